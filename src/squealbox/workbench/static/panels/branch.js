// Limit cycles over a parameter: stable solid, unstable dashed, and where they exist beside stable sliding.

import { Asked, button } from "../asked.js";
import { BENT, Chart, band, line, points, span, upright } from "../chart.js";
import { make } from "../elements.js";
import { label, shown } from "../numbers.js";
import { stateWithout } from "../panel.js";
import { degrees } from "../start.js";

const parameter = (panel) => panel.parameter("parameter", "friction.static");

export default {
  setup(panel) {
    panel.parameterChoice("over", "parameter", "friction.static");
    panel.degrees = make("span");
    panel.controls.append(panel.degrees);
    panel.asked = new Asked(panel, "Press Follow; it may take a minute.", () => [stateWithout(panel.app.store, parameter(panel)), parameter(panel)]);
    panel.body.append(make("div", { class: "buttons" }, button("Follow", () => follow(panel), { title: "Follow the limit cycles over the parameter" })));
    panel.charts = [new Chart(panel.body, { name: "branch", height: 270, like: BENT, awaited: "amplitude of the cycles: press Follow" })];
    panel.app.store.addEventListener("shown", () => picture(panel));
    panel.app.store.addEventListener("changed", () => picture(panel));
  },

  options(panel) {
    if (!panel.asked.current) return null;
    return { parameter: parameter(panel), span: panel.span(parameter(panel)), at: panel.at, dof: panel.chosen.dof ?? 0, points: panel.chosen.points };
  },

  state: (panel) => stateWithout(panel.app.store, parameter(panel)),

  draw(panel, frame) {
    panel.frame = frame;
    degrees(panel, frame.data);
    panel.remark = words(frame.data);
    panel.element.dataset.together = JSON.stringify(frame.data.together);
    panel.element.dataset.walks = frame.data.walks.length;
    panel.app.beside = { current: () => panel.asked.current, ...frame.data };
    if (panel.app.verdict.data) panel.app.verdict.draw(panel.app.verdict.data);
    picture(panel);
  },
};

function follow(panel) {
  const value = panel.app.store.value(parameter(panel));
  const [low, high] = panel.span(parameter(panel)) ?? [0, 1];
  panel.at = Math.min(Math.max(typeof value === "number" ? value : low, low), high);
  panel.range = [low, high];
  panel.asked.ask();
}

function picture(panel) {
  if (!panel.frame) return;
  const { data, arrays } = panel.frame;
  const { axis } = data;
  const layers = data.together.map(([from, to]) => band(from, to, { cls: "together" }));
  for (const [from, to] of data.quiet) layers.push(line([from, to], [0, 0], { cls: "s2", name: "stable sliding" }));
  const sizes = [];
  data.walks.forEach((walk, i) => {
    const [x, y, stable] = ["value", "size", "stable"].map((name) => arrays[`${name}${i}`]);
    sizes.push(y);
    for (const wanted of [1, 0]) {
      const kept = y.map((value, k) => (stable[k] === wanted || stable[k - 1] === wanted ? value : NaN));
      if (kept.some(Number.isFinite)) layers.push(line(x, kept, { cls: wanted ? "s0" : "s1", name: wanted ? "stable cycle" : "unstable cycle" }));
    }
    if (walk.specials.length) layers.push(points(walk.specials.map((each) => each[1]), walk.specials.map((each) => each[2]), { cls: "begin", r: 5, column: walk.specials.map((each) => each[0]).join(", ") }));
  });
  if (data.hopf !== null) layers.push(points([data.hopf], [0], { cls: "here", column: "onset" }));
  const present = panel.app.store.value(axis.parameter);
  if (typeof present === "number") layers.push(upright(present / axis.factor));
  const [, top] = span(sizes, { with0: true, room: 0.3 });
  panel.charts[0].draw({
    x: { label: label(axis.parameter, axis.unit), domain: data.span },
    y: { label: label(`amplitude of ${data.names[data.dof]}`, data.unit), domain: [-0.03 * top, top] },
    layers,
  });
}

function words(data) {
  const unit = data.axis.unit ? ` ${data.axis.unit}` : "";
  const said = [];
  if (data.hopf !== null) said.push(`Sliding loses its stability at ${shown(data.hopf, 5)}${unit}, ${data.kind}.`);
  for (const [from, to] of data.together) said.push(`From ${shown(from, 4)} to ${shown(to, 4)}${unit} (shaded) a stable cycle exists beside stable sliding: a push decides.`);
  const ended = [...new Set(data.walks.map((walk) => walk.ended).filter((text) => text && !text.startsWith("completed")))];
  if (ended.length) said.push(`Followed until: ${ended.join("; ")}. Beyond that nothing is said.`);
  if (data.centre) said.push("Closed orbits lie side by side about a centre, as nothing in the model damps them: none attracts, a push decides the size.");
  if (!data.walks.length && !data.centre) said.push("No limit cycle was found from the starts tried; that does not prove there is none.");
  const specials = data.walks.flatMap((walk) => walk.specials.map(([kind, value]) => `${kind} at ${shown(value, 5)}`));
  if (specials.length) said.push(`Circles: ${[...new Set(specials)].slice(0, 6).join(", ")}.`);
  return said.join(" ");
}

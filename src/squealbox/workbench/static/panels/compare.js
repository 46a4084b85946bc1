// Two designs beside each other: A is kept, B is the one on the page.

import { button } from "../asked.js";
import { Chart, across, line, span, upright } from "../chart.js";
import { make, table } from "../elements.js";
import { label, prefix, shown, withUnit } from "../numbers.js";

export default {
  setup(panel) {
    panel.parameterChoice("over", "parameter", "friction.static");
    panel.keys = {
      keep: button("Keep this as A", () => keep(panel), { title: "Keep the design on the page as A" }),
      swap: button("Swap A and B", () => swap(panel), { disabled: true }),
      drop: button("Forget A", () => panel.choose({ a: null }), { disabled: true }),
    };
    panel.body.append(make("div", { class: "buttons" }, ...Object.values(panel.keys)));
    const place = make("div", { class: "charts two" });
    panel.table = make("div", { class: "scroller", role: "region", tabindex: 0, "aria-label": "The two designs in numbers" });
    panel.body.append(place, panel.table);
    panel.charts = [
      new Chart(place, { name: "frequency", title: "Frequencies", height: 200 }),
      new Chart(place, { name: "growth", title: "Largest growth rate", height: 200 }),
    ];
  },

  options(panel) {
    const parameter = panel.parameter("parameter", "friction.static");
    return parameter ? { parameter, span: panel.span(parameter) } : null;
  },

  draw(panel, frame) {
    panel.b = frame;
    const { a } = panel.chosen;
    panel.keys.swap.disabled = panel.keys.drop.disabled = !a;
    if (!a) panel.a = null;
    else if (panel.a?.key !== key(panel, a)) other(panel, a);
    picture(panel);
  },
};

const WHY = { unknown_base: "it came from a file that is not open any more" };
const key = (panel, design) => JSON.stringify([design, panel.request().options.parameter, panel.b.data.span]);

function keep(panel) {
  if (!panel.b) return;
  const design = panel.app.store.design;
  panel.a = { key: key(panel, design), frame: panel.b };
  panel.choose({ a: design });
  panel.keys.swap.disabled = panel.keys.drop.disabled = false;
  picture(panel);
}

function swap(panel) {
  const { a } = panel.chosen;
  panel.choose({ a: panel.app.store.design });
  panel.app.store.replace(a);
}

/** Ask for A: after a change of the axis, a swap, or when a link carried it. */
function other(panel, design) {
  const asked = key(panel, design);
  const { options } = panel.request();
  panel.app.connection.ask({ view: "compare", state: design, options: { ...options, span: panel.b.data.span.map((end) => end * panel.b.data.axis.factor) } }).then(
    (frame) => {
      panel.a = { key: asked, frame: frame.kind === "answer" ? frame : null, why: WHY[frame.kind] ?? frame.wrong?.map((each) => each.message).join("; ") ?? frame.message };
      picture(panel);
    },
    () => {}, // the connection was lost: asked again when the page draws again
  );
}

function picture(panel) {
  const { b } = panel;
  const a = panel.a?.frame ?? null;
  const [frequency, growth] = panel.charts;
  const both = [[b, "B", "s0"], ...(a ? [[a, "A", "s1"]] : [])];
  const top = Math.max(...both.flatMap(([frame]) => Array.from(frame.arrays.frequency).filter(Number.isFinite)));
  const [factor, hertz] = prefix("Hz", top);
  const x = { label: label(b.data.axis.parameter, b.data.axis.unit), domain: b.data.span };
  const here = b.data.value === null ? [] : [upright(b.data.value)];
  const curves = both.flatMap(([{ data, arrays }, name, cls]) =>
    Array.from({ length: data.modes }, (_, i) => {
      const [, many] = arrays.frequency.shape;
      return line(arrays.values, arrays.frequency.subarray(i * many, (i + 1) * many).map((f) => f / factor), { cls, name });
    }),
  );
  frequency.draw({ x, y: { label: label("frequency", hertz), domain: span(curves.map((each) => each.y), { room: 0.2 }) }, layers: [...curves, ...here] });
  const rates = both.map(([{ arrays }, name, cls]) => line(arrays.values, arrays.growth, { cls, name }));
  growth.draw({ x, y: { label: label("growth rate", "1/s"), domain: span(rates.map((each) => each.y), { room: 0.2 }) }, layers: [across(0), ...rates, ...here], legend: "top left" });
  panel.table.replaceChildren(numbers(a?.data ?? null, b.data));
  panel.element.dataset.compared = a ? "yes" : "no";
  const kept = Boolean(panel.chosen.a);
  if (a) panel.remark = "";
  else if (kept && panel.a?.why) panel.remark = `A cannot be drawn over ${b.data.axis.parameter}: ${panel.a.why}.`;
  else panel.remark = "Keep this design as A, then change it: A stays beside it.";
  panel.says.textContent = panel.remark;
}

function numbers(a, b) {
  const unit = b.axis.unit ? ` ${b.axis.unit}` : "";
  const percent = (share) => (share === null ? "–" : `${shown(100 * share, 3)} %`);
  const rows = [
    ["steady sliding", (d) => d.state + (d.mechanism ? `, ${d.mechanism}` : "")],
    ["worst mode", (d) => (d.frequency === null ? "–" : withUnit(d.frequency, "Hz", 5))],
    ["its growth rate", (d) => `${shown(d.growth, 5)} 1/s`, (d) => d.growth],
    [`critical ${b.axis.parameter}`, (d) => (d.critical === null ? "none here" : shown(d.critical, 5) + unit)],
    ["margin to it", (d) => percent(d.margin)],
  ];
  const body = rows.map(([name, text, size]) => row(name, a && text(a), text(b), a && size && Math.sign(size(b) - size(a))));
  const before = new Map(a?.parameters ?? []);
  const after = new Map(b.parameters);
  for (const name of new Set([...before.keys(), ...after.keys()])) {
    if (a && before.get(name) !== after.get(name)) body.push(row(name, before.get(name) ?? "–", after.get(name) ?? "–"));
  }
  const heads = ["", a ? "A (kept)" : null, "B (this page)"].filter((head) => head !== null);
  return table(heads, body);
}

function row(name, a, b, sense = 0) {
  const cls = sense ? (sense < 0 ? "better" : "worse") : null;
  return make("tr", {}, make("th", { scope: "row" }, name), a === null ? null : make("td", {}, a), make("td", { class: cls }, b));
}


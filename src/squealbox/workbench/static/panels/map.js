// Stability over two parameters on a canvas, its boundary as a curve; a click, a drag or the arrow keys move the design.

import { Chart, path, points } from "../chart.js";
import { choose, make } from "../elements.js";
import { label, shown } from "../numbers.js";
import { stateWithout } from "../panel.js";
import { diverging, mechanismColours, sequential } from "../colours.js";

export default {
  setup(panel) {
    panel.parameterChoice("x", "x", "friction.static");
    panel.parameterChoice("y", "y", "load", "load1", "sliding_speed", "theta1");
    panel.controls.append(choose("show", [["growth", "growth rate"], ["frequency", "frequency"], ["mechanism", "mechanism"]], panel.chosen.show ?? "growth", (show) => panel.choose({ show })));
    const chart = new Chart(panel.body, { name: "map", height: 300 });
    panel.charts = [chart];
    panel.legend = make("p", { class: "key", "aria-hidden": "true" });
    panel.body.append(panel.legend);
    chart.svg.attr("tabindex", 0).attr("aria-label", "Stability map: click or use the arrow keys to move the design").classed("pickable", true);
    pickable(panel, chart);
    panel.app.store.addEventListener("shown", () => mark(panel));
    panel.app.store.addEventListener("changed", () => mark(panel));
  },

  options(panel) {
    const [x, y] = axes(panel);
    if (!x || !y) return null;
    return { x, y, xspan: panel.span(x), yspan: panel.span(y), show: panel.chosen.show ?? "growth" };
  },

  state: (panel) => stateWithout(panel.app.store, ...axes(panel)),

  draw(panel, { data, arrays }) {
    panel.frame = { data, arrays };
    const [chart] = panel.charts;
    const [rows, columns] = arrays.growth.shape;
    const heat = { rows, columns, ...coloured(data, arrays) };
    panel.legend.replaceChildren(...legend(heat));
    const domain = (axis, span) => ({ label: label(axis.parameter, axis.unit), domain: span, axis });
    panel.spec = { x: domain(data.x, data.xspan), y: domain(data.y, data.yspan), heat, edges: boundary(arrays) };
    const share = data.unstable === null ? "no steady sliding anywhere" : `${shown(100 * data.unstable, 3)} % of the plane is unstable`;
    panel.remark = data.missing ? `${share}; ${data.missing} points have no steady sliding` : share;
    mark(panel);
    chart.svg.attr("data-unstable", data.unstable);
  },
};

const axes = (panel) => [panel.parameter("x", "friction.static"), panel.parameter("y", "load", "load1", "sliding_speed", "theta1")];

/** The present design on the map that is drawn. */
function mark(panel) {
  if (!panel.spec) return;
  const { store } = panel.app;
  const { x, y, heat, edges } = panel.spec;
  const [a, b] = [store.value(x.axis.parameter), store.value(y.axis.parameter)];
  const known = typeof a === "number" && typeof b === "number";
  const at = [a / x.axis.factor, b / y.axis.factor];
  panel.charts[0].draw({ x, y, heat, layers: [path(edges, { column: "boundary" }), ...(known ? [points([at[0]], [at[1]], { cls: "here big", r: 6, column: "present design" })] : [])] });
  panel.element.dataset.at = at.join(",");
}

function pickable(panel, chart) {
  const place = (event) => {
    const box = chart.svg.node().getBoundingClientRect();
    const inside = (value, [a, b]) => Math.min(Math.max(value, Math.min(a, b)), Math.max(a, b));
    const { x, y } = panel.spec;
    const px = inside(chart.x.invert(event.clientX - box.left), x.domain);
    const py = inside(chart.y.invert(event.clientY - box.top), y.domain);
    return { [x.axis.parameter]: rounded(px, x.domain) * x.axis.factor, [y.axis.parameter]: rounded(py, y.domain) * y.axis.factor };
  };
  const node = chart.svg.node();
  let dragging = false;
  node.addEventListener("pointerdown", (event) => {
    if (!panel.spec || event.button) return;
    dragging = true;
    node.setPointerCapture(event.pointerId);
    panel.app.store.propose(place(event));
  });
  node.addEventListener("pointermove", (event) => dragging && panel.app.store.propose(place(event)));
  const end = () => {
    if (dragging) panel.app.store.commit();
    dragging = false;
  };
  node.addEventListener("pointerup", end);
  node.addEventListener("pointercancel", end);
  node.addEventListener("keydown", (event) => {
    const way = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
    if (!way || !panel.spec) return;
    event.preventDefault();
    const { x, y } = panel.spec;
    const moved = (axis, steps) => {
      const [low, high] = axis.domain;
      const value = panel.app.store.value(axis.axis.parameter) / axis.axis.factor + (steps * (high - low)) / 100;
      return rounded(Math.min(Math.max(value, low), high), axis.domain) * axis.axis.factor;
    };
    panel.app.store.commit({ [x.axis.parameter]: moved(x, way[0]), [y.axis.parameter]: moved(y, way[1]) });
  });
}

const rounded = (value, [low, high]) => {
  const digits = Math.max(0, 3 - Math.floor(Math.log10(high - low)));
  return Number(value.toFixed(Math.min(digits, 12)));
};

/** The curves of the boundary, from its points and the number of the curve each is on. */
function boundary({ edge, curve }) {
  const curves = [];
  for (let i = 0; i < curve.length; i++) (curves[curve[i]] ??= []).push([edge[2 * i], edge[2 * i + 1]]);
  return curves;
}

/** The values to be coloured, how, and what the colours mean; the scale is made for the colours the page has then. */
function coloured(data, arrays) {
  const key = (made, words) => () => made().steps.map(([css, value]) => [css, words(value)]);
  if (data.show === "mechanism") {
    const keys = () => data.mechanisms.map((name, code) => [mechanismColours().css(code), name.replaceAll("_", " ")]);
    return { values: arrays.mechanism, scale: mechanismColours, keys, name: "mechanism" };
  }
  if (data.show === "frequency") {
    const scale = () => sequential(arrays.frequency);
    return { values: arrays.frequency, scale, keys: key(scale, (value) => `${shown(value, 3)} Hz`), name: "frequency [Hz]" };
  }
  const scale = () => diverging(arrays.growth);
  return { values: arrays.growth, scale, keys: key(scale, (value) => `${shown(value, 2)} 1/s`), name: "growth rate [1/s]", words: "growth rate: orange squeals, blue is quiet" };
}

function legend(heat) {
  const swatch = (css) => {
    const made = make("i", { class: "swatch" });
    made.style.backgroundColor = css;
    return made;
  };
  return [...heat.keys().flatMap(([css, words]) => [swatch(css), `${words} `]), heat.words ?? ""];
}

// Zoom: drag a box over a figure (with Shift where a drag moves the design), or + and −; twice pressed, or 0, shows all again.

import { element, spot } from "./elements.js";

const LEAST = 6; // px of a box that is meant
const STEP = 0.7;

/** `narrow(axis, ends)` takes the new ends of an axis over a parameter, null for the usual ones, and returns true: it is then computed anew. */
export function zoomable(chart, narrow) {
  const node = chart.svg;
  const box = element("rect", { class: "zoom", visibility: "hidden" });
  node.append(box);
  const corners = ([a, b], [c, d]) => [Math.min(a, c), Math.min(b, d), Math.abs(c - a), Math.abs(d - b)];
  let from = null;
  node.addEventListener("pointerdown", (event) => {
    if (!chart.spec || event.button || event.pointerType === "touch" || (node.classList.contains("pickable") && !event.shiftKey)) return;
    from = spot(node, event);
    node.setPointerCapture(event.pointerId);
    event.stopImmediatePropagation();
  }, true);
  node.addEventListener("pointermove", (event) => {
    if (!from) return;
    const [x, y, width, height] = corners(from, spot(node, event));
    for (const [name, value] of Object.entries({ x, y, width, height, visibility: "visible" })) box.setAttribute(name, value);
  });
  node.addEventListener("pointerup", (event) => {
    if (!from) return;
    const [x, y, width, height] = corners(from, spot(node, event));
    from = null;
    box.setAttribute("visibility", "hidden");
    if (width > LEAST || height > LEAST) show(width > LEAST && [chart.x.invert(x), chart.x.invert(x + width)], height > LEAST && [chart.y.invert(y + height), chart.y.invert(y)]);
  });
  node.addEventListener("dblclick", () => show(null, null));
  node.addEventListener("keydown", (event) => {
    const by = { "+": STEP, "=": STEP, "-": 1 / STEP }[event.key];
    if (!chart.spec || (!by && event.key !== "0")) return;
    event.preventDefault();
    show(...[chart.x, chart.y].map((scale) => by && nearer(scale.ends, by)));
  });

  function show(x, y) {
    const ends = { x, y };
    for (const way of ["x", "y"]) if (ends[way] !== false && narrow(chart.spec[way], ends[way])) ends[way] = null;
    const of = chart.spec.x.label + chart.spec.y.label;
    const [was, now] = [chart.zoom?.of === of ? chart.zoom : {}, (way) => (ends[way] === false ? was[way] : ends[way]) || null];
    chart.zoom = { x: now("x"), y: now("y"), of };
    chart.draw(chart.spec);
  }
}

const nearer = ([a, b], by) => [(a + b) / 2 - (by * (b - a)) / 2, (a + b) / 2 + (by * (b - a)) / 2];

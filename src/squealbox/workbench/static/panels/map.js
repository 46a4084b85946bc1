// The stability map: a click, a drag or the arrow keys move the design.

import { set, spot } from "../elements.js";

export default {
  setup(panel) {
    const [chart] = panel.charts;
    set(chart.svg, { class: "pickable", "aria-label": "Stability map: click or use the arrow keys to move the design; plus and minus zoom, 0 shows all" });
    pickable(panel, chart);
  },
};

function pickable(panel, chart) {
  const place = (event) => {
    const [left, top] = spot(chart.svg, event);
    const inside = (value, [a, b]) => Math.min(Math.max(value, Math.min(a, b)), Math.max(a, b));
    const { x, y } = chart.spec;
    const px = inside(chart.x.invert(left), chart.x.ends);
    const py = inside(chart.y.invert(top), chart.y.ends);
    return { [x.parameter]: rounded(px, x.domain) * x.factor, [y.parameter]: rounded(py, y.domain) * y.factor };
  };
  const node = chart.svg;
  let dragging = false;
  node.addEventListener("pointerdown", (event) => {
    if (!chart.spec || event.button) return;
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
    if (!way || !chart.spec) return;
    event.preventDefault();
    const { x, y } = chart.spec;
    const moved = (axis, steps) => {
      const [low, high] = axis.domain;
      const value = panel.app.store.value(axis.parameter) / axis.factor + (steps * (high - low)) / 100;
      return rounded(Math.min(Math.max(value, low), high), axis.domain) * axis.factor;
    };
    panel.app.store.commit({ [x.parameter]: moved(x, way[0]), [y.parameter]: moved(y, way[1]) });
  });
}

const rounded = (value, [low, high]) => {
  const digits = Math.max(0, 3 - Math.floor(Math.log10(high - low)));
  return Number(value.toFixed(Math.min(digits, 12)));
};

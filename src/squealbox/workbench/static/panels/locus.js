// Frequency and growth rate of every mode over a parameter, and the eigenvalues in their plane; the present point marked.

import { Chart, across, band, line, points, span, upright } from "../chart.js";
import { row } from "../connection.js";
import { make } from "../elements.js";
import { label, prefix } from "../numbers.js";

export default {
  setup(panel) {
    panel.parameterChoice("over", "parameter", "friction.static");
    const place = make("div", { class: "charts three" });
    panel.body.append(place);
    panel.charts = [
      new Chart(place, { name: "frequency", title: "Frequency", height: 216 }),
      new Chart(place, { name: "growth", title: "Growth rate (above zero: squeal)", height: 216 }),
      new Chart(place, { name: "plane", title: "Eigenvalue plane", height: 216 }),
    ];
  },

  options(panel) {
    const parameter = panel.parameter("parameter", "friction.static");
    return parameter ? { parameter, span: panel.span(parameter) } : null;
  },

  draw(panel, { data, arrays }) {
    const { axis } = data;
    const [frequencies, growths, plane] = panel.charts;
    const x = { label: label(axis.parameter, axis.unit), domain: [arrays.value[0], arrays.value.at(-1)] };
    const modes = arrays.frequency.shape[0];
    const rows = (array) => Array.from({ length: modes }, (_, i) => row(array, i));
    const [factor, hertz] = prefix("Hz", arrays.frequency.reduce((a, b) => (b > a ? b : a), 0));
    const frequency = rows(arrays.frequency).map((each) => each.map((f) => f / factor));
    const growth = rows(arrays.growth);
    const here = { x: data.value === null ? null : data.value / axis.factor, f: arrays.hereFrequency.map((f) => f / factor), g: arrays.hereGrowth };
    const bands = data.unstable.map(([a, b]) => band(a, b));
    const present = here.x === null ? [] : [upright(here.x)];
    const dots = (ys) => (here.x === null ? [] : [points(Array(ys.length).fill(here.x), ys, { column: "present design" })]);
    const names = (i) => ({ cls: `s${i % 7}`, column: `mode ${i + 1}`, ...(modes <= 4 ? { name: `mode ${i + 1}` } : {}) });
    frequencies.draw({
      x,
      y: { label: label("frequency", hertz), domain: span([...frequency, here.f]) },
      legend: "bottom right",
      layers: [...bands, ...present, ...frequency.map((f, i) => line(arrays.value, f, names(i))), ...dots(here.f)],
    });
    growths.draw({
      x,
      y: { label: label("growth rate", "1/s"), domain: span([...growth, here.g], { with0: true }) },
      layers: [...bands, across(0), ...present, ...growth.map((g, i) => line(arrays.value, g, { ...names(i), name: "" })), ...dots(here.g)],
    });
    const reach = span([...growth, here.g], { with0: true });
    plane.draw({
      x: { label: label("growth rate", "1/s"), domain: reach },
      y: { label: label("frequency", hertz), domain: span([...frequency, here.f]) },
      layers: [
        band(0, reach[1]),
        upright(0, { cls: "axis-line" }),
        ...growth.map((g, i) => line(g, frequency[i], { ...names(i), name: "" })),
        points(here.g, here.f, { column: "present design" }),
        ...ends(growth, frequency),
      ],
    });
    panel.remark = data.outcome === "completed" ? "" : `${data.message}.`;
    panel.element.dataset.value = data.value;
  },
};

/** A ring where each line of the plane begins, so that its direction is seen. */
function ends(growth, frequency) {
  const begins = growth.map((g, i) => [g[0], frequency[i][0]]).filter((p) => p.every(Number.isFinite));
  return [points(begins.map((p) => p[0]), begins.map((p) => p[1]), { cls: "begin", r: 3, column: "first value" })];
}

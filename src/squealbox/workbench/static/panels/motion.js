// A transient: its course with the verdict, spectrum, phase plane and spectrogram.

import { Chart, across, hull, line, span, text } from "../chart.js";
import { sequential } from "../colours.js";
import { choose, make } from "../elements.js";
import { label, prefix, shown, typographic } from "../numbers.js";
import { degrees, startOf } from "../start.js";

const STARTS = [["push", "steady sliding, pushed"], ["rest", "loads applied at rest"], ["sliding", "steady sliding"]];

export default {
  setup(panel) {
    panel.degrees = make("span");
    panel.controls.append(
      choose("start", STARTS, startOf(panel.app.store).start, (start) => panel.choose({ start })),
      choose("push", [["0.001", "0.1 %"], ["0.05", "5 %"], ["0.5", "50 %"], ["2", "200 %"]], String(startOf(panel.app.store).push), (push) => panel.choose({ push: Number(push) })),
      panel.degrees,
    );
    const place = make("div", { class: "charts two" });
    panel.body.append(place);
    panel.app.addEventListener("cursor", ({ detail }) => panel.element.dataset.state === "drawn" && panel.cursor?.(detail));
    panel.charts = [
      new Chart(place, { name: "time", title: "Displacement", height: 190 }),
      new Chart(place, { name: "spectrum", title: "Spectrum of the second half", height: 190 }),
      new Chart(place, { name: "phase", title: "Phase plane of the second half", height: 230 }),
      new Chart(place, { name: "spectrogram", title: "Spectrogram", height: 230 }),
    ];
  },

  options: (panel) => startOf(panel.app.store),

  draw(panel, { data, arrays }) {
    degrees(panel, data);
    panel.app.heard({ data, arrays });
    panel.remark = [data.verdict, data.caution, data.outcome === "completed" ? "" : `${data.message}.`].filter(Boolean).map(typographic).join(" ");
    panel.element.dataset.fate = data.fate ?? "";
    panel.element.dataset.frequency = data.peaks?.[0]?.[0] ?? "";
    if (data.short) return;
    const [time, spectrum, phase, spectrogram] = panel.charts;
    const name = data.names[data.dof];
    time.draw({
      x: { label: label("time", data.clock), domain: [0, data.end ?? arrays.time.at(-1)] },
      y: { label: label(name, data.unit), domain: span([arrays.low, arrays.high]) },
      layers: [hull(arrays.time, arrays.low, arrays.high)],
    });
    phase.draw({
      x: { label: label(name, data.unit), domain: span([arrays.x]) },
      y: { label: label(`d${name}/dt`, data.speed), domain: span([arrays.v]) },
      layers: [line(arrays.x, arrays.v, { cls: "s1 thin" })],
    });
    panel.cursor = (k) => {
      phase.mark(arrays.lastX[k], arrays.lastV[k]);
      time.mark(data.lastFrom + arrays.lastTime[k], arrays.lastX[k]);
    };
    if (!arrays.hertz) return;
    const [factor, hertz] = prefix("Hz", arrays.hertz.at(-1));
    const f = arrays.hertz.map((each) => each / factor);
    const top = arrays.amplitude.reduce((a, b) => (b > a ? b : a), 0) || 1;
    spectrum.draw({
      x: { label: label("frequency", hertz), domain: [0, f.at(-1)] },
      y: { label: label("amplitude", data.unit), domain: [0, 1.18 * top] },
      layers: [line(f, arrays.amplitude), across(0), ...data.peaks.slice(0, 3).map(([at, size]) => text(at / factor, size, shown(at / factor)))],
    });
    const [rows, columns] = arrays.grid.shape;
    const scale = () => sequential(arrays.grid, { log: true });
    const keys = () => scale().steps.map(([css, value]) => [css, `${shown(value, 2)} ${data.unit}`]);
    spectrogram.draw({
      x: { label: label("time", data.clock), domain: data.gridTime },
      y: { label: label("frequency", hertz), domain: [0, data.gridTop / factor] },
      heat: { rows, columns, values: arrays.grid, scale, keys, name: `amplitude [${data.unit}]`, smooth: true },
      layers: [],
    });
  },
};

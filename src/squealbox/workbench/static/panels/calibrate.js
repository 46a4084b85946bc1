// The design fitted to an event of the recording: what to fit, the values with their intervals, and taking them over.

import { Asked, button } from "../asked.js";
import { choose, make, table } from "../elements.js";
import { raised, shown } from "../numbers.js";
import { asked } from "./recording.js";

const USUAL = [["friction.static"], ["k3", "k2", "k", "k11"]];
const WIDE = [["0.1", "10 %"], ["0.3", "30 %"], ["0.6", "60 %"]];

export default {
  setup(panel) {
    panel.files.hidden = true;
    USUAL.forEach((usual, i) => panel.parameterChoice(i ? "and" : "fit", `p${i}`, ...usual));
    panel.controls.append(choose("within", WIDE, String(panel.chosen.share ?? 0.3), (share) => panel.choose({ share: Number(share) })));
    panel.asked = new Asked(panel, "Press Fit, once a recording with a squeal event is there.", () => [panel.app.store.design, panel.chosen]);
    panel.keys = { fit: button("Fit", () => panel.asked.ask()), take: button("Take these values over", () => over(panel), { disabled: true }) };
    panel.list = make("div", { class: "scroller", role: "region", tabindex: 0, "aria-label": "Fitted values" });
    panel.body.append(make("div", { class: "buttons" }, ...Object.values(panel.keys)), panel.list);
    list(panel, [["friction.static", "…", "…", "…"], ["k3", "…", "…", "…"]]);
  },

  options(panel) {
    const recording = panel.app.panels.get("recording");
    if (!panel.asked.current || !recording?.id) return null;
    const parameters = [...new Set(USUAL.map((usual, i) => panel.parameter(`p${i}`, ...usual)))];
    return { ...asked(recording), event: recording.data?.event ?? 0, parameters, share: panel.chosen.share ?? 0.3 };
  },

  draw(panel, { data }) {
    panel.data = data;
    const read = (value, row) => (value === null ? "–" : `${shown(value / row.factor, 5)} ${raised(row.unit)}`.trim());
    list(panel, data.rows.map((row) => [row.name, read(row.before, row), read(row.values, row), `${read(row.low, row)} to ${read(row.high, row)}`]));
    panel.keys.take.disabled = data.rows.some((row) => row.values === null);
    panel.element.dataset.outcome = data.outcome;
    panel.remark = [data.outcome === "completed" ? "" : `${data.message}.`, ...data.open, ...data.fits.map(([text, value, away]) => `${text}: the fit says ${shown(value, 5)}, ${shown(away, 2)} sd apart.`)].join(" ");
  },
};

const list = (panel, rows) => panel.list.replaceChildren(table(["parameter", "now", "fitted", "95 % interval"], rows, { class: "cures" }));

function over(panel) {
  panel.app.store.commit(Object.fromEntries(panel.data.rows.map((row) => [row.name, row.values])));
}

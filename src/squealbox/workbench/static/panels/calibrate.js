// The design fitted to an event of the recording, and the fitted values taken over.

import { Asked } from "../asked.js";

export default {
  setup(panel) {
    panel.asked = new Asked(panel, "Press Fit, once a recording with a squeal event is there.", () => [panel.app.store.design, panel.chosen]);
    panel.button("Fit", () => panel.asked.ask());
    panel.take = panel.button("Take these values over", () => panel.app.store.commit(Object.fromEntries(panel.frame.data.rows.map((row) => [row.name, row.values]))), { disabled: true });
    panel.like(["parameter", "now", "fitted", "95 % interval"], ["friction.static", "k3"]);
  },

  options(panel) {
    const recording = panel.app.panels.get("recording");
    if (!panel.asked.current || !recording?.id) return null;
    const parameters = panel.about.choices.filter((each) => each.kind === "over").map(({ name, usual }) => panel.parameter(name, ...usual));
    return { ...recording.request().options, event: recording.frame?.data.event ?? 0, parameters: [...new Set(parameters)] };
  },

  draw(panel, { data }) {
    panel.take.disabled = data.rows.some((row) => row.values === null);
  },
};

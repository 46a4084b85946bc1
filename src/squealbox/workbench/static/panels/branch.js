// Limit cycles over a parameter, on Follow; where they exist beside stable sliding goes into the verdict.

import { Asked } from "../asked.js";
import { stateWithout } from "../panel.js";

const parameter = (panel) => panel.parameter("parameter", "friction.static");

export default {
  setup(panel) {
    panel.asked = new Asked(panel, "Press Follow; it may take a minute.", () => [stateWithout(panel.app.store, parameter(panel)), parameter(panel)]);
    panel.button("Follow", () => follow(panel), { title: "Follow the limit cycles over the parameter" });
  },

  options: (panel) => (panel.asked.current ? { at: panel.at, dof: panel.chosen.dof ?? 0, points: panel.chosen.points } : null),

  draw(panel, { data }) {
    panel.app.beside = { current: () => panel.asked.current, ...data };
    if (panel.app.verdict.data) panel.app.verdict.draw(panel.app.verdict.data);
  },
};

function follow(panel) {
  const value = panel.app.store.value(parameter(panel));
  const [low, high] = panel.span(parameter(panel)) ?? [0, 1];
  panel.at = Math.min(Math.max(typeof value === "number" ? value : low, low), high);
  panel.asked.ask();
}

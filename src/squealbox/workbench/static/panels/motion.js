// A transient: what it says goes into the verdict, and where the brake that moves is now is marked in its figures.

import { startOf } from "../start.js";

export default {
  setup: (panel) => panel.app.addEventListener("cursor", ({ detail }) => panel.element.dataset.state === "drawn" && panel.cursor?.(detail)),

  options: (panel) => startOf(panel.app.store),

  draw(panel, { data, arrays }) {
    panel.app.heard({ data, arrays });
    const [time, , phase] = panel.charts;
    panel.cursor = arrays.lastX && ((k) => {
      phase.mark(arrays.lastX[k], arrays.lastV[k]);
      time.mark(data.lastFrom + arrays.lastTime[k], arrays.lastX[k]);
    });
  },
};

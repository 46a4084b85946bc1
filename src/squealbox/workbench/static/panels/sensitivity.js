// Which parameter to change: what one per cent more of each does to the growth rate.

import { Bars } from "../bars.js";
import { shown } from "../numbers.js";

export default {
  setup(panel) {
    panel.charts = [new Bars(panel.body, "sensitivity")];
  },

  options: () => ({}),

  draw(panel, { data }) {
    const bars = data.bars.map((bar) => ({ name: bar.name, parts: [[bar.growth > 0 ? "b0" : "b2", bar.growth]], sum: bar.growth }));
    panel.charts[0].draw({ label: "change of growth rate for +1 % [1/s]", bars });
    const best = data.bars[0];
    panel.remark = data.outcome !== "completed" ? `${data.message}.`
      : data.near ? "Two modes nearly merge here: derivatives mean little."
        : best ? `Strongest: 1 % ${best.growth > 0 ? "less" : "more"} of ${best.name} lowers the growth rate by ${shown(Math.abs(best.growth), 3)} 1/s. Valid for small changes only.` : "";
  },
};

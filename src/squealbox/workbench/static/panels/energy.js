// What each contact and each damper brings to the growth rate of the mode that grows first.

import { Bars } from "../bars.js";
import { shown, withUnit } from "../numbers.js";

const CLASSES = { "normal force": "b0", slope: "b1", damping: "b2" };

export default {
  setup(panel) {
    panel.charts = [new Bars(panel.body, "energy")];
  },

  options: () => ({}),

  draw(panel, { data }) {
    const bars = data.bars.map((bar) => ({ ...bar, parts: Object.entries(bar.parts).map(([name, value]) => [CLASSES[name], value]) }));
    panel.charts[0].draw({ label: "share of the growth rate [1/s]", bars, legend: Object.entries(CLASSES).map(([name, cls]) => [cls, name]) });
    panel.remark = data.outcome === "completed"
      ? `Together ${shown(data.growth)} 1/s at ${withUnit(data.frequency, "Hz")}: to the right feeds the mode, to the left damps it.${data.left ? ` ${data.left} smaller ones are not shown.` : ""}`
      : `${data.message}.`;
  },
};

// Which parameter to change: bars, the same as discs where the drawing names the parameter, and how far each must go.

import { button } from "../asked.js";
import { Bars } from "../bars.js";
import { drawn, element } from "../drawing.js";
import { choose, make } from "../elements.js";
import { shown, typographic } from "../numbers.js";

const STEPS = { percent: "+1 %", tolerance: "one tolerance" };

export default {
  setup(panel) {
    const step = choose("for", Object.entries(STEPS), panel.chosen.step ?? "percent", (chosen) => panel.choose({ step: chosen }));
    panel.needs = make("span");
    panel.stage = make("div", { class: "drawing weighed" });
    const beside = make("div", { class: "beside" });
    panel.body.append(make("p", { class: "needs controls" }, step, panel.needs), beside);
    panel.charts = [new Bars(beside, "sensitivity")];
    Object.assign(panel.charts[0].margin, { left: 96, right: 48 });
    beside.append(panel.stage);
  },

  options: (panel) => ({ step: panel.chosen.step ?? "percent" }),

  draw(panel, { data, arrays }) {
    const look = (bar) => (bar.growth > 0 ? "b0" : "b2");
    const step = STEPS[panel.chosen.step ?? "percent"];
    panel.charts[0].draw({ label: `growth rate [1/s] for ${step}`, bars: data.bars.map((bar) => ({ name: bar.name, parts: [[look(bar), bar.growth]], sum: bar.growth })) });
    const go = ({ name, needed }) => button(`${name} ${typographic(` ${needed.told}`).trim()}`, () => panel.app.store.commit({ [name]: needed.beyond }), { title: "Put this value, and one hundredth of the way more, on the page", data: { needs: name } });
    panel.needs.replaceChildren(...data.bars.filter((bar) => bar.needed?.near).map(go));
    panel.remark = data.outcome !== "completed" ? `${data.message}.` : data.near ? "Two modes nearly merge here: derivatives mean little." : typographic(data.words);
    panel.stage.replaceChildren();
    if (!data.strokes || !data.bars.length) return;
    const { svg, at } = drawn(data, arrays.points, "Drawing of the brake, with what each parameter does");
    const most = Math.abs(data.bars[0].growth);
    for (const bar of data.bars.filter((each) => each.place)) {
      const [x, y] = at(bar.place);
      const disc = element("circle", { cx: x, cy: y, r: 6 + 18 * Math.sqrt(Math.abs(bar.growth) / most), class: look(bar), "data-of": bar.name });
      svg.append(disc, element("text", { x, y: y + 7, "text-anchor": "middle" }));
      svg.lastChild.textContent = shown(bar.growth, 2);
    }
    panel.stage.append(svg);
  },
};

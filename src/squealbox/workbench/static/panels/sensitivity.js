// Which parameter to change: bars, the same as discs where the drawing names the parameter, and how far each must go.

import { drawn } from "../drawing.js";
import { button, element, make } from "../elements.js";
import { shown, typographic } from "../numbers.js";

export default {
  setup(panel) {
    panel.needs = make("p", { class: "needs controls" });
    panel.stage = make("div", { class: "drawing weighed" });
    panel.body.prepend(panel.needs);
    panel.place.append(panel.stage);
    Object.assign(panel.charts[0].margin, { left: 96, right: 48 });
  },

  draw(panel, { data, arrays }) {
    const go = ({ name, needed }) => button(`${name} ${typographic(` ${needed.told}`).trim()}`, () => panel.app.store.commit({ [name]: needed.beyond }), { title: "Put this value, and one hundredth of the way more, on the page", data: { needs: name } });
    panel.needs.replaceChildren(...data.bars.filter((bar) => bar.needed?.near).map(go));
    panel.stage.replaceChildren();
    if (!data.shapes || !data.bars.length) return;
    const { svg, at } = drawn(data, arrays.points, "Drawing of the brake, with what each parameter does");
    const most = Math.abs(data.bars[0].growth);
    for (const bar of data.bars.filter((each) => each.place)) {
      const [x, y] = at(bar.place);
      const disc = element("circle", { cx: x, cy: y, r: 6 + 18 * Math.sqrt(Math.abs(bar.growth) / most), class: bar.growth > 0 ? "b0" : "b2", "data-of": bar.name });
      svg.append(disc, element("text", { x, y: y + 7, "text-anchor": "middle" }));
      svg.lastChild.textContent = shown(bar.growth, 2);
    }
    panel.stage.append(svg);
  },
};

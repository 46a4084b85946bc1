// A target, how far production is from it, and the share of the lot that is stable over friction.

import { Chart, across, line, points, text, upright } from "../chart.js";
import { make } from "../elements.js";
import { typographic } from "../numbers.js";

const USUAL = { friction: 0.45, share: 95 };

export default {
  setup(panel) {
    panel.files.hidden = true;
    const field = (name, words, about) => {
      const input = make("input", { type: "number", "aria-label": `target: ${name}`, value: panel.chosen[name] ?? USUAL[name], ...about });
      input.addEventListener("change", () => input.checkValidity() && input.value && panel.choose({ [name]: Number(input.value) }));
      return make("label", {}, `${words} `, input);
    };
    panel.controls.append(field("friction", "friction", { min: 0.01, max: 5, step: 0.01 }), field("share", "for", { min: 1, max: 99.9, step: 0.1 }), "% stable");
    panel.charts = [new Chart(panel.body, { name: "lot", height: 150 })];
  },

  options: (panel) => ({ ...USUAL, ...panel.chosen }),

  draw(panel, { data, arrays }) {
    panel.element.dataset.met = data.met;
    panel.remark = typographic(data.words);
    panel.charts[0].draw({
      x: { label: "friction", domain: [arrays.axis[0], arrays.axis.at(-1)] },
      y: { label: "stable [%]", domain: [0, 105] },
      layers: [line(arrays.axis, arrays.curve), across(data.share), upright(data.friction), points([data.friction], [data.share]), text(data.friction, data.share - 22, "target"), ...(data.least === null ? [] : [points([data.least], [data.share], { cls: "begin" }), text(data.least, data.share - 22, "reached")])],
    });
  },
};

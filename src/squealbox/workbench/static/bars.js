// Bars to the left and right of zero, one row each, with their numbers: for few named things.

import { axis, scale, sized, ticks } from "./chart.js";
import { element, fill, make, set } from "./elements.js";
import { shown } from "./numbers.js";

const ROW = 24;

export class Bars {
  constructor(place, name) {
    this.name = name;
    this.margin = { top: 6, right: 62, bottom: 36, left: 128 };
    const put = (tag, about) => this.svg.appendChild(element(tag, about));
    this.canvas = { hidden: true };
    this.svg = element("svg", { role: "img", "aria-label": name });
    this.frame = make("div", { class: "frame" }, this.svg);
    place.append((this.figure = make("figure", { class: "chart", data: { figure: name } }, this.frame)));
    this.axis = put("g", { class: "axis" });
    this.rows = put("g");
    this.label = put("text", { class: "axis-label", "text-anchor": "middle" });
    this.legend = put("g", { class: "legend" });
    sized(this, () => this.draw(this.spec));
    this.draw({ label: "being computed", bars: [3, 2, 1].map((size) => ({ name: "…", parts: [["like", size]], sum: NaN })) });
  }

  /** spec: { label, bars: [{ name, parts: [[class, value], ...], sum }], legend: [[class, name], ...] } */
  draw(spec) {
    this.spec = spec;
    if (!this.size.width) return;
    const { top, right, bottom, left } = this.margin;
    const width = Math.max(this.size.width, 200);
    const legend = spec.legend?.length > 1 ? 18 : 0;
    const height = top + legend + ROW * Math.max(spec.bars.length, 1) + bottom;
    this.inner = { width: width - left - right, height: height - top - bottom };
    set(this.svg, { width, height, viewBox: `0 0 ${width} ${height}` });
    this.frame.style.height = `${height}px`;
    const ends = spec.bars.flatMap((bar) => stacked(bar).flatMap((part) => [part.from, part.to]));
    const x = scale([Math.min(0, ...ends), Math.max(0, ...ends) || 1], [left, left + this.inner.width]);
    set(this.axis, { transform: `translate(0,${height - bottom})` });
    axis(this.axis, x, ticks(x.ends, Math.max(2, this.inner.width / 50)), 4);
    const words = (cls, at, said, about) => ["text", { class: cls, x: at, y: 16, ...about }, said];
    const part = ({ cls, from, to }) => ["rect", { class: cls, y: 4, height: ROW - 9, x: x(Math.min(from, to)), width: Math.abs(x(to) - x(from)) }];
    const row = (bar, i) => ["g", { class: "bar", transform: `translate(0,${top + legend + ROW * i})`, "data-name": bar.name, "data-value": bar.sum },
      [...stacked(bar).map(part), words("name", left - 8, bar.name, { "text-anchor": "end" }), words("value", width - right + 6, shown(bar.sum, 3))]];
    fill(this.rows, spec.bars.map(row));
    set(this.label, { x: left + this.inner.width / 2, y: height - 5 });
    this.label.textContent = spec.label;
    const entry = ([cls, name], i) => ["g", { transform: `translate(${left - 60 + 110 * i},2)` }, [["rect", { class: cls, width: 12, height: 12, y: 2 }], ["text", { x: 17, y: 13 }, name]]];
    fill(this.legend, legend ? spec.legend.map(entry) : []);
  }
}

/** The parts of a bar one after the other, those above zero to the right and those below to the left. */
function stacked(bar) {
  let right = 0;
  let left = 0;
  return bar.parts.filter(([, value]) => value).map(([cls, value]) => {
    const from = value > 0 ? right : left;
    if (value > 0) right += value;
    else left += value;
    return { cls, from, to: from + value };
  });
}

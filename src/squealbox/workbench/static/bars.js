// Bars to the left and right of zero, one row each, with their numbers: for few named things.

import { sized } from "./chart.js";
import { shown } from "./numbers.js";

const d3 = window.d3;
const ROW = 24;

export class Bars {
  constructor(place, name) {
    this.name = name;
    this.margin = { top: 6, right: 62, bottom: 36, left: 128 };
    this.figure = d3.select(place).append("figure").attr("class", "chart").attr("data-figure", name);
    this.frame = this.figure.append("div").attr("class", "frame");
    this.canvas = { hidden: true };
    this.svg = this.frame.append("svg").attr("role", "img").attr("aria-label", name);
    this.axis = this.svg.append("g").attr("class", "axis");
    this.rows = this.svg.append("g");
    this.label = this.svg.append("text").attr("class", "axis-label").attr("text-anchor", "middle");
    this.legend = this.svg.append("g").attr("class", "legend");
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
    this.svg.attr("width", width).attr("height", height).attr("viewBox", `0 0 ${width} ${height}`);
    this.frame.style("height", `${height}px`);
    const ends = spec.bars.flatMap((bar) => stacked(bar).flatMap((part) => [part.from, part.to]));
    const x = d3.scaleLinear().domain([Math.min(0, ...ends), Math.max(0, ...ends) || 1]).range([left, left + this.inner.width]);
    this.axis.attr("transform", `translate(0,${height - bottom})`).call(d3.axisBottom(x).ticks(Math.max(2, this.inner.width / 50)).tickFormat((v) => shown(v, 4)).tickSizeOuter(0));
    const groups = this.rows.selectAll("g.bar").data(spec.bars);
    groups.exit().remove();
    const fresh = groups.enter().append("g").attr("class", "bar");
    fresh.append("text").attr("class", "name").attr("text-anchor", "end");
    fresh.append("text").attr("class", "value");
    const all = fresh.merge(groups).attr("transform", (bar, i) => `translate(0,${top + legend + ROW * i})`).attr("data-name", (bar) => bar.name).attr("data-value", (bar) => bar.sum);
    all.select("text.name").attr("x", left - 8).attr("y", 16).text((bar) => bar.name);
    all.select("text.value").attr("x", width - right + 6).attr("y", 16).text((bar) => shown(bar.sum, 3));
    const parts = all.selectAll("rect").data(stacked);
    parts.exit().remove();
    parts.enter().insert("rect", "text").merge(parts).attr("class", (part) => part.cls).attr("y", 4).attr("height", ROW - 9)
      .attr("x", (part) => x(Math.min(part.from, part.to))).attr("width", (part) => Math.abs(x(part.to) - x(part.from)));
    this.label.attr("x", left + this.inner.width / 2).attr("y", height - 5).text(spec.label);
    this.#named(legend ? spec.legend : [], left);
  }

  #named(names, left) {
    const entries = this.legend.selectAll("g").data(names);
    entries.exit().remove();
    const fresh = entries.enter().append("g");
    fresh.append("rect").attr("width", 12).attr("height", 12).attr("y", 2);
    fresh.append("text").attr("x", 17).attr("y", 13);
    const all = fresh.merge(entries).attr("transform", (entry, i) => `translate(${left - 60 + 110 * i},2)`);
    all.select("rect").attr("class", (entry) => entry[0]);
    all.select("text").text((entry) => entry[1]);
  }

  columns() {
    return [["name", this.spec.bars.map((bar) => bar.name)], [this.spec.label, this.spec.bars.map((bar) => bar.sum)]];
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

// One chart: axes, lines, areas, points and marks in SVG, drawn with D3; a picture of values on a canvas beneath.
//
//   const chart = new Chart(place, { height: 220, title: "frequency" });
//   chart.draw({ x: { label, domain }, y: { label, domain }, layers: [line(x, y, { name })] });

import { shown } from "./numbers.js";
import { shade } from "./theme.js";

const d3 = window.d3;
const MARGIN = { top: 8, right: 14, bottom: 42, left: 58 };
const WAVE = Array.from({ length: 60 }, (_, i) => [i / 59, 0.5 + 0.4 * Math.sin(i / 3) * Math.exp(-i / 60)]);
const LETTER = 7; // px a digit of the axes is wide

// What a panel's own script draws; the server's figures come with layers of these and other kinds (DRAW below).
export const line = (x, y, about = {}) => ({ kind: "line", x, y, cls: "s0", ...about });

const LIKE = {
  wave: [WAVE],
  events: [[[0, 0.3], [0.2, 0.3], [0.25, 0.6], [0.7, 0.58], [0.75, 0.3], [1, 0.3]]],
  bent: [[[0, 0.02], [0.5, 0.02]], [[0.5, 0.02], [0.42, 0.25], [0.28, 0.45], [0.2, 0.6], [0.24, 0.72], [0.5, 0.86], [1, 1]]],
};

export class Chart {
  constructor(place, { height = 230, title = "", name = "figure", margin = {}, like = "wave", awaited = "being computed" } = {}) {
    this.margin = { ...MARGIN, ...margin };
    Object.assign(this, { height, like: LIKE[like] ?? LIKE.wave, awaited: awaited || "being computed" });
    this.name = name;
    this.figure = d3.select(place).append("figure").attr("class", "chart").attr("data-figure", name);
    if (title) this.figure.append("figcaption").text(title);
    this.frame = this.figure.append("div").attr("class", "frame fills").style("height", `${height}px`);
    this.canvas = this.frame.append("canvas").node();
    this.svg = this.frame.append("svg").attr("role", "img").attr("tabindex", 0).attr("aria-label", `${title || name}; plus and minus zoom, 0 shows all`).attr("height", height);
    this.key = this.figure.append("p").attr("class", "key").attr("hidden", "");
    this.clip = `clip-${Math.random().toString(36).slice(2)}`;
    this.clipped = this.svg.append("clipPath").attr("id", this.clip).append("rect");
    this.back = this.svg.append("g").attr("clip-path", `url(#${this.clip})`);
    this.grid = this.svg.append("g").attr("class", "grid");
    this.xAxis = this.svg.append("g").attr("class", "axis");
    this.yAxis = this.svg.append("g").attr("class", "axis");
    this.front = this.svg.append("g").attr("clip-path", `url(#${this.clip})`);
    this.xLabel = this.svg.append("text").attr("class", "axis-label").attr("text-anchor", "middle");
    this.yLabel = this.svg.append("text").attr("class", "axis-label").attr("text-anchor", "middle");
    this.legend = this.svg.append("g").attr("class", "legend");
    this.reader = this.svg.append("g").attr("class", "reader").attr("display", "none");
    this.reader.append("circle").attr("r", 3.5);
    this.reader.append("text").attr("class", "reading");
    this.svg.on("mousemove", () => this.#read(d3.mouse(this.svg.node()))).on("mouseleave", () => this.#silent());
    sized(this, () => (this.spec ? this.draw(this.spec) : this.#sketch()));
  }

  /** What will stand here, until the first answer: a curve of its kind and a word of what is awaited. */
  #sketch() {
    const { width, height } = this.size;
    this.svg.attr("width", width).attr("height", height).attr("viewBox", `0 0 ${width} ${height}`);
    this.sketched ??= this.svg.append("g").attr("class", "sketch");
    this.sketched.selectAll("*").remove();
    const place = ([x, y]) => `${(width * (0.08 + 0.86 * x)).toFixed(1)},${(height * (0.86 - 0.72 * y)).toFixed(1)}`;
    for (const curve of [[[0, 1], [0, 0], [1, 0]], ...this.like]) this.sketched.append("path").attr("d", `M${curve.map(place).join("L")}`);
    this.sketched.append("text").attr("x", width / 2).attr("y", height * 0.97).text(this.awaited);
  }

  draw(given) {
    const spec = (this.spec = { ...given, layers: given.layers.filter(drawable) });
    if (!this.size.width) return; // out of sight: drawn when it is seen
    this.sketched?.remove();
    this.height = this.size.height;
    this.svg.attr("height", this.height);
    const { top, right, bottom } = this.margin;
    const left = (this.margin.left = this.#room(spec.y));
    const width = Math.max(this.size.width, 130);
    const inner = { width: width - left - right, height: this.height - top - bottom };
    this.inner = inner;
    this.svg.attr("width", width).attr("viewBox", `0 0 ${width} ${this.height}`);
    this.clipped.attr("x", left).attr("y", top).attr("width", inner.width).attr("height", inner.height);
    const zoomed = this.zoom?.of === spec.x.label + spec.y.label ? this.zoom : {};
    this.x = scale(spec.x, [left, left + inner.width], zoomed.x);
    this.y = scale(spec.y, [top + inner.height, top], zoomed.y);
    this.#axes(spec);
    const behind = spec.layers.filter((layer) => layer.kind === "band");
    const before = spec.layers.filter((layer) => layer.kind !== "band");
    this.#layers(this.back, behind);
    this.#layers(this.front, before);
    this.#named(spec.layers.filter((layer) => layer.name && layer.kind !== "band"), spec.legend);
    this.#heat(spec.heat);
    this.#keys(spec.heat);
    if (this.marked) this.#mark(...this.marked);
    this.svg.attr("data-drawn", (this.count = (this.count ?? 0) + 1));
  }

  /** Room for the label and the longest number of the upright axis. */
  #room(axis) {
    const numbers = scale(axis, [0, 1]).ticks(5).map((value) => shown(value, 5).length);
    return 30 + LETTER * Math.max(2, ...numbers);
  }

  #axes(spec) {
    const { top, bottom, left } = this.margin;
    const ticks = (axis, size) => axis.ticks(Math.max(2, Math.round(size / 70))).tickFormat((v) => shown(v, 5)).tickSizeOuter(0);
    this.xAxis.attr("transform", `translate(0,${this.height - bottom})`).call(ticks(d3.axisBottom(this.x), this.inner.width));
    this.yAxis.attr("transform", `translate(${left},0)`).call(ticks(d3.axisLeft(this.y), 1.6 * this.inner.height));
    const places = spec.heat ? [] : this.y.ticks(Math.max(2, Math.round((1.6 * this.inner.height) / 70)));
    const lines = this.grid.selectAll("line").data(places);
    lines.exit().remove();
    lines.enter().append("line").merge(lines).attr("x1", left).attr("x2", left + this.inner.width).attr("y1", this.y).attr("y2", this.y);
    this.xLabel.attr("x", left + this.inner.width / 2).attr("y", this.height - 6).text(spec.x.label);
    this.yLabel.attr("transform", `translate(14,${top + this.inner.height / 2}) rotate(-90)`).text(spec.y.label);
  }

  #layers(group, layers) {
    const nodes = group.selectAll("g.layer").data(layers);
    nodes.exit().remove();
    const all = nodes.enter().append("g").merge(nodes);
    all.attr("class", (layer) => `layer ${layer.cls}`).each((layer, i, drawn) => DRAW[layer.kind](d3.select(drawn[i]), layer, this));
  }

  #named(layers, place = "top right") {
    const [vertical, horizontal] = place.split(" ");
    const seen = new Set();
    const names = layers.filter((layer) => !seen.has(layer.name) && seen.add(layer.name));
    const entries = this.legend.selectAll("g").data(names);
    entries.exit().remove();
    const fresh = entries.enter().append("g");
    fresh.append("line").attr("x1", 0).attr("x2", 22).attr("y1", -4).attr("y2", -4);
    fresh.append("text").attr("x", 27);
    const all = fresh.merge(entries);
    const { left, top } = this.margin;
    const x = horizontal === "left" ? left + 8 : left + this.inner.width - 108;
    const first = vertical === "top" ? top + 16 : top + this.inner.height - 8 - 16 * (names.length - 1);
    all.attr("class", (layer) => `layer ${layer.cls}`).attr("transform", (layer, i) => `translate(${x},${first + 16 * i})`);
    all.select("text").text((layer) => layer.name);
  }

  #heat(heat) {
    const canvas = this.canvas;
    canvas.hidden = !heat;
    if (!heat) return;
    const { left, top } = this.margin;
    const [a, b] = this.spec.x.domain.map(this.x);
    const [c, d] = this.spec.y.domain.map(this.y);
    const clip = [top - d, b - left - this.inner.width, c - top - this.inner.height, left - a].map((room) => `${Math.max(0, room)}px`).join(" ");
    Object.assign(canvas.style, { left: `${a}px`, top: `${d}px`, width: `${b - a}px`, height: `${c - d}px`, clipPath: `inset(${clip})` });
    const colours = shade();
    if (this.coloured?.values === heat.values && this.coloured.colours === colours) return; // only the mark has moved
    this.coloured = { values: heat.values, colours };
    canvas.width = heat.columns;
    canvas.height = heat.rows;
    const { pixel } = heat.scale(); // made anew at each drawing: the colours are those of the page
    const picture = new ImageData(heat.columns, heat.rows);
    const pixels = new Uint32Array(picture.data.buffer);
    for (let j = 0; j < heat.rows; j++) {
      const from = (heat.rows - 1 - j) * heat.columns; // rows come from below
      for (let i = 0; i < heat.columns; i++) pixels[j * heat.columns + i] = pixel(heat.values[from + i]);
    }
    canvas.getContext("2d").putImageData(picture, 0, 0);
    canvas.classList.toggle("smooth", Boolean(heat.smooth));
  }

  /** What the colours of a picture mean, below it. */
  #keys(heat) {
    this.key.attr("hidden", heat ? null : "");
    const key = heat && JSON.stringify([heat.keys(), heat.words]);
    if (!heat || key === this.told) return;
    this.told = key;
    this.key.text("");
    for (const [css, words] of heat.keys()) {
      this.key.append("i").attr("class", "swatch").style("background-color", css);
      this.key.append("span").text(words);
    }
    this.key.append("span").text(` ${heat.words ?? ""}`);
  }

  /** The number nearest to the pointer: of a line or point, else of an area or the picture below. */
  #read([x, y]) {
    let best = null;
    for (const layer of this.spec?.layers ?? []) {
      const ys = { line: [layer.y], points: [layer.y], hull: [layer.low, layer.high] }[layer.kind] ?? [];
      for (const values of ys) {
        for (let i = 0; i < values.length; i++) {
          const [dx, dy] = [this.x(layer.x[i]) - x, this.y(values[i]) - y];
          const far = dx * dx + (layer.kind === "hull" ? 0 : dy * dy);
          if (far < (best?.far ?? 900)) best = { far, px: this.x(layer.x[i]), py: this.y(values[i]), words: `${layer.name ? `${layer.name}: ` : ""}${shown(layer.x[i])}, ${layer.kind === "hull" ? `${shown(layer.low[i])} to ${shown(layer.high[i])}` : shown(values[i])}` };
        }
      }
    }
    best ??= this.spec?.heat && this.#below(x, y);
    if (!best) return this.#silent();
    const right = best.px > this.margin.left + 0.6 * this.inner.width;
    this.reader.attr("display", null).attr("transform", `translate(${best.px},${best.py})`);
    this.reader.select("text").attr("x", right ? -8 : 8).attr("y", best.py < 30 ? 18 : -8).attr("text-anchor", right ? "end" : "start").text(best.words);
  }

  /** The value of the picture below a place. */
  #below(x, y) {
    const { heat, x: along, y: up } = this.spec;
    const [vx, vy] = [this.x.invert(x), this.y.invert(y)];
    const cell = (value, [low, high], count) => Math.round(((value - low) / (high - low)) * (count - 1));
    const [i, j] = [cell(vx, along.domain, heat.columns), cell(vy, up.domain, heat.rows)];
    if (!(i >= 0 && j >= 0 && i < heat.columns && j < heat.rows)) return null;
    const value = heat.values[j * heat.columns + i];
    return { px: x, py: y, words: `${shown(vx)}, ${shown(vy)}: ${heat.names?.[value] ?? `${shown(value, 3)} ${heat.unit}`}` };
  }

  /** The present design: a line, or a point on a figure over two parameters. */
  present(x, y) {
    if (this.marked?.[0] === x && this.marked[1] === y) return;
    this.marked = [x, y];
    if (this.x) this.#mark(x, y);
  }

  #mark(x, y) {
    const known = [x, y].filter((each) => typeof each === "number");
    this.here ??= this.svg.append("g").attr("clip-path", `url(#${this.clip})`);
    const mark = (this.markLayer = known.length < 2 ? { kind: "upright", x, cls: "present" } : { kind: "points", x: [x], y: [y], cls: "here big", r: 6 });
    this.#layers(this.here, [mark].filter(drawable));
    this.figure.attr("data-at", known.join(","));
  }

  /** Where the brake that moves is now. */
  mark(x, y) {
    if (!this.x) return;
    this.cursor ??= this.svg.append("circle").attr("class", "cursor").attr("r", 5);
    this.cursor.attr("cx", this.x(x)).attr("cy", this.y(y));
  }

  #silent() {
    this.reader.attr("display", "none");
  }

  /** The numbers drawn, as columns: [[name, values], ...]. */
  columns() {
    const columns = [];
    const { x, y, layers, heat } = this.spec;
    for (const [i, layer] of layers.entries()) {
      if (layer.cls === "measured") columns.push(["measured", [layer.x ?? layer.y]]);
      const name = layer.name || layer.column || `line ${i + 1}`;
      if (layer.kind === "line" || layer.kind === "points") columns.push([`${name}: ${x.label}`, layer.x], [`${name}: ${y.label}`, layer.y]);
      if (layer.kind === "path") columns.push([`${name}: ${x.label}`, layer.rings.flatMap((ring) => [...ring.map((at) => at[0]), NaN])], [`${name}: ${y.label}`, layer.rings.flatMap((ring) => [...ring.map((at) => at[1]), NaN])]);
      if (layer.kind === "hull") columns.push([`${x.label}`, layer.x], [`least ${y.label}`, layer.low], [`largest ${y.label}`, layer.high]);
    }
    if (heat) {
      const at = (axis, count, i) => axis.domain[0] + ((axis.domain[1] - axis.domain[0]) * i) / (count - 1);
      const xs = [], ys = [];
      for (let j = 0; j < heat.rows; j++) for (let i = 0; i < heat.columns; i++) xs.push(at(x, heat.columns, i)), ys.push(at(y, heat.rows, j));
      columns.unshift([x.label, xs], [y.label, ys], [heat.name, heat.values]);
    }
    return columns;
  }
}

/** Keep the size of a figure's frame, and draw when it changes: asked for while drawing, it would lay out the page each time. */
export function sized(chart, draw) {
  chart.size = { width: 0, height: 0 };
  new ResizeObserver(([{ contentRect: { width, height } }]) => {
    const grown = width !== chart.size.width || height !== chart.size.height;
    chart.size = { width, height };
    if (grown && width) draw();
  }).observe(chart.frame.node());
}

const LARGEST = 1e150; // beyond which differences and squares of an axis are no numbers

/** False for a mark whose place is no number: it would be an attribute no browser reads. */
const drawable = (layer) => ["x", "y", "from", "to"].every((name) => typeof layer[name] !== "number" || Math.abs(layer[name]) < LARGEST);

function scale(axis, range, zoomed) {
  const domain = zoomed ?? axis.domain;
  return d3.scaleLinear().domain(domain.every((end) => Math.abs(end) < LARGEST) ? domain : [0, 1]).range(range);
}

/** The span of some arrays, a little wider; `with0` keeps zero inside. */
export function span(arrays, { with0 = false, room = 0.06 } = {}) {
  let low = with0 ? 0 : Infinity;
  let high = with0 ? 0 : -Infinity;
  for (const array of arrays) {
    for (const value of array) {
      if (value < low) low = value;
      if (value > high) high = value;
    }
  }
  if (!(low <= high)) return [0, 1];
  const extra = room * (high - low) || Math.abs(high) * 0.1 || 1;
  return [low - extra, high + extra];
}

function single(group, tag) {
  const found = group.selectAll(tag).data([0]);
  group.selectAll(`:scope > :not(${tag})`).remove();
  return found.enter().append(tag).merge(found);
}

const DRAW = {
  line(group, layer, { x, y }) {
    let d = "";
    let pen = "M";
    for (let i = 0; i < layer.x.length; i++) {
      const px = x(layer.x[i]);
      const py = y(layer.y[i]);
      if (Number.isFinite(px) && Number.isFinite(py)) {
        d += `${pen}${px.toFixed(1)},${py.toFixed(1)}`;
        pen = "L";
      } else pen = "M";
    }
    single(group, "path").attr("d", d || null).attr("fill", "none");
  },
  hull(group, layer, { x, y }) {
    const up = [];
    const down = [];
    for (let i = 0; i < layer.x.length; i++) {
      const [px, top, foot] = [x(layer.x[i]), y(layer.high[i]), y(layer.low[i])].map((value) => value.toFixed(1));
      if ([px, top, foot].includes("NaN")) continue;
      up.push(`${px},${top}`);
      down.push(`${px},${foot}`);
    }
    single(group, "path").attr("class", "area").attr("d", up.length ? `M${up.join("L")}L${down.reverse().join("L")}Z` : null);
  },
  points(group, layer, { x, y }) {
    const places = Array.from(layer.x, (value, i) => [x(value), y(layer.y[i])]).filter((p) => p.every(Number.isFinite));
    group.selectAll(":scope > :not(circle)").remove();
    const dots = group.selectAll("circle").data(places);
    dots.exit().remove();
    dots.enter().append("circle").merge(dots).attr("r", layer.r).attr("cx", (p) => p[0]).attr("cy", (p) => p[1]);
  },
  across(group, layer, { y, margin, inner }) {
    single(group, "line").attr("x1", margin.left).attr("x2", margin.left + inner.width).attr("y1", y(layer.y)).attr("y2", y(layer.y));
  },
  upright(group, layer, { x, margin, inner }) {
    single(group, "line").attr("x1", x(layer.x)).attr("x2", x(layer.x)).attr("y1", margin.top).attr("y2", margin.top + inner.height);
  },
  band(group, layer, { x, margin, inner }) {
    const [a, b] = [x(layer.from), x(layer.to)];
    single(group, "rect").attr("x", Math.min(a, b)).attr("width", Math.abs(b - a)).attr("y", margin.top).attr("height", inner.height);
  },
  text(group, layer, { x, y }) {
    single(group, "text").attr("x", x(layer.x)).attr("y", y(layer.y)).attr("dx", layer.dx ?? 0).attr("dy", layer.dy ?? -6)
      .attr("text-anchor", layer.anchor ?? "middle").text(layer.words);
  },
  path(group, layer, { x, y }) {
    const d = layer.rings.map((ring) => "M" + ring.map(([a, b]) => `${x(a).toFixed(1)},${y(b).toFixed(1)}`).join("L")).join("");
    single(group, "path").attr("d", d || null).attr("fill", "none");
  },
};

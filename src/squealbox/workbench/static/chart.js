// One chart: axes, lines, areas, points and marks in SVG; a picture of values on a canvas beneath.
//
//   const chart = new Chart(place, { height: 220, title: "frequency" });
//   chart.draw({ x: { label, domain }, y: { label, domain }, layers: [{ kind: "line", x, y, cls: "s0", name }] }); // kinds: DRAW below

import { element, fill, make, set, spot } from "./elements.js";
import { raised, shown } from "./numbers.js";
import { shade } from "./theme.js";

const MARGIN = { top: 8, right: 14, bottom: 42, left: 58 };
const WAVE = Array.from({ length: 60 }, (_, i) => [i / 59, 0.5 + 0.4 * Math.sin(i / 3) * Math.exp(-i / 60)]);
const MIDDLE = { class: "axis-label", "text-anchor": "middle" };
const LETTER = 7.7; // px a digit of the axes is wide

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
    this.canvas = make("canvas");
    this.svg = element("svg", { role: "img", tabindex: 0, "aria-label": `${title || name}; plus and minus zoom, 0 shows all`, height });
    this.frame = make("div", { class: "frame fills" }, this.canvas, this.svg);
    this.frame.style.height = `${height}px`;
    this.key = make("p", { class: "key", hidden: true });
    this.figure = make("figure", { class: "chart", data: { figure: name } }, title ? make("figcaption", {}, title) : null, this.frame, this.key);
    place.append(this.figure);
    const clip = `clip-${Math.random().toString(36).slice(2)}`;
    const put = (tag, about, ...children) => this.svg.appendChild(element(tag, about, ...children));
    this.clipped = element("rect");
    put("clipPath", { id: clip }, this.clipped);
    this.back = put("g", { "clip-path": `url(#${clip})` });
    this.grid = put("g", { class: "grid" });
    this.axes = [put("g", { class: "axis" }), put("g", { class: "axis" })];
    this.front = put("g", { "clip-path": `url(#${clip})` });
    this.labels = [put("text", MIDDLE), put("text", MIDDLE)];
    this.legend = put("g", { class: "legend" });
    this.reading = element("text", { class: "reading" });
    this.reader = put("g", { class: "reader", hidden: "" }, element("circle", { r: 3.5 }), this.reading);
    this.here = put("g", { "clip-path": `url(#${clip})` });
    this.svg.addEventListener("mousemove", (event) => this.#read(spot(this.svg, event)));
    this.svg.addEventListener("mouseleave", () => this.#silent());
    sized(this, () => (this.spec ? this.draw(this.spec) : this.#sketch()));
  }

  /** What will stand here, until the first answer: a curve of its kind and a word of what is awaited. */
  #sketch() {
    const { width, height } = this.size;
    set(this.svg, { width, height, viewBox: `0 0 ${width} ${height}` });
    this.sketched ??= this.svg.appendChild(element("g", { class: "sketch" }));
    const place = ([x, y]) => `${(width * (0.08 + 0.86 * x)).toFixed(1)},${(height * (0.86 - 0.72 * y)).toFixed(1)}`;
    const curves = [[[0, 1], [0, 0], [1, 0]], ...this.like].map((curve) => ["path", { d: `M${curve.map(place).join("L")}` }]);
    fill(this.sketched, [...curves, ["text", { x: width / 2, y: height * 0.97 }, this.awaited]]);
  }

  draw(given) {
    const spec = (this.spec = { ...given, layers: given.layers.filter(drawable) });
    if (!this.size.width) return; // out of sight: drawn when it is seen
    this.sketched?.remove();
    this.height = this.size.height;
    const { top, right, bottom } = this.margin;
    const left = (this.margin.left = this.#room(spec.y));
    const width = Math.max(this.size.width, 130);
    const inner = (this.inner = { width: width - left - right, height: this.height - top - bottom });
    set(this.svg, { width, height: this.height, viewBox: `0 0 ${width} ${this.height}` });
    set(this.clipped, { x: left, y: top, width: inner.width, height: inner.height });
    const zoomed = this.zoom?.of === spec.x.label + spec.y.label ? this.zoom : {};
    this.x = scale(zoomed.x ?? spec.x.domain, [left, left + inner.width]);
    this.y = scale(zoomed.y ?? spec.y.domain, [top + inner.height, top]);
    this.#axes(spec);
    this.#layers(this.back, spec.layers.filter((layer) => layer.kind === "band"));
    this.#layers(this.front, spec.layers.filter((layer) => layer.kind !== "band"));
    this.#named(spec.layers.filter((layer) => layer.name && layer.kind !== "band"), spec.legend);
    this.#heat(spec.heat);
    this.#keys(spec.heat);
    if (this.marked) this.#mark(...this.marked);
    set(this.svg, { "data-drawn": (this.count = (this.count ?? 0) + 1) });
  }

  /** Room for the label and the longest number of the upright axis. */
  #room(axis) {
    const numbers = ticks(scale(axis.domain, [0, 1]).ends, 5).map((value) => shown(value, 5).length);
    return 32 + LETTER * Math.max(2, ...numbers);
  }

  #axes({ x, y, heat }) {
    const { top, bottom, left } = this.margin;
    const [across, up] = [[this.x, this.inner.width], [this.y, 1.6 * this.inner.height]].map(([{ ends }, size]) => ticks(ends, Math.max(2, Math.round(size / 70))));
    set(this.axes[0], { transform: `translate(0,${this.height - bottom})` });
    set(this.axes[1], { transform: `translate(${left},0)` });
    axis(this.axes[0], this.x, across, 5);
    axis(this.axes[1], this.y, up, 5, true);
    const lines = heat ? [] : up.map((value) => ["line", { x1: left, x2: left + this.inner.width, y1: this.y(value), y2: this.y(value) }]);
    fill(this.grid, lines);
    set(this.labels[0], { x: left + this.inner.width / 2, y: this.height - 6 });
    const [long, room] = [6.4 * y.label.length, this.height - 4]; // px; a long label is moved and pressed into the height
    const middle = Math.max(top + this.inner.height / 2, Math.min(long, room) / 2 + 2);
    set(this.labels[1], { transform: `translate(14,${middle}) rotate(-90)`, textLength: long > room ? room : NaN, lengthAdjust: "spacingAndGlyphs" });
    [x, y].forEach(({ label }, i) => (this.labels[i].textContent = label));
  }

  #layers(group, layers) {
    fill(group, layers.map((layer) => ["g", { class: `layer ${layer.cls}` }, DRAW[layer.kind](layer, this)]));
  }

  #named(layers, place = "top right") {
    const [vertical, horizontal] = place.split(" ");
    const names = layers.filter(({ name }, i) => layers.findIndex((each) => each.name === name) === i);
    const { left, top } = this.margin;
    const x = horizontal === "left" ? left + 8 : left + this.inner.width - 108;
    const first = vertical === "top" ? top + 16 : top + this.inner.height - 8 - 16 * (names.length - 1);
    const entry = ({ name, cls }, i) => ["g", { class: `layer ${cls}`, transform: `translate(${x},${first + 16 * i})` }, [["line", { x1: 0, x2: 22, y1: -4, y2: -4 }], ["text", { x: 27 }, name]]];
    fill(this.legend, names.map(entry));
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
    this.key.hidden = !heat;
    const key = heat && JSON.stringify([heat.keys(), heat.words]);
    if (!heat || key === this.told) return;
    this.told = key;
    const swatches = heat.keys().flatMap(([css, words]) => {
      const swatch = make("i", { class: "swatch" });
      swatch.style.backgroundColor = css;
      return [swatch, make("span", {}, words)];
    });
    this.key.replaceChildren(...swatches, ` ${heat.words ?? ""}`);
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
          if (far < (best?.far ?? 900)) best = { far, px: this.x(layer.x[i]), py: this.y(values[i]), words: `${layer.name || layer.column ? `${layer.name || layer.column}: ` : ""}${read(this.spec.x, layer.x[i])}, ${layer.kind === "hull" ? `${shown(layer.low[i])} to ${read(this.spec.y, layer.high[i])}` : read(this.spec.y, values[i])}` };
        }
      }
    }
    best ??= this.spec?.heat && this.#below(x, y);
    if (!best) return this.#silent();
    this.reader.removeAttribute("hidden");
    set(this.reader, { transform: `translate(${best.px},${best.py})` });
    this.reading.textContent = best.words;
    const length = this.reading.getComputedTextLength();
    set(this.reading, { x: best.px + 10 + length > this.size.width ? Math.max(-8 - length, 2 - best.px) : 8, y: best.py < 30 ? 18 : -8 });
  }

  /** The value of the picture below a place. */
  #below(x, y) {
    const { heat, x: along, y: up } = this.spec;
    const [vx, vy] = [this.x.invert(x), this.y.invert(y)];
    const cell = (value, [low, high], count) => Math.round(((value - low) / (high - low)) * (count - 1));
    const [i, j] = [cell(vx, along.domain, heat.columns), cell(vy, up.domain, heat.rows)];
    if (!(i >= 0 && j >= 0 && i < heat.columns && j < heat.rows)) return null;
    const [value, also] = [heat.values, heat.beside].map((values) => values?.[j * heat.columns + i]);
    const words = heat.names?.[value] ?? `${shown(value, 3)} ${heat.unit}`;
    return { px: x, py: y, words: `${read(along, vx)}, ${read(up, vy)}: ${words}${also > 0 ? `, ${shown(also)} ${heat.besideUnit}` : ""}` };
  }

  /** The present design: a line, or a point on a figure over two parameters. */
  present(x, y) {
    if (this.marked?.[0] === x && this.marked[1] === y) return;
    this.marked = [x, y];
    if (this.x) this.#mark(x, y);
  }

  #mark(x, y) {
    const known = [x, y].filter((each) => typeof each === "number");
    const mark = (this.markLayer = known.length < 2 ? { kind: "upright", x, cls: "present" } : { kind: "points", x: [x], y: [y], cls: "here big", r: 6, column: "present design" });
    this.#layers(this.here, [mark].filter(drawable));
    this.figure.dataset.at = known.join(",");
  }

  /** Where the brake that moves is now. */
  mark(x, y) {
    if (!this.x) return;
    this.cursor ??= this.svg.appendChild(element("circle", { class: "cursor", r: 5 }));
    set(this.cursor, { cx: this.x(x), cy: this.y(y) });
  }

  #silent() {
    set(this.reader, { hidden: "" });
  }
}

/** Keep the size of a figure's frame, and draw when it changes: asked for while drawing, it would lay out the page each time. */
export function sized(chart, draw) {
  chart.size = { width: 0, height: 0 };
  new ResizeObserver(([{ contentRect: { width, height } }]) => {
    const grown = width !== chart.size.width || height !== chart.size.height;
    chart.size = { width, height };
    if (grown && width) draw();
  }).observe(chart.frame);
}

/** A number of an axis with its unit. */
const read = ({ unit }, value) => `${shown(value)} ${unit && unit !== "-" ? raised(unit) : ""}`.trim();

const LARGEST = 1e150; // beyond which differences and squares of an axis are no numbers

/** False for a mark whose place is no number: it would be an attribute no browser reads. */
const drawable = (layer) => ["x", "y", "from", "to"].every((name) => typeof layer[name] !== "number" || Math.abs(layer[name]) < LARGEST);

/** The place [px] of a number, `invert` the number of a place; `ends` are the numbers at both `sides`. */
export function scale(domain, sides) {
  const ends = domain.every((end) => Math.abs(end) < LARGEST) ? domain : [0, 1];
  const by = (sides[1] - sides[0]) / (ends[1] - ends[0] || 1);
  return Object.assign((value) => sides[0] + by * ((value ?? NaN) - ends[0]), { ends, sides, invert: (px) => ends[0] + (px - sides[0]) / by });
}

/** Round numbers between two ends, about that many: 1, 2 or 5 times a power of ten apart. */
export function ticks(ends, count) {
  const [low, high] = [Math.min(...ends), Math.max(...ends)];
  const power = 10 ** Math.floor(Math.log10((high - low) / count));
  const over = (high - low) / count / power;
  const step = power * ([[Math.sqrt(50), 10], [Math.sqrt(10), 5], [Math.SQRT2, 2]].find(([least]) => over >= least)?.[1] ?? 1);
  const [first, last] = [Math.ceil(low / step - 1e-9), Math.floor(high / step + 1e-9)];
  return last >= first ? Array.from({ length: last - first + 1 }, (_, i) => Number(((first + i) * step).toPrecision(12))) : [];
}

/** An axis with its numbers, along the bottom or `upright` along the left. */
export function axis(group, scaled, places, digits, upright = false) {
  const [a, b] = scaled.sides.map((side) => side + 0.5); // px whose lines are sharp
  const tick = upright ? { x2: -6 } : { y2: 6 };
  const number = upright ? { x: -9, dy: "0.32em", "text-anchor": "end" } : { y: 9, dy: "0.71em", "text-anchor": "middle" };
  const marks = places.map((value) => {
    const at = scaled(value) + 0.5;
    return ["g", { class: "tick", transform: `translate(${upright ? `0,${at}` : `${at},0`})` }, [["line", tick], ["text", number, shown(value, digits)]]];
  });
  fill(group, [["path", { d: upright ? `M.5,${a}V${b}` : `M${a},.5H${b}` }], ...marks]);
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

const path = (d) => [["path", { d, fill: "none" }]];

const DRAW = {
  line(layer, { x, y }) {
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
    return path(d);
  },
  hull(layer, { x, y }) {
    const up = [];
    const down = [];
    for (let i = 0; i < layer.x.length; i++) {
      const [px, top, foot] = [x(layer.x[i]), y(layer.high[i]), y(layer.low[i])].map((value) => value.toFixed(1));
      if ([px, top, foot].includes("NaN")) continue;
      up.push(`${px},${top}`);
      down.push(`${px},${foot}`);
    }
    return [["path", { class: "area", d: up.length ? `M${up.join("L")}L${down.reverse().join("L")}Z` : "" }]];
  },
  points: (layer, { x, y }) => Array.from(layer.x, (value, i) => ({ cx: x(value), cy: y(layer.y[i]), r: layer.r }))
    .filter(({ cx, cy }) => Number.isFinite(cx) && Number.isFinite(cy)).map((about) => ["circle", about]),
  across: (layer, { y, margin, inner }) => [["line", { x1: margin.left, x2: margin.left + inner.width, y1: y(layer.y), y2: y(layer.y) }]],
  upright: (layer, { x, margin, inner }) => [["line", { x1: x(layer.x), x2: x(layer.x), y1: margin.top, y2: margin.top + inner.height }]],
  band(layer, { x, margin, inner }) {
    const [a, b] = [x(layer.from), x(layer.to)];
    return [["rect", { x: Math.min(a, b), width: Math.abs(b - a), y: margin.top, height: inner.height }]];
  },
  text: (layer, { x, y }) => [["text", { x: x(layer.x), y: y(layer.y), dx: layer.dx ?? 0, dy: layer.dy ?? -6, "text-anchor": layer.anchor ?? "middle" }, layer.words]],
  path: (layer, { x, y }) => path(layer.rings.map((ring) => "M" + ring.map(([a, b]) => `${x(a).toFixed(1)},${y(b).toFixed(1)}`).join("L")).join("")),
};

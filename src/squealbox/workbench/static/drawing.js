// The brake, drawn from the shapes its design makes of its parameters; it turns and grows with the parameters.

import { element, set } from "./elements.js";
import { View } from "./view.js";

const SIZE = { width: 300, height: 240 };
const HEAD = 8;
const GREEK = { "\\Omega": "Ω", "\\theta": "θ" };

export class Drawing {
  constructor(app, place) {
    this.app = app;
    this.place = place;
    this.view = new View(app, "drawing", {
      request: () => ({ state: app.store.design, options: {} }),
      draw: (frame) => this.draw(frame),
      status: (kind, frame) => {
        place.dataset.state = kind;
        app.problems(kind === "wrong" ? frame.wrong : []);
      },
    });
  }

  draw({ data, arrays }) {
    this.place.replaceChildren(drawn(data, arrays.points, "Drawing of the brake").svg);
  }
}

/** A drawing as SVG; `parts(read)` puts each point that `moves` where `read(number)` says; `at` is where that is in the picture. */
export function drawn({ shapes, box }, points, words, moves = () => true) {
  const [left, right, bottom, top] = box;
  const room = 10;
  const scale = Math.min((SIZE.width - 2 * room) / (right - left || 1), (SIZE.height - 2 * room) / (top - bottom || 1));
  const dx = (SIZE.width - scale * (right - left)) / 2;
  const dy = (SIZE.height - scale * (top - bottom)) / 2;
  const at = ([x, y]) => [dx + scale * (x - left), SIZE.height - dy - scale * (y - bottom)];
  const svg = element("svg", { viewBox: `0 0 ${SIZE.width} ${SIZE.height}`, role: "img", "aria-label": words });
  let next = 0;
  const pieces = shapes.flatMap((shape) => {
    const own = Array.from({ length: shape.count }, (_, i) => next + i);
    next += shape.count;
    const [nodes, put] = PUT[shape.kind](shape, scale);
    svg.append(...nodes);
    const piece = (read) => put(own.map((p) => at(read(p))));
    piece((p) => [points[2 * p], points[2 * p + 1]]);
    return own.some(moves) ? [piece] : [];
  });
  const parts = (read) => pieces.forEach((piece) => piece(read));
  return { svg, parts, at };
}

const known = (spot) => spot.every(Number.isFinite); // extreme values lead to places that are none

const joined = (spots) => spots.filter(known).map(([x, y]) => `${x.toFixed(1)},${y.toFixed(1)}`).join(" ");

// Each gives its nodes, and a function that puts them at the spots of its points.
const PUT = {
  line(s) {
    const node = element("polyline", { class: `stroke ${s.role}`, "stroke-width": 0.5 + 0.8 * s.width, ...(s.dashes.length ? { "stroke-dasharray": "5 3" } : {}) });
    return [[node], (spots) => node.setAttribute("points", joined(spots))];
  },
  polygon(s) {
    const node = element("polygon", { class: `solid ${s.role}` });
    return [[node], (spots) => node.setAttribute("points", joined(spots))];
  },
  circle(s, scale) {
    const node = element("circle", { r: s.radius * scale, class: `solid ${s.role}` });
    return [[node], ([[x, y]]) => set(node, { cx: x, cy: y })];
  },
  arrow(s) {
    const shaft = element("line", { class: `stroke arrow ${s.role}`, "stroke-width": 2 });
    const head = element("polygon", { class: `head ${s.role}` });
    return [[shaft, head], ([a, b]) => arrow(shaft, head, a, b)];
  },
  text(s) {
    const anchor = { left: "start", right: "end" }[s.anchor] ?? "middle";
    const nodes = s.text.split("\n").map((words) => {
      const node = element("text", { "text-anchor": anchor, class: `words ${s.role}` });
      node.append(...symbols(words));
      return node;
    });
    return [nodes, ([[x, y]]) => known([x, y]) && nodes.forEach((node, i) => node.setAttribute("transform", `translate(${x} ${y + 4 + 14 * i})`))];
  },
};

/** A shaft from a to b with a head that is never smaller than can be seen. */
export function arrow(shaft, head, a, b) {
  const length = Math.hypot(b[0] - a[0], b[1] - a[1]) || 1;
  const along = [(b[0] - a[0]) / length, (b[1] - a[1]) / length];
  const back = [b[0] - HEAD * along[0], b[1] - HEAD * along[1]];
  const side = [-along[1] * HEAD * 0.45, along[0] * HEAD * 0.45];
  set(shaft, { x1: a[0], y1: a[1], x2: back[0], y2: back[1] });
  head.setAttribute("points", joined([b, [back[0] + side[0], back[1] + side[1]], [back[0] - side[0], back[1] - side[1]]]));
}

/** `$k_1, c_1$` with its subscripts. */
function symbols(words) {
  const parts = [];
  for (const [i, piece] of words.split("$").entries()) {
    if (i % 2 === 0) {
      if (piece) parts.push(document.createTextNode(piece));
      continue;
    }
    for (const match of piece.matchAll(/(\\[A-Za-z]+|[^_\\]+)(?:_(\w))?/g)) {
      parts.push(document.createTextNode(GREEK[match[1]] ?? match[1]));
      if (!match[2]) continue;
      const low = element("tspan", { dy: 3, class: "low" });
      low.textContent = match[2];
      const back = element("tspan", { dy: -3 });
      back.textContent = "\u200a";
      parts.push(low, back);
    }
  }
  return parts;
}

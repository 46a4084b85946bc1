// The brake, drawn from the strokes the server makes of its geometry; it turns and grows with the parameters.

import { View } from "./view.js";

const SVG = "http://www.w3.org/2000/svg";
const SIZE = { width: 300, height: 240 };
const GREEK = { "\\Omega": "Ω", "\\theta": "θ" };

export class Drawing {
  constructor(app, place) {
    this.app = app;
    this.place = place;
    this.view = new View(app, "drawing", {
      request: () => ({ state: app.store.design, options: {} }),
      draw: (frame) => this.draw(frame.data),
      status: (kind, frame) => this.status(kind, frame),
    });
  }

  status(kind, frame) {
    this.place.dataset.state = kind;
    this.app.problems(kind === "wrong" ? frame.wrong : []);
  }

  draw({ strokes, box }) {
    this.place.hidden = !strokes.length;
    const [left, right, bottom, top] = box;
    const room = 10;
    const scale = Math.min((SIZE.width - 2 * room) / (right - left || 1), (SIZE.height - 2 * room) / (top - bottom || 1));
    const dx = (SIZE.width - scale * (right - left)) / 2;
    const dy = (SIZE.height - scale * (top - bottom)) / 2;
    const at = ([x, y]) => [dx + scale * (x - left), SIZE.height - dy - scale * (y - bottom)];
    const svg = element("svg", { viewBox: `0 0 ${SIZE.width} ${SIZE.height}`, role: "img", "aria-label": "Drawing of the brake" });
    for (const stroke of strokes) svg.append(...DRAW[stroke.kind](stroke, at, scale));
    this.place.replaceChildren(svg);
  }
}

const DRAW = {
  line: (s, at) => [element("polyline", { points: s.points.map((p) => at(p).join(",")).join(" "), class: `stroke ${s.role}`, "stroke-width": 0.5 + 0.8 * s.width, ...(s.dashed ? { "stroke-dasharray": "5 3" } : {}) })],
  polygon: (s, at) => [element("polygon", { points: s.points.map((p) => at(p).join(",")).join(" "), class: `solid ${s.role} ${tint(s.fill)}` })],
  circle: (s, at, scale) => {
    const [cx, cy] = at(s.at);
    return [element("circle", { cx, cy, r: s.filled ? 3 : s.radius * scale, class: s.filled ? "dot" : `solid ${s.role} ${tint(s.fill)}` })];
  },
  arrow: (s, at) => {
    const [a, b] = [at(s.start), at(s.end)];
    const length = Math.hypot(b[0] - a[0], b[1] - a[1]) || 1;
    const along = [(b[0] - a[0]) / length, (b[1] - a[1]) / length];
    const head = Math.min(8, length);
    const back = [b[0] - head * along[0], b[1] - head * along[1]];
    const side = [-along[1] * head * 0.42, along[0] * head * 0.42];
    const corners = [b, [back[0] + side[0], back[1] + side[1]], [back[0] - side[0], back[1] - side[1]]];
    return [
      element("line", { x1: a[0], y1: a[1], x2: back[0], y2: back[1], class: `stroke arrow ${s.role}`, "stroke-width": 2 }),
      element("polygon", { points: corners.map((p) => p.join(",")).join(" "), class: `head ${s.role}` }),
    ];
  },
  text: (s, at) => {
    const [x, y] = at(s.at);
    const anchor = { left: "start", right: "end" }[s.anchor] ?? "middle";
    return s.text.split("\n").map((words, i) => {
      const node = element("text", { x, y: y + 4 + 14 * i, "text-anchor": anchor, class: `words ${s.role}` });
      node.append(...symbols(words));
      return node;
    });
  },
};

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

const tint = (fill) => (fill === "#ffffff" ? "hollow" : fill === "#e6c9a8" ? "lining" : "filled");

function element(tag, about) {
  const made = document.createElementNS(SVG, tag);
  for (const [name, value] of Object.entries(about)) made.setAttribute(name, value);
  return made;
}

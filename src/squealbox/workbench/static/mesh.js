// The surface of a brake in 3-D on a canvas: drag or arrow keys turn it, wheel, + and − come nearer, Z looks along the axis.

import { shade } from "./theme.js";

const REACH = 0.09; // of its size: the largest movement shown
const SIZES = 16; // steps of colour from still to moving most
const LINED = 2500; // faces up to which their edges are drawn
const LIGHTS = 12; // and from turned away to facing
const LOOKS = {
  light: { parts: [[198, 207, 216], [188, 206, 178], [208, 190, 214]], most: [213, 94, 0], edge: "rgb(20 24 29 / 22%)", slip: "#009e73", lifted: "#14181d" },
  dark: { parts: [[104, 118, 132], [92, 120, 84], [122, 100, 130]], most: [255, 154, 77], edge: "rgb(0 0 0 / 34%)", slip: "#35c79b", lifted: "#eceff3" },
};
const KEYS = { ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, 0.1], ArrowDown: [0, -0.1] };
const START = { turn: 0.6, tilt: 0.85, near: 1 };

export class Mesh {
  /** `drawn` is called when it was turned. */
  constructor(place, drawn) {
    this.view = { ...START };
    this.canvas = document.createElement("canvas");
    Object.assign(this.canvas, { className: "mesh", tabIndex: 0 });
    this.canvas.setAttribute("role", "img");
    this.canvas.setAttribute("aria-label", "The brake in 3-D. Arrow keys turn it, plus and minus come nearer, Z looks along the axis, 0 looks as at first");
    place.replaceChildren(this.canvas);
    const move = (change) => {
      Object.assign(this.view, change);
      this.view.near = Math.min(8, Math.max(0.5, this.view.near));
      drawn();
    };
    const by = ([turn, tilt]) => move({ turn: this.view.turn + turn, tilt: this.view.tilt + tilt });
    const nearer = (times) => move({ near: this.view.near * times });
    this.canvas.addEventListener("pointerdown", (event) => this.canvas.setPointerCapture(event.pointerId));
    this.canvas.addEventListener("pointermove", (event) => event.buttons && by([event.movementX / 120, event.movementY / 120]));
    this.canvas.addEventListener("wheel", (event) => (event.preventDefault(), nearer(Math.exp(-event.deltaY / 500))), { passive: false });
    this.canvas.addEventListener("keydown", (event) => {
      const acts = { "+": () => nearer(1.15), "-": () => nearer(1 / 1.15), z: () => move({ turn: 0, tilt: 0 }), 0: () => move(START) };
      const act = KEYS[event.key] ? () => by(KEYS[event.key]) : acts[event.key.toLowerCase()];
      if (!act || event.ctrlKey || event.metaKey || event.altKey) return;
      event.preventDefault();
      act();
    });
    new ResizeObserver(drawn).observe(place);
  }

  load({ places, faces, parts, touching }, names) {
    const count = places.shape[0];
    const ends = [0, 1, 2].map((axis) => [Math.min, Math.max].map((most) => places.reduce((found, x, i) => (i % 3 === axis ? most(found, x) : found), places[axis])));
    this.middle = ends.map(([low, high]) => (low + high) / 2);
    this.size = Math.hypot(...ends.map(([low, high]) => high - low)) / 2;
    Object.assign(this, { places, parts, names, count, faces: Uint32Array.from(faces) });
    this.lone = faces[0] === faces[1];
    this.touching = Array.from({ length: touching.shape[0] }, (_, c) => { // each goes along with the nearest node
      const far = (i) => (places[3 * i] - touching[3 * c]) ** 2 + (places[3 * i + 1] - touching[3 * c + 1]) ** 2 + (places[3 * i + 2] - touching[3 * c + 2]) ** 2;
      let best = 0;
      for (let i = 1; i < count; i++) if (far(i) < far(best)) best = i;
      return best;
    });
    this.spots = new Float32Array(3 * count);
    this.order = new Float64Array(parts.length);
  }

  /** A mode (count, 3) whose largest component is 1, and the normal forces that say which contacts are lifted. */
  shape(re, im, normal) {
    Object.assign(this, { re, im, normal });
    const size = (i) => Math.hypot(re[i], im[i]);
    const moves = Array.from({ length: this.count }, (_, i) => Math.hypot(size(3 * i), size(3 * i + 1), size(3 * i + 2)));
    const most = Math.max(...moves);
    this.levels = this.parts.map((_, f) => Math.round(((SIZES - 1) * (moves[this.faces[4 * f]] + moves[this.faces[4 * f + 1]] + moves[this.faces[4 * f + 2]] + moves[this.faces[4 * f + 3]])) / 4 / most));
  }

  /** What the colours mean: [colour, words]. */
  keys() {
    const { most, slip, lifted } = this.#colours();
    return [...this.palette.map((colours, part) => [colours[LIGHTS - 1], this.names[part]]), [`rgb(${most})`, "moves most"], ...(this.touching.length ? [[slip, "contact slips"], [lifted, "lifted"]] : [])];
  }

  /** Colours of each part by movement and light, as the page is coloured now. */
  #colours() {
    if (this.shade !== shade()) {
      this.shade = shade();
      const { parts, most } = LOOKS[this.shade] ?? LOOKS.light;
      const colour = (part, k) => parts[part % parts.length].map((low, c) => ((low + (most[c] - low) * (Math.floor(k / LIGHTS) / (SIZES - 1))) * (0.5 + (0.5 * (k % LIGHTS)) / (LIGHTS - 1))).toFixed(0));
      this.palette = this.names.map((_, part) => Array.from({ length: SIZES * LIGHTS }, (_, k) => `rgb(${colour(part, k)})`));
    }
    return LOOKS[this.shade] ?? LOOKS.light;
  }

  /** One picture, at a phase [rad] of the mode. */
  draw(phase) {
    const { canvas, faces, spots, order, lone } = this;
    const [fine, wide, high] = [window.devicePixelRatio || 1, canvas.clientWidth, canvas.clientHeight];
    if (!this.re || !wide) return;
    if (canvas.width !== Math.round(fine * wide) || canvas.height !== Math.round(fine * high)) Object.assign(canvas, { width: Math.round(fine * wide), height: Math.round(fine * high) });
    const look = this.#colours();
    const pen = canvas.getContext("2d");
    pen.clearRect(0, 0, canvas.width, canvas.height);
    const scale = (0.47 * this.view.near * Math.min(canvas.width, canvas.height)) / this.size;
    this.#place(phase, scale, canvas.width / 2, canvas.height / 2);
    const [lined, seam] = [this.parts.length <= LINED, 0.7];
    let seen = 0;
    for (let f = 0; f < this.parts.length; f++) {
      const [a, b, c, d] = [3 * faces[4 * f], 3 * faces[4 * f + 1], 3 * faces[4 * f + 2], 3 * faces[4 * f + 3]];
      if (!lone && (spots[c] - spots[a]) * (spots[d + 1] - spots[b + 1]) >= (spots[c + 1] - spots[a + 1]) * (spots[d] - spots[b])) continue; // seen from within
      order[seen++] = Math.round((spots[a + 2] + spots[b + 2] + spots[c + 2] + spots[d + 2]) * 256) * 65536 + f;
    }
    pen.lineWidth = 0.6 * fine;
    pen.strokeStyle = look.edge;
    for (const key of order.subarray(0, seen).sort()) { // the farthest first
      const f = ((key % 65536) + 65536) % 65536;
      const [a, b, c, d] = [3 * faces[4 * f], 3 * faces[4 * f + 1], 3 * faces[4 * f + 2], 3 * faces[4 * f + 3]];
      const [x1, y1, z1, x2, y2, z2] = [spots[c] - spots[a], spots[c + 1] - spots[a + 1], spots[c + 2] - spots[a + 2], spots[d] - spots[b], spots[d + 1] - spots[b + 1], spots[d + 2] - spots[b + 2]];
      const flat = x1 * y2 - y1 * x2;
      const light = lone ? 1 : Math.abs(flat) / (Math.hypot(y1 * z2 - z1 * y2, z1 * x2 - x1 * z2, flat) || 1);
      pen.fillStyle = this.palette[this.parts[f]][this.levels[f] * LIGHTS + Math.round(light * (LIGHTS - 1))];
      pen.beginPath();
      if (lone) pen.arc(spots[a], spots[a + 1], 5 * fine, 0, 7);
      else {
        const [x, y] = [(spots[a] + spots[b] + spots[c] + spots[d]) / 4, (spots[a + 1] + spots[b + 1] + spots[c + 1] + spots[d + 1]) / 4];
        for (const k of [a, b, c, d]) pen.lineTo(spots[k] + (spots[k] > x ? seam : -seam), spots[k + 1] + (spots[k + 1] > y ? seam : -seam)); // no gap between two
        pen.closePath();
      }
      pen.fill();
      if (lined) pen.stroke();
    }
    this.touching.forEach((i, c) => { // seen through what hides them
      pen.fillStyle = this.normal[c] > 0 ? look.slip : look.lifted;
      pen.fillRect(spots[3 * i] - fine, spots[3 * i + 1] - fine, 2 * fine, 2 * fine);
    });
  }

  /** Where each node is in the picture, x, y and how near, at a phase of the mode. */
  #place(phase, scale, x0, y0) {
    const { places, re, im, spots, middle, view } = this;
    const [cos, sin] = [Math.cos(phase) * REACH * this.size, Math.sin(phase) * REACH * this.size];
    const [ct, st, ce, se] = [Math.cos(view.turn), Math.sin(view.turn), Math.cos(view.tilt), Math.sin(view.tilt)];
    for (let i = 0; i < places.length; i += 3) {
      const x = places[i] - middle[0] + re[i] * cos - im[i] * sin;
      const y = places[i + 1] - middle[1] + re[i + 1] * cos - im[i + 1] * sin;
      const z = places[i + 2] - middle[2] + re[i + 2] * cos - im[i + 2] * sin;
      const back = st * x + ct * y;
      spots[i] = x0 + scale * (ct * x - st * y);
      spots[i + 1] = y0 - scale * (ce * back + se * z);
      spots[i + 2] = scale * (ce * z - se * back);
    }
  }
}

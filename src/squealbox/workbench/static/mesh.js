// The surface of a brake in 3-D on a canvas: drag or arrow keys turn it, wheel, + and − come nearer, Z looks along the axis.

import { make } from "./elements.js";
import { shade } from "./theme.js";

const REACH = 0.09; // of its size: the largest movement shown
const [SIZES, LIGHTS] = [16, 12]; // steps of colour, from still to moving most and from turned away to facing
const LINED = 2500; // faces up to which their edges are drawn
const SEAM = 0.7; // px by which a face without edges laps over the next
const LOOKS = {
  light: { parts: [[198, 207, 216], [188, 206, 178], [208, 190, 214]], most: [213, 94, 0], edge: "rgb(20 24 29 / 22%)", slip: "#009e73", lifted: "#14181d" },
  dark: { parts: [[104, 118, 132], [92, 120, 84], [122, 100, 130]], most: [255, 154, 77], edge: "rgb(0 0 0 / 34%)", slip: "#35c79b", lifted: "#eceff3" },
};
const START = { turn: 0.6, tilt: 0.85, near: 1 };
const KEYS = { ArrowLeft: [-0.1, 0, 1], ArrowRight: [0.1, 0, 1], ArrowUp: [0, 0.1, 1], ArrowDown: [0, -0.1, 1], "+": [0, 0, 1.15], "-": [0, 0, 1 / 1.15] };
const VIEWS = { z: { turn: 0, tilt: 0 }, Z: { turn: 0, tilt: 0 }, 0: START };
const WORDS = "The brake in 3-D. Arrow keys turn it, plus and minus come nearer, Z looks along the axis, 0 looks as at first";

export class Mesh {
  /** `found` is the answer of the panel mesh; a mode is put in as re and im (k, 3), the largest component 1, shares (f)
   * of the largest motion, and the normal forces of the contacts; `drawn` is called when it was turned. */
  constructor(place, { arrays: { places, faces, parts, touching }, data: { names, size } }, drawn) {
    Object.assign(this, { places, parts, touching, names, size, faces: Uint32Array.from(faces), view: { ...START }, lone: faces[0] === faces[1] });
    this.spots = new Float32Array(places.length);
    this.order = new Float64Array(parts.length);
    const move = (change) => (Object.assign(this.view, change), drawn());
    const by = ([turn, tilt, nearer]) => move({ turn: this.view.turn + turn, tilt: this.view.tilt + tilt, near: Math.min(8, Math.max(0.5, this.view.near * nearer)) });
    this.canvas = make("canvas", {
      class: "mesh", tabindex: 0, role: "img", "aria-label": WORDS, title: WORDS,
      onpointerdown: ({ pointerId }) => this.canvas.setPointerCapture(pointerId),
      onpointermove: ({ buttons, movementX, movementY }) => buttons && by([movementX / 120, movementY / 120, 1]),
      onwheel: (event) => (event.preventDefault(), by([0, 0, Math.exp(-event.deltaY / 500)])),
      onkeydown: (event) => {
        if (event.ctrlKey || event.metaKey || event.altKey || !(event.key in KEYS || event.key in VIEWS)) return;
        event.preventDefault();
        event.key in KEYS ? by(KEYS[event.key]) : move(VIEWS[event.key]);
      },
    });
    place.replaceChildren(this.canvas);
    new ResizeObserver(drawn).observe(place);
  }

  /** What the colours mean, as swatches and words. */
  keys() {
    const { most, slip, lifted } = this.#colours();
    const keys = [...this.palette.map((colours, part) => [colours[LIGHTS - 1], this.names[part]]), [`rgb(${most})`, "moves most"], ...(this.touching.length ? [[slip, "contact slips"], [lifted, "lifted"]] : [])];
    return keys.flatMap(([colour, name]) => [Object.assign(make("i", { class: "swatch" }), { style: `background: ${colour}` }), `${name} `]);
  }

  /** Colours of each part by movement and light, as the page is coloured now. */
  #colours() {
    const look = LOOKS[shade()];
    if (this.look === look) return look;
    const mixed = (part, k) => look.parts[part % 3].map((low, c) => Math.round((low + ((look.most[c] - low) * Math.floor(k / LIGHTS)) / (SIZES - 1)) * (0.5 + (0.5 * (k % LIGHTS)) / (LIGHTS - 1))));
    this.palette = this.names.map((_, part) => Array.from({ length: SIZES * LIGHTS }, (_, k) => `rgb(${mixed(part, k)})`));
    return (this.look = look);
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
    this.#place(phase, (0.47 * this.view.near * Math.min(canvas.width, canvas.height)) / this.size, canvas.width / 2, canvas.height / 2);
    const lined = this.parts.length <= LINED;
    let seen = 0;
    for (let f = 0; f < this.parts.length; f++) {
      const [a, b, c, d] = [3 * faces[4 * f], 3 * faces[4 * f + 1], 3 * faces[4 * f + 2], 3 * faces[4 * f + 3]];
      if (!lone && (spots[c] - spots[a]) * (spots[d + 1] - spots[b + 1]) >= (spots[c + 1] - spots[a + 1]) * (spots[d] - spots[b])) continue; // seen from within
      order[seen++] = Math.round((spots[a + 2] + spots[b + 2] + spots[c + 2] + spots[d + 2]) * 256) * 65536 + f;
    }
    Object.assign(pen, { lineWidth: 0.6 * fine, strokeStyle: look.edge });
    for (const key of order.subarray(0, seen).sort()) { // the farthest first
      const f = ((key % 65536) + 65536) % 65536;
      const corners = [3 * faces[4 * f], 3 * faces[4 * f + 1], 3 * faces[4 * f + 2], 3 * faces[4 * f + 3]];
      const [a, b, c, d] = corners;
      const [x1, y1, z1, x2, y2, z2] = [spots[c] - spots[a], spots[c + 1] - spots[a + 1], spots[c + 2] - spots[a + 2], spots[d] - spots[b], spots[d + 1] - spots[b + 1], spots[d + 2] - spots[b + 2]];
      const flat = x1 * y2 - y1 * x2;
      const light = lone ? 1 : Math.abs(flat) / (Math.hypot(y1 * z2 - z1 * y2, z1 * x2 - x1 * z2, flat) || 1);
      pen.fillStyle = this.palette[this.parts[f]][Math.round((SIZES - 1) * this.shares[f]) * LIGHTS + Math.round(light * (LIGHTS - 1))];
      pen.beginPath();
      if (lone) pen.arc(spots[a], spots[a + 1], 5 * fine, 0, 7);
      else {
        const [x, y] = [(spots[a] + spots[b] + spots[c] + spots[d]) / 4, (spots[a + 1] + spots[b + 1] + spots[c + 1] + spots[d + 1]) / 4];
        for (const k of corners) pen.lineTo(spots[k] + (spots[k] > x ? SEAM : -SEAM), spots[k + 1] + (spots[k + 1] > y ? SEAM : -SEAM));
      }
      pen.closePath();
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
    const { places, re, im, spots, view } = this;
    const [cos, sin] = [Math.cos(phase) * REACH * this.size, Math.sin(phase) * REACH * this.size];
    const [ct, st, ce, se] = [Math.cos(view.turn), Math.sin(view.turn), Math.cos(view.tilt), Math.sin(view.tilt)];
    for (let i = 0; i < places.length; i += 3) {
      const x = places[i] + re[i] * cos - im[i] * sin;
      const y = places[i + 1] + re[i + 1] * cos - im[i + 1] * sin;
      const z = places[i + 2] + re[i + 2] * cos - im[i + 2] * sin;
      const back = st * x + ct * y;
      spots[i] = x0 + scale * (ct * x - st * y);
      spots[i + 1] = y0 - scale * (ce * back + se * z);
      spots[i + 2] = scale * (ce * z - se * back);
    }
  }
}

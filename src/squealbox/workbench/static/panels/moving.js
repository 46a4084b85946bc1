// The brake in slow motion: a mode with its phases, or the last periods of the motion with stick, slip, lift-off, forces.

import { arrow, drawn } from "../drawing.js";
import { choose, element, make, set } from "../elements.js";
import { Mesh } from "../mesh.js";
import { shown, withUnit } from "../numbers.js";

const SLOW = 2.4; // s that a period of a mode takes, and a sixth of the last periods of a motion
const REACH = 0.14; // of the drawing's height: the largest movement shown
const STATES = { 0: "stick", 1: "slip", "-1": "slip", 2: "lifted" };
const FORCE = 0.28; // of the height: the arrow of the largest force
const [MOVING, RARE] = [400, 28]; // ms after a change, and ms between pictures then
const still = matchMedia("(prefers-reduced-motion: reduce)");

export default {
  setup(panel) {
    panel.files.hidden = true;
    panel.pick = make("span");
    panel.play = make("button", { type: "button", onclick: () => hold(panel) }, "Pause");
    panel.controls.append(panel.pick, panel.play);
    panel.stage = make("div", { class: "drawing moving" });
    panel.legend = make("p", { class: "states" });
    panel.body.append(panel.stage, panel.legend);
    panel.charts = [];
    hold(panel, still.matches);
    still.addEventListener("change", () => hold(panel, still.matches));
    panel.app.addEventListener("motion", () => scene(panel));
    panel.app.addEventListener("played", ({ detail }) => played(panel, detail));
    panel.app.store.addEventListener("changed", () => motionNow(panel) !== panel.moves && scene(panel));
    const step = (now) => {
      requestAnimationFrame(step);
      const wait = now - panel.app.movedAt < MOVING ? RARE : 0; // a slider moves: fewer pictures leave time for it
      const shown = !panel.element.hidden && panel.view.visible && panel.scene && !panel.held && !panel.played;
      if (shown && now - (panel.pictured ?? 0) >= wait) frame(panel, (panel.pictured = now));
    };
    requestAnimationFrame(step);
  },

  options: (panel) => ({ mode: panel.chosen.mode ?? 0 }),

  draw(panel, answer) {
    panel.answer = answer;
    const { data } = answer;
    const names = data.modes.map(([hertz, growth], i) => [String(i), `${withUnit(hertz, "Hz")}, ${shown(growth, 3)} 1/s`]);
    panel.pick.replaceChildren(...(names.length > 1 ? [choose("mode", names, String(data.mode), (mode) => panel.choose({ mode: Number(mode) }))] : []));
    if (data.mesh) return solid(panel, answer);
    panel.mesh = null;
    const { moves, points } = answer.arrays;
    const { parts, svg, at } = drawn(data, points, "The brake, moving", (p) => data.names.some((_, i) => moves[2 * (i * moves.shape[1] + p)] || moves[2 * (i * moves.shape[1] + p) + 1]));
    panel.stage.replaceChildren(svg);
    Object.assign(panel, { parts, at });
    panel.size = data.box[3] - data.box[2];
    panel.arrows = data.contacts.map((contact) => {
      const [shaft, head, dot] = [element("line", { class: "stroke force" }), element("polygon", { class: "head force" }), element("circle", { r: 5 })];
      svg.append(shaft, head, dot);
      return { contact, shaft, head, dot };
    });
    scene(panel);
  },
};

function hold(panel, held = !panel.held) {
  panel.held = held;
  panel.play.textContent = held ? "Move" : "Pause";
}

/** The surface of a finite-element brake, asked for once: only the mode is new. */
async function solid(panel, { data, arrays }) {
  const state = panel.app.store.design;
  if (panel.mesh?.base !== state.base) {
    panel.scene = panel.mesh = null;
    const found = await panel.app.connection.ask({ view: "mesh", state, options: {} }).catch(() => null);
    if (found?.kind !== "answer" || panel.answer.data !== data) return;
    panel.mesh = new Mesh(panel.stage, found, () => panel.scene && frame(panel, panel.since ?? 0));
    panel.mesh.base = state.base;
  }
  Object.assign(panel.mesh, arrays, { normal: data.normal });
  scene(panel);
}

/** The displacements of the last motion, while it is asked what happens and they are of the design on the page. */
const motionNow = ({ answer, app }) => !answer?.data.mesh && app.questions.asked === "happens" && app.motion?.arrays?.lastQ;

/** What is shown: the motion where it is asked what happens and one of this design is known, else the mode. */
function scene(panel) {
  if (!panel.answer || panel.played || (panel.answer.data.mesh && !panel.mesh)) return;
  const { data, arrays } = panel.answer;
  const { motion } = panel.app;
  const moves = (panel.moves = motionNow(panel));
  panel.pick.hidden = Boolean(moves);
  if (moves) {
    panel.scene = motionOf(panel, motion.arrays.lastQ, motion.arrays.lastForce, motion.arrays.lastState);
    panel.remark = `The last ${shown(motion.arrays.lastTime.at(-1), 3)} ${motion.clock}, over and over; movement enlarged. Arrows: normal forces.`;
  } else {
    if (!arrays.re) {
      panel.scene = null; // the design before may have moved
      panel.remark = `${data.message}.`;
      return;
    }
    const at = (share) => ({ k: 0, turn: 2 * Math.PI * share, q: Array.from(arrays.re, (re, i) => re * Math.cos(2 * Math.PI * share) - arrays.im[i] * Math.sin(2 * Math.PI * share)) });
    panel.scene = { at, period: SLOW };
    panel.remark = `${data.mode ? "A mode" : "The mode that grows first"}, ${withUnit(data.modes[data.mode][0], "Hz")}: ${data.words}`;
  }
  if (!data.mesh) enlarge(panel);
  panel.legend.hidden = !moves && !data.mesh;
  if (data.mesh) panel.legend.replaceChildren(...panel.mesh.keys());
  else if (moves) panel.legend.replaceChildren(...["slip", "stick", "lifted"].flatMap((state) => [make("i", { class: `swatch ${state}` }), `${state} `]));
  if (panel.says.textContent !== panel.remark) panel.says.textContent = panel.remark;
  frame(panel, panel.held ? (panel.since ?? 0) : performance.now()); // held, the same instant again
}

/** Motion of all freedoms (instants, freedoms) about its mean, with force and state of each contact. */
function motionOf(panel, q, force, state) {
  const many = panel.answer.data.names.length;
  const rows = q.length / many;
  const mean = new Float64Array(many);
  for (let i = 0; i < q.length; i++) mean[i % many] += q[i] / rows;
  const at = (share) => {
    const k = Math.min(Math.floor(share * rows), rows - 1);
    return { k, q: Array.from(mean, (middle, i) => q[k * many + i] - middle) };
  };
  return { at, period: 6 * SLOW, force, state };
}

/** A sound plays: the brake stands where its clock is, { share, q, force, state }; null when it is over. */
function played(panel, now) {
  if (!now) return scene(panel, (panel.played = null));
  if (panel.held || panel.element.hidden || !panel.answer || panel.answer.data.mesh || now.q.length % panel.answer.data.names.length) return;
  if (panel.played !== now.q) {
    panel.played = now.q;
    panel.scene = motionOf(panel, now.q, now.force, now.state);
    enlarge(panel);
    panel.says.textContent = "Goes along with the sound, lit as by a flash once a period, so that its vibration is seen slowly.";
  }
  frame(panel, panel.since ?? 0, now.share);
}

/** What displacements q add to a point, of the points whose moves (freedoms, points, 2) these are. */
function shift(moves, q, p) {
  let [x, y] = [0, 0];
  for (let i = 0, at = 2 * p; i < q.length; i++, at += 2 * moves.shape[1]) {
    x += q[i] * moves[at];
    y += q[i] * moves[at + 1];
  }
  return [x, y];
}

/** Enlarge so that the largest movement of a point over a period is seen well. */
function enlarge(panel) {
  const { moves } = panel.answer.arrays;
  let most = 0;
  for (let k = 0; k < 24; k++) {
    const { q } = panel.scene.at(k / 24);
    for (let p = 0; p < moves.shape[1]; p++) most = Math.max(most, Math.hypot(...shift(moves, q, p)));
  }
  panel.scale = (REACH * panel.size) / (most || 1);
}

/** One picture. */
function frame(panel, now, share = (now / 1e3 / panel.scene?.period) % 1) {
  if (!panel.scene) return;
  panel.since = now;
  panel.pictures = (panel.pictures ?? 0) + 1;
  if (panel.answer.data.mesh) return panel.mesh.draw(2 * Math.PI * share);
  const { data, arrays } = panel.answer;
  const { k, q, turn = 0 } = panel.scene.at(share);
  const { points, moves } = arrays;
  const place = (x, y, by, p) => {
    const [dx, dy] = shift(by, q, p);
    return [x + panel.scale * dx, y + panel.scale * dy];
  };
  panel.parts((p) => place(points[2 * p], points[2 * p + 1], moves, p));
  const forces = panel.scene.force;
  const contacts = panel.arrows.length;
  const mean = Math.max(...data.normal.map(Math.abs).filter(Number.isFinite), 1e-12);
  const swing = Math.max(...(arrays.pressRe ?? []).map((re, i) => Math.hypot(re, arrays.pressIm[i])), 1e-300);
  panel.arrows.forEach(({ contact, shaft, head, dot }, c) => {
    const [x, y] = place(contact[0], contact[1], arrays.contactMoves, c);
    const normal = forces ? forces[k * contacts + c] : data.normal[c] + (0.5 * mean * (arrays.pressRe[c] * Math.cos(turn) - arrays.pressIm[c] * Math.sin(turn))) / swing;
    const long = (normal * FORCE * panel.size) / (1.5 * mean);
    const [here, tail] = [panel.at([x, y]), panel.at([x - contact[2] * long, y - contact[3] * long])];
    arrow(shaft, head, tail, here);
    const state = forces ? STATES[panel.scene.state[k * contacts + c]] : "slip";
    set(dot, { cx: here[0], cy: here[1] });
    if (dot.dataset.state !== state) set(dot, { class: `contact ${state}`, "data-state": state });
  });
  if (forces && !panel.played) panel.app.dispatchEvent(new CustomEvent("cursor", { detail: k }));
}

// The verdict in words, above the figures: state, mechanism, where stability is lost, and how far that is.

import { make } from "./elements.js";
import { shown, withUnit } from "./numbers.js";
import { View } from "./view.js";

const MECHANISMS = { flutter: "mode coupling (flutter)", negative_slope: "falling friction (negative slope)", divergence: "divergence", mixed: "mode coupling and falling friction together", unknown: "not known" };
const AUDIBLE = [20, 20e3]; // Hz
const UNDAMPED = 1e-9; // damping ratio below which what is left is round-off

export class Verdict {
  constructor(app, place) {
    Object.assign(this, { app, place });
    this.view = new View(app, "verdict", {
      request: () => this.#request(),
      draw: (frame) => this.draw(frame.data),
      status: (kind) => (place.dataset.state = kind === "progress" ? "waiting" : kind),
    });
  }

  #request() {
    const locus = this.app.panels.get("locus");
    if (!this.app.store.sheet || !locus) return null;
    const parameter = locus.parameter("parameter", "friction.static");
    return { state: this.app.store.design, options: { parameter, span: locus.span(parameter) } };
  }

  draw(data) {
    this.data = data;
    const place = this.place;
    const beside = this.#beside();
    place.dataset.verdict = beside ? "beside" : data.state;
    place.replaceChildren(make("p", { class: "state" }, headline(data), beside ? ", but a push can start a vibration that stays" : ""), make("p", { class: "why" }, ...why(data)), make("p", { class: "quiet" }, caveats(data)));
    this.amplitude();
  }

  /** Has a limit cycle been found beside the stable sliding of this design? */
  #beside() {
    const { beside, store } = this.app;
    if (!beside?.current() || this.data.state !== "stable") return false;
    const value = store.value(beside.axis.parameter) / beside.axis.factor;
    return beside.together.some(([low, high]) => value >= low && value <= high);
  }

  /** What the motion panel found, while it belongs to the same design. */
  amplitude() {
    const { motion } = this.app;
    this.place.querySelector(".heard")?.remove();
    if (!motion || !this.data) return;
    const words = make("p", { class: "heard", title: motion.loud?.assumption ?? "" }, `In time: ${motion.text} `, ...loud(motion));
    this.place.insertBefore(words, this.place.lastChild);
  }
}

/** The estimate of the sound level with what it rests on; a motion that dies away has none. */
function loud({ fate, loud: found }) {
  if (!found || fate === "decays" || fate === "not_decided") return [];
  if (found.level === null || found.level < 0) return ["Nothing of it can be heard."];
  const level = make("b", {}, `about ${Math.round(found.weighted)} dB(A) at 1 m`);
  const until = fate === "grows" ? " at the end of the run, and rising" : "";
  return [`Sound of ${found.of}: `, level, `${until}, an estimate: ${shown(1e4 * found.area)} cm² moving as a whole; a real brake may be 10 dB louder or quieter.`];
}

function headline(data) {
  if (data.state === "unknown") return "No steady sliding";
  if (data.state === "stable") return "Steady sliding is stable";
  if (data.mechanism === "divergence") return "Unstable: it moves away without vibrating";
  const heard = data.frequency >= AUDIBLE[0] && data.frequency <= AUDIBLE[1];
  return `Unstable: it will ${heard ? "squeal" : "vibrate"} at about ${withUnit(data.frequency, "Hz")}`;
}

function why(data) {
  if (data.state === "unknown") return [`${data.reason}.`];
  const words = [];
  if (data.state === "unstable") {
    const several = data.modes > 1 ? `${data.modes} modes grow, the fastest` : "One mode grows,";
    words.push(`${several} at ${shown(data.growth)} 1/s by ${MECHANISMS[data.mechanism] ?? data.mechanism}${shares(data)}. `);
  } else if (Math.abs(data.damping) < UNDAMPED) words.push(`A mode at ${withUnit(data.frequency, "Hz")} neither grows nor decays: nothing in the model damps it. `);
  else words.push(`The least damped mode decays at ${shown(-data.growth)} 1/s, at ${withUnit(data.frequency, "Hz")} (damping ratio ${shown(data.damping, 3)}). `);
  return [...words, ...margin(data)];
}

function shares(data) {
  if (data.flutterShare === null || data.mechanism === "divergence") return "";
  return `, ${Math.round(100 * data.flutterShare)} % of what feeds it from circulation`;
}

function margin(data) {
  const { axis, value } = data;
  const unit = axis.unit ? ` ${axis.unit}` : "";
  const changes = data.crossings.filter((each) => each.changes);
  const read = (x) => `${shown(x / axis.factor, 5)}${unit}`;
  if (!changes.length) return [`Over ${axis.parameter} from ${read(data.span[0])} to ${read(data.span[1])} that does not change.`];
  if (value === null) return [`Critical ${axis.parameter}: ${changes.map((each) => read(each.value)).join(", ")}.`];
  const near = changes.reduce((a, b) => (Math.abs(b.value - value) < Math.abs(a.value - value) ? b : a));
  const away = value ? ` (${shown((100 * (near.value - value)) / Math.abs(value), 3)} %)` : "";
  const way = near.value >= value ? "above" : "below";
  return [
    "Stability changes at ",
    make("b", {}, `${axis.parameter} = ${read(near.value)}`),
    `, ${read(Math.abs(near.value - value))} ${way} the present ${read(value)}${away}, by ${MECHANISMS[near.mechanism] ?? near.mechanism}${near.mechanism === "divergence" ? "" : ` at ${withUnit(near.frequency, "Hz")}`}.`,
    changes.length > 1 ? ` It changes ${changes.length} times in this range.` : "",
  ];
}

function caveats(data) {
  const words = data.pulled?.length ? [`${data.pulled.map(([name, force]) => `${name} is pulled (${withUnit(force, "N")})`).join(", ")}: a contact that cannot pull would lift off.`] : [];
  words.push("Linear and about steady sliding: it says whether squeal can start, not how loud it gets; stable sliding can still squeal after a push.");
  if (data.near) words.push("Two modes nearly merge here: growth rate and shares react strongly to small changes.");
  return words.join(" ");
}

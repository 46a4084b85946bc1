// The verdict in words, above the figures: state, mechanism, where stability is lost, and how far that is.

import { make } from "./elements.js";
import { shown } from "./numbers.js";
import { View } from "./view.js";

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
    return { state: this.app.store.design, options: locus.request()?.options ?? {} };
  }

  draw(data) {
    this.data = data;
    const place = this.place;
    const beside = this.#beside();
    place.dataset.verdict = beside ? "beside" : data.state;
    place.replaceChildren(make("p", { class: "state" }, data.headline, beside ? ", but a push can start a vibration that stays" : ""), make("p", { class: "why" }, ...data.why.map((each) => (typeof each === "string" ? each : make("b", {}, each[0])))), make("p", { class: "quiet" }, data.caveats));
    this.amplitude();
  }

  /** Has a limit cycle been found beside the stable sliding of this design? */
  #beside() {
    const { beside, store } = this.app;
    if (!beside?.current() || this.data.state !== "stable") return false;
    const value = store.value(beside.parameter) / beside.factor;
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

// A panel that computes only when it is asked to: it remembers for which design that was, and says when it is another.

import { note } from "./elements.js";

export class Asked {
  /** `state()` is what of the design the panel depends on; `words` says what to press. */
  constructor(panel, words, state = () => panel.app.store.design) {
    Object.assign(this, { panel, words, state, wanted: null });
    panel.element.dataset.state = "idle";
    panel.says.textContent = words;
    panel.app.store.addEventListener("changed", () => this.#look());
  }

  get key() {
    return JSON.stringify(this.state());
  }

  /** True while the page still shows the design that was asked for. */
  get current() {
    return this.wanted !== null && this.wanted === this.key;
  }

  ask() {
    if (!this.panel.app.ready) return note("The server does not answer. Press again when it does.");
    this.wanted = this.key;
    this.panel.view.forget();
    this.panel.view.visible = true;
    this.panel.view.update();
  }

  #look() {
    if (this.wanted === null || this.current) return;
    this.panel.element.dataset.state = "stale";
    this.panel.says.textContent = `Of an earlier design. ${this.words}`;
  }
}

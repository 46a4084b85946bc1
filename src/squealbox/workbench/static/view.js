// A view asks the server for what it shows. One question is under way at a time, the newest follows; an answer is drawn
// only while the design and options it was asked for are still those of the page.

import { Disconnected } from "./connection.js";

export class View {
  /** name; request() -> { state, options } or null; draw(frame); status(kind, text) */
  constructor(app, name, { request, draw, status, slow = false }) {
    Object.assign(this, { app, name, request, draw, status, slow });
    this.stopping = false; // the user pressed Stop
    this.asked = null; // the key of the question under way
    this.drawn = null; // the key of what is drawn
    this.visible = true;
    this.outcome = ["waiting", null]; // of the question last answered
  }

  get busy() {
    return this.asked !== null;
  }

  /** Something may have changed: ask if what is drawn is no longer right; out of sight only where `unseen` says so. */
  update(unseen = false) {
    this.unseen = unseen; // asked out of sight: so is what follows it
    if (!(this.visible || unseen) || !this.app.ready) return;
    const question = this.request();
    if (!question) return;
    const key = JSON.stringify(question);
    if (key === this.drawn) {
      this.status(...this.outcome); // back at what is drawn, or at what was found wrong with it
      return;
    }
    this.status("waiting");
    if (this.asked === null) this.#ask(question, key);
    else if (this.slow && key !== this.asked) this.#end();
  }

  /** What is drawn may be that of an older design: say so until it is asked for. */
  stale() {
    if (!this.visible) return;
    const question = this.request();
    if (question && JSON.stringify(question) !== this.drawn) this.status("waiting");
  }

  /** Stop a slow computation; the panel stays as it is until something changes. */
  stop() {
    this.stopping = this.asked !== null;
    if (this.asked !== null) this.#end();
  }

  #end() {
    this.app.connection.ask({ ask: "stop", view: this.name }).catch(() => {}); // the server is gone, and its work too
  }

  forget() {
    this.drawn = null;
  }

  /** The server is gone: what is drawn is kept, and is pale from the first change on. */
  lost() {
    this.asked = null;
  }

  #ask(question, key) {
    this.asked = key;
    this.app.connection
      .ask({ view: this.name, ...question }, (progress) => {
        this.slow = true; // a newer question need not wait for it
        this.status("progress", progress);
      })
      .then((frame) => this.#answered(frame, key))
      .catch((error) => {
        if (!(error instanceof Disconnected)) throw error;
        this.asked = null; // the page asks again when the server is back
      });
  }

  #answered(frame, key) {
    this.asked = null;
    const stopped = this.stopping;
    this.stopping = false;
    const current = this.request();
    const wanted = current && JSON.stringify(current) === key;
    if (frame.kind === "unknown_base") {
      this.app.reopen();
      return;
    }
    if (wanted && frame.kind === "answer") {
      this.drawn = key;
      this.app.ahead(this.name); // what waits for it is computed while it is drawn
      this.draw(frame);
      this.outcome = ["drawn", null];
      this.status("drawn");
      this.app.painted(this.name, key);
    } else if (wanted && frame.kind !== "superseded" && (stopped || frame.kind !== "stopped")) {
      this.drawn = key;
      this.outcome = [frame.kind, frame];
      this.status(frame.kind, frame);
    }
    this.app.answered(this.name);
    if (this.drawn !== key) this.update(this.unseen); // a newer question, or this one again where it was stopped for another
  }
}

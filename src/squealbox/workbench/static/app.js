// The page as a whole: what the server offers, the state, the views, and the buttons above.

import { Connection } from "./connection.js";
import { Drawing } from "./drawing.js";
import { make, note } from "./elements.js";
import { download } from "./export.js";
import { typographic } from "./numbers.js";
import { Opener } from "./opener.js";
import { Panel } from "./panel.js";
import { Parameters } from "./parameters.js";
import { Questions } from "./questions.js";
import { Store, same } from "./store.js";
import { chooseTheme, nextTheme } from "./theme.js";
import { Verdict } from "./verdict.js";

const LEADING = ["locus", "map", "motion"]; // the views whose pace a moving slider keeps, where they are on the screen
const QUIET = 40; // ms without a change after which the other views are asked
const PATIENCE = 250; // ms they wait at most while a slider moves
const LATE = 1000; // ms they wait for a leading view that is slow
const AT_FIRST = 5000; // and before it has been drawn at all: one figure early is more than seven late
const TOLD = "motion"; // the view whose answer is part of the verdict, also while it is out of sight
const REST = 600; // ms without a change after which it is asked then

class App extends EventTarget {
  constructor() {
    super();
    this.connection = new Connection();
    this.store = new Store();
    this.panels = new Map();
    this.views = [];
    this.ready = false;
    this.lastMotion = null;
    this.measured = {};
    this.parameters = new Parameters(this, byId("fields"));
    this.drawing = new Drawing(this, byId("drawing"));
    this.verdict = new Verdict(this, byId("verdict"));
    this.views.push(this.drawing.view, this.verdict.view);
    this.opener = new Opener(this);
    this.questions = new Questions(this, byId("questions"), byId("panels"));
    this.store.busy = () => this.#leading()?.busy ?? false;
    this.store.addEventListener("changed", (event) => this.#changed(event.detail?.fields));
    this.store.addEventListener("history", () => this.#history());
    this.connection.addEventListener("hello", (event) => this.#hello(event.detail));
    this.connection.addEventListener("lost", () => this.#lost());
    this.#buttons();
  }

  /** The name of files: design and date are left out, so that equal figures have equal names. */
  stem() {
    return this.store.design.base ? (this.store.names.get(this.store.design.base) ?? "design") : this.store.design.brake.replaceAll("_", "-");
  }

  /** A view was drawn: tell who waits for it, once the frame with it has been painted. */
  painted(name, key) {
    requestAnimationFrame(() => setTimeout(() => this.dispatchEvent(new CustomEvent("painted", { detail: { name, key, at: performance.now() } }))));
  }

  /** The leading view is about to be drawn: the drawing and the verdict, which follow it, are asked meanwhile. */
  ahead(name) {
    if (name !== this.#leading().name) return;
    this.drawing.view.update();
    this.verdict.view.update();
  }

  /** A view was answered and drawn: what was gathered meanwhile can go, what waits for it is asked. */
  answered(name) {
    if (name === this.#leading().name) {
      this.store.answered();
      this.ahead(name);
    }
    if (this.changedAt && !this.verdict.view.busy) this.#later();
  }

  /** The view that a moving slider waits for: the main figure on the screen, else the verdict. */
  #leading() {
    const main = LEADING.map((name) => this.panels.get(name)?.view).find((view) => view?.visible);
    return main ?? this.verdict.view;
  }

  /** Ask the leading view at once, the verdict after it, and the others when the slider rests or has moved for long. */
  #update() {
    const leading = this.#leading();
    leading.update();
    for (const panel of this.panels.values()) if (panel.about.slow) panel.view.update();
    for (const view of this.views) view.stale();
    this.movedAt = performance.now();
    this.changedAt ??= this.movedAt;
    if (!leading.busy) this.answered(leading.name); // nothing of it has changed
    clearTimeout(this.late);
    this.late = setTimeout(() => this.changedAt && this.#others(), leading.drawn || leading.slow ? LATE : AT_FIRST);
  }

  /** The other views, when the hand rests or has moved for long. */
  #later() {
    clearTimeout(this.later);
    const now = performance.now();
    this.later = setTimeout(() => this.#others(), Math.max(0, Math.min(QUIET - (now - this.movedAt), this.changedAt + PATIENCE - now)));
  }

  #others() {
    this.changedAt = null;
    for (const view of this.views) view.update();
    clearTimeout(this.resting);
    this.resting = setTimeout(() => this.panels.get(TOLD)?.view.update(true), REST);
  }

  /** What the motion panel found last, while it is of the design on the page. */
  get motion() {
    return this.lastMotion && same(this.lastMotion.design, this.store.design) ? this.lastMotion : null;
  }

  /** What the motion panel found goes into the verdict and onto the friction curve. */
  heard({ data, arrays }) {
    const text = typographic(data.verdict ?? data.words);
    this.lastMotion = { design: this.store.design, text, arrays, clock: data.clock, from: data.lastFrom, speeds: data.speeds, fate: data.fate, loud: data.loud };
    this.verdict.amplitude();
    this.dispatchEvent(new Event("motion"));
  }

  /** What a recording says, by quantity: it is drawn over what is computed. */
  hearing(measured) {
    if (same(this.measured, measured)) return;
    this.measured = measured;
    this.dispatchEvent(new Event("measured"));
  }

  /** What is wrong with the design: beside its field, or above all fields. */
  problems(wrong) {
    const others = this.parameters.problems(wrong);
    byId("problems").replaceChildren(...others.map((each) => make("p", {}, each.message)));
  }

  /** Read a design file's text; resolves to what is wrong with it, or nothing. */
  async open(text, wanted = () => true, name = null, files = []) {
    const beside = files.length ? crypto.randomUUID().replaceAll("-", "") : undefined;
    for (const file of files) {
      const answer = await fetch(`/beside/${beside}/${encodeURIComponent(file.name)}`, { method: "POST", body: file });
      if (!answer.ok) return [{ line: 0, field: "", message: (await answer.json().catch(() => null))?.message ?? "the server does not answer" }];
    }
    const frame = await this.connection.ask({ ask: "open", text, beside });
    if (!wanted()) return [];
    if (frame.kind === "opened") {
      for (const [panel, asked] of Object.entries(frame.settings)) this.store.settings = { ...this.store.settings, [panel]: { ...this.store.settings[panel], ...asked } };
      this.store.replace({ base: frame.base, brake: frame.brake, laws: {}, values: {} }, frame.text, name);
      return [];
    }
    return frame.wrong ?? [{ line: 0, field: "", message: frame.message }];
  }

  /** Take over what a link carries; false where it carries nothing. */
  async follow(address) {
    const carried = Store.carried(address);
    return carried !== null && this.take(carried);
  }

  /** Take over what a link or the project carries; false where that cannot be. */
  async take(carried) {
    const [laws, values, settings] = [carried.laws, carried.values, carried.settings].map((each) => (isObject(each) ? each : {}));
    let brake = String(carried.brake ?? "");
    const text = typeof carried.text === "string" ? carried.text : null;
    if (!text && !this.hello.brakes.some((each) => each.name === brake)) {
      note(`The link names a brake that is not known here: “${brake.slice(0, 40)}”.`);
      return false;
    }
    let [base, asked] = [null, {}];
    if (text) {
      const frame = await this.connection.ask({ ask: "open", text });
      if (frame.kind !== "opened") {
        note("The file in this link cannot be read here.");
        return false;
      }
      [base, asked] = [frame.base, frame.settings];
      brake ||= frame.brake;
    }
    this.store.settings = { ...asked, ...settings };
    this.store.replace({ base, brake, laws, values }, text, carried.name);
    return true;
  }

  /** The server does not know our file, as after its restart: send it again. */
  async reopen() {
    if (!this.store.text) return this.store.replace(Store.plain("drum_brake"));
    const frame = await this.connection.ask({ ask: "open", text: this.store.text });
    if (frame.kind === "opened") this.#update();
    else if (this.initial && this.store.design.base) note("The file this design came from is not open any more.");
  }

  async #hello(hello) {
    const first = !this.hello;
    this.hello = hello;
    this.ready = true;
    byId("link-state").textContent = "";
    document.body.dataset.connected = "yes";
    if (first) await this.#begin(hello);
    else if (this.store.text) await this.reopen();
    for (const view of this.views) view.forget();
    if (!first) await this.#sheet();
  }

  async #begin(hello) {
    const select = byId("brake");
    select.replaceChildren(...hello.brakes.map((brake) => make("option", { value: brake.name }, brake.title)));
    select.append(make("option", { value: "", hidden: true }, "from a file"));
    const address = location.hash;
    this.loading = this.#panels(hello.panels.filter((about) => about.questions.length)); // meanwhile the sheet is asked
    if (hello.text && !address) await this.open(hello.text, undefined, hello.name);
    else if (!(await this.follow(address))) await this.#sheet();
  }

  async #panels(shown) {
    const modules = await Promise.all(shown.map((about) => about.script && import(`./panels/${about.name}.js`)));
    shown.forEach((about, i) => {
      const panel = new Panel(this, about, modules[i]?.default ?? {});
      this.panels.set(about.name, panel);
      this.views.push(panel.view);
      byId("panels").append(panel.element);
    });
    this.questions.show();
  }

  #lost() {
    this.ready = false;
    document.body.dataset.connected = "no";
    byId("link-state").textContent = this.hello ? "the server does not answer; waiting for it" : "no connection";
    for (const view of this.views) view.lost();
  }

  async #changed(fields) {
    if (!fields) return this.#update();
    for (const view of this.views) view.stale();
    await this.#sheet();
  }

  async #sheet() {
    const { design } = this.store;
    const frame = await this.connection.ask({ ask: "sheet", state: { ...design, values: {} } }).catch(() => null);
    await this.loading;
    if (!frame || this.store.design !== design) return;
    if (frame.kind === "unknown_base") return this.reopen();
    if (frame.kind !== "sheet") return this.problems(frame.wrong ?? []);
    this.store.sheet = frame.sheet;
    byId("brake").value = design.base ? "" : design.brake;
    byId("title").textContent = frame.sheet.title;
    byId("source").textContent = frame.sheet.source ? `Source: ${frame.sheet.source}` : "";
    this.store.dispatchEvent(new Event("fields"));
    this.#update();
  }

  #history() {
    byId("undo").disabled = !this.store.past.length;
    byId("redo").disabled = !this.store.future.length;
  }

  async #save() {
    const frame = await this.connection.ask({ ask: "sheet", toml: true, state: this.store.design, settings: this.store.settings }).catch(() => null);
    if (!frame) note("Not saved: the server does not answer. Save again when it does.");
    else if (frame.toml) download(frame.toml, `${this.stem()}.toml`, "application/toml"), frame.said && note(frame.said);
    else note(frame.notWritable ?? "This design cannot be written: see what is marked.");
  }

  async #copyLink() {
    const address = `${location.origin}/${this.store.fragment()}`;
    await navigator.clipboard.writeText(address).then(
      () => note("Copied. It opens in any workbench: squealbox lab LINK, or Open…"),
      () => note(address),
    );
  }

  #buttons() {
    const on = (id, what) => byId(id).addEventListener("click", what);
    byId("brake").addEventListener("change", (event) => this.store.replace(Store.plain(event.target.value)));
    on("open", () => this.opener.show());
    on("save", () => this.#save());
    on("link", () => this.#copyLink());
    on("undo", () => this.store.undo());
    on("redo", () => this.store.redo());
    on("reset", () => this.store.replace({ ...this.store.design, laws: {}, values: {} }));
    on("theme", () => (note(`Colours: ${nextTheme()}`), this.#repaint()));
    document.addEventListener("keydown", (event) => {
      if (!(event.ctrlKey || event.metaKey) || event.key.toLowerCase() !== "z" || event.target.type === "text") return;
      event.preventDefault();
      if (event.shiftKey) this.store.redo();
      else this.store.undo();
    });
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.#repaint());
    chooseTheme();
  }

  /** Pictures hold their colours in their pixels: draw them again. */
  #repaint() {
    for (const view of this.views) view.forget();
    this.#update();
  }
}

const isObject = (value) => value !== null && typeof value === "object" && !Array.isArray(value);

const byId = (id) => document.getElementById(id);

export const app = new App();
app.connection.start();

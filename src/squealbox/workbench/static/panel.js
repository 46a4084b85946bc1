// A panel on the page: title, options, files, what is going on, and the place its module draws in.
//
// A module in panels/ exports `default { setup(panel), options(panel), draw(panel, frame) }` and, where it likes,
// `state(panel)` (what of the design it depends on) and `changed(panel)` (called at every change of the design).

import { choose, make } from "./elements.js";
import { exportCharts } from "./export.js";
import { View } from "./view.js";

const SAYS = { stopped: "stopped", wrong: "not computed: see what is marked", failed: "failed" };

export class Panel {
  constructor(app, about, module) {
    Object.assign(this, { app, about, module, name: about.name, charts: [] });
    const title = make("h2", { id: `title-${about.name}` }, about.title);
    this.controls = make("span", { class: "controls" });
    this.files = make("span", { class: "files" });
    this.says = make("p", { class: "says", role: "status", "aria-live": "polite" });
    this.body = make("div", { class: "body" });
    this.element = make(
      "section",
      { class: `panel wide-${about.columns}`, "aria-labelledby": title.id, data: { panel: about.name, state: "waiting" } },
      make("header", {}, title, this.controls, make("span", { class: "gap" }), this.files),
      this.body,
      this.says,
    );
    this.element.style.gridArea = about.name;
    this.stopper = make("button", { type: "button", class: "stop", hidden: true, onclick: () => this.view.stop() }, "Stop");
    this.view = new View(app, about.name, {
      slow: about.slow,
      request: () => this.request(),
      draw: (frame) => module.draw(this, frame),
      status: (kind, frame) => this.status(kind, frame),
    });
    for (const kind of ["png", "svg", "csv"]) {
      const save = () => exportCharts(this.charts, `${this.app.stem()}-${this.name}`, kind);
      this.files.append(make("button", { type: "button", title: `Save as ${kind.toUpperCase()}`, onclick: save }, kind.toUpperCase()));
    }
    module.setup(this);
    new IntersectionObserver((entries) => this.#seen(entries.at(-1).isIntersecting), { rootMargin: "120px" }).observe(this.element);
  }

  /** The options the user chose for this panel. */
  get chosen() {
    return this.app.store.settings[this.name] ?? {};
  }

  choose(changes) {
    this.app.store.option(this.name, changes);
  }

  /** A select among the parameters that can be varied, kept as option `name`. */
  parameterChoice(text, name, ...usual) {
    const place = make("span", { class: "parameter-choice" });
    const fill = () => {
      const varied = this.app.store.sheet?.varied ?? [];
      const value = this.parameter(name, ...usual);
      const key = JSON.stringify([varied, value]);
      if (place.dataset.key === key) return;
      place.dataset.key = key;
      place.replaceChildren(choose(text, varied.map((each) => [each, each]), value, (chosen) => this.choose({ [name]: chosen })));
    };
    this.app.store.addEventListener("changed", fill);
    this.app.store.addEventListener("fields", fill);
    this.controls.append(place);
    fill();
  }

  /** The parameter chosen as option `name`, or the first of `usual` that the design has. */
  parameter(name, ...usual) {
    const varied = this.app.store.sheet?.varied ?? [];
    const chosen = this.chosen[name];
    if (varied.includes(chosen)) return chosen;
    return usual.find((each) => varied.includes(each)) ?? varied[0];
  }

  /** The ends [SI] of an axis over a parameter: its slider's, and wide enough for the present value. */
  span(parameter) {
    const store = this.app.store;
    const field = store.field(store.sheet?.aliases[parameter]?.[0] ?? parameter);
    if (!field?.slider) return null;
    const value = store.value(parameter);
    const [low, high] = (store.design.base && this.chosen.spans?.[parameter]) || field.slider; // as the opened file asks
    return typeof value === "number" ? [Math.min(low, value), Math.max(high, value)] : [low, high];
  }

  /** On the screen of the question that is asked, or nowhere. */
  show(shown) {
    this.element.hidden = !shown;
    if (!shown) this.view.visible = false;
  }

  request() {
    if (!this.app.store.sheet) return null;
    const options = this.module.options(this);
    if (!options) return null;
    return { state: this.module.state?.(this) ?? this.app.store.design, options };
  }

  status(kind, frame) {
    this.element.dataset.state = kind === "progress" ? "waiting" : kind;
    this.element.setAttribute("aria-busy", kind === "waiting" || kind === "progress");
    if (kind === "drawn") this.says.replaceChildren(...(this.remark ? [this.remark] : []));
    else if (kind === "progress") this.says.replaceChildren(`${frame.text} … ${Math.round(100 * frame.share)} % `, this.stopper);
    else if (kind === "waiting") this.#slowly();
    else if (kind === "wrong") this.says.textContent = frame.wrong.map((each) => (each.field ? `${each.field}: ` : "") + each.message).join("; ");
    else this.says.textContent = frame?.message ?? SAYS[kind] ?? kind;
    this.stopper.hidden = !(this.view.slow && (kind === "waiting" || kind === "progress"));
  }

  #slowly() {
    clearTimeout(this.timer);
    this.timer = setTimeout(() => {
      if (this.element.dataset.state === "waiting" && !this.says.textContent.includes("%")) this.says.replaceChildren(...(this.app.ready ? ["computing … ", this.stopper] : ["the server does not answer; this is of an earlier design"]));
    }, 400);
  }

  #seen(visible) {
    this.view.visible = visible;
    if (visible) this.view.update();
  }
}

/** The state without the values of some parameters: a panel that shows them along its axes does not depend on them. */
export function stateWithout(store, ...parameters) {
  const left = new Set(parameters.flatMap((each) => store.sheet.aliases[each] ?? [each]));
  const values = Object.fromEntries(Object.entries(store.design.values).filter(([path]) => !left.has(path)));
  return { ...store.design, values };
}

// A panel on the page: title, options, files, what is going on, and the place its module draws in.
//
// What it is given comes from the server: choices in its head, figures, table, sentence. A module in panels/ adds what is its
// own: `default { setup(panel), options(panel), state(panel), more(panel, spec), draw(panel, frame) }`, each where it likes.

import { Bars } from "./bars.js";
import { Chart } from "./chart.js";
import { button, choose, make, table } from "./elements.js";
import { KINDS, exportCharts } from "./export.js";
import { resolved } from "./figures.js";
import { plain, typed, typographic } from "./numbers.js";
import { View } from "./view.js";
import { zoomable } from "./zoom.js";

const SAYS = { stopped: "stopped", wrong: "not computed: see what is marked", failed: "failed" };

export class Panel {
  constructor(app, about, module) {
    Object.assign(this, { app, about, module, name: about.name, charts: [] });
    const title = make("h2", { id: `title-${about.name}` }, about.title);
    this.controls = make("span", { class: "controls" });
    this.files = make("span", { class: "files", hidden: !about.figures.length });
    this.says = make("p", { class: "says", role: "status", "aria-live": "polite" });
    this.buttons = make("div", { class: "buttons", hidden: true });
    this.place = make("div", { class: `charts ${about.layout}` });
    this.body = make("div", { class: "body" }, this.buttons, this.place);
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
      draw: (frame) => this.draw(frame),
      status: (kind, frame) => this.status(kind, frame),
    });
    for (const choice of about.choices) this[choice.kind]?.(choice);
    for (const figure of about.figures) this.figure(figure);
    this.place.hidden = !about.figures.length;
    if (about.table) this.body.append((this.list = make("div", { class: "scroller", role: "region", tabindex: 0, "aria-label": about.table })));
    const save = ({ target }) => target.value && (exportCharts(this.charts, `${this.app.stem()}-${this.name}`, target.value), (target.value = ""));
    const kinds = [["", "Save…"], ...KINDS].map(([kind, words]) => make("option", { value: kind, hidden: !kind }, words));
    this.files.append(make("select", { "aria-label": `Save ${about.title}`, onchange: save }, ...kinds));
    module.setup?.(this);
    for (const event of ["shown", "changed"]) app.store.addEventListener(event, () => this.mark());
    app.addEventListener("measured", () => this.frame?.data.figures && this.draw(this.frame));
    new IntersectionObserver((entries) => this.#seen(entries.at(-1).isIntersecting), { rootMargin: "120px" }).observe(this.element);
  }

  /** A place for a figure, with a sketch of what will stand there. */
  figure(about) {
    const chart = about.bars ? new Bars(this.place, about.name) : new Chart(this.place, about);
    if (!about.bars) zoomable(chart, (axis, ends) => this.narrow(axis, ends));
    this.charts.push(chart);
  }

  /** The table that will stand there: its heads and names of rows. */
  like(heads, names) {
    this.list.replaceChildren(table(heads, names.map((name) => [name, ...Array(heads.length - 1).fill("…")]), { class: "numbers" }));
  }

  /** A button above the figures. */
  button(text, onclick, about = {}) {
    const made = button(text, onclick, about);
    this.buttons.hidden = false;
    this.buttons.append(made);
    return made;
  }

  /** The figures, the table and the sentence of an answer, then what the panel's own script adds. */
  draw(frame) {
    this.frame = frame;
    const { data, arrays } = frame;
    if (data.words !== undefined) this.remark = typographic(data.words);
    for (const [name, value] of Object.entries(data.marks ?? {})) this.element.dataset[name] = value ?? "";
    this.filled?.(data);
    for (const figure of data.figures ?? []) {
      const spec = figure.bars ? figure : resolved(figure, arrays, this.app.measured);
      this.charts.find((chart) => chart.name === figure.name).draw(this.module.more ? this.module.more(this, spec) : spec);
    }
    if (data.table) this.list?.replaceChildren(table(data.table.heads, data.table.rows, { class: "numbers" }));
    this.mark();
    this.module.draw?.(this, frame);
  }

  /** The present design on the figures over its parameters. */
  mark() {
    if (this.element.hidden) return;
    for (const chart of this.charts) {
      const [x, y] = [chart.spec?.x, chart.spec?.y].map((axis) => axis?.parameter && this.app.store.value(axis.parameter) / axis.factor);
      if (typeof x === "number") chart.present(x, y);
    }
  }

  /** The options the user chose for this panel. */
  get chosen() {
    return this.app.store.settings[this.name] ?? {};
  }

  choose(changes) {
    this.app.store.option(this.name, changes);
  }

  /** A select among the parameters that can be varied, kept as option `name`, and the ends of its axis. */
  over({ text, name, usual, span }) {
    const { store } = this.app;
    const place = make("span", { class: "parameter-choice" });
    const fill = () => {
      const varied = store.sheet?.varied ?? [];
      const value = this.parameter(name, ...usual);
      const field = value && this.field(value);
      const ends = field && span ? this.span(value)?.map((end) => plain(end / field.factor)) : null;
      const key = JSON.stringify([varied, value, ends, field?.unit]);
      if (place.dataset.key === key || place.contains(document.activeElement)) return;
      place.dataset.key = key;
      const end = (i) => make("input", { type: "text", size: 4, class: "end", value: ends[i], inputmode: "decimal", "aria-label": `${value} ${i ? "to" : "from"} [${field.unit || "-"}]`, title: `${i ? "Upper" : "Lower"} end of the axis; empty: the usual one`, onchange: ({ target }) => this.#typed(value, field, ends, i, target) });
      place.replaceChildren(choose(text, varied.map((each) => [each, each]), value, (chosen) => this.choose({ [name]: chosen })), ...(ends ? [end(0), "–", end(1)] : []));
    };
    for (const event of ["changed", "fields"]) store.addEventListener(event, fill);
    place.addEventListener("focusout", () => setTimeout(fill));
    this.controls.append(place);
    fill();
  }

  /** A select among words, kept as option `name`. */
  words({ text, name, options, usual, numbers, meaning }) {
    this.controls.append(choose(text, options, String(this.chosen[name] ?? usual), (value) => this.choose({ [name]: numbers ? Number(value) : value }), meaning));
  }

  /** A number to be typed, kept as option `name`. */
  number({ text, name, usual, low, high, step, meaning }) {
    const input = make("input", { type: "number", class: "end", "aria-label": `${this.name}: ${name}`, min: low, max: high, step, value: this.chosen[name] ?? usual });
    input.addEventListener("change", () => input.value && input.checkValidity() && this.choose({ [name]: input.valueAsNumber }));
    this.controls.append(make("label", { class: "choice", title: meaning }, `${text} `, input));
  }

  /** A select over the degrees of freedom of what was drawn. */
  freedom({ text }) {
    const place = make("span");
    this.controls.append(place);
    this.filled = ({ names, dof }) => {
      const key = JSON.stringify([names, dof]);
      if (!names || place.dataset.key === key) return;
      place.dataset.key = key;
      place.replaceChildren(choose(text, names.map((name, i) => [String(i), name]), String(dof), (chosen) => this.choose({ dof: Number(chosen) })));
    };
  }

  /** An end of an axis that was typed; empty, the usual one. */
  #typed(parameter, field, ends, i, input) {
    if (!input.value.trim()) return this.app.store.range(parameter, null);
    const { value, wrong } = typed(input.value, field);
    const both = ends.map(Number).with(i, value);
    if (!wrong && both[0] < both[1]) return this.app.store.range(parameter, both.map((end) => end * field.factor));
    this.says.textContent = `${parameter}: ${wrong ?? "expected a lower and a higher end"}`;
    input.value = ends[i];
  }

  field = (parameter) => this.app.store.field(this.app.store.sheet?.aliases[parameter]?.[0] ?? parameter);

  /** Other ends for an axis over a parameter, null for the usual ones; false where the axis is over none. */
  narrow(axis, ends) {
    if (!axis.parameter) return false;
    this.app.store.range(axis.parameter, ends && ends.map((end) => end * axis.factor));
    return true;
  }

  /** The parameter chosen as option `name`, or the first of `usual` that the design has. */
  parameter(name, ...usual) {
    const varied = this.app.store.sheet?.varied ?? [];
    const chosen = this.chosen[name];
    if (varied.includes(chosen)) return chosen;
    return usual.find((each) => varied.includes(each)) ?? varied[0];
  }

  /** The ends [SI] of an axis over a parameter: those chosen, or its slider's, and wide enough for the present value. */
  span(parameter) {
    const { store } = this.app;
    const field = this.field(parameter);
    if (!field?.slider) return null;
    const chosen = store.ranges[parameter];
    if (chosen) return chosen;
    const value = store.value(parameter);
    const [low, high] = field.slider;
    return typeof value === "number" ? [Math.min(low, value), Math.max(high, value)] : [low, high];
  }

  /** On the screen of the question that is asked, or nowhere. */
  show(shown) {
    this.element.hidden = !shown;
    if (!shown) this.view.visible = false;
  }

  request() {
    const { store } = this.app;
    if (!store.sheet) return null;
    const asked = {};
    const along = [];
    for (const { kind, name, usual, span, numbers, panel } of this.about.choices) {
      if (kind === "over") {
        asked[name] = this.parameter(name, ...usual);
        if (!asked[name]) return null;
        if (span) asked[span] = this.span(asked[name]);
        along.push(asked[name]);
      } else if (kind === "shared") asked[name] = store.settings[panel]?.[name];
      else if (kind === "freedom") asked.dof = this.chosen.dof ?? 0;
      else asked[name] = this.chosen[name] ?? (numbers ? Number(usual) : usual);
    }
    const own = this.module.options ? this.module.options(this) : {};
    if (!own) return null;
    const state = this.module.state?.(this) ?? (this.about.along ? stateWithout(store, ...along) : store.design);
    return { state, options: { ...asked, ...own, ...(store.units ? { units: store.units } : {}) } };
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

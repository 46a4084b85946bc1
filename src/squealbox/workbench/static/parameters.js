// The side of the page: every field of the design as a slider and a number, a choice or a friction law.

import { askNumber, make } from "./elements.js";
import { plain, raised, typed, unitsOf } from "./numbers.js";

export class Parameters {
  constructor(app, place) {
    Object.assign(this, { app, place, rows: new Map() });
    place.addEventListener("submit", (event) => event.preventDefault());
    app.store.addEventListener("fields", () => this.build());
    app.store.addEventListener("shown", () => this.show());
    app.store.addEventListener("changed", () => this.show());
  }

  build() {
    const focused = document.activeElement?.dataset.path;
    this.rows.clear();
    this.place.replaceChildren(...this.app.store.fields.map((field) => this.#row(field)));
    this.show();
    if (focused) this.place.querySelector(`[data-path="${CSS.escape(focused)}"]`)?.focus();
  }

  /** The values of the design into the fields; one that is being typed in is left alone. */
  show() {
    for (const row of this.rows.values()) row.show?.();
  }

  /** What is wrong, beside the field it belongs to; the rest is returned. */
  problems(wrong) {
    for (const row of this.rows.values()) this.#mark(row, "");
    const others = [];
    for (const each of wrong) {
      const row = this.rows.get(each.field);
      if (row) this.#mark(row, inReadUnit(each.message, this.app.store.field(each.field)));
      else others.push(each);
    }
    return others;
  }

  #mark(row, message) {
    if (row.problem.textContent === message) return;
    row.problem.textContent = message;
    row.element.classList.toggle("wrong", Boolean(message));
    for (const input of row.element.querySelectorAll("input, select")) input.setAttribute("aria-invalid", Boolean(message));
  }

  #row(field) {
    const id = `field-${field.path.replaceAll(".", "-")}`;
    const problem = make("p", { class: "problem", id: `${id}-problem`, role: "alert" });
    const name = make("label", { for: id, class: "name" }, field.path);
    const tip = make("span", { class: "tip", id: `${id}-tip`, role: "tooltip" }, ...about(field));
    const meaning = make("span", { class: "meaning" }, field.meaning || "");
    const element = make("div", { class: `row ${field.kind}`, data: { field: field.path } }, make("span", { class: "head" }, name, meaning), tip);
    const row = { element, problem };
    this.rows.set(field.path, row);
    const common = { id, "aria-describedby": `${id}-tip ${id}-problem`, data: { path: field.path } };
    if (field.kind === "number") this.#number(field, row, common);
    else if (field.kind === "choice" || field.kind === "law") this.#choice(field, row, common);
    else element.append(make("output", { ...common, class: "fixed" }, field.value));
    element.append(problem);
    return element;
  }

  #number(field, row, common) {
    const { store } = this.app;
    const factor = field.factor;
    const [low, high] = field.slider;
    const step = field.whole ? 1 : field.step / factor;
    const slider = make("input", { type: "range", "aria-label": `${field.path}, slider`, data: { slider: field.path }, min: low / factor, max: high / factor, step: field.whole ? 1 : "any" });
    const number = make("input", { ...common, type: "text", inputmode: "decimal", size: 9, placeholder: field.optional ? "left out" : "" });
    const unit = this.#unit(field);
    slider.addEventListener("input", () => store.propose({ [field.path]: nearest(slider.valueAsNumber * factor, field) }));
    slider.addEventListener("change", () => store.commit());
    slider.addEventListener("keydown", (event) => {
      const way = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1, PageUp: 25, PageDown: -25 }[event.key];
      if (!way) return;
      event.preventDefault();
      const value = slider.valueAsNumber + way * (field.whole ? Math.sign(way) : step * (event.shiftKey ? 0.1 : 1));
      store.commit({ [field.path]: nearest(Math.min(Math.max(value * factor, low), high), field) });
    });
    const take = () => {
      if (number.value.trim() === "" && field.optional) return store.commit({ [field.path]: null });
      const { value, wrong } = typed(number.value, field);
      if (wrong) return this.#mark(row, `${wrong}: expected a number in ${raised(field.range)}`);
      if (value === Number(plain((store.value(field.path) ?? NaN) / factor))) return this.#mark(row, "");
      store.commit({ [field.path]: value * factor });
    };
    number.addEventListener("change", take);
    number.addEventListener("keydown", (event) => {
      if (event.key === "Enter") take();
      const way = { ArrowUp: 1, ArrowDown: -1 }[event.key];
      if (way && typeof store.value(field.path) === "number") {
        event.preventDefault();
        store.commit({ [field.path]: nearest(store.value(field.path) + way * field.step, field) });
      }
    });
    row.show = () => {
      const value = store.value(field.path);
      const given = typeof value === "number";
      if (document.activeElement !== number || number.dataset.shown === number.value) number.value = given ? plain(value / factor) : "";
      number.dataset.shown = number.value;
      if (given) {
        if (value < low) slider.min = value / factor;
        if (value > high) slider.max = value / factor;
        slider.value = value / factor;
      }
      slider.setAttribute("aria-valuetext", given ? `${plain(value / factor)} ${field.unit}` : "left out");
      slider.classList.toggle("left-out", !given);
    };
    row.element.append(make("span", { class: "control" }, slider, number, unit));
  }

  /** The unit of a field: a choice where there are several. */
  #unit(field) {
    const units = unitsOf(field);
    if (units.length < 2) return make("span", { class: "unit" }, raised(field.unit || "-"));
    const chosen = units.some(({ name }) => name === field.unit) ? field.unit : units[0].name;
    const about = make("select", { class: "unit", "aria-label": `Unit of ${field.path}`, title: "Read and write it in another unit" });
    for (const { name, ask } of units) about.append(make("option", { value: name, selected: name === chosen }, raised(ask && name !== field.unit ? `${name}…` : name)));
    about.addEventListener("change", async () => {
      const { name, ask, factor } = units.find((each) => each.name === about.value);
      const given = ask ? await askNumber(ask) : null;
      if (ask && given === null) about.value = chosen;
      else this.app.store.unit(field.path, name, ask ? factor(given) : factor);
    });
    return about;
  }

  #choice(field, row, common) {
    const { store } = this.app;
    const select = make("select", common);
    for (const option of field.options) select.append(make("option", { value: option, title: field.titles?.[option] ?? "" }, option.replaceAll("_", " ")));
    select.addEventListener("change", () => {
      if (field.kind === "law") this.#law(field.path, select.value);
      else store.commit({ [field.path]: select.value });
    });
    row.show = () => (select.value = field.kind === "law" ? field.value : store.value(field.path));
    row.element.append(make("span", { class: "control" }, select));
  }

  /** Another law: what was changed of the old one goes, the server continues it with the new one. */
  #law(path, name) {
    const { design } = this.app.store;
    const values = {};
    for (const [each, value] of Object.entries(design.values)) if (!each.startsWith(`${path}.`)) values[each] = value;
    this.app.store.replace({ ...design, laws: { ...design.laws, [path]: name }, values });
  }
}

/** "expected a finite number in ..." with the range in the unit of the field, not in SI. */
const inReadUnit = (message, field) => (field?.kind === "number" ? message.replace(/(a finite number in ).*$/, `$1${raised(field.range)}`) : message);

/** The value rounded so that the field shows all of it. */
function nearest(value, field) {
  if (field.whole) return Math.round(value);
  const shownValue = value / field.factor;
  const digits = Math.max(0, 3 - Math.floor(Math.log10(Math.max(Math.abs(field.slider[0]), Math.abs(field.slider[1])) / field.factor)));
  return Number(shownValue.toFixed(Math.min(digits, 12))) * field.factor;
}

function about(field) {
  const parts = [];
  if (field.meaning) parts.push(make("b", {}, field.meaning));
  if (field.range) parts.push(make("span", {}, `range ${raised(field.range)}`));
  if (field.source) parts.push(make("span", {}, `source: ${field.source}`));
  if (field.titles) parts.push(...Object.entries(field.titles).map(([name, text]) => make("span", {}, `${name.replaceAll("_", " ")}: ${text}`)));
  return parts;
}

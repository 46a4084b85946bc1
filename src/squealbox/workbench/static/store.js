// The one state of the page: which design, which laws, what was changed; undo; and the link that carries it all.
//
// A design is { base, brake, laws, values }: `base` names an opened file, `values` holds only what was changed. It is
// never altered in place. Changes made while a slider moves are gathered until the leading view has answered the last
// ones, so what is drawn always belongs to the design that is shown.

const LINK = "#d=";
const REST = 300; // ms without a change after which the address follows
const LONGEST_WAIT = 150; // ms a gathered change may wait

export class Store extends EventTarget {
  constructor() {
    super();
    this.design = Store.plain("drum_brake");
    [this.texts, this.names] = [new Map(), new Map()]; // of the opened files, by base: undo and links find those of their design
    this.sheet = null;
    this.settings = {}; // options of the panels, by panel
    this.past = [];
    this.future = [];
    this.gathered = null;
    this.before = null; // the design before the gesture that is going on
    this.busy = () => false; // is the leading view still answering?
  }

  static plain = (brake) => ({ base: null, brake, laws: {}, values: {} });

  /** The text of the file the present design came from, null where it came from none. */
  get text() {
    return this.design.base ? (this.texts.get(this.design.base) ?? null) : null;
  }

  /** The fields of the design, each in the unit that was chosen for it. */
  get fields() {
    if (this.read?.sheet !== this.sheet || this.read.units !== this.units) {
      const fields = (this.sheet?.fields ?? []).map((field) => (this.units?.[field.path] ? inUnit(field, ...this.units[field.path]) : field));
      this.read = { sheet: this.sheet, units: this.units, fields };
    }
    return this.read.fields;
  }

  /** Units chosen for parameters, { path: [unit, factor] }, where there are any. */
  get units() {
    return this.settings.page?.units;
  }

  /** Ends [SI] chosen for the axes over parameters, { path: [low, high] }. */
  get ranges() {
    return this.settings.page?.ranges ?? {};
  }

  /** Other ends for the axes over a parameter, null for the usual ones. */
  range(parameter, ends) {
    this.option("page", { ranges: { ...this.ranges, [parameter]: ends ?? undefined } });
  }

  /** Another unit for a parameter, and for the alias that begins with it. */
  unit(path, unit, factor) {
    const usual = this.sheet.fields.find((field) => field.path === path).unit === unit;
    const also = Object.entries(this.sheet.aliases).filter(([, names]) => names[0] === path).map(([alias]) => alias);
    const units = { ...this.units };
    for (const each of [path, ...also]) units[each] = usual ? undefined : [unit, factor];
    this.option("page", { units: Object.values(units).some(Boolean) ? units : undefined });
    this.dispatchEvent(new Event("fields"));
  }

  field(path) {
    return this.fields.find((field) => field.path === path);
  }

  /** The value of a parameter as shown, an alias standing for its first field. */
  value(path) {
    const name = this.sheet?.aliases[path]?.[0] ?? path;
    if (this.gathered && name in this.gathered) return this.gathered[name];
    if (name in this.design.values) return this.design.values[name];
    return this.field(name)?.value;
  }

  /** A change while a gesture goes on: shown at once, computed as fast as the leading view answers. */
  propose(changes) {
    this.before ??= this.design;
    this.gathered ??= {};
    for (const [path, value] of Object.entries(changes)) {
      for (const name of this.sheet?.aliases[path] ?? [path]) this.gathered[name] = value;
    }
    this.dispatchEvent(new CustomEvent("shown"));
    this.gatheredAt ??= performance.now();
    this.#later();
  }

  /** The end of a gesture: one step for undo. */
  commit(changes = {}) {
    if (Object.keys(changes).length) this.propose(changes);
    this.#flush();
    if (this.before && !same(this.before, this.design)) {
      this.past.push(this.before);
      if (this.past.length > 200) this.past.shift();
      this.future = [];
    }
    this.before = null;
    clearTimeout(this.keeping); // the address costs as much as a figure: it follows when the hand rests
    this.keeping = setTimeout(() => this.#keepLink(), REST);
    this.dispatchEvent(new Event("history"));
  }

  /** A leading view has answered: what was gathered meanwhile can go. */
  answered() {
    if (this.gathered) this.#flush();
  }

  /** Another brake, file or law: the fields change too. */
  replace(design, text = null, name = null) {
    if (design.base && text !== null) this.texts.set(design.base, text);
    if (design.base && name) this.names.set(design.base, name);
    this.gathered = null;
    this.past.push(this.before ?? this.design);
    this.before = null;
    this.future = [];
    this.#set(design, true);
  }

  undo() {
    this.#step(this.past, this.future);
  }

  redo() {
    this.#step(this.future, this.past);
  }

  /** Options of a panel; they are part of the link, not of undo. */
  option(panel, changes) {
    this.settings = { ...this.settings, [panel]: { ...this.settings[panel], ...changes } };
    this.#keepLink();
    this.dispatchEvent(new CustomEvent("changed"));
  }

  /** What a link and the project carry: the design, the file it came from, and the options of the panels. */
  get whole() {
    const { base, brake, laws, values } = this.design;
    return { brake, laws, values, settings: this.settings, ...(base ? { text: this.text, name: this.names.get(base) } : {}) };
  }

  /** The link's part behind the #. */
  fragment() {
    return LINK + encode(JSON.stringify(this.whole));
  }

  /** What a link carries; null where it is none. */
  static carried(address) {
    const at = address.indexOf(LINK);
    if (at < 0) return null;
    try {
      const state = JSON.parse(decode(address.slice(at + LINK.length).trim()));
      return state && typeof state === "object" ? state : null;
    } catch {
      return null;
    }
  }

  /** At once while the leading view is free; else when it has answered, looked at once a frame. */
  #later() {
    if (this.frame) return;
    if (!this.busy()) {
      this.#flush();
      return;
    }
    this.frame = requestAnimationFrame(() => {
      this.frame = 0;
      if (!this.gathered) return;
      if (this.busy() && performance.now() - this.gatheredAt < LONGEST_WAIT) this.#later();
      else this.#flush();
    });
  }

  #flush() {
    if (!this.gathered) return;
    const values = { ...this.design.values, ...this.gathered };
    this.gathered = null;
    this.gatheredAt = null;
    this.#set({ ...this.design, values }, false);
  }

  #step(from, to) {
    if (!from.length) return;
    this.gathered = null;
    this.before = null;
    to.push(this.design);
    this.#set(from.pop(), true);
  }

  #set(design, fields) {
    this.design = design;
    if (fields) this.#keepLink();
    this.dispatchEvent(new CustomEvent("changed", { detail: { fields } }));
    this.dispatchEvent(new Event("history"));
  }

  #keepLink() {
    history.replaceState(null, "", location.pathname + location.search + this.fragment());
  }
}

const inUnit = (field, unit, factor) => ({ ...field, usual: field.unit, unit, factor, range: `${field.lowOpen ? "(" : "["}${end(field.low, factor, "−")}, ${end(field.high, factor, "")}${field.highOpen ? ")" : "]"} ${unit}` });
const end = (value, factor, sign) => (value === null ? `${sign}inf` : String(Number((value / factor).toPrecision(6))));

export const same = (a, b) => JSON.stringify(a) === JSON.stringify(b);

function encode(text) {
  const bytes = new TextEncoder().encode(text);
  let binary = "";
  for (const byte of bytes) binary += String.fromCharCode(byte);
  return btoa(binary).replaceAll("+", "-").replaceAll("/", "_").replaceAll("=", "");
}

function decode(text) {
  const binary = atob(text.replaceAll("-", "+").replaceAll("_", "/"));
  return new TextDecoder("utf-8", { fatal: true }).decode(Uint8Array.from(binary, (c) => c.charCodeAt(0)));
}

// The project on disk: designs side by side, notes, history and files; the page's state goes there after each gesture.

import { button, choose, make, note, table } from "../elements.js";
import { Store, same } from "../store.js";

const REST = 800; // ms without a change after which something is kept
const HEADS = ["design", "steady sliding", "worst mode", "growth 1/s", "critical µ", "margin", "saved", "note", ""];

export default {
  setup(panel) {
    const [app, { store }] = [panel.app, panel.app];
    panel.called = make("input", { type: "text", size: 12, maxlength: 80, "aria-label": "Name for the design or the state", placeholder: "name" });
    const also = make("input", { type: "checkbox", checked: Boolean(panel.chosen.results), onchange: () => panel.choose({ results: also.checked }) });
    const named = (verb) => () => act(panel, verb, { name: panel.called.value, state: store.whole });
    const recorded = ({ taken }) => (taken ? send(panel, "measurements", taken.name, taken) : note("No recording is open: drop one onto the page."));
    [panel.list, panel.past, panel.kept] = ["Designs of the project", "History", "Measurements and results"].map((words) => make("div", { class: "scroller", role: "region", tabindex: 0, "aria-label": words }));
    const [keeping, rested] = [() => keep(panel), later(() => keep(panel))];
    panel.notes = make("textarea", { "aria-label": "Notes", placeholder: "Notes: they save themselves, into notes.md", oninput: () => rested((panel.dirty = true)), onblur: keeping });
    Object.assign(panel, { stamp: Date.now(), presets: make("span"), restore: make("span") });
    panel.body.append(make("div", { class: "buttons" }, panel.called, button("Save this design", named("save")), button("Name this state", named("name")), panel.presets, button("Keep the recording", () => recorded(app.panels.get("recording"))), make("label", { title: "Figures and files that you save go into results/ too" }, also, " keep what I save"), panel.restore), make("div", { class: "project" }, panel.list, panel.notes, panel.past, panel.kept));
    panel.list.append(table(HEADS, []));
    document.addEventListener("saved", ({ detail }) => panel.chosen.results && send(panel, "results", detail.name, detail.content));
    for (const [where, news] of [[store, "changed"], [store, "history"], [app.connection, "hello"]]) where.addEventListener(news, rested);
    for (const news of ["visibilitychange", "pagehide"]) addEventListener(news, keeping);
    if (location.hash || app.hello.text) return;
    ask(panel, "left").then((left) => {
      const go = (words) => button(words, () => (place.remove(), words === "Not now" || app.take(left.state)));
      const place = make("p", { class: "offer", role: "status" }, go(`Go on where you were (${left?.title}, ${when(left?.time)})`), " ", go("Not now"));
      if (left?.state) document.getElementById("content").prepend(place);
    });
  },

  options: (panel) => ({ stamp: panel.stamp }),
  state: () => Store.plain("drum_brake"), // of the page nothing: the table is of what is on disk

  draw(panel, { data }) {
    const keys = ({ name }) => [["As A", () => asA(panel, name)], ["Delete", () => act(panel, "delete", { name })]].map(([words, what]) => button(words, what, { "aria-label": `${words}: ${name}` }));
    const opens = ({ name }) => button(name, () => take(panel, "open", { name }), { "aria-label": `Open: ${name}`, title: "Open" });
    const words = ({ name, note: text }) => make("input", { type: "text", value: text, maxlength: 2000, title: text, "aria-label": `Note on ${name}`, onchange: (event) => ask(panel, "note", { name, note: event.target.value }) });
    const state = ({ state, wrong }) => make("span", wrong ? { class: "problem", title: wrong } : {}, wrong || state);
    panel.list.replaceChildren(table(HEADS, data.rows.map((row) => [opens(row), state(row), ...row.numbers, when(1e3 * row.when), words(row), make("span", { class: "keys" }, ...keys(row))]), { class: "designs" }));
    look(panel);
  },
};

const when = (time) => new Date(time).toLocaleString("sv").slice(0, 16);
const address = (part, name) => `/project/${part}/${encodeURIComponent(name)}`;
/** A function that does `what` when its callers have rested. */
const later = (what, timer = 0) => () => (clearTimeout(timer), (timer = setTimeout(what, REST)));
const act = async (panel, verb, about) => (await ask(panel, verb, about)) && ((panel.stamp += 1), panel.view.update());
const take = async (panel, verb, about) => panel.app.take((await ask(panel, verb, about)) ?? {});

/** Ask the server; nothing, and said, where it cannot be done: at every gesture once. */
async function ask(panel, verb, about = {}) {
  const frame = await panel.app.connection.ask({ ask: "project", do: verb, ...about }).catch(() => ({ message: "The server does not answer." }));
  const news = frame.said || frame.message;
  if (news && news !== panel.said) note(news);
  panel.said = verb === "keep" ? news : null;
  return frame.kind === "project" ? frame : null;
}

async function asA(panel, name) {
  const [{ connection, store }, { text } = {}] = [panel.app, (await ask(panel, "open", { name })) ?? {}];
  const { kind, base, brake } = text ? await connection.ask({ ask: "open", text }) : {};
  if (kind === "opened") store.texts.set(base, text), store.option("compare", { a: { base, brake, laws: {}, values: {} } });
  note(kind === "opened" ? `${name} is A under “What silences it?”.` : `${name} cannot be read.`);
}

async function look(panel) {
  const found = await ask(panel, "look");
  if (!found) return;
  if (!panel.dirty) [panel.notes.value, panel.key] = [found.notes, found.key];
  const begin = async (preset) => panel.app.open((await ask(panel, "open", { preset }))?.text ?? "", undefined, preset);
  panel.presets.replaceChildren(choose("preset", [["", "choose …"], ...found.presets], "", begin));
  panel.restore.replaceChildren(...found.thrown.map(([thrown, name]) => button(`Take back ${name}`, () => act(panel, "restore", { name, thrown }))));
  panel.past.replaceChildren(table(["left at", "state", ""], found.history.map(({ time, id, title, words, name }) => [when(time), make("span", { title }, make("b", {}, name), ` ${words || title}`), button("Go back", () => take(panel, "back", { line: id }), { "aria-label": `Go back to ${name || when(time)}` })])));
  const files = (part, key) => found[part].map(({ name, size }) => [make("a", { href: address(part, name), download: name }, name), `${Math.ceil(size / 1e3)} kB`, key(name)]);
  const measure = (name) => fetch(address("measurements", name)).then((answer) => (answer.ok ? answer.blob() : Promise.reject())).then((blob) => panel.app.panels.get("recording").take(new File([blob], name)));
  const measured = (name) => button("Open", () => measure(name).catch(() => note(`${name} cannot be opened.`)), { "aria-label": `Open ${name}` });
  panel.kept.replaceChildren(table(["measurements, results", "size", ""], [...files("measurements", measured), ...files("results", () => "")]));
  panel.says.textContent = [panel.remark, `In ${found.folder}.`, ...found.wrong].join(" ");
}

async function send(panel, part, name, body) {
  const found = await fetch(address(part, name), { method: "POST", body }).then((answer) => answer.json()).catch(() => ({ message: "Not kept: the server does not answer." }));
  note(found.message ?? `Kept as ${part}/${found.name}.`);
  look(panel);
}

/** Keep notes and state when a gesture is over; not the brake a page begins with, before anything was done to it. */
async function keep(panel) {
  const { store, ready } = panel.app;
  const [state, text] = [JSON.stringify(store.whole), panel.notes.value];
  const kept = panel.dirty && ready && (await ask(panel, "notes", { text, key: panel.key }));
  if (kept) [panel.key, panel.dirty] = [kept.key, text !== panel.notes.value];
  if (!ready || store.before || state === panel.state || (!panel.state && same(store.design, Store.plain("drum_brake")))) return;
  if (await ask(panel, "keep", { state: store.whole })) panel.state = state;
  if (panel.view.visible) look(panel);
}

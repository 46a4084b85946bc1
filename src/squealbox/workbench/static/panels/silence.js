// The cures, the best first: a click applies one, another takes it back, and one key plays before and after.

import { Asked } from "../asked.js";
import { button, make, note, table } from "../elements.js";
import { shown, withUnit } from "../numbers.js";
import { fullScale, sound } from "../sound.js";
import { same } from "../store.js";

const HEADS = ["", "cure", "dose", "growth", "at margin", "squeals", "pushed", "cost", "caution"];
const KEY = "b";

export default {
  setup(panel) {
    panel.files.hidden = true;
    panel.base = null; // the design the table is of
    panel.applied = null; // { row, design } on the page now
    panel.heard = new Map();
    panel.asked = new Asked(panel, "Press Find cures; it takes some seconds.", () => of(panel));
    panel.keys = {
      find: button("Find cures", () => panel.asked.ask()),
      back: button("Take it back", () => apply(panel, null), { disabled: true }),
      hear: button("Hear before / after (B)", () => hear(panel), { disabled: true, "aria-keyshortcuts": KEY }),
    };
    panel.list = make("div", { class: "scroller", role: "region", tabindex: 0, "aria-label": "Cures, the best first" });
    panel.body.append(make("div", { class: "buttons" }, ...Object.values(panel.keys)), panel.list);
    list(panel, ["absorber on y", "dampers on x and y", "theta2", "shim at shoe 1"].map((name) => ({ name })));
    panel.app.store.addEventListener("changed", () => mark(panel));
    document.addEventListener("keydown", (event) => {
      if (event.key.toLowerCase() !== KEY || event.ctrlKey || event.metaKey || event.altKey || event.target.matches("input[type=text], textarea, select")) return;
      if (!panel.element.hidden && !panel.keys.hear.disabled) hear(panel);
    });
  },

  options: (panel) => (panel.asked.current ? {} : null),

  state: (panel) => of(panel),

  draw(panel, { data }) {
    panel.base = of(panel);
    panel.heard.clear();
    panel.rows = data.rows;
    panel.element.dataset.cures = data.rows.length;
    list(panel, data.rows);
    panel.remark = `Without: growth ${shown(data.growth, 3)} 1/s, ${shown(100 * data.probability, 3)} % of the lot squeals, ${withUnit(data.amplitude, "m", 2)} after a push. ${data.assumption}`;
    mark(panel);
  },
};

/** The design cures are sought for: while one of them is applied, the one without it. */
const of = (panel) => (panel.applied && same(panel.applied.design, panel.app.store.design) ? panel.base : panel.app.store.design);

function list(panel, rows) {
  const percent = (share) => `${shown(100 * share, 3)} %`;
  const cells = (row) => [row.name, `${shown(row.dose, 3)} ${row.unit}`, shown(row.growth, 3), shown(row.atMargin, 2), percent(row.probability), row.amplitude === null ? "–" : withUnit(row.amplitude, "m", 2), row.cost, row.caution];
  const body = rows.map((row) => {
    const known = "dose" in row;
    const key = button("Apply", () => apply(panel, row), { disabled: !known || Boolean(row.refused), title: row.refused ?? row.python, "aria-label": `Apply ${row.name}` });
    return make("tr", { data: { cure: row.name }, class: known ? null : "like" }, make("td", {}, key), ...(known ? cells(row) : [row.name, ...Array(7).fill("…")]).map((text, i) => make(i ? "td" : "th", { title: text, scope: i ? null : "row" }, text)));
  });
  panel.list.replaceChildren(table(HEADS, body, { class: "cures" }));
}

/** Put the brake with a cure on the page, or the one without; one step of undo each. */
async function apply(panel, row) {
  const { app, base } = panel;
  const text = app.store.texts.get(base.base) ?? null;
  if (!row || row.values) {
    const design = row ? { ...base, values: { ...base.values, ...row.values } } : base;
    return put(panel, row, design, text);
  }
  const frame = await app.connection.ask({ ask: "open", text: row.text }).catch(() => null);
  if (frame?.kind !== "opened") return note("The cure was not applied: the server does not answer.");
  const design = { base: frame.base, brake: frame.brake, laws: {}, values: {} };
  put(panel, row, design, row.text);
}

function put(panel, row, design, text) {
  panel.applied = row && { row, design };
  panel.app.store.option("compare", { a: row ? panel.base : null });
  panel.app.store.replace(design, text);
}

function mark(panel) {
  const on = panel.applied && same(panel.applied.design, panel.app.store.design) ? panel.applied.row.name : null;
  for (const row of panel.list.querySelectorAll("tr[data-cure]")) row.setAttribute("aria-current", row.dataset.cure === on);
  panel.keys.back.disabled = panel.keys.hear.disabled = !on;
  panel.element.dataset.applied = on ?? "";
}

/** Before, then after, then before: the motion of both at the same freedom, as loud as they are to each other. */
async function hear(panel) {
  const both = [panel.base, panel.applied.design];
  panel.says.textContent = "computing both sounds …";
  for (const [i, state] of both.entries()) {
    const key = JSON.stringify(state);
    if (panel.heard.has(key)) continue;
    const dof = i ? panel.heard.get(JSON.stringify(both[0])).dof : undefined;
    const frame = await panel.app.connection.ask({ view: "listen", state, options: { dof } }).catch(() => null);
    if (frame?.kind !== "answer") return note(`No sound: ${frame?.message ?? frame?.wrong?.[0]?.message ?? "the server does not answer"}.`);
    panel.heard.set(key, { ...frame.data, wave: frame.arrays.wave });
  }
  panel.turn = panel.turn === "before" && panel.turned === panel.applied ? "after" : "before";
  panel.turned = panel.applied;
  const heard = both.map((state) => panel.heard.get(JSON.stringify(state)));
  const now = heard[panel.turn === "before" ? 0 : 1];
  if (now.wave) sound(now, fullScale(now, heard.filter((each) => each.wave)));
  panel.element.dataset.heard = panel.turn;
  panel.says.textContent = `${panel.turn === "before" ? "Before" : `After, with ${panel.applied.row.name}`}: ${now.silent ?? now.words}. Press B for the other.`;
}

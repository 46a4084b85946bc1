// A guided tour of the paper of 2011: steps that set the design, what to look at, and the verdicts on its claims.

import { Asked } from "../asked.js";
import { button, make } from "../elements.js";
import { Store } from "../store.js";

const SIGNS = { agree: "✓ agree", disagree: "✗ disagree", "not decidable": "? not decidable" };
const READING = { reading: "reconstructed", "friction.slope": -0.0653, sliding_speed: 1.48 }; // with what it was found with
const LOOK = { locus: "modes", map: "map", friction: "friction curve", motion: "motion", energy: "energy", sensitivity: "ranking", branch: "limit cycles" };

export default {
  setup(panel) {
    panel.files.hidden = true;
    panel.step = null;
    panel.asked = new Asked(panel, "Start the tour, or judge the design that is shown.", () => reading(panel));
    panel.list = make("div", { class: "scroller", role: "region", tabindex: 0, "aria-label": "Claims of the paper" });
    panel.body.append(
      make("p", {}, "Ten steps through the paper: each sets the design, says where to look, and gives the verdicts on what the paper claims."),
      make("div", { class: "buttons" }, button("Start the tour", () => start(panel)), button("Judge this reading", () => panel.asked.ask(), { title: "The claims with the reading and the friction slope of the design on the page" })),
      panel.list,
    );
    panel.card = make("section", { class: "tour", role: "dialog", "aria-label": "Tour", hidden: true });
    document.body.append(panel.card);
    document.getElementById("tools").append(button("Tour", () => start(panel), { id: "tour", title: "A guided tour of the drum-brake paper of 2011" }));
  },

  options: (panel) => (panel.asked.current ? {} : null),

  state: (panel) => reading(panel),

  draw(panel, { data }) {
    panel.data = data;
    panel.element.dataset.agree = data.count.agree;
    panel.remark = `Reading ${data.reading}, slope ${-data.alpha} s/m${data.assumed ? " (assumed)" : ""}${data.inferred ? ", inferred from the paper's numbers and not printed, amplitudes peak to peak" : ""}: ${Object.entries(data.count).map(([verdict, many]) => `${many} ${verdict}`).join(", ")}.`;
    const rows = data.claims.map((claim) => make("tr", {}, make("th", { scope: "row" }, claim.id), make("td", {}, claim.statement), make("td", {}, mark(claim), ` ${claim.computed}`)));
    panel.list.replaceChildren(make("table", {}, make("tbody", {}, ...rows)));
    if (panel.step !== null) show(panel);
  },
};

/** What the claims depend on: the brake, its reading and the slope of its friction. */
function reading(panel) {
  const { base, brake, laws, values } = panel.app.store.design;
  const kept = Object.entries(values).filter(([path]) => path === "reading" || path === "friction.slope");
  return { base, brake, laws, values: Object.fromEntries(kept) };
}

function mark(claim) {
  return make("span", { class: `claim ${claim.verdict === "not decidable" ? "undecided" : claim.verdict}` }, SIGNS[claim.verdict]);
}

async function start(panel) {
  panel.step = 0;
  panel.app.store.replace({ ...Store.plain("drum_brake"), values: READING });
  panel.card.hidden = false;
  panel.card.replaceChildren(make("p", {}, "Computing what the paper claims …"));
  panel.asked.ask();
}

function go(panel, step) {
  panel.step = step;
  const { values: paper, steps } = panel.data;
  const { values, map } = steps[step];
  panel.app.store.replace({ ...Store.plain("drum_brake"), values: { ...READING, ...paper, ...values } });
  if (map) panel.app.store.option("map", map);
  else if (panel.app.store.settings.map?.x === "theta1") panel.app.store.option("map", { x: "friction.static", y: "load" });
  if (!panel.asked.current) panel.asked.ask();
  show(panel);
}

function show(panel) {
  const { steps, claims, reading: read } = panel.data;
  const step = steps[panel.step];
  const said = step.claims.map((id) => claims.find((claim) => claim.id === id));
  const computed = (panel.asked.current || panel.asked.wanted === null) && read === (panel.app.store.design.values.reading ?? read);
  panel.card.replaceChildren(...[
    make("h3", {}, `${panel.step + 1} of ${steps.length}: ${step.title}`),
    make("p", {}, step.text),
    said.length ? make("p", { class: "quiet" }, computed ? `What the paper claims, for reading ${read}:` : "What the paper claims; being judged …") : null,
    said.length ? make("ul", {}, ...said.map((claim) => make("li", {}, computed ? mark(claim) : null, ` ${claim.statement}${computed ? ` Here: ${claim.computed}.` : ""}`))) : null,
    make("div", { class: "buttons" }, ...step.look.map((name) => button(`Look at ${LOOK[name]}`, () => look(panel, name)))),
    make("div", { class: "buttons" },
      button("Back", () => go(panel, panel.step - 1), { disabled: panel.step === 0 }),
      button("Next", () => go(panel, panel.step + 1), { disabled: panel.step === steps.length - 1 }),
      button("End the tour", () => ((panel.step = null), (panel.card.hidden = true))),
    ),
  ].filter(Boolean));
  panel.card.dataset.step = panel.step;
}

function look(panel, name) {
  const { element } = panel.app.panels.get(name);
  panel.app.questions.askFor(name);
  element.scrollIntoView({ block: "start", behavior: "smooth" });
  element.classList.add("looked");
  setTimeout(() => element.classList.remove("looked"), 2000);
}

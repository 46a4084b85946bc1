// The questions the page answers, one screen each: the panels of a question are shown, all others take no place.

import { make } from "./elements.js";

// A panel's file says which of them it answers.
const QUESTIONS = [
  ["why", "Why does it squeal?"], ["when", "When?"], ["happens", "What happens?"], ["silences", "What silences it?"],
  ["matches", "Does it match the test?"], ["tells", "Report, tour"], ["project", "Project"],
];

export class Questions {
  constructor(app, bar, place) {
    Object.assign(this, { app, bar, place });
    this.tabs = QUESTIONS.map(([name, words]) => make("button", { type: "button", role: "tab", id: `ask-${name}`, "aria-controls": place.id, data: { question: name }, onclick: () => this.ask(name) }, words));
    bar.append(...this.tabs);
    bar.addEventListener("keydown", (event) => {
      const way = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
      if (!way) return;
      const next = (QUESTIONS.findIndex(([name]) => name === this.asked) + way + QUESTIONS.length) % QUESTIONS.length;
      this.ask(QUESTIONS[next][0]);
      this.tabs[next].focus();
    });
    app.store.addEventListener("changed", () => this.show());
  }

  get asked() {
    const { question } = this.app.store.settings.page ?? {};
    return QUESTIONS.some(([name]) => name === question) ? question : QUESTIONS[0][0];
  }

  ask(name) {
    if (name !== this.asked) this.app.store.option("page", { question: name });
  }

  /** The question whose screen holds a panel: the present one where it does. */
  askFor(panel) {
    const { hello, connection } = this.app;
    if (!hello) return connection.addEventListener("hello", () => this.askFor(panel), { once: true });
    const { questions } = hello.panels.find(({ name }) => name === panel);
    if (!questions.includes(this.asked)) this.ask(questions[0]);
  }

  show() {
    const { asked } = this;
    if (this.place.dataset.question === asked && this.many === this.app.panels.size) return;
    this.many = this.app.panels.size; // a file may be open before they are here
    this.place.dataset.question = asked;
    this.place.setAttribute("aria-labelledby", `ask-${asked}`);
    for (const tab of this.tabs) {
      tab.setAttribute("aria-selected", tab.dataset.question === asked);
      tab.tabIndex = tab.dataset.question === asked ? 0 : -1;
    }
    for (const panel of this.app.panels.values()) panel.show(panel.about.questions.includes(asked));
  }
}

// The report of the present design: one HTML file, handed over when it is made.

import { Asked } from "../asked.js";
import { button, make } from "../elements.js";
import { download } from "../export.js";

export default {
  setup(panel) {
    panel.asked = new Asked(panel, "Press Make the report; it takes some seconds.");
    panel.body.append(
      make("p", {}, "One HTML file for a colleague: verdict, parameters with sources, stability, map, motion with sound, limit cycle, caveats and versions. It opens without a network and prints well."),
      make("div", { class: "buttons" }, button("Make the report", () => panel.asked.ask())),
    );
    document.getElementById("tools").append(button("Report", () => (panel.app.questions.askFor("report"), panel.asked.ask()), { id: "report", title: "Everything about this design as one HTML file" }));
  },

  options: (panel) => (panel.asked.current ? { made: panel.asked.wanted.length } : null),

  draw(panel, { data }) {
    const name = `${panel.app.stem()}-report.html`;
    download(data.html, name, "text/html");
    panel.element.dataset.made = data.html.length;
    panel.remark = `Saved as ${name}, ${(data.html.length / 1e6).toFixed(1)} MB.`;
  },
};

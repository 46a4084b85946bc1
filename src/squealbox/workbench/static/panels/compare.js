// Two designs beside each other: A is kept, B is the one on the page.

export default {
  setup(panel) {
    const keep = (a) => panel.choose({ a });
    panel.button("Keep this as A", () => keep(panel.app.store.design), { title: "Keep the design on the page as A" });
    panel.keys = [panel.button("Swap A and B", () => swap(panel)), panel.button("Forget A", () => keep(null))];
    for (const key of panel.keys) key.disabled = true;
  },

  options: (panel) => (panel.chosen.a ? { a: panel.chosen.a } : {}),

  draw(panel) {
    for (const key of panel.keys) key.disabled = !panel.chosen.a;
  },
};

function swap(panel) {
  const { a } = panel.chosen;
  panel.choose({ a: panel.app.store.design });
  panel.app.store.replace(a);
}

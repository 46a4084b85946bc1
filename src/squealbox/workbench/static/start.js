// How a motion begins, and the choice of the degree of freedom: the same for every panel that follows a motion.

import { choose } from "./elements.js";

export const START = { start: "push", push: 0.05, dof: 0 };

/** The options of a motion as they were chosen in its panel. */
export const startOf = (store) => {
  const { start, push, dof } = { ...START, ...store.settings.motion };
  return { start, push, dof };
};

/** A select over the degrees of freedom of what was drawn, in the place kept for it. */
export function degrees(panel, { names, dof }) {
  const key = JSON.stringify([names, dof]);
  if (panel.degrees.dataset.key === key) return;
  panel.degrees.dataset.key = key;
  panel.degrees.replaceChildren(choose("of", names.map((name, i) => [String(i), name]), String(dof), (chosen) => panel.choose({ dof: Number(chosen) })));
}

// Light, dark, or as the system is set; the choice is kept in the browser.

const CHOICES = ["as the system", "light", "dark"];
const KEY = "squealbox-theme";

export function chooseTheme(choice = localStorage.getItem(KEY) ?? CHOICES[0]) {
  if (choice === CHOICES[0]) delete document.documentElement.dataset.theme;
  else document.documentElement.dataset.theme = choice;
  localStorage.setItem(KEY, choice);
  return choice;
}

const night = matchMedia("(prefers-color-scheme: dark)");

/** A word for the colours the page has now, found without laying it out. */
export const shade = () => document.documentElement.dataset.theme ?? (night.matches ? "dark" : "light");

export function nextTheme() {
  const now = CHOICES.indexOf(localStorage.getItem(KEY) ?? CHOICES[0]);
  return chooseTheme(CHOICES[(now + 1) % CHOICES.length]);
}

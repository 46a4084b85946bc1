// What the tests look for in a page as it is drawn: each function returns what is wrong, an empty list when nothing is.

const seen = (e) => e.getClientRects().length > 0;
const panels = () => [...document.querySelectorAll(".panel:not([hidden])")];
const written = () => [...document.querySelectorAll("body *")].filter((e) => seen(e) && [...e.childNodes].some((n) => n.nodeType === 3 && n.textContent.trim()));

function empty() {
  const marks = "svg path, svg line, svg rect, svg circle, p, td, canvas:not([hidden])";
  return panels().filter((panel) => ![...panel.querySelector(":scope > .body").querySelectorAll(marks)].some(seen)).map((panel) => panel.dataset.panel);
}

function outside() {
  const found = panels().filter((panel) => {
    const box = panel.getBoundingClientRect();
    return box.bottom > innerHeight + 1 || box.right > innerWidth + 1 || box.height < 120;
  }).map((panel) => panel.dataset.panel);
  const { scrollWidth, scrollHeight } = document.documentElement;
  const content = document.getElementById("content");
  if (scrollWidth > innerWidth || scrollHeight > innerHeight) found.push("the page scrolls");
  if (content.scrollHeight > content.clientHeight) found.push("the question scrolls");
  return found;
}

function nameless() {
  return [...document.querySelectorAll('button, select, input, textarea, a[href], [tabindex="0"], [role=img]')].filter(seen).filter((e) => {
    const labels = [...(e.labels ?? [])].map((label) => label.textContent).join("");
    const by = (e.getAttribute("aria-labelledby") ?? "").split(" ").map((id) => document.getElementById(id)?.textContent ?? "").join("");
    return !(e.getAttribute("aria-label") || labels.trim() || by.trim() || e.textContent.trim() || e.title);
  }).map((e) => e.outerHTML.slice(0, 90));
}

/** A name on an element whose role takes none is not read out. */
const silent = () => [...document.querySelectorAll("[aria-label]")].filter((e) => ["DIV", "SPAN", "P", "I"].includes(e.tagName) && !e.getAttribute("role")).map((e) => e.outerHTML.slice(0, 90));

function dangling() {
  const names = ["aria-describedby", "aria-labelledby", "aria-controls"];
  return [...document.querySelectorAll(names.map((name) => `[${name}]`).join())].flatMap((e) =>
    names.flatMap((name) => (e.getAttribute(name) ?? "").split(" ")).filter((id) => id && !document.getElementById(id)).map((id) => `${e.outerHTML.slice(0, 60)} -> ${id}`));
}

function twice() {
  const ids = [...document.querySelectorAll("[id]")].map((e) => e.id);
  return ids.filter((id, i) => ids.indexOf(id) !== i);
}

const small = () => written().filter((e) => parseFloat(getComputedStyle(e).fontSize) < 12).map((e) => `${e.tagName}: ${e.textContent.slice(0, 40)}`);

function faint() {
  const parts = (text) => {
    const found = text.match(/[\d.]+/g).map(Number);
    return found.length > 3 ? found : [...found, 1];
  };
  const light = (rgb) => {
    const [r, g, b] = rgb.slice(0, 3).map((v) => v / 255).map((v) => (v <= 0.03928 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4));
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
  };
  const up = function* (e) {
    for (; e; e = e.parentElement) yield e;
  };
  const ground = (e) => {
    for (const each of up(e)) {
      const colour = parts(getComputedStyle(each).backgroundColor);
      if (colour[3] > 0.99) return colour;
    }
    return [255, 255, 255, 1];
  };
  return written().filter((e) => !e.closest(":disabled, option")).flatMap((e) => {
    const style = getComputedStyle(e);
    const [a, b] = [light(parts(e.ownerSVGElement ? style.fill : style.color)), light(ground(e.ownerSVGElement ?? e))].sort((x, y) => y - x);
    const ratio = (a + 0.05) / (b + 0.05);
    const solid = [...up(e)].every((each) => Number(getComputedStyle(each).opacity) > 0.99);
    return ratio >= 4.5 && solid ? [] : [`${ratio.toFixed(2)} ${e.tagName} ${e.className.baseVal ?? e.className} ${e.textContent.trim().slice(0, 30)}`];
  });
}

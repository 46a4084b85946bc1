// Small pieces of the page, made without innerHTML.

export function make(tag, about = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(about)) {
    if (value === undefined || value === null || value === false) continue;
    if (name === "class") element.className = value;
    else if (name === "data") Object.assign(element.dataset, value);
    else if (name.startsWith("on")) element.addEventListener(name.slice(2), value);
    else element.setAttribute(name, value === true ? "" : value);
  }
  element.append(...children.filter((child) => child !== null && child !== undefined));
  return element;
}

/** The same of a picture in SVG. */
export function element(tag, about = {}, ...children) {
  const made = document.createElementNS("http://www.w3.org/2000/svg", tag);
  set(made, about);
  made.append(...children);
  return made;
}

/** Attributes of a node; a number that is none leaves its attribute out. */
export function set(node, about) {
  for (const [name, value] of Object.entries(about)) {
    if (typeof value === "number" && !Number.isFinite(value)) node.removeAttribute(name);
    else if (node.getAttribute(name) !== String(value)) node.setAttribute(name, value);
  }
}

/** The children of a node: [tag, attributes, text or children] each. What is there is kept: to style new nodes takes the browser longer. */
export function fill(node, parts) {
  parts.forEach(([tag, about, inside = []], i) => {
    const there = node.children[i];
    const child = there?.tagName === tag ? there : element(tag);
    if (!there) node.append(child);
    else if (child !== there) there.replaceWith(child);
    for (const { name } of [...child.attributes]) if (!(name in about)) child.removeAttribute(name);
    set(child, about);
    if (typeof inside !== "string") fill(child, inside);
    else if (child.textContent !== inside) child.textContent = inside;
  });
  while (node.children.length > parts.length) node.lastElementChild.remove();
}

/** Where on a node the pointer is. */
export function spot(node, event) {
  const box = node.getBoundingClientRect();
  return [event.clientX - box.left, event.clientY - box.top];
}

export const button = (text, onclick, about = {}) => make("button", { type: "button", onclick, ...about }, text);

/** A select with its label; `choices` are [value, text] pairs. */
export function choose(text, choices, value, onchange, title) {
  const select = make("select", { "aria-label": text });
  for (const [each, name] of choices) select.append(make("option", { value: each, selected: each === value }, name));
  select.value = value;
  select.addEventListener("change", () => onchange(select.value));
  return make("label", { class: "choice", title }, `${text} `, select);
}

/** A table: the words of its head, and rows whose first cell names them; a cell is a text, an element, or [text, class]. */
export function table(heads, rows, about = {}) {
  const cells = (tag, row) => row.map((cell) => [cell].flat()).map(([words, cls], i) => make(i ? "td" : tag, { class: cls || null, scope: i ? null : "row" }, words));
  const head = heads.map((words) => (words ? make("th", { scope: "col" }, words) : make("td")));
  return make("table", about, make("thead", {}, make("tr", {}, ...head)), make("tbody", {}, ...rows.map((row) => (Array.isArray(row) ? make("tr", {}, ...cells("th", row)) : row))));
}

/** A number asked for in a dialog; null where none is given. */
export function askNumber(words) {
  const input = make("input", { type: "number", min: 0, step: "any", id: "asked-number" });
  const go = make("form", { method: "dialog", novalidate: true }, make("label", { for: input.id }, `${words} `), input, make("p", { class: "buttons" }, make("button", { value: "ok" }, "OK"), " ", make("button", { type: "button", onclick: () => dialog.close() }, "Cancel")));
  const dialog = make("dialog", { "aria-label": words }, go);
  document.body.append(dialog);
  dialog.showModal();
  return new Promise((resolve) => dialog.addEventListener("close", () => (dialog.remove(), resolve(dialog.returnValue === "ok" && input.valueAsNumber > 0 ? input.valueAsNumber : null))));
}

let hiding = 0;

/** A sentence at the foot of the page that goes away. */
export function note(text) {
  const place = document.getElementById("note");
  place.textContent = text;
  place.hidden = false;
  clearTimeout(hiding);
  hiding = setTimeout(() => (place.hidden = true), 4000);
}

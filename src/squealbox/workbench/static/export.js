// Figures as files for paper, light also where the page is dark: PNG, SVG with its look written into it, PDF, and the numbers
// drawn as CSV or in the clipboard.

import { element } from "./drawing.js";
import { note } from "./elements.js";
import { onPaper } from "./theme.js";

const FINER = 3; // pixels of a PNG for one of the page: 300 dots per inch at the size of the page
const KEPT = ["paint-order", "fill", "fill-opacity", "stroke", "stroke-width", "stroke-dasharray", "stroke-opacity", "opacity", "font-family", "font-size", "font-weight"];
const KEYS = 24; // px below a figure for the meaning of its colours

/** The SVG of a chart as text with its look as attributes; `ground` are the elements beneath it, as text. */
function serialised(chart, ground) {
  const live = chart.svg.node();
  const copy = live.cloneNode(true);
  const from = [live, ...live.querySelectorAll("*")];
  const to = [copy, ...copy.querySelectorAll("*")];
  from.forEach((element, i) => {
    const look = getComputedStyle(element);
    for (const name of KEPT) to[i].setAttribute(name, look.getPropertyValue(name));
    to[i].removeAttribute("class");
  });
  copy.querySelectorAll('[display="none"]').forEach((element) => element.remove());
  copy.setAttribute("xmlns", "http://www.w3.org/2000/svg");
  const keys = chart.spec.heat?.keys() ?? [];
  if (keys.length) keyed(copy, keys, chart.margin.left);
  const text = new XMLSerializer().serializeToString(copy);
  const inside = text.indexOf(">") + 1;
  return text.slice(0, inside) + ground + text.slice(inside);
}

/** What the colours of the picture mean, in a row below the figure. */
function keyed(copy, keys, left) {
  const [, , width, height] = copy.getAttribute("viewBox").split(" ").map(Number);
  copy.setAttribute("height", height + KEYS);
  copy.setAttribute("viewBox", `0 0 ${width} ${height + KEYS}`);
  const each = (width - left) / keys.length;
  keys.forEach(([css, words], i) => {
    const x = left + i * each;
    copy.append(element("rect", { x, y: height + 4, width: 12, height: 12, fill: css, stroke: "#888888" }));
    const text = element("text", { x: x + 17, y: height + 14, "font-size": "12px", "font-family": "system-ui, DejaVu Sans, sans-serif", fill: "#14181d" });
    text.textContent = words;
    copy.append(text);
  });
}

const box = (chart) => ({ x: chart.margin.left, y: chart.margin.top, width: chart.inner.width, height: chart.inner.height });
const PAPER = "#ffffff";

/** A figure as it goes to paper, whatever the colours of the page: its SVG as text, and the picture beneath it. */
function printed(chart, ground) {
  const taken = onPaper(() => {
    chart.draw(chart.spec);
    return { text: serialised(chart, ground(chart)), picture: chart.canvas.hidden ? null : likeness(chart.canvas) };
  });
  chart.draw(chart.spec); // in the page's own colours again
  return taken;
}

function likeness(canvas) {
  const copy = document.createElement("canvas");
  Object.assign(copy, { width: canvas.width, height: canvas.height });
  copy.getContext("2d").drawImage(canvas, 0, 0);
  return copy;
}

/** The chart as an SVG file; a picture of values goes in as an image, written as text so that this page loads nothing. */
export function svgText(chart) {
  return printed(chart, () => {
    const paper = `<rect width="100%" height="100%" fill="${PAPER}"/>`;
    if (chart.canvas.hidden) return paper;
    const place = Object.entries(box(chart)).map(([name, value]) => `${name}="${value}"`).join(" ");
    const look = chart.spec.heat.smooth ? "" : ' style="image-rendering:pixelated"';
    return `${paper}<image ${place} preserveAspectRatio="none"${look} href="${chart.canvas.toDataURL()}"/>`;
  }).text;
}

/** The chart as a PNG of three times its size on the page: paper, picture, and the drawing over them. */
export async function pngBlob(chart) {
  const { text, picture } = printed(chart, () => "");
  const address = URL.createObjectURL(new Blob([text], { type: "image/svg+xml" }));
  try {
    const image = new Image();
    image.src = address;
    await image.decode();
    const canvas = document.createElement("canvas");
    canvas.width = FINER * image.width;
    canvas.height = FINER * image.height;
    const pen = canvas.getContext("2d");
    pen.fillStyle = PAPER;
    pen.fillRect(0, 0, canvas.width, canvas.height);
    pen.imageSmoothingEnabled = false;
    const { x, y, width, height } = box(chart);
    if (picture) pen.drawImage(picture, FINER * x, FINER * y, FINER * width, FINER * height);
    pen.imageSmoothingEnabled = true;
    pen.drawImage(image, 0, 0, canvas.width, canvas.height);
    return await new Promise((resolve) => canvas.toBlob(resolve, "image/png"));
  } finally {
    URL.revokeObjectURL(address);
  }
}

/** The numbers of a chart, one column each, with names and units in the first line. */
export function csvText(chart, between = ",") {
  const columns = chart.columns();
  const quoted = (name) => `"${name.replaceAll('"', '""')}"`;
  const lines = [columns.map(([name]) => quoted(name)).join(between)];
  const rows = Math.max(0, ...columns.map(([, values]) => values.length));
  for (let i = 0; i < rows; i++) lines.push(columns.map(([, values]) => cell(values[i])).join(between));
  return lines.join("\n") + "\n";
}

/** A number with eight digits, a word in quotes, nothing where nothing is known. */
function cell(value) {
  if (typeof value === "string") return `"${value.replaceAll('"', '""')}"`;
  return Number.isFinite(value) ? Number(value.toPrecision(8)) : "";
}

/** Hand a file to the user. */
export function download(content, name, type) {
  document.dispatchEvent(new CustomEvent("saved", { detail: { content, name } })); // it may go into the project too
  const address = URL.createObjectURL(content instanceof Blob ? content : new Blob([content], { type }));
  const link = document.createElement("a");
  link.href = address;
  link.download = name;
  document.body.append(link);
  link.click();
  link.remove();
  setTimeout(() => URL.revokeObjectURL(address), 10000);
}

/** The chart as PDF, drawn by the server from the numbers on the page. */
async function pdfBlob(chart) {
  const { x, y, layers = [], heat, ...rest } = chart.spec;
  const axis = (each, scale) => each?.label && { label: each.label, domain: scale.domain() };
  const picture = heat && { ...heat, span: [x.domain, y.domain], scale: heat.kind };
  const figure = { ...rest, size: [chart.size.width, chart.size.height], x: axis(x, chart.x), y: axis(y, chart.y), layers, heat: picture };
  const plain = (key, value) => (value instanceof Float32Array ? Array.from(value, (v) => (Number.isFinite(v) ? Number(v.toPrecision(7)) : null)) : value);
  const answer = await fetch("/paper", { method: "POST", body: JSON.stringify(figure, plain) }).catch(() => null);
  if (answer?.ok) return answer.blob();
  note((await answer?.json().catch(() => null))?.message ?? "No PDF: the server does not answer.");
  return null;
}

export const KINDS = [["PNG", "PNG"], ["SVG", "SVG"], ["PDF", "PDF"], ["CSV", "numbers as CSV"], ["Copy", "copy as table"]];

/** Every chart of a panel as files of that kind, or all their numbers to the clipboard. */
export async function exportCharts(charts, stem, kind) {
  const drawn = charts.filter((chart) => chart.spec);
  if (kind === "Copy") return copied(drawn.map((chart) => csvText(chart, "\t")).join("\n"));
  const made = { PNG: pngBlob, SVG: svgText, PDF: pdfBlob, CSV: csvText }[kind];
  const type = { SVG: "image/svg+xml", CSV: "text/csv" }[kind];
  for (const chart of drawn) {
    const content = await made(chart);
    if (content) download(content, `${stem}-${chart.name}.${kind.toLowerCase()}`, type);
  }
}

/** Text into the clipboard. */
export const copied = (text) => navigator.clipboard.writeText(text).then(() => note("Copied: paste it into a spreadsheet."), () => note("The browser gives no clipboard to this page."));

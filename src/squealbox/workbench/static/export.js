// Figures as files for paper, drawn by the server from the numbers on the page; the numbers as CSV or in the clipboard.

import { note } from "./elements.js";

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

/** The chart as PDF, SVG or PNG. */
async function onPaper(chart, kind) {
  const { x, y, layers = [], heat, ...rest } = chart.spec;
  const axis = (each, scale) => each?.label && { label: each.label, domain: scale.ends };
  const picture = heat && { ...heat, span: [x.domain, y.domain], scale: heat.kind };
  const figure = { ...rest, size: [chart.size.width, chart.size.height], x: axis(x, chart.x), y: axis(y, chart.y), layers: [...layers, chart.markLayer].filter(Boolean), heat: picture };
  const plain = (key, value) => (value instanceof Float32Array ? Array.from(value, (v) => (Number.isFinite(v) ? Number(v.toPrecision(7)) : null)) : value);
  const answer = await fetch(`/paper/${kind}`, { method: "POST", body: JSON.stringify(figure, plain) }).catch(() => null);
  if (answer?.ok) return answer.blob();
  note((await answer?.json().catch(() => null))?.message ?? "Not saved: the server does not answer.");
  return null;
}

export const KINDS = [["PNG", "PNG"], ["SVG", "SVG"], ["PDF", "PDF"], ["CSV", "numbers as CSV"], ["Copy", "copy as table"]];

/** Every chart of a panel as files of that kind, or all their numbers to the clipboard. */
export async function exportCharts(charts, stem, kind) {
  const drawn = charts.filter((chart) => chart.spec);
  if (kind === "Copy") return copied(drawn.map((chart) => csvText(chart, "\t")).join("\n"));
  const ending = kind.toLowerCase();
  for (const chart of drawn) {
    const content = kind === "CSV" ? csvText(chart) : await onPaper(chart, ending);
    if (content) download(content, `${stem}-${chart.name}.${ending}`, "text/csv");
  }
}

/** Text into the clipboard. */
export const copied = (text) => navigator.clipboard.writeText(text).then(() => note("Copied: paste it into a spreadsheet."), () => note("The browser gives no clipboard to this page."));

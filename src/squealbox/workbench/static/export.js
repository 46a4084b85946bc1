// Figures as files, made by the server from the numbers on the page: for paper, as CSV, or as a table for the clipboard.

import { note } from "./elements.js";

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

/** The chart as a file. */
async function made(chart, kind) {
  const { x, y, layers = [], heat, ...rest } = chart.spec;
  const axis = (each, scale) => each?.label && { label: each.label, domain: scale.ends };
  const picture = heat && { ...heat, span: [x.domain, y.domain], scale: heat.kind };
  const figure = { ...rest, size: [chart.size.width, chart.size.height], x: axis(x, chart.x), y: axis(y, chart.y), layers: [...layers, chart.markLayer].filter(Boolean), heat: picture };
  const plain = (key, value) => (value instanceof Float32Array ? Array.from(value, (v) => (Number.isFinite(v) ? Number(v.toPrecision(8)) : null)) : value);
  const answer = await fetch(`/paper/${kind}`, { method: "POST", body: JSON.stringify(figure, plain) }).catch(() => null);
  if (answer?.ok) return answer.blob();
  note((await answer?.json().catch(() => null))?.message ?? "Not saved: the server does not answer.");
  return null;
}

export const KINDS = [["PNG", "PNG"], ["SVG", "SVG"], ["PDF", "PDF"], ["CSV", "numbers as CSV"], ["Copy", "copy as table"]];

/** Every chart of a panel as files of that kind, or all their numbers to the clipboard. */
export async function exportCharts(charts, stem, kind) {
  const ending = kind === "Copy" ? "tsv" : kind.toLowerCase();
  const drawn = charts.filter((chart) => chart.spec);
  const files = await Promise.all(drawn.map((chart) => made(chart, ending)));
  if (kind === "Copy") return files.every(Boolean) && copied((await Promise.all(files.map((file) => file.text()))).join("\n"));
  files.forEach((file, i) => file && download(file, `${stem}-${drawn[i].name}.${ending}`));
}

/** Text into the clipboard. */
export const copied = (text) => navigator.clipboard.writeText(text).then(() => note("Copied: paste it into a spreadsheet."), () => note("The browser gives no clipboard to this page."));

// Figures as files: PNG, SVG with its look written into it, and CSV of the numbers drawn.

const KEPT = ["fill", "fill-opacity", "stroke", "stroke-width", "stroke-dasharray", "stroke-opacity", "opacity", "font-family", "font-size", "font-weight"];

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
  const text = new XMLSerializer().serializeToString(copy);
  const inside = text.indexOf(">") + 1;
  return text.slice(0, inside) + ground + text.slice(inside);
}

const box = (chart) => ({ x: chart.margin.left, y: chart.margin.top, width: chart.inner.width, height: chart.inner.height });
const paper = () => getComputedStyle(document.body).backgroundColor;

/** The chart as an SVG file; a picture of values goes in as an image, written as text so that this page loads nothing. */
export function svgText(chart) {
  let ground = `<rect width="100%" height="100%" fill="${paper()}"/>`;
  if (!chart.canvas.hidden) {
    const place = Object.entries(box(chart)).map(([name, value]) => `${name}="${value}"`).join(" ");
    ground += `<image ${place} preserveAspectRatio="none" href="${chart.canvas.toDataURL()}"/>`;
  }
  return serialised(chart, ground);
}

/** The chart as a PNG of twice its size on the page: paper, picture, and the drawing over them. */
export async function pngBlob(chart) {
  const address = URL.createObjectURL(new Blob([serialised(chart, "")], { type: "image/svg+xml" }));
  try {
    const image = new Image();
    image.src = address;
    await image.decode();
    const canvas = document.createElement("canvas");
    canvas.width = 2 * image.width;
    canvas.height = 2 * image.height;
    const pen = canvas.getContext("2d");
    pen.fillStyle = paper();
    pen.fillRect(0, 0, canvas.width, canvas.height);
    pen.imageSmoothingEnabled = false;
    const { x, y, width, height } = box(chart);
    if (!chart.canvas.hidden) pen.drawImage(chart.canvas, 2 * x, 2 * y, 2 * width, 2 * height);
    pen.imageSmoothingEnabled = true;
    pen.drawImage(image, 0, 0, canvas.width, canvas.height);
    return await new Promise((resolve) => canvas.toBlob(resolve, "image/png"));
  } finally {
    URL.revokeObjectURL(address);
  }
}

/** The numbers of a chart, one column each, with names and units in the first line. */
export function csvText(chart) {
  const columns = chart.columns();
  const quoted = (name) => `"${name.replaceAll('"', '""')}"`;
  const lines = [columns.map(([name]) => quoted(name)).join(",")];
  const rows = Math.max(0, ...columns.map(([, values]) => values.length));
  for (let i = 0; i < rows; i++) lines.push(columns.map(([, values]) => (i < values.length && Number.isFinite(values[i]) ? Number(values[i].toPrecision(8)) : "")).join(","));
  return lines.join("\n") + "\n";
}

/** Hand a file to the user. */
export function download(content, name, type) {
  const address = URL.createObjectURL(content instanceof Blob ? content : new Blob([content], { type }));
  const link = document.createElement("a");
  link.href = address;
  link.download = name;
  document.body.append(link);
  link.click();
  link.remove();
  setTimeout(() => URL.revokeObjectURL(address), 10000);
}

/** Every chart of a panel as files of that kind. */
export async function exportCharts(charts, stem, kind) {
  for (const chart of charts.filter((chart) => chart.spec)) {
    const name = `${stem}-${chart.name}.${kind}`;
    if (kind === "svg") download(svgText(chart), name, "image/svg+xml");
    if (kind === "csv") download(csvText(chart), name, "text/csv");
    if (kind === "png") download(await pngBlob(chart), name, "image/png");
  }
}

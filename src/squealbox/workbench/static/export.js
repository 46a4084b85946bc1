// Figures as files: PNG, SVG with its look written into it, and CSV of the numbers drawn.

const KEPT = ["fill", "fill-opacity", "stroke", "stroke-width", "stroke-dasharray", "stroke-opacity", "opacity", "font-family", "font-size", "font-weight"];

/** The SVG of a chart as text; the picture beneath it goes in as an image, the look as attributes. */
export function svgText(chart) {
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
  const namespace = "http://www.w3.org/2000/svg";
  const add = (tag, about) => {
    const element = document.createElementNS(namespace, tag);
    for (const [name, value] of Object.entries(about)) element.setAttribute(name, value);
    return element;
  };
  const size = { width: live.getAttribute("width"), height: live.getAttribute("height") };
  const parts = [add("rect", { ...size, fill: getComputedStyle(document.body).backgroundColor })];
  if (!chart.canvas.hidden) {
    const box = { x: chart.margin.left, y: chart.margin.top, width: chart.inner.width, height: chart.inner.height };
    parts.push(add("image", { ...box, preserveAspectRatio: "none", href: chart.canvas.toDataURL() }));
  }
  copy.prepend(...parts);
  return new XMLSerializer().serializeToString(copy);
}

/** The chart as a PNG of twice its size on the page. */
export async function pngBlob(chart) {
  const text = svgText(chart);
  const address = URL.createObjectURL(new Blob([text], { type: "image/svg+xml" }));
  try {
    const image = new Image();
    image.src = address;
    await image.decode();
    const canvas = document.createElement("canvas");
    canvas.width = 2 * image.width;
    canvas.height = 2 * image.height;
    canvas.getContext("2d").drawImage(image, 0, 0, canvas.width, canvas.height);
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

// Figures as the server describes them (`figure_data.py`): layers name arrays of the frame with "@name".

import { diverging, mechanismColours, sequential } from "./colours.js";
import { label, raised, shown } from "./numbers.js";

const SCALES = { diverging, sequential, decades: (values) => sequential(values, { log: true }), mechanism: mechanismColours };
const STRETCH = 2; // what is measured is drawn where it lies within this many times the axis

/** What a chart draws, made of a figure and the arrays of its frame; `measured` holds numbers of a recording by quantity. */
export function resolved(figure, arrays, measured = {}) {
  const read = (value) => (typeof value === "string" && value[0] === "@" ? arrays[value.slice(1)] : value);
  const [x, y] = [figure.x, figure.y].map((axis) => ({ ...axis, label: label(axis.name, axis.unit), domain: holding(axis, measured) }));
  const layers = figure.layers.map((layer) => ({ ...layer, ...Object.fromEntries(["x", "y", "low", "high"].filter((key) => key in layer).map((key) => [key, read(layer[key])])) }));
  for (const [axis, kind, at] of [[x, "upright", "x"], [y, "across", "y"]]) {
    const value = measured[axis.quantity] / axis.factor;
    if (value >= axis.domain[0] && value <= axis.domain[1]) layers.push({ kind, [at]: value, cls: "measured", name: "measured" });
  }
  return { x, y, layers, legend: figure.legend, heat: figure.heat && picture({ ...figure.heat, beside: read(figure.heat.beside) }, read(figure.heat.values)) };
}

/** The ends of an axis, wider where what is measured lies not far outside. */
function holding({ domain, quantity, factor }, measured) {
  const value = measured[quantity] / factor;
  const [low, high] = domain;
  const room = (STRETCH - 1) * (high - low);
  return value > low - room && value < high + room ? [Math.min(low, value), Math.max(high, 1.04 * value)] : domain;
}

/** A picture with its colours and what they mean; the scale is made anew at each drawing, for the colours the page has then. */
function picture(heat, values) {
  const scale = () => SCALES[heat.scale](values);
  const keys = () => (heat.names ? heat.names.map((name, code) => [scale().css(code), name]) : scale().steps.map(([css, value]) => [css, `${shown(value, 2)} ${raised(heat.unit)}`.trim()]));
  return { ...heat, kind: heat.scale, values, scale, keys, name: label(heat.name, heat.unit) };
}

// Colours of the pictures, as pixels and as CSS; safe for colour-blind readers, for light and for dark pages.

import { shade } from "./theme.js";

const NONE = [136, 136, 136];
const MECHANISMS = [[222, 235, 247], [213, 94, 0], [0, 158, 115], [120, 60, 150], [230, 159, 0]];
const MECHANISMS_DARK = [[32, 44, 58], [224, 110, 20], [0, 158, 115], [150, 96, 190], [230, 170, 30]];

const dark = () => shade() === "dark";
const pack = ([r, g, b]) => (0xff000000 | (b << 16) | (g << 8) | r) >>> 0;
const css = ([r, g, b]) => `rgb(${r},${g},${b})`;
const mix = (a, b, t) => a.map((x, i) => Math.round(x + (b[i] - x) * t));

/** Orange above zero, blue below, pale at zero; the shade grows with the square root, so the boundary stands out. */
export function diverging(values) {
  const [zero, up, down] = dark() ? [[30, 34, 40], [255, 150, 60], [90, 170, 235]] : [[252, 252, 252], [200, 80, 0], [40, 110, 175]];
  let largest = 0;
  let least = 0;
  for (const value of values) {
    if (value > largest) largest = value;
    if (value < least) least = value;
  }
  const colour = (value) => {
    if (!Number.isFinite(value)) return NONE;
    if (value > 0) return mix(mix(zero, up, 0.25), up, Math.sqrt(value / (largest || 1)));
    return mix(zero, down, 0.75 * Math.sqrt(value / (least || -1)));
  };
  const steps = [least, least / 4, largest / 4, largest].filter((value, i, all) => value !== 0 && all.indexOf(value) === i);
  return { pixel: (value) => pack(colour(value)), steps: steps.map((value) => [css(colour(value)), value]) };
}

/** From pale to strong over the values there are. */
export function sequential(values, { log = false, decades = 3 } = {}) {
  const [pale, strong] = dark() ? [[26, 30, 38], [120, 200, 255]] : [[250, 251, 253], [0, 60, 120]];
  let low = Infinity;
  let high = -Infinity;
  for (const value of values) {
    if (value < low) low = value;
    if (value > high) high = value;
  }
  const share = log ? (value) => Math.max(0, 1 + Math.log10(Math.max(value, 1e-300) / high) / decades) : (value) => (value - low) / (high - low || 1);
  const colour = (value) => (Number.isFinite(value) ? mix(pale, strong, Math.min(1, share(value))) : NONE);
  const steps = [0, 0.33, 0.67, 1].map((t) => (log ? high * 10 ** (decades * (t - 1)) : low + t * (high - low)));
  return { pixel: (value) => pack(colour(value)), steps: steps.map((value) => [css(colour(value)), value]) };
}

export function mechanismColours() {
  const colours = dark() ? MECHANISMS_DARK : MECHANISMS;
  const of = (code) => colours[code] ?? NONE;
  return { pixel: (code) => pack(of(code)), css: (code) => css(of(code)) };
}

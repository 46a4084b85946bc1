// Numbers and units as a reader writes them.

const PREFIXES = {
  m: [[1, "m"], [1e-3, "mm"], [1e-6, "µm"], [1e-9, "nm"]],
  s: [[1, "s"], [1e-3, "ms"], [1e-6, "µs"]],
  Hz: [[1e6, "MHz"], [1e3, "kHz"], [1, "Hz"]],
  N: [[1e6, "MN"], [1e3, "kN"], [1, "N"], [1e-3, "mN"]],
  "m/s": [[1, "m/s"], [1e-3, "mm/s"], [1e-6, "µm/s"]],
};

/** A number with that many digits, plain where it can be, with a true minus. */
export function shown(value, digits = 4) {
  if (value === null || value === undefined || Number.isNaN(value)) return "–";
  if (!Number.isFinite(value)) return value > 0 ? "∞" : "−∞";
  const size = Math.abs(value);
  let text;
  if (size !== 0 && (size < 1e-4 || size >= 1e6)) text = value.toExponential(digits - 1).replace(/\.?0+e/, "e").replace("e+", "e");
  else text = String(Number(value.toPrecision(digits)));
  return text.replaceAll("-", "−");
}

/** A value with the prefix that makes it one or more: 2.13 kHz. */
export function withUnit(value, unit, digits = 4) {
  const [factor, name] = prefix(unit, Math.abs(value));
  return `${shown(value / factor, digits)} ${name}`.trim();
}

/** What to divide values up to `largest` by, and the unit then read. */
export function prefix(unit, largest) {
  const choices = PREFIXES[unit] ?? [[1, unit]];
  if (!largest) return choices.find(([factor]) => factor === 1) ?? choices[0];
  return choices.find(([factor]) => largest >= 0.999 * factor) ?? choices[choices.length - 1];
}

const UNITS = [
  { m: 1, mm: 1e-3, cm: 1e-2, "µm": 1e-6, um: 1e-6, nm: 1e-9 },
  { s: 1, ms: 1e-3, "µs": 1e-6, us: 1e-6 },
  { Hz: 1, kHz: 1e3 },
  { N: 1, kN: 1e3, MN: 1e6, mN: 1e-3 },
  { "m/s": 1, "mm/s": 1e-3, "km/h": 1 / 3.6 }, // and rpm, with a radius
  { "N/m": 1, "kN/m": 1e3, "N/mm": 1e3, "MN/m": 1e6, "kN/mm": 1e6 },
  { kg: 1, g: 1e-3, t: 1e3 },
  { rad: 1, deg: Math.PI / 180, "°": Math.PI / 180 },
];

/** Units in which a field can be read, with the factor to SI; those that need a length or an area say how to ask for it. */
export const unitsOf = (field) => {
  const kind = UNITS.find((each) => (field.usual ?? field.unit) in each) ?? {};
  const shownOnce = Object.entries(kind).filter(([name]) => !["um", "us", "°"].includes(name)).map(([name, factor]) => ({ name, factor }));
  if ("m/s" in kind) shownOnce.push({ name: "rpm", ask: "Radius at which it slides, in mm", factor: (mm) => (2 * Math.PI * mm * 1e-3) / 60 });
  if ("N" in kind) shownOnce.push({ name: "bar", ask: "Area of the piston, in cm²", factor: (cm2) => 1e5 * cm2 * 1e-4 });
  return shownOnce;
};

/** What somebody typed into a field, in the unit the field is read in: a number, alone or with a unit of its kind. */
export function typed(text, field) {
  const found = /^([+-]?(?:\d+[.,]?\d*|[.,]\d+)(?:e[+-]?\d+)?)\s*(\S*)$/i.exec(text.trim().replace("−", "-"));
  if (!found) return { wrong: `“${text}” is no number` };
  if (/^[+-]?[1-9]\d{0,2},\d{3}$/.test(found[1])) {
    return { wrong: `“${found[1]}” may mean ${found[1].replace(",", "")} or ${found[1].replace(",", ".")}, write one of these` };
  }
  const value = Number(found[1].replace(",", "."));
  if (!Number.isFinite(value) || (value === 0 && /[1-9]/.test(found[1].split(/e/i)[0]))) return { wrong: `“${text}” is ${value ? "larger" : "smaller"} than any number here` };
  const unit = found[2];
  if (!unit || unit === field.unit || unit === raised(field.unit)) return { value };
  const kind = UNITS.find((each) => field.unit in each && unit in each);
  return kind ? { value: (value * kind[unit]) / kind[field.unit] } : { wrong: `“${unit}” is no unit of ${field.path}` };
}

/** Signs of plain text as they are printed. */
export const typographic = (text) => text.replaceAll("+-", "±").replaceAll(" -", " −").replace(/ u(m|s|rad)\b/g, " µ$1");

/** As many digits as a field needs to hold the number. */
export const plain = (value) => (value === null || value === undefined ? "" : String(Number(value.toPrecision(7))));

/** "friction.static [-]": the label of an axis. */
export const label = (name, unit) => `${name} [${raised(unit || "-")}]`;

/** "kg m^2" with its power raised. */
export const raised = (unit) => unit.replaceAll("^2", "²").replaceAll("^3", "³");

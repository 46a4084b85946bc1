// The friction curve with the speeds at which the contacts slide, and the range the motion passes through.

import { Chart, band, line, points, span, text, upright } from "../chart.js";
import { row } from "../connection.js";
import { label, shown } from "../numbers.js";

export default {
  setup(panel) {
    panel.charts = [new Chart(panel.body, { name: "friction", height: 300 })];
    panel.app.addEventListener("motion", () => panel.frame && draw(panel, panel.frame));
  },

  options: () => ({}),

  draw(panel, frame) {
    panel.frame = frame;
    draw(panel, frame);
  },
};

function draw(panel, { data, arrays }) {
  const curves = data.laws.map((_, i) => row(arrays.mu, i));
  const sliding = data.contacts.filter((contact) => contact.speed !== null);
  const speeds = sliding.map((contact) => Math.abs(contact.speed));
  const top = arrays.speed.at(-1);
  const names = data.laws.length > 1 ? (i) => ({ name: data.laws[i] }) : (i) => ({ column: data.laws[i] });
  const range = operating(panel, top);
  panel.charts[0].draw({
    x: { label: label("sliding speed |v|", "m/s"), domain: [0, top] },
    y: { label: label("friction coefficient", ""), domain: span([...curves, data.static], { with0: true }) },
    layers: [
      ...(range ? [band(range[0], range[1], { cls: "operating", name: "passed" })] : []),
      ...[...new Set(speeds)].map((speed) => upright(speed)),
      ...curves.map((mu, i) => line(arrays.speed, mu, { cls: `s${i % 7}`, ...names(i) })),
      points(data.static.map(() => 0), data.static, { cls: "begin", r: 4, column: "static limit" }),
      points(speeds, sliding.map((contact) => contact.mu), { column: "contacts at steady sliding" }),
      ...tangents(sliding, top),
      ...(range ? [text((range[0] + range[1]) / 2, span([...curves, data.static], { with0: true })[0], "range of the motion", { dy: -6 })] : []),
    ],
  });
  const falling = sliding.filter((contact) => contact.slope < 0);
  panel.remark = data.outcome !== "completed" ? `${data.message}.`
    : falling.length ? `Friction falls with speed at ${falling.length} of ${sliding.length} contacts, slope ${shown(falling[0].slope)} s/m: it takes damping away.`
      : "Friction does not fall with speed here.";
}

/** A short tangent at each operating point: the slope that takes damping away. */
function tangents(contacts, top) {
  const half = 0.07 * top;
  return contacts.map(({ speed, mu, slope }) => line([Math.abs(speed) - half, Math.abs(speed) + half], [mu - slope * half, mu + slope * half], { cls: "tangent", column: "tangent" }));
}

/** The sliding speeds the last motion passed, while it belongs to this design. */
function operating(panel, top) {
  const { motion } = panel.app;
  if (!motion?.speeds?.length) return null;
  const ends = motion.speeds.map(([low, high]) => [low <= 0 && high >= 0 ? 0 : Math.min(Math.abs(low), Math.abs(high)), Math.max(Math.abs(low), Math.abs(high))]);
  return [Math.min(...ends.map((e) => e[0])), Math.min(top, Math.max(...ends.map((e) => e[1])))];
}

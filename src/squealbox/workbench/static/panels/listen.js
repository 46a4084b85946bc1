// The motion as sound, true or slowed with the picture, as it slides or braking to rest; now and before, and as files.

import { Asked, button } from "../asked.js";
import { Chart, hull, line, span, text } from "../chart.js";
import { sequential } from "../colours.js";
import { choose, make } from "../elements.js";
import { download } from "../export.js";
import { label, shown, typographic, withUnit } from "../numbers.js";
import { fullScale, silence, sound } from "../sound.js";
import { degrees, startOf } from "../start.js";
import { wavBlob } from "../wav.js";

const COLUMNS = 400; // of the time history: the least and largest value in each
const SLOW = [["1", "true"], ["8", "slowed 8 times"], ["32", "slowed 32 times"]];
const STOPS = [["0", "as it slides"], ...["0.5", "1", "2", "4"].map((seconds) => [seconds, `braking to rest in ${seconds} s`])];

export default {
  setup(panel) {
    panel.heard = { now: null, kept: null };
    panel.asked = new Asked(panel, "Press Play.");
    panel.keys = {
      now: button("Play", () => play(panel, "now"), { title: "Compute and play the motion of this design" }),
      keep: button("Keep as before", () => figure(panel, (panel.heard.kept = panel.heard.now), (panel.keys.kept.disabled = false)), { disabled: true, title: "Keep this sound, then change the design and play again" }),
      kept: button("Play before", () => play(panel, "kept"), { disabled: true }),
      still: button("Stop", silence),
      wav: button("WAV", () => save(panel), { disabled: true, title: "Save the sound as WAV files" }),
    };
    panel.ratio = make("input", { type: "checkbox", checked: true });
    panel.degrees = make("span");
    panel.controls.append(panel.degrees);
    panel.body.append(make("div", { class: "buttons" }, ...Object.values(panel.keys),
      choose("heard", SLOW, panel.chosen.slow ?? "1", (slow) => panel.choose({ slow })),
      choose("while", STOPS, String(panel.chosen.braking ?? 0), (braking) => panel.choose({ braking: Number(braking) })),
      make("label", { title: "Both as loud as they are to each other; else each as loud as can be" }, panel.ratio, " true ratio")));
    panel.words = make("div", { class: "quiet" });
    panel.charts = [new Chart(panel.body, { name: "sound", height: 170, awaited: "the sound: press Play" })];
    panel.body.append(panel.words);
  },

  options(panel) {
    if (!panel.asked.current) return null;
    const motion = startOf(panel.app.store);
    return { ...motion, dof: panel.chosen.dof ?? motion.dof, braking: panel.chosen.braking ?? 0 };
  },

  draw(panel, { data, arrays }) {
    degrees(panel, data);
    panel.remark = data.silent ?? typographic(data.words);
    panel.element.dataset.pitch = data.pitch ?? "";
    panel.heard.now = data.silent ? null : { ...data, ...arrays };
    panel.keys.keep.disabled = panel.keys.wav.disabled = !panel.heard.now;
    figure(panel);
    if (panel.waiting && panel.heard.now) sounding(panel, panel.heard.now);
    panel.waiting = false;
  },
};

/** Play what is kept, or the present design: computed first where that has not been done. */
function play(panel, which) {
  if (which === "kept" || (panel.asked.current && panel.heard.now && panel.element.dataset.state === "drawn")) sounding(panel, panel.heard[which]);
  else {
    panel.waiting = true;
    panel.asked.ask();
  }
}

const loudest = (panel, heard) => fullScale(heard, Object.values(panel.heard).filter(Boolean), panel.ratio.checked);

function sounding(panel, heard) {
  const { wave, rate, frameQ: q, frameForce: force, frameState: state } = heard;
  const at = (share) => {
    if (share !== null) panel.cursor?.((share * wave.length) / rate);
    panel.element.dataset.at = share ?? "";
    panel.app.dispatchEvent(new CustomEvent("played", { detail: share === null || heard !== panel.heard.now ? null : { share, q, force, state } }));
  };
  sound(heard, loudest(panel, heard), { slow: Number(panel.chosen.slow ?? 1), at });
  panel.element.dataset.played = heard.pitch;
}

function save(panel) {
  for (const [which, heard] of Object.entries(panel.heard)) {
    if (!heard) continue;
    const name = `${panel.app.stem()}${which === "kept" ? "-before" : ""}.wav`;
    download(wavBlob(heard.wave, heard.rate, loudest(panel, heard) / heard.factor), name, "audio/wav");
  }
}

function figure(panel) {
  const { now, kept } = panel.heard;
  const first = [now, kept].filter(Boolean).reduce((a, b) => (a && a.largest >= b.largest ? a : b), null);
  if (!first) return;
  panel.words.textContent = panel.says.title = `${first.assumption}${now && kept ? ` Before: ${kept.words}.` : ""}`;
  if (now?.grid) return stop(panel, now);
  const drawn = [[kept, "s1", "before"], [now, "s0", "now"]].filter(([heard]) => heard && !heard.grid).map(([heard, cls, name]) => {
    const many = Math.floor(heard.wave.length / COLUMNS);
    const ends = (most) => Float32Array.from({ length: COLUMNS }, (_, i) => (most(...heard.wave.subarray(i * many, (i + 1) * many)) * heard.factor) / first.factor);
    return hull(Float32Array.from({ length: COLUMNS }, (_, i) => ((i + 0.5) * many) / heard.rate), ends(Math.min), ends(Math.max), { cls, name });
  });
  panel.charts[0].draw({
    x: { label: label("time", "s"), domain: [0, first.wave.length / first.rate] },
    y: { label: label(first.names[first.dof], first.unit), domain: span(drawn.flatMap(({ low, high }) => [low, high])) },
    layers: drawn,
  });
  panel.cursor = (time) => now && panel.charts[0].mark(time, (now.wave[Math.round(time * now.rate)] * now.factor) / first.factor);
}

/** A stop: its spectrogram, the speed as a line from its first value to none, and the squeal events by name. */
function stop(panel, { grid, gridTime, gridTop, seconds, speed, speedUnit, events }) {
  const [rows, columns] = grid.shape;
  const scale = () => sequential(grid, { log: true });
  const height = (time) => (gridTop / 1e3) * (1 - time / seconds);
  const squeals = events.flatMap(([from, to, hertz, level]) => [
    line([from, to], [hertz / 1e3, hertz / 1e3], { cls: "s1" }),
    text((Math.max(from, gridTime[0]) + to) / 2, hertz / 1e3, `${withUnit(hertz, "Hz", 3)}, ${Math.round(level)} dB(A)`),
  ]);
  panel.charts[0].draw({
    x: { label: label("time", "s"), domain: gridTime },
    y: { label: label("frequency", "kHz"), domain: [0, gridTop / 1e3] },
    heat: { rows, columns, values: grid, scale, keys: () => scale().steps.map(([css, value]) => [css, `${shown(value, 2)} Pa`]), name: "sound pressure [Pa]", smooth: true },
    layers: [line(gridTime, gridTime.map(height), { cls: "s2", name: `speed ${shown(speed, 3)} to 0 ${speedUnit}` }), ...squeals],
    legend: "bottom left",
  });
  panel.cursor = (time) => panel.charts[0].mark(time, height(time));
}

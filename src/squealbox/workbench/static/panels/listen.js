// The motion as sound at its true frequency, now and before a change, and both as files.

import { Asked, button } from "../asked.js";
import { Chart, line, span } from "../chart.js";
import { make } from "../elements.js";
import { download } from "../export.js";
import { label, shown, withUnit } from "../numbers.js";
import { fullScale, silence, sound } from "../sound.js";
import { degrees, startOf } from "../start.js";
import { wavBlob } from "../wav.js";

const PERIODS = 6; // drawn, of the end of the sound
const FADED = 0.03; // s at the end that the drawing leaves out

export default {
  setup(panel) {
    panel.heard = { now: null, kept: null };
    panel.asked = new Asked(panel, "Press Play.");
    panel.keys = {
      now: button("Play", () => play(panel, "now"), { title: "Compute and play the motion of this design" }),
      keep: button("Keep as before", () => keep(panel), { disabled: true, title: "Keep this sound, then change the design and play again" }),
      kept: button("Play before", () => play(panel, "kept"), { disabled: true }),
      still: button("Stop", silence),
      wav: button("WAV", () => save(panel), { disabled: true, title: "Save the sound as WAV files" }),
    };
    panel.ratio = make("input", { type: "checkbox", checked: true });
    panel.degrees = make("span");
    panel.controls.append(panel.degrees);
    const ratio = make("label", { title: "Both as loud as they are to each other; else each as loud as can be" }, panel.ratio, " true ratio");
    panel.body.append(make("div", { class: "buttons" }, ...Object.values(panel.keys), ratio));
    panel.words = make("div", { class: "quiet" });
    panel.charts = [new Chart(panel.body, { name: "sound", height: 170, title: "The end of the sound", awaited: "the sound: press Play" })];
    panel.body.append(panel.words);
  },

  options(panel) {
    if (!panel.asked.current) return null;
    const motion = startOf(panel.app.store);
    return { ...motion, dof: panel.chosen.dof ?? motion.dof };
  },

  draw(panel, { data, arrays }) {
    degrees(panel, data);
    panel.remark = data.silent ?? `${data.names[data.dof]} at ${withUnit(data.pitch, "Hz", 5)}, ${loudness(data)}`;
    panel.element.dataset.pitch = data.pitch ?? "";
    panel.heard.now = data.silent ? null : { ...data, wave: arrays.wave };
    panel.keys.keep.disabled = panel.keys.wav.disabled = !panel.heard.now;
    figure(panel);
    if (panel.waiting && panel.heard.now) sounding(panel, panel.heard.now);
    panel.waiting = false;
  },
};

/** Play what is kept, or the present design: computed first where that has not been done. */
function play(panel, which) {
  if (which === "kept" || (panel.asked.current && panel.heard.now)) sounding(panel, panel.heard[which]);
  else {
    panel.waiting = true;
    panel.asked.ask();
  }
}

function keep(panel) {
  panel.heard.kept = panel.heard.now;
  panel.keys.kept.disabled = false;
  figure(panel);
}

/** The level while it lasts, or that it does not: the estimate looks at the end of the sound. */
const loudness = (data) => (data.level === null || data.level < 0 ? "and dies away: in the end nothing is left to hear" : `about ${shown(data.level, 3)} dB, ${shown(data.weighted, 3)} dB(A) at 1 m`);

const loudest = (panel, heard) => fullScale(heard, Object.values(panel.heard).filter(Boolean), panel.ratio.checked);

function sounding(panel, heard) {
  sound(heard, loudest(panel, heard));
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
  const many = Math.ceil((PERIODS / first.pitch) * first.rate);
  const end = first.wave.length - Math.round(FADED * first.rate);
  const x = Float32Array.from({ length: many }, (_, i) => (1e3 * i) / first.rate);
  const part = (heard) => heard.wave.subarray(end - many, end).map((value) => (value * heard.factor) / first.factor);
  const layers = [];
  if (kept) layers.push(line(x, part(kept), { cls: "s1", name: "before" }));
  if (now) layers.push(line(x, part(now), { cls: "s0", name: "now" }));
  panel.charts[0].draw({
    x: { label: label("time", "ms"), domain: [0, x.at(-1)] },
    y: { label: label(first.names[first.dof], first.unit), domain: span(layers.map((layer) => layer.y), { room: 0.25 }) },
    layers,
  });
  panel.words.textContent = `${first.assumption}${now && kept ? ` Before: ${withUnit(kept.pitch, "Hz", 5)}, ${loudness(kept)}.` : ""}`;
}

// The motion as sound, true or slowed with the picture, as it slides or braking to rest; now and before, and as files.

import { Asked } from "../asked.js";
import { span } from "../chart.js";
import { make } from "../elements.js";
import { download } from "../export.js";
import { label } from "../numbers.js";
import { fullScale, silence, sound } from "../sound.js";
import { wavBlob } from "../wav.js";

const COLUMNS = 400; // of the time history: the least and largest value in each

export default {
  setup(panel) {
    panel.heard = { now: null, kept: null };
    panel.asked = new Asked(panel, "Press Play.");
    panel.button("Play", () => play(panel, "now"), { title: "Compute and play the motion of this design" });
    panel.keys = [panel.button("Keep as before", () => keep(panel), { title: "Keep this sound, then change the design and play again" }), panel.button("Play before", () => play(panel, "kept"))];
    panel.button("Stop", silence);
    panel.wav = panel.button("WAV", () => save(panel), { disabled: true, title: "Save the sound as WAV files" });
    for (const key of panel.keys) key.disabled = true;
    panel.ratio = make("input", { type: "checkbox", checked: true });
    panel.buttons.append(make("label", { title: "Both as loud as they are to each other; else each as loud as can be" }, panel.ratio, " true ratio"));
    panel.text = make("div", { class: "quiet" });
    panel.body.append(panel.text);
  },

  options(panel) {
    if (!panel.asked.current) return null;
    const { start, push, dof } = panel.app.panels.get("motion").request()?.options ?? {};
    return { start, push, dof: panel.chosen.dof ?? dof };
  },

  draw(panel, { data, arrays }) {
    if (data.silent) panel.remark = data.silent;
    panel.element.dataset.pitch = data.pitch ?? "";
    panel.heard.now = data.silent ? null : { ...data, ...arrays };
    panel.keys[0].disabled = panel.wav.disabled = !panel.heard.now;
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

function keep(panel) {
  panel.heard.kept = panel.heard.now;
  panel.keys[1].disabled = false;
  figure(panel);
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

/** What is heard over time, now and before; a stop has its own figure. */
function figure(panel) {
  const { now, kept } = panel.heard;
  const [chart] = panel.charts;
  const first = [now, kept].filter(Boolean).reduce((a, b) => (a && a.largest >= b.largest ? a : b), null);
  if (!first) return;
  panel.text.textContent = panel.says.title = `${first.assumption}${now && kept ? ` Before: ${kept.words}.` : ""}`;
  if (now?.seconds) return (panel.cursor = (time) => chart.mark(time, chart.spec.y.domain[1] * (1 - time / now.seconds)));
  const drawn = [[kept, "s1", "before"], [now, "s0", "now"]].filter(([heard]) => heard && !heard.seconds).map(([heard, cls, name]) => {
    const many = Math.floor(heard.wave.length / COLUMNS);
    const ends = (most) => Float32Array.from({ length: COLUMNS }, (_, i) => (most(...heard.wave.subarray(i * many, (i + 1) * many)) * heard.factor) / first.factor);
    return { kind: "hull", x: Float32Array.from({ length: COLUMNS }, (_, i) => ((i + 0.5) * many) / heard.rate), low: ends(Math.min), high: ends(Math.max), cls, name };
  });
  chart.draw({
    x: { label: label("time", "s"), domain: [0, first.wave.length / first.rate] },
    y: { label: label(first.names[first.dof], first.unit), domain: span(drawn.flatMap(({ low, high }) => [low, high])) },
    layers: drawn,
  });
  panel.cursor = (time) => now && chart.mark(time, (now.wave[Math.round(time * now.rate)] * now.factor) / first.factor);
}

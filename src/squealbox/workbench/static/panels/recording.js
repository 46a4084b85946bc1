// A recording of the brake: dropped onto the page, kept on this machine; its events, beside what the model says.

import { button } from "../asked.js";
import { Chart, line } from "../chart.js";
import { sequential } from "../colours.js";
import { choose, make, note, table } from "../elements.js";
import { label, shown, withUnit } from "../numbers.js";
import { sound } from "../sound.js";

const LIKE = [[[0, 0.3], [0.2, 0.3], [0.25, 0.6], [0.7, 0.58], [0.75, 0.3], [1, 0.3]]];

export default {
  setup(panel) {
    panel.file = make("input", { type: "file", accept: ".wav,.flac,.ogg,.csv,.npy,.uff,.unv", "aria-label": "Recording", onchange: () => panel.take(panel.file.files[0]) });
    panel.scale = make("input", { type: "text", size: 6, value: panel.chosen.full_scale ?? 1, "aria-label": "One is worth", onchange: () => panel.choose({ full_scale: Number(panel.scale.value.replace(",", ".")) }) });
    panel.controls.append(panel.file, choose("unit", [["FS", "not calibrated"], ["Pa", "Pa"], ["g", "g"], ["m/s^2", "m/s²"]], panel.chosen.unit ?? "FS", (unit) => panel.choose({ unit })), make("label", {}, "1 is worth ", panel.scale));
    panel.keys = [button("Hear the recording", () => hear(panel), { disabled: true }), button("Hear the model", () => model(panel), { disabled: true })];
    const place = make("div", { class: "charts two" });
    panel.list = make("div", { class: "scroller", role: "region", tabindex: 0, "aria-label": "Squeal events" });
    panel.body.append(make("div", { class: "buttons" }, ...panel.keys), place);
    panel.charts = [new Chart(place, { name: "recording", title: "Spectrogram with the events", height: 230, like: LIKE, awaited: "drop a recording here: WAV, FLAC, CSV, UFF" })];
    panel.list.append(make("p", { class: "quiet" }, "Here stand the squeal events: onset, frequency, level, growth; and the model beside the one you choose."));
    place.append(panel.list);
    panel.take = (file) => take(panel, file);
    panel.says.textContent = "Drop a recording anywhere on the page. It stays on this machine.";
    panel.element.dataset.state = "idle";
  },

  options: (panel) => (panel.id ? asked(panel) : null),

  draw(panel, { data, arrays }) {
    panel.data = data;
    const [rows, columns] = arrays.grid.shape;
    const scale = () => sequential(arrays.grid, { log: true });
    const keys = () => scale().steps.map(([css, value]) => [css, shown(value, 2)]);
    panel.charts[0].draw({
      x: { label: label("time", "s"), domain: data.gridTime },
      y: { label: label("frequency", "kHz"), domain: [0, data.gridTop / 1e3] },
      heat: { rows, columns, values: arrays.grid, scale, keys, name: "amplitude", smooth: true },
      layers: data.events.map((each, i) => line([each.onset, each.end], [each.frequency / 1e3, each.frequency / 1e3], { cls: i === data.event ? "s1" : "s5", column: `event ${i + 1}` })),
    });
    panel.list.replaceChildren(events(panel, data), ...(data.compared.length ? [beside(data)] : []));
    for (const key of panel.keys) key.disabled = false;
    panel.element.dataset.events = data.count;
    const counted = data.count ? `${data.count} event${data.count > 1 ? "s" : ""}, ${shown(100 * data.occurrence, 3)} % of ${shown(data.duration, 3)} s.` : `${data.message || "No squeal event"}.`;
    panel.remark = [counted, ...data.notes.map((each) => `${each}.`)].join(" ");
  },
};

export const asked = (panel) => {
  const { unit, full_scale, event } = panel.chosen;
  return { id: panel.id, unit, full_scale, event };
};

async function take(panel, file) {
  if (!file) return;
  const answer = await fetch(`/recording?name=${encodeURIComponent(file.name)}`, { method: "POST", body: file }).catch(() => null);
  const found = answer ? await answer.json().catch(() => ({})) : {};
  if (!found.id) return note(found.message ?? "The recording was not taken: the server does not answer.");
  Object.assign(panel, { id: found.id, taken: file });
  panel.app.questions.askFor("recording");
  panel.choose({ event: undefined });
}

async function hear(panel) {
  const audio = new OfflineAudioContext(1, 1, 44100);
  const decoded = await panel.taken.arrayBuffer().then((bytes) => audio.decodeAudioData(bytes)).catch(() => null);
  if (!decoded) return note("The browser cannot play this kind of recording.");
  const wave = decoded.getChannelData(0);
  sound({ wave, rate: decoded.sampleRate, factor: 1 }, wave.reduce((most, each) => Math.max(most, Math.abs(each)), 1e-9));
}

async function model(panel) {
  const frame = await panel.app.connection.ask({ view: "listen", state: panel.app.store.design, options: {} }).catch(() => null);
  if (!frame?.arrays?.wave) return note(frame?.data?.silent ?? "No sound of the model.");
  sound({ ...frame.data, wave: frame.arrays.wave }, frame.data.largest);
}

function events(panel, data) {
  const rate = (value, error) => (value === null ? "–" : `${shown(value, 3)}${error === null ? "" : ` ± ${shown(error, 2)}`}`);
  const pick = (each, i) => button(`${shown(each.onset, 4)} s`, () => panel.choose({ event: i }), { "aria-label": `Event at ${shown(each.onset, 4)} s`, "aria-pressed": i === data.event });
  const rows = data.events.map((each, i) => [pick(each, i), `${shown(each.end - each.onset, 3)} s`, withUnit(each.frequency, "Hz", 5), shown(each.level, 3), rate(each.growth_rate, each.growth_error)]);
  return table(["onset", "lasts", "frequency", `level ${data.unit}`, "growth 1/s"], rows, { class: "cures" });
}

function beside(data) {
  const rows = data.compared.map(([name, simulated, measured, error, away]) => [`${name} ${{ frequency: "Hz", "growth rate": "1/s" }[name] ?? ""}`, shown(simulated, 5), `${shown(measured, 5)}${error === null ? "" : ` ± ${shown(error, 2)}`}`, away === null ? "–" : `${shown(away, 3)} sd`]);
  return table(["that event", "model", "measured", "apart"], rows, { class: "cures" });
}

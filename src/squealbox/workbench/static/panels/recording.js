// A recording of the brake: dropped onto the page, kept on this machine; its events, beside what the model says.

import { button, make, note, table } from "../elements.js";
import { shown, withUnit } from "../numbers.js";
import { sound } from "../sound.js";

export default {
  setup(panel) {
    panel.file = make("input", { type: "file", accept: ".wav,.flac,.ogg,.csv,.npy,.uff,.unv", "aria-label": "Recording", onchange: () => panel.take(panel.file.files[0]) });
    panel.controls.prepend(panel.file);
    panel.keys = [panel.button("Hear the recording", () => hear(panel), { disabled: true }), panel.button("Hear the model", () => model(panel), { disabled: true })];
    panel.events = make("div", {}, make("p", { class: "quiet" }, "Here stand the squeal events: onset, frequency, level, growth; and the model beside the one you choose."));
    panel.list.prepend(panel.events);
    panel.place.append(panel.list);
    panel.take = (file) => take(panel, file);
    panel.says.textContent = "Drop a recording anywhere on the page. It stays on this machine.";
    panel.element.dataset.state = "idle";
  },

  options: ({ id, chosen }) => (id ? { id, event: chosen.event } : null),

  draw(panel, { data }) {
    panel.list.prepend(events(panel, data));
    for (const key of panel.keys) key.disabled = false;
    const { frequency, growth_rate } = data.events[data.event] ?? {};
    panel.app.hearing(data.events.length ? { frequency, "growth rate": growth_rate ?? undefined } : {});
  },
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
  return table(["onset", "lasts", "frequency", `level ${data.unit}`, "growth 1/s"], rows, { class: "numbers" });
}

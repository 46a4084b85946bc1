// Sound of what the server computed: as loud to each other as the estimates say, or each as loud as can be.

let audio = null;
let source = null;

/** What full scale stands for [m]: its own largest value, or more by what it is quieter than the loudest of `others`. */
export function fullScale(heard, others, ratio = true) {
  const level = (each) => each.weighted ?? -Infinity;
  const most = Math.max(...others.map(level));
  return heard.largest * (ratio && Number.isFinite(most) ? 10 ** ((most - level(heard)) / 20) : 1);
}

export function silence() {
  source?.stop();
  source = null;
}

/** Play samples so that `full` [m] is 0.9 of full scale. */
export function sound(heard, full) {
  audio ??= new AudioContext();
  audio.resume();
  silence();
  const buffer = audio.createBuffer(1, heard.wave.length, heard.rate);
  const scale = (0.9 * heard.factor) / full;
  buffer.copyToChannel(heard.wave.map((value) => value * scale), 0);
  source = audio.createBufferSource();
  source.buffer = buffer;
  source.connect(audio.destination);
  source.start();
}

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

/** Play samples so that `full` [m] is 0.9 of full scale, `slow` times slower; `at` is told which share has been heard, null at the end. */
export function sound(heard, full, { slow = 1, at = () => {} } = {}) {
  audio ??= new AudioContext();
  audio.resume();
  silence();
  const buffer = audio.createBuffer(1, heard.wave.length, heard.rate);
  const scale = (0.9 * heard.factor) / full;
  buffer.copyToChannel(heard.wave.map((value) => value * scale), 0);
  const playing = (source = audio.createBufferSource());
  playing.buffer = buffer;
  playing.playbackRate.value = 1 / slow;
  playing.connect(audio.destination);
  const begun = audio.currentTime;
  playing.start();
  playing.onended = () => source !== playing && source ? null : at((source = null));
  const look = () => {
    if (source !== playing) return;
    at(Math.min(0.9999, (audio.currentTime - begun) / slow / buffer.duration));
    requestAnimationFrame(look);
  };
  look();
}

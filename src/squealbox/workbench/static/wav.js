// Samples as a WAV file: one channel, 16 bits.

/** `wave` in any unit; a value of size `loudest` becomes 0.9 of full scale. */
export function wavBlob(wave, rate, loudest) {
  const bytes = new DataView(new ArrayBuffer(44 + 2 * wave.length));
  const text = (at, letters) => [...letters].forEach((letter, i) => bytes.setUint8(at + i, letter.charCodeAt(0)));
  text(0, "RIFF");
  text(8, "WAVEfmt ");
  text(36, "data");
  for (const [at, value] of [[4, 36 + 2 * wave.length], [16, 16], [24, rate], [28, 2 * rate], [40, 2 * wave.length]]) bytes.setUint32(at, value, true);
  for (const [at, value] of [[20, 1], [22, 1], [32, 2], [34, 16]]) bytes.setUint16(at, value, true); // plain samples, one channel
  const scale = (0.9 * 32767) / loudest;
  for (let i = 0; i < wave.length; i++) bytes.setInt16(44 + 2 * i, Math.max(-32767, Math.min(32767, Math.round(wave[i] * scale))), true);
  return new Blob([bytes], { type: "audio/wav" });
}

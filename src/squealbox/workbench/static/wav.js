// Samples as a WAV file: one channel, 16 bits.

/** `wave` in any unit; a value of size `loudest` becomes 0.9 of full scale. */
export function wavBlob(wave, rate, loudest) {
  const bytes = new DataView(new ArrayBuffer(44 + 2 * wave.length));
  const text = (at, letters) => [...letters].forEach((letter, i) => bytes.setUint8(at + i, letter.charCodeAt(0)));
  text(0, "RIFF");
  bytes.setUint32(4, 36 + 2 * wave.length, true);
  text(8, "WAVEfmt ");
  bytes.setUint32(16, 16, true);
  bytes.setUint16(20, 1, true); // plain samples
  bytes.setUint16(22, 1, true); // one channel
  bytes.setUint32(24, rate, true);
  bytes.setUint32(28, 2 * rate, true);
  bytes.setUint16(32, 2, true);
  bytes.setUint16(34, 16, true);
  text(36, "data");
  bytes.setUint32(40, 2 * wave.length, true);
  const scale = (0.9 * 32767) / loudest;
  for (let i = 0; i < wave.length; i++) bytes.setInt16(44 + 2 * i, Math.max(-32767, Math.min(32767, Math.round(wave[i] * scale))), true);
  return new Blob([bytes], { type: "audio/wav" });
}

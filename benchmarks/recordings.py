"""Growth rate and frequency against the bound of Cramer and Rao, the detector of squeal events, and damaged files.

python benchmarks/recordings.py [records of each kind] [hours of noise] [damaged files]
"""

import resource
import sys
import tempfile
import time
import warnings
from pathlib import Path

import numpy as np
from scipy.signal import butter, lfilter

from squealbox.signals import Recording, SignalError, growth_rate, read_recording, squeal_events

RATE, TONE = 48_000.0, 2000.3
WHITE = ([1.0], [1.0])
KINDS = {  # growth, samples, noise over the largest amplitude, further tones, filter of the noise
    "steady": (0.0, 4800, 0.1, (), WHITE),
    "growing": (30.0, 4800, 0.1, (), WHITE),
    "burst": (100.0, 4800, 0.05, (), WHITE),
    "short burst": (700.0, 9600, 0.02, (), WHITE),
    "decaying": (-60.0, 9600, 0.05, (), WHITE),
    "two tones": (0.0, 4800, 0.1, ((0.0, 2100.0, 0.5, 0.7),), WHITE),
    "two near tones": (0.0, 4800, 0.1, ((0.0, 2040.0, 0.5, 0.7),), WHITE),
    "noisy": (0.0, 4800, 0.7, (), WHITE),
    "steady, red noise": (0.0, 4800, 0.1, (), ([1.0], [1.0, -0.9])),
    "decaying, red noise": (-60.0, 9600, 0.05, (), ([1.0], [1.0, -0.9])),
    "steady, low pass": (0.0, 4800, 0.1, (), butter(2, 6000.0, fs=RATE)),
    "steady, steep low pass": (0.0, 4800, 0.1, (), butter(4, 1500.0, fs=RATE)),
    "growing, high pass": (30.0, 4800, 0.1, (), butter(2, 5000.0, "high", fs=RATE)),
    "steady, band pass": (0.0, 4800, 0.1, (), butter(2, [1500.0, 4000.0], "band", fs=RATE)),
    "steady, resonance": (0.0, 4800, 0.1, (), ([1.0], [1.0, -1.9 * np.cos(0.4), 0.9025])),
}


def bound(t, growth, amplitude, phase, noise, others):
    columns = []
    for g, f, a, p in ((growth, TONE, amplitude, phase), *others):
        e, w = np.exp(g * t), 2 * np.pi * f
        c, s = np.cos(w * t + p), np.sin(w * t + p)
        columns += [e * c, -a * e * s, a * t * e * c, -a * t * e * s]
    J = np.stack([*columns, np.ones_like(t)], axis=1)
    scale = np.linalg.norm(J, axis=0)
    variance = np.diag(np.linalg.inv((J / scale).T @ (J / scale))) / scale**2 * noise**2
    return np.sqrt(variance[2]), np.sqrt(variance[3]) / (2 * np.pi)


def growth(records):
    print(f"{'kind':20}  rate: rms/bound, cover   frequency: rms/bound, cover   not told   ms each")
    for kind, (g, count, noise, others, (ahead, back)) in KINDS.items():
        t, rng = np.arange(count) / RATE, np.random.default_rng(2)
        amplitude = 1.0 if g <= 0.0 else float(np.exp(-g * t[-1]))
        misses, held, refused, spent = [], [], 0, 0.0
        for _ in range(records):
            phase = rng.uniform(0.0, 2 * np.pi)
            x = amplitude * np.exp(g * t) * np.cos(2 * np.pi * TONE * t + phase)
            for g2, f2, a2, p2 in others:
                x = x + a2 * np.exp(g2 * t) * np.cos(2 * np.pi * f2 * t + p2)
            turn = np.exp(-2j * np.pi * TONE / RATE)
            gain = abs(np.polyval(back[::-1], turn) / np.polyval(ahead[::-1], turn))
            x = x + noise * gain * lfilter(ahead, back, rng.standard_normal(count + 2000))[2000:]
            begun = time.process_time()
            try:
                found = growth_rate(x, rate=RATE)
            except SignalError:
                refused += 1
                continue
            finally:
                spent += time.process_time() - begun
            misses.append((found.rate - g, found.frequency - TONE))
            held.append((abs(misses[-1][0]) <= found.rate_error, abs(misses[-1][1]) <= found.frequency_error))
        rms = np.sqrt(np.mean(np.square(misses), axis=0)) / bound(t, g, amplitude, 0.3, noise, others)
        cover = np.mean(held, axis=0)
        print(
            f"{kind:20}  {rms[0]:12.3f} {cover[0]:9.3f}  {rms[1]:20.3f} {cover[1]:9.3f}  {refused:8d}  "
            f"{1e3 * spent / records:8.1f}"
        )


def events(hours):
    length = 2048
    w = np.sin(np.pi * np.arange(length) / length) ** 2
    for decibel in (11.4, 13.0, 15.0):
        found, late, extra = 0, [], 0
        for seed in range(60):
            rng, t = np.random.default_rng(seed), np.arange(int(2 * RATE)) / RATE
            amplitude = np.sqrt(4.0 * 0.01 * np.sum(w**2) / np.sum(w) ** 2 * 10.0 ** (decibel / 10.0))
            frequency, begin = rng.uniform(2200.0, 15000.0), rng.uniform(0.3, 0.8)
            on = (t > begin) & (t < begin + 0.7)
            x = 0.1 * rng.standard_normal(t.size) + amplitude * np.sin(2 * np.pi * frequency * t) * on
            seen = squeal_events(x, RATE, least_level=None)
            near = np.abs(seen.frequency - frequency) < 30.0
            found += bool(np.any(near))
            extra += seen.count - int(np.count_nonzero(near))
            late += [abs(seen.onset[near][0] - begin)] if np.any(near) else []
        print(f"{decibel:4.1f} dB: {found} of 60, onsets to {max(late, default=0) / 0.010667:.1f} hops, {extra} others")
    false, spent, minutes = 0, 0.0, max(round(60 * hours), 1)
    for minute in range(minutes):
        x = np.random.default_rng(1000 + minute).standard_normal(int(60 * RATE))
        begun = time.process_time()
        false += squeal_events(x, RATE, least_level=None).count
        spent += time.process_time() - begun
    print(f"noise: {false} false events in {minutes / 60:.2f} h, {60 * minutes / spent:.0f} times real time")


def whole_files(folder):
    """A small file of each kind that is read."""
    import pyuff
    import soundfile

    x = 0.1 * np.random.default_rng(0).standard_normal((600, 2))
    t = np.arange(600) / 8000.0
    for ending in ("wav", "flac", "ogg", "aiff"):
        soundfile.write(folder / f"whole.{ending}", x, 8000)
    np.save(folder / "whole.npy", x)
    table = "\n".join(f"{a!r};{b!r}" for a, b in zip(t.tolist(), x[:, 0].tolist(), strict=True))
    (folder / "whole.csv").write_text("t [s];mic [Pa]\n" + table)
    for kind in (0, 1):
        file = pyuff.UFF(str(folder / f"whole{kind}.uff"))
        file.write_sets(pyuff.prepare_58(
            binary=kind, func_type=1, rsp_node=1, rsp_dir=1, ref_dir=1, ref_node=1, data=x[:, 0], x=t, id1="mic",
            rsp_ent_name="b", ref_ent_name="b", abscissa_spacing=1, abscissa_spec_data_type=17,
            ordinate_spec_data_type=12, orddenom_spec_data_type=13,
        ), mode="overwrite")  # fmt: skip
    return sorted(folder.glob("whole*"))


def spoiled(whole, rng):
    """The bytes of a file cut, overwritten, doubled, or with one number of it made absurd."""
    bad = bytearray(whole)
    way = int(rng.integers(5))
    if way == 0:
        return bytes(bad[: rng.integers(len(bad))])
    if way == 1:
        return bytes(bad) + bytes(rng.integers(0, 256, size=rng.integers(1, 4000), dtype=np.uint8))
    if way == 2:
        place = int(rng.integers(min(len(bad), 120)))
        bad[place : place + 4] = bytes(rng.choice([0, 1, 127, 255], size=4).astype(np.uint8))
    elif way == 3:
        text = rng.choice([b"nan", b"1e999", b"-1", b"\x00", b"1e300", b"9" * 30, b"\n", b";;"])
        place = int(rng.integers(len(bad)))
        bad[place : place + len(text)] = text
    else:
        for place in rng.integers(0, len(bad), size=8):
            bad[place] = rng.integers(256)
    return bytes(bad)


def damaged(count):
    rng, said, read, longest = np.random.default_rng(7), 0, 0, 0.0
    with tempfile.TemporaryDirectory() as name:
        wholes = whole_files(Path(name))
        before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        for i in range(count):
            whole = wholes[i % len(wholes)]
            path = whole.with_name(f"damaged{whole.suffix}")
            path.write_bytes(spoiled(whole.read_bytes(), rng))
            begun = time.process_time()
            try:
                with warnings.catch_warnings():
                    warnings.simplefilter("error")
                    found: Recording = read_recording(path, rate=8000.0)
                    squeal_events(found, band=(500.0, 3000.0), frame=0.01)
                read += 1
            except SignalError as error:
                said += 1
                if "\n" in str(error) or not str(error):
                    print(f"not one sentence: {error!r}")
            except Exception as error:
                print(f"{whole.name}, {i}: {type(error).__name__}: {error}")
            longest = max(longest, time.process_time() - begun)
        grown = (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) / 1024
    told = f"{said} told in a sentence, {read} read"
    print(f"{count} damaged files: {told}, the slowest {longest:.2f} s, {grown:.0f} MB more")


if __name__ == "__main__":
    damaged(int(sys.argv[3]) if len(sys.argv) > 3 else 10_000)
    growth(int(sys.argv[1]) if len(sys.argv) > 1 else 500)
    events(float(sys.argv[2]) if len(sys.argv) > 2 else 10.0)

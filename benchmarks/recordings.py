"""Growth rate and frequency against the bound of Cramer and Rao, and the detector of squeal events, in full counts.

python benchmarks/recordings.py [records of each kind] [hours of noise]
"""

import sys
import time

import numpy as np
from scipy.signal import lfilter

from squealbox.signals import SignalError, growth_rate, squeal_events

RATE, TONE = 48_000.0, 2000.3
KINDS = {  # growth, samples, noise over the largest amplitude, further tones, colour
    "steady": (0.0, 4800, 0.1, (), 0.0),
    "growing": (30.0, 4800, 0.1, (), 0.0),
    "burst": (100.0, 4800, 0.05, (), 0.0),
    "decaying": (-60.0, 9600, 0.05, (), 0.0),
    "two tones": (0.0, 4800, 0.1, ((0.0, 2100.0, 0.5, 0.7),), 0.0),
    "noisy": (0.0, 4800, 0.7, (), 0.0),
    "steady, red noise": (0.0, 4800, 0.1, (), 0.9),
    "decaying, red noise": (-60.0, 9600, 0.05, (), 0.9),
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
    for kind, (g, count, noise, others, colour) in KINDS.items():
        t, rng = np.arange(count) / RATE, np.random.default_rng(2)
        amplitude = 1.0 if g <= 0.0 else float(np.exp(-g * t[-1]))
        misses, held, refused, spent = [], [], 0, 0.0
        for _ in range(records):
            phase = rng.uniform(0.0, 2 * np.pi)
            x = amplitude * np.exp(g * t) * np.cos(2 * np.pi * TONE * t + phase)
            for g2, f2, a2, p2 in others:
                x = x + a2 * np.exp(g2 * t) * np.cos(2 * np.pi * f2 * t + p2)
            gain = abs(1.0 - colour * np.exp(-2j * np.pi * TONE / RATE))
            x = x + noise * gain * lfilter([1.0], [1.0, -colour], rng.standard_normal(count + 500))[500:]
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


if __name__ == "__main__":
    growth(int(sys.argv[1]) if len(sys.argv) > 1 else 500)
    events(float(sys.argv[2]) if len(sys.argv) > 2 else 10.0)

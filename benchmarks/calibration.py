"""Calibration in full counts: coverage of the 95 % intervals, designs a second, the round trip.

python benchmarks/calibration.py [data sets] [stops]
"""

import sys
import time

import numpy as np

from squealbox import DrumBrake, LinearSlope, Measured, calibrate, complex_modes, squeal_events
from squealbox.calibration.calibrate import _Problem
from squealbox.signals import Recording

BRAKE = DrumBrake(friction=LinearSlope(static=0.36, slope=-0.05))
BOUNDS = {"k3": (1.5e8, 2.3e8), "friction.static": (0.3, 0.42)}
TRUTH = np.array([1.9e8, 0.36])
RATE = 48_000.0


def coverage(sets):
    mode = complex_modes(BRAKE).most_unstable
    held, begun = np.zeros(2), time.process_time()
    for seed in range(sets):
        rng = np.random.default_rng(seed)
        data = [
            Measured("growth_rate", mode.growth_rate + 20.0 * rng.standard_normal(), sd=20.0),
            Measured("frequency", mode.frequency + rng.standard_normal(), sd=1.0),
        ]
        found = calibrate(BRAKE, BOUNDS, data, seed=seed)
        held += (found.low <= TRUTH) & (found.high >= TRUTH)
    print(f"95 % intervals hold {held / sets} over {sets} data sets, {(time.process_time() - begun) / sets:.2f} s each")


def speed(count=50_000):
    data = [Measured("growth_rate", 536.0, sd=20.0), Measured("frequency", 2078.0, sd=1.0)]
    problem = _Problem(BRAKE, tuple(BOUNDS), list(BOUNDS.values()), data)
    u = np.random.default_rng(0).uniform(size=(count, 2))
    problem(u[:10])
    begun = time.process_time()
    problem(u)
    print(f"{count / (time.process_time() - begun):.0f} designs a second")


def round_trip(stops):
    mode = complex_modes(BRAKE).most_unstable
    g, f = float(mode.growth_rate), float(mode.frequency)
    t = np.arange(int(1.2 * RATE)) / RATE
    envelope = np.exp(g * np.minimum(t - 0.4, 0.0) - 200.0 * np.maximum(t - 0.9, 0.0))
    right, within, held = 0, 0, np.zeros(2)
    for seed in range(stops):
        rng = np.random.default_rng(seed)
        x = envelope * np.sin(2 * np.pi * f * t + rng.uniform(0.0, 6.28)) + 0.01 * rng.standard_normal(t.size)
        events = squeal_events(Recording(x, RATE, ("mic",), ("Pa",)))
        right += abs(events.frequency[0] - f) < 0.1
        sd = float(events.growth_error[0]) / 1.96
        within += abs(events.growth_rate[0] - g) < 2.0 * sd
        data = [
            Measured("growth_rate", float(events.growth_rate[0]), sd=sd),
            Measured("frequency", float(events.frequency[0]), sd=float(events.frequency_error[0]) / 1.96),
        ]
        found = calibrate(BRAKE, BOUNDS, data, seed=seed)
        held += (found.low <= TRUTH) & (found.high >= TRUTH)
    print(f"{stops} round trips: frequency to 0.1 Hz {right}, growth within 2 sd {within}, held {held / stops}")


if __name__ == "__main__":
    speed()
    coverage(int(sys.argv[1]) if len(sys.argv) > 1 else 500)
    round_trip(int(sys.argv[2]) if len(sys.argv) > 2 else 200)

"""Calibration in full counts: closed forms, coverage of the 95 % intervals, designs a second, the round trip.

python benchmarks/calibration.py [data sets] [stops]

A stop of the round trip is the exact motion of a drum whose parameters are drawn, with sliding speed and loads falling,
rendered as sound in noise; its event is detected, two parameters are calibrated on the event's onset, each against the
numbers the motion itself has: frequency and level of its squeal, growth and frequency of its mode. The frequency counts
as right within 0.1 Hz, where speed and loads fall and it with them within its spread.
"""

import sys
import time

import numpy as np
from scipy.signal import butter, sosfiltfilt

from squealbox import DrumBrake, LinearSlope, Measured, System, calibrate, complex_modes, simulate
from squealbox.calibration import from_events
from squealbox.calibration.calibrating import _Problem
from squealbox.schedules import Ramp
from squealbox.signals import a_weighting, rendered, squeal_events
from squealbox.signals.radiation import HEARING

BRAKE = DrumBrake(friction=LinearSlope(static=0.36, slope=-0.05))
BOUNDS = {"k3": (1.5e8, 2.3e8), "friction.static": (0.3, 0.42)}
RATE = 96_000.0


def coupled(p):
    k, D = np.asarray(p["k"], dtype=float), np.asarray(p["D"], dtype=float)
    K = np.stack([np.stack([2 * k, k * (1 - D)], -1), np.stack([k, 2 * k], -1)], -2)
    return System(np.eye(2), np.zeros((2, 2)), K)


def closed_forms():
    worst = 0.0
    for growth, frequency in ((12.8, 260.0), (200.0, 2000.0), (75.0, 900.0), (600.0, 5000.0)):
        w = 2.0 * np.pi * frequency
        truth = np.array([(w**2 - growth**2) / 2.0, 1.0 + 16.0 * growth**2 * w**2 / (w**2 - growth**2) ** 2])
        data = [Measured("growth_rate", growth, sd=5.0), Measured("frequency", frequency, sd=1.0)]
        found = calibrate(coupled, {"k": (0.3 * truth[0], 2.5 * truth[0]), "D": (1.0, 1.3)}, data, profile=False)
        worst = max(worst, float(np.max(np.abs(found.values / truth - 1.0))))
    print(f"mode coupling from growth and frequency: {worst:.1e} of the closed form")


def coverage(name, design, bounds, truth, of, sets):
    exact = [float(np.ravel(each.predicted(design.replace(dict(each.at))))[0]) for each in of(np.zeros(9))]
    held, spent = np.zeros(len(bounds)), 0.0
    for seed in range(sets):
        data = of(np.random.default_rng(seed).standard_normal(9))
        data = [each.replace(value=value + each.value * each.sd) for each, value in zip(data, exact, strict=True)]
        begun = time.process_time()
        found = calibrate(design, bounds, data, seed=seed)
        spent += time.process_time() - begun
        held += (found.low <= truth) & (found.high >= truth)
    print(f"{name}: 95 % intervals hold {held / sets} over {sets} data sets, {spent / sets:.2f} s each")


def drum(z):
    return [Measured("growth_rate", z[0], sd=20.0), Measured("frequency", z[1], sd=1.0)]


def three(z):
    quiet = {"friction.static": 0.2}
    tests = [Measured("frequency", z[2 + i], sd=2.0, mode=i, at=quiet) for i in (0, 1)]
    return [*drum(z), *tests]


def speed(count=50_000):
    data = [Measured("growth_rate", 536.0, sd=20.0), Measured("frequency", 2078.0, sd=1.0)]
    problem = _Problem(BRAKE, tuple(BOUNDS), list(BOUNDS.values()), data)
    u = np.random.default_rng(0).uniform(size=(count, 2))
    problem(u[:10])
    begun, clock = time.process_time(), time.perf_counter()
    problem(u)
    spent, passed = time.process_time() - begun, time.perf_counter() - clock
    print(f"{count / passed:.0f} designs a second, {count / spent:.0f} in a second of one core")


def posterior():
    found = calibrate(
        lambda p: p, {"a": (0.0, 4.0), "b": (-1.0, 3.0)},
        [Measured(lambda at: at["a"] + at["b"], 3.0, sd=0.1), Measured(lambda at: at["a"] - at["b"], 1.0, sd=0.2)],
    )  # fmt: skip
    drawn = np.quantile(found.posterior(40_000, seed=1), (0.025, 0.975), axis=0)
    print(f"widths, posterior over profile, linear: {np.diff(drawn, axis=0)[0] / (found.high - found.low)}")


def round_trip(stops):
    right = within = loud = told = 0
    held, spent = np.zeros(2), 0.0
    duration, names = 0.25, ("k3", "friction.static")
    for seed in range(stops):
        rng = np.random.default_rng(seed)
        truth = np.array([rng.uniform(1.85e8, 1.95e8), rng.uniform(0.35, 0.38)])
        design = BRAKE.replace(dict(zip(names, truth, strict=True)))
        braking = {"sliding_speed": Ramp(0.2, -0.2), "load1": Ramp(1000.0, -400.0), "load2": Ramp(1000.0, -400.0)}
        braking = braking if seed % 2 else {}  # in every second stop; the frequency of the squeal falls with it
        mode = complex_modes(design).most_unstable
        times = np.arange(int(duration * RATE)) / RATE
        motion = simulate(
            design.replace(braking),
            duration,
            start=mode.start(1e-5 * float(np.exp(-0.07 * mode.growth_rate))),
            times=times,
        )
        clean = rendered(motion, dof="x").channel()
        sound = rendered(motion, dof="x", noise=1e-2 * float(np.max(np.abs(clean))), seed=seed)
        begun = time.process_time()
        events = squeal_events(sound, least_level=None, band=(1250.0, 16000.0))
        i = int(np.argmax(events.level))
        data = from_events(events, i, at={"sliding_speed": "speed"})
        if len(data) == 2:
            found = calibrate(design.replace({"k3": 1.7e8, "friction.static": 0.33}), BOUNDS, data, seed=seed)
            held += (found.low <= truth) & (found.high >= truth)
            told += 1
        spent += time.process_time() - begun
        share = min(0.05, 0.25 * float(events.end[i] - events.onset[i]))
        a, b = (int(RATE * at) for at in (events.onset[i] + share, events.end[i] - share))
        near = butter(2, [0.8 * events.frequency[i], 1.2 * events.frequency[i]], "band", fs=RATE, output="sos")
        tone = sosfiltfilt(near, clean)[a:b]
        turns = np.nonzero((tone[:-1] < 0.0) & (tone[1:] >= 0.0))[0]
        turns = turns - tone[turns] / (tone[turns + 1] - tone[turns])
        exact = (len(turns) - 1) / (turns[-1] - turns[0]) * RATE
        right += abs(events.frequency[i] - exact) < (events.frequency_error[i] if seed % 2 else 0.1)
        level = 10.0 * np.log10(np.mean(tone**2) / HEARING**2) + 20.0 * np.log10(float(a_weighting(exact)))
        inside = (events.track_time[i] >= (a / RATE)) & (events.track_time[i] <= (b / RATE))
        heard = 10.0 * np.log10(np.mean(10.0 ** (0.1 * events.track_level[i][inside])))
        loud += abs(heard - level) < 0.1
        mode = complex_modes(design.replace({"sliding_speed": float(events.braking[i, 0])})).most_unstable
        within += abs(events.growth_rate[i] - mode.growth_rate) < 2.0 * events.growth_error[i] / 1.96
    print(
        f"{stops} round trips: growth told {told}, frequency {right}, growth within 2 sd {within}, level {loud}, "
        f"parameters held {held / max(told, 1)}, {spent / stops:.2f} s each"
    )


if __name__ == "__main__":
    sets = int(sys.argv[1]) if len(sys.argv) > 1 else 500
    closed_forms()
    speed()
    posterior()
    coverage("drum, two parameters", BRAKE, BOUNDS, [1.9e8, 0.36], drum, sets)
    more = {**BOUNDS, "k4": (0.5 * BRAKE.k4, 1.5 * BRAKE.k4)}
    coverage("drum, three parameters", BRAKE, more, [1.9e8, 0.36, BRAKE.k4], three, sets)
    round_trip(int(sys.argv[2]) if len(sys.argv) > 2 else 200)

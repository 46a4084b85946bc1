"""What a countermeasure costs in time: sampled and late loops, and dither far above the brake's frequencies.

A late run stands beside SciPy's DOP853 by the method of steps on the same linear block. Times are processor time, the
least of several. The ratio of a dithered run is its time over that of the same run of the brake without dither.
"""

import time

from scipy.integrate import solve_ivp

from squealbox import PID, Controlled, Dithered, DrumBrake, NormalDither, System, simulate


def least(function, repetitions=5):
    """Least processor time [s] of a call after the first, and what it gives."""
    found, spent = function(), []
    for _ in range(repetitions):
        start = time.process_time()
        found = function()
        spent.append(time.process_time() - start)
    return min(spent), found


def by_steps(c, gain, delay, count, rtol):
    """A block under a late velocity feedback, one delay after the other."""
    before, state = None, [1.0, 0.0]
    for k in range(count):

        def field(t, x, before=before):
            late = 0.0 if before is None else before(t - delay)[1]
            return [x[1], -gain * late - c * x[1] - x[0]]

        span = k * delay, (k + 1) * delay
        run = solve_ivp(field, span, state, "DOP853", rtol=rtol, atol=1e-2 * rtol, dense_output=True)
        before, state = run.sol, run.y[:, -1]
    return state


def loops():
    """Sampled and late loops on the drum, and a late block beside SciPy."""
    drum, duration = DrumBrake(), 5e-3
    for name, given, count in (
        ("sampled, 50 kHz", {"derivative": 2000.0, "sampling": 50e3, "computing": 1.0}, 250),
        ("late by 20 us", {"derivative": 500.0, "delay": 2e-5}, 250),
    ):
        brake = Controlled(drum, [PID(on=on, **given) for on in "xy"])
        simulate(brake, 1e-4)
        spent, run = least(lambda brake=brake: simulate(brake, duration))
        print(f"{name:<20} {1e3 * spent / count:7.2f} ms each of {run.settings['pieces']} pieces, {run.outcome}")
    c, gain, delay, count = 0.05, 0.3, 0.6, 60
    block = System([[1.0]], [[c]], [[1.0]], loops=(PID(on="q1", derivative=gain, delay=delay),))
    exact = by_steps(c, gain, delay, count, 1e-13)
    ours, run = least(lambda: simulate(block, count * delay, ([1.0], [0.0]), [count * delay]))
    error = abs(run.q[-1, 0] - exact[0])
    rival, end = least(lambda: by_steps(c, gain, delay, count, 3e-12))
    print(
        f"{'a late block':<20} {1e3 * ours:7.1f} ms, error {error:.1e}; SciPy by steps {1e3 * rival:.1f} ms, error "
        f"{abs(end[0] - exact[0]):.1e}; ratio {rival / ours:.1f}"
    )


def dither():
    """Runs of 50 ms with dither of 50 kHz over those without."""
    drum, duration = DrumBrake(), 0.05
    plain, run = least(lambda: simulate(drum, duration))
    print(f"{'without dither':<20} {1e3 * plain:7.2f} ms, {run.steps} steps")
    cases = [(f"normal, {100 * r:g} %", NormalDither(drum, ratio=r, frequency=50e3)) for r in (0.2, 0.9)]
    cases += [
        (f"tangential, {w:g} m/s", Dithered(drum, velocity=w, frequency=50e3, direct=True))
        for w in (0.1, 0.21, 0.4, 0.8)
    ]
    for name, brake in cases:
        spent, run = least(lambda brake=brake: simulate(brake, duration))
        reversals = len(run.event_time)
        print(
            f"{name:<20} {1e3 * spent:7.2f} ms, ratio {spent / plain:5.1f}, {run.steps} steps, {run.rejected} in vain, "
            f"{reversals} events"
        )


if __name__ == "__main__":
    loops()
    dither()

"""Branches of the drum: 200 cycles by shooting with multipliers, beside natural continuation with SciPy.

    python benchmarks/branches.py            # a table on stdout
    python benchmarks/branches.py --quick    # fewer points

The other follows the same branch at the same values by natural continuation: `scipy.optimize.root` for x(T) = x(0),
with the same exact motion of this program, since SciPy has none with sticking. It gives neither multipliers nor folds,
which is part of why it takes less time. Processor time, one process; run it on an idle machine.
"""

import argparse
import time

import numpy as np

from squealbox import DrumBrake, LinearSlope, branch, shooting, simulate

DRUM = DrumBrake(friction=LinearSlope(0.3, -0.05), reading="consistent")
START = ([3e-5, 1e-5], [0.3, -0.3])
BOUNDS = (0.2, 0.33)


def timed(task):
    """(result, processor time [s]) of a task, its kernels compiled before."""
    begin = time.process_time()
    return task(), time.process_time() - begin


def ours(points, large):
    """Cycles with multipliers, special points and all, from 0.33 down."""
    return branch(DRUM, "friction.static", BOUNDS, large, value=0.33, method="shooting", direction=-1, points=points,
                  largest_step=0.6 / points)  # fmt: skip


def natural(values, large):
    """Periods at the values by SciPy's hybrid method on x(T) = x(0), each from the one before; the motion is ours."""
    from scipy.optimize import root

    scale = np.r_[np.max(np.abs(large.q), axis=0), np.max(np.abs(large.qd), axis=0)]
    top = int(np.argmax(large.q[:-1, 1]))
    y = np.r_[np.r_[large.q[top], large.qd[top, :1]] / scale[:3], 1.0]
    periods = []
    for value in values:
        drum = DRUM.replace({"friction.static": float(value)})

        def gap(y, drum=drum):
            x, period = np.r_[y[:3] * scale[:3], 0.0], y[3] * float(large.period)
            run = simulate(drum, period, (x[:2], x[2:]), times=2, rtol=1e-11)
            return (np.r_[run.q[-1], run.qd[-1]] - x) / scale

        found = root(gap, y, tol=1e-9)
        y = found.x
        periods.append(y[3] * float(large.period) if found.success else np.nan)
    return np.array(periods)


def main():
    """Print the table."""
    reader = argparse.ArgumentParser(description=__doc__)
    reader.add_argument("--quick", action="store_true")
    points = 50 if reader.parse_args().quick else 200
    large = shooting(DRUM.replace({"friction.static": 0.33}), START)
    ours(5, large)
    found, seconds = timed(lambda: ours(points, large))
    each = 1e3 * seconds / len(found.value)
    print(f"branch by shooting: {len(found.value)} cycles, {seconds:.2f} s, {each:.1f} ms a cycle")
    periods, rival = timed(lambda: natural(found.value, large))
    agree = np.nanmax(np.abs(periods / found.period - 1.0))
    missed = int(np.sum(np.isnan(periods)))
    print(f"scipy.optimize.root on the same motion: {rival:.2f} s, no multipliers; {missed} values not converged")
    print(f"largest relative difference of the periods {agree:.1e}; scipy over ours {rival / seconds:.2f}")


if __name__ == "__main__":
    main()

"""Motion with sticking beside other Python solvers, each in the formulations it offers, at equal error.

The brake is the drum in reading eq3 with a preload of 1 kN and mu 0.44, over the pressure centres of the map of
`ensembles.py`; nearly all contacts stick and slip. Two formulations of friction:

tanh     mu(|v|) tanh(v / width) N for several widths and tolerances: CyRK and numbalsoda with a compiled right-hand
         side, diffrax and heyoka's batch mode with many trajectories side by side;
events   the exact one. The senses of slip and the inverse of G over the sticking contacts are parameters of the
         equation, each solver locates the next event with its own machinery, the decision of the next mode follows.
         diffrax has all of it compiled in one loop; heyoka and CyRK decide in Python.

Errors are those of the end state against our rtol 1e-11, relative to the largest displacement of the trajectory: the
median over those a rival was given. Times are of the processor and per trajectory, without compilation. Of each rival
the fastest setting exact enough is compared with our fastest such; where none is, that is said. A call of more than
`PATIENCE` a trajectory is timed once, without a repetition. Needs the extra `bench`; words name the rivals to be run.
"""

import itertools
import sys
import time

import ensembles
import numpy as np
from rival_solvers import RIVALS, Drum

from squealbox import simulate_ensemble

SIDE = 32
WANTED = (1e-3, 1e-5, 1e-6)
PATIENCE = 1.0  # seconds of the processor for each trajectory
METHODS = ("taylor", "dormand-prince-8")
OURS = (1e-3, 1e-5, 1e-7, 1e-8)


def timed(run):
    """The answer of a call and its processor time [s]."""
    start = time.process_time()
    found = run()
    return found, time.process_time() - start


def truths(system):
    """End displacements of all trajectories, the largest of each, and what it did."""
    sheet = {"observe": ("peak", "sticking"), "threads": 1}
    found = simulate_ensemble(system, None, ensembles.DURATION, rtol=1e-11, **sheet)
    stuck = np.mean(np.max(found["sticking"], axis=-1) > 0)
    print(f"drum, eq3, preload 1 kN, mu 0.44, {ensembles.DURATION} s, {SIDE} x {SIDE} pressure centres; in the mean "
          f"{np.mean(found.events):.0f} events, contacts stick in {100 * stuck:.0f} % of trajectories")  # fmt: skip
    return found.q.reshape(-1, 2), np.max(found["peak"], axis=-1).ravel()


def error_of(ends, truth, largest):
    """Median error; NaN as soon as half of the runs failed."""
    error = np.max(np.abs(ends - truth), axis=1) / largest
    return np.median(np.where(np.isfinite(error), error, np.inf))


def ours(system, truth, largest):
    """(error, time) of our ensembles over the whole map."""
    rows = []
    for method, rtol in itertools.product(METHODS, OURS):

        def run(method=method, rtol=rtol):
            return simulate_ensemble(system, None, ensembles.DURATION, method, (), rtol=rtol, threads=1)

        found = run()
        spent = np.median([timed(run)[1] for _ in range(3)]) / len(truth)
        rows.append((error_of(found.q.reshape(-1, 2), truth, largest), spent))
        report("ours", f"{method} {rtol:.0e}", *rows[-1])
    return rows


def report(name, setting, error, spent):
    """One row."""
    print(f"  {name:<24}{setting:<24}{1e6 * spent:12.0f} us   median error {error:.0e}", flush=True)


def tried(rival, drums, truth, largest):
    """(error, time) of each setting of a rival."""
    rows = []
    picks = np.linspace(0, len(drums) - 1, rival.takes).astype(int)
    for setting in rival.settings:
        run = rival.prepare([drums[k] for k in picks], setting)
        first, spent = timed(run)
        if spent < PATIENCE * rival.takes:
            spent = min(timed(run)[1] for _ in range(2))
        rows.append((error_of(first, truth[picks], largest[picks]), spent / rival.takes))
        report(rival.name, rival.said(setting), *rows[-1])
    return rows


def fastest(rows, wanted):
    """Least time among the rows that are exact enough; inf when none is."""
    return min((spent for error, spent in rows if error <= wanted), default=np.inf)


def main():
    """Print all rows, then the ratios."""
    system = ensembles.mapped(SIDE, "eq3", 1000.0)
    truth, largest = truths(system)
    drums = Drum.each_of(system)
    own = ours(system, truth, largest)
    chosen = [x for x in RIVALS if not sys.argv[1:] or any(word in x.name for word in sys.argv[1:])]
    rows = {rival.name: tried(rival, drums, truth, largest) for rival in chosen}
    print("time over ours, each the fastest that is exact enough; asked 100 for the best rival")
    print(f"  {'median error at most':<24}" + "".join(f"{x:>12.0e}" for x in WANTED))
    for name, found in rows.items():
        ratios = [fastest(found, x) / fastest(own, x) for x in WANTED]
        print(f"  {name:<24}" + "".join(f"{x:>12.0f}" if np.isfinite(x) else f"{'not met':>12}" for x in ratios))


if __name__ == "__main__":
    main()

"""Drum transients of 0.05 s: compiled against SciPy's solve_ivp, and exact contact against a tight reference.

Part 1 runs the same equations, the same method (Bogacki-Shampine 3(2) with plain sgn) and the same tolerances in this
one process. SciPy gets a right-hand side of a few whole-array operations. Part 2 runs exact stick and slip by the usual
method for every reading of the drum, with the preload of the design (none, but in `consistent`, where it is the load)
and with 1000 N on each contact, and once a motion without events; with its end alone, and with
every row. Part 3 runs in new processes, first with an empty folder of compiled code, then with what that left.

Times are of the processor, after one run that compiles. `--quick` takes fewer repetitions.
"""

import os
import subprocess
import sys
import tempfile
import time

# These choose other kernels of OpenBLAS and slow SciPy's small products down: the rival runs as it is shipped.
UNWANTED = ("OPENBLAS_CORETYPE", "OPENBLAS_L2_SIZE")
if any(name in os.environ for name in UNWANTED):
    os.execve(sys.executable, [sys.executable, *sys.argv], {k: v for k, v in os.environ.items() if k not in UNWANTED})

import numpy as np
from scipy.integrate import solve_ivp

from squealbox import DrumBrake, LinearSlope, simulate

DURATION = 0.05
SLOPE = -0.05
READINGS = ("eq1_printed", "eq3", "eq3_signed", "componentwise", "consistent")


def seconds(function, repetitions):
    """Processor time of each repetition, after one that does not count."""
    function()
    spent = []
    for _ in range(repetitions):
        start = time.process_time()
        function()
        spent.append(time.process_time() - start)
    return np.array(spent)


def right_hand_side(system):
    """y' of a system of constant loads and speeds whose contacts share one LinearSlope, for SciPy."""
    inverse = np.linalg.inv(system.M)
    n = system.size
    mass_stiffness, mass_damping, load = inverse @ system.K, inverse @ system.C, inverse @ system.load
    act = inverse @ np.array([c.d for c in system.contacts]).T
    along = np.array([c.t for c in system.contacts])
    press = np.array([c.n for c in system.contacts])
    preload = np.array([float(c.N0) for c in system.contacts])
    speed = np.array([float(c.V) for c in system.contacts])
    static, slope = (getattr(system.contacts[0].law, name) for name in ("static", "slope"))

    def rates(_, y):
        q, qd = y[:n], y[n:]
        v = speed - along @ qd
        force = (static + slope * np.abs(v)) * np.sign(v) * (preload + press @ q)
        out = np.empty(2 * n)
        out[:n] = qd
        out[n:] = load - mass_stiffness @ q - mass_damping @ qd + act @ force
        return out

    return rates


def against_scipy(friction, repetitions):
    """One line: both times, their ratio and its spread."""
    system = DrumBrake(friction=LinearSlope(friction, SLOPE)).system()
    options = {"method": "bogacki-shampine", "contact": "raw", "rtol": 1e-3}
    ours = simulate(system, DURATION, **options)
    atol = np.array(ours.settings["atol"])
    rates, start = right_hand_side(system), np.zeros(2 * system.size)

    def rival():
        return solve_ivp(rates, (0.0, DURATION), start, method="RK23", rtol=1e-3, atol=atol)

    theirs = rival()
    scipy_times = seconds(rival, repetitions)
    our_times = seconds(lambda: simulate(system, DURATION, **options), 20 * repetitions)
    ratio = np.median(scipy_times) / np.median(our_times)
    low, high = np.min(scipy_times) / np.max(our_times), np.max(scipy_times) / np.min(our_times)
    per_call = np.median(scipy_times) / theirs.nfev / (np.median(our_times) / ours.evaluations)
    print(
        f"mu = {friction:<5} SciPy RK23 {1e3 * np.median(scipy_times):8.1f} ms ({theirs.nfev} evaluations, "
        f"{len(theirs.t) - 1} steps)   squealbox {1e3 * np.median(our_times):7.3f} ms ({ours.evaluations} evaluations, "
        f"{ours.steps} steps, {ours.outcome})"
    )
    print(f"           ratio {ratio:.0f} (from {low:.0f} to {high:.0f}); per evaluation {per_call:.0f}")


def exact_contact(reading, preload, repetitions, friction=0.44):
    """One line: time, error against a reference, audit and counts of an exact run."""
    system = DrumBrake(friction=LinearSlope(friction, SLOPE), reading=reading).system()
    if preload is not None:
        system = system.replace({"contacts": tuple(c.replace({"N0": preload}) for c in system.contacts)})
    reference = simulate(system, DURATION, times=2, rtol=1e-13)
    motion = simulate(system, DURATION, times=2)
    spent = seconds(lambda: simulate(system, DURATION, times=2), repetitions)
    all_rows = seconds(lambda: simulate(system, DURATION), repetitions)
    error = np.nan
    if len(motion.t) == len(reference.t) == 2:
        error = np.max(np.abs(motion.q[-1] - reference.q[-1])) / np.max(np.abs(reference.q))
    audit = simulate(system, DURATION).energy.relative_residual
    given = "design" if preload is None else f"{preload:.0f}"
    print(
        f"{reading:<14}{friction:>6}{given:>9}{1e3 * np.median(spent):>9.2f}{1e3 * np.min(spent):>9.2f}"
        f"{1e3 * np.min(all_rows):>9.2f}{error:>10.1e}"
        f"{audit:>10.1e}{motion.steps:>8d}{motion.evaluations:>9d}{len(motion.event_time):>8d}  "
        f"{motion.outcome} / {reference.outcome}"
    )


FIRST = """
import time
began = time.process_time()
import numpy as np
from squealbox import DrumBrake, LinearSlope, ModeCoupling, Stribeck, simulate, simulate_ensemble
line, curve = (DrumBrake(friction=law) for law in (LinearSlope(0.44, -0.05), Stribeck(0.44, 0.3, 1.0)))
vary = {"friction.static": np.linspace(0.35, 0.5, 20)}
for label, first in {
    "first run, imports included; asked 3.0": lambda: simulate(line, 0.01),
    "another law; asked 1.5": lambda: simulate(curve, 0.01),
    "one contact in place of two; asked 1.5": lambda: simulate(ModeCoupling(), 0.01),
    "first ensemble; asked 1.5": lambda: simulate_ensemble(line, vary, 0.01),
    "ensemble of the other law; asked 1.5": lambda: simulate_ensemble(curve, vary, 0.01),
}.items():
    first()
    print(f"{label:<45}{time.process_time() - began:8.2f} s")
    began = time.process_time()
"""


def first_runs():
    """What a newcomer waits for, and what a second session does."""
    with tempfile.TemporaryDirectory() as fresh:
        for what in ("nothing compiled yet", "read from disk; asked 0.3 each"):
            print(f"\nPart 3: {what}")
            subprocess.run([sys.executable, "-c", FIRST], env={**os.environ, "SQUEALBOX_CACHE": fresh}, check=True)


def main():
    """Print all parts."""
    quick = "--quick" in sys.argv[1:]
    print(f"Part 1: raw sgn, rtol 1e-3, same atol, {DURATION} s, reading consistent, alpha {-SLOPE} s/m")
    for friction in (0.3, 0.45):
        against_scipy(friction, 2 if quick else 5)
    print(f"\nPart 2: exact contact, usual method and rtol, {DURATION} s; asked 1.0 ms, without events 0.4 ms")
    print(
        f"{'reading':<14}{'mu':>6}{'N0 [N]':>9}{'ms':>9}{'least':>9}{'all rows':>9}{'error':>10}{'audit':>10}"
        f"{'steps':>8}{'evals':>9}{'events':>8}  outcome / of the reference at rtol 1e-13"
    )
    for reading in READINGS:
        for preload in (None, 1000.0):
            exact_contact(reading, preload, 10 if quick else 50)
    exact_contact("consistent", None, 10 if quick else 50, 0.3)
    sys.stdout.flush()
    first_runs()


if __name__ == "__main__":
    main()

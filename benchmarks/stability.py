"""Eigenvalues beside NumPy's batched eigvals in this one process, a map of a million points, and traced boundaries.

Ratios are NumPy's least time over ours at equal results; the largest difference of the results stands beside them.
`--boundaries` also traces 50 random designs and compares each with a grid of 2001 x 2001 points (some minutes).
"""

import os
import sys
import time
from functools import partial
from itertools import pairwise

# These choose other kernels of OpenBLAS and slow NumPy down: the rival runs as it is shipped, on one core.
UNWANTED = ("OPENBLAS_CORETYPE", "OPENBLAS_L2_SIZE")
if any(name in os.environ for name in UNWANTED) or os.environ.get("OPENBLAS_NUM_THREADS") != "1":
    wanted = {name: value for name, value in os.environ.items() if name not in UNWANTED}
    os.execve(sys.executable, [sys.executable, *sys.argv], {**wanted, "OPENBLAS_NUM_THREADS": "1"})

import numpy as np

from squealbox import DrumBrake, LinearSlope
from squealbox.compiled.sixteen import room
from squealbox.control.poles import Late, late_poles
from squealbox.stability import compiled_eigenvalues, stability_boundary, stability_map
from squealbox.stability.spectra import flags_of, parts_of, two_dof_kernels


def least(function, repetitions=7):
    """Least processor time [s] of a call, after one that does not count."""
    function()
    spent = []
    for _ in range(repetitions):
        start = time.process_time()
        function()
        spent.append(time.process_time() - start)
    return min(spent)


def report(name, ours, rival, remark):
    """One line of the table, per system."""
    print(
        f"{name:<28} {1e9 * ours:9.1f} ns, NumPy {1e9 * rival:8.0f} ns, ratio {rival / ours:7.1f}  ({remark})",
        flush=True,
    )


def oscillators(count, size, seed=1):
    """Damping and stiffness (count, size, size) of coupled oscillators with flutter and light damping, and state
    matrices."""
    rng = np.random.default_rng(seed)
    root = rng.normal(size=(count, size, size))
    stiffness = np.eye(size) + root @ np.swapaxes(root, -1, -2) / size + 0.3 * rng.normal(size=(count, size, size))
    damping = 0.05 * np.eye(size) + 0.05 * rng.normal(size=(count, size, size))
    state = np.zeros((count, 2 * size, 2 * size))
    state[:, :size, size:] = np.eye(size)
    state[:, size:, :size], state[:, size:, size:] = -stiffness, -damping
    return damping, stiffness, state


def two_degrees_of_freedom(count=40000):
    """Growth rate with frequency, and the flag, of 2 DOF."""
    damping, stiffness, state = oscillators(count, 2)
    numpy_time = least(lambda: np.linalg.eigvals(state), 3) / count
    values = np.linalg.eigvals(state)
    mass, c, k = np.eye(2).ravel(), damping.ravel(), stiffness.ravel()
    growth, omega, number = np.empty(count), np.empty(count), np.empty(count)
    kernels = two_dof_kernels()
    ours = least(lambda: kernels.growth_and_frequency(mass, c, k, growth, omega, number, room(4)), 30) / count
    gap = np.max(np.abs(growth - values.real.max(axis=-1)))
    report("2 DOF growth and frequency", ours, numpy_time, f"largest difference {gap:.1e}")
    ours = least(lambda: flags_of(mass, c, k), 200) / count
    wrong = int(np.sum(flags_of(mass, c, k) != (values.real.max(axis=-1) < 0.0)))
    report("2 DOF stability flag", ours, numpy_time, f"{wrong} flags differ")


def spectra():
    """Whole spectra: of 2 DOF in closed form, of any real matrices by QR."""
    damping, stiffness, state = oscillators(20000, 2)
    mass, c, k, found = np.eye(2).ravel(), damping.ravel(), stiffness.ravel(), np.empty((len(state), 4), dtype=complex)
    run = partial(two_dof_kernels().spectrum, mass, c, k, parts_of(found).reshape(-1, 8), room(8))
    compare("4 x 4 spectrum, 2 DOF", state, run, lambda: found)
    for size, count in ((4, 20000), (12, 3200), (24, 640)):
        for kind in ("oscillators", "any real"):
            if kind == "oscillators":
                _, _, matrices = oscillators(count, size // 2)
            else:
                matrices = np.random.default_rng(size).normal(size=(count, size, size))
            run = partial(compiled_eigenvalues, matrices)
            compare(f"{size} x {size} spectrum, {kind}", matrices, run, run)


def compare(name, state, ours, result):
    """Time of a spectrum beside numpy.linalg.eigvals, one after the other so that both see the same machine."""
    times = [(least(lambda: np.linalg.eigvals(state), 3), least(ours, 3)) for _ in range(5)]
    rival, own = (min(column) / len(state) for column in zip(*times, strict=True))
    gap = np.max(np.min(np.abs(np.linalg.eigvals(state)[:, :, None] - result()[:, None, :]), axis=2))
    report(name, own, rival, f"largest difference {gap:.1e}")


def million_points():
    """A drum map of 1e6 points with growth rate and mechanism."""
    axes = {"friction.static": np.linspace(0.1, 0.6, 1000), "load": np.linspace(100.0, 2e4, 1000)}
    stability_map(DrumBrake(), {name: values[::5] for name, values in axes.items()})
    start, spent = time.perf_counter(), time.process_time()
    found = stability_map(DrumBrake(), axes)
    wall, spent = time.perf_counter() - start, time.process_time() - spent
    print(f"1e6 drum points with growth rate and mechanism: {spent:.1f} s of one core, {wall:.1f} s on the clock")
    print(found.summary())


def boundaries(count=50, resolution=2001):
    """Random drums over two random parameters: crossed grid edges that no traced curve passes."""
    from scipy.spatial import cKDTree

    rng = np.random.default_rng(2011)
    spans = {"friction.static": (0.05, 0.8), "theta1": (0.3, 1.5), "theta2": (1.7, 2.9)}
    spans |= {"k3": (5e7, 4e8), "k4": (5e7, 4e8)}
    missed, worst, edges_seen = 0, 0.0, 0
    for i in range(count):
        chosen = [str(name) for name in rng.choice(list(spans), 2, replace=False)]
        reading = str(rng.choice(["consistent", "eq3", "eq3_signed"]))
        design = DrumBrake(
            friction=LinearSlope(float(rng.uniform(0.25, 0.6)), 0.0), reading=reading,
            theta1=float(rng.uniform(0.3, 1.5)), theta2=float(rng.uniform(1.7, 2.9)),
            c1=float(rng.uniform(20.0, 400.0)), c2=float(rng.uniform(20.0, 400.0)),
        )  # fmt: skip
        bounds = {name: spans[name] for name in chosen}
        start = time.perf_counter()
        traced = stability_boundary(design, bounds)
        spent = time.perf_counter() - start
        grids = [np.linspace(*bounds[name], resolution) for name in chosen]
        unstable = stability_map(design, dict(zip(chosen, grids, strict=True)), mechanism=False).unstable
        across, up = np.argwhere(unstable[1:] != unstable[:-1]), np.argwhere(unstable[:, 1:] != unstable[:, :-1])
        crossed = np.vstack([across + np.array([0.5, 0.0]), up + np.array([0.0, 0.5])])
        share = np.linspace(0.0, 1.0, 200)[:, None]
        low = np.array([bounds[name][0] for name in chosen])
        width = np.array([bounds[name][1] for name in chosen]) - low
        dense = [a + (b - a) * share for curve in traced.curves for a, b in pairwise(curve)]
        far = len(crossed)
        if dense and far:
            points = (np.concatenate(dense) - low) / width * (resolution - 1)
            far = int(np.sum(cKDTree(points).query(crossed)[0] > 3.0))  # chords of curves: a few cells of 1/2000
        left = float(np.max(np.abs(traced.growth_rate), initial=0.0))
        missed, worst, edges_seen = missed + far, max(worst, left), edges_seen + len(crossed)
        print(
            f"  {i + 1:2d} {reading:<10} {'/'.join(chosen):<28} {len(traced.curves)} curves, {spent:5.1f} s, ", end=""
        )
        print(f"{len(crossed):6d} grid edges, {far} missed, |growth rate| {left:.1e} 1/s", flush=True)
    print(f"{count} designs: {missed} of {edges_seen} crossed grid edges missed, |growth rate| up to {worst:.1e} 1/s")


def poles_under_delay(count=200):
    """Poles right of -3/T of random systems with one or two delays, beside the eigenvalues of 100 Chebyshev points."""
    rng = np.random.default_rng(7)
    spent, rival, missed = [], [], 0
    for _ in range(count):
        d = int(rng.integers(1, 9))
        delays = rng.uniform(0.1, 2.0, rng.integers(1, 3))
        late = Late(rng.normal(size=(d, d)), [(t, rng.normal(size=(d, 1)) @ rng.normal(size=(1, d))) for t in delays])
        line = -3.0 / float(max(delays))
        spent.append(least(partial(late_poles, late, line), 1))
        found, counted = late_poles(late, line)
        missed += counted - len(found)
        size = d + 100 * len(delays)
        rival.append(least(partial(np.linalg.eigvals, rng.normal(size=(size, size))), 1))
    print(
        f"poles of {count} systems under delay: median {1e3 * np.median(spent):.1f} ms, longest "
        f"{1e3 * max(spent):.1f} ms, {missed} missed (eigenvalues of 100 points each: {1e3 * np.median(rival):.1f} ms)"
    )


if __name__ == "__main__":
    two_degrees_of_freedom()
    spectra()
    million_points()
    poles_under_delay()
    if "--boundaries" in sys.argv:
        boundaries()

"""Branches of the drum beside SciPy, pycont-lite and harmonicbalance.

    pip install 'squealbox[bench]'
    python benchmarks/branches.py            # tables on stdout, about two minutes
    python benchmarks/branches.py --quick    # fewer points, one round

Exact stick and slip, the map x(T) - x(0) = 0 of this program's own motion, as none of the others has one with sticking:
    ours       200 cycles with Floquet multipliers, special points, exact derivatives
    SciPy      `optimize.root` at the same values, each from the one before; no multipliers, no folds
    pycont     pseudo-arclength with Newton-Krylov; its detection of bifurcations and its stability (of equilibria) off

Smoothed law (arctan over 0.05 m/s), 20 harmonics, errors against shooting on the same smoothed law:
    ours             `branch` by harmonic balance, multipliers included
    harmonicbalance  its Fourier series and its oversampling, a linear phase condition, SciPy's `root`, from value to
                     value: its own autonomous wrapper asks the square of the distance from a start to vanish, which
                     makes the Jacobian singular there; its path follower knows one degree of freedom and omega only
    pycont           its own limit cycles: a Hopf point on the smoothed steady sliding, and the box scheme from a cycle
                     that we hand it, each within a time limit

Processor time, one process, rounds in turn; ratios are rival over ours, median and range. Run it on an idle machine.
"""

import argparse
import contextlib
import io
import signal
import time
import warnings

import numpy as np

from squealbox import DrumBrake, LinearSlope, branch, shooting, simulate
from squealbox.limit_cycles.cycles.field import Field

DRUM = DrumBrake(friction=LinearSlope(0.3, -0.05), reading="consistent")
START = ([3e-5, 1e-5], [0.3, -0.3])
BOUNDS, HIGH = (0.2, 0.33), 0.33
SMOOTH, WIDTH, HARMONICS = (0.40, 0.60), 0.05, 20
NAME = "friction.static"
PATIENCE = 30  # seconds of an attempt of pycont's own limit cycles


def drum(value):
    return DRUM.replace({NAME: float(value)})


def timed(task):
    """(result, processor time [s]) of a task, its kernels compiled before."""
    begin = time.process_time()
    return task(), time.process_time() - begin


def ratios(rival, ours):
    each = np.array(rival) / np.array(ours)
    return f"{np.median(each):.2f} ({np.min(each):.2f} to {np.max(each):.2f})"


class Map:
    """x(T) - x(0) in shares of the cycle at the start, over three states at a largest y, the period, and friction."""

    def __init__(self, large):
        self.period = float(large.period)
        self.scale = np.r_[np.max(np.abs(large.q), axis=0), np.max(np.abs(large.qd), axis=0)]
        top = int(np.argmax(large.q[:-1, 1]))
        self.start = np.r_[np.r_[large.q[top], large.qd[top, :1]] / self.scale[:3], 1.0]

    def gap(self, u, value):
        x, period = np.r_[u[:3] * self.scale[:3], 0.0], u[3] * self.period
        run = simulate(drum(value), period, (x[:2], x[2:]), times=2, rtol=1e-11)
        return (np.r_[run.q[-1], run.qd[-1]] - x) / self.scale


def ours(points, large):
    """Cycles with multipliers, special points and all, from 0.33 down."""
    return branch(DRUM, NAME, BOUNDS, large, value=HIGH, method="shooting", direction=-1, points=points,
                  largest_step=0.6 / points)  # fmt: skip


def by_scipy(values, large):
    """Periods at the values, each from the cycle before."""
    from scipy.optimize import root

    loop = Map(large)
    u, periods = loop.start, []
    for value in values:
        found = root(loop.gap, u, args=(value,), tol=1e-9)
        u = found.x
        periods.append(u[3] * loop.period if found.success else np.nan)
    return np.array(periods)


def by_pycont(points, large):
    """(values, periods) along the branch by pycont's pseudo-arclength continuation of the same map."""
    import pycont
    from scipy.optimize import root

    loop, span = Map(large), BOUNDS[1] - BOUNDS[0]

    def gap(u, p):
        return loop.gap(u, HIGH + span * p)

    first = root(gap, loop.start, args=(0.0,), tol=1e-11).x
    settings = {"tolerance": 1e-9, "rdiff": 1e-6, "bifurcation_detection": False, "analyze_stability": False,
                "initial_directions": "decrease_p", "param_max": 0.05}  # fmt: skip
    step = 0.7 / points  # about the distance in friction of our points
    found = pycont.arclengthContinuation(gap, first, 0.0, 1e-6, step, step, points - 1, settings, verbosity="off")
    walk = found.branches[0]
    return HIGH + span * walk.p_path, walk.u_path[:, 3] * loop.period


def exact_error(values, periods):
    """Largest relative error of ten periods, against shooting anew to 1e-13."""
    errors = []
    for i in np.linspace(0, len(values) - 1, 10).astype(int):
        cycle = shooting(drum(values[i]), START)
        errors.append(abs(float(periods[i]) / float(cycle.period) - 1.0))
    return max(errors)


def stick_slip(points, rounds):
    large = shooting(drum(HIGH), START)
    ours(5, large)
    times = {name: [] for name in ("ours", "SciPy", "pycont")}
    for _ in range(rounds):
        found, seconds = timed(lambda: ours(points, large))
        times["ours"].append(seconds)
        periods, seconds = timed(lambda: by_scipy(found.value, large))  # noqa: B023
        times["SciPy"].append(seconds)
        (values, loops), seconds = timed(lambda: by_pycont(points, large))
        times["pycont"].append(seconds * len(found.value) / len(values))
    print(f"Exact stick and slip, {len(found.value)} cycles, friction {found.value[0]:.3f} to {found.value[-1]:.3f}")
    print(
        f"  ours    {np.median(times['ours']):6.2f} s, error {exact_error(found.value, found.period):.1e}, multipliers"
    )
    print(f"  SciPy   {np.median(times['SciPy']):6.2f} s, error {exact_error(found.value, periods):.1e}, "
          f"{np.sum(np.isnan(periods))} not converged; over ours {ratios(times['SciPy'], times['ours'])}")  # fmt: skip
    print(f"  pycont  {np.median(times['pycont']):6.2f} s, error {exact_error(values, loops):.1e}, "
          f"{len(values)} points to {values[-1]:.3f}; over ours {ratios(times['pycont'], times['ours'])}")  # fmt: skip


def smooth_ours(points, low):
    return branch(DRUM, NAME, SMOOTH, low, value=SMOOTH[0], contact="smooth", width=WIDTH, harmonics=HARMONICS,
                  points=points, largest_step=1.0 / points)  # fmt: skip


class Series:
    """The smoothed drum in the series of harmonicbalance, displacements over a size and time times omega0."""

    def __init__(self, cycle):
        self.size, self.omega = float(np.max(cycle.amplitude)), 2.0 * np.pi * cycle.frequency

    def residual(self, value):
        """M^-1 R / (omega0^2 size) of both degrees of freedom, as a function of two series."""
        system, size, omega = drum(value).system(), self.size, self.omega
        inverse = np.linalg.inv(system.M)
        law, unit = system.contacts[0].law, 1.0 / (omega**2 * size)
        damping, stiffness = inverse @ system.C / omega, inverse @ system.K / omega**2
        load = inverse @ np.asarray(system.load) * unit
        rows = [
            (c.n * size, c.t * size * omega, float(c.N0), float(c.V), inverse @ c.d * unit) for c in system.contacts
        ]

        def drag(v):
            return law.mu(v) * (2.0 / np.pi) * np.arctan(v / WIDTH)

        def balance(x):
            rate = [each.dt() for each in x]
            forces = []
            for n, t, force, speed, push in rows:
                normal = x[0] * float(n[0]) + x[1] * float(n[1]) + force
                sliding = rate[0] * float(-t[0]) + rate[1] * float(-t[1]) + speed
                forces.append((normal * sliding.nonlinearity(drag), push))
            total = []
            for i in range(2):
                row = rate[i].dt() - float(load[i])
                for j in range(2):
                    row = row + rate[j] * float(damping[i, j]) + x[j] * float(stiffness[i, j])
                for force, push in forces:
                    row = row - force * float(push[i])
                total.append(row)
            return total

        return balance


def by_harmonicbalance(values, low):
    """Periods at the values, each from the series before."""
    from harmonicbalance.fourier import Fourier
    from scipy.optimize import root

    made = Series(low)
    grid = Fourier(omega=1.0, n=HARMONICS)
    times = np.arange(4 * HARMONICS + 2) / (4 * HARMONICS + 1) * float(low.period)
    top = int(np.argmax(low.q[:-1, 1]))
    run = simulate(drum(SMOOTH[0]), float(low.period), (low.q[top], low.qd[top]), times, contact="smooth", width=WIDTH,
                   rtol=1e-10)  # fmt: skip
    series = [grid._from_time_domain(run.q[:-1, i] / made.size) for i in range(2)]
    unknowns, periods = np.hstack([each.coeffs() for each in series] + [1.0]), []
    for value in values:
        balance = made.residual(value)

        def zero(p, balance=balance):
            x = [Fourier.from_coeffs(half, p[-1]) for half in np.split(p[:-1], 2)]
            return np.append(np.hstack([each.coeffs() for each in balance(x)]), x[1].coeffs_sin[0])

        found = root(zero, unknowns, tol=1e-9)
        unknowns = found.x if found.success else unknowns
        periods.append(2.0 * np.pi / (found.x[-1] * made.omega) if found.success else np.nan)
    return np.array(periods)


def smooth_error(values, periods):
    """Largest relative error of eight periods against shooting on the same smoothed law, each from a run."""
    errors, cycle = [], shooting(drum(values[0]), START, contact="smooth", width=WIDTH)
    for i in np.linspace(0, len(values) - 1, 8).astype(int):
        cycle = shooting(drum(values[i]), (*cycle.start,), contact="smooth", width=WIDTH)
        errors.append(abs(float(periods[i]) / float(cycle.period) - 1.0))
    return max(errors)


def smoothed(points, rounds):
    low = shooting(drum(SMOOTH[0]), START, contact="smooth", width=WIDTH)
    smooth_ours(3, low)
    times = {"ours": [], "harmonicbalance": []}
    for _ in range(rounds):
        found, seconds = timed(lambda: smooth_ours(points, low))
        times["ours"].append(seconds)
        periods, seconds = timed(lambda: by_harmonicbalance(found.value, low))  # noqa: B023
        times["harmonicbalance"].append(seconds)
    print(f"Smoothed law, {len(found.value)} cycles, friction {found.value[0]:.3f} to {found.value[-1]:.3f}")
    print(f"  ours             {np.median(times['ours']):6.2f} s, error {smooth_error(found.value, found.period):.1e}, "
          "multipliers")  # fmt: skip
    print(f"  harmonicbalance  {np.median(times['harmonicbalance']):6.2f} s, error "
          f"{smooth_error(found.value, periods):.1e}, {int(np.sum(np.isnan(periods)))} not converged; over ours "
          f"{ratios(times['harmonicbalance'], times['ours'])}")  # fmt: skip


class OutOfTime(Exception):
    """An attempt took longer than PATIENCE."""


def _out_of_time(number, frame):
    raise OutOfTime


def attempt(words, task):
    """Say how an attempt ended: what the task says, the rival's own error, or that its time was over."""
    signal.signal(signal.SIGALRM, _out_of_time)
    signal.alarm(PATIENCE)
    begin = time.process_time()
    try:
        with warnings.catch_warnings(), contextlib.redirect_stdout(io.StringIO()):  # its solver prints each step
            warnings.simplefilter("ignore")  # the rival divides by zero on its way
            ended = task()
    except OutOfTime:
        ended = f"no answer within {PATIENCE} s"
    except Exception as error:  # whatever the rival raises is its answer
        ended = f"{type(error).__name__}: {error}"
    finally:
        signal.alarm(0)
    print(f"  pycont, {words}: {ended} ({time.process_time() - begin:.1f} s of processor time)")


def own_cycles_of_pycont():
    import pycont
    from pycont.LimitCycle import createLimitCycleObjectiveFunction
    from scipy.optimize import newton_krylov, root

    cycle = shooting(drum(0.45), START, contact="smooth", width=WIDTH)
    size, omega = float(np.max(cycle.amplitude)), 2.0 * np.pi * cycle.frequency
    scale, slips = np.r_[size, size, size * omega, size * omega], np.ones(2, dtype=int)

    def rate(u, p):
        field = Field(drum(p).system(), "arctan", WIDTH)
        return field.rate(np.asarray(u) * scale, slips) / (scale * omega)

    def hopf():
        still = root(rate, np.zeros(4), args=(0.30,), tol=1e-12).x
        settings = {"hopf_detection": True, "bifurcation_detection": False, "initial_directions": "increase_p"}
        found = pycont.arclengthContinuation(rate, still, 0.30, 1e-6, 0.002, 0.002, 50, settings, verbosity="off")
        met = [f"{event.kind} at {event.p:.4f}" for event in found.events]
        return f"{len(found.branches)} branch(es), events {', '.join(met)}"

    def box():
        count = 256
        times = np.linspace(0.0, float(cycle.period), count + 1)
        run = simulate(drum(0.45), float(cycle.period), cycle.start, times, contact="smooth", width=WIDTH, rtol=1e-10)
        states = (np.hstack([run.q, run.qd])[:-1] / scale).ravel()
        loop = createLimitCycleObjectiveFunction(rate, states, 4, count)
        first = newton_krylov(lambda q: loop(q, 0.45), np.append(states, float(cycle.period) * omega), f_tol=1e-6)
        settings = {"tolerance": 1e-6, "bifurcation_detection": False, "analyze_stability": False}
        found = pycont.arclengthContinuation(loop, first, 0.45, 1e-6, 0.05, 0.05, 5, settings, verbosity="off")
        return f"{len(found.branches[0].p_path)} points"

    growth = [float(np.max(np.linalg.eigvals(_jacobian(p)).real)) for p in (0.33, 0.35)]
    print(f"Its own limit cycles: steady sliding grows by {growth[0]:.0f} 1/s at 0.33 and {growth[1]:.0f} at 0.35")
    attempt("a Hopf point from 0.30 on", hopf)
    attempt("the box scheme of 256 points from our cycle at 0.45", box)


def _jacobian(value):
    """df/dx of the smoothed drum in steady sliding."""
    from scipy.optimize import root

    field, slips = Field(drum(value).system(), "arctan", WIDTH), np.ones(2, dtype=int)
    size = np.r_[1e-5, 1e-5, 0.1, 0.1]
    still = root(lambda u: field.rate(u * size, slips) / (size * field.frequency), np.zeros(4), tol=1e-12).x * size
    return field.jacobian(still, slips)


def main():
    """Print the tables."""
    reader = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    reader.add_argument("--quick", action="store_true")
    quick = reader.parse_args().quick
    points, rounds = (50, 1) if quick else (200, 3)
    stick_slip(points, rounds)
    smoothed(points, rounds)
    own_cycles_of_pycont()


if __name__ == "__main__":
    main()

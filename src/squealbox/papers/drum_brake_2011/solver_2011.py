"""What the solver of 2011 did to the motion: Bogacki and Shampine's method at its usual settings, beside exact motion.

The paper names the method, not its settings. The usual ones of the programs that offer it are a relative tolerance of
1e-3 and an absolute tolerance of 1e-3 of the largest value so far; a step load from rest makes that the first swing. Of
a rotation with the step h the method of third order keeps |1 + z + z^2/2 + z^3/6| at z = i w h, that is

    |.|^2 = 1 - (w h)^4/12 + (w h)^6/36,      so it adds the damping   (w h)^4/(24 h)  [1/s]

for w h small: at 1,000 steps in 0.05 s, w h is 0.6 and the method adds about as much as half the table's damping.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from squealbox.compiled import translated
from squealbox.designs import DrumBrake
from squealbox.papers.drum_brake_2011 import marching
from squealbox.papers.drum_brake_2011.cases import DURATION, Case
from squealbox.papers.drum_brake_2011.claims import EXACT, RAW
from squealbox.papers.drum_brake_2011.motions import METHODS, SAMPLES, judged
from squealbox.signals import MotionLike, slope
from squealbox.stability import complex_modes
from squealbox.system import DesignOrSystem, as_system, linearise
from squealbox.transient import Trajectory, simulate, verdict

RELATIVE = 1e-3
SHORTEST = 1e-9  # s: a step that crosses a reversal of sgn is kept once it is this short
SETTINGS = {
    "exact": "every stick, slip and reversal located",
    "raw": "the same method with a relative tolerance of 1e-3 throughout, as the raw runs of this study",
    "ode23": "usual settings: relative tolerance 1e-3, absolute tolerance 1e-3 of the largest value so far",
}
EARLY, LATE = (0.0, 0.0125), (0.0125, 0.025)  # s; after that nothing is left but the error allowed
UPTO = (0.010, 0.0125, 0.015)  # s: what is added grows while the motion dies, because the error allowed stays
MU = 0.30
LOADS = tuple(500.0 * i for i in range(16, 27))  # N: 8 to 13 kN
FRICTIONS = tuple(round(0.38 + 0.005 * i, 3) for i in range(6))


@dataclass(frozen=True)
class Decay:
    """A run that decays: its time and x, its steps, and the decay rates [1/s] of both modes, early and late."""

    setting: str
    t: Any
    x: Any
    steps: int
    early: tuple[float, float]
    late: tuple[float, float]


def added_damping(angular_frequency: float, step: float) -> float:
    """The damping [1/s] the method adds to a rotation at this frequency [rad/s] with this step [s].

    >>> round(added_damping(13000.0, 5e-5))
    129
    """
    z = 1j * angular_frequency * step
    return -math.log(abs(1.0 + z + z**2 / 2.0 + z**3 / 6.0)) / step


@dataclass(frozen=True)
class Plain:
    """A motion by the plain method of 2011: `t` (k,), `q` and `qd` (k, n) at its own steps."""

    t: Any
    q: Any
    qd: Any

    @property
    def steps(self) -> int:
        """Accepted steps."""
        return self.t.size - 1

    def at(self, times: ArrayLike) -> "Plain":
        """The same at other times, by the cubic through values and rates at both ends of a step."""
        from scipy.interpolate import CubicHermiteSpline

        spline = CubicHermiteSpline(self.t, self.q, self.qd)
        return Plain(np.asarray(times), spline(times), spline(times, 1))


def ode23(design: DesignOrSystem, duration: float = DURATION, rtol: float = RELATIVE) -> Plain:
    """The motion from rest as the programs of 2011 integrate it: plain sgn, one error for the worst of all values.

    A step is kept when h |e_i| <= rtol max(|y_i|, a_i) for every value, with the absolute tolerance rtol a_i that
    begins at 1e-6 and rises to rtol times the largest value so far; the next step is 0.8 (rtol/error)^(1/3) times the
    last, at most five times, and never longer than a fiftieth of the run.
    """
    march, room = translated(marching).march, 1024
    system = as_system(design)
    inverse, size, contacts = np.linalg.inv(system.M), system.size, system.contacts
    linear = np.hstack([-inverse @ system.K, -inverse @ system.C])
    sensed = np.array([np.concatenate([each.n, each.t]) for each in contacts])
    pushed = np.array([inverse @ each.d for each in contacts])
    laws = np.array([[each.N0, each.V, each.law.static, each.law.slope] for each in contacts], dtype=float)
    equation, given = (linear, inverse @ system.load, sensed, pushed, laws), (float(duration), float(rtol), SHORTEST)
    while True:
        t, y = np.empty(room), np.empty((room, 2 * size))
        count = march(equation, *given, t, y, np.zeros((4, 2 * size)), np.zeros((3, 2 * size)))
        if count <= room:
            return Plain(t[:count], y[:count, :size], y[:count, size:])
        room *= 4


def run(designs: Sequence[Any], setting: str) -> Iterator[Any]:
    """Motions from rest by one of `SETTINGS`, one after the other: simulated ones at the sample times of the study."""
    if setting == "ode23":
        yield from (ode23(design) for design in designs)
    else:
        road = EXACT if setting == "exact" else RAW
        yield from (simulate(design, DURATION, "rest", SAMPLES, METHODS[road], road) for design in designs)


def decays(case: Case, mu: float = MU) -> list[Decay]:
    """The motion at `mu` by every setting, with the decay rates of its two modes."""
    design = case.design(mu=mu)
    found = []
    for setting in SETTINGS:
        (motion,) = run([design], setting)
        rates = [decay_of_modes(design, motion, *part) for part in (EARLY, LATE)]
        shown = motion.at(np.linspace(0.0, DURATION, SAMPLES)) if isinstance(motion, Plain) else motion
        found.append(Decay(setting, shown.t, shown.q[:, 0], int(motion.steps), *rates))
    return found


def decay_of_modes(design: DesignOrSystem, motion: MotionLike, begin: float, end: float) -> tuple[float, float]:
    """Decay rates [1/s] of the lower and the upper mode in a motion about steady sliding, from `begin` to `end` [s].

    The share of mode j is w_j^H ((lambda_j M + C) (q - q0) + M q'), with its left mode w_j: while nothing reverses it
    goes as exp(lambda_j t), whatever the other mode does.
    """
    modes, linear = complex_modes(design), linearise(as_system(design))
    inside = (motion.t >= begin) & (motion.t <= end)
    q, qd = motion.q[inside] - modes.steady, motion.qd[inside]
    rates = []
    for eigenvalue, left in zip(modes.eigenvalues[:2], np.conj(modes.left[:, :2].T), strict=True):
        share = q @ (left @ (eigenvalue * linear.M + linear.C)) + qd @ (left @ linear.M)
        rates.append(-float(slope(motion.t[inside], np.log(np.abs(share)))[0]))
    return rates[0], rates[1]


def added(case: Case, mu: float = MU) -> dict[float, list[tuple[float, float]]]:
    """What ode23 adds to the decay of both modes [1/s] up to the times `UPTO` [s], for the slope of `case` and none."""
    found: dict[float, list[tuple[float, float]]] = {}
    for each in (case, case.replace(alpha=0.0)):
        design = each.design(mu=mu)
        motion, true = ode23(design), -complex_modes(design).growth_rate[:2]
        rates = [np.array(decay_of_modes(design, motion, 0.0, end)) - true for end in UPTO]
        found[each.alpha] = [(float(lower), float(upper)) for lower, upper in rates]
    return found


def onsets(case: Case) -> dict[str, tuple[float, float]]:
    """The least load [N] and friction coefficient from which on every motion tried persists, by setting."""
    loads, frictions = ([case.design(load=load) for load in LOADS], [case.design(mu=mu) for mu in FRICTIONS])
    return {
        setting: (_least(LOADS, run(loads[::-1], setting)), _least(FRICTIONS, run(frictions[::-1], setting)))
        for setting in SETTINGS
    }


def damping_of_the_table() -> dict[str, tuple[float, float]]:
    """C1 and c2 [N s/m] as printed, by 0.05 sqrt(k m), and by the stated loss factor, c = eta k/w and c = 2 eta m w."""
    brake = DrumBrake()
    roots = [math.sqrt(float(k * brake.m)) for k in (brake.k1, brake.k2)]
    return {
        "printed": (float(brake.c1), float(brake.c2)),
        "0.05 sqrt(k m)": (0.05 * roots[0], 0.05 * roots[1]),
        "loss factor 0.02": (0.02 * roots[0], 0.02 * roots[1]),
        "damping ratio 0.02": (0.04 * roots[0], 0.04 * roots[1]),
    }


def _persists(motion: Trajectory) -> bool | None:
    if not isinstance(motion, Plain):
        return judged(motion).persists
    found = verdict(motion.at(np.linspace(0.0, DURATION, SAMPLES)), dof=0)
    return {"decays": False, "grows": True, "settles_on_cycle": True}.get(found.kind)


def _least(values: Sequence[float], motions: Iterator[Any]) -> float:
    """The least value from which on all persist, by their motions from the last down; infinite where the last dies."""
    least = math.inf
    for value, motion in zip(reversed(values), motions, strict=True):
        if _persists(motion) is not True:
            break
        least = value
    return least

"""What the solver of 2011 did to the motion: Bogacki and Shampine's method at its usual settings, beside exact motion.

The paper names the method, not its settings. The usual ones of the programs that offer it are a relative tolerance of
1e-3 and an absolute tolerance of 1e-3 of the largest value so far; a step load from rest makes that the first swing. Of
a rotation with the step h the method of third order keeps |1 + z + z^2/2 + z^3/6| at z = i w h, that is

    |.|^2 = 1 - (w h)^4/12 + (w h)^6/36,      so it adds the damping   (w h)^4/(24 h)  [1/s]

for w h small: at 1,000 steps in 0.05 s, w h is 0.6 and the method adds about as much as half the table's damping.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from operator import mul
from typing import Any

import numpy as np

from squealbox.designs import DrumBrake
from squealbox.papers.drum_brake_2011 import steady
from squealbox.papers.drum_brake_2011.cases import DURATION, Case
from squealbox.papers.drum_brake_2011.claims import EXACT, RAW
from squealbox.papers.drum_brake_2011.motions import METHODS, SAMPLES, judged
from squealbox.signals import growth_rate
from squealbox.system import as_system
from squealbox.transient import simulate
from squealbox.transient.verdict import verdict

RELATIVE = 1e-3
SHORTEST = 1e-9  # s: a step that crosses a reversal of sgn is kept once it is this short
SETTINGS = {
    "exact": "every stick, slip and reversal located",
    "raw": "the same method with a relative tolerance of 1e-3 throughout, as the raw runs of this study",
    "ode23": "usual settings: relative tolerance 1e-3, absolute tolerance 1e-3 of the largest value so far",
}
EARLY, LATE = (0.0, 0.0125), (0.0125, 0.025)  # s; after that nothing is left but the error allowed
LOADS = tuple(500.0 * i for i in range(16, 27))  # N: 8 to 13 kN
FRICTIONS = tuple(round(0.38 + 0.005 * i, 3) for i in range(6))


@dataclass(frozen=True)
class Decay:
    """A run that decays: its time and x, the steps it took, and its decay rate [1/s] early and late."""

    setting: str
    t: Any
    x: Any
    steps: int
    early: float
    late: float


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

    def at(self, times: Any) -> "Plain":
        """The same at other times, by the cubic through values and rates at both ends of a step."""
        from scipy.interpolate import CubicHermiteSpline

        spline = CubicHermiteSpline(self.t, self.q, self.qd)
        return Plain(np.asarray(times), spline(times), spline(times, 1))


def ode23(design: Any, duration: float = DURATION, rtol: float = RELATIVE) -> Plain:
    """The motion from rest as the programs of 2011 integrate it: plain sgn, one error for the worst of all values.

    A step is kept when h |e_i| <= rtol max(|y_i|, a_i) for every value, with the absolute tolerance rtol a_i that
    begins at 1e-6 and rises to rtol times the largest value so far; the next step is 0.8 (rtol/error)^(1/3) times the
    last, at most five times, and never longer than a fiftieth of the run.
    """
    rate, size = _rate(as_system(design))
    time, y, step, largest = 0.0, [0.0] * (2 * size), 1e-6, [1e-6 / rtol] * (2 * size)
    first, failed = rate(y), False
    times, states = [time], [y]
    while time < duration:
        step = min(step, duration / 50.0, duration - time)
        half, three, ninth = 0.5 * step, 0.75 * step, step / 9.0
        second = rate([a + half * k for a, k in zip(y, first, strict=True)])
        third = rate([a + three * k for a, k in zip(y, second, strict=True)])
        slopes = zip(y, first, second, third, strict=True)
        new = [a + ninth * (2.0 * k1 + 3.0 * k2 + 4.0 * k3) for a, k1, k2, k3 in slopes]
        fourth = rate(new)
        worst = step * max(
            abs(-5.0 * k1 / 72.0 + k2 / 12.0 + k3 / 9.0 - k4 / 8.0) / max(abs(a), abs(b), most)
            for k1, k2, k3, k4, a, b, most in zip(first, second, third, fourth, y, new, largest, strict=True)
        )
        if worst > rtol and step > SHORTEST:
            step *= 0.5 if failed else max(0.5, 0.8 * (rtol / worst) ** (1.0 / 3.0))
            failed = True
            continue
        time, y, first, failed = time + step, new, fourth, False
        largest = [max(most, abs(a)) for most, a in zip(largest, y, strict=True)]
        times.append(time)
        states.append(y)
        step *= min(5.0, 0.8 * (rtol / max(worst, 1e-12)) ** (1.0 / 3.0))
    found = np.array(states)
    return Plain(np.array(times), found[:, :size], found[:, size:])


def _rate(system: Any) -> tuple[Callable[[list[float]], list[float]], int]:
    """The rate of change of (q, q') in plain numbers, several times as quick as arrays of two; and the freedoms."""
    inverse, size = np.linalg.inv(system.M), system.size
    linear = np.hstack([-inverse @ system.K, -inverse @ system.C]).tolist()
    force = (inverse @ system.load).tolist()
    contacts = [
        (np.concatenate([c.n, 0.0 * c.t]).tolist(), np.concatenate([0.0 * c.n, c.t]).tolist(),
         (inverse @ c.d).tolist(), float(c.N0), float(c.V), float(c.law.static), float(c.law.slope))
        for c in system.contacts
    ]  # fmt: skip

    def rate(y: list[float]) -> list[float]:
        change = [f + sum(map(mul, row, y)) for f, row in zip(force, linear, strict=True)]
        for n, t, d, preload, speed, static, slope in contacts:
            v = speed - sum(map(mul, t, y))
            if v:
                mu = static + slope * abs(v)  # Eq. (2)
                pull = (mu if v > 0.0 else -mu) * (preload + sum(map(mul, n, y)))
                change = [a + pull * b for a, b in zip(change, d, strict=True)]
        return y[size:] + change

    return rate, size


def run(design: Any, setting: str) -> Any:
    """A motion from rest by one of `SETTINGS`, at the sample times of the study."""
    if setting == "exact":
        return simulate(design, DURATION, "rest", SAMPLES, METHODS[EXACT], EXACT)
    if setting == "raw":
        return simulate(design, DURATION, "rest", SAMPLES, METHODS[RAW], RAW)
    return ode23(design)


def decays(case: Case, mu: float = 0.30) -> list[Decay]:
    """The motion at `mu` by every setting, with the decay rate of its lower mode."""
    design = case.design(mu=mu)
    lower = float(steady.frequencies(steady.modes(case, mu=mu))[0]) / (2.0 * np.pi)
    found = []
    for setting in SETTINGS:
        motion = run(design, setting)
        steps = int(motion.steps)
        if isinstance(motion, Plain):
            motion = motion.at(np.linspace(0.0, DURATION, SAMPLES))
        x = motion.q[:, 0]
        rates = []
        for low, high in (EARLY, LATE):
            inside = (motion.t >= low) & (motion.t <= high)
            rates.append(-float(growth_rate(x[inside], motion.t[inside], frequency=lower).rate))
        found.append(Decay(setting, motion.t, x, steps, *rates))
    return found


def onsets(case: Case) -> dict[str, tuple[float, float]]:
    """The least load [N] and friction coefficient from which on every motion tried persists, by setting."""
    return {
        setting: (
            _least([(load, case.design(load=load)) for load in LOADS], setting),
            _least([(mu, case.design(mu=mu)) for mu in FRICTIONS], setting),
        )
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


def _persists(motion: Any) -> bool | None:
    if not isinstance(motion, Plain):
        return judged(motion).persists
    found = verdict(motion.at(np.linspace(0.0, DURATION, SAMPLES)), dof=0)
    return {"decays": False, "grows": True, "settles_on_cycle": True}.get(found.kind)


def _least(tried: list[tuple[float, Any]], setting: str) -> float:
    """The least value from which on all designs persist, tried from the last down; infinite where the last does not."""
    least = math.inf
    for value, design in reversed(tried):
        if _persists(run(design, setting)) is not True:
            break
        least = value
    return least

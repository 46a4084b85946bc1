"""The best tuned mass for a brake: how it is to be tuned and damped, and how narrow that is.

aim "decay" asks for the fastest decay of the slowest motion, "margin" for the highest critical value of a parameter,
"probability" for the least squeal over a scatter. On a negatively damped oscillator the best decay is reached where the
two pairs meet, (s^2 + a s + g)^2: eigenvalues move there as the root of a detuning, so that point is solved for as
(lambda_i - lambda_j)^2 = 0 and not searched for.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from squealbox.arguments import public, with_parameters
from squealbox.countermeasures.base import outer
from squealbox.countermeasures.loss import at_the_window, first_loss
from squealbox.countermeasures.mechanical import TunedMass
from squealbox.design import Design
from squealbox.parameters import ParameterError, known_names
from squealbox.result import Array, Result, quantity
from squealbox.scatter import Scatter, Scattered, as_scatter
from squealbox.stability import complex_modes, growth_about, growth_of, spectrum, steady_sliding
from squealbox.system import Equilibrium, Linearised, as_system

if TYPE_CHECKING:
    from squealbox.stability import ComplexModes

AIMS = ("decay", "margin", "probability")
FREQUENCIES, DAMPINGS = 21, 14  # of the detuning map
BEYOND, HEAVIEST = 2.0, 5.0  # times the ends of the map, and the largest damping ratio, that are looked at
LIGHTEST = 1e-5  # damping ratio below which it is tried without any
ALIKE = 1e-13  # of the largest value of the map: closer than round-off none is better
POLISHED = 3  # best points of the map from which the search goes on
FAR = 5.0  # in logarithms, from the best tuning to where two modes meet


@dataclass(frozen=True, kw_only=True, eq=False)
class BestAbsorber(Result):
    """The best tuned mass, as :func:`best_absorber` returns it, with its detuning map.

    `value` is the growth rate [1/s] (decay), the critical value (margin) or the probability of squeal, and `growth_map`
    that over frequencies and damping ratios. `band` are the frequencies between which the brake stays stable.
    """

    frequency: Any = quantity("", "Hz", "frequency of the absorber")
    damping: Any = quantity("", "1", "damping ratio of the absorber")
    value: Any = quantity("", "", "what was aimed for")
    before: Any = quantity("", "", "the same without the absorber")
    frequencies: Array = quantity("tuning", "Hz", "frequencies of the map")
    dampings: Array = quantity("ratio", "1", "damping ratios of the map")
    growth_map: Array = quantity("tuning ratio", "", "what was aimed for, over tuning and damping")
    band: tuple[float, float] = (float("nan"), float("nan"))
    aim: str = "decay"

    coordinates: ClassVar = {"tuning": "frequencies", "ratio": "dampings"}
    table_over: ClassVar = ("tuning", "ratio")

    @property
    def design(self) -> TunedMass:
        """The brake with its best absorber."""
        given = self.inputs
        return TunedMass(given["system"], given["on"], given["mass"], float(self.frequency), float(self.damping))

    def summary(self) -> str:
        """Tuning, what it brings, and how narrow it is."""
        what = {"decay": "growth rate [1/s]", "margin": "critical value", "probability": "P(squeal)"}[self.aim]
        low, high = self.band
        given = self.inputs
        return (
            f"{given['mass']:g} kg on {given['on']}: tune to {float(self.frequency):.6g} Hz, damp by "
            f"{100.0 * float(self.damping):.4g} %: {what} {float(self.before):.6g} -> {float(self.value):.6g}"
            + (f"; stable from {low:.6g} to {high:.6g} Hz" if np.isfinite(low) else "; not stable")
        )


@public(bounds=None, brake=with_parameters)
def best_absorber(
    brake: Design,
    on: str,
    mass: float,
    aim: str = "decay",
    scatter: Scattered | None = None,
    *,
    parameter: str = "friction.static",
    bounds: tuple[float, float] | None = None,
    samples: int = 256,
    seed: int = 0,
) -> BestAbsorber:
    """The frequency and damping ratio with which a tuned mass serves a brake best.

    Parameters
    ----------
    brake : any design
    on : degree of freedom the absorber stands on
    mass : of the absorber [kg]
    aim : "decay" (least growth rate), "margin" (largest critical value of `parameter` within `bounds`) or "probability"
        (least share of the lot drawn from `scatter` that squeals)
    bounds : [SI] None takes 0 to 2 times the parameter's value
    samples, seed : of the lot, the same for every tuning

    Returns
    -------
    BestAbsorber. Accuracy: about 1e-8 of the largest |eigenvalue| where two modes meet. A margin whose best tuning lies
    at the edge of a narrow window of instability, which just closes there, is solved for where the matrices are linear
    in the parameter, as in friction that does not fall; else it is found to about 1e-4.

    >>> from squealbox import LinearSlope, MassOnBelt
    >>> block = MassOnBelt(sliding_speed=1.0, friction=LinearSlope(0.4, -0.1))
    >>> round(float(best_absorber(block, "x", 0.05).value), 6)
    -0.0611
    """
    if aim not in AIMS:
        raise ParameterError("best_absorber", "aim", aim, known_names(str(aim), list(AIMS)))
    if aim == "probability" and scatter is None:
        raise ParameterError("best_absorber", "scatter", scatter, "the scatter the probability is of")
    scatter = None if scatter is None else as_scatter(scatter)
    modes = complex_modes(brake)
    if not modes.outcome.ok:
        raise ParameterError("best_absorber", "brake", str(modes.outcome), f"steady sliding: {modes.outcome.message}")
    centre = float(modes.most_unstable.frequency) or float(np.max(modes.frequency))
    start = TunedMass(brake, on, mass, centre, 0.1)
    start.system()  # an unknown name is said before the search
    judge = _judge(start, aim, scatter, parameter, bounds, samples, seed)
    ratio = mass * float(np.sum(np.abs(modes.most_unstable.shape[_place(start, on)]) ** 2)) / _modal_mass(brake, modes)
    damped = max(np.sqrt(max(ratio, 1e-6)), 1e-3)
    frequencies = centre * np.exp(np.linspace(-1.0, 1.0, FREQUENCIES) ** 3 * np.log(2.5))
    dampings = damped * np.geomspace(0.01, 3.0, DAMPINGS)
    if aim == "margin":  # each look is a scan of its own: a coarser map
        frequencies, dampings = frequencies[::2], dampings[::2]
    grid = np.array([judge(np.full(len(dampings), f), dampings) for f in frequencies])
    best = _searched(judge, frequencies, dampings, grid, {"margin": 70, "probability": 100}.get(aim, 300))
    if aim == "decay":
        best = min([best, *_meetings(start, best[1:])], key=lambda each: each[0])
    if aim == "margin":
        best = min(
            [best, *at_the_window(start, best, parameter, _limits(start, parameter, bounds))], key=lambda each: each[0]
        )
    value, frequency, damping = best
    undamped = float(np.ravel(judge(np.array([frequency]), np.zeros(1)))[0])
    if undamped <= value:
        value, damping = undamped, 0.0
    if aim == "probability":  # without what decided between equal shares
        value, grid = float(np.floor(value * samples + 1e-9)) / samples, np.floor(grid * samples + 1e-9) / samples
    sign = -1.0 if aim == "margin" else 1.0
    without = _without(brake, aim, scatter, parameter, bounds, samples, seed)
    inputs = {"system": brake, "on": on, "mass": float(mass)}
    settings = {"aim": aim, "parameter": parameter, "bounds": bounds, "samples": samples, "seed": seed}
    return BestAbsorber(
        frequency=np.asarray(frequency), damping=np.asarray(damping), value=np.asarray(sign * value),
        before=np.asarray(without), frequencies=frequencies, dampings=dampings,
        growth_map=sign * grid,
        band=_band(start.replace(frequency=frequency, damping=damping)), aim=aim, inputs=inputs, settings=settings,
    )  # fmt: skip


Judge = Callable[[Any, Any], Any]


def _tuned(start: TunedMass) -> Callable[[Any, Any], Linearised]:
    """The linearised brake over frequencies and damping ratios (...), one shape, of its absorber.

    Its spring and damper alone change with them, and it hangs still while the brake slides: the rest is known once.
    """
    system = as_system(start, linear=True)
    if any(loop.sampling is not None for loop in system.loops):  # of one exact sample no part is the absorber's alone
        return lambda f, z: steady_sliding(start.replace(frequency=f, damping=z))
    about, base = steady_sliding(start), start.brake.system()
    row = np.zeros(about.K.shape[-1])
    row[: base.size + 1] = start.stretch(base)
    before = start.spring_and_damper

    def tuned(frequency: float | np.ndarray, damping: float | np.ndarray) -> Linearised:
        spring, damper = start.tuned_to(frequency, damping)
        stiffness = about.K + outer(spring - before[0], row, row)
        losses = about.C + outer(damper - before[1], row, row)
        state, shape = about.equilibrium, np.shape(spring)
        over = {
            name: np.broadcast_to(getattr(state, name), shape + np.shape(getattr(state, name)))
            for name in ("q", "normal_force", "sliding_speed", "friction", "exists", "floating")
        }
        sliding = Equilibrium(**over, outcome=state.outcome)
        return Linearised(np.broadcast_to(about.M, stiffness.shape), losses, stiffness, sliding)

    return tuned


def _judge(
    start: TunedMass,
    aim: str,
    scatter: Any,
    parameter: str,
    bounds: tuple[float, float] | None,
    samples: int,
    seed: int,
) -> Judge:
    """The number to be made small, of frequencies and damping ratios (k,)."""
    if aim == "decay":
        tuned = _tuned(start)
        return lambda f, z: growth_about(tuned(f, z))
    if aim == "margin":
        limits = _limits(start, parameter, bounds)

        def margin(f: ArrayLike, z: ArrayLike) -> Any:
            pairs = zip(np.atleast_1d(f), np.atleast_1d(z), strict=True)
            return np.array([-first_loss(start.replace(frequency=a, damping=b), parameter, limits) for a, b in pairs])

        return margin
    lot = (scatter or Scatter({})).sample(samples, seed=seed)

    def share(f: ArrayLike, z: ArrayLike) -> Any:
        found = []
        for one, two in zip(np.atleast_1d(f), np.atleast_1d(z), strict=True):
            growth = growth_of(start.replace({**lot, "frequency": one, "damping": two}))
            growing = np.maximum(growth, 0.0)
            # shares are steps: what grows decides between equal ones, by less than one sample
            found.append(float(np.mean(growing > 0.0)) + 0.9 / samples * float(np.mean(growing / (1.0 + growing))))
        return np.array(found)

    return share


def _limits(start: Design, parameter: str, bounds: tuple[float, float] | None) -> tuple[float, float]:
    if bounds is not None:
        return float(bounds[0]), float(bounds[1])
    value = float(start.value_of(parameter))
    return 0.0, 2.0 * value if value > 0.0 else 1.0


def _searched(
    judge: Judge, frequencies: np.ndarray, dampings: np.ndarray, grid: np.ndarray, most: int
) -> tuple[float, float, float]:
    """The best (value, frequency, damping), by Nelder and Mead in logarithms from the best points of the map."""
    from scipy.optimize import minimize

    def judged(x: np.ndarray) -> float:
        frequency, damping = np.exp(x)
        if not (frequencies[0] / BEYOND < frequency < BEYOND * frequencies[-1] and LIGHTEST < damping < HEAVIEST):
            return float("inf")
        return float(np.ravel(judge(np.exp(x[:1]), np.exp(x[1:])))[0])

    around = np.pad(grid, 1, constant_values=np.inf)
    neighbours = [around[i : i + grid.shape[0], k : k + grid.shape[1]] for i in range(3) for k in range(3)]
    valleys = np.argwhere(grid <= np.min(neighbours, axis=0))
    valleys = valleys[np.argsort(grid[tuple(valleys.T)])][:POLISHED]
    best = (np.inf, 0.0, 0.0)
    alike = ALIKE * float(np.max(np.abs(grid), where=np.isfinite(grid), initial=0.0))
    for i, k in valleys:
        simplex = np.log([frequencies[i], dampings[k]]) + np.array([[0.0, 0.0], [0.02, 0.0], [0.0, 0.3]])
        for _ in range(2):  # begun again from where it ended: it may have become flat
            found = minimize(
                judged, simplex[0], method="Nelder-Mead",
                options={"initial_simplex": simplex, "xatol": 1e-10, "fatol": alike, "maxfev": most},
            )  # fmt: skip
            simplex = found.x + np.array([[0.0, 0.0], [1e-3, 0.0], [0.0, 1e-2]])
            if found.fun < best[0]:
                best = (float(found.fun), float(np.exp(found.x[0])), float(np.exp(found.x[1])))
    return best


def _meetings(start: TunedMass, near: tuple[float, float]) -> list[tuple[float, float, float]]:
    """Tunings near by at which two of the slowest modes meet: (lambda_i - lambda_j)^2 = 0, two real equations."""
    from scipy.optimize import root

    tuned = _tuned(start)

    def apart(x: np.ndarray) -> Any:
        frequency, damping = np.exp(np.clip(x, np.log(near) - FAR, np.log(near) + FAR))  # a step may go anywhere
        values = spectrum(tuned(frequency, damping))
        upper = np.sort_complex(-values[: len(values) // 2])[: max(len(values) // 2, 2)]
        squares = np.array([(a - b) ** 2 for i, a in enumerate(upper) for b in upper[:i]]) / np.max(np.abs(upper)) ** 2
        least = squares[int(np.argmin(np.abs(squares)))]
        return np.array([least.real, least.imag])

    found = root(apart, np.log(near), method="hybr", options={"xtol": 1e-14, "eps": 1e-9})
    if not np.all(np.abs(found.x - np.log(near)) <= FAR) or np.max(np.abs(found.fun)) > 1e-10:
        return []  # none, or one far away, where the search was held
    frequency, damping = (float(x) for x in np.exp(found.x))
    values = spectrum(tuned(frequency, damping))
    upper = values[: len(values) // 2]
    order = np.argsort(-upper.real)
    a, b = upper[order[0]], upper[order[min(1, len(order) - 1)]]
    met = 0.5 * (a + b).real if abs(a - b) < 1e-5 * abs(a) else a.real  # a pair that meets is known by its mean
    return [(float(met), frequency, damping)]


def _band(design: TunedMass) -> tuple[float, float]:
    """The frequencies around the tuning between which the brake is stable; NaN where it is not."""
    from scipy.optimize import brentq

    tuned = _tuned(design)
    if not float(growth_about(tuned(design.frequency, design.damping))) < 0.0:
        return float("nan"), float("nan")

    def growth(x: float) -> float:
        moved = float(np.exp(x))  # the damper itself stays
        return float(growth_about(tuned(moved, design.damping * design.frequency / moved)))

    ends = []
    for side in (-1.0, 1.0):
        inside = float(np.log(design.frequency))
        for step in np.geomspace(1e-3, 3.0, 60):
            outside = float(np.log(design.frequency)) + side * step
            if growth(outside) > 0.0:
                ends.append(float(np.exp(brentq(growth, inside, outside, xtol=1e-14, rtol=1e-14))))
                break
            inside = outside
        else:
            ends.append(0.0 if side < 0.0 else float("inf"))
    return ends[0], ends[1]


def _without(
    brake: Design,
    aim: str,
    scatter: Any,
    parameter: str,
    bounds: tuple[float, float] | None,
    samples: int,
    seed: int,
) -> float:
    if aim == "decay":
        return float(growth_of(brake))
    if aim == "margin":
        return first_loss(brake, parameter, _limits(brake, parameter, bounds))
    return float(np.mean(growth_of(brake.replace(scatter.sample(samples, seed=seed))) > 0.0))


def _place(start: TunedMass, on: str) -> Any:
    names = start.brake.system().names
    return [names.index(on)] if isinstance(on, str) else [i for i, x in enumerate(on) if x]


def _modal_mass(brake: Design, modes: "ComplexModes") -> float:
    shape = modes.most_unstable.shape
    mass = brake.system().M
    size = float(np.real(np.conj(shape) @ (mass[: len(shape), : len(shape)] @ shape[: len(mass)])))
    return size if size > 0.0 else float(np.max(np.diag(mass)))

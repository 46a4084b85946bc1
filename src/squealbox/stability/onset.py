"""At which value of a parameter does steady sliding lose (or regain) its stability?

The largest growth rate is scanned over the range in one batched call and each change of sign is refined by Brent's
method. A system without any damping is neutral up to its onset, so no growth rate changes sign there; for it the
refined function is the square of the distance of two squared eigenvalues, which is analytic through the coalescence.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from squealbox.result import Outcome, Result, quantity
from squealbox.stability.eigenvalues import spectrum
from squealbox.system import Equilibrium, Linearised, as_system, linearise

RELATIVE = 1e-12


@dataclass(frozen=True, kw_only=True, eq=False)
class CriticalValue(Result):
    """The value of a parameter at which stability changes, as :func:`critical_value` returns it."""

    value: Any = quantity("", "", "critical value of the parameter, in its own unit; NaN when there is none")
    eigenvalue: Any = quantity("", "1/s", "eigenvalue on the boundary")
    parameter: str = ""
    direction: str = ""

    @property
    def angular_frequency(self) -> float:
        """|Im lambda| at the onset [rad/s]."""
        return float(abs(np.imag(self.eigenvalue)))

    @property
    def frequency(self) -> float:
        """|Im lambda| / (2 pi) at the onset [Hz]."""
        return self.angular_frequency / (2.0 * np.pi)

    def __repr__(self) -> str:
        if not self.outcome.ok:
            return f"{self.parameter}: {self.outcome}, {self.outcome.message}"
        return f"{self.parameter} = {float(self.value):.10g} ({self.direction}) at {self.frequency:.6g} Hz"


def critical_value(
    design: Any, parameter: str, bounds: tuple[float, float], *, points: int = 401, time: float = 0.0
) -> CriticalValue:
    """The first value from below, between `bounds`, at which steady sliding changes its stability.

    Parameters
    ----------
    design : a design whose ``replace({parameter: values})`` makes it a batch, or a callable of one value that returns a
        design or a system
    parameter : dotted name, such as "friction.static"; for a callable, what the result calls it
    bounds : (low, high) in the parameter's own unit
    points : number of values scanned; two changes between neighbours are not seen
    time : instant of schedules [s]

    Returns `CriticalValue`: value good to 1e-12 relative, the eigenvalue there, and direction "destabilising" (unstable
    above) or "stabilising" (stable above). Without a change the outcome is "no_onset" with the growth rates at both
    ends as evidence; "no_equilibrium" when steady sliding exists nowhere in the range.
    """
    low, high = _checked(bounds, points)
    at = _at(design, parameter, time)
    values = np.linspace(low, high, points)
    measure = _measure(at(values))
    inputs = {"system": None if _is_recipe(design) else design, "time": time}
    settings = {"bounds": [low, high], "points": points}
    found = _first_bracket(measure)
    if found is None:
        outcome = _no_onset(at(values[[0, -1]]), measure)
        nothing: dict[str, Any] = {"value": np.nan, "eigenvalue": complex(np.nan), "parameter": parameter}
        return CriticalValue(**nothing, inputs=inputs, settings=settings, outcome=outcome)
    value = _root(at, values[found], values[found + 1], _neutral(at(values[[found, found + 1]])))
    direction = "destabilising" if measure[found] >= 0.0 else "stabilising"
    eigenvalue = _on_the_axis(spectrum(at(np.array([value])))[0])
    found_there: dict[str, Any] = {"value": value, "eigenvalue": eigenvalue, "direction": direction}
    return CriticalValue(**found_there, parameter=parameter, inputs=inputs, settings=settings)


def _checked(bounds: tuple[float, float], points: int) -> tuple[float, float]:
    low, high = (float(b) for b in bounds)
    if not (np.isfinite(low) and np.isfinite(high) and low < high):
        raise ValueError(f"bounds = {bounds}: expected two finite numbers (low, high) with low < high")
    if points < 2:
        raise ValueError(f"points = {points}: expected at least 2")
    return low, high


def _is_recipe(design: Any) -> bool:
    return callable(design) and not hasattr(design, "replace")


def _at(design: Any, parameter: str, time: float) -> Callable[[Any], Linearised]:
    """The linearised matrices at an array of parameter values, shape (values, n, n)."""
    if not _is_recipe(design):
        return lambda values: linearise(as_system(design.replace({parameter: np.asarray(values)})), time)

    def one_by_one(values: Any) -> Linearised:
        parts = [linearise(as_system(design(float(value))), time) for value in values]
        return stacked(parts)

    return one_by_one


def stacked(parts: list[Linearised]) -> Linearised:
    """Linearised systems of one size as a batch along a new first axis."""
    states = [part.equilibrium for part in parts]
    worst = next((state.outcome for state in states if not state.outcome.ok), states[0].outcome)
    names = ("q", "normal_force", "sliding_speed", "friction", "exists")
    state = Equilibrium(**{name: np.stack([getattr(s, name) for s in states]) for name in names}, outcome=worst)
    return Linearised(**{name: np.stack([getattr(part, name) for part in parts]) for name in "MCK"}, equilibrium=state)


def _measure(about: Linearised) -> Any:
    """A measure that is positive where stable, negative where a mode grows; NaN without equilibrium."""
    eigenvalues = spectrum(about)
    growth = -np.max(eigenvalues.real, axis=-1)
    neutral = _neutral(about)
    return np.where(neutral, coalescence(eigenvalues), growth)


def coalescence(eigenvalues: Any) -> Any:
    """For spectra symmetric in lambda -> -lambda: negative where a mode grows, zero at coalescence or divergence.

    With s = lambda^2, min over pairs of Re (s_i - s_j)^2 is negative just where two s are a conjugate pair, and
    -s negative where a root is real; both are analytic in a parameter where the eigenvalues themselves are not.
    """
    half = eigenvalues.shape[-1] // 2
    squares = eigenvalues[..., :half] ** 2
    scale = np.max(np.abs(squares), axis=-1, keepdims=True)
    squares = squares / np.where(scale > 0.0, scale, 1.0)
    nearest = np.min(-squares.real, axis=-1)
    for i in range(half):
        for j in range(i):
            nearest = np.minimum(nearest, np.real((squares[..., i] - squares[..., j]) ** 2))
    return nearest


def _neutral(about: Linearised) -> Any:
    """True where the spectrum is symmetric in lambda -> -lambda: no damping at all, or purely gyroscopic coupling."""
    scale = np.max(np.abs(about.K), axis=(-1, -2)) ** 0.5 * np.max(np.abs(about.M), axis=(-1, -2)) ** 0.5
    none = np.max(np.abs(about.C), axis=(-1, -2)) <= 1e-15 * scale
    skew = np.max(np.abs(about.C + np.swapaxes(about.C, -1, -2)), axis=(-1, -2)) <= 1e-15 * scale
    uneven = np.max(np.abs(about.K - np.swapaxes(about.K, -1, -2)), axis=(-1, -2))
    symmetric = uneven <= 1e-15 * np.max(np.abs(about.K), axis=(-1, -2))
    return none | (skew & symmetric)


def _first_bracket(measure: Any) -> int | None:
    growing = measure < 0.0
    known = np.isfinite(measure)
    changes = np.nonzero((growing[1:] != growing[:-1]) & known[1:] & known[:-1])[0]
    return int(changes[0]) if changes.size else None


def _root(at: Callable[[Any], Linearised], low: float, high: float, neutral: Any) -> float:
    from scipy.optimize import brentq

    def measure(value: float) -> float:
        about = at(np.array([value]))
        eigenvalues = spectrum(about)[0]
        return float(coalescence(eigenvalues) if np.all(neutral) else -np.max(eigenvalues.real))

    root: float = brentq(measure, low, high, xtol=RELATIVE * max(abs(low), abs(high)), rtol=RELATIVE)
    return root


def _on_the_axis(eigenvalues: Any) -> complex:
    """The eigenvalue with the largest growth rate; its real part is what the root finder left."""
    half = len(eigenvalues) // 2
    return complex(eigenvalues[:half][np.argmax(eigenvalues[:half].real)])


def _no_onset(ends: Linearised, measure: Any) -> Outcome:
    if not np.any(np.isfinite(measure)):
        return Outcome("no_equilibrium", f"no steady sliding in the range: {ends.equilibrium.outcome.message}")
    growth = [float(g) for g in np.max(spectrum(ends).real, axis=-1)]
    state = "unstable" if np.nanmin(measure) < 0.0 else "stable"
    return Outcome("no_onset", f"{state} in the whole range", growth_rate_low=growth[0], growth_rate_high=growth[1])

"""Parameters of a design from what was measured of the brake: values, covariance, intervals, and what stays open.

    chi^2(p) = sum_i ((y_i - y_i(p)) / sd_i)^2,      S = (J'J)^-1,   J_ij = d y_i/d p_j / sd_i

Intervals are profiles: p_j is held, all others are fitted anew, and the interval ends where chi^2 has risen by 3.84.
The singular values of J, scaled by the parameters, say which combinations the data know.
Source: G. A. F. Seber, C. J. Wild, Nonlinear Regression, 1989, chapters 3 and 5.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from squealbox.arguments import public
from squealbox.calibration.measured import Measured
from squealbox.calibration.search import WORST, linearised, losses, searched
from squealbox.distributions import TruncatedNormal
from squealbox.family import DesignOrRecipe
from squealbox.parameters import ParameterError
from squealbox.result import Array, Outcome, Result, quantity
from squealbox.scatter import Scatter

LOSSES = ("squares", "robust")
FIRST = 256  # points of the box from which the best are followed
STARTS = 12
RANK = 1e-6  # singular value beside the largest, from which a combination counts as unknown
LOOSE = 0.5  # relative standard deviation from which a parameter counts as hardly known
FAR = 3.0  # standard deviations from which a residual is named
PROFILE = 9  # points on either side
SPAN = 3.0  # standard deviations a profile is followed


@dataclass(frozen=True, kw_only=True, eq=False)
class Calibration(Result):
    """Parameters that fit, as :func:`calibrate` returns them.

    The outcome is "completed", "not_identifiable" (some combination of parameters leaves every measured value as it is)
    or "no_fit" (no design within the bounds has an answer to all that was measured).
    """

    values: Array = quantity("parameter", "", "best values, in SI")
    errors: Array = quantity("parameter", "", "standard deviations from the covariance")
    covariance: Array = quantity("parameter parameter2", "", "covariance of the values")
    low: Array = quantity("parameter", "", "lower end of the profile interval")
    high: Array = quantity("parameter", "", "upper end of the profile interval")
    predicted: Array = quantity("measured", "", "what the fitted design says of each measured number")
    residuals: Array = quantity("measured", "1", "measured less predicted, in standard deviations")
    singular_values: Array = quantity("parameter", "1", "of the scaled sensitivities, largest first")
    directions: Array = quantity("parameter parameter2", "1", "combinations that belong to them, one in a row")
    chi_square: float = np.nan
    cannot_tell: tuple[str, ...] = ()

    @property
    def names(self) -> tuple[str, ...]:
        """The parameters, in order."""
        return tuple(self.settings["names"])

    @property
    def correlation(self) -> Any:
        """Correlation of the values, shape (p, p)."""
        scale = np.where(self.errors > 0.0, self.errors, 1.0)
        return self.covariance / np.outer(scale, scale)

    @property
    def design(self) -> Any:
        """The design with the fitted values."""
        return _made(self.inputs["design"], dict(zip(self.names, (float(x) for x in self.values), strict=True)))

    @property
    def scatter(self) -> Scatter:
        """What is known of the parameters as a `Scatter` for `squeal_probability`: normal, cut at the bounds."""
        bounds = self.settings["bounds"]
        parts = {
            name: TruncatedNormal(float(value), max(float(error), 1e-12 * (high - low)), low, high)
            for name, value, error, (low, high) in zip(self.names, self.values, self.errors, bounds, strict=True)
        }
        matrix = np.clip(self.correlation, -0.999999, 0.999999)
        np.fill_diagonal(matrix, 1.0)
        return Scatter(parts, matrix if len(parts) > 1 else None)

    def predict(self, measured: Measured, *, samples: int = 2000, seed: int = 0) -> tuple[float, float, float]:
        """What the fitted brake does elsewhere: the value, and the 95 % band that the parameters leave it."""
        best = float(np.ravel(measured.predicted(_made(self.inputs["design"], {**_single(self), **measured.at})))[0])
        drawn = self.scatter.sample(samples, seed=seed)
        found = measured.predicted(_made(self.inputs["design"], {**drawn, **measured.at}))
        low, high = np.nanquantile(np.broadcast_to(found, (samples,)), (0.025, 0.975))
        return best, float(low), float(high)

    def posterior(self, count: int = 4000, *, seed: int = 0, walkers: int = 64, burn: int = 200) -> Any:
        """Draws from the posterior under flat priors within the bounds, shape (count, p).

        An ensemble of walkers that stretch towards each other (Goodman and Weare 2010, Comm. App. Math. Comp. Sci. 5,
        65-80); every step is one call with half of them.
        """
        problem = _Problem(self.inputs["design"], self.names, self.settings["bounds"], self.inputs["measured"])
        robust = self.settings["loss"] == "robust"
        rng = np.random.default_rng(seed)
        size = len(self.names)
        walkers = max(2 * size + 2, walkers) // 2 * 2
        best = problem.inside(self.values)
        spread = np.minimum(np.nan_to_num(self.errors / problem.width, nan=0.1), 0.2)
        u = np.clip(best + 0.5 * spread * rng.standard_normal((walkers, size)), 1e-9, 1.0 - 1e-9)
        cost = losses(problem(u), robust)
        kept = []
        half = walkers // 2
        for step in range(burn + -(-count // walkers)):
            for mine, other in ((slice(0, half), slice(half, None)), (slice(half, None), slice(0, half))):
                stretch = (rng.uniform(size=half) + 1.0) ** 2 / 2.0  # density 1/sqrt(z) on [1/2, 2]
                partner = u[other][rng.integers(half, size=half)]
                trial = partner + stretch[:, None] * (u[mine] - partner)
                inside = np.all((trial >= 0.0) & (trial <= 1.0), axis=1)
                found = np.where(inside, losses(problem(np.clip(trial, 0.0, 1.0)), robust), np.inf)
                chance = (size - 1) * np.log(stretch) - 0.5 * (found - cost[mine])
                taken = np.log(rng.uniform(size=half)) < chance
                u[mine] = np.where(taken[:, None], trial, u[mine])
                cost[mine] = np.where(taken, found, cost[mine])
            if step >= burn:
                kept.append(u.copy())
        return problem.low + np.concatenate(kept)[:count] * problem.width

    def summary(self) -> str:
        """A table of the parameters and one of what was measured, and what the data cannot tell."""
        width = max(len(name) for name in ("parameter", *self.names))
        lines = [f"{'parameter':{width}}  {'value':>13}  {'sd':>10}  95 % interval"]
        if not np.all(np.isfinite(self.values)):
            return self.outcome.told
        for i, name in enumerate(self.names):
            numbers = f"{self.values[i]:13.6g}  {self.errors[i]:10.3g}  {self.low[i]:.6g} to {self.high[i]:.6g}"
            lines.append(f"{name:{width}}  {numbers}")
        lines.append(f"chi^2 = {self.chi_square:.3g} of {len(self.residuals)} measured numbers")
        for text, found, away in zip(self.settings["measured"], self.predicted, self.residuals, strict=True):
            mark = "  <- not reached" if abs(away) > FAR else ""
            lines.append(f"  {text}: the model says {found:.6g}, {round(float(away), 2) + 0.0:+.2f} sd{mark}")
        if not self.outcome.ok:
            lines.append(self.outcome.told)
        return "\n".join([*lines, *self.cannot_tell])


@public()
def calibrate(
    design: DesignOrRecipe,
    parameters: Mapping[str, tuple[float, float]],
    measured: Sequence[Measured | Sequence[Measured]],
    *,
    loss: str = "squares",
    level: float = 0.95,
    profile: bool = True,
    seed: int = 0,
) -> Calibration:
    """Fit parameters of a design to measured numbers.

    Parameters
    ----------
    design : has ``replace``; or a function of {parameter: values} that makes a design or a system of arrays
    parameters : {dotted name: (lowest, highest)} of what is fitted; a trial never leaves these bounds
    measured : the measured numbers with their standard deviations; lists of them, as `from_signal`, `from_events` and
        `from_friction` make of a signal, an event and a friction curve, may stand among them
    loss : "squares"; or "robust", 2 (sqrt(1 + r^2) - 1), under which one bad number does not pull the rest
    level : [-] of the intervals
    profile : False takes the intervals from the covariance, which is quicker
    seed : of the first points

    Returns
    -------
    Calibration

    Raises `ParameterError` for bounds, names or measured numbers that cannot be meant. A frequency and a growth rate of
    one mode do not tell friction from damping: what the data leave open is in `cannot_tell`, in words.

    >>> from squealbox import ModeCoupling
    >>> brake = ModeCoupling()
    >>> found = calibrate(brake, {"k22": (1.5, 3.0)}, [Measured("critical_value", 1.2, sd=0.01)])
    >>> bool(found.low[0] < found.values[0] < found.high[0])
    True
    """
    from scipy.stats import chi2

    problem = _Problem(design, tuple(parameters), list(parameters.values()), _flat(measured))
    if loss not in LOSSES or not 0.0 < level < 1.0:
        raise ParameterError("calibrate", "loss, level", (loss, level), "'squares' or 'robust', and a level in (0, 1)")
    robust = loss == "robust"
    settings = {"names": list(problem.names), "bounds": problem.bounds, "loss": loss, "level": level, "seed": seed}
    settings["measured"] = [f"{each.name} {each.value:.6g} +- {each.sd:.2g}" for each in problem.measured]
    inputs = {"design": design, "measured": problem.measured}
    u, cost = problem.best(robust, seed)
    size, count = len(problem.names), len(problem.measured)
    if not np.isfinite(cost) or cost >= WORST:
        nothing = np.full(size, np.nan)
        text = f"no design within the bounds has an answer to all {count} measured numbers"
        empty: dict[str, Any] = {"errors": nothing, "low": nothing, "high": nothing, "singular_values": nothing}
        square = np.full((size, size), np.nan)
        return Calibration(
            values=nothing, covariance=square, directions=square, predicted=np.full(count, np.nan),
            residuals=np.full(count, np.nan), inputs=inputs, settings=settings,
            outcome=Outcome("no_fit", text), **empty,
        )  # fmt: skip
    r, jacobian = (part[0] for part in linearised(problem, u[None]))
    values = problem.low + u * problem.width
    scale = np.where(np.abs(values) > 1e-9 * problem.width, np.abs(values), problem.width)
    _, singular, rows = np.linalg.svd(jacobian * (scale / problem.width), full_matrices=True)
    singular = np.append(singular, np.zeros(size - len(singular)))
    unknown = singular <= RANK * max(singular[0], 1e-300)
    inverse = np.where(unknown, 0.0, 1.0 / np.where(unknown, 1.0, singular))
    covariance = (rows.T * inverse**2) @ rows * np.outer(scale, scale)
    errors = np.sqrt(np.diag(covariance))
    for row in rows[unknown]:
        errors[np.abs(row) > 0.1] = np.inf
    rise = float(chi2.ppf(level, 1))
    low, high = values - np.sqrt(rise) * errors, values + np.sqrt(rise) * errors
    if profile:
        low, high = _profiles(problem, u, cost, errors, rise, robust, low, high)
    low, high = np.maximum(low, problem.low), np.minimum(high, problem.low + problem.width)
    told = _words(problem, values, errors, singular, rows, unknown, low, high)
    wrong = [problem.measured[i].name for i in np.nonzero(np.abs(r) > FAR)[0]]
    if wrong:
        told.append(f"the model does not reach {', '.join(wrong)}: more than {FAR:g} standard deviations are left")
    outcome = (
        Outcome("not_identifiable", told[0], singular_values=[float(x) for x in singular])
        if np.any(unknown)
        else Outcome()
    )
    return Calibration(
        values=values, errors=errors, covariance=covariance, low=low, high=high,
        predicted=np.array([each.value for each in problem.measured]) - r * problem.sd, residuals=r,
        singular_values=singular, directions=rows, chi_square=float(np.sum(r**2)), cannot_tell=tuple(told),
        inputs=inputs, settings=settings, outcome=outcome,
    )  # fmt: skip


def _flat(measured: Iterable[Any]) -> list[Any]:
    """The measured numbers, those of lists among them each for itself."""
    found: list[Any] = []
    for each in measured:
        found += _flat(each) if isinstance(each, (list, tuple)) else [each]
    return found


class _Problem:
    """Residuals (measured - predicted)/sd at points of the unit box, all in one call."""

    def __init__(
        self, design: DesignOrRecipe, names: Sequence[str], bounds: Sequence[Any], measured: Sequence[Measured]
    ) -> None:
        if not names:
            raise ParameterError("calibrate", "parameters", {}, "one parameter or more with its bounds")
        if not measured or not all(isinstance(each, Measured) for each in measured):
            raise ParameterError("calibrate", "measured", list(measured), "a list of Measured(...), one or more")
        for name, pair in zip(names, bounds, strict=True):
            if np.shape(pair) != (2,) or not np.all(np.isfinite(pair)) or not pair[0] < pair[1]:
                raise ParameterError("calibrate", name, pair, "(lowest, highest), finite and increasing")
        self.design, self.names, self.measured = design, tuple(names), list(measured)
        self.bounds = [[float(a), float(b)] for a, b in bounds]
        self.low, high = np.array(self.bounds).T
        self.width = high - self.low
        self.sd = np.array([each.sd for each in self.measured])
        for ends in (self.low, high):  # a bound outside a parameter's range is told at once
            _made(design, dict(zip(self.names, (float(x) for x in ends), strict=True)))

    def inside(self, values: ArrayLike) -> Any:
        """Values as a point of the unit box."""
        return np.clip((np.asarray(values) - self.low) / self.width, 0.0, 1.0)

    def __call__(self, u: np.ndarray) -> Any:
        values = self.low + np.atleast_2d(u) * self.width
        columns = {name: values[:, i] for i, name in enumerate(self.names)}
        rows: list[Any] = []
        known: dict[Any, tuple[Any, dict[str, Any]]] = {}
        for each in self.measured:
            key = tuple(sorted(each.at.items()))
            if key not in known:
                at = {n: np.full(len(values), v) for n, v in each.at.items()}
                known[key] = (_made(self.design, {**columns, **at}), {})
            found = np.broadcast_to(each.predicted(*known[key]), (len(values),))
            rows.append((each.value - found) / each.sd)
        r = np.stack(rows, axis=1)
        return np.where(np.isfinite(r), np.clip(r, -WORST, WORST), WORST)

    def best(self, robust: bool, seed: int) -> tuple[Any, float]:
        """The best of several searches, from the best points of a first sample."""
        from scipy.stats import qmc

        first = qmc.Sobol(len(self.names), rng=np.random.default_rng(seed)).random(FIRST)
        first = np.concatenate([np.full((1, len(self.names)), 0.5), first])
        cost = losses(self(first), robust)
        chosen = first[np.argsort(cost, kind="stable")[:STARTS]]
        ends, cost = searched(self, chosen, np.ones(chosen.shape, dtype=bool), robust)
        best = int(np.argmin(cost))
        return ends[best], float(cost[best])


def _profiles(
    problem: _Problem,
    u: np.ndarray,
    cost: float,
    errors: np.ndarray,
    rise: float,
    robust: bool,
    low: np.ndarray,
    high: np.ndarray,
) -> tuple[Any, Any]:
    """Ends of the profile intervals; a bound where chi^2 does not rise so far within it."""
    size = len(u)
    spread = np.minimum(np.where(np.isfinite(errors), errors / problem.width, 1.0), 1.0)
    shares = np.linspace(0.0, 1.0, PROFILE + 1)[1:]
    starts, free, places = [], [], []
    for j in range(size):
        for side in (-1, 1):
            reach = min(SPAN * max(spread[j], 1e-12), u[j] if side < 0 else 1.0 - u[j])
            for share in shares:
                start = u.copy()
                start[j] = u[j] + side * reach * share
                starts.append(start)
                free.append(np.arange(size) != j)
                places.append((j, side))
    _, found = searched(problem, np.array(starts), np.array(free), robust, steps=25)
    low, high = low.copy(), high.copy()
    for j in range(size):
        for side in (-1, 1):
            rows = [i for i, place in enumerate(places) if place == (j, side)]
            at = np.array([0.0, *(abs(starts[i][j] - u[j]) for i in rows)])
            height = np.maximum.accumulate(np.sqrt(np.maximum(np.array([0.0, *(found[i] - cost for i in rows)]), 0.0)))
            limit = np.sqrt(rise)
            reached = np.nonzero(height >= limit)[0]
            if reached.size and at[-1] > 0.0:
                k = int(reached[0])
                share = (limit - height[k - 1]) / max(height[k] - height[k - 1], 1e-300)
                end = u[j] + side * (at[k - 1] + share * (at[k] - at[k - 1]))
            elif at[-1] < SPAN * spread[j] * (1.0 - 1e-9):
                end = 0.0 if side < 0 else 1.0
            else:
                end = u[j] + side * at[-1]
            value = problem.low[j] + end * problem.width[j]
            if side < 0:
                low[j] = value
            else:
                high[j] = value
    return low, high


def _words(
    problem: _Problem,
    values: np.ndarray,
    errors: np.ndarray,
    singular: np.ndarray,
    rows: np.ndarray,
    unknown: np.ndarray,
    low: np.ndarray,
    high: np.ndarray,
) -> list[str]:
    """What the data cannot tell apart, a sentence each."""
    told = []
    for row in rows[unknown]:
        part = row / row[np.argmax(np.abs(row))]
        moved = [(name, share) for name, share in zip(problem.names, part, strict=True) if abs(share) > 0.05]
        names = ", ".join(name for name, _ in moved)
        if len(moved) == 1:
            told.append(f"the data say nothing about {names}")
            continue
        factors = ", ".join(f"{name} by {share:+.2g} %" for name, share in moved)
        told.append(f"the data cannot tell {names} apart: changing {factors} leaves every measured number as it is")
    for j, name in enumerate(problem.names):
        if np.isfinite(errors[j]) and errors[j] > LOOSE * abs(values[j]):
            weakest = rows[-1] / rows[-1][np.argmax(np.abs(rows[-1]))]
            others = [n for n, share in zip(problem.names, weakest, strict=True) if abs(share) > 0.3 and n != name]
            along = f", mostly together with {', '.join(others)}" if others else ""
            told.append(f"{name} is hardly known{along}: {low[j]:.3g} to {high[j]:.3g} fit")
    return told


def _single(found: Calibration) -> dict[str, float]:
    return dict(zip(found.names, (float(x) for x in found.values), strict=True))


def _made(design: Any, values: Mapping[str, Any]) -> Any:
    return design.replace(dict(values)) if hasattr(design, "replace") else design(dict(values))

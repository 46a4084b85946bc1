"""Measured friction coefficients to a friction law, with confidence bands and a choice. Depends on: friction, result.

Each law mu(v; p) is fitted by least squares (`scipy.optimize.curve_fit`). The band of the fitted curve follows from the
covariance S of p by linear propagation, t sqrt(g' S g) with g = dmu/dp and Student's t of the chosen level, and the
laws are compared by Akaike's criterion AIC = n ln(RSS/n) + 2 (k + 1), k coefficients and one variance.
"""

import dataclasses
import warnings
from collections.abc import Callable, Mapping, Sequence
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from squealbox.arguments import public
from squealbox.friction import LAW_NAMES
from squealbox.law import FrictionLaw
from squealbox.parameters import ParameterError, known_names
from squealbox.result import COMPLETED, Array, Outcome, Result, quantity

LEAST_POINTS = 5
MOST_USUAL = 3  # numbers of the usual laws
CARRIES = 0.9  # leverage of a point from which it carries a coefficient nearly alone


FITTED = {name: law for name, law in LAW_NAMES.items() if law.guess(np.array([0.1, 1.0]), np.array([0.4, 0.3]))}
USUAL = tuple(name for name, law in FITTED.items() if law.creep_formula is None)


@dataclasses.dataclass(frozen=True, kw_only=True, eq=False)
class FrictionFit(Result):
    """Laws fitted to measured points, each with its band; `law` is the one with the least AIC.

    A law that could not be fitted has AIC inf and a NaN curve; `outcome` says why when none could.
    """

    speeds: Array = quantity("point", "m/s", "measured sliding speeds")
    values: Array = quantity("point", "-", "measured friction coefficients")
    curve_speeds: Array = quantity("along", "m/s", "sliding speeds of the curves")
    curves: Array = quantity("law along", "-", "fitted coefficient")
    low: Array = quantity("law along", "-", "lower end of the confidence band")
    high: Array = quantity("law along", "-", "upper end of the confidence band")
    coefficients: Array = quantity("law coefficient", "", "fitted numbers in the order of the law's sheet; NaN behind")
    errors: Array = quantity("law coefficient", "", "standard errors of the fitted numbers")
    aic: Array = quantity("law", "-", "Akaike's criterion")
    rms: Array = quantity("law", "-", "root of the mean squared residual")

    coordinates: ClassVar = {"along": "curve_speeds"}

    def table(self) -> dict[str, Any]:
        """The curve of the best law with its band."""
        told = {"mu [-]": self.curves, "low [-]": self.low, "high [-]": self.high}
        return {"speed [m/s]": self.curve_speeds, **{head: each[self.best] for head, each in told.items()}}

    @property
    def names(self) -> tuple[str, ...]:
        """The laws that were tried."""
        return tuple(self.settings["laws"])

    @property
    def best(self) -> int:
        """Index of the law with the least AIC."""
        return int(np.argmin(self.aic))

    @property
    def law(self) -> FrictionLaw:
        """The law with the least AIC, ready for a design."""
        return self.law_named(self.names[self.best])

    def law_named(self, name: str) -> FrictionLaw:
        """One of the fitted laws by its name. Raises `ParameterError` when it was not fitted."""
        row = self.names.index(name) if name in self.names else -1
        if row < 0 or not np.isfinite(self.aic[row]):
            raise ParameterError("FrictionFit", "law", name, "the name of a law that was fitted")
        names = self._fitted_names(name)
        return FITTED[name](**dict(zip(names, self.coefficients[row].tolist(), strict=False)))

    def _fitted_names(self, law: str) -> list[str]:
        return list(FITTED[law].guess(self.speeds, self.values))

    def summary(self) -> str:
        """A table of the laws, the best first."""
        lines = [f"{'law':14}{'AIC':>10}{'rms':>11}  coefficients"]
        for row in np.argsort(self.aic, kind="stable"):
            name = self.names[row]
            if not np.isfinite(self.aic[row]):
                lines.append(f"{name:14}{'-':>10}{'-':>11}  could not be fitted")
                continue
            parts = zip(self._fitted_names(name), self.coefficients[row], self.errors[row], strict=False)
            text = ", ".join(f"{part} = {value:.4g} +- {error:.2g}" for part, value, error in parts)
            lines.append(f"{name:14}{self.aic[row]:10.2f}{self.rms[row]:11.3g}  {text}")
        return "\n".join(lines)


@public()
def fit_friction(
    speeds: ArrayLike, values: ArrayLike, law: str | Sequence[str] | None = None, *, level: float = 0.95
) -> FrictionFit:
    """Fit friction laws to measured points mu(v).

    Parameters
    ----------
    speeds : shape (n,), [m/s] sliding speeds, 0 or more, n >= 5
    values : shape (n,), [-] measured coefficients in [0, 10]
    law : name of a law or several; left out, all of coulomb, linear_slope, stribeck, hyperbolic, cubic. Of lugre and
        elasto_plastic the curve of steady sliding is fitted: static, kinetic and speed; what their bristles do, a
        stiffness from pre-sliding, is not in such points and keeps its usual value
    level : [-] confidence level of the bands, between 0 and 1

    Returns the fits. A sliding measurement cannot tell the static limit: the fitted laws take mu(v -> 0) for it.
    Raises `ParameterError` for points that are no such measurement. Laws with three coefficients need points on both
    sides of their bend; one that does not settle is left out with AIC inf.

    >>> v = np.linspace(0.1, 2.0, 20)
    >>> fit_friction(v, 0.3 + 0.2 * np.exp(-v / 0.5)).names[fit_friction(v, 0.3 + 0.2 * np.exp(-v / 0.5)).best]
    'stribeck'
    """
    v, mu = _points(speeds, values)
    names = list(USUAL) if law is None else [law] if isinstance(law, str) else list(law)
    for name in names:
        if name not in FITTED:
            raise ParameterError("fit_friction", "law", name, known_names(str(name), list(FITTED)))
    if not 0.0 < level < 1.0:
        raise ParameterError("fit_friction", "level", level, "a number in (0, 1)")
    along = np.linspace(0.0, float(np.max(v)), 201)
    room = max(MOST_USUAL, *(len(FITTED[name].guess(v, mu)) for name in names))
    fits = [_fitted(FITTED[name], v, mu, along, level, room) for name in names]
    arrays: dict[str, Any] = {key: np.array([fit[key] for fit in fits]) for key in fits[0]}
    found = np.any(np.isfinite(arrays["aic"]))
    outcome = Outcome(COMPLETED) if found else Outcome("no_fit", "none of the laws could be fitted", laws=names)
    settings = {"laws": names, "level": level}
    return FrictionFit(speeds=v, values=mu, curve_speeds=along, settings=settings, outcome=outcome, **arrays)


def _points(speeds: ArrayLike, values: ArrayLike) -> tuple[Any, Any]:
    try:
        v, mu = np.asarray(speeds, dtype=float), np.asarray(values, dtype=float)
    except (TypeError, ValueError) as error:
        raise ParameterError("fit_friction", "speeds", speeds, "numbers in m/s") from error
    if v.ndim != 1 or v.shape != mu.shape or v.size < LEAST_POINTS:
        shown = f"shapes {v.shape} and {mu.shape}"
        raise ParameterError("fit_friction", "speeds", shown, f"{LEAST_POINTS} or more speeds with a value each")
    if np.any(v < 0.0):
        at = int(np.argmax(v < 0.0))
        expected = (
            "speeds of 0 m/s or more: a law is of |v|, and the sign of a coefficient would be lost with that of v"
        )
        raise ParameterError("fit_friction", f"speeds[{at}]", float(v[at]), expected)
    if not np.all(np.isfinite(v)) or np.ptp(v) == 0.0:
        raise ParameterError("fit_friction", "speeds", speeds, "finite numbers in m/s, not all the same")
    if not np.all(np.isfinite(mu)) or np.any((mu < 0.0) | (mu > 10.0)):
        raise ParameterError("fit_friction", "values", values, "finite numbers in [0, 10]")
    return v, mu


def _fitted(
    law: type[FrictionLaw], v: np.ndarray, mu: np.ndarray, along: np.ndarray, level: float, room: int
) -> dict[str, Any]:
    from scipy.optimize import OptimizeWarning, curve_fit
    from scipy.stats import t as student

    guess = law.guess(v, mu)
    count, about = len(guess), law.parameters()
    low = [about[name].low + 1e-12 * about[name].low_open for name in guess]

    def curve(speed: np.ndarray, *p: float) -> Any:
        return law.formula(speed, _coefficients(law, dict(zip(guess, p, strict=True))))

    nothing = np.full(along.shape, np.nan)
    failed = {"curves": nothing, "low": nothing, "high": nothing, "aic": np.inf, "rms": np.nan}
    failed |= {"coefficients": np.full(room, np.nan), "errors": np.full(room, np.nan)}
    try:
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("error", OptimizeWarning)
            begin = list(guess.values())
            p, covariance = curve_fit(curve, v, mu, p0=begin, bounds=(low, np.inf), max_nfev=20000)
        law(**dict(zip(guess, p.tolist(), strict=True)))
    except (RuntimeError, ValueError, OptimizeWarning):  # not converged, or numbers that are no such law
        return failed
    residual = float(np.sum((mu - curve(v, *p)) ** 2))
    covariance = _robust(lambda at: curve(v, *at), p, mu, covariance)
    steps = 1e-6 * np.maximum(np.abs(p), 1e-3)
    gradient = [
        (curve(along, *(p + h * e)) - curve(along, *(p - h * e))) / (2.0 * h)
        for h, e in zip(steps, np.eye(count), strict=True)
    ]
    spread = np.sqrt(np.maximum(np.einsum("ia,ij,ja->a", gradient, covariance, gradient), 0.0))
    half = float(student.ppf(0.5 + 0.5 * level, v.size - count)) * spread
    middle = curve(along, *p)
    error = np.sqrt(np.diag(covariance))
    variance = max(residual / v.size, np.finfo(float).tiny)  # a perfect fit has no logarithm
    return {
        "curves": middle,
        "low": middle - half,
        "high": middle + half,
        "coefficients": np.append(p, np.full(room - count, np.nan)),
        "errors": np.append(error, np.full(room - count, np.nan)),
        "aic": v.size * np.log(variance) + 2.0 * (count + 1),
        "rms": np.sqrt(residual / v.size),
    }


def _robust(curve: Callable[[Any], Any], p: np.ndarray, mu: np.ndarray, usual: np.ndarray) -> Any:
    """The covariance of the coefficients, no smaller than what each point says when it is left out.

    The usual one, s^2 (J'J)^-1, takes the scatter of all points for that of the one point that carries a coefficient,
    and that point fits itself. HC3, (J'J)^-1 sum_i J_i'J_i (r_i/(1 - h_i))^2 (J'J)^-1 with the leverage h, is close to
    leaving it out (MacKinnon and White 1985, J. Econometrics 29, 305-325); with h = 1 nothing is known of it but what
    it says itself, and its residual is taken for that of a point with nothing else to go by.
    """
    steps = 1e-6 * np.maximum(np.abs(p), 1e-3)
    jacobian = np.stack(
        [(curve(p + h * e) - curve(p - h * e)) / (2.0 * h) for h, e in zip(steps, np.eye(len(p)), strict=True)], axis=1
    )
    inverse = np.linalg.pinv(jacobian.T @ jacobian)
    leverage = np.einsum("ni,ij,nj->n", jacobian, inverse, jacobian)
    left = np.maximum(1.0 - leverage, 1e-3)
    residual = mu - curve(p)
    free = max(len(mu) - len(p), 1)
    scatter = np.sqrt(np.sum(residual**2) / free)
    weight = np.maximum(np.abs(residual) / left, scatter / np.sqrt(left))
    sandwich = inverse @ (jacobian.T * weight**2) @ jacobian @ inverse
    larger = np.sqrt(np.maximum(np.diag(sandwich), 1e-300) / np.maximum(np.diag(usual), 1e-300))
    scale = np.maximum(larger, 1.0) if np.any(leverage > CARRIES) else np.ones(len(p))
    return usual * np.outer(scale, scale)


def _coefficients(law: type[FrictionLaw], numbers: Mapping[str, float]) -> tuple[Any, ...]:
    """Those of the formula, before the numbers are known to make a law."""
    sheet = object.__new__(law)
    for name, value in numbers.items():
        object.__setattr__(sheet, name, value)
    return sheet.coefficients()

"""Exceptional points, where two modes and their shapes merge, and the split of damping that resists flutter best.

At an exceptional point eigenvalues leave each other like a square root; the square of their distance is analytic there,
and its real and imaginary part vanish together. A damped brake meets that in isolated points of two parameters.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from squealbox.arguments import public
from squealbox.family import Bounds, DesignOrRecipe, Family, Varied
from squealbox.result import Array, Outcome, Result, quantity
from squealbox.stability.family import SteadyFamily
from squealbox.stability.onset import critical_value
from squealbox.stability.state_matrix import spectrum


@dataclass(frozen=True, kw_only=True, eq=False)
class ExceptionalPoints(Result):
    """Points of two parameters at which two modes merge, as :func:`exceptional_points` returns them."""

    x: Array = quantity("point", "", "first parameter, in its own unit")
    y: Array = quantity("point", "", "second parameter, in its own unit")
    eigenvalue: Array = quantity("point", "1/s", "the merged eigenvalue")
    gap: Array = quantity("point", "1/s", "distance of the two eigenvalues that is left")
    parameters: tuple[str, ...] = ()

    def summary(self) -> str:
        """One line for each point."""
        if len(self.x) == 0:
            return self.outcome.told
        a, b = self.parameters
        rows = zip(self.x, self.y, self.eigenvalue, strict=True)
        return "\n".join(f"{a} = {x:.10g}, {b} = {y:.10g}: lambda = {v:.8g} 1/s" for x, y, v in rows)


@public()
def exceptional_points(
    design: DesignOrRecipe, bounds: Mapping[str, Bounds], *, points: int = 41, time: float = 0.0
) -> ExceptionalPoints:
    """Points of two parameters where two modes merge: least distances on a grid, refined by Newton's method.

    Parameters
    ----------
    design : a design, or a function of two floats that returns a design or a system
    bounds : name to (low, high) for two parameters
    points : grid points along each axis
    time : [s] instant at which schedules are taken

    The outcome is "none_found" when nothing converged inside the rectangle. Where modes merge along a whole curve, as
    without damping, points of that curve are returned.
    """
    family = SteadyFamily.within("exceptional_points", design, bounds, count=2, time=time)
    low = np.array([low for low, _ in family.spans])
    width = np.array([high for _, high in family.spans]) - low
    x, y = np.meshgrid(np.linspace(0.0, 1.0, points), np.linspace(0.0, 1.0, points), indexing="ij")
    values = spectrum(family.at(low[0] + width[0] * x, low[1] + width[1] * y))
    squares, pairs = _squared_gaps(values)
    found: list[Any] = []
    for k, pair in enumerate(pairs):
        size = np.abs(squares[..., k])
        for i, j in np.argwhere(_local_minima(size)):
            root = _newton(family, low, width, np.array([x[i, j], y[i, j]]), values[i, j][list(pair)])
            if root is not None and all(np.linalg.norm(root[0] - other[0]) > 1e-6 for other in found):
                found.append(root)
    found.sort(key=lambda root: tuple(root[0]))
    where = low + width * np.array([root[0] for root in found]).reshape(-1, 2)
    outcome = Outcome() if found else Outcome("none_found", "no two modes merge inside the rectangle")
    return ExceptionalPoints(
        x=where[:, 0],
        y=where[:, 1],
        eigenvalue=np.array([root[1] for root in found], dtype=complex),
        gap=np.array([root[2] for root in found], dtype=float),
        parameters=family.parameters,
        inputs=family.inputs,
        settings={"bounds": dict(zip(family.parameters, map(list, family.spans), strict=True)), "points": points},
        outcome=outcome,
    )


def _squared_gaps(values: np.ndarray) -> tuple[Any, list[tuple[int, int]]]:
    half = values.shape[-1] // 2
    pairs = [(i, j) for i in range(half) for j in range(i)]
    return np.stack([(values[..., i] - values[..., j]) ** 2 for i, j in pairs], axis=-1), pairs


def _local_minima(size: np.ndarray) -> Any:
    padded = np.pad(np.nan_to_num(size, nan=np.inf), 1, constant_values=np.inf)
    middle = padded[1:-1, 1:-1]
    least = np.isfinite(middle)
    for shift in ((0, 1), (2, 1), (1, 0), (1, 2), (0, 0), (0, 2), (2, 0), (2, 2)):
        least &= middle <= padded[shift[0] : shift[0] + middle.shape[0], shift[1] : shift[1] + middle.shape[1]]
    return least


def _newton(
    family: SteadyFamily, low: np.ndarray, width: np.ndarray, point: np.ndarray, pair: np.ndarray
) -> tuple[Any, complex, float] | None:
    """Newton's method on (lambda_i - lambda_j)^2 = 0 in two real unknowns."""
    step = 1e-5
    shifts = step * np.array([[0.0, 0.0], [1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]])
    centre = complex(np.mean(pair))
    scale = max(abs(centre), 1e-300)
    for _ in range(30):
        values = spectrum(family.at(*(low + width * (point + shifts)).T))
        if not np.all(np.isfinite(values)):
            return None
        near = np.argsort(np.abs(values - centre), axis=-1)[:, :2]
        two = np.take_along_axis(values, near, axis=-1)
        square = (two[:, 0] - two[:, 1]) ** 2
        centre = complex(np.mean(two[0]))
        slopes = np.array([square[1] - square[2], square[3] - square[4]]) / (2.0 * step)
        jacobian = np.array([slopes.real, slopes.imag])
        change, *_ = np.linalg.lstsq(jacobian, np.array([square[0].real, square[0].imag]), rcond=1e-12)
        size = float(np.linalg.norm(change))
        point = point - change * min(1.0, 0.2 / max(size, 1e-300))
        if np.any((point < -0.2) | (point > 1.2)):
            return None
        if size < 1e-12:
            break
    gap = float(np.sqrt(np.abs(square[0])))
    inside = bool(np.all((point >= 0.0) & (point <= 1.0)))
    return (point, centre, gap) if inside and gap < 1e-4 * scale else None


@dataclass(frozen=True, kw_only=True, eq=False)
class DampingSplit(Result):
    """Critical value against how a fixed sum of two dampings is split, as :func:`damping_split` returns it."""

    share: Array = quantity("split", "1", "share of the first damper in the sum")
    critical: Array = quantity("split", "", "critical value of the parameter, in its own unit; NaN without onset")
    best_share: Any = quantity("", "1", "share with the highest critical value")
    best: Any = quantity("", "", "highest critical value")
    undamped: Any = quantity("", "", "critical value without either damper")
    parameter: str = ""
    dampers: tuple[str, ...] = ()

    coordinates: ClassVar = {"split": "share"}

    def summary(self) -> str:
        """The best split, and how low the critical value can fall by damping wrongly."""
        worst = float(np.nanmin(self.critical))
        lines = [f"best split: {float(self.best_share):.4g} of the sum on {self.dampers[0]}"]
        lines[0] += f", critical {self.parameter} = {float(self.best):.8g} (undamped {float(self.undamped):.8g})"
        if worst < float(self.undamped):
            lines.append(f"damping destabilises: the worst split lowers it to {worst:.8g}")
        return "\n".join(lines)


def damping_split(
    design: Any,
    dampers: tuple[str, str],
    total: float,
    parameter: Varied,
    bounds: Bounds | None = None,
    *,
    splits: int = 21,
) -> DampingSplit:
    """How a fixed sum of damping is best split between two dampers, for the highest critical value of `parameter`.

    Parameters
    ----------
    design : a design
    dampers : names of two dampings, in one unit
    total : [SI] their sum, in that unit
    parameter, bounds : [SI] as for `critical_value`
    splits : shares tried between 0.02 and 0.98, between which the best is refined

    Damping one degree of freedom more than the other can lower the onset below that without damping: the result shows
    it.
    """
    from scipy.optimize import minimize_scalar

    family = Family.within("damping_split", design, parameter, bounds)

    def critical(share: float) -> float:
        damped = design.replace({dampers[0]: share * total, dampers[1]: (1.0 - share) * total})
        return float(critical_value(damped, family.name, family.spans[0], points=101).value)

    shares = np.linspace(0.02, 0.98, splits)
    values = np.array([critical(float(share)) for share in shares])
    if not np.any(np.isfinite(values)):
        nothing: dict[str, Any] = {"share": shares, "critical": values, "best_share": np.nan, "best": np.nan}
        outcome = Outcome("no_onset", "no split has an onset in the range")
        return DampingSplit(**nothing, undamped=np.nan, parameter=family.name, dampers=dampers, outcome=outcome)
    i = int(np.nanargmax(values))
    ends = (float(shares[max(i - 1, 0)]), float(shares[min(i + 1, splits - 1)]))
    fine = minimize_scalar(lambda share: -critical(share), bounds=ends, method="bounded", options={"xatol": 1e-7})
    better = -float(fine.fun) > values[i]
    bare = design.replace({dampers[0]: 0.0, dampers[1]: 0.0})
    return DampingSplit(
        share=shares,
        critical=values,
        best_share=float(fine.x) if better else float(shares[i]),
        best=-float(fine.fun) if better else float(values[i]),
        undamped=float(critical_value(bare, family.name, family.spans[0], points=101).value),
        parameter=family.name,
        dampers=dampers,
        inputs={"system": design},
        settings={"total": total, "bounds": list(family.spans[0]), "splits": splits},
    )

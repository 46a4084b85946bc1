"""The last digits of a critical value, and a bound on what is left: Newton's method on Re lambda(p) = 0.

With P(s) = s^2 M + s C_eff + K_eff at the parameter p, right and left vectors P(lambda) u = 0, w' P(lambda) = 0,

    d lambda        = -w' dP u / (w' P'(lambda) u)                  of any small change dP of the matrices
    |d lambda|     <= ROUND_OFF |w|' (|lambda|^2 |M| + |lambda| |C| + |K|) |u| / |w' P'(lambda) u|
    p              <- p - Re lambda / Re (d lambda / dp)

The residual is summed in extended precision, so an eigenvalue is as good as its matrices are; the bound is what the
round-off in those can do. Source: Tisseur 2000, Linear Algebra and its Applications 309, 339-361.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from squealbox.parameters import ParameterError
from squealbox.stability.family import SteadyFamily

ROUND_OFF = 16.0 * np.finfo(float).eps  # of an entry of K_eff and C_eff: sums over a few contacts and steady sliding
STEPS = 4  # of Newton's method: the root is known to ten digits
NEAR = 1e-6  # share of |lambda| by which a polished eigenvalue may move; more, and it is another one
DIFFERENCE = 1e-5  # share of the range, of the derivative by the parameter


@dataclass(frozen=True)
class Polished:
    """The value, the eigenvalue there, and the bound on the error of the value; infinite where none is known."""

    value: float
    eigenvalue: complex
    uncertainty: float


def polished(family: SteadyFamily, value: float, eigenvalue: complex, low: float, high: float) -> Polished:
    """The crossing at `value` with `eigenvalue`, refined between `low` and `high`."""
    unknown = Polished(value, eigenvalue, np.inf)
    width = high - low
    p, root = value, eigenvalue
    for _ in range(STEPS):
        sides = _sides(family, p, DIFFERENCE * width)
        matrices = sides[1][1]
        if matrices is None:
            return unknown
        found = _refined(matrices, root)
        if found is None or abs(found[0] - root) > NEAR * max(abs(root), _scale(matrices)):
            return unknown
        root, u, w, along, error = found
        rate = _rate(sides, root, u, w, along)
        if rate is None or rate == 0.0:
            return unknown
        step = root.real / rate
        bound = error / abs(rate)
        if not np.isfinite(step) or not low - width <= p - step <= high + width:
            return unknown
        p -= step
        if abs(step) <= 0.25 * bound or abs(step) <= np.spacing(abs(p)):
            break
    return Polished(float(p), complex(0.0, root.imag), float(bound + abs(step) + 2.0 * np.spacing(abs(p))))


Matrices = tuple[Any, Any, Any]


def _sides(family: SteadyFamily, p: float, step: float) -> list[tuple[float, Matrices | None]]:
    """M, C_eff and K_eff at p and a step to both sides; None where there is no steady sliding."""
    return _at(family, [p - step, p, p + step])


def _at(family: SteadyFamily, places: list[float]) -> list[tuple[float, Matrices | None]]:
    """In one batch, unless one of them is beyond what the parameter may be."""
    try:
        about = family.at(np.array(places))
    except ParameterError:
        return [(places[0], None)] if len(places) == 1 else [_at(family, [x])[0] for x in places]
    whole = [np.broadcast_to(x, (len(places), *x.shape[-2:])) for x in (about.M, about.C, about.K)]
    known = about.equilibrium.exists & np.all([np.all(np.isfinite(x), axis=(-1, -2)) for x in whole], axis=0)
    return [(x, (whole[0][i], whole[1][i], whole[2][i]) if known[i] else None) for i, x in enumerate(places)]


def _scale(matrices: Matrices) -> float:
    """An angular frequency [rad/s] of the system: a root near zero is measured by it."""
    mass, _, stiffness = (float(np.max(np.abs(x), initial=0.0)) for x in matrices)
    return float(np.sqrt(stiffness / mass)) if mass > 0.0 else 0.0


def _sizes(matrices: Matrices, size: float) -> Any:
    """|s|^2 |M| + |s| |C| + |K|, with no entry of K smaller than its diagonal lets expect: sums may have cancelled."""
    mass, damping, stiffness = matrices
    diagonal = np.sqrt(np.abs(np.diag(stiffness)))
    return size**2 * np.abs(mass) + size * np.abs(damping) + np.maximum(np.abs(stiffness), np.outer(diagonal, diagonal))


def _refined(matrices: Matrices, root: complex) -> tuple[complex, Any, Any, complex, float] | None:
    """The eigenvalue near `root`, its right and left vectors, w' P' u, and the bound on its error [1/s]."""
    mass, damping, stiffness = (x.astype(np.clongdouble) for x in matrices)
    s = np.clongdouble(root)
    for _ in range(2):
        sizes = _sizes(matrices, abs(complex(s)))
        rows = 1.0 / np.sqrt(np.maximum(np.max(sizes, axis=1), 1e-300))
        whole = s * s * mass + s * damping + stiffness
        left, _, right = np.linalg.svd(np.asarray(rows[:, None] * whole * rows, dtype=complex))
        u, w = rows * right[-1].conj(), (rows * left[:, -1]).conj()
        wide, tall = w.astype(np.clongdouble), u.astype(np.clongdouble)
        along = wide @ ((2.0 * s * mass + damping) @ tall)
        if along == 0.0:
            return None
        s = s - (wide @ (whole @ tall)) / along
    error = ROUND_OFF * float(np.abs(w) @ sizes @ np.abs(u)) / abs(complex(along))
    return complex(s), u, w, complex(along), error


def _rate(
    sides: list[tuple[float, Matrices | None]], s: complex, u: np.ndarray, w: np.ndarray, along: complex
) -> float | None:
    """d(Re lambda)/dp, from the difference of the matrices on both sides of p, or on one where the other has none."""
    known = [(x, m) for x, m in sides if m is not None]
    if len(known) < 2:
        return None
    (a, before), (b, after) = known[0], known[-1]
    changes = [(y - x) / (b - a) for x, y in zip(before, after, strict=True)]
    whole = s * s * changes[0] + s * changes[1] + changes[2]
    return float((-(w @ whole @ u) / along).real)

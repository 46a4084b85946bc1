"""How eigenvalues answer to every parameter of a design, to first and second order.

With Q = lambda^2 M + lambda C_eff + K_eff, Q u = 0, w^H Q = 0 and w^H (2 lambda M + C_eff) u = 1, the derivatives are

    lambda_p  = -w^H Q_p u
    lambda_pq = -w^H [Q_pq u + (Q_lp lambda_q + Q_lq lambda_p + Q_ll lambda_p lambda_q) u
                      + (Q_p + lambda_p Q_l) u_q + (Q_q + lambda_q Q_l) u_p]

with Q_l = dQ/dlambda, and u_p from the bordered system [[Q, Q_l u], [u^H, 0]]: exact for non-symmetric matrices. The
matrices' own derivatives are central differences of sixth order (a design is an arbitrary function of its parameters),
from one batched call, with one-sided ones at the end of a parameter's range. Near a coalescence no derivative exists;
`near_defective` flags it. Where two modes share an eigenvalue without merging, each parameter parts them in a direction
of its own, so neither has a gradient: `repeated` flags that, and the derivatives are NaN.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from squealbox.arguments import public
from squealbox.fe import ReducedBrake
from squealbox.parameters import DataSheet, Parameter
from squealbox.result import Array, Result, quantity
from squealbox.stability.eigenvalues import NEAR_DEFECTIVE, Mode, complex_modes, modes_of
from squealbox.stability.family import SteadyFamily, steady_sliding
from squealbox.stability.sentences import MERGE
from squealbox.system import DesignOrSystem

CENTRAL = np.arange(-3.0, 4.0)
REPEATED = 1e-9  # distance to the next eigenvalue, as a share of |lambda|, below which the two are one
RELATIVE_STEP = 2e-3  # of a parameter's size: truncation (2e-3)^6 and round-off 1e-16/(2e-3)^2 are both far below 1e-9


@dataclass(frozen=True, kw_only=True, eq=False)
class Sensitivity(Result):
    """Derivatives of one eigenvalue in the parameters of a design, as :func:`sensitivity` returns them."""

    eigenvalue: Any = quantity("", "1/s", "the eigenvalue")
    first: Array = quantity("parameter", "", "d lambda / d p, in 1/s per unit of the parameter")
    second: Array = quantity("parameter other", "", "d2 lambda / dp dq, in 1/s per units of the parameters")
    values: Array = quantity("parameter", "", "the parameters' values")
    condition: Any = quantity("", "1", "condition number of the eigenvalue")
    separation: Any = quantity("", "1/s", "distance to the nearest other eigenvalue")
    parameters: tuple[str, ...] = ()

    table_over: ClassVar = ("parameter",)

    @property
    def repeated(self) -> bool:
        """True where another mode has the same eigenvalue but its own shape, so that no derivative exists."""
        return not self.near_defective and bool(self.separation <= REPEATED * abs(complex(self.eigenvalue)))

    @property
    def near_defective(self) -> bool:
        """True where two modes (nearly) merge, so that the derivatives mean little."""
        return bool(self.condition > NEAR_DEFECTIVE)

    @property
    def relative(self) -> Any:
        """p d(growth rate)/dp [1/s] of each parameter: change of the growth rate per relative change."""
        return self.values * np.real(self.first)

    def ranked(self) -> list[tuple[str, float]]:
        """Parameters with p d(growth rate)/dp [1/s], the strongest first."""
        order = np.argsort(-np.abs(self.relative), kind="stable")
        return [(self.parameters[i], float(self.relative[i])) for i in order]

    def summary(self) -> str:
        """The ranking as a table: change of growth rate and frequency for one per cent more of each parameter."""
        if self.repeated:
            return f"two modes share the eigenvalue {self.eigenvalue:.6g} 1/s: neither has derivatives"
        rows = [f"{'parameter':<20} {'growth rate [1/s]':>18} {'frequency [Hz]':>16}   for +1 %"]
        order = np.argsort(-np.abs(self.relative), kind="stable")
        turn = np.sign(np.imag(self.eigenvalue)) / (2.0 * np.pi)
        for i in order:
            change = 0.01 * self.values[i] * self.first[i]
            rows.append(f"{self.parameters[i]:<20} {change.real:>+18.6g} {turn * change.imag:>+16.6g}")
        rows += [MERGE] * self.near_defective
        return "\n".join(rows)


@public(parameters=None)
def sensitivity(
    design: Any, parameters: Sequence[str] | None = None, mode: int | Mode | None = None, *, time: float = 0.0
) -> Sensitivity:
    """First and second derivatives of an eigenvalue in the parameters of a design.

    Parameters
    ----------
    design : a design without leading axes
    parameters : dotted names; by default every parameter that holds a number
    mode : index in the spectrum, or a `Mode`; by default the most unstable
    time : instant of schedules [s]

    Raises `ValueError` without steady sliding. Accuracy: about 1e-9 of |lambda|/p for smooth designs, less near a
    coalescence (`condition`).
    """
    steady = steady_sliding(design, time)
    if steady.K.ndim > 2:
        raise ValueError(f"leading axes {steady.K.shape[:-2]}: sensitivity() is for one design")
    modes = complex_modes(design, time) if isinstance(design, ReducedBrake) else modes_of(steady)
    chosen = mode if isinstance(mode, Mode) else modes.most_unstable if mode is None else modes.mode(mode)
    names = tuple(parameters) if parameters is not None else free_parameters(design)
    values = np.array([float(design.value_of(name)) for name in names])
    matrices = matrix_derivatives(design, names, time)
    value, u, w = chosen.eigenvalue, chosen.shape, chosen.left
    condition = float(modes.condition[chosen.index])
    separation = float(np.min(np.abs(np.delete(modes.eigenvalues, chosen.index) - value)))
    if condition <= NEAR_DEFECTIVE and separation <= REPEATED * abs(value):
        first, second = np.full(len(names), np.nan + 0j), np.full((len(names), len(names)), np.nan + 0j)
    else:
        first, second = _derivatives(value, u, w, steady.M, steady.C, steady.K, matrices)
    return Sensitivity(
        eigenvalue=complex(value),
        first=first,
        second=second,
        values=values,
        condition=condition,
        separation=separation,
        parameters=names,
        inputs={"system": design, "time": time},
    )


def free_parameters(design: Any) -> tuple[str, ...]:
    """Dotted names of all parameters of a design that hold one number."""
    return tuple(name for name, _, value in design.leaves() if isinstance(value, float))


def matrix_derivatives(design: DesignOrSystem, names: Sequence[str], time: float = 0.0) -> Mapping[str, Any]:
    """First (k, n, n) and second (k, k, n, n) derivatives of M, C_eff and K_eff in k parameters, by differences.

    Returns {"M": (first, second), "C": ..., "K": ...}.
    """
    lines = _Lines(design, names)
    steady = SteadyFamily(design, names, time=time).at(*lines.points.T)
    if not np.all(steady.equilibrium.exists):
        raise ValueError(f"no steady sliding beside the design: {steady.equilibrium.outcome.message}")
    return {name: lines.derivatives(getattr(steady, name)) for name in "MCK"}


class _Lines:
    """Points on a line along each parameter and along each pair, and the differences taken on them."""

    def __init__(self, design: Any, names: Sequence[str]) -> None:
        about = {name: parameter for name, parameter, _ in design.leaves()}
        self.count = len(names)
        centre = np.array([float(design.value_of(name)) for name in names])
        spans = [_span(value, about.get(_leaf(design, name))) for value, name in zip(centre, names, strict=True)]
        self.steps = np.array([step for step, _ in spans])
        self.sides = [side for _, side in spans]
        directions = [(i, i) for i in range(self.count)]
        directions += [(i, j) for i in range(self.count) for j in range(i)]
        self.directions = directions
        rows = [centre + offset[:, None] * way for way, offset in map(self._line, directions)]
        self.points = np.concatenate(rows)

    def _line(self, pair: tuple[int, int]) -> tuple[Any, Any]:
        """Direction in parameter space and the offsets along it that stay in both ranges."""
        i, j = pair
        way = np.zeros(self.count)
        way[i] = self.steps[i]
        turn = -1.0 if self.sides[i] * self.sides[j] < 0 else 1.0
        if i != j:
            way[j] = turn * self.steps[j]
        side = self.sides[i] if self.sides[i] != 0 else turn * self.sides[j]
        return way, CENTRAL if side == 0 else side * np.arange(7.0)

    def derivatives(self, samples: np.ndarray) -> tuple[Any, Any]:
        """First (k, n, n) and second (k, k, n, n) derivatives from the samples at `points`."""
        by_line = np.asarray(samples).reshape(len(self.directions), 7, *samples.shape[1:])
        first = np.empty((self.count, *samples.shape[1:]))
        second = np.empty((self.count, self.count, *samples.shape[1:]))
        for line, (i, j) in zip(by_line, self.directions, strict=True):
            way, offsets = self._line((i, j))
            once, twice = (np.tensordot(_weights(offsets, order), line, axes=1) for order in (1, 2))
            if i == j:
                first[i], second[i, i] = once / self.steps[i], twice / self.steps[i] ** 2
            else:
                own = second[i, i] * self.steps[i] ** 2 + second[j, j] * self.steps[j] ** 2
                second[i, j] = second[j, i] = (twice - own) / (2.0 * way[i] * way[j])
        return first, second


def _derivatives(
    value: complex,
    u: np.ndarray,
    w: np.ndarray,
    mass: np.ndarray,
    damping: np.ndarray,
    stiffness: np.ndarray,
    parts: Mapping[str, Any],
) -> tuple[Any, Any]:
    dynamic = value**2 * mass + value * damping + stiffness
    by_value = 2.0 * value * mass + damping
    (m1, m2), (c1, c2), (k1, k2) = (parts[name] for name in "MCK")
    q1, q2 = value**2 * m1 + value * c1 + k1, value**2 * m2 + value * c2 + k2
    q1_by_value = 2.0 * value * m1 + c1
    left = np.conj(w)
    first = -np.einsum("i,pij,j->p", left, q1, u)
    bordered = np.block([[dynamic, (by_value @ u)[:, None]], [np.conj(u)[None, :], np.zeros((1, 1))]])
    moved = np.linalg.solve(bordered, np.vstack([-(q1 @ u).T, np.zeros((1, len(first)))]))[:-1].T
    slopes = q1 + first[:, None, None] * by_value
    cross = np.einsum("i,pij,qj->pq", left, slopes, moved)
    mixed = np.einsum("i,pij,j->p", left, q1_by_value, u)
    own = left @ (2.0 * mass) @ u
    second = np.einsum("i,pqij,j->pq", left, q2, u) + np.outer(mixed, first) + np.outer(first, mixed)
    return first, -(second + own * np.outer(first, first) + cross + cross.T)


def _span(value: float, about: Parameter | None) -> tuple[float, int]:
    """Step of a parameter and the side its range leaves free: 0 both, 1 upwards, -1 downwards."""
    step = RELATIVE_STEP * abs(value) if value != 0.0 else RELATIVE_STEP
    if about is not None and value - 3.0 * step < about.low:
        return step, 1
    if about is not None and value + 3.0 * step > about.high:
        return step, -1
    return step, 0


def _leaf(design: DataSheet, name: str) -> str:
    """The name of the first field behind an alias."""
    head, dot, rest = name.partition(".")
    return str(design.aliases.get(head, (head,))[0]) + dot + rest


def _weights(offsets: np.ndarray, order: int) -> Any:
    """Weights of the difference formula of that order on the given offsets."""
    powers = np.vander(offsets, increasing=True).T
    wanted = np.zeros(len(offsets))
    wanted[order] = 1.0 if order == 1 else 2.0
    return np.linalg.solve(powers, wanted)

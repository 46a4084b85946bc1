"""A branch by harmonic balance, as continuation sees it: coefficients of the series and omega over the parameter."""

import copy
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from squealbox.limit_cycles.cycles.cycle import Cycle, extremes
from squealbox.limit_cycles.cycles.field import Field
from squealbox.limit_cycles.cycles.harmonic_balance import Balance, Grid, cycle_of
from squealbox.parameters import ParameterError
from squealbox.result import COMPLETED, Outcome
from squealbox.system import System

KEPT = 8  # equations kept between calls at the same values


class HarmonicPath:
    """Residual of harmonic balance over (coefficients but one, omega) and the parameter: a `CyclePath`."""

    has_corners = False

    def __init__(self, make: Callable[[float], System], contact: str, width: float, grid: Grid, span: float) -> None:
        self.make, self.contact, self.width, self.grid, self.span = make, contact, width, grid, span
        self.balances: dict[float, Balance] = {}
        self.column, self.size, self.omega, self.scale = 0, 1.0, 1.0, np.ones(1)

    def begin(self, coefficients: np.ndarray, omega: float, p: float, size: float) -> Any:
        """Unknowns of a start; sets the phase and the scales: `size` [m] and omega."""
        turned, self.column = self.balance(p).turned(self.grid.padded(coefficients))
        self.size, self.omega = size, omega
        self.scale = np.append(np.full(turned.size - 1, size), omega)
        return np.append(np.delete(turned.ravel(), self.column), omega)

    def again(self, make: Callable[[float], System] | None = None) -> "HarmonicPath":
        """The path over the parameter of a family beside this one."""
        other = copy.copy(self)
        other.make, other.balances = make or self.make, {}
        return other

    def through(self, cycle: Cycle, p: float) -> Any:
        """Unknowns of a path through a cycle, whose samples are equidistant."""
        fine = Grid(self.grid.harmonics, len(cycle.t) - 1)
        series = self.grid.series(self.grid.values @ fine.series(cycle.q[:-1]))
        return self.begin(series, 2.0 * np.pi / float(cycle.period), p, float(np.max(cycle.amplitude)))

    def rise(self, x: np.ndarray) -> Any:
        """Direction of growing amplitude at x, for the start beside a Hopf point, in scaled variables with p."""
        coefficients, _ = self.series(x)
        direction = coefficients / self.size
        direction[0] = 0.0
        flat = np.append(np.delete(direction.ravel(), self.column), [0.0, 0.0])
        return flat / np.linalg.norm(flat)

    def balance(self, p: float) -> Balance:
        """The equation at a parameter value."""
        if p not in self.balances:
            self.balances[p] = Balance(Field(self.make(p), self.contact, self.width), self.grid)
            if len(self.balances) > KEPT:
                self.balances.pop(next(iter(self.balances)))
        return self.balances[p]

    def series(self, x: np.ndarray) -> tuple[Any, float]:
        """Coefficients (2H + 1, n) and omega of a point."""
        return np.insert(x[:-1], self.column, 0.0).reshape(len(self.grid.d), -1), float(x[-1])

    def residual(self, x: np.ndarray, p: float) -> Any:
        """R over omega^2 size; NaN, which continuation refuses, where the parameter leaves its range."""
        try:
            self.balance(p)
        except ParameterError:
            return np.full(len(x), np.nan)
        return self.balance(p).residual(*self.series(x))[0].ravel() / (self.omega**2 * self.size)

    def jacobian(self, x: np.ndarray, p: float) -> tuple[Any, Any]:
        """By the unknowns (analytic) and by the parameter (central difference)."""
        coefficients, omega = self.series(x)
        balance = self.balance(p)
        by_q, by_omega = balance.jacobian(coefficients, omega, balance.motion(coefficients, omega))
        by_x = np.column_stack([np.delete(by_q, self.column, axis=1), by_omega]) / (self.omega**2 * self.size)
        step = 1e-6 * self.span
        by_p = (self.residual(x, p + step) - self.residual(x, p - step)) / (2.0 * step)
        return by_x, by_p

    def confirmed(self, values: Sequence[float]) -> bool:
        """Each value has its own equation."""
        return True

    def describe(self, x: np.ndarray, p: float) -> dict[str, Any]:
        """Period, extremes, multipliers and least sliding speed of the cycle at a point."""
        coefficients, omega = self.series(x)
        balance = self.balance(p)
        states = balance.motion(coefficients, omega)
        n = balance.field.size
        closed = np.vstack([states, states[:1]])
        t = np.append(self.grid.tau, 2.0 * np.pi) / omega
        low, high = extremes(t, closed[:, :n], closed[:, n:])
        return {"period": 2.0 * np.pi / omega, "lowest": low, "highest": high, "multipliers": self.multipliers(x, p),
                "least_slip": self.least_slip(x, p), "sticking": self.sticking(x, p), "begin": states[0]}  # fmt: skip

    def multipliers(self, x: np.ndarray, p: float) -> Any:
        """Floquet multipliers of the cycle at a point."""
        steps = max(128, self.grid.samples)
        balance = self.balance(p)
        return balance.field.multipliers(balance.monodromy(*self.series(x), steps))

    def cycle(self, x: np.ndarray, p: float) -> Cycle:
        """The cycle at a point, on a fine grid; its error is the share of the last quarter of harmonics."""
        coefficients, omega = self.series(x)
        balance = self.balance(p)
        settings = {"contact": self.contact, "width": self.width}
        error = balance.tail(coefficients)
        return cycle_of(balance, coefficients, omega, Outcome(COMPLETED), settings, error)

    def sticking(self, x: np.ndarray, p: float) -> float:
        """None: a series does not stick [s]."""
        return 0.0

    def least_slip(self, x: np.ndarray, p: float) -> float:
        """Least sliding speed in the sense of V [m/s], by a parabola through the least of many samples."""
        field = self.balance(p).field
        fine = self.grid.even(16 * self.grid.samples)
        slip = field.contact_state(self.balance(p).motion(*self.series(x), fine))[1] * np.sign(field.V)
        least = np.inf
        for v in slip.T:
            i = int(np.argmin(v))
            a, b, c = v[i - 1], v[i], v[(i + 1) % len(v)]
            bend = a - 2.0 * b + c
            least = min(least, float(b - (c - a) ** 2 / (8.0 * bend) if bend > 0.0 else b))
        return least

"""Harmonic balance: a periodic motion as a Fourier series, its frequency among the unknowns.

q(tau) = a_0 + sum_h a_h cos(h tau) + b_h sin(h tau), tau = omega t. With E the series at N equal instants, E+ its
inverse and D the derivative by tau, the coefficients Q (2H + 1, n) obey

    R(Q, omega) = omega^2 D^2 Q M' + omega D Q C' + Q K' - E+ [f + sum_c d_c F_c(E Q, omega E D Q)] = 0

and one coefficient, b_h = 0 of the largest harmonic, fixes the phase. F is evaluated in time and brought back
(alternating frequency-time; Cameron and Griffin 1989, Journal of Applied Mechanics 56, 149-154). The Jacobian is
analytic, from dF/dN and dF/dv. Stability: Phi' = A(t) Phi over one period, by exponentials of the fourth-order Magnus
series. A series that only has every m-th harmonic goes round m times in its period, and is given once round.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from squealbox.arguments import public
from squealbox.cautions import along
from squealbox.limit_cycles.cycles.cycle import Cycle, extremes
from squealbox.limit_cycles.cycles.field import Field
from squealbox.limit_cycles.cycles.shooting import CONTACTS
from squealbox.limit_cycles.cycles.starting import first_guess
from squealbox.limit_cycles.cycles.variation import fly, magnus
from squealbox.parameters import ParameterError, known_names
from squealbox.result import COMPLETED, Outcome
from squealbox.start import StartLike
from squealbox.system import DesignOrSystem, as_system

if TYPE_CHECKING:
    from squealbox.transient import Trajectory

LARGEST = 512  # harmonics; beyond this a smoothed cycle is better found by shooting
ABSENT = 1e-9  # of the largest harmonic: Newton's method leaves less than its tolerance
FAILURES = 4  # doublings in a row without convergence after which the search ends
ADVICE = "give a start nearer to the cycle, more harmonics, or a wider smoothing; or use shooting"
STICKS = "a contact reverses or sticks on this cycle: use a smoothed contact, or shooting"
CLOSED = 1e-2  # of its size, by which a motion of one period that is taken for the cycle itself may fail to close
Guess: TypeAlias = "Callable[[Grid], Any]"


@public()
def harmonic_balance(
    design_or_system: DesignOrSystem,
    start: StartLike = None,
    *,
    contact: str = "exact",
    width: float = 1e-3,
    harmonics: int | None = None,
    samples: int | None = None,
    tolerance: float = 1e-6,
    settle: float | None = None,
    most_steps: int = 40,
) -> Cycle:
    """The limit cycle near `start` as a Fourier series; harmonics are doubled until the estimate meets `tolerance`.

    Parameters
    ----------
    design_or_system : a design or a `System`, with constant loads and speeds
    start : as for :func:`shooting`
    contact, width : "exact" takes sgn(v) as it is, right while no contact reverses or sticks (the outcome says when
        one does); "smooth" = "arctan" or "tanh" with `width` [m/s] for all other cycles
    harmonics : H; None doubles from 8 until the change by the last doubling is below `tolerance`
    samples : N, a power of two; None takes the first one of at least 8 H + 8
    tolerance : of the estimate, relative to the size of the motion [-]
    settle : [s] of the run before

    Returns
    -------
    Cycle; `settings` holds harmonics and samples. Outcome "completed", "no_convergence" (evidence: history, advice),
    "too_few_harmonics", "sticking" (exact contact on a cycle that reverses), "steady_sliding" or "no_cycle".

    Accuracy: `error` is the largest of the change of the motion and of the frequency when harmonics were doubled last,
    an estimate for the coarser of the two. For a fixed `harmonics` it is the share of the last quarter of harmonics.

    >>> from squealbox import DrumBrake, LinearSlope
    >>> harmonic_balance(DrumBrake(friction=LinearSlope(0.45, -0.05)), contact="smooth", width=0.05).stable
    True
    """
    if contact not in CONTACTS:
        raise ParameterError("harmonic_balance", "contact", contact, known_names(str(contact), list(CONTACTS)))
    field = Field(as_system(design_or_system), CONTACTS[contact], width)
    x, period, found = first_guess(field, start, settle)
    settings = {"contact": contact, "width": width, "tolerance": tolerance}
    grid = Grid(harmonics or 8, samples)
    balance = Balance(field, grid)
    guess, found = _guess(field, x, period, found)
    if not found.ok:
        return cycle_of(balance, guess(grid), 2.0 * np.pi / period, found, settings, np.nan)

    def solved(guess: Guess, period: float) -> tuple[Any, ...]:
        if harmonics is None:
            return _refined(balance, guess, period, tolerance, most_steps)
        coefficients, omega, outcome = balance.solve(guess(grid), 2.0 * np.pi / period, most_steps)
        return balance, coefficients, omega, outcome, balance.tail(coefficients)

    done = solved(guess, period)
    rounds = rounds_of(done[1]) if done[3].ok else 1
    if rounds > 1:
        once = once_round(done[1], rounds)
        done = solved(lambda grid: grid.padded(once), 2.0 * np.pi / (rounds * done[2]))
    return cycle_of(done[0], done[1], done[2], done[3], settings, done[4])


def rounds_of(coefficients: np.ndarray) -> int:
    """How often the motion of a series goes round in its period: the common divisor of the harmonics it has."""
    sizes = np.linalg.norm(coefficients[1:].reshape(-1, 2 * coefficients.shape[1]), axis=1)
    return int(np.gcd.reduce(1 + np.flatnonzero(sizes > ABSENT * np.max(sizes)))) or 1


def once_round(coefficients: np.ndarray, rounds: int) -> Any:
    """The series of one of the rounds."""
    pairs = coefficients[1:].reshape(-1, 2, coefficients.shape[1])[rounds - 1 :: rounds]
    return np.concatenate([coefficients[:1], pairs.reshape(-1, coefficients.shape[1])])


def _guess(field: Field, x: np.ndarray, period: float, found: Outcome) -> tuple[Guess, Outcome]:
    """The series, on any grid, of the motion from x over a period; of rest at x where there is none, and then why."""
    run = fly(field, x, period, 1e-9) if found.ok else None
    if run is None or not run.outcome.ok:
        if run is not None:
            message = f"the first period ended early: {run.outcome.message}"
            found = Outcome("no_convergence", message, history=[], advice=ADVICE)
    elif field.contact == "exact" and _closes(run) and _reverses(field, run.mode):
        found = Outcome("sticking", STICKS, history=[], advice=ADVICE)
    if run is None or not found.ok:
        return lambda grid: grid.series(np.tile(x[: field.size], (grid.samples, 1))), found

    def along(grid: Grid) -> Any:
        return grid.series(fly(field, x, period, 1e-9, np.linspace(0.0, period, grid.samples + 1)).q[: grid.samples])

    return along, found


def _closes(run: "Trajectory") -> bool:
    """Whether a motion of one period is the cycle, to what a first guess knows."""
    return bool(np.all(np.abs(run.q[-1] - run.q[0]) <= CLOSED * max(float(np.max(np.ptp(run.q, axis=0))), 1e-300)))


def _reverses(field: Field, modes: np.ndarray) -> bool:
    """Whether a contact sticks, or slips against its belt, in any of the modes (k, m)."""
    return bool(np.any((modes == 0) | (modes == np.where(field.V >= 0.0, -1, 1))))


def _refined(balance: "Balance", guess: Guess, period: float, tolerance: float, most: int) -> tuple[Any, ...]:
    """Double the harmonics until the motion changes by less than `tolerance` of its size."""
    coefficients, omega, outcome = balance.solve(guess(balance.grid), 2.0 * np.pi / period, most)
    error, failures = np.inf, 0 if outcome.ok else 1
    while 2 * balance.grid.harmonics <= LARGEST and error > tolerance and failures < FAILURES:
        coarse = outcome
        finer = Balance(balance.field, Grid(2 * balance.grid.harmonics))
        begin = finer.grid.padded(coefficients) if coarse.ok else guess(finer.grid)
        phase = omega if coarse.ok else 2.0 * np.pi / period
        coefficients, omega, outcome = finer.solve(begin, phase, most)
        failures = 0 if outcome.ok else failures + 1
        if outcome.ok and coarse.ok:  # what did not converge tells no error
            change = np.max(np.linalg.norm(coefficients - begin, axis=0))
            size = np.max(np.linalg.norm(coefficients[1:], axis=0)) or 1.0
            error = max(float(change / size), abs(omega / phase - 1.0))
        balance = finer
    if outcome.ok and error > tolerance:
        message = f"{balance.grid.harmonics} harmonics leave an estimated error of {error:.2g}: {ADVICE}"
        outcome = Outcome("too_few_harmonics", message, error=error, advice=ADVICE)
    return balance, coefficients, omega, outcome, error


class Grid:
    """Fourier series of H harmonics on N instants: E (N, 2H + 1), its inverse, and d/dtau (2H + 1, 2H + 1)."""

    def __init__(self, harmonics: int, samples: int | None = None) -> None:
        if harmonics < 1:
            raise ParameterError("harmonic_balance", "harmonics", harmonics, "a whole number of at least 1")
        least = 2 ** int(np.ceil(np.log2(8 * harmonics + 8)))
        self.harmonics, self.samples = harmonics, samples or least
        if self.samples < 2 * harmonics + 1:
            raise ParameterError("harmonic_balance", "samples", samples, f"at least {2 * harmonics + 1}")
        tau = 2.0 * np.pi * np.arange(self.samples) / self.samples
        self.tau, h = tau, np.arange(1, harmonics + 1)
        self.values = self.at(tau)
        self.inverse = self.values.T * (2.0 / self.samples)
        self.inverse[0] *= 0.5
        self.d = np.zeros((2 * harmonics + 1,) * 2)
        self.d[2 * h - 1, 2 * h], self.d[2 * h, 2 * h - 1] = h, -h
        self.slopes = self.values @ self.d
        self._kept: dict[tuple[int, float], tuple[Any, Any]] = {}

    def even(self, count: int, offset: float = 0.0) -> tuple[Any, Any]:
        """E and E D at `count` equal instants from `offset` of a step on; kept, as a walk asks for them often."""
        if (count, offset) not in self._kept:
            values = self.at(2.0 * np.pi * (np.arange(count) + offset) / count)
            self._kept[count, offset] = values, values @ self.d
        return self._kept[count, offset]

    def at(self, tau: np.ndarray) -> Any:
        """E at the phases tau: columns 1, cos tau, sin tau, cos 2 tau, ..."""
        angles = np.multiply.outer(tau, np.arange(1, self.harmonics + 1))
        both = np.stack([np.cos(angles), np.sin(angles)], axis=-1).reshape(len(tau), -1)
        return np.hstack([np.ones((len(tau), 1)), both])

    def series(self, samples: np.ndarray) -> Any:
        """Coefficients (2H + 1, n) of values (N, n)."""
        return self.inverse @ samples

    def padded(self, coefficients: np.ndarray) -> Any:
        """Coefficients of fewer harmonics, with zeros for the rest; of more harmonics, cut."""
        out = np.zeros((2 * self.harmonics + 1, coefficients.shape[1]))
        rows = min(len(out), len(coefficients))
        out[:rows] = coefficients[:rows]
        return out

    def shifted(self, coefficients: np.ndarray, phase: float) -> Any:
        """Coefficients of the same motion begun `phase` later."""
        return self.inverse @ (self.at(self.tau + phase) @ coefficients)


@dataclass(frozen=True, eq=False)
class Balance:
    """The residual of one field on one grid, and Newton's method for it."""

    field: Field
    grid: Grid

    def motion(self, coefficients: np.ndarray, omega: float, at: tuple[Any, Any] | None = None) -> Any:
        """States x (N, 2n) at the instants of the grid, or where E and E D are given."""
        values, slopes = (self.grid.values, self.grid.slopes) if at is None else at
        return np.hstack([values @ coefficients, omega * (slopes @ coefficients)])

    def modes(self, states: np.ndarray) -> Any:
        """Sense of slip of each contact: that of V, so a series that passes a reversal still has a smooth residual."""
        return np.broadcast_to(np.where(self.field.V >= 0.0, 1, -1), (*states.shape[:-1], len(self.field.V)))

    def residual(self, coefficients: np.ndarray, omega: float) -> tuple[Any, Any]:
        """R (2H + 1, n) over the mass [m/s^2], and the states behind it."""
        field, grid = self.field, self.grid
        states = self.motion(coefficients, omega)
        force, _, _, opened = field.forces(states, self.modes(states))
        push = force @ field.md + field.mf
        if np.any(opened):
            push = push + (field.contact_state(states)[0] * opened) @ field.mw
        slope = omega * (grid.d @ coefficients)
        inertia = omega * (grid.d @ slope)
        return inertia + slope @ field.mc.T + coefficients @ field.mk.T - grid.inverse @ push, states

    def jacobian(self, coefficients: np.ndarray, omega: float, states: np.ndarray) -> tuple[Any, Any]:
        """dR/dQ as (size, size) with Q raveled by rows, and dR/domega (size,)."""
        field, grid = self.field, self.grid
        d, rows, n = grid.d, len(grid.d), field.size
        eye = np.eye(rows)
        mass = omega**2 * (d @ d)
        total = np.einsum("ab,ij->aibj", mass, np.eye(n)) + np.einsum("ab,ij->aibj", omega * d, field.mc)
        total += np.einsum("ab,ij->aibj", eye, field.mk)
        by_omega = 2.0 * omega * (d @ d @ coefficients) + d @ coefficients @ field.mc.T
        _, by_normal, by_speed, opened = field.forces(states, self.modes(states))
        qd_by_omega = states[:, n:] / omega
        for c in range(len(field.laws)):
            normal_part = grid.inverse @ (by_normal[:, c, None] * grid.values)
            speed_part = grid.inverse @ (by_speed[:, c, None] * grid.slopes)
            total -= np.einsum("ab,ij->aibj", normal_part, np.outer(field.md[c], field.n[c]))
            total += np.einsum("ab,ij->aibj", omega * speed_part, np.outer(field.md[c], field.t[c]))
            by_omega += np.outer(grid.inverse @ (by_speed[:, c] * (qd_by_omega @ field.t[c])), field.md[c])
            if np.any(opened[:, c]):
                part = grid.inverse @ (opened[:, c, None] * grid.values)
                total -= np.einsum("ab,ij->aibj", part, np.outer(field.mw[c], field.n[c]))
        return total.reshape(rows * n, rows * n), by_omega.ravel()

    def solve(self, guess: np.ndarray, omega: float, most: int = 40) -> tuple[Any, float, Outcome]:
        """Newton with halved steps; the phase is turned so that b_h of the largest harmonic is zero."""
        coefficients, column = self.turned(guess)
        history: list[float] = []
        scale = omega**2 * max(float(np.max(np.linalg.norm(coefficients[1:], axis=0))), 1e-300)
        value, states = self.residual(coefficients, omega)
        for _ in range(most):
            norm = float(np.linalg.norm(value)) / scale
            history.append(norm)
            by_q, by_omega = self.jacobian(coefficients, omega, states)
            matrix = np.column_stack([np.delete(by_q, column, axis=1), by_omega * omega])
            try:
                step = np.linalg.solve(matrix, -value.ravel())
            except np.linalg.LinAlgError:
                break
            change = np.insert(step[:-1], column, 0.0).reshape(coefficients.shape)
            share = min(1.0, 0.2 / max(abs(step[-1]), 1e-300))
            for _ in range(8):
                trial = coefficients + share * change, omega * (1.0 + share * step[-1])
                new, new_states = self.residual(*trial)
                if np.linalg.norm(new) / scale < norm:
                    break
                share *= 0.5
            else:
                break
            coefficients, omega, value, states = *trial, new, new_states
        norm = float(np.linalg.norm(value)) / scale
        return coefficients, float(omega), self._judged(norm, history, coefficients, omega, states)

    def _judged(
        self, norm: float, history: list[float], coefficients: np.ndarray, omega: float, states: np.ndarray
    ) -> Outcome:
        if not norm < 1e-9:
            message = f"Newton's method stopped at a relative residual of {norm:.3g}: {ADVICE}"
            return Outcome("no_convergence", message, history=history, advice=ADVICE)
        speed = float(np.max(np.abs(states[:, self.field.size :])))
        if speed <= 1e-9 * (float(np.max(np.abs(self.field.V), initial=0.0)) or 1.0):
            return Outcome("steady_sliding", "the series shrank to steady sliding, not a cycle", history=history)
        reverses = np.any(self.field.contact_state(states)[1] * self.modes(states) < 0.0)
        if self.field.contact == "exact" and reverses:
            return Outcome("sticking", STICKS, history=history, advice=ADVICE)
        return Outcome(COMPLETED, "", history=history)

    def turned(self, coefficients: np.ndarray) -> tuple[Any, int]:
        """The series begun where the largest harmonic of any displacement has b_h = 0 < a_h; the place of that b_h."""
        a, b = coefficients[1::2], coefficients[2::2]
        h, dof = np.unravel_index(int(np.argmax(np.hypot(a, b))), a.shape)
        turned = self.grid.shifted(coefficients, float(np.arctan2(b[h, dof], a[h, dof])) / (int(h) + 1))
        turned[2 * h + 2, dof] = 0.0
        return turned, int((2 * h + 2) * coefficients.shape[1] + dof)

    def tail(self, coefficients: np.ndarray) -> float:
        """Share of the last quarter of harmonics in the motion [-]."""
        rows = max(2, 2 * (self.grid.harmonics // 4))
        return float(np.max(np.linalg.norm(coefficients[-rows:], axis=0) / np.linalg.norm(coefficients[1:])))

    def monodromy(self, coefficients: np.ndarray, omega: float, steps: int | None = None) -> Any:
        """Phi over one period by fourth-order Magnus exponentials at two Gauss points of each step, shape (2n, 2n)."""
        steps = steps or max(256, self.grid.samples)
        h, beside = 2.0 * np.pi / steps, float(np.sqrt(3.0) / 6.0)
        early, late = (self.motion(coefficients, omega, self.grid.even(steps, 0.5 + s * beside)) for s in (-1.0, 1.0))
        a, b = (self.field.jacobians(x, self.modes(x)) for x in (early, late))
        return magnus(a, b, h / omega, self.field.scale)


def cycle_of(
    balance: Balance, coefficients: np.ndarray, omega: float, outcome: Outcome, settings: dict[str, Any], error: float
) -> Cycle:
    """The cycle behind a series, on a fine grid."""
    field, grid = balance.field, balance.grid
    tau = np.linspace(0.0, 2.0 * np.pi, max(513, 2 * grid.samples + 1))
    values = grid.at(tau)
    states = balance.motion(coefficients, omega, (values, values @ grid.d))
    t, n = tau / omega, field.size
    low, high = extremes(t, states[:, :n], states[:, n:])
    monodromy = balance.monodromy(coefficients, omega) if outcome.ok else np.full((2 * n, 2 * n), np.nan)
    multipliers = field.multipliers(monodromy)
    none = np.zeros(0)
    settings = {**settings, "harmonics": grid.harmonics, "samples": grid.samples}
    return Cycle(
        inputs={"system": field.system}, settings=settings, outcome=outcome, period=np.asarray(2.0 * np.pi / omega),
        t=t, q=states[:, :n], qd=states[:, n:], sliding_velocity=field.contact_state(states)[1],
        mode=balance.modes(states).astype(np.int8), multipliers=multipliers, lowest=low, highest=high,
        event_time=none, event_contact=none.astype(np.int64), event_mode=none.astype(np.int8), error=float(error),
        caution="; ".join(along(field.system, states[:, :n], states[:, n:])) if outcome.ok else "",
    )  # fmt: skip

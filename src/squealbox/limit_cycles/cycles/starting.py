"""A first guess of a cycle: a state on it and its period, from a long run or from what the caller knows."""

from typing import Any

import numpy as np

from squealbox.limit_cycles.cycles.cycle import Cycle
from squealbox.limit_cycles.cycles.field import Autonomous
from squealbox.limit_cycles.cycles.variation import PERIOD_STEPS, fly
from squealbox.result import COMPLETED, Outcome
from squealbox.stability import Mode, complex_modes
from squealbox.start import Start, StartLike
from squealbox.system import equilibrium
from squealbox.transient import Trajectory, simulate

PERIODS = 300.0  # of the lowest mode, of a run that is to settle
GUESS_RTOL = 1e-9
UNBOUNDED = 1e100  # [m, m/s]; squares of what is below it are still numbers
LONG_STEPS = 2_000_000  # of the run that is to settle
KEPT = 10_000_000  # rows times freedoms and contacts of one in which a return is looked for, some 0.4 GB
LINGERS = 5.0  # periods of the slowest mode, after which rows of a delay hold what is under way
STIFF = "one period of the slowest mode takes too many steps: damping, or what is held, is far faster than it"
DYING = 0.05  # share of the sliding speed; a swing below it that falls goes on falling where sliding is stable
FALLS = 0.98  # by which a swing falls at least over two thirds of a run that dies down
VISIBLE = 0.5  # share of the sliding speed by which it swings in a mode to begin with
STILL = 1e-5  # share of the sliding speed; a run that swings less has settled on steady sliding


def first_guess(field: Autonomous, start: Any, settle: float | None) -> tuple[Any, float, Outcome]:
    """State x (2n,), period [s] and outcome, from `start`.

    start : None (the most unstable mode, or rest), or any `Start`; (q, qd, period) and a `Cycle` are taken as they are
    settle : [s] of the run before a return is looked for; None takes 300 periods of the slowest mode
    """
    if isinstance(start, Cycle):
        return field.state(start.q[0], start.qd[0], start.memory), float(start.period), Outcome(COMPLETED)
    if isinstance(start, (tuple, list)) and len(start) == 3 and np.ndim(start[2]) == 0:  # else deflections
        return _under_way(field, state_of(field, start[:2]), float(start[2]))
    x = state_of(field, start)
    slowest = _slowest_period(field)
    duration = PERIODS * slowest if settle is None else settle
    if field.late and duration > 0.0:
        return _settled_under_a_delay(field, x, duration, slowest)
    if duration > slowest:  # where the first of its periods is out of reach, all are
        run = fly(field, x, slowest, GUESS_RTOL, np.array([slowest]))
        if run.outcome == "step_limit":
            return x, slowest, Outcome("no_cycle", f"{STIFF}: {run.outcome.message}", **run.outcome.evidence)
    if duration > 0.0:
        run = fly(field, x, duration, GUESS_RTOL, np.array([duration]), most=LONG_STEPS)
        if not run.outcome.ok:
            return x, slowest, Outcome("no_cycle", f"the first run ended early: {run.outcome.message}")
        x = np.concatenate([run.q[-1], run.qd[-1]])
    return first_return(field, x, slowest)


def _settled_under_a_delay(
    field: Autonomous, x: np.ndarray, duration: float, slowest: float
) -> tuple[Any, float, Outcome]:
    """As `first_guess`: a long run under the delay itself, and a short one with its rows, which make steps tiny."""
    n, size = field.system.size, field.size
    start = x[:n], x[size : size + n]
    run = simulate(field.asked, duration, start, [0.0, duration], contact=field.contact, width=field.width)
    if not run.outcome.ok:
        return x, slowest, Outcome("no_cycle", f"the first run ended early: {run.outcome.message}")
    x, _, outcome = _under_way(field, field.state(run.q[-1, :n], run.qd[-1, :n]), LINGERS * slowest)
    return first_return(field, x, slowest) if outcome.ok else (x, slowest, outcome)


def _under_way(field: Autonomous, x: np.ndarray, period: float) -> tuple[Any, float, Outcome]:
    """A known start, with what is then under way in delays, as a period of the motion from it leaves that."""
    if field.late:
        run = fly(field, x, period, GUESS_RTOL)
        if not run.outcome.ok:
            return x, period, Outcome("no_cycle", f"the first period ended early: {run.outcome.message}")
        n = field.system.size
        x = field.state(x[:n], x[field.size : field.size + n], run.q[-1, n:])
    return x, period, Outcome(COMPLETED)


def first_return(field: Autonomous, x: np.ndarray, period: float) -> tuple[Any, float, Outcome]:
    """A state in fast slip on the motion from x, and the time after which the motion comes back to it."""
    run = fly(field, x, 12.0 * period, GUESS_RTOL, most=12 * PERIOD_STEPS)
    if run.outcome.ok and _inside_a_stick(run):  # the belt is slow: look for as long as contacts may stick
        window = 12.0 * (period + _longest_stick(field))
        run = fly(field, x, window, GUESS_RTOL, most=min(LONG_STEPS, KEPT // (field.size + len(field.V))))
    if not run.outcome.ok:
        return x, period, Outcome("no_cycle", f"the search for a return ended early: {run.outcome.message}")
    states = np.hstack([run.q, run.qd])
    if np.max(np.abs(states)) > UNBOUNDED:
        return x, period, Outcome("no_cycle", "the motion grows without bound: no cycle in sight")
    size = np.ptp(states, axis=0)
    size = np.where(size > 0.0, size, 1.0)
    fastest = max(float(np.max(np.abs(field.V), initial=0.0)), 1e-300)
    if not np.any(run.mode == 0) and np.max(np.ptp(run.qd, axis=0)) <= STILL * fastest:
        return x, period, Outcome("steady_sliding", "the run settles on steady sliding, not on a cycle")
    if (swing := _dying(field, run) / fastest) < DYING:
        message = (
            f"the run dies down to steady sliding: it swings by {100.0 * swing:.2g} % of the sliding speed, and falls"
        )
        return x, period, Outcome("steady_sliding", message)
    begin = _fast_slip(run)
    section = np.concatenate([run.qd[begin], np.diff(run.qd[begin : begin + 2], axis=0)[0]]) / size**2
    beside = (states - states[begin]) @ section
    crossing = [i for i in range(begin + 1, len(beside) - 1) if beside[i] < 0.0 <= beside[i + 1]]
    best, found = np.inf, period
    for i in crossing:
        share = -beside[i] / (beside[i + 1] - beside[i])
        away = float(np.max(np.abs(((1.0 - share) * states[i] + share * states[i + 1] - states[begin]) / size)))
        if away < 0.5 * best:
            best, found = away, float(run.t[i] + share * (run.t[i + 1] - run.t[i]) - run.t[begin])
        if best < 0.02:
            break
    if not crossing:
        return x, period, Outcome("no_cycle", "the motion does not return: a longer `settle` may help")
    return states[begin], found, Outcome(COMPLETED)


def _dying(field: Autonomous, run: Trajectory) -> float:
    """Swing [m/s] at the end of a run that slides all along, swings less and less, and whose sliding is stable."""
    if np.any(run.mode != run.mode[0]) or np.any(run.mode == 0):
        return np.inf
    early, late = (float(np.max(np.ptp(part, axis=0))) for part in np.array_split(run.qd, 3)[::2])
    stable = late < FALLS * early and bool(np.all(complex_modes(field.asked).stable))
    return late if stable else np.inf


def _inside_a_stick(run: Trajectory) -> bool:
    """Whether a contact sticks in the run without having let go at least twice: its stick may outlast the run."""
    return any(
        bool(np.any(sticks)) and int(np.count_nonzero(sticks[:-1] & ~sticks[1:])) < 2 for sticks in (run.mode == 0).T
    )


def _longest_stick(field: Autonomous) -> float:
    """Estimate of the longest stick [s]: the spring's force runs through twice the static limit, 2 mu N / (k V)."""
    inverse = np.linalg.pinv(field.held_fast.K)
    normal = np.abs(field.N0)
    state = equilibrium(field.asked)
    if np.all(state.exists):
        normal = np.maximum(normal, np.abs(state.normal_force))
    soft = np.abs(np.einsum("ci,ij,cj->c", field.t, inverse, field.d))
    with np.errstate(divide="ignore", invalid="ignore"):
        times = 2.0 * field.static * normal * soft / np.abs(field.V)
    times = times[np.isfinite(times)]
    return float(np.max(times, initial=0.0))


def _fast_slip(run: Trajectory) -> int:
    """The row, in the first half, at which the slowest contact slips fastest."""
    half = max(2, len(run.t) // 2)
    if run.sliding_velocity.shape[1] == 0:
        return 0
    return int(np.argmax(np.min(np.abs(run.sliding_velocity[:half]), axis=1)))


def state_of(field: Autonomous, start: StartLike) -> Any:
    """The state (q, qd) in one row, (2n,), that a `Start` means; None is near the mode that grows fastest, or rest."""
    if start is None:
        modes = complex_modes(field.asked)
        start = modes.most_unstable if np.any(modes.exists & np.isfinite(modes.eigenvalues[..., 0])) else "rest"
        if isinstance(start, Mode) and start.growth_rate <= 0.0:
            start = "rest"
    begin = Start.of("", start, field.system, modes_of=field.asked, share=VISIBLE)
    return field.state(begin.q, begin.qd, begin.z)


def _slowest_period(field: Autonomous) -> float:
    modes = complex_modes(field.asked)
    rates = np.abs(np.imag(modes.eigenvalues)) if np.any(modes.exists) else field.own_modes()[0]
    moving = rates[rates > 1e-9 * field.frequency]
    return 2.0 * np.pi / float(np.min(moving)) if moving.size else 2.0 * np.pi / (field.frequency or 1.0)


def steady_state(field: Autonomous) -> Any:
    """Steady sliding (q, q') (2n,), or NaN where there is none."""
    state, n = field.sliding(), field.system.size
    q = state.q if np.all(state.exists) else np.full(n, np.nan)
    return np.concatenate([q, np.zeros(n)])

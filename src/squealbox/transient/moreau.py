"""Time stepping after Moreau: a fixed step, set-valued friction, any number of contacts."""

from typing import Any, NamedTuple

import numpy as np

from squealbox.parameters import ParameterError
from squealbox.power import power_dissipated, power_of_circulation, power_of_load
from squealbox.result import COMPLETED, Outcome
from squealbox.schedules import value_at
from squealbox.system import InvalidSystem, System
from squealbox.transient import packing
from squealbox.transient.methods import Method
from squealbox.transient.own_laws import own_texts
from squealbox.transient.trajectory import OPEN, Trajectory

SWEEPS = 2000
TOLERANCE = 1e-12  # change of an impulse over its limit at which the sweeps end


class Stepping(NamedTuple):
    """The sparse rows a step works on; x_start, x_column, x_value are compressed rows of x."""

    mk_start: Any
    mk_column: Any
    mk_value: Any
    mc_start: Any
    mc_column: Any
    mc_value: Any
    n_start: Any
    n_column: Any
    n_value: Any
    t_start: Any
    t_column: Any
    t_value: Any
    d_start: Any
    d_column: Any
    d_value: Any
    md_start: Any
    md_column: Any
    md_value: Any
    mw_start: Any
    mw_column: Any
    mw_value: Any
    a_start: Any
    a_column: Any
    a_value: Any
    ma_start: Any
    ma_column: Any
    ma_value: Any
    mobility: Any
    hold: Any
    reach: Any
    unilateral: Any
    static: Any
    law_kind: Any
    law_coefficients: Any
    signal_start: Any
    term_weight: Any
    term_kind: Any
    term_coefficients: Any
    q_mid: Any
    u_new: Any
    limit: Any
    impulse: Any
    side: Any


def time_stepping(
    system: System,
    duration: float,
    q: np.ndarray,
    qd: np.ndarray,
    start_time: float,
    times: np.ndarray | None,
    step: float | None,
) -> Trajectory:
    """March with a fixed step; the trajectory holds every step, or the requested `times` interpolated between steps.

    The error is of first order in the step while contacts stick and slip. The outcome is "completed", "not_finite", or
    "no_convergence" when the impulses of some step did not settle, with the remaining change as evidence.
    Raises `ParameterError` for a step that the explicit treatment of K cannot bear.
    """
    from squealbox.transient._engine import time_stepping_kernel

    problem = packing.pack(system, Method(), 0, 1.0, True)
    if any(contact.law.grip_formula is not None for contact in system.contacts):
        raise InvalidSystem('a law has memory, or a loop a limit: time stepping knows neither; take contact="exact"')
    if problem["light"]:
        raise InvalidSystem('a row has no mass: time stepping solves for velocities; take contact="exact"')
    period = 1e3 * float(problem["window"])
    highest = packing.highest_frequency(problem["mk"])
    longest = 2.0 / highest if highest > 0.0 else np.inf
    h = min(period, duration) / 400.0 if step is None else step
    if not 0.0 < h < longest:
        raise ParameterError("simulate", "step", step, f"a step in (0, {longest:.3g}) s, below 2/omega_max")
    steps = int(np.ceil(duration / h * (1.0 - 1e-12)))
    h = duration / steps
    n, m = system.size, len(system.contacts)
    rows = np.zeros((steps + 1, 1 + 2 * n + 4 * m))
    z = _stepping(system, problem)
    z.limit[_at_rest(system, qd, start_time)] = np.inf  # as if each had stuck in a step before
    done, sweeps, change = time_stepping_kernel(own=own_texts(system.contacts))(
        z, q.copy(), qd.copy(), start_time, h, steps, SWEEPS, TOLERANCE, rows, np.zeros(m)
    )
    outcome = _outcome(done, steps, h, sweeps, change)
    settings = {
        "duration": duration, "start": [q.tolist(), qd.tolist()], "start_time": start_time,
        "contact": "time-stepping", "step": h,
    }  # fmt: skip
    return _trajectory(system, rows[: done + 1], times, settings, outcome, int(done), h * z.mobility)


def _stepping(system: System, problem: np.ndarray) -> Stepping:
    from scipy.sparse import csr_array

    n, m = system.size, len(system.contacts)
    fields: dict[str, Any] = {}
    matrices = {"mk": (n, n), "mc": (n, n), "n": (m, n), "t": (m, n), "d": (m, n), "md": (m, n), "mw": (m, n)}
    across = np.zeros((m, n)) if system.across is None else system.across
    ma = across @ packing.inverse_mass(system.M).T
    given = {name: problem[name][:rows, :columns] for name, (rows, columns) in matrices.items()}
    for name, matrix in (given | {"a": across, "ma": ma}).items():
        sparse = csr_array(matrix)
        fields[f"{name}_start"] = sparse.indptr.astype(np.int64)
        fields[f"{name}_column"] = sparse.indices.astype(np.int64)
        fields[f"{name}_value"] = sparse.data.copy()
    mobility = np.diag(problem["g"])[:m].copy()
    if np.any(mobility <= 0.0):
        raise InvalidSystem(
            "time stepping needs t . M^-1 d > 0 for every contact: its friction must act against its slip"
        )
    fields["hold"], fields["reach"] = _mobilities(problem["t"][:m, :n], across, problem["md"][:m, :n], ma)
    for name in ("unilateral", "static", "law_kind", "law_coefficients"):
        fields[name] = problem[name][:m].copy()
    for name in ("signal_start", "term_weight", "term_kind", "term_coefficients"):
        fields[name] = problem[name].copy()
    return Stepping(
        **fields, mobility=mobility, q_mid=np.zeros(n), u_new=np.zeros(n), limit=np.zeros(m), impulse=np.zeros(m),
        side=np.zeros(m),
    )  # fmt: skip


def _at_rest(system: System, qd: np.ndarray, time: float) -> Any:
    """Which contacts have no relative velocity, to round-off, shape (m,)."""
    table = np.array([c.t for c in system.contacts]).reshape(-1, system.size)
    belts = np.array([float(value_at(c.V, time)) for c in system.contacts])
    sizes = np.abs(belts) + np.abs(table) @ np.abs(qd)
    aside = np.zeros(len(belts)) if system.across is None else system.across @ qd
    return np.hypot(belts - table @ qd, aside) <= 1e-12 * sizes


def _mobilities(t: np.ndarray, a: np.ndarray, md: np.ndarray, ma: np.ndarray) -> tuple[Any, Any]:
    """Of contacts in a plane: the inverse of what their velocities gain by their impulses, as rows, and a bound."""
    blocks = np.moveaxis(np.array([[np.sum(x * y, axis=1) for y in (md, ma)] for x in (t, a)]), -1, 0)
    hold, reach = np.zeros((len(t), 4)), np.zeros(len(t))
    for c in np.flatnonzero(np.any(a, axis=1)):
        values = np.linalg.eigvalsh(0.5 * (blocks[c] + blocks[c].T))
        if not values[0] > 0.0:
            raise InvalidSystem(
                f"contacts[{c}]: time stepping needs friction that acts against every direction of its slip"
            )
        hold[c], reach[c] = np.linalg.inv(blocks[c]).ravel(), 1.0 / values[-1]
    return hold, reach


def _outcome(done: int, steps: int, h: float, sweeps: int, change: float) -> Outcome:
    if done < steps:
        return Outcome("not_finite", f"the motion left the range of finite numbers at step {done}", time=done * h)
    if sweeps >= SWEEPS and change > 1e-6:
        message = f"the impulses of a step still changed by {change:.1e} of their limit after {SWEEPS} sweeps"
        return Outcome("no_convergence", message, change=float(change), sweeps=int(sweeps))
    return Outcome(COMPLETED)


def _trajectory(
    system: System,
    rows: np.ndarray,
    times: np.ndarray | None,
    settings: dict[str, Any],
    outcome: Outcome,
    steps: int,
    gains: np.ndarray,
) -> Trajectory:
    """gains (m,): the speed [m/s] that a newton of its friction takes from each contact in a step."""
    n, m = system.size, len(system.contacts)
    t, q, qd, normal, speed, force, work = np.split(rows, np.cumsum([1, n, n, m, m, m]), axis=1)
    instants = t[:, 0]
    opens = np.array([c.unilateral for c in system.contacts], dtype=bool) & (normal <= 0.0)
    normal = np.where(opens, 0.0, normal)
    works = [
        _integral(power_of_load(system, instants, qd), instants),
        _integral(power_of_circulation(system, q, qd), instants),
        _integral(power_dissipated(system, qd), instants),
        _integral(_power_of_opening(system, instants, q, qd), instants),
    ]
    aside = 0.0 if system.across is None else qd @ system.across.T
    slip = np.hypot(speed, aside)
    taken = np.max(np.abs(force) * gains, initial=1e-300)  # where all is at rest, speeds are the round-off of that
    sticking = slip <= 1e-9 * np.maximum(np.max(slip, initial=0.0), taken)
    mode = np.where(opens, OPEN, np.where(sticking, 0, np.where(speed < 0.0, -1, 1))).astype(np.int8)
    changed = np.argwhere(np.diff(mode, axis=0) != 0)
    events = (instants[changed[:, 0] + 1], changed[:, 1], mode[changed[:, 0] + 1, changed[:, 1]])
    columns = [q, qd, normal, speed, force, work, *works]
    if times is not None:
        mode = mode[np.clip(np.searchsorted(instants, times), 0, len(instants) - 1)]
        columns = [_at(times, instants, column) for column in columns]
        columns[0] = _hermite(times, instants, q, qd)
        instants = times
    return Trajectory(
        inputs={"system": system}, settings=settings, outcome=outcome, t=instants, q=columns[0], qd=columns[1],
        normal_force=columns[2], sliding_velocity=columns[3], friction_force=columns[4], mode=mode,
        work_friction=columns[5], work_load=columns[6], work_circulation=columns[7], work_dissipated=columns[8],
        work_opening=columns[9], work_impact=np.zeros(len(instants)),
        event_time=events[0], event_contact=events[1], event_mode=events[2], end_q=q[-1], end_qd=qd[-1],
        steps=steps, rejected=0, evaluations=steps,
    )  # fmt: skip


def _power_of_opening(system: System, times: np.ndarray, q: np.ndarray, qd: np.ndarray) -> Any:
    total = np.zeros(len(q))
    for contact in system.contacts:
        if contact.unilateral:
            normal = value_at(contact.N0, times) + q @ contact.n
            total += np.minimum(normal, 0.0) * (qd @ contact.normal)
    return total


def _integral(power: np.ndarray, t: np.ndarray) -> Any:
    from scipy.integrate import cumulative_trapezoid

    return cumulative_trapezoid(power, t, initial=0.0)


def _at(times: np.ndarray, t: np.ndarray, column: np.ndarray) -> Any:
    flat = column.reshape(len(t), -1)
    values = np.stack([np.interp(times, t, x) for x in flat.T], axis=-1) if flat.shape[1] else np.zeros((len(times), 0))
    return values.reshape(len(times), *column.shape[1:])


def _hermite(times: np.ndarray, t: np.ndarray, q: np.ndarray, qd: np.ndarray) -> Any:
    from scipy.interpolate import CubicHermiteSpline

    return CubicHermiteSpline(t, q, qd)(times)

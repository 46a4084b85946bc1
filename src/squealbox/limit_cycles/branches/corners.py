"""Past a corner of a branch: where a contact begins to touch v = 0, or two events change places.

The return map of stick and slip is continuous there but its derivative jumps, so pseudo-arclength, which wants a
tangent that turns little, stops. With A- and A+ the derivatives of the residual by y = (x, p) on both sides of the
surface h(y) = 0 at which the order of events changes,

    A+ - A- = a h'      (both agree along the surface: rank one)

The branch comes along t- with h.t- > 0 (h so signed) and goes on along the null vector t+ of A+ with h.t+ > 0. Where p
turns back, t-_p t+_p < 0, that is a fold with a corner: two cycles meet and both end. Where the residual itself jumps
(a contact with static above kinetic friction that just stops, one in tension that reaches v = 0), no cycle lies beside
the last one, and the branch ends there.

Source: di Bernardo, Budd, Champneys and Kowalczyk 2008, Piecewise-smooth Dynamical Systems, Springer, Sec. 3.1 and
Ch. 8 (border collision; of the boundary events of sliding only grazing-sliding has a linear corner); the rank-one rule
is derived here.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from squealbox.continuation import Equation, Follower, PathPoint, null_vector
from squealbox.limit_cycles.branches.shooting_path import ShootingPath
from squealbox.result import Outcome

PROBES = (1e-6, 1e-5, 1e-4, 1e-3)  # distances beyond the last point at which the new order of events is looked for
RESIDUAL = 30.0  # residual beside a corner over the distance, times the size of the derivative: more is a jump
NEWTON_STEPS = 8
CLOSE = 1e-9
MOST = 20  # corners of one branch
Events = tuple[tuple[int, int], ...]  # (contact, new mode) of each event of a period


@dataclass(frozen=True, eq=False)
class Corner:
    """Where a walk stopped and where it goes on: points in scaled variables, and the corner between them."""

    last: PathPoint
    y: Any
    tangent: Any
    kind: str
    p: float
    uncertainty: float


def kind_of(before: Events, after: Events) -> str:
    """What happens where the order of events changes: sticking, grazing, or event_order."""
    sticks = [sum(mode == 0 for _, mode in events) for events in (before, after)]
    if sticks[0] != sticks[1]:
        return "sticking"
    return "grazing" if len(before) != len(after) else "event_order"


def beyond(path: ShootingPath, walk: Follower, last: PathPoint) -> Corner | Outcome:
    """How a branch goes on after its last point, or why it does not."""
    equation = walk.equation
    y, before = equation.y(last.x, last.p), path.sequence(last.x, last.p)
    if before is None:  # the last point itself has no motion
        return walk.outcome
    inside = _derivative(equation, y)
    seen = None
    for way in _ways(y, last.tangent):
        for distance in PROBES:
            probe = y + distance * way
            after = path.sequence(*equation.point(probe))
            if after is None or after == before:
                continue
            seen = seen or (after, first_other(path, last, *equation.point(probe)))
            value, outside = equation.value(probe), _derivative(equation, probe)
            if not np.all(np.isfinite(outside)):
                continue
            size = distance * max(float(np.max(np.abs(outside))), float(np.max(np.abs(inside))))
            if np.max(np.abs(value)) > RESIDUAL * size:
                break  # it jumps
            found = _start_of(path, equation, y, last.tangent, inside, outside, distance, before)
            if found is not None:
                return _corner(equation, last, before, found)
    if seen is None:
        return walk.outcome
    after, other = seen
    message = f"the motion jumps at {last.p:.10g}: no cycle lies beside this one, whose next event is another"
    if other:
        message += ": contact {contact} goes over to mode {mode_after} in place of {mode_before}".format(**other)
        message += ", its normal force {normal_force:.3g} N there (largest {largest_force:.3g} N)".format(**other)
    return Outcome("jump", message, p=last.p, events_before=str(before), events_after=str(after), **other)


def first_other(path: ShootingPath, last: PathPoint, x: np.ndarray, p: float) -> dict[str, Any]:
    """The first event of a period that is another at x and p than at the last point, and N there [N].

    Empty where one list of events begins like the other and only ends sooner.
    """
    runs = path.run(last.x, last.p), path.run(x, p)
    events = [list(zip(run.event_contact.tolist(), run.event_mode.tolist(), strict=True)) for run in runs]
    i = next((i for i, (one, other) in enumerate(zip(*events, strict=False)) if one != other), None)
    if i is None:
        return {}
    contact, row = events[0][i][0], int(np.argmin(np.abs(runs[0].t - runs[0].event_time[i])))
    forces = path.field(last.p).contact_state(np.hstack([runs[0].q, runs[0].qd]))[0][:, contact]
    after = next((mode for at, mode in events[1][i:] if at == contact), None)
    return {"contact": contact, "mode_before": events[0][i][1], "mode_after": after,
            "share_of_period": float(runs[0].event_time[i] / last.x[-1]), "normal_force": float(forces[row]),
            "largest_force": float(np.max(np.abs(forces)))}  # fmt: skip


def _ways(y: np.ndarray, tangent: np.ndarray) -> Iterator[Any]:
    """Directions in which the surface is looked for: ahead, then along the parameter."""
    along = np.append(np.zeros(y.size - 1), 1.0)
    yield from (tangent, along, -along)


def _derivative(equation: Equation, y: np.ndarray) -> Any:
    return equation.derivative(y) if np.all(np.isfinite(equation.value(y))) else np.full((1, 1), np.nan)


def _start_of(
    path: ShootingPath, equation: Equation, y: np.ndarray, tangent: np.ndarray, inside: np.ndarray, outside: np.ndarray,
    distance: float, before: Events,
) -> tuple[Any, Any, Events] | None:  # fmt: skip
    """(point, tangent, events) on the branch beyond the corner, with another order of events than before it."""
    normal = np.linalg.svd(outside - inside)[2][0]
    normal = normal if normal @ tangent > 0.0 else -normal
    forward = np.linalg.svd(outside)[2][-1]
    forward = forward if forward @ normal > 0.0 else -forward
    for length in (3.0 * distance, 30.0 * distance):
        found = equation.corrected(y + length * forward, forward, NEWTON_STEPS, CLOSE).y
        if found is None:
            continue
        after = path.sequence(*equation.point(found))
        if after is None or after == before:
            continue
        if 0.2 * length < np.linalg.norm(found - y) < 5.0 * length:
            return found, null_vector(equation.derivative(found), forward), after
    return None


def _corner(equation: Equation, last: PathPoint, before: Events, found: tuple[Any, Any, Events]) -> Corner:
    """The corner itself: where the tangents of both sides come nearest to each other."""
    beyond_it, tangent, after = found
    y = equation.y(last.x, last.p)
    ways = np.column_stack([last.tangent, tangent])
    ahead, back = np.linalg.lstsq(ways, beyond_it - y, rcond=None)[0]
    ends = y[-1] + ahead * last.tangent[-1], beyond_it[-1] - back * tangent[-1]
    uncertainty = abs(ends[0] - ends[1]) + abs(ends[0] - y[-1])
    return Corner(
        last,
        beyond_it,
        tangent,
        kind_of(before, after),
        0.5 * sum(ends) * equation.scale[-1],
        uncertainty * equation.scale[-1],
    )

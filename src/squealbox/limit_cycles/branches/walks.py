"""A walk along a branch from its start to where it ends, past the corners on its way, and the special points on it."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from squealbox.continuation import Equation, Follower, PathPoint, StepControl, along
from squealbox.limit_cycles.branches.corners import MOST, Corner, beyond
from squealbox.limit_cycles.branches.paths import CyclePath
from squealbox.limit_cycles.branches.phases import taken_up, touches_event
from squealbox.limit_cycles.branches.special_points import BranchPoint, branch_point, candidates, located
from squealbox.result import COMPLETED, Outcome

Special = tuple[str, float, int, BranchPoint | None]


SMALL = 0.2  # of the largest amplitude of a walk: below it a cycle may be about to shrink to steady sliding
STALL = (
    1e-5,
    15,
)  # a path that takes so many steps below that length runs along a grazing, where derivatives are unbounded
STALLED = Outcome("step_underflow", f"{STALL[1]} steps below {STALL[0]:g} in a row: the path runs along a grazing")
BACK = 1e-3  # arclength from the last point to the one that tells where a path was going


@dataclass(eq=False)
class Walk:
    """Points visited with the path each lies on and what it was seen to be, and the corners by the point before."""

    visited: list[PathPoint] = field(default_factory=list)
    paths: list[CyclePath] = field(default_factory=list)
    seen: list[dict[str, Any]] = field(default_factory=list)
    corners: dict[int, Corner] = field(default_factory=dict)
    outcome: Outcome = field(default_factory=Outcome)
    largest: float = 0.0  # swing so far

    def add(self, point: PathPoint, path: CyclePath) -> None:
        """One more point."""
        self.visited.append(point)
        self.paths.append(path)
        self.seen.append(path.describe(point.x, point.p) | {"along": float(point.tangent[-1])})

    def drop_last(self) -> None:
        """Leave out the last point."""
        self.visited, self.paths, self.seen = self.visited[:-1], self.paths[:-1], self.seen[:-1]

    def shrank(self) -> bool:
        """True when the last step passed through amplitude zero: what was a largest displacement is a least one."""
        if len(self.visited) < 2 or self.paths[-2] is not self.paths[-1]:
            return False
        swings = [about["highest"] - about["lowest"] for about in self.seen[-2:]]
        self.largest = max(self.largest, *(float(np.max(each)) for each in swings))
        dof = int(np.argmax(swings[-1]))
        sides = [2.0 * about["begin"][dof] > about["highest"][dof] + about["lowest"][dof] for about in self.seen[-2:]]
        return bool(np.max(swings) < SMALL * self.largest and sides[0] != sides[1])

    def born(self) -> Outcome:
        """The end at steady sliding: the square of the amplitude is linear in the parameter. Drops the last point."""
        self.drop_last()
        squares = [float(np.max(about["highest"] - about["lowest"])) ** 2 for about in self.seen[-2:]]
        values = [at.p for at in self.visited[-2:]]
        p = (
            values[-1] - squares[-1] * (values[-1] - values[0]) / (squares[-1] - squares[0])
            if len(values) > 1
            else values[0]
        )
        return Outcome(COMPLETED, f"the cycle shrinks to steady sliding at {p:.8g}, a Hopf point", hopf=p)

    def stalls(self) -> bool:
        """True when steps stay tiny."""
        steps = [at.step for at in self.visited[-STALL[1] :]]
        return len(steps) == STALL[1] and min(steps) > 0.0 and max(steps) < STALL[0]

    def earlier(self) -> PathPoint | None:
        """The last point of the path that is well before its end."""
        last = self.visited[-1]
        pairs = zip(reversed(self.visited), reversed(self.paths), strict=True)
        return next((at for at, path in pairs if path is self.paths[-1] and last.arclength - at.arclength > BACK), None)


def walked(
    path: CyclePath, walk: Follower, control: StepControl, bounds: tuple[float, float], to_grazing: bool
) -> Walk:
    """Walk to the end; with `to_grazing`, to the first cycle on which a contact reverses."""
    done = Walk()
    for _ in range(MOST):
        for point in walk:
            done.add(point, path)
            if to_grazing and done.seen[-1]["least_slip"] < 0.0:
                done.outcome = Outcome("grazing", "a contact reverses at the start", p=point.p)
                return done
            if done.shrank():
                done.outcome = done.born()
                return done
            if len(done.visited) >= control.most_points:
                done.outcome = Outcome("most_points", f"stopped after {control.most_points} points", p=point.p)
                return done
            if done.stalls():
                break
        done.outcome = STALLED if done.stalls() else walk.outcome
        if done.outcome != "step_underflow" or not path.has_corners:
            return done
        onward = _onward(done, path, walk)
        if onward is None:
            return done
        path, x, p, tangent = onward
        walk = along(path, x, p, control=control, bounds=bounds, tangent=tangent)
    return done


def _onward(done: Walk, path: Any, walk: Follower) -> tuple[Any, ...] | None:
    """(path, x, p, tangent) to go on with after steps have become too small; None, with the reason, where it ends."""
    last, earlier = done.visited[-1], done.earlier()
    if touches_event(path, last.x, last.p) and earlier is not None:
        again = taken_up(path, (last.x, last.p), (earlier.x, earlier.p))
        if again is not None:
            return again
    corner = beyond(path, walk, last)
    if isinstance(corner, Outcome):
        done.outcome = corner
        return None
    done.corners[len(done.visited) - 1] = corner
    return path, *walk.equation.point(corner.y), corner.tangent


def special_points(walk: Walk, parameter: str) -> list[Special]:
    """(kind, value, index of the point before, the point or None where it could not be solved for) along the walk."""
    found: list[Special] = []
    for event, i in candidates(walk.seen):
        path = walk.paths[i]
        if i in walk.corners or walk.paths[i + 1] is not path:
            continue
        solved = located(path, walk.visited[i], walk.visited[i + 1], event)
        if solved is not None:
            x, p, test, uncertainty = solved
            found.append((event.kind, p, i, branch_point(path, x, p, event.kind, parameter, test, uncertainty)))
        elif event.told:
            found.append((event.kind, 0.5 * (walk.visited[i].p + walk.visited[i + 1].p), i, None))
    for i, corner in walk.corners.items():
        if i + 1 < len(walk.visited):
            found += _at_corner(walk.paths[i], i, corner, walk.visited[i + 1], parameter)
    return sorted(found, key=lambda special: special[2])


def _at_corner(path: CyclePath, i: int, corner: Corner, after: PathPoint, parameter: str) -> list[Special]:
    """A corner by its kind, and as a fold where the parameter turns back there."""
    kinds = [corner.kind]
    if corner.last.tangent[-1] * after.tangent[-1] < 0.0:
        kinds.append("fold")
    gap = float(np.max(np.abs(Equation.of(path).y(corner.last.x, corner.last.p) - corner.y)))
    made = [branch_point(path, corner.last.x, corner.p, kind, parameter, gap, corner.uncertainty) for kind in kinds]
    return [(point.kind, corner.p, i, point) for point in made]

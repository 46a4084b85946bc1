"""The searches behind `optimise`: SciPy for one goal, pymoo for several."""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from squealbox.extras import extra
from squealbox.studies.optimisation.goals import Candidates, Constraint, Goal

FEASIBLE = 1e-6  # relative violation of a constraint that still counts as kept
WORST = 1e30  # stands for a goal that is unknown or infinite
Effort = tuple[int, int, int]  # population, generations, seed


def best_of_one(
    candidates: Candidates,
    goal: Goal,
    constraints: list[Constraint],
    box: np.ndarray,
    start: np.ndarray | None,
    effort: Effort,
) -> Any:
    """The best point for one goal, shape (1, variables); from `start` alone when it is given."""
    if start is None:
        found = _evolved(candidates, goal, constraints, box, effort)
    else:
        found = np.clip(start, box[:, 0], box[:, 1])
    polished = _polished(candidates, goal, constraints, box, found)
    both = np.stack([found, polished])
    cost = _costs(candidates, [goal], both)[:, 0]
    missed = _missed(candidates, constraints, both)
    better = missed[1] <= max(missed[0], FEASIBLE) and (cost[1] < cost[0] or missed[0] > FEASIBLE)
    return both[1:] if better else both[:1]


def _evolved(candidates: Candidates, goal: Goal, constraints: list[Constraint], box: np.ndarray, effort: Effort) -> Any:
    from scipy.optimize import NonlinearConstraint, differential_evolution

    population, generations, seed = effort
    raised: list[Exception] = []  # SciPy says something else in its place

    def cost(x: np.ndarray) -> Any:
        columns = x.T if x.ndim == 2 else x[None]
        try:
            found = _costs(candidates, [goal], columns)[:, 0]
        except Exception as error:
            raised.append(error)
            raise
        return found if x.ndim == 2 else float(found[0])

    def kept(x: np.ndarray) -> Any:
        columns = x.T if x.ndim == 2 else x[None]
        found = _finite(candidates.measures(constraints, columns))
        return found.T if x.ndim == 2 else found[0]

    limits: tuple[Any, ...] = ()
    if constraints:
        limits = (NonlinearConstraint(kept, [c.low for c in constraints], [c.high for c in constraints]),)
    try:
        found = differential_evolution(
            cost, box, constraints=limits, rng=seed, vectorized=True, updating="deferred", polish=False, tol=1e-8,
            popsize=max(2, -(-population // len(box))), maxiter=generations,
        )  # fmt: skip
    except RuntimeError:
        if raised:
            raise raised[0] from None
        raise
    return np.asarray(found.x)


def _polished(
    candidates: Candidates, goal: Goal, constraints: list[Constraint], box: np.ndarray, start: np.ndarray
) -> Any:
    """SLSQP from `start` in variables scaled to their ranges, with differences of a batch for its derivatives."""
    from scipy.optimize import minimize

    low, width = box[:, 0], np.ptp(box, axis=1)

    def place(u: ArrayLike) -> Any:
        return np.clip(low + np.atleast_2d(u) * width, box[:, 0], box[:, 1])

    size = abs(float(_costs(candidates, [goal], start[None])[0, 0])) or 1.0
    rows = [(i, sign, end) for i, each in enumerate(constraints) for sign, end in ((1.0, each.low), (-1.0, each.high))]
    rows = [row for row in rows if np.isfinite(row[2])]

    def cost(u: np.ndarray) -> Any:
        return _costs(candidates, [goal], place(u))[:, 0] / size

    def slack(u: np.ndarray) -> Any:
        found = _finite(candidates.measures(constraints, place(u)))
        return np.stack([sign * (found[:, i] - end) / max(abs(end), 1e-12) for i, sign, end in rows], axis=-1)

    limits = [{"type": "ineq", "fun": lambda u: slack(u)[0], "jac": lambda u: _slopes(slack, u)}] if rows else []
    found = minimize(
        lambda u: float(cost(u)[0]), (start - low) / width, jac=lambda u: _slopes(cost, u), method="SLSQP",
        bounds=[(0.0, 1.0)] * len(box), constraints=limits, options={"ftol": 1e-14, "maxiter": 200},
    )  # fmt: skip
    return place(found.x)[0] if np.all(np.isfinite(found.x)) else start


def _slopes(function: Callable[[Any], Any], u: np.ndarray, step: float = 1e-6) -> Any:
    """Central differences of a batched function (one-sided at the bounds): ([outputs,] variables)."""
    shifts = step * np.eye(u.size)
    up, down = np.minimum(u + shifts, 1.0), np.maximum(u - shifts, 0.0)
    values = function(np.concatenate([up, down]))
    span = np.diag(up - down)
    difference = values[: u.size] - values[u.size :]
    return (difference.T / span) if difference.ndim == 2 else difference / span


def pareto_front(
    candidates: Candidates, goals: list[Goal], constraints: list[Constraint], box: np.ndarray, effort: Effort
) -> Any:
    """Designs none of which betters another in every goal, shape (designs, variables), by NSGA-II."""
    with extra("studies"):
        from pymoo.algorithms.moo.nsga2 import NSGA2
        from pymoo.core.problem import Problem
        from pymoo.optimize import minimize

    population, generations, seed = effort

    class Weighing(Problem):
        def __init__(self) -> None:
            count = 1 + 2 * len(constraints)  # the first: every goal has an answer
            super().__init__(n_var=len(box), n_obj=len(goals), n_ieq_constr=count, xl=box[:, 0], xu=box[:, 1])

        def _evaluate(self, x: np.ndarray, out: dict[str, Any], *_: Any, **__: Any) -> None:
            cost = _costs(candidates, goals, x)
            kept = [np.where(np.any(np.abs(cost) >= WORST, axis=1), 1.0, -1.0)[:, None]]
            if constraints:
                found = _finite(candidates.measures(constraints, x))
                low, high = (np.array([getattr(c, end) for c in constraints]) for end in ("low", "high"))
                kept += [np.maximum(low - found, -WORST), np.maximum(found - high, -WORST)]
            out["F"], out["G"] = cost, np.concatenate(kept, axis=1)

    found = minimize(Weighing(), NSGA2(pop_size=population), ("n_gen", generations), seed=seed, verbose=False)
    if found.X is None:  # nothing keeps the constraints: the least bad of the last population
        last = found.pop
        worst = np.argmin(last.get("CV")[:, 0])
        return np.atleast_2d(last.get("X")[worst])
    x = np.atleast_2d(found.X)
    return x[np.lexsort(np.atleast_2d(found.F).T[::-1])]


def _costs(candidates: Candidates, goals: list[Goal], x: np.ndarray) -> Any:
    return _finite(candidates.measures(goals, x) * np.array([goal.factor for goal in goals]))


def _finite(values: np.ndarray) -> Any:
    return np.clip(np.where(np.isnan(values), WORST, values), -WORST, WORST)


def _missed(candidates: Candidates, constraints: list[Constraint], x: np.ndarray) -> Any:
    """The largest relative violation at points (count, variables); 0 when everything is kept."""
    if not constraints:
        return np.zeros(len(x))
    found = _finite(candidates.measures(constraints, x))
    scales = [max(*(abs(end) for end in (c.low, c.high) if np.isfinite(end)), 1e-12) for c in constraints]
    parts = [c.violation(found[:, i]) / scale for i, (c, scale) in enumerate(zip(constraints, scales, strict=True))]
    return np.maximum(np.max(np.stack(parts), axis=0), 0.0)

"""The best design within bounds: one goal by SciPy, several by their Pareto front through pymoo; robust if asked for.

One goal: differential evolution over the box (a population in one batched call), then SLSQP from its best point, whose
answer is taken when it is feasible and better. Several: NSGA-II. Goals and constraints may be taken over scatter.
Sources: R. Storn, K. Price 1997, J. Global Optim. 11, 341-359;
K. Deb et al. 2002, IEEE Trans. Evol. Comput. 6, 182-197.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Literal

import numpy as np

from squealbox.arguments import public
from squealbox.family import DesignOrRecipe, unit_of
from squealbox.parameters import ParameterError, known_names
from squealbox.result import Array, Outcome, Result, quantity
from squealbox.scatter import Scatter, Scattered, as_scatter
from squealbox.studies.optimisation.goals import Candidates, Constraint, Goal
from squealbox.studies.optimisation.search import FEASIBLE, best_of_one, pareto_front
from squealbox.studies.quantity import input_of
from squealbox.studies.uncertainty.intervals import checked_box

METHODS = ("global", "local")
NEAR = 1e-4  # share of the range, or of the size of a constraint's limit, within which it is said to bind


@dataclass(frozen=True, kw_only=True, eq=False)
class Optimum(Result):
    """Designs that cannot be bettered, as :func:`optimise` returns them: one, or the points of a Pareto front.

    `best` is the index of one design of the front: for one goal the only one, for several the compromise, which is
    nearest to the best value of every goal, each scaled by its range over the front.
    """

    values: Array = quantity("design parameter", "", "varied parameters, in SI")
    goals: Array = quantity("design goal", "", "the goals at these designs")
    constraints: Array = quantity("design constraint", "", "the constrained numbers there")
    before: Array = quantity("parameter", "", "varied parameters of the design given; NaN where it is unknown")
    goals_before: Array = quantity("goal", "", "its goals")
    constraints_before: Array = quantity("constraint", "", "its constrained numbers")
    best: int = 0

    table_over: ClassVar = ("design",)
    headings: ClassVar = {"values": "{}", "goals": "{}", "constraints": "{}"}

    @property
    def names(self) -> tuple[str, ...]:
        """The varied parameters, in order."""
        return tuple(self.settings["names"])

    def table(self) -> dict[str, Any]:
        return {"best": np.arange(len(self.values)) == self.best, **super().table()}

    def _unit_at(self, dim: str, label: str, unit: str) -> str:
        if dim not in ("goal", "constraint"):
            return super()._unit_at(dim, label, unit)
        return str({each["name"]: each["unit"] for each in self.settings[f"{dim}s"]}.get(label) or "-")

    @property
    def changes(self) -> dict[str, float]:
        """The best design as ``replace`` takes it: ``brake.replace(found.changes)``."""
        return {name: float(value) for name, value in zip(self.names, self.values[self.best], strict=True)}

    @property
    def design(self) -> Any:
        """The design given with the best values; `ValueError` when it cannot be kept with a result."""
        given = self.inputs.get("design")
        if given is None:
            raise ValueError("the design was a function, which a result cannot keep: use `changes`")
        return given.replace(self.changes)

    def binding(self, index: int | None = None) -> list[str]:
        """What holds a design back: bounds and constraints it lies on, in words."""
        row = self.best if index is None else index
        said = []
        for name, value, (low, high) in zip(self.names, self.values[row], self.settings["box"], strict=True):
            width = high - low
            said += [f"{name} at its lower bound {low:.6g}"] * bool(value - low <= NEAR * width)
            said += [f"{name} at its upper bound {high:.6g}"] * bool(high - value <= NEAR * width)
        for about, value in zip(self.settings["constraints"], self.constraints[row], strict=True):
            for word, limit in (("lower", about["low"]), ("upper", about["high"])):
                if limit is not None and abs(value - limit) <= NEAR * max(abs(limit), 1e-12):
                    said.append(f"{about['name']} at its {word} limit {limit:.6g}")
        return said

    def summary(self) -> str:
        """Before and after, and what binds."""
        if not self.outcome.ok:
            return f"optimum: {self.outcome.told}"
        lines = []
        if len(self.values) > 1:
            lines.append(f"{len(self.values)} designs on the Pareto front; the compromise among them:")
        design = self.inputs.get("design")
        moved = zip(self.names, self.before, self.values[self.best], strict=True)
        rows = [(name, unit_of(design, name), old, new) for name, old, new in moved]
        for kind in ("goals", "constraints"):
            numbers = zip(getattr(self, f"{kind}_before"), getattr(self, kind)[self.best], strict=True)
            for about, (old, new) in zip(self.settings[kind], numbers, strict=True):
                what = about["sense"] if kind == "goals" else _limits(about)
                rows.append((f"{about['name']} ({what})", about["unit"], old, new))
        width = max(len(row[0]) for row in rows)
        lines.append(f"{'':{width}}  {'before':>12}  {'after':>12}")
        lines += [f"{name:{width}}  {a:12.6g}  {b:12.6g}  {unit}".rstrip() for name, unit, a, b in rows]
        held = self.binding()
        lines.append(f"binding: {'; '.join(held) if held else 'nothing, the optimum lies inside'}")
        lines.append(f"{self.settings['evaluations']} evaluations")
        return "\n".join(lines)


@public(design=None)
def optimise(
    design: DesignOrRecipe | None,
    variables: Mapping[str, tuple[float, float]],
    goals: Goal | Sequence[Goal],
    constraints: Sequence[Constraint] = (),
    *,
    scatter: Scattered | None = None,
    samples: int = 256,
    method: Literal["global", "local"] = "global",
    population: int = 60,
    generations: int = 200,
    seed: int = 0,
) -> Optimum:
    """Designs that reach `goals` best while `variables` stay within their bounds.

    Parameters
    ----------
    design : has ``replace``; or a function of the values in the order of `variables` (and of `scatter`); or None
    variables : dotted name to (low, high) in SI: the parameters that may be changed
    goals : one `Goal`, or several for a Pareto front
    constraints : what has to be kept
    scatter : parameters that scatter, for goals and constraints over it; `samples` Sobol' points, the same for every
        candidate. A scattered parameter that is varied too scatters about its varied value: with the same relative
        deviations when it is lognormal, with the same deviations otherwise
    method : for one goal "global" (differential evolution, then SLSQP) or "local" (SLSQP from the design given)
    population, generations : of the search
    seed : the same seed gives the same designs

    Accuracy: a single smooth optimum to about 1e-6 of the range; a goal that is a probability has steps of 1/samples.
    The front is a sample of it. When no candidate keeps the constraints the outcome is "infeasible", with the least bad
    one.

    >>> from squealbox.studies import Goal, optimise
    >>> bowl = Goal(lambda at: (at["x"] - 0.3) ** 2 + 1.0)
    >>> found = optimise(None, {"x": (-1.0, 1.0)}, bowl)
    >>> round(found.changes["x"], 5), round(float(found.goals[0, 0]), 9)
    (0.3, 1.0)
    """
    wanted: list[Any] = list(goals) if isinstance(goals, (list, tuple)) else [goals]
    kept = list(constraints)
    names, box = checked_box(variables, "optimise")
    scatter = None if scatter is None else as_scatter(scatter)
    _check(wanted, kept, scatter, method)
    candidates = Candidates(design, names, scatter, int(samples), seed)
    before = _before(design, names)
    if len(wanted) == 1:
        start = before if method == "local" else None
        x = best_of_one(candidates, wanted[0], kept, box, start, (population, generations, seed))
    else:
        x = pareto_front(candidates, wanted, kept, box, (population, generations, seed))
    reached = candidates.measures([*wanted, *kept], x)
    given = np.full(reached.shape[1], np.nan)
    if np.all(np.isfinite(before)):
        given = candidates.measures([*wanted, *kept], before[None])[0]
    count = len(wanted)
    settings = {"names": names, "box": box.tolist(), "samples": int(samples), "method": method, "seed": seed}
    settings |= {"population": population, "generations": generations, "evaluations": candidates.evaluations}
    settings |= {"goals": [_about(goal) for goal in wanted], "constraints": [_about(each) for each in kept]}
    return Optimum(
        values=x,
        goals=reached[:, :count],
        constraints=reached[:, count:],
        before=before,
        goals_before=given[:count],
        constraints_before=given[count:],
        best=_compromise(reached[:, :count] * [goal.factor for goal in wanted]),
        inputs={"design": input_of(design), "scatter": scatter},
        settings=settings,
        outcome=_outcome(reached[:, :count], reached[:, count:], kept),
    )


def _check(goals: list[Goal], constraints: list[Constraint], scatter: Scatter | None, method: str) -> None:
    if not goals:
        raise ParameterError("optimise", "goals", goals, "at least one Goal")
    for each in (*goals, *constraints):
        if not isinstance(each, (Goal, Constraint)):
            raise ParameterError("optimise", "goals", each, "a Goal; a Constraint goes to constraints")
        if each.over != "nominal" and scatter is None:
            raise ParameterError("optimise", "scatter", None, f"a Scatter, which {each.name} is taken over")
    if method not in METHODS:
        raise ParameterError("optimise", "method", method, known_names(str(method), list(METHODS)))


def _before(design: object, names: list[str]) -> Any:
    """The varied parameters of the design given; NaN where there is none."""
    if hasattr(design, "value_of"):
        return np.array([float(design.value_of(name)) for name in names])
    return np.full(len(names), np.nan)


def _about(each: Goal | Constraint) -> dict[str, Any]:
    about = {"name": each.name, "unit": "" if each.over == "probability" else each.quantity.unit, "over": each.over}
    if isinstance(each, Goal):
        return {**about, "sense": each.sense}
    ends = {name: float(end) if np.isfinite(end) else None for name, end in (("low", each.low), ("high", each.high))}
    return {**about, **ends}


def _limits(about: Mapping[str, Any]) -> str:
    ends = (("at least", about["low"]), ("at most", about["high"]))
    return ", ".join(f"{word} {end:g}" for word, end in ends if end is not None)


def _compromise(costs: np.ndarray) -> int:
    """The row nearest to the best of every column, each scaled by its range."""
    costs = np.where(np.isfinite(costs), costs, 1e30)
    low, width = np.min(costs, axis=0), np.ptp(costs, axis=0)
    return int(np.argmin(np.linalg.norm((costs - low) / np.where(width > 0.0, width, 1.0), axis=1)))


def _outcome(goals: np.ndarray, measures: np.ndarray, constraints: list[Constraint]) -> Outcome:
    if not np.all(np.isfinite(goals)):
        return Outcome("no_answer", "a goal is unknown or infinite at the best designs found: narrow the bounds")
    if not constraints:
        return Outcome()
    worst = np.stack([each.violation(measures[:, i]) for i, each in enumerate(constraints)], axis=-1)
    scale = np.array([_scale(each) for each in constraints])
    if np.all(np.any(worst > FEASIBLE * scale, axis=1)):
        i = int(np.argmax(np.min(worst / scale, axis=0)))
        message = f"no design within the bounds keeps every constraint; the least bad misses {constraints[i].name}"
        return Outcome("infeasible", message, missed_by=float(np.min(worst[:, i])))
    return Outcome()


def _scale(each: Constraint) -> float:
    return max(*(abs(end) for end in (each.low, each.high) if np.isfinite(end)), 1e-12)

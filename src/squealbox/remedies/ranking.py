"""Every candidate at the dose it needs, how it fares over the scatter of production, and the table of them all."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from squealbox.arguments import public, with_parameters
from squealbox.control import closed_loop
from squealbox.countermeasures import Controlled, Countermeasure, Dithered
from squealbox.design import Design
from squealbox.fe import ReducedBrake, with_component, with_mass
from squealbox.parameters import ParameterError
from squealbox.remedies.candidates import Candidate, candidates_for, more_friction
from squealbox.remedies.production import ASSUMED, LOT, lot_size, usual_scatter
from squealbox.remedies.structural import ON_THE_BASIS, structural_candidates
from squealbox.result import Array, Outcome, Result, quantity
from squealbox.scatter import Scatter, Scattered, as_scatter
from squealbox.stability import growth_of
from squealbox.system import InvalidSystem, equilibrium
from squealbox.transient import simulate
from squealbox.words import as_read

TUNING = 0.03  # standard deviation of an absorber's frequency in production, relative
ZOOM, SLOW_ZOOM = 17, 6
PUSH, PERIODS = 0.05, 100.0  # m/s of the push, and how many periods of the worst mode it is followed
MOST_ROWS = 20  # of a summary
Z = 1.96  # of a 95 % interval
FEWER = "{} brakes in the lot, as each is large: P(squeal) is known to {:.0f} % or better, with more samples closer"
HALF = 0.5
READ_IN = {"rad": ("deg", np.pi / 180.0), "N/m": ("kN/mm", 1e6), "m/N": ("mm/kN", 1e-6)}
NO_DOSE = "no dose up to"


@dataclass(frozen=True, kw_only=True, eq=False)
class Remedies(Result):
    """Cures ranked by the squeal they leave, as :func:`silence` returns them. Rows are along `cure`.

    `reached` says whether the dose makes the brake quiet at `margin` more friction; where none does, the dose is that
    with the least growth. `line` is the Python that makes the cured brake, of the name `brake`; `values` are the
    parameters a cure gives another value, {} for one that puts something on the brake.
    """

    name: Array = quantity("cure", "1", "what is done")
    dose: Array = quantity("cure", "", "how much of it, in its own unit")
    unit: Array = quantity("cure", "1", "unit of the dose")
    reached: Array = quantity("cure", "1", "True where the brake is quiet at the margin too")
    growth: Array = quantity("cure", "1/s", "largest growth rate at nominal friction")
    growth_at_margin: Array = quantity("cure", "1/s", "largest growth rate with the margin in friction")
    probability: Array = quantity("cure", "1", "share of the lot that squeals")
    amplitude: Array = quantity("cure", "m", "vibration some time after a push, half peak to peak; NaN unknown")
    cost: Array = quantity("cure", "1", "what it costs, in words")
    caution: Array = quantity("cure", "1", "what to know before using it")
    line: Array = quantity("cure", "1", "one line of Python that makes the cured brake")
    values: tuple[dict[str, float], ...] = ()
    before: float = float("nan")
    growth_before: float = float("nan")
    amplitude_before: float = float("nan")
    margin: float = 0.1
    assumption: str = ""

    headings: ClassVar = {"name": "cure", "unit": "unit of the dose", "probability": "P(squeal)", "line": "python"}

    def __len__(self) -> int:
        return len(self.name)

    def dose_as_read(self, row: int) -> tuple[float, str]:
        """The dose of that row and its unit as a reader has them: degrees, kN/mm, mm/kN."""
        unit, factor = READ_IN.get(str(self.unit[row]), (str(self.unit[row]), 1.0))
        return float(self.dose[row]) / factor, unit

    def design(self, row: int) -> Design:
        """The brake with the cure of that row, made by its line of Python."""
        from squealbox import countermeasures, loops

        known = {name: getattr(countermeasures, name) for name in countermeasures.__all__}
        known |= {name: getattr(loops, name) for name in ("PID", "ActiveForce", "StateFeedback", "DelayedFeedback")}
        known |= {"with_component": with_component, "with_mass": with_mass}
        made: Design = _made(str(self.line[row]), {**known, "brake": self.inputs["system"]})
        return made

    @property
    def pushed(self) -> bool:
        """Whether motions after a push were followed."""
        return bool(np.isfinite(self.amplitude_before) or np.any(np.isfinite(self.amplitude)))

    def rows(self) -> list[tuple[str, ...]]:
        """The table as text, under `heads`."""
        return [
            (
                str(self.name[i]), _told(float(self.dose[i]), str(self.unit[i])), f"{float(self.growth[i]):+.4g}",
                f"{float(self.growth_at_margin[i]):+.4g}", f"{float(self.probability[i]):.3f}",
                *([f"{round(1e6 * float(self.amplitude[i]), 3):.3g}"] if self.pushed else []), str(self.cost[i]),
                str(self.caution[i]),
            )
            for i in range(len(self))
        ]  # fmt: skip

    def heads(self) -> tuple[str, ...]:
        """What the columns of `rows` are called; what was not followed has none."""
        later = f"at mu +{100.0 * self.margin:.3g} %"
        push = ("after push [um]",) if self.pushed else ()
        return ("cure", "dose", "growth [1/s]", later, "P(squeal)", *push, "cost", "caution")

    def without(self) -> str:
        """The brake as it is, in a sentence."""
        push = f", {1e6 * self.amplitude_before:.3g} um after a push" if self.pushed else ""
        return f"Without: growth {self.growth_before:+.4g} 1/s, P(squeal) {self.before:.3f}{push}"

    def summary(self, most: int = MOST_ROWS) -> str:
        """The ranked table, ready for an e-mail: the `most` best cures, a screenful, and what to know of them."""
        shown = min(most, len(self))
        table = [row[:-1] for row in (self.heads(), *self.rows()[:shown])]
        widths = [max(map(len, column)) for column in zip(*table, strict=True)]
        lines = [
            "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip() for row in table
        ]
        lines += [f"and {len(self) - shown} more, in rows()"] if shown < len(self) else []
        several = [[part for part in str(self.caution[i]).split("; ") if part] for i in range(shown)]
        others = [[part for part in each if not part.startswith(NO_DOSE)] for each in several]
        cautions = [f"{self.name[i]}: {'; '.join(others[i])}" for i in range(shown) if others[i]]
        loud = [str(self.name[i]) for i in range(shown) if len(others[i]) < len(several[i])]
        if loud:
            friction = f" with {100.0 * self.margin:.3g} % more friction" if self.margin else ""
            cautions += [f"no dose that was tried makes it quiet{friction}: {', '.join(loud)}"]
        said = [self.assumption] if self.assumption else []
        return "\n".join([self.without(), *lines, "", *cautions, *said])


@public(scatter=None, brake=with_parameters)
def silence(
    brake: Design,
    scatter: Scattered | None = None,
    candidates: Sequence[Candidate] | None = None,
    margin: float = 0.1,
    *,
    samples: int | None = None,
    seed: int = 0,
    push: float = PUSH,
) -> Remedies:
    """What would silence this brake: every candidate at the dose it needs, ranked by the squeal it leaves.

    Parameters
    ----------
    brake : any design with a friction law
    scatter : how its parameters scatter in production, {name: distribution} or a `Scatter`; None takes `usual_scatter`,
        and the summary says so
    candidates : None takes `candidates_for`: each parameter, absorbers, dampers, masses, springs, shims, asymmetry,
        dither, velocity feedback, active force control, combinations of two. Of a reduced brake less friction,
        components stiffer, softer, heavier, lighter or more damped, and masses on nodes, by the modes of its band
    margin : [-] by which friction may rise without squeal
    samples, seed : of the lot, the same for every candidate; absorbers scatter in their tuning by 3 % besides. None
        takes 2048 brakes, fewer of more than 20 degrees of freedom, which take longer; the summary says so
    push : [m/s] velocity of the push along the worst mode after which the motion is followed; 0 follows none

    >>> from squealbox import Coulomb, ModeCoupling
    >>> from squealbox.studies import Normal, Scatter
    >>> brake = ModeCoupling(c1=0.02, c2=0.02, friction=Coulomb(1.05))
    >>> table = silence(brake, Scatter({"friction.static": Normal(1.05, 0.05)}), samples=64, push=0.0)
    >>> len(table) >= 15, bool(table.probability[0] < table.before)
    (True, True)
    """
    if not (np.isfinite(margin) and margin >= 0.0):
        raise ParameterError("silence", "margin", margin, "a finite number of at least 0")
    said: list[str] = []
    if isinstance(brake, ReducedBrake):  # nothing can be fastened to its coordinates: the structure is changed
        candidates = structural_candidates(brake) if candidates is None else candidates
        push, said = 0.0, [ON_THE_BASIS]
    assumed = scatter is None
    scatter = usual_scatter(brake) if scatter is None else as_scatter(scatter)
    if not isinstance(scatter, Scatter):
        raise ParameterError("silence", "scatter", scatter, "{name: distribution} or a Scatter of the brake")
    fewer = samples is None and lot_size(brake) < LOT
    samples = lot_size(brake) if samples is None else samples
    said += [ASSUMED] * assumed + [FEWER.format(samples, 50.0 * Z / np.sqrt(samples))] * fewer
    lot = scatter.sample(samples, seed=seed)
    tuning = 1.0 + TUNING * np.random.default_rng(seed + 1).standard_normal(samples)
    worse = more_friction(brake, 1.0 + margin)
    chosen = list(candidates_for(brake, worse) if candidates is None else candidates)
    rows = [_row(each, brake, margin, lot, tuning, push) for each in chosen]
    rows = _one_side(rows)
    names = (
        "name",
        "dose",
        "unit",
        "reached",
        "growth",
        "growth_at_margin",
        "probability",
        "amplitude",
        "cost",
        "caution",
        "line",
    )
    columns: dict[str, Any] = {name: np.array([row[name] for row in rows]) for name in names}
    outcome = Outcome() if rows else Outcome("no_candidates", "nothing was given that could be tried")
    return Remedies(
        **columns, values=tuple(row["values"] for row in rows), before=_share(brake, lot),
        growth_before=float(growth_of(brake)), amplitude_before=_pushed(brake, brake, push), margin=margin,
        inputs={"system": brake}, settings={"samples": samples, "seed": seed, "push": push}, outcome=outcome,
        assumption="\n".join(said),
    )  # fmt: skip


def _row(
    each: Candidate, brake: Design, margin: float, lot: Mapping[str, Any], tuning: np.ndarray, push: float
) -> dict[str, Any]:
    dose, reached = _dose(each, margin)
    cured = each.make(dose)
    growth, later = float(growth_of(cured)), float(growth_of(more_friction(cured, 1.0 + margin)))
    share = _share_cured(each, cured, brake, lot, tuning)
    cautions = [*each.cautions, *_said(cured, brake)]
    if not reached:
        cautions.insert(0, f"{NO_DOSE} {_told(float(np.abs(each.doses[-1])), each.unit)} makes it quiet at the margin")
    if growth <= 0.0 and share > HALF:
        cautions.insert(0, f"stable as drawn, and yet {100.0 * share:.0f} % of the lot squeals")
    return {
        "name": each.name, "dose": dose, "unit": each.unit, "reached": reached, "growth": growth,
        "growth_at_margin": later,
        "probability": share, "amplitude": _pushed(cured, brake, push), "cost": each.cost(dose),
        "caution": "; ".join(cautions), "line": each.line(dose),
        "values": {} if each.values is None else each.values(dose),
    }  # fmt: skip


def _told(dose: float, unit: str) -> str:
    """A dose as a reader writes it: angles in degrees, pure numbers without a unit."""
    number, unit = as_read(dose, unit)
    return f"{number:.4g} {unit}".rstrip()


def _dose(each: Candidate, margin: float) -> tuple[float, bool]:
    """The least dose at which the brake is quiet with the margin, or the one with the least growth."""
    doses = np.asarray(each.doses, dtype=float)
    growth = _growths(each, doses, margin)
    quiet = growth <= 0.0
    if not np.any(quiet):
        return float(doses[int(np.argmin(growth))]), False
    first = int(np.argmax(quiet))
    if first == 0:
        return float(doses[0]), True
    low, high = doses[first - 1], doses[first]
    for _ in range(1 if each.slow else 4):
        fine = np.linspace(low, high, SLOW_ZOOM if each.slow else ZOOM)
        quiet = _growths(each, fine, margin) <= 0.0
        k = max(int(np.argmax(quiet)), 1)
        low, high = fine[k - 1], fine[k]
    return float(high), True


def _growths(each: Candidate, doses: np.ndarray, margin: float) -> Any:
    """Growth rates (k,) at the margin; inf at doses the brake's own rules refuse."""

    def growth(some: float | np.ndarray) -> Any:
        try:
            return growth_of(more_friction(each.make(some), 1.0 + margin))
        except (ParameterError, InvalidSystem):
            return np.inf  # refused: the table says that no such dose is possible

    together = growth(doses) if len(doses) > 1 and not each.slow else np.inf
    if np.ndim(together):
        return together
    return np.array([growth(float(dose)) for dose in doses])  # one by one: some of them may be possible


def _share(brake: Design, lot: Mapping[str, Any]) -> float:
    """Share of the lot that squeals."""
    return float(np.mean(growth_of(brake.replace(lot)) > 0.0))


def _share_cured(each: Candidate, cured: Design, brake: Design, lot: Mapping[str, Any], tuning: np.ndarray) -> float:
    """Share of the lot that squeals with a cure; a parameter that it changes scatters about its new value."""
    values: dict[str, Any] = {}
    if each.values is None:
        where = "brake." * len(_layers(cured, brake))  # no field of a countermeasure is taken for the brake's
        values = {f"{where}{name}": sample for name, sample in lot.items()}
    else:
        for name, sample in lot.items():
            for field in brake.aliases.get(name, (name,)):
                values[field] = sample + (cured.value_of(field) - brake.value_of(field))
    if each.tuned:
        values[each.tuned] = cured.value_of(each.tuned) * tuning
    return _share(cured, values)


def _layers(cured: Design, brake: Design) -> list[Countermeasure]:
    """The countermeasures put onto the brake, the outermost first; none where it is not among what they hold."""
    for i, layer in enumerate(cured.layers):
        if layer.brake is brake:
            return list(cured.layers[: i + 1])
    return []


def _one_side(rows: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Of the two directions of a parameter the better one."""
    best: dict[Any, dict[str, Any]] = {}
    for row in sorted(rows, key=lambda row: (row["probability"], row["growth_at_margin"])):
        best.setdefault(tuple(row["values"]) or row["name"], row)
    return list(best.values())


def _said(cured: Design, brake: Design) -> list[str]:
    for layer in _layers(cured, brake):
        if isinstance(layer, Dithered):
            left = f"mean friction left {100.0 * float(np.min(layer.friction_left)):.0f} %"
            return [left, *layer.cautions()]
    if isinstance(cured, Controlled):
        found = closed_loop(cured)
        if not found.stable:
            return []
        rate = found.sampling_margin(1.0)
        sampling = (
            f"the sampling above {rate:.4g} Hz" if np.isfinite(rate) else "no sampling that was tried is quick enough"
        )
        return [f"the delay must stay below {1e6 * found.delay_margin:.3g} us and {sampling} (one sample to compute)"]
    state = equilibrium(cured.system())
    pulled = [
        c.name
        for c, force in zip(cured.system().contacts, np.atleast_1d(state.normal_force), strict=False)
        if force < 0.0
    ]
    was = [float(force) < 0.0 for force in np.atleast_1d(equilibrium(brake.system()).normal_force)]
    return [f"{', '.join(pulled)} is pulled (N < 0)"] if len(pulled) > sum(was) else []


def _pushed(cured: Design, brake: Design, push: float) -> float:
    """Half peak to peak over the last tenth of a run that begins with a push along the brake's worst mode [m]."""
    if push == 0.0:
        return float("nan")
    from squealbox.stability import complex_modes

    worst = complex_modes(brake).most_unstable
    moving = np.real(worst.shape)[: brake.system().size]  # what a law with memory bends is not pushed
    moving = moving / np.max(np.abs(worst.shape[: moving.size]))
    duration = PERIODS / max(worst.frequency, 1e-12)
    try:
        steady = equilibrium(cured.system()).q
        kick = np.zeros(steady.size)
        kick[: moving.size] = push * moving
        motion = simulate(cured, duration, (steady, kick), 2001)
    except (InvalidSystem, ParameterError):
        return float("nan")  # an engine that cannot run it: the table says NaN, unknown
    if not motion.outcome.ok:
        return float("nan")
    last = motion.q[-200:, : moving.size]
    return float(0.5 * np.max(np.ptp(last, axis=0)))


def _made(line: str, known: dict[str, Any]) -> Any:
    """What the line makes; only the names in `known` and numbers are read, no code is run."""
    import ast

    def of(node: ast.AST) -> Any:
        if isinstance(node, ast.Expression):
            return of(node.body)
        if isinstance(node, ast.Constant):
            return node.value
        if isinstance(node, ast.Name):
            return known[node.id]
        if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
            return -of(node.operand)
        if isinstance(node, ast.List):
            return [of(item) for item in node.elts]
        if isinstance(node, ast.Dict):
            return {of(k): of(v) for k, v in zip(node.keys, node.values, strict=True) if k is not None}
        if isinstance(node, ast.Attribute) and node.attr == "replace":
            return of(node.value).replace
        if isinstance(node, ast.Call):
            return of(node.func)(*map(of, node.args), **{str(k.arg): of(k.value) for k in node.keywords})
        raise ParameterError("Remedies", "line", line, "a line of Python as `silence` writes it")

    return of(ast.parse(line, mode="eval"))

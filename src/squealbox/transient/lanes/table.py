"""A batch of systems as the table of jobs a lane kernel works through."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from squealbox.schedules import Constant, Schedule, kinks, value_at
from squealbox.system import Contact, System
from squealbox.transient import packing
from squealbox.transient._motion import EXACT
from squealbox.transient.lanes.batch import first_of
from squealbox.transient.lanes.shape import LANES, PARTS, Shape, audit, entries, parameter_rows
from squealbox.transient.latest import Latest
from squealbox.transient.methods import TAYLOR, Method
from squealbox.transient.one_motion import lever, shared_motions
from squealbox.transient.own_laws import law_kinds, own_texts
from squealbox.transient.rows import EquationRows, audited, audited_matrix, consistent, fastest_rate, memories, rows_of
from squealbox.transient.smooth_laws import smooth_kinds
from squealbox.transient.tolerances import absolute_tolerances
from squealbox.transient.widened import RunApart

FEW = 3  # freedoms and contacts up to which a single run shares its kernel with other patterns of zeros
ANGLE = (
    2.0  # of a schedule in a Taylor step: a series of order 16 leaves out 4e-10 of its swing; tolerances see the rest
)


@dataclass(frozen=True)
class Jobs:
    """The table of a batch.

    A row of parameters that differs between jobs is a column of `table` (jobs, columns), one that does not is a number
    in `fixed`; varies[row] is the column or -1. `template` is one system of the batch, `own` the highest angular
    frequency [rad/s] of each.
    """

    shape: Shape
    table: Any
    varies: Any
    fixed: Any
    template: System
    own: Any


def tabulate(
    system: System, method: Method, scheme: int, width: float, start: tuple[Any, Any], duration: float,
    begin: float, watches: tuple[Any, ...], coefficients: tuple[float, ...], samples: bool, recorded: bool = False,
) -> Jobs:  # fmt: skip
    """The jobs of a batched system; leading axes are those of the system or else of the starts, flattened."""
    if any(contact.rigid for contact in system.contacts):
        raise RunApart("a rigid contact has impacts, which lanes do not know: run such systems one by one")
    batch = system.shape or np.shape(start[0])[:-1]
    count = int(np.prod(batch, dtype=int))
    rows, equation, template = EQUATIONS.of(system, recorded, lambda: _prepared(system, recorded))
    found, signals, breaks = equation
    values: dict[str, Any] = dict(found)
    n, m = system.size, len(system.contacts)
    q, qd = start
    q = consistent(system, rows, q, np.asarray(value_at(system.load, begin), dtype=float))
    for k in range(n):
        values[f"start{k}"], values[f"start{n + k}"] = q[..., k], qd[..., k]
    own = _highest_frequency(values, n) if rows.all_have_mass else fastest_rate(system, rows)
    values |= limits(system, method, own, scheme == EXACT and m > 0, duration, start)
    values |= {f"break{k}": instant for k, instant in enumerate(breaks)} | {"width": np.asarray(width)}
    contacts = system.contacts
    kinds = law_kinds(contacts)
    laws = tuple((int(kind), len(c.law.coefficients())) for kind, c in zip(kinds, contacts, strict=True))
    names = entries(n, m) + (audit(n) if recorded else [])
    present = frozenset(name for name in names if name in values and np.any(values[name] != 0.0))
    unilateral = tuple(bool(c.unilateral) for c in system.contacts)
    groups = [] if scheme != EXACT else shared_motions(system)
    for group in groups:
        values |= {f"lever{c}": lever(contacts[c].d, contacts[group[0]].d) for c in group}
    if recorded and rows.all_have_mass and n <= FEW and m <= FEW:
        present = _filled(present, [name for name in names if name in values])
    shape = Shape(
        n,
        m,
        method.tableau,
        scheme,
        laws,
        present,
        unilateral,
        signals,
        watches,
        samples,
        len(breaks),
        own_texts(system.contacts),
        _endless(values, laws) if method.tableau == TAYLOR else (),
        1 if recorded else LANES,
        recorded,
        () if rows.all_have_mass else rows.kinds,
        smooth_kinds(system.contacts) if any(smooth_kinds(system.contacts)) else (),
        memories(system) if max(memories(system), default=-1) >= 0 else (),
        int(getattr(system, "seen", n)),
        tuple(tuple(group) for group in groups),
        tuple(c for c, contact in enumerate(contacts) if without_friction(contact)),
    )
    names = parameter_rows(shape)
    fixed = np.zeros(3 + len(names) + len(coefficients))
    fixed[:3] = begin + duration, begin, method.most_steps
    fixed[3 + len(names) :] = coefficients
    varies = np.full(len(names), -1, dtype=np.int64)
    columns: list[Any] = []
    for row, name in enumerate(names):
        value = np.asarray(values[name], dtype=float)
        if value.ndim == 0 or np.all(value == value.flat[0]):
            fixed[3 + row] = value.flat[0]
        else:
            varies[row] = len(columns)
            columns.append(np.broadcast_to(value, batch).ravel())
    table = np.stack(columns, axis=1) if columns else np.zeros((count, 1))
    return Jobs(shape, np.ascontiguousarray(table), varies, fixed, template, own)


EQUATIONS = Latest(8)  # of systems that are run several times


def _prepared(system: System, recorded: bool) -> tuple[EquationRows, Any, System]:
    """What depends on the system alone."""
    rows = rows_of(system)
    return rows, _equation(system, rows, recorded), first_of(system)


def _equation(system: System, rows: EquationRows, recorded: bool = False) -> tuple[dict[str, Any], Any, list[Any]]:
    """Numbers of the equation by name, kinds of the signals (none when all are constant), and their kinks."""
    n, contacts = system.size, system.contacts
    inverse = rows.inverse
    values: dict[str, Any] = {}

    def put(name: str, matrix: np.ndarray) -> None:
        for i in range(matrix.shape[-2]):
            for j in range(matrix.shape[-1]):
                values[f"{name}{i}_{j}"] = matrix[..., i, j]

    put("mk", rows.stiffness)
    put("mc", rows.damping)
    for c, contact in enumerate(contacts):
        w = np.zeros(n) if contact.normal is None else contact.normal
        columns = {"md": _times(inverse, contact.d), "mw": _times(inverse, w), "d": audited(system, contact.d)}
        columns |= {"t": rows.t[c], "s": rows.s[c], "n": rows.n[c], "w": audited(system, w)}
        for name, vector in columns.items():
            for i in range(n):
                values[f"{name}{c}_{i}"] = np.asarray(vector)[..., i]
        for e, other in enumerate(contacts):
            values[f"g{c}_{e}"] = np.sum(contact.t * _times(inverse, other.d), axis=-1)
        for i, coefficient in enumerate(contact.law.coefficients()):
            values[f"law{c}_{i}"] = np.asarray(coefficient, dtype=float)
        values[f"zero{c}"], values[f"own_g{c}"] = np.asarray(contact.law.mu(0.0), dtype=float), values[f"g{c}_{c}"]
        values[f"slope{c}"] = np.asarray(contact.law.slope_at(0.0), dtype=float)
    signals = [_terms(c.V) for c in contacts] + [_terms(c.N0) for c in contacts]
    load = packing.load_terms(system)
    for c in range(len(contacts)):
        signals[c] += packing.commanded_by_the_load(system, rows, c, load)
        signals[len(contacts) + c] += packing.through_the_load(system, rows, c, load)
    signals += [[(_times(inverse, weight)[..., i], part) for weight, part in load] for i in range(n)]
    if recorded:
        stiffness = audited_matrix(system, system.K)
        put("c", audited_matrix(system, system.C))
        put("ka", 0.5 * (stiffness - np.swapaxes(stiffness, -1, -2)))
        told = [(audited(system, np.asarray(weight)), part) for weight, part in load]
        signals += [[(weight[..., i], part) for weight, part in told] for i in range(n)]
    if all(isinstance(part, Constant) for terms in signals for _, part in terms):
        names = [f"V{c}" for c in range(len(contacts))] + [f"N0{c}" for c in range(len(contacts))]
        names += [f"{name}{i}" for name in ("f", "F") for i in range(n)]
        for name, terms in zip(names, signals, strict=False):
            values[name] = sum(weight * np.asarray(part.coefficients()[0]) for weight, part in terms)
        return values, (), []
    kinds = []
    for index, terms in enumerate(signals):
        kinds.append(tuple((packing.schedule_kind(part), len(part.coefficients())) for _, part in terms))
        for k, (weight, part) in enumerate(terms):
            values[f"weight{index}_{k}"] = np.asarray(weight, dtype=float)
            for i, coefficient in enumerate(part.coefficients()):
                values[f"given{index}_{k}_{i}"] = np.asarray(coefficient, dtype=float)
    return values, tuple(kinds), [np.asarray(t) for t in kinks(part for terms in signals for _, part in terms)]


def _filled(present: frozenset[str], names: list[str]) -> frozenset[str]:
    """The names present and the zeros beside them: the rows of one contact, or a skew stiffness, are there or not."""
    rows = {name.partition("_")[0] for name in present}
    skew = any(row.startswith("ka") for row in rows)

    def there(name: str) -> bool:
        kind = name.rstrip("0123456789_")
        own = name.partition("_")[0] in rows
        return own if kind in ("md", "mw", "d", "t", "n", "w") else skew if kind == "ka" else True

    return frozenset(name for name in names if there(name))


def without_friction(contact: Contact) -> bool:
    """Whether some job's contact has none at all, so its reversals are no events."""
    return contact.law.grip_formula is None and bool(np.any(np.asarray(contact.law.static_limit) == 0.0))


def _terms(value: Any) -> list[tuple[Any, Schedule]]:
    return list(value.terms()) if isinstance(value, Schedule) else [(np.asarray(1.0), Constant(value))]


def limits(
    system: System, method: Method, own: Any, exact: bool, duration: float, start: tuple[Any, Any]
) -> dict[str, Any]:
    """Tolerances and limits of the steps, as `packing` and `simulate` choose them, from each highest frequency."""
    swing = packing.schedule_frequency(system)
    pace = np.maximum(own, swing)
    pace = np.where(pace > 0.0, pace, np.pi / (3.0 * duration))
    out: dict[str, Any] = {"rtol": np.asarray(method.rtol)}
    given = absolute_tolerances(system, method, own, start)
    out |= {f"atol{k}": np.asarray(each) for k, each in enumerate(given)}
    period = 2.0 * np.pi / pace
    seen = period / 6.0 if exact else np.pi / (3.0 * np.maximum(swing, 1e-300)) + 0.0 * period
    largest = np.minimum(duration, seen)
    if method.tableau == TAYLOR:
        longest = np.minimum(PARTS * period / 6.0, ANGLE / np.maximum(swing, 1e-300))
        largest = np.minimum(duration, longest)
    out["largest"] = largest if method.largest_step is None else np.minimum(largest, method.largest_step)
    out["least"], out["window"], out["highest"] = 1e-14 * period, 1e-3 * period, pace
    first = out["largest"] if method.tableau == TAYLOR else 1e-3 * period
    out["first"] = first if method.first_step is None else np.full(np.shape(period), method.first_step)
    return out


def _endless(values: dict[str, Any], laws: tuple[tuple[int, int], ...]) -> tuple[tuple[str, str], ...]:
    """Coefficients of laws that are infinite in the whole ensemble, as text: a bound that is not there."""
    names = [f"law{c}_{i}" for c, (_, count) in enumerate(laws) for i in range(count)]
    found = [
        (name, f"{sign}np.inf") for name in names for sign in ("", "-") if np.all(values[name] == float(f"{sign}inf"))
    ]
    return tuple(found)


def _highest_frequency(values: dict[str, Any], n: int) -> Any:
    """Highest angular frequency [rad/s] of M^-1 K of each job. In closed form for two."""
    if n == 2:
        a, b, c, d = (values[f"mk{i}_{j}"] for i in range(2) for j in range(2))
        half = 0.5 * (a + d)
        root = np.sqrt((half * half - (a * d - b * c)).astype(complex))
        largest = np.maximum(np.abs(half + root), np.abs(half - root))
    else:
        rows = [np.stack(np.broadcast_arrays(*(values[f"mk{i}_{j}"] for j in range(n))), axis=-1) for i in range(n)]
        matrix = np.stack(np.broadcast_arrays(*rows), axis=-2)
        largest = np.max(np.abs(np.linalg.eigvals(matrix)), axis=-1)
    return np.sqrt(largest)


def _times(matrix: np.ndarray, vector: np.ndarray) -> Any:
    return np.einsum("...ij,...j->...i", matrix, np.asarray(vector, dtype=float))

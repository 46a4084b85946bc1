"""A system and a method as the records the compiled march works on.

A record is one element of a structured array: the compiler passes it by its address, and reads its fields like
attributes. The room of each field is a power of two, so that few sizes are ever compiled; the loops run to the counts.
"""

import math
from functools import cache, lru_cache
from typing import Any

import numpy as np

from squealbox.schedules import SCHEDULES, Constant, Schedule, kinks
from squealbox.system import Contact, InvalidSystem, System
from squealbox.transient.methods import TAYLOR, Method, Tableau, tableau
from squealbox.transient.own_laws import law_kinds
from squealbox.transient.rows import (
    WITH_MASS,
    EquationRows,
    audited,
    audited_matrix,
    commanding_load,
    fastest_rate,
    memories,
    rows_of,
    sensed_load,
)
from squealbox.transient.smooth_laws import smooth_kinds
from squealbox.transient.tolerances import absolute_tolerances

UNIT = Constant(1.0)
STAGES, DEGREE = 16, 7  # room in the record of a tableau


def pack(
    system: System, method: Method, scheme: int, width: float, every_step: bool, start: tuple[Any, Any] | None = None
) -> Any:
    """The record of one system; raises `InvalidSystem` for a map of systems or a singular mass matrix.

    Systems are frozen, so the records of the last few are kept for the next run, with its own tolerances.
    """
    kept, highest = _packed(system, scheme, width)
    record = kept.copy()
    record["rtol"], record["every_step"] = method.rtol, every_step
    n, room = system.size, len(record["mk"])
    atol = absolute_tolerances(system, method, np.asarray(highest), start)
    record["atol"][:n], record["atol"][room : room + n] = atol[:n], atol[n:]
    return record


@lru_cache(maxsize=64)
def _packed(system: System, scheme: int, width: float) -> tuple[Any, float]:
    """The record but for tolerances and output, and the highest frequency [rad/s] of the system itself."""
    if system.shape != ():
        raise InvalidSystem(f"the system has leading axes {system.shape}: simulate takes one system at a time")
    n, contacts = system.size, system.contacts
    rows = rows_of(system)
    inverse = rows.inverse
    d, t = _rows([c.d for c in contacts], n), _rows(list(rows.t), n)
    w = _rows([np.zeros(n) if c.normal is None else c.normal for c in contacts], n)
    normal = _rows(
        [c.normal if c.rigid else sensed for c, sensed in zip(contacts, rows.n, strict=True)], n
    )  # of a rigid one -gap = normal . q - gap0
    laws = [np.array(c.law.coefficients(), dtype=float) for c in contacts]
    highest = highest_frequency(rows.stiffness) if rows.all_have_mass else float(fastest_rate(system, rows))
    pace = max(highest, float(schedule_frequency(system)))
    values: dict[str, Any] = {
        "size": n,
        "contacts": len(contacts),
        "mk": rows.stiffness,
        "mc": rows.damping,
        "kind": np.array(rows.kinds, dtype=np.int64),
        "light": not rows.all_have_mass,
        "smooth": np.array(smooth_kinds(contacts), dtype=np.int64),
        "memory": np.array(memories(system), dtype=np.int64),
        "s": _rows(list(rows.s), n),
        "c": audited_matrix(system, system.C),
        "ka": 0.5 * (audited_matrix(system, system.K) - audited_matrix(system, system.K).T),
        "circulatory": np.any(audited_matrix(system, system.K) != audited_matrix(system, system.K).T),
        "md": d @ inverse.T,
        "mw": w @ inverse.T,
        "d": audited(system, d),
        "t": t,
        "n": normal,
        "w": audited(system, w),
        "g": t @ inverse @ d.T,
        "unilateral": np.array([c.unilateral for c in contacts], dtype=np.int64),
        "static": np.array([static_limit(c) for c in contacts], dtype=float),
        "rigid": np.array([c.rigid for c in contacts], dtype=np.int64),
        "rigid_count": sum(c.rigid for c in contacts),
        "restitution": np.array([c.restitution for c in contacts], dtype=float),
        "law_kind": law_kinds(contacts),
        "law_coefficients": _padded(laws),
        **_signals(system, rows),
        "scheme": scheme,
        "smoothing": width,
        "window": 1e-3 * 2.0 * np.pi / pace if pace > 0.0 else np.inf,
    }
    record = _record(_layout(values), values)
    record["atol"][:] = 1.0
    record["kind"][n:], record["memory"][len(contacts) :] = WITH_MASS, -1
    return record, highest


def _layout(values: dict[str, Any]) -> np.dtype[Any]:
    laws, terms = values["law_coefficients"].shape[1], values["term_coefficients"].shape
    rooms = (values["size"], values["contacts"], laws, *terms, len(values["breaks"]))
    least = (2, 2, 16, 32, 8, 8)  # tables of up to four points share the code of the other laws and schedules
    return problem_type(*(_room(count, low) for count, low in zip(rooms, least, strict=True)))


@cache
def problem_type(n: int, m: int, law: int, terms: int, term: int, breaks: int) -> np.dtype[Any]:
    """The layout of a problem with room for n degrees of freedom, m contacts, their coefficients, terms and kinks."""
    integers = ("size", "contacts", "circulatory", "signals", "varying", "break_count", "scheme", "every_step")
    arrays: dict[str, tuple[str, tuple[int, ...]]] = {
        "mk": ("f8", (n, n)), "mc": ("f8", (n, n)), "c": ("f8", (n, n)), "ka": ("f8", (n, n)),
        "md": ("f8", (m, n)), "mw": ("f8", (m, n)), "d": ("f8", (m, n)), "t": ("f8", (m, n)),
        "n": ("f8", (m, n)), "w": ("f8", (m, n)), "g": ("f8", (m, m)),
        "unilateral": ("i8", (m,)), "static": ("f8", (m,)), "law_kind": ("i8", (m,)),
        "kind": ("i8", (n,)), "smooth": ("i8", (m,)), "memory": ("i8", (m,)), "s": ("f8", (m, n)),
        "rigid": ("i8", (m,)), "restitution": ("f8", (m,)),
        "law_coefficients": ("f8", (m, law)), "signal_start": ("i8", (2 * (m + n) + 1,)),
        "term_weight": ("f8", (terms,)), "term_kind": ("i8", (terms,)),
        "term_coefficients": ("f8", (terms, term)), "breaks": ("f8", (breaks,)), "atol": ("f8", (2 * n,)),
    }  # fmt: skip
    return np.dtype(
        [(name, "i8") for name in (*integers, "rigid_count", "light")]
        + [(name, "f8") for name in ("smoothing", "window", "rtol")]
        + [(name, kind, shape) for name, (kind, shape) in arrays.items()]
    )


@cache
def rule(name: str) -> Any:
    """The record of the named tableau; of any for a series, which has none."""
    method: Tableau = tableau("dormand-prince-8" if name == TAYLOR else name)
    kinds = [(key, "i8") for key in ("stages", "dense_stages", "degree", "error_order", "blended")] + [("growth", "f8")]
    kinds += [("a", "f8", (STAGES, STAGES)), ("p", "f8", (STAGES, DEGREE)), ("bernstein", "f8", (5, 5))]  # type: ignore[list-item]
    kinds += [(key, "f8", (STAGES,)) for key in ("b", "c", "e", "e3")]  # type: ignore[misc]
    values = {
        "stages": method.stages,
        "dense_stages": len(method.p),
        "degree": method.p.shape[1],
        "error_order": method.error_order,
        "blended": method.e3 is not None,
        "growth": method.growth,
        "bernstein": bernstein_matrix(),
        **{key: getattr(method, key) for key in ("a", "p", "b", "c", "e")},
        "e3": np.zeros(1) if method.e3 is None else method.e3,
    }
    return _record(np.dtype(kinds), values)


def longer(kept: np.ndarray) -> Any:
    """The same rows with room for three times as many more, which takes no memory before it is written to."""
    out = np.empty((4 * len(kept), *kept.shape[1:]))
    out[: len(kept)] = kept
    return out


def scratch(problem: Any, q: np.ndarray, qd: np.ndarray, time: float, first_step: float) -> Any:
    """The record of working arrays of one march, with the start in place; first_step 0 leaves it to the march."""
    n, m = problem["atol"].shape[0] // 2, problem["static"].shape[0]
    width = 2 * n + m + 5
    floats: dict[str, tuple[int, ...]] = {
        "signal": (2 * (m + n) + m,), "normal": (m,), "speed": (m,), "force": (m,), "right": (2 * m,),
        "matrix": (2 * m, 2 * m), "whole": (2 * m, 2 * m), "basis": (2 * m + 1, 2 * m), "before": (n,),
        "share": (m,), "bias": (m,), "leave": (m,), "lowest": (m,), "fastest": (m,), "creep": (m,),
        "weight": (2 * m,), "wanted": (2 * m,), "multiplier": (2 * m,), "terms": (2 * m,),
        "state": (width,), "state_new": (width,), "y": (width,), "y_dense": (width,), "dy": (width,),
        "stage": (STAGES, width), "phi": (2 * m,), "phi0": (2 * m,), "phi1": (2 * m,), "nodes": (5, 2 * m),
        "stack": (128, 7), "clock": (7,),
        "mu": (m,), "size": (m,), "rebound": (m,), "approach": (m,), "poly": (DEGREE + 1,),
    }  # fmt: skip
    names = (
        "stuck",
        "mode",
        "old",
        "forced",
        "at_zero",
        "fresh",
        "chosen",
        "touch",
        "leaving",
        "hit",
        "noisy",
        "idle",
        "slack",
    )
    integers = dict.fromkeys(names, m) | {"spare": 1, "row_contact": 2 * m, "row_kind": 2 * m, "count": 11}
    kinds = tuple((name, "f8", shape) for name, shape in floats.items())
    kinds += tuple((name, "i8", (size,)) for name, size in integers.items())
    state = np.zeros(2 * n)
    state[: len(q)], state[n : n + len(qd)] = q, qd
    lowest = np.full(m, np.inf)
    return _record(
        _dtype(kinds),
        {
            "state": state,
            "lowest": lowest,
            "bias": np.ones(m),
            "clock": np.array([time, first_step, 0.0, 0.0, time, np.inf, 0.0]),
        },
    )


def row_width(problem: Any) -> int:
    """Columns of an output row: t, the state with its energy integrals, then N, v, force and mode of each contact."""
    return int(6 + 2 * problem["size"] + 5 * problem["contacts"])


def highest_frequency(stiffness: np.ndarray) -> float:
    """Highest angular frequency [rad/s] of M^-1 K, without friction."""
    return float(np.sqrt(np.max(np.abs(np.linalg.eigvals(stiffness)), initial=0.0)))


def schedule_frequency(system: System) -> Any:
    """Highest angular frequency [rad/s] of what moves by itself, V(t), N0(t) and f(t); 0 when nothing swings."""
    fastest = np.zeros(())
    for value in (system.load, *(each for c in system.contacts for each in (c.V, c.N0))):
        if isinstance(value, Schedule):
            fastest = np.maximum(fastest, value.angular_frequency())
    return fastest


def static_limit(contact: Contact) -> Any:
    """The static limit of a contact's law; 0 of one that has no direction to stick along, and of a smooth law."""
    sticks = np.any(contact.t) and np.any(contact.d) and contact.law.grip_formula is None
    return contact.law.static_limit if sticks else 0.0


def schedule_kind(part: Schedule) -> int:
    """The number of a schedule in the compiled code."""
    if type(part) not in SCHEDULES:
        known = ", ".join(kind.__name__ for kind in SCHEDULES)
        raise InvalidSystem(
            f"schedule {type(part).__name__}(...): expected one that can be compiled, sums and products of {known}"
        )
    return SCHEDULES.index(type(part))


def bernstein_matrix() -> Any:
    """Bernstein coefficients of the quartic through values at 0, 1/4, 1/2, 3/4, 1, shape (5, 5)."""
    nodes = np.arange(5) / 4.0
    values = np.array([[math.comb(4, k) * x**k * (1.0 - x) ** (4 - k) for k in range(5)] for x in nodes])
    return np.linalg.inv(values)


@cache
def _dtype(fields: tuple[Any, ...]) -> np.dtype[Any]:
    return np.dtype(list(fields))


def _record(kind: np.dtype[Any], values: dict[str, Any]) -> Any:
    """One element of a structured array; an array shorter than its room fills the front of it."""
    record = np.zeros(1, dtype=kind)[0]
    for name, value in values.items():
        room = record[name]
        if np.ndim(room) == 0:
            record[name] = value
        else:
            room[tuple(slice(0, size) for size in np.shape(value))] = value
    return record


def _room(count: int, least: int = 2) -> int:
    """The next power of two."""
    return max(least, 1 << (int(count) - 1).bit_length())


def _signals(system: System, rows: EquationRows) -> dict[str, Any]:
    """The varying quantities V, N0, M^-1 f and f, each a sum of weighted schedules: term k belongs to signal i for
    signal_start[i] <= k < signal_start[i + 1].
    """
    n, contacts = system.size, system.contacts
    load = load_terms(system)
    inverse = rows.inverse
    lists = [_terms(c.V) for c in contacts] + [_terms(-c.gap if c.rigid else c.N0) for c in contacts]
    for c in range(len(contacts)):
        lists[c] += commanded_by_the_load(system, rows, c, load)
        lists[len(contacts) + c] += through_the_load(system, rows, c, load)
    spare: list[list[Any]] = [[] for _ in range(_room(n) - n)]  # the march counts loads by the room, not by the size
    lists += [[((inverse @ weight)[i], part) for weight, part in load] for i in range(n)] + spare
    lists += [[(audited(system, weight)[i], part) for weight, part in load] for i in range(n)] + spare
    terms = [term for group in lists for term in group]
    kinds = np.array([schedule_kind(part) for _, part in terms], dtype=np.int64)
    coefficients = [np.array(part.coefficients(), dtype=float).ravel() for _, part in terms]
    breaks = kinks(part for _, part in terms)
    return {
        "signals": len(lists),
        "signal_start": _starts(lists),
        "term_weight": np.array([float(weight) for weight, _ in terms]),
        "term_kind": kinds,
        "term_coefficients": _padded(coefficients),
        "varying": np.any(kinds != 0),
        "break_count": len(breaks),
        "breaks": np.array(breaks, dtype=float),
    }


def through_the_load(
    system: System, rows: EquationRows, c: int, load: list[tuple[Any, Schedule]]
) -> list[tuple[Any, Any]]:
    """What the load adds to the normal force of contact c through rows with neither mass nor damping."""
    row = sensed_load(system, rows, c)
    return [] if row is None else [(np.sum(row * weight, axis=-1), part) for weight, part in load]


def commanded_by_the_load(
    system: System, rows: EquationRows, c: int, load: list[tuple[Any, Schedule]]
) -> list[tuple[Any, Any]]:
    """What the load adds to the speed of a smooth contact that senses a row of first order."""
    row = commanding_load(system, rows, c)
    return [] if row is None else [(-np.sum(row * weight, axis=-1), part) for weight, part in load]


def load_terms(system: System) -> list[tuple[Any, Schedule]]:
    """The load as vectors (..., n), each times a simple schedule."""
    if not isinstance(system.load, Schedule):
        return [(np.asarray(system.load), UNIT)]
    terms = []
    for weight, part in system.load.terms():
        schedule_kind(part)
        if np.ndim(part.coefficients()[0]) != 0:
            raise InvalidSystem("load: write a vector load as a schedule times a vector, such as Ramp(...) * [1, 0]")
        terms.append((np.broadcast_to(np.asarray(weight, dtype=float), (system.size,)), part))
    return terms


def _terms(value: Any) -> list[tuple[Any, Schedule]]:
    """A number or a schedule as weights of simple schedules."""
    return list(value.terms()) if isinstance(value, Schedule) else [(value, UNIT)]


def inverse_mass(mass: np.ndarray) -> Any:
    """M^-1, shape (..., n, n); raises `InvalidSystem` where M is singular to working precision."""
    try:
        inverse = np.linalg.inv(mass)
    except np.linalg.LinAlgError:
        inverse = np.full_like(mass, np.inf)
    size = np.max(np.abs(mass), axis=(-1, -2)) * np.max(np.abs(inverse), axis=(-1, -2))
    if not np.all(size < 1e14):
        raise InvalidSystem("M is singular: a transient needs a mass for every degree of freedom")
    return inverse


def _rows(vectors: list[Any], n: int) -> Any:
    return np.array(vectors, dtype=float).reshape(len(vectors), n)


def _starts(groups: list[Any]) -> Any:
    return np.concatenate([[0], np.cumsum([len(group) for group in groups])]).astype(np.int64)


def _padded(rows: list[Any]) -> Any:
    table = np.zeros((len(rows), max((len(row) for row in rows), default=1)))
    for i, row in enumerate(rows):
        table[i, : len(row)] = row
    return table

"""Rows without mass in time: which rows of a system are of first order or algebraic, and the equation solved for them.

A row with a damper but no mass gives its own velocity, a row with neither its own displacement. With S = M, whose
columns of such rows are replaced by those of C and of K,

    S x = f + sum_c d_c F_c - K q - C q'        x = (q'' | q' | q) of the rows with mass, of first order, algebraic

where K and C leave out the columns that S has taken: one linear solution, whatever the kinds of the rows. What a
contact senses of an algebraic row is put through the same solution. `System`s with a full singular M come here in
other coordinates (`coordinates`). Depends on: system, schedules.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from squealbox.memory_rows import remembering
from squealbox.schedules import Constant, Schedule, value_at
from squealbox.system import InvalidSystem, System
from squealbox.transient.latest import Latest

KEPT = Latest(16)
WITH_MASS, FIRST_ORDER, ALGEBRAIC = 2, 1, 0  # how often a row's displacement is differentiated


@dataclass(frozen=True)
class EquationRows:
    """The equation of a system solved for x.

    kinds (n,) of the rows; inverse, S^-1 (..., n, n); stiffness and damping, S^-1 K and S^-1 C without the columns that
    x holds; n and t of each contact (..., n) as they sense what the motion remembers, v = V - t.q' - s.q.
    """

    kinds: tuple[int, ...]
    inverse: Any
    stiffness: Any
    damping: Any
    n: tuple[Any, ...]
    t: tuple[Any, ...]
    s: tuple[Any, ...]

    @cached_property
    def all_have_mass(self) -> bool:
        """True for the usual system."""
        return all(kind == WITH_MASS for kind in self.kinds)

    def of(self, *kinds: int) -> list[int]:
        """The rows of these kinds."""
        return [i for i, kind in enumerate(self.kinds) if kind in kinds]


def row_kinds(system: System) -> tuple[int, ...]:
    """The kind of each row: what M and C hold in any entry of the batch, in the row and in the column."""

    def used(matrix: np.ndarray, axis: int) -> Any:
        found = np.any(matrix != 0.0, axis=axis)
        return np.any(found.reshape(-1, found.shape[-1]), axis=0)

    heavy, damped = used(system.M, -1), used(system.C, -2)
    return tuple(WITH_MASS if m else FIRST_ORDER if c else ALGEBRAIC for m, c in zip(heavy, damped, strict=True))


def rows_of(system: System) -> EquationRows:
    """The rows of a system; `InvalidSystem` in one sentence where they determine no motion."""

    def shared() -> EquationRows:
        made = _rows_of(system)
        for array in (made.inverse, made.stiffness, made.damping):
            array.flags.writeable = False
        return made

    found: EquationRows = KEPT.of(system, (), shared)
    return found


def _rows_of(system: System) -> EquationRows:
    kinds = row_kinds(system)
    inverse = solved_for(system, kinds)
    stiffness, damping = inverse @ system.K, inverse @ system.C
    sensed, along = (tuple(getattr(contact, name) for contact in system.contacts) for name in ("n", "t"))
    if all(kind == WITH_MASS for kind in kinds):
        return EquationRows(kinds, inverse, stiffness, damping, sensed, along, tuple(0.0 * t for t in along))
    first, algebraic = ([i for i, kind in enumerate(kinds) if kind == which] for which in (FIRST_ORDER, ALGEBRAIC))
    stiffness, damping = np.array(stiffness), np.array(damping)
    stiffness[..., :, algebraic] = 0.0
    damping[..., :, [*first, *algebraic]] = 0.0
    _check_contacts(system, kinds, inverse, damping)
    slides, commands = [], []
    for t in along:  # a row of first order sensed by a smooth contact: its velocity is -(mk q + mc q')
        rates = np.array(t)
        rates[..., [i for i, kind in enumerate(kinds) if kind == WITH_MASS]] = 0.0
        slides.append(t - rates - np.einsum("...i,...ij->...j", rates, damping))
        commands.append(-np.einsum("...i,...ij->...j", rates, stiffness))
    reached = tuple(_through(n, stiffness, algebraic) for n in sensed)
    return EquationRows(kinds, inverse, stiffness, damping, reached, tuple(slides), tuple(commands))


def solved_for(system: System, kinds: tuple[int, ...]) -> Any:
    """S^-1, shape (..., n, n)."""
    shape = np.broadcast_shapes(*(x.shape for x in (system.M, *((system.C, system.K) if min(kinds) < 2 else ()))))
    matrix = np.array(np.broadcast_to(system.M, shape))
    for i, kind in enumerate(kinds):
        if kind != WITH_MASS:
            matrix[..., :, i] = (system.C if kind == FIRST_ORDER else system.K)[..., :, i]
    level = np.ones(1) if min(kinds) == WITH_MASS else _levels(matrix)
    scaled = matrix * level[..., None, :]
    rows = np.ones(1) if min(kinds) == WITH_MASS else _levels(np.swapaxes(scaled, -1, -2))
    scaled = scaled * rows[..., :, None]
    try:
        inverse = np.linalg.inv(scaled)
    except np.linalg.LinAlgError:
        inverse = np.full_like(scaled, np.inf)
    size = np.max(np.abs(scaled), axis=(-1, -2)) * np.max(np.abs(inverse), axis=(-1, -2))
    if not np.all(size < 1e14):
        raise InvalidSystem(
            "M is singular and damping and stiffness do not determine the motion without mass: expected a mass, "
            f"a damper or a spring for every motion of {', '.join(system.names)}"
        )
    return inverse * level[..., :, None] * rows[..., None, :]


def _levels(matrix: np.ndarray) -> Any:
    """Factors that bring the largest entry of each column to 1."""
    size = np.max(np.abs(matrix), axis=-2)
    return 1.0 / np.where(size > 0.0, size, 1.0)


def _check_contacts(system: System, kinds: tuple[int, ...], inverse: np.ndarray, damping: np.ndarray) -> None:
    """What the laws of the contacts, solved for accelerations, cannot do on rows without them."""
    light = [i for i, kind in enumerate(kinds) if kind != WITH_MASS]
    algebraic = [i for i, kind in enumerate(kinds) if kind == ALGEBRAIC]
    names = system.names
    for c, contact in enumerate(system.contacts):
        label = f"contacts[{c}]" + (f" ({contact.name})" if contact.name else "")
        for i in light:
            smooth = contact.law.grip_formula is not None and kinds[i] == FIRST_ORDER
            free = smooth and not any(np.any(_solved(inverse, each.d)[..., i]) for each in system.contacts)
            if np.any(contact.t[..., i]) and not free:
                raise InvalidSystem(
                    f"{label} slides on {names[i]!r}, a row without mass: its speed would jump with its own friction; "
                    "expected t on rows with mass"
                )
        if contact.rigid and np.any(contact.normal[..., light]):
            raise InvalidSystem(f"{label} is rigid and touches a row without mass: an impact there has no inertia")
        acts = _solved(inverse, contact.d)
        lifts = None if contact.normal is None else _solved(inverse, contact.normal)
        for i in algebraic:
            if np.any(np.abs(acts[..., i]) > 1e-12 * np.max(np.abs(acts))):
                raise InvalidSystem(
                    f"{label} acts on {names[i]!r}, a row with neither mass nor damping, which would jump with its "
                    "friction; expected d on other rows"
                )
            if lifts is not None and np.any(np.abs(lifts[..., i]) > 1e-12 * np.max(np.abs(lifts))):
                raise InvalidSystem(
                    f"{label} opens on {names[i]!r}, a row with neither mass nor damping; expected normal on other rows"
                )
    if algebraic and isinstance(system.load, Schedule):
        for weight, part in system.load.terms():
            moved = np.einsum("...ij,...j->...i", inverse, np.asarray(weight, dtype=float))
            if not isinstance(part, Constant) and np.any(moved[..., algebraic] != 0.0):
                raise InvalidSystem(
                    f"a load varies in time on {names[algebraic[0]]!r}, a row with neither mass nor damping; "
                    "expected a constant load there"
                )
    if algebraic and np.any(damping[..., algebraic, :] != 0.0):
        raise InvalidSystem(
            f"{names[algebraic[0]]!r} has neither mass nor damping of its own, and yet feels a velocity: "
            "expected a mass or a damper on it"
        )


def _solved(inverse: np.ndarray, vector: np.ndarray) -> Any:
    return np.einsum("...ij,...j->...i", inverse, vector)


def _through(n: np.ndarray, stiffness: np.ndarray, algebraic: list[int]) -> Any:
    """A row that senses algebraic rows, as it senses the others through them."""
    if not algebraic or not np.any(n[..., algebraic]):
        return n
    direct = np.array(n)
    direct[..., algebraic] = 0.0
    return direct - np.einsum("...i,...ij->...j", n[..., algebraic], stiffness[..., algebraic, :])


def sensed_load(system: System, rows: EquationRows, c: int) -> Any:
    """What the load adds to the normal force of contact c through algebraic rows: a vector (..., n), or None."""
    algebraic = rows.of(ALGEBRAIC)
    sensed = system.contacts[c].n
    if not algebraic or not np.any(sensed[..., algebraic]):
        return None
    return np.einsum("...i,...ij->...j", sensed[..., algebraic], rows.inverse[..., algebraic, :])


def commanding_load(system: System, rows: EquationRows, c: int) -> Any:
    """What the load does to the speed of a contact that senses rows of first order: a vector (..., n), or None."""
    first = rows.of(FIRST_ORDER)
    along = system.contacts[c].t
    if not first or not np.any(along[..., first]):
        return None
    return np.einsum("...i,...ij->...j", along[..., first], rows.inverse[..., first, :])


def memories(system: System) -> tuple[int, ...]:
    """The row in which each contact's law keeps its memory, -1 without."""
    kept: tuple[int, ...] = getattr(system, "memories", ())
    return kept or (-1,) * len(system.contacts)


def audited(system: System, vectors: np.ndarray) -> Any:
    """Vectors (..., n) without the rows that the energy audit leaves out."""
    left_out = list(getattr(system, "unaudited", ()))
    if not left_out:
        return vectors
    out = np.array(vectors)
    out[..., left_out] = 0.0
    return out


def audited_matrix(system: System, matrix: np.ndarray) -> Any:
    """A matrix (..., n, n) without those rows and columns."""
    return np.swapaxes(audited(system, np.swapaxes(audited(system, matrix), -1, -2)), -1, -2)


def consistent(system: System, rows: EquationRows, q: np.ndarray, load: np.ndarray) -> Any:
    """The start q (..., n) with the algebraic rows where the others and the load [N] put them."""
    algebraic = rows.of(ALGEBRAIC)
    if not algebraic:
        return q
    value = np.einsum("...ij,...j->...i", rows.inverse, load) - np.einsum("...ij,...j->...i", rows.stiffness, q)
    shape = np.broadcast_shapes(q.shape, value.shape)
    out = np.array(np.broadcast_to(q, shape))
    out[..., algebraic] = np.broadcast_to(value, shape)[..., algebraic]
    return out


def fastest_rate(system: System, rows: EquationRows) -> Any:
    """Largest |eigenvalue| [1/s] of the equation without friction, (...): what a step must resolve.

    Contacts with memory hold with the stiffness of their bristles under the normal force of the system at rest.
    """
    held = rows.stiffness
    for c in remembering(system.contacts):
        contact = system.contacts[c]
        force = np.abs(value_at(contact.N0, 0.0)) + np.abs(np.sum(rows.n[c] * _at_rest(system), axis=-1))
        spring = force * contact.law.grip[0]
        push = _solved(rows.inverse, contact.d)[..., :, None] * rows.t[c][..., None, :]
        held = held + np.asarray(spring)[..., None, None] * push
    n, heavy, first = len(rows.kinds), rows.of(WITH_MASS), rows.of(FIRST_ORDER)
    matrix = np.zeros((*held.shape[:-2], 2 * n, 2 * n))
    speeds = [n + i for i in heavy]
    matrix[..., heavy, speeds] = 1.0
    for i in (*heavy, *first):
        at = n + i if i in heavy else i
        matrix[..., at, :n], matrix[..., at, n:] = -held[..., i, :], -rows.damping[..., i, :]
    keep = [*heavy, *first, *speeds]
    matrix = matrix[..., keep, :][..., :, keep]
    unit = np.sqrt(np.max(np.abs(held[..., heavy, :]), axis=(-1, -2), initial=0.0))
    unit = np.where(unit > 0.0, unit, 1.0)[..., None]
    level = np.ones((*matrix.shape[:-2], len(keep)))
    level[..., len(keep) - len(heavy) :] = unit
    scaled = matrix * level[..., None, :] / level[..., :, None]
    return np.max(np.abs(np.linalg.eigvals(scaled)), axis=-1, initial=0.0)


def _at_rest(system: System) -> Any:
    """K^-1 f at the start, 0 where there is none."""
    load = np.asarray(value_at(system.load, 0.0), dtype=float)
    with np.errstate(all="ignore"):
        q = np.einsum("...ij,...j->...i", np.linalg.pinv(system.K), load)
    return np.where(np.isfinite(q), q, 0.0)

"""Contacts that hold one motion together: which they are, and whether they share its force by limits that vary."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from squealbox.schedules import Schedule
from squealbox.system import Contact, System
from squealbox.transient._motion import OPEN, STICK
from squealbox.transient._sharing import RISES
from squealbox.transient.rows import rows_of

TINY, CLEAR = 1e-300, 1e-9  # stands for zero; more than round-off
PARALLEL = 1e-12  # share of a row by which it may leave the direction of another


def shared_motions(system: System) -> list[list[int]]:
    """Groups of contacts that sense one direction and act along one, where limits vary within a step."""
    found = [group for group in _alike(system) if len(group) > 1]
    return [group for group in found if any(_limit_varies(system.contacts[c]) for c in group)]


def shares_vary(system: System) -> bool:
    """Whether contacts that depend on each other otherwise share their force by limits that vary: a step cannot."""
    groups = _alike(system)
    rows = np.array([system.contacts[group[0]].t for group in groups], dtype=float).reshape(-1, system.size)
    if len(rows) < 2 or np.linalg.matrix_rank(rows) == len(rows):
        return False
    return any(_limit_varies(system.contacts[c]) for group in groups for c in group)


def lever(row: ArrayLike, first: ArrayLike) -> Any:
    """By how much a row is longer than another along which it lies."""
    row, first = np.asarray(row, dtype=float), np.asarray(first, dtype=float)
    return np.sum(row * first, axis=-1) / np.sum(first * first, axis=-1)


def _alike(system: System) -> list[list[int]]:
    """Contacts that can stick, those on one motion together."""
    groups: list[list[int]] = []
    for c, contact in enumerate(system.contacts):
        if not (np.any(contact.t) and np.any(contact.d)) or contact.law.grip_formula is not None:
            continue
        known = next((group for group in groups if _same_motion(contact, system.contacts[group[0]])), None)
        if known is None:
            groups.append([c])
        else:
            known.append(c)
    return groups


def _same_motion(one: Contact, other: Contact) -> bool:
    parallel = _along(one.t, other.t) and _along(one.d, other.d)
    return parallel and bool(np.all(lever(one.t, other.t) * lever(one.d, other.d) > 0.0))


def _along(row: ArrayLike, first: ArrayLike) -> bool:
    """Whether two rows lie along one direction throughout a batch."""
    row, size = np.asarray(row, dtype=float), np.sum(np.square(first), axis=-1)
    if not np.all(size > 0.0):
        return False
    rest = row - np.asarray(lever(row, first))[..., None] * first
    return bool(np.all(np.abs(rest) <= PARALLEL * np.max(np.abs(row), axis=-1, keepdims=True)))


def _limit_varies(contact: Contact) -> bool:
    """Whether the static limit of a contact changes without an event."""
    return bool(np.any(contact.n)) or isinstance(contact.N0, Schedule)


SHARED = (
    "friction that sticks holds the motion that {name} stops, and their laws leave open how they share its force, on "
    "which the sliding of {name} depends: taken here is that what is closed carries what it can"
)


def undetermined(system: System, rows: np.ndarray, events: np.ndarray) -> tuple[str, ...]:
    """A sentence for each rigid contact whose sliding the laws of the contacts left open along a run.

    Forces x of closed and of sticking contacts with A x = 0 change no motion that is held. Where they change another
    one all the same, it is that of a rigid contact that slides with a normal force out of x. `rows` of output end with
    the modes of the contacts; `events` tell the instant, the contact and its new mode.
    """
    m = len(system.contacts)
    if not any(contact.rigid for contact in system.contacts) or len(rows) == 0:
        return ()
    modes, mode = [rows[:, -m:]], np.array(rows[0, -m:])
    for time, c, new in events:
        if time > rows[0, 0]:
            mode[int(c)] = new
            modes.append(mode[None].copy())
    found = [_left_open(system, each) for each in np.unique(np.concatenate(modes), axis=0)]
    return tuple(SHARED.format(name=system.contact_names[c]) for c in sorted(set().union(*found)))


def _left_open(system: System, mode: np.ndarray) -> set[int]:
    """The rigid contacts whose sliding is left open in one set of modes."""
    contacts = system.contacts
    closed = [c for c in range(len(contacts)) if contacts[c].rigid and mode[c] != OPEN]
    held = [c for c in range(len(contacts)) if mode[c] == STICK and contacts[c].law.static_limit > RISES]
    if not any(mode[c] != STICK for c in closed):
        return set()
    rows = np.array([*(contacts[c].normal for c in closed), *(contacts[c].t for c in held)])
    pushes = [mode[c] * contacts[c].law.static_limit * contacts[c].d - contacts[c].normal for c in closed]
    columns = rows_of(system).inverse @ np.array([*pushes, *(contacts[c].d for c in held)]).T
    columns = columns / np.maximum(np.linalg.norm(columns, axis=0), TINY)
    _, size, null = np.linalg.svd(rows / np.maximum(np.linalg.norm(rows, axis=1), TINY)[:, None] @ columns)
    free = null[int(np.sum(size > CLEAR * size[0])) :]
    loose = free[np.linalg.norm(free @ columns.T, axis=1) > CLEAR]
    return {c for i, c in enumerate(closed) if mode[c] != STICK and np.any(np.abs(loose[:, i]) > CLEAR)}

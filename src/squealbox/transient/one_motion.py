"""Contacts that hold one motion together: which they are, and whether they share its force by limits that vary."""

from typing import Any

import numpy as np

from squealbox.schedules import Schedule
from squealbox.system import Contact, System

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


def lever(row: Any, first: Any) -> Any:
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


def _along(row: Any, first: Any) -> bool:
    """Whether two rows lie along one direction throughout a batch."""
    row, size = np.asarray(row, dtype=float), np.sum(np.square(first), axis=-1)
    if not np.all(size > 0.0):
        return False
    rest = row - np.asarray(lever(row, first))[..., None] * first
    return bool(np.all(np.abs(rest) <= PARALLEL * np.max(np.abs(row), axis=-1, keepdims=True)))


def _limit_varies(contact: Contact) -> bool:
    """Whether the static limit of a contact changes without an event."""
    return bool(np.any(contact.n)) or isinstance(contact.N0, Schedule)

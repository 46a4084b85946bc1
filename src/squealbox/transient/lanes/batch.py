"""Batches of systems: many stacked into one with leading axes, and one out of many."""

import dataclasses
from collections.abc import Sequence
from typing import Any

import numpy as np

from squealbox.members import member
from squealbox.system import System, as_system
from squealbox.transient.limited import in_time
from squealbox.transient.widened import RunApart, Widened, base_of


def stacked(designs: Sequence[Any]) -> System:
    """Systems of the same structure as one with a leading axis; `RunApart` names one that differs."""
    systems = [in_time(as_system(each)) for each in designs]
    whole = _joined(systems)
    if isinstance(whole, Widened):
        if any(not np.array_equal(each.embedding, whole.embedding) for each in systems[1:]):  # type: ignore[attr-defined]
            raise RunApart("designs of a sequence have singular mass matrices that differ: run them apart")
        whole = whole.replace(base=_joined([base_of(each) for each in systems]))
    return whole


def _joined(systems: list[System]) -> System:
    first = systems[0]
    for i, other in enumerate(systems):
        alike = type(other) is type(first) and other.size == first.size and len(other.contacts) == len(first.contacts)
        kinds = [(type(c.law), c.unilateral, type(c.V), type(c.N0)) for c in other.contacts]
        if other.shape != () or not alike or kinds != [
            (type(c.law), c.unilateral, type(c.V), type(c.N0)) for c in first.contacts
        ]:  # fmt: skip
            raise RunApart(f"design {i} of the sequence has another structure than the first: run them apart")
    plain = {name: np.stack([getattr(s, name) for s in systems]) for name in ("M", "C", "K")}
    contacts = []
    for c, contact in enumerate(first.contacts):
        given: dict[str, Any] = {}
        for name in ("n", "d", "t", "normal", "N0", "V"):
            values = [getattr(s.contacts[c], name) for s in systems]
            given[name] = np.stack(values) if isinstance(values[0], np.ndarray) else _same(values, name)
        laws = [s.contacts[c].law for s in systems]
        given["law"] = _stacked_law(laws)
        contacts.append(contact.replace(given))
    loads = [s.load for s in systems]
    load = np.stack(loads) if isinstance(loads[0], np.ndarray) else _same(loads, "load")
    return first.replace({**plain, "load": load, "contacts": tuple(contacts)})


def _same(values: list[Any], name: str) -> Any:
    if any(value != values[0] for value in values):
        raise RunApart(f"{name}: schedules in a sequence of designs must be the same: run them apart")
    return values[0]


def _stacked_law(laws: list[Any]) -> Any:
    first = laws[0]
    if all(law == first for law in laws):
        return first
    fields = {each.name: [getattr(law, each.name) for law in laws] for each in dataclasses.fields(first)}
    fields = {name: values for name, values in fields.items() if any(value != values[0] for value in values)}
    if any(not isinstance(value, (int, float)) for values in fields.values() for value in values):
        raise RunApart("friction laws of a sequence may differ in numbers that all of them set: run them apart")
    return first.replace({name: np.array(values, dtype=float) for name, values in fields.items()})


def first_of(system: System) -> System:
    """The first system of a batch."""
    return member(system, 0)

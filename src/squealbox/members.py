"""One system of a batch with leading axes."""

import dataclasses
from typing import Any

import numpy as np

from squealbox import friction, schedules
from squealbox.parameters import DataSheet
from squealbox.schedules import Sum

POINTS = (friction.Table, schedules.Table, schedules.Polynomial)


def member(system: Any, i: int) -> Any:
    """System i of a batch, counted along its leading axes."""
    if system.shape == ():
        return system
    cut = _Cut(system.shape, i)
    plain = {name: cut(getattr(system, name), 2) for name in ("M", "C", "K")}
    plain["load"] = cut(system.load, 1)
    contacts = []
    for contact in system.contacts:
        given = {name: cut(getattr(contact, name), 1) for name in ("n", "d", "t", "normal")}
        given |= {name: cut(getattr(contact, name), 0) for name in ("N0", "V", "law")}
        contacts.append(contact.replace(given))
    loops = tuple(cut(loop, 0) for loop in system.loops)
    return system.replace({**plain, "contacts": tuple(contacts), "loops": loops})


@dataclasses.dataclass(frozen=True)
class _Cut:
    """Entry i along leading axes of an array, or of every number of a law, schedule or loop."""

    shape: tuple[int, ...]
    i: int

    def __call__(self, value: Any, tail: int) -> Any:
        if value is None or isinstance(value, (bool, str)):
            return value
        if isinstance(value, DataSheet):
            own = {each.name: getattr(value, each.name) for each in dataclasses.fields(value)}  # type: ignore[arg-type]
            if isinstance(value, Sum):
                return Sum(tuple((self(w, tail), self(part, 0)) for w, part in own["parts"]))
            if isinstance(value, POINTS):  # its arrays are points or weights, not leading axes
                return value
            changed = {
                name: self(x, 0)
                for name, x in own.items()
                if isinstance(x, DataSheet) or (isinstance(x, np.ndarray) and x.ndim > 0)
            }
            return value.replace(changed) if changed else value
        array = np.asarray(value)
        if array.ndim <= tail:
            return array
        last = array.shape[array.ndim - tail :]
        return np.broadcast_to(array, (*self.shape, *last)).reshape((-1, *last))[self.i]

"""What every countermeasure is: a design that holds a design, and writes more rows beside its own.

`replace({"brake.friction.static": 0.4})` reaches into the brake that is held; a name the countermeasure does not have
is looked for in it too, so "friction.static" names the same parameter through any number of countermeasures, and every
analysis that varies it works unchanged.
"""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike

from squealbox.design import Design
from squealbox.loops import padded_load
from squealbox.parameters import Choice, Parameter, ParameterError, known_names
from squealbox.system import Contact, System


class Titled:
    """What a countermeasure is called: the kind by its own words, one on a brake by the brake's first."""

    def __init__(self, words: str) -> None:
        self.words = words

    def __get__(self, made: Any, kind: object = None) -> str:
        return self.words if made is None else f"{made.brake.title}, {self.words[:1].lower()}{self.words[1:]}"


class Countermeasure(Design):
    """A design that holds a design: `brake` with one thing done to it.

    Its `system()` is that of the brake with rows added or changed; countermeasures nest in any order.
    """

    brake: Design

    def __init_subclass__(cls, **keywords: Any) -> None:
        super().__init_subclass__(**keywords)
        if isinstance(words := cls.__dict__.get("title"), str):
            cls.title = Titled(words)  # type: ignore[assignment]

    def __post_init__(self) -> None:
        super().__post_init__()
        if not isinstance(self.brake, Design):
            raise ParameterError(type(self).__name__, "brake", self.brake, "a design, such as DrumBrake()")

    def replace(self, changes: Mapping[str, Any] | None = None, **keywords: Any) -> Self:
        """A copy with other values; names that the countermeasure does not have are the brake's."""
        own = {*self.field_names(), *self.aliases}
        given = {**(changes or {}), **keywords}
        return super().replace(
            {name if name.partition(".")[0] in own else f"brake.{name}": given[name] for name in given}
        )

    def value_of(self, path: str) -> Any:
        """The value behind a dotted name, the countermeasure's own or the brake's."""
        own = path.partition(".")[0] in {*self.field_names(), *self.aliases}
        return super().value_of(path) if own else self.brake.value_of(path)

    def usual(self, path: str) -> Any:
        own = path.partition(".")[0] in {*self.field_names(), *self.aliases}
        return super().usual(path) if own else self.brake.usual(path)

    def unit_of(self, path: str) -> str:
        """The unit of a dotted name, the countermeasure's own or the brake's."""
        return super().unit_of(path) or self.brake.unit_of(path)

    def leaves(self, prefix: str = "") -> Iterator[tuple[str, Parameter, Any]]:
        """Every declared parameter, those of the brake under their own names as long as these mean the same."""
        for name, about, value in super().leaves():
            yield prefix + short_name(self, name), about, value

    def scalar(self, name: str) -> Parameter:
        return super().scalar(short_name(self, name))

    def words(self) -> dict[str, Choice]:
        return {**self.brake.words(), **self.choices()}

    def cautions(self) -> tuple[str, ...]:
        """Where what is done to the brake may make it worse, in sentences."""
        return self.brake.cautions() if isinstance(self.brake, Countermeasure) else ()

    @property
    def innermost(self) -> Design:
        """The brake itself, without any countermeasure."""
        return self.brake.innermost

    @property
    def layers(self) -> tuple["Countermeasure", ...]:
        """Itself, and those around the brake it holds."""
        return (self, *self.brake.layers)


def short_name(design: Design, path: str) -> str:
    """A dotted name without the countermeasures in front of it, as long as it then still means the same.

    >>> from squealbox import AddedMass, DrumBrake
    >>> short_name(AddedMass(DrumBrake(), "x", 0.1), "brake.friction.static")
    'friction.static'
    """
    held, tail, passed = design, path, []
    while isinstance(held, Countermeasure) and tail.startswith("brake."):
        passed.append(held.field_names())
        held, tail = held.brake, tail.removeprefix("brake.")
    head = tail.partition(".")[0]
    kept = max((i + 1 for i, names in enumerate(passed) if head in names), default=0)
    return "brake." * kept + tail


def direction(owner: str, field: str, system: System, on: str | Sequence[float]) -> Any:
    """The unit vector of a degree of freedom by its name, or a row of numbers as it is, shape (n,)."""
    if isinstance(on, str):
        if on not in system.names:
            raise ParameterError(owner, field, on, known_names(on, list(system.names)))
        return np.eye(system.size)[system.names.index(on)]
    row = np.asarray(on, dtype=float)
    if row.shape != (system.size,) or not np.all(np.isfinite(row)) or not np.any(row):
        raise ParameterError(owner, field, on, f"a name of {system.names}, or {system.size} numbers, one of them not 0")
    return row


def contact_index(owner: str, field: str, system: System, at: str) -> int:
    """The place of the contact with that name; of the only one for an empty name."""
    names = [contact.name for contact in system.contacts]
    if at == "" and len(names) == 1:
        return 0
    if at not in names or names.count(at) > 1:
        raise ParameterError(owner, field, at, known_names(at, names) if names else "a brake with contacts")
    return names.index(at)


def added(
    system: System,
    *,
    mass: np.ndarray | None = None,
    damping: np.ndarray | None = None,
    stiffness: np.ndarray | None = None,
) -> System:
    """The system with matrices (..., n, n) added to its own."""
    changes = {"M": mass, "C": damping, "K": stiffness}
    return system.replace({name: getattr(system, name) + more for name, more in changes.items() if more is not None})


def extended(system: System, *names: str) -> System:
    """The system with further degrees of freedom at the end, as yet without mass, damping and stiffness.

    A name that is taken gets a number behind it.
    """
    more = len(names)
    taken = list(system.names)
    for name in names:
        number = 2
        unique = name
        while unique in taken:
            unique, number = f"{name} {number}", number + 1
        taken.append(unique)
    matrices = {name: _padded(getattr(system, name), more, 2) for name in ("M", "C", "K")}
    contacts = tuple(_padded_contact(contact, more) for contact in system.contacts)
    return system.replace(
        {**matrices, "load": padded_load(system.load, more), "contacts": contacts, "names": tuple(taken)}
    )


def outer(scale: ArrayLike, left: ArrayLike, right: ArrayLike) -> Any:
    """scale left right', shape (..., n, n)."""
    return np.asarray(scale, dtype=float)[..., None, None] * (
        np.asarray(left)[..., :, None] * np.asarray(right)[..., None, :]
    )


def _padded(array: np.ndarray, more: int, axes: int) -> Any:
    return np.pad(array, [(0, 0)] * (np.ndim(array) - axes) + [(0, more)] * axes)


def _padded_contact(contact: Contact, more: int) -> Contact:
    rows = {name: getattr(contact, name) for name in ("n", "d", "t", "normal")}
    return contact.replace({name: _padded(row, more, 1) for name, row in rows.items() if row is not None})

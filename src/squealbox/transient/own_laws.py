"""Friction laws that come as source text: their numbers in the compiled code, and what the compiler is handed.

A law of this kind has `texts`, the source of ``mu(v, p)`` and ``slope(v, p)``; its kind follows those of `LAWS`, one
for each different text among the contacts, in their order.
"""

from collections.abc import Sequence
from functools import cache
from typing import Any

import numpy as np

from squealbox.friction import LAWS
from squealbox.law import FrictionLaw
from squealbox.system import Contact, InvalidSystem

Texts = tuple[str, str]


def texts_of(law: FrictionLaw) -> Texts | None:
    """The source of an own law that may run; None for the laws the engine knows.

    Raises the law's own `ParameterError` when its code has not been allowed.
    """
    texts: Texts | None = getattr(law, "texts", None)
    if texts is not None:
        law.mu(0.0)
    return texts


def own_texts(contacts: Sequence[Contact]) -> tuple[Texts, ...]:
    """The different sources among the contacts, in order."""
    found = [texts for contact in contacts if (texts := texts_of(contact.law)) is not None]
    return tuple(dict.fromkeys(found))


def law_kinds(contacts: Sequence[Contact]) -> Any:
    """The number of each contact's law in the compiled code, shape (contacts,)."""
    own = own_texts(contacts)
    kinds = []
    for contact in contacts:
        texts = texts_of(contact.law)
        if texts is None and type(contact.law) not in LAWS:
            known = ", ".join(law.__name__ for law in LAWS)
            given = f"{type(contact.law).__name__}(...)"
            raise InvalidSystem(
                f"{contact.name or 'contact'}.law = {given}: expected a law that can be compiled, "
                f"one of {known} or an OwnLaw"
            )
        kinds.append(LAWS.index(type(contact.law)) if texts is None else len(LAWS) + own.index(texts))
    return np.array(kinds, dtype=np.int64)


def is_long(text: str) -> bool:
    """Whether an own law is a sum of many terms, such as one averaged over a phase."""
    return "for " in text


@cache
def untraced(text: str) -> str:
    """Why the series of an own law's mu cannot be written; empty where it can."""
    from squealbox.transient.lanes.formulas import tried

    return "a friction law that is a sum of many terms has no short Taylor series" if is_long(text) else tried(text)

"""One value of a file: a number with its unit, or one of several words. What is wrong is noted in the document."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from squealbox.files.document import Document
from squealbox.files.lines import Key
from squealbox.parameters import Parameter, known_names
from squealbox.units import UnitError, in_si

WRONG: Any = object()  # stands for a value that was wrong and has been reported
LONGEST = 60  # characters of a value shown in a sentence


def read_number(document: Document, value: Any, about: Parameter, key: Key) -> Any:
    """One number, or `WRONG`."""
    expected = about.expected
    if isinstance(value, str):
        try:
            number = in_si(value, about.unit)
        except UnitError as error:
            document.problem(key, str(error))
            return WRONG
    elif isinstance(value, (int, float)) and not isinstance(value, bool):
        try:
            number = float(value)
        except OverflowError:
            return wrong(document, key, value, expected)
    else:
        return wrong(document, key, value, f"{expected}{_example(about)}")
    return number if about.accepts(np.asarray(number)) else wrong(document, key, value, expected)


def read_choice(document: Document, value: Any, choices: Mapping[str, Any], key: Key) -> Any:
    """What a word stands for, or `WRONG`."""
    if not isinstance(value, str):
        return wrong(document, key, value, f"one of {', '.join(choices)}")
    if value not in choices:
        document.problem(key, f"unknown name {shown(value)}, {known_names(value[:LONGEST], list(choices))}")
        return WRONG
    return choices[value]


def shown(value: object) -> str:
    """A value as a file writes it, cut to a length that fits in a sentence."""
    if isinstance(value, bool):
        text = str(value).lower()
    elif isinstance(value, Mapping):
        text = "a table"
    elif isinstance(value, list):
        text = f"[{', '.join(shown(item) for item in value[:4])}{', ...' if len(value) > 4 else ''}]"
    elif isinstance(value, str):
        text = repr(value[:LONGEST]) if value.isprintable() else ascii(value[:LONGEST])
    elif isinstance(value, int) and abs(value) >= 10**18:
        text = f"a whole number of {value.bit_length()} bits"
    else:
        text = str(value)
    return text if len(text) <= LONGEST else f"{text[: LONGEST - 3]}..."


def _example(about: Parameter) -> str:
    return "" if about.unit in ("", "-") else f", such as '1 {about.unit}'"


def wrong(document: Document, key: Key, value: Any, expected: str) -> Any:
    """Note that `value` is not what was expected; gives `WRONG`."""
    document.problem(key, f"{shown(value)}: expected {expected}")
    return WRONG


def only(document: Document, table: Mapping[str, Any], key: Key, known: Sequence[str]) -> None:
    """A problem of the document for each key that is none of those known."""
    for name in table:
        if name not in known:
            document.problem((*key, name), f"unknown key, {known_names(name[:60], list(known))}")

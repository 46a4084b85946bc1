"""A start, or a box of starts, from the command line: states by name, in their own units.

    --start sliding    --start mode 2    --start x=1mm "x'=0.2 m/s"    --box x=-1mm:1mm y=0 "y'=-0.1:0.1"

A prime marks a velocity. What is not named is as in steady sliding, or at zero where there is none.
"""

from collections.abc import Sequence
from typing import Annotated, Any

import numpy as np
from cyclopts import Parameter

from squealbox.cli.inputs import number
from squealbox.cli.running import UsageError
from squealbox.limit_cycles import VISIBLE, state_names
from squealbox.parameters import ParameterError, known_names
from squealbox.start import Start, in_words
from squealbox.system import InvalidSystem, System, equilibrium

States = Annotated[tuple[str, ...], Parameter(negative="", consume_multiple=True, show_default=False)]


def start_from(system: System, given: Sequence[str]) -> tuple[Any, Any] | None:
    """(q, qd) of ``--start``: None for nothing given, rest, sliding, a mode, or sliding with some states set."""
    if not given:
        return None
    n, words = system.size, " ".join(given)
    if words in ("rest", "sliding") or in_words(words):
        try:
            begin = Start.of("", words, system, share=VISIBLE)
        except (InvalidSystem, ParameterError) as error:
            raise UsageError(f"--start {words}: {getattr(error, 'expectation', error)}") from error
        return begin.q, begin.qd
    x = np.concatenate([_sliding(system), np.zeros(n)])
    expected = 'rest, sliding, mode 2, or NAME=VALUE such as x=1mm "x\'=0.2"'
    for i, text, label in _named(system, given, "--start", expected):
        x[i] = number(text, _unit(system, i), label)
    return x[:n], x[n:]


def box_from(system: System, given: Sequence[str], usual: Any) -> tuple[Any, Any]:
    """Half widths (2n,) and middle (q, qd) of ``--box``; states that are not named keep their `usual` half width."""
    half, middle = np.array(usual, dtype=float), np.concatenate([_sliding(system), np.zeros(system.size)])
    for i, text, label in _named(system, given, "--box", 'NAME=LOW:HIGH or NAME=VALUE, such as x=-1mm:1mm "x\'=0"'):
        low, _, high = text.partition(":")
        ends = [number(end, _unit(system, i), label) for end in ((low, high) if high else (low, low))]
        if ends[0] > ends[1]:
            raise UsageError(f"{label}: expected the lower end first")
        half[i], middle[i] = 0.5 * (ends[1] - ends[0]), 0.5 * (ends[0] + ends[1])
    return half, (middle[: system.size], middle[system.size :])


def _named(system: System, given: Sequence[str], option: str, expected: str) -> list[tuple[int, str, str]]:
    """Place in the state, text and label of each NAME=TEXT."""
    names, found = state_names(system), {}
    for each in given:
        name, equals, text = (part.strip() for part in each.partition("="))
        label = f"{option} {each[:60]}"
        if not equals or not text:
            raise UsageError(f"{label}: expected {expected}")
        if name not in names:
            raise UsageError(f"{label}: unknown state, {known_names(name, names)}")
        if names.index(name) in found:
            raise UsageError(f"{label}: {name} is given twice")
        found[names.index(name)] = (text, label)
    return [(i, *rest) for i, rest in found.items()]


def _unit(system: System, i: int) -> str:
    unit = system.units[i % system.size]
    return unit if i < system.size else f"{unit}/s"


def _sliding(system: System) -> Any:
    """Steady sliding, shape (n,); zeros where there is none."""
    state = equilibrium(system)
    return np.asarray(state.q, dtype=float) if np.all(state.exists) else np.zeros(system.size)

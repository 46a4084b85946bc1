"""What a panel is given and what it hands back."""

import threading
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from squealbox.design import Design
from squealbox.figure_data import Bars, FigureAxis, FigureData, packed
from squealbox.parameters import ParameterError
from squealbox.words import read_in
from squealbox.workbench.panels.declared import told
from squealbox.workbench.sheet import slider
from squealbox.workbench.state import StateError, UnknownBase, design_of

LONGEST_UNIT = 12  # characters
NONE = "\u2013"  # in a table, where nothing is known


class OptionError(ValueError):
    """An option of a panel that makes no sense; the message is one sentence."""


class Stopped(Exception):
    """The user stopped the computation, or a newer question made it needless."""


class Elsewhere(Exception):
    """The answer needs a process of its own: what the page says meanwhile, and how many seconds it usually takes."""

    def __init__(self, text: str, seconds: float) -> None:
        self.text, self.seconds = text, seconds
        super().__init__(text)


@dataclass(frozen=True)
class Answer:
    """What a panel draws: `figures`, a sentence in `data["words"]`, and what else its script asks for.

    `data` goes into the header (plain JSON), `arrays` follow as float32. Scale numbers to the unit they are read in
    before (float32 has seven digits). What stands in `data["marks"]` becomes attributes of the panel's element, a
    `table` in `data["table"]` its table.
    """

    data: Mapping[str, Any]
    arrays: Mapping[str, Any] = field(default_factory=dict)
    figures: Sequence[FigureData | Bars] = ()

    def sent(self) -> tuple[dict[str, Any], dict[str, Any]]:
        """Header and arrays of the answer's frame."""
        if not self.figures:
            return dict(self.data), dict(self.arrays)
        figures, arrays = packed(self.figures)
        return {**self.data, "figures": figures}, {**arrays, **self.arrays}


def table(heads: Sequence[str], rows: Sequence[Sequence[Any]]) -> dict[str, Any]:
    """A table of an answer: heads, and rows whose first cell names them; a cell is a text or (text, look)."""
    return {"heads": list(heads), "rows": [list(row) for row in rows]}


class Work:
    """How a long answer says how far it is, and learns that nobody waits for it any more.

    `apart` is true in a process of its own, which nobody else waits for.
    """

    def __init__(self, report: Callable[[float, str], None] | None = None, apart: bool = False) -> None:
        self._report, self._stop, self.apart = report, threading.Event(), apart

    def stop(self) -> None:
        """Ask the answer to end; it raises `Stopped` at its next `progress`."""
        self._stop.set()

    @property
    def stopped(self) -> bool:
        """True when the answer is no longer wanted."""
        return self._stop.is_set()

    def progress(self, share: float, text: str = "") -> None:
        """Say how far the answer is, 0 to 1, and raise `Stopped` where it is no longer wanted."""
        if self.stopped:
            raise Stopped
        self.say(share, text)

    def say(self, share: float, text: str) -> None:
        """Say how far the answer is."""
        if self._report is not None:
            self._report(share, text)


Function = Callable[[Design, "Options", Work], Answer]


class Options:
    """The options of a question, each read with its kind and range; what is wrong is an `OptionError`."""

    def __init__(self, given: Any, bases: Mapping[str, Design] | None = None) -> None:
        if not isinstance(given, Mapping):
            raise OptionError("options: expected an object")
        self.given, self.bases = given, bases or {}

    def design(self, name: str) -> Design | None:
        """Another design, given as the page gives its own; None where none is given."""
        state = self.given.get(name)
        if state is None:
            return None
        try:
            return design_of(state, self.bases)
        except UnknownBase as error:
            raise OptionError(f"{name}: it came from a file that is not open any more") from error
        except StateError as error:
            raise OptionError(f"{name}: {error}") from error

    def chosen(self, *choices: dict[str, Any]) -> dict[str, Any]:
        """What words and numbers among the choices of a panel are, by name, each within what it and its sheet say."""
        abouts = [told(each) for each in choices if each["kind"] in ("words", "number")]
        return {about["name"]: self._chosen(**about) for about in abouts}

    def _chosen(self, name: str, kind: str, usual: Any, **about: Any) -> Any:
        if kind == "words":
            value, known = self.given.get(name), [value for value, _ in about["options"]]
            value, read = usual if value is None else value, float if about["numbers"] else str
            found = [read(each) for each in known if value in (each, read(each))]
            if not found:
                raise OptionError(f"{name}: expected one of {', '.join(known)}")
            return found[0]
        value = self.number(name, usual, about.get("low", -np.inf), about.get("high", np.inf))
        return int(value) if about.get("whole") and value is not None else value

    def number(self, name: str, usual: Any, low: float, high: float) -> Any:
        """A finite number from low to high; `usual`, which may be None, where nothing is given."""
        value = self.given.get(name)
        if value is None:
            return usual
        if isinstance(value, bool) or not isinstance(value, (int, float)) or not low <= value <= high:
            raise OptionError(f"{name}: expected a number in [{low:g}, {high:g}]")
        return float(value)

    def dof(self, design: Design) -> int:
        """The index of a degree of freedom; the first where nothing is given, or a design chosen later has fewer.

        The answer names the one that was taken.
        """
        value = self.number("dof", 0, 0, 1e9)
        if value != int(value):
            raise OptionError("dof: expected a whole number")
        return int(value) if value < design.system().size else 0

    def parameter(self, name: str, design: Design, *usual: str) -> str:
        """The name of a parameter a study can vary; left out, the first of `usual` that the design has."""
        known = design.scalars()
        value = self.given.get(name)
        if value is None:
            return next((each for each in usual if each in known), next(iter(known)))
        if not isinstance(value, str) or value not in known:
            raise OptionError(f"{name}: {str(value)[:60]!r} is no parameter of this design that can be varied")
        return value

    def span(self, name: str, design: Design, parameter: str) -> tuple[float, float]:
        """The ends [SI] of an axis: those given as ``[low, high]`` or where the parameter's slider runs."""
        about, value = design.scalars()[parameter], float(design.value_of(parameter) or 0.0)
        given = self.given.get(name)
        if given is None:
            low, high = slider(value, about)
            return min(low, value), max(high, value)
        if not isinstance(given, list) or len(given) != 2 or not all(_is_number(end) for end in given):
            raise OptionError(f"{name}: expected two numbers")
        low, high = float(given[0]), float(given[1])
        if not (low < high and about.accepts(np.array([low, high]))):
            raise OptionError(f"{name}: expected a lower and a higher value in {about.range}")
        return low, high

    def over(self, design: Design, choice: dict[str, Any]) -> tuple[str, tuple[float, float]]:
        """The parameter that is chosen and the ends [SI] of its axis."""
        parameter = self.parameter(choice["name"], design, *choice["usual"])
        return parameter, self.span(choice["span"], design, parameter)

    def axis(self, design: Design, parameter: str, ends: tuple[float, float]) -> FigureAxis:
        """An axis over a parameter, its ends given in SI, in the unit that was chosen for it or the usual one."""
        read, chosen = axis_of(design, parameter), self.given.get("units")
        unit, factor = read["unit"], read["factor"]
        given = chosen.get(parameter) if isinstance(chosen, Mapping) else None
        if isinstance(given, list) and len(given) == 2 and _is_number(given[1]) and given[1] > 0.0:
            unit, factor = str(given[0])[:LONGEST_UNIT], float(given[1])
        low, high = (end / factor for end in ends)
        return FigureAxis(parameter, unit, (low, high), parameter, factor)


def axis_of(design: Design, parameter: str) -> dict[str, Any]:
    """How an axis of this parameter is read: its name, unit and factor to SI."""
    about = design.scalars()[parameter]
    unit, factor = read_in(about, design.usual(parameter))
    return {"parameter": parameter, "unit": unit, "factor": factor, "meaning": about.meaning}


def try_value(design: Design, parameter: str) -> float | None:
    """The value of a parameter [SI], None where it has none (a schedule, or left out)."""
    try:
        value = design.value_of(parameter)
    except ParameterError:
        return None
    return float(value) if isinstance(value, (int, float)) else None


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool) and abs(value) < 1e300

"""What the arguments of public functions may be: one sentence where one is not, before anything is computed.

An argument's name says what it is, the same in every function (`duration` is a time above zero everywhere), so what it
may be stands here once. Who waits for the function is told so. Depends on: parameters, waiting.
"""

import functools
import inspect
import math
import os
from collections.abc import Callable, Mapping
from typing import Any, ParamSpec, Protocol, TypeVar

import numpy as np

from squealbox.parameters import DataSheet, Missing, Parameter, ParameterError, known_names
from squealbox.waiting import Progress


class Brake(Protocol):
    """A design as an analysis sees it: what makes a system."""

    def system(self) -> Any:
        """The equation of motion, a `system.System`."""


P = ParamSpec("P")
R = TypeVar("R")
Kind = Callable[[Any], str]  # what is expected, as the end of a sentence, where the value is not that; "" where it is


def real(about: Parameter) -> Kind:
    """A finite number in a range."""

    def expected(value: Any) -> str:
        return "" if is_real(value) and about.contains(float(value)) else about.expected

    return expected


def whole(least: int) -> Kind:
    """A whole number of at least `least`."""

    def expected(value: Any) -> str:
        good = is_real(value) and value == int(value) and value >= least
        return "" if good else f"a whole number of at least {least}"

    return expected


def is_real(value: Any) -> bool:
    """True for a single finite number, of Python or NumPy, that is no truth value."""
    number = isinstance(value, (int, float, np.integer, np.floating)) and not isinstance(value, bool)
    alone = isinstance(value, np.ndarray) and value.ndim == 0 and value.dtype.kind in "iuf"
    return (number or alone) and math.isfinite(value)


def interval(value: Any) -> str:
    """Two finite numbers (low, high) with low < high."""
    pair = isinstance(value, (tuple, list, np.ndarray)) and len(value) == 2 and all(is_real(each) for each in value)
    return "" if pair and value[0] < value[1] else "two finite numbers (low, high) with low < high"


def bounds(value: object) -> str:
    """An interval; those of several parameters by name are read by `squealbox.family`, which names the one to blame."""
    return "" if isinstance(value, Mapping) else interval(value)


def band(value: Any) -> str:
    """Frequencies (f1, f2) in Hz."""
    good = interval(value) == "" and value[0] >= 0.0
    return "" if good else "(f1, f2) in Hz with 0 <= f1 < f2"


def design(value: object) -> str:
    """A design or a system, not its class and not its file."""
    if isinstance(value, type):
        return f"a design made from it, {value.__name__}(...)"
    if isinstance(value, (str, os.PathLike)):
        return "a design; read_design(path) reads a file"
    good = (
        callable(value)
        or callable(getattr(value, "system", None))
        or (hasattr(value, "contacts") and hasattr(value, "M"))
    )
    return "" if good else "a design or a System"


def with_parameters(value: object) -> str:
    """A design: what has parameters by name, which a System has not."""
    told = design(value)
    if told or callable(getattr(value, "system", None)):
        return told
    return "a design, whose parameters have names; OwnBrake(M, C, K, contacts) makes one of matrices"


def designs(value: object) -> str:
    """A design or a system, or a list of them."""
    each = value if isinstance(value, (list, tuple)) else [value]
    return next((expected for one in each if (expected := design(one))), "")


def named(value: object) -> str:
    """Values by the names of parameters."""
    good = isinstance(value, (Mapping, DataSheet)) or hasattr(value, "names")
    return "" if good else 'a dictionary by parameter, such as {"friction.static": ...}'


def word(value: object) -> str:
    """The name of a parameter, or a dictionary of it and what it may be."""
    good = isinstance(value, (str, Mapping))
    return "" if good else 'the name of a parameter, such as "friction.static", or {"friction.static": ...}'


def asked(value: object) -> str:
    """A number of a design."""
    return "" if callable(value) else "a function of a design, or a quantity such as quantities.growth_rate()"


def path(value: object) -> str:
    """A file or folder."""
    return "" if isinstance(value, (str, os.PathLike)) else "a path"


POSITIVE: dict[str, str] = {"duration": "s", "width": "m/s", "step": "s", "tolerance": "", "largest_step": ""}
KINDS: dict[str, Kind] = {
    **{name: real(Parameter(unit, 0.0, low_open=True)) for name, unit in POSITIVE.items()},
    **{name: real(Parameter("s")) for name in ("time", "start_time")},
    "rtol": real(Parameter("", 1e-15, 1.0, high_open=True)),
    **{name: whole(1) for name in ("samples", "points", "harmonics", "most_steps", "rounds", "shots", "threads")},
    **{name: whole(1) for name in ("population", "generations", "replicates")},
    "seed": whole(0),
    "bounds": bounds,
    "band": band,
    **dict.fromkeys(("design", "design_or_system", "brake", "system"), design),
    **dict.fromkeys(("scatter", "variables", "parameters"), named),
    "path": path,
    "parameter": word,
    "quantity": asked,
}


def public(**kinds: Kind | None) -> Callable[[Callable[P, R]], Callable[P, R]]:
    """A function whose arguments are looked at first, by `KINDS` and by `kinds` of its own (None: not this one).

    None passes where it is the default. A dictionary in the place of `parameter` stands for it and for the argument
    behind it, its bounds or values. What a function calls its owner "" is told under the function's own name.

    Raises `ParameterError` for an argument that is not what it shall be and, with the nearest name, for one that the
    function does not have.

    >>> @public()
    ... def wait(duration: float) -> float:
    ...     return duration
    >>> wait("50ms")
    Traceback (most recent call last):
    squealbox.declarations.ParameterError: wait.duration = '50ms': expected a finite number in (0, inf) s
    """

    def decorate(function: Callable[P, R]) -> Callable[P, R]:
        given = inspect.signature(function).parameters
        names = [name for name, one in given.items() if one.kind is not one.VAR_KEYWORD]
        open_ended = len(names) < len(given)
        looked = {name: kinds.get(name, KINDS.get(name)) for name in names}
        at = [(i, name, kind, given[name].default) for i, (name, kind) in enumerate(looked.items()) if kind is not None]
        owner = function.__name__
        place = names.index("progress") if "progress" in names else None
        placed = [name for name in names if given[name].kind is inspect.Parameter.POSITIONAL_OR_KEYWORD]
        # a dictionary leaves out the bounds or values behind it, where more can be given by place
        pair = placed.index("parameter") if "parameter" in placed[:-2] else len(names)
        must = [name for name in names if given[name].default is inspect.Parameter.empty]

        @functools.wraps(function)
        def call(*args: P.args, **keywords: P.kwargs) -> R:
            for name in keywords:
                if not open_ended and name not in given:
                    raise ParameterError(owner, name, keywords[name], known_names(name, names))
            if len(args) > pair + 1 and isinstance(args[pair], Mapping) and args[pair + 1] is not None:
                args = (*args[: pair + 1], None, *args[pair + 1 :])  # type: ignore[assignment]
            for i, name, kind, usual in at:
                if i < len(args):
                    value: Any = args[i]
                elif name in keywords:
                    value = keywords[name]
                else:
                    continue
                if value is usual:
                    continue
                if (expected := kind(value)) != "":
                    raise ParameterError(owner, name, value, expected)
            if len(args) + len(keywords) < len(must):
                lacking = next((name for name in must[len(args) :] if name not in keywords), None)
                if lacking is not None:
                    about = looked[lacking]
                    raise Missing(owner, lacking, about(None) if about else "")
            try:
                with Progress(owner) as told:
                    if told.began and place is not None and place >= len(args) and keywords.get("progress") is None:
                        keywords["progress"] = told.heard
                    return function(*args, **keywords)
            except ParameterError as error:
                if error.named or error.name not in given:
                    raise
                raise error.of(owner) from error

        call.looked_at = tuple(name for _, name, _, _ in at)  # type: ignore[attr-defined]
        return call

    return decorate

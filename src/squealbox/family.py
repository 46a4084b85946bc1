"""A design with free parameters, in the one spelling of every analysis: {"friction.static": what it may be}.

    bounds          (low, high)              to look for something: `critical_value`, `branch`, `stability_boundary`
    values          one number or several    to compute something: `tracked_modes`, `stability_map`, `sweep`
    axis            low, high and points     serves as either
    distribution    Normal(0.4, 0.02)        how it scatters: `squeal_probability`, `silence`; read by `Scatter`

What a kind of value cannot mean for an analysis is one sentence that names the parameter. Depends on: arguments,
parameters, system.
"""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, Self

import numpy as np

from squealbox.arguments import interval
from squealbox.parameters import DataSheet, Missing, ParameterError, parameter
from squealbox.system import DesignOrSystem, System, as_system

Bounds = tuple[float, float]
Varied = str | Mapping[str, Any]  # one parameter by name, or {name: bounds or values}
DesignOrRecipe = DesignOrSystem | Callable[..., DesignOrSystem]  # a recipe makes a design of values of its parameters
COUNTED = {1: "one parameter", 2: "two parameters"}


class ParameterAxis(DataSheet):
    """One parameter and the values it takes; `low` and `high` are in the parameter's own SI unit."""

    aliases: ClassVar[Mapping[str, tuple[str, ...]]] = {"parameter": ("name",)}

    name: str
    low: float = parameter("")
    high: float = parameter("")
    points: int = parameter("-", 2, 20_001, default=201, meaning="number of values")

    @property
    def values(self) -> np.ndarray:
        """The values, equally spaced, shape (points,)."""
        return np.linspace(self.low, self.high, int(self.points))


@dataclass(frozen=True)
class ParameterPlane:
    """Two parameters and the values each takes."""

    x: ParameterAxis
    y: ParameterAxis


class Family:
    """Designs over one or more parameters.

    Parameters
    ----------
    design : a design or a system, whose ``replace({name: array})`` makes a batch; or a function of one float for each
        parameter that returns a design or a system, called point by point
    parameters : dotted names, such as "friction.static"; for a function, what results call its arguments
    spans : of each parameter its bounds (low, high), or its values (k,)

    Raises `ParameterError` for a name the design does not have.
    """

    def __init__(self, design: Any, parameters: Iterable[str], spans: Iterable[Any] = ()) -> None:
        self.design, self.parameters, self.spans = design, tuple(parameters), tuple(spans)
        self.recipe: Callable[..., Any] | None = design if is_recipe(design) else None
        if isinstance(design, DataSheet) and not isinstance(design, System):  # whose table of contacts has no names
            for name in self.parameters:
                design.value_of(name)

    @classmethod
    def within(
        cls,
        owner: str,
        design: DesignOrRecipe | None,
        parameter: Varied,
        bounds: Bounds | None = None,
        *,
        count: int = 1,
        **more: Any,
    ) -> Self:
        """The family of ``{name: (low, high)}``, or of one name and its bounds; `owner` was asked for `count` names."""
        given = _spelled(owner, "bounds", parameter, bounds, count, "(low, high)")
        return cls(design, given, [bounds_of(owner, *each) for each in given.items()], **more)

    @classmethod
    def along(
        cls,
        owner: str,
        design: DesignOrRecipe | None,
        parameter: Varied,
        values: Any = None,
        *,
        count: int = 0,
        **more: Any,
    ) -> Self:
        """The family of ``{name: values}``, or of one name and its values; `count` 0 takes any number of names."""
        given = _spelled(owner, "values", parameter, values, count, "values")
        return cls(design, given, [values_of(owner, *each) for each in given.items()], **more)

    @property
    def name(self) -> str:
        """The first parameter."""
        return self.parameters[0]

    def one(self, *values: Any) -> Any:
        """The design at one value of each parameter; of a design with ``replace`` also at arrays of them."""
        return varied(self.design, dict(zip(self.parameters, values, strict=True)))

    def system(self, *values: float) -> System:
        """The system at one value of each parameter."""
        return as_system(self.one(*values))


def is_recipe(design: object) -> bool:
    """True for a function that makes designs or systems of values, False for a design."""
    return callable(design) and not hasattr(design, "replace")


def varied(design: Any, values: Mapping[str, Any]) -> Any:
    """The design with these values; a function called with them in order; the values themselves without a design."""
    if design is None:
        return dict(values)
    return design(*values.values()) if is_recipe(design) else design.replace(values)


def unit_of(design: object, path: str) -> str:
    """The unit of a parameter, for tables and figures; empty when nothing declares it."""
    return design.unit_of(path) if isinstance(design, DataSheet) else ""


def kept_unit(design: object, path: str) -> dict[str, Any]:
    """The setting by which a result that keeps no design knows the unit of its parameter; none where nothing does."""
    unit = unit_of(design, path)
    return {"parameter_units": {path: unit}} if unit else {}


def bounds_of(owner: str, name: str, given: Any) -> Bounds:
    """(low, high) of a parameter, or the ends of an axis."""
    if all(hasattr(given, each) for each in ("low", "high", "points")):
        given = (given.low, given.high)
    if expected := interval(given):
        raise ParameterError(owner, name, given, expected)
    return float(given[0]), float(given[1])


def values_of(owner: str, name: str, given: Any, *, words: bool = False, axes: bool = False) -> Any:
    """Values (k,) of a parameter, or those of an axis; with `words` they may be such, with `axes` of any shape."""
    if hasattr(given, "ppf") or hasattr(given, "dist"):
        expected = "values; Scatter({...}).sample(count) draws them from distributions"
        raise ParameterError(owner, name, given, expected)
    given = given if callable(getattr(given, "values", len)) else given.values
    expected = "one or more finite numbers" + ", or words" * words
    try:
        array = np.array(given if axes else np.atleast_1d(given))
    except ValueError as error:  # of unequal lengths
        raise ParameterError(owner, name, given, expected) from error
    if array.ndim == 1 and array.size and words and array.dtype.kind == "U":
        return array
    if (
        (array.ndim != 1 and not axes)
        or array.size == 0
        or array.dtype.kind not in "iuf"
        or not np.all(np.isfinite(array))
    ):
        raise ParameterError(owner, name, given, expected)
    return array.astype(float)


def _spelled(owner: str, word: str, parameter: Varied, given: Any, count: int, of: str) -> dict[str, Any]:
    """{name: given} of either spelling."""
    if isinstance(parameter, str):
        if given is None:
            raise Missing(owner, word, interval(None) if word == "bounds" else "one or more finite numbers")
        return {parameter: given}
    if given is not None:
        raise ParameterError(owner, word, given, f"nothing beside {{name: {of}}}")
    if not isinstance(parameter, Mapping) or not parameter or len(parameter) != (count or len(parameter)):
        names = list(parameter) if isinstance(parameter, Mapping) else parameter
        expected = f"{COUNTED.get(count, 'at least one parameter')}, {{name: {of}}}"
        raise ParameterError(owner, "parameters", names, expected)
    return dict(parameter)

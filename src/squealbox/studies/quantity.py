"""The number a study asks of a design, and its values at many points in one batched call.

A quantity is any function ``quantity(design) -> number``; for a design whose parameters are arrays of shape (n,) it
returns n numbers. The analysis inside is the caller's: this room imports none.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from squealbox.family import DesignOrRecipe, varied
from squealbox.parameters import DataSheet, Parameter, ParameterError

MAKERS = "squealbox.quantities"  # its functions make quantities
BLOCK = 1 << 17  # points computed together


@dataclass(frozen=True)
class Quantity:
    """A number of a design, what it is called, and the limit beyond which the brake squeals.

    Parameters
    ----------
    function : of a design, returns one number, or n numbers for a design of arrays of shape (n,)
    name, unit : what tables and figures call it
    limit : the value at which squeal begins, in `unit`
    squeals : "above" or "below" the limit
    smooth : False when it has kinks, such as the growth rate where two modes meet; a surrogate says so then
    batched : False when the function takes one design at a time
    meaning : one line for a table

    >>> from squealbox.studies import Quantity
    >>> stiffness = Quantity(lambda design: design["k"], "stiffness", "N/m", limit=2.0)
    >>> stiffness.excess(3.0)
    1.0
    """

    function: Callable[[Any], Any]
    name: str
    unit: str = ""
    limit: float = 0.0
    squeals: Literal["above", "below"] = "above"
    smooth: bool = True
    batched: bool = True
    meaning: str = ""

    def __repr__(self) -> str:
        unit = f" {self.unit}" if self.unit not in ("", "-", "1") else ""
        return f"Quantity {self.name}: squeals {self.squeals} {self.limit:g}{unit}"

    def __post_init__(self) -> None:
        if not callable(self.function):
            raise ParameterError("Quantity", "function", self.function, "a function of a design")
        if self.squeals not in ("above", "below"):
            raise ParameterError("Quantity", "squeals", self.squeals, "'above' or 'below'")
        if not np.isfinite(self.limit):
            raise ParameterError("Quantity", "limit", self.limit, "a finite number")

    def __call__(self, design: Any) -> Any:
        return self.function(design)

    def excess(self, values: float | np.ndarray) -> Any:
        """How far `values` are on the side of squeal: positive squeals, zero and below does not; NaN is unknown."""
        return values - self.limit if self.squeals == "above" else self.limit - values

    @property
    def about(self) -> dict[str, Any]:
        """What a result keeps of the quantity; its function cannot be written to a file."""
        return {"name": self.name, "unit": self.unit, "limit": self.limit, "squeals": self.squeals}


QuantityLike = Quantity | Callable[[Any], Any]  # a number of a design, or a plain function of one


def as_quantity(given: QuantityLike) -> Quantity:
    """`given` as a quantity; a plain function squeals above 0 and is called by its own name."""
    if isinstance(given, Quantity):
        return given
    if not callable(given):
        raise ParameterError("study", "quantity", given, "a function of a design, or a Quantity")
    name = getattr(given, "__name__", type(given).__name__)
    if getattr(given, "__module__", "") == MAKERS:
        raise ParameterError("study", "quantity", f"{name}, not called", f"{name}(...), which makes the quantity")
    return Quantity(given, "quantity" if name == "<lambda>" else name.replace("_", " "))


def evaluate(
    design: DesignOrRecipe | None, quantity: Quantity, points: Mapping[str, Any], *, strict: bool = True
) -> Any:
    """The quantity at `points` (dotted name to shape (n,)), shape (n,); in blocks of 131,072.

    `design` has ``replace``; or is a function of the values in the order of `points`; or is None, when the quantity is
    a function of the dictionary of values itself. NaN where the design refuses a value as out of its range.
    Raises `ParameterError` for an unknown name or (`strict`) when it refuses every point, `ValueError` for an answer of
    another shape.
    """
    arrays = {name: np.asarray(values, dtype=float) for name, values in points.items()}
    count = next(iter(arrays.values())).size
    inside = _inside(design, arrays)
    if strict and not np.any(inside):
        varied(design, {name: float(values[0]) for name, values in arrays.items()})  # says why
    found = np.full(count, np.nan)
    places = np.nonzero(inside)[0]
    for start in range(0, places.size, BLOCK):
        block = places[start : start + BLOCK]
        found[block] = _block(design, quantity, {name: values[block] for name, values in arrays.items()})
    return found


def input_of(design: object) -> Any:
    """What a result keeps of the design; a function cannot be written to a file and is left out."""
    return design if isinstance(design, DataSheet) else None


def _block(design: DesignOrRecipe | None, quantity: Quantity, arrays: Mapping[str, Any]) -> Any:
    count = next(iter(arrays.values())).size
    if not quantity.batched:
        rows = ({name: float(values[i]) for name, values in arrays.items()} for i in range(count))
        return np.array([float(quantity(varied(design, row))) for row in rows])
    values = np.asarray(quantity(varied(design, arrays)), dtype=float)
    if values.shape != (count,):
        raise ValueError(
            f"{quantity.name} of {count} designs at once has shape {values.shape}: expected ({count},); "
            "give Quantity(..., batched=False) for a function of one design at a time"
        )
    return values


def _inside(design: DesignOrRecipe | None, arrays: Mapping[str, Any]) -> Any:
    """True where every value is within the range its parameter declares."""
    inside = np.ones(next(iter(arrays.values())).shape, dtype=bool)
    for name, values in arrays.items():
        inside &= np.isfinite(values)
        for about in declared(design, name):
            inside &= (values > about.low) if about.low_open else (values >= about.low)
            inside &= (values < about.high) if about.high_open else (values <= about.high)
    return inside


def declared(design: object, path: str) -> list[Parameter]:
    """What the design declares of the parameter `path`, one entry for each field that an alias sets."""
    if not isinstance(design, DataSheet):
        return []
    head, _, rest = path.partition(".")
    names = design.aliases.get(head, (head,))
    design.value_of(path)  # an unknown name says so
    if rest:
        found = [about for name in names if hasattr(design, name) for about in declared(getattr(design, name), rest)]
    else:
        found = [design.parameters()[name] for name in names if name in design.parameters()]
    held = getattr(design, "brake", None)
    if isinstance(held, DataSheet) and names[0] not in design.field_names():
        return declared(held, path)  # within countermeasures a parameter of the brake keeps its name
    return found or [about for name, about, _ in design.leaves() if name == path]

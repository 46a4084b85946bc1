"""One door to every figure: `plot` looks at the kind of result and calls the function that draws it."""

from functools import singledispatch
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@singledispatch
def plot(result: Any, **keywords: Any) -> "Figure":
    """The figure of a result; keywords go to the function that draws it.

    Each drawing module registers its kinds with ``plot.register``. Raises `TypeError` for a result nothing draws.
    """
    known = ", ".join(sorted(kind.__name__ for kind in plot.registry if kind is not object))
    raise TypeError(f"no figure is known for {type(result).__name__}: expected one of {known}")

"""One door to every figure: `plot` looks at the kind of result and calls the function that draws it."""

import importlib
import inspect
from collections.abc import Mapping, Sequence
from functools import cache, singledispatch
from pathlib import Path
from typing import TYPE_CHECKING, Any

from squealbox.arguments import public, real
from squealbox.declarations import Parameter, ParameterError, known_names
from squealbox.plots.style import LOOK, Look, styled

if TYPE_CHECKING:
    from matplotlib.figure import Figure

INCHES = real(Parameter("inches", 0.5, 100.0))


@cache
def drawers() -> None:
    """Load every module that registers how a kind is drawn."""
    for path in sorted(Path(__file__).parent.glob("*.py")):
        if "\n@drawn_by.register" in path.read_text(encoding="utf-8"):
            importlib.import_module(f"squealbox.plots.{path.stem}")


@singledispatch
def drawn_by(result: object, **keywords: Any) -> "Figure":
    """The figure of a result as its kind is drawn: each drawing module registers its kinds here."""
    known = ", ".join(sorted(kind.__name__ for kind in drawn_by.registry if kind is not object))
    raise TypeError(f"no figure is known for {type(result).__name__}: expected one of {known}")


@public(width=INCHES, height=INCHES)
def plot(
    result: object,
    *,
    width: float | None = None,
    height: float | None = None,
    style: str | Mapping[str, Any] | Sequence[Any] | None = None,
    **keywords: Any,
) -> "Figure":
    """The figure of a result.

    Parameters
    ----------
    result : what an analysis returned, a design, a system or a friction law
    width, height : [in] of the figure, by default what suits it; a column of a paper has 3.4, a page 7
    style : name, dictionary or list of matplotlib styles, which go before the look of this house; fonts, sizes and
        lines that are set in ``matplotlib.rcParams`` do so by themselves
    keywords : go to the function that draws the result

    Raises `TypeError` for a result nothing draws, `ParameterError` for a width that is none. ``savefig("x.pdf")`` or
    ``savefig("x.svg")`` of the figure keeps its text as text.

    >>> from squealbox import DrumBrake, complex_modes
    >>> float(plot(complex_modes(DrumBrake()), width=3.4, style={"font.family": "serif"}).get_figwidth())
    3.4
    """
    token = LOOK.set(Look(width, height, style))
    try:
        with styled():
            draw = drawer_of(type(result))
            known = inspect.signature(draw).parameters
            if all(each.kind is not each.VAR_KEYWORD for each in known.values()):
                names = [*list(known)[1:], "width", "height", "style"]
                for name in keywords:
                    if name not in known:
                        raise ParameterError("plot", name, keywords[name], known_names(name, names))
            return draw(result, **keywords)
    finally:
        LOOK.reset(token)


def drawer_of(kind: type) -> Any:
    """The function that draws a kind of result."""
    drawers()
    return drawn_by.dispatch(kind)


plot.register = drawn_by.register  # type: ignore[attr-defined]
plot.dispatch = drawer_of  # type: ignore[attr-defined]
plot.registry = drawn_by.registry  # type: ignore[attr-defined]

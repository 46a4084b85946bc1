"""What every design is: a data sheet that makes a system."""

import importlib
from typing import Any, ClassVar

from squealbox.friction import FrictionLaw
from squealbox.parameters import DRAWN_BY, DataSheet, ParameterError, screenful
from squealbox.system import System


class Markdown(str):
    """Text that a notebook shows as Markdown."""

    def _repr_markdown_(self) -> str:
        return str(self)


class Design(DataSheet):
    """A brake on paper: parameters with unit, range and source, and ``system()``, the equation it obeys.

    Every parameter may be an array with leading axes; the system then carries the same axes.
    """

    title: ClassVar[str] = ""
    source: ClassVar[str] = ""

    def __post_init__(self) -> None:
        super().__post_init__()
        if not hasattr(self, "friction"):
            return
        law = self.friction
        if not isinstance(law, FrictionLaw):
            raise ParameterError(type(self).__name__, "friction", law, "a friction law")

    def system(self) -> System:
        """The equation of motion with these parameters."""
        raise NotImplementedError

    def draw(self, panel: Any) -> None:
        """Where `plots.brakes` knows no drawing: with `plot`, `text`, `annotate`, `add_patch` of a Matplotlib panel."""

    def __str__(self) -> str:
        further = "complex_modes(it), simulate(it, 0.05), plot(it); it.replace({name: value}) has another value"
        return f"{screenful(self.summary(), lines=29)}\n{further}"

    def plot(self, **keywords: Any) -> Any:
        """The drawing of this brake, as `squealbox.plots.brake_drawing` makes it."""
        return importlib.import_module(DRAWN_BY).plot(self, **keywords)

    @classmethod
    def parameter_table(cls) -> Markdown:
        """The parameters with symbol, default, range and unit, meaning and source, as a Markdown table."""
        lines = ["| parameter | default | range | meaning | source |", "|---|---|---|---|---|"]
        for name, about in cls.parameters().items():
            value = getattr(cls, name, None)
            shown = f"{value:.6g}" if isinstance(value, (int, float)) else str(value)
            lines.append(f"| `{name}` | {shown} | {about.range} | {about.meaning} | {about.source} |")
        return Markdown("\n".join(lines))

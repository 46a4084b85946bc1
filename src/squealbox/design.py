"""What every design is: a data sheet that makes a system."""

import importlib
from typing import Annotated, Any, ClassVar, get_origin

import numpy as np

from squealbox.law import FrictionLaw
from squealbox.parameters import (
    DRAWN_BY,
    Choice,
    DataSheet,
    Parameter,
    ParameterError,
    field_type,
    known_names,
    screenful,
)
from squealbox.shapes import Shapes
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

    @property
    def innermost(self) -> "Design":
        """The brake itself, without what a countermeasure adds."""
        return self

    @property
    def layers(self) -> tuple[Any, ...]:
        """The countermeasures around the brake, the outermost first."""
        return ()

    def scalars(self) -> dict[str, Parameter]:
        """The scalar parameters that a study can vary, nested ones with dots, aliases included.

        Those of a brake within countermeasures and loops keep their names.
        """
        arrays = {name for name in self.parameters() if get_origin(field_type(type(self), name)) is Annotated}
        known = {name: about for name, about, value in self.leaves() if np.ndim(value) == 0 and name not in arrays}
        own = self.innermost.parameters()
        for alias, names in self.innermost.aliases.items():
            if all(name in own for name in names):
                known.setdefault(alias, own[names[0]])
        return known

    def scalar(self, name: str) -> Parameter:
        """Unit and range of the scalar parameter `name`; `ParameterError` names those there are."""
        known = self.scalars()
        if name not in known:
            raise ParameterError("design", "parameter", name, known_names(name[:60], list(known)))
        return known[name]

    def words(self) -> dict[str, Choice]:
        """The fields that hold one of several words, those of a brake within countermeasures included."""
        return self.choices()

    def draw(self, shapes: Shapes) -> None:
        """Add the shapes of its drawing, and its contacts in the order of the system; a design may have none."""

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

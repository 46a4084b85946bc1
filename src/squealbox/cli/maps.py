"""`squealbox map`: which part of a plane squeals, why, and where its boundary runs."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

from cyclopts import Parameter

from squealbox.cli.answers import show as say
from squealbox.cli.answers import written
from squealbox.cli.inputs import Vary, axis, folder, read, readable, small, spans
from squealbox.cli.options import AS_WRITTEN, Asked
from squealbox.cli.running import ComputationFailed, UsageError
from squealbox.family import ParameterAxis
from squealbox.fe import ReducedBrake
from squealbox.stability import Boundary, StabilityMap, map_boundary, stability_boundary, stability_map
from squealbox.waiting import Progress
from squealbox.writing import write, write_table

ABOUT = {"map_": "stability over two parameters, with the boundary as curves"}

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from squealbox.design import Design
    from squealbox.files import DesignFile

COARSE = 11  # points along each axis of a reduced brake's map, unless more are asked for
CLOSE = 0.02  # share of a cell to which its boundary is located
Span = Annotated[tuple[str, str, str] | None, Parameter(negative="")]
ACROSS, UP = "--x NAME LOW HIGH", "--y NAME LOW HIGH"


@dataclass(frozen=True)
class HowPlane:
    """What a command varies, where that is not as the section [map] of its file says.

    Parameters
    ----------
    vary
        two parameters, each with its lowest and highest value: friction.static=0:1 theta1=20deg:160deg
    x
        parameter, lowest and highest value: friction.static 0 1
    y
        the same for the other axis: theta1 20deg 160deg
    points
        number of values along each axis
    """

    vary: Vary = ()
    x: Span = None
    y: Span = None
    points: int | None = None

    def of(self, found: "DesignFile") -> tuple[ParameterAxis, ParameterAxis]:
        """The two axes of a plane, from the options or the section [map] of the file."""
        given = found.map
        x, y = ((name, *ends) for name, ends in spans(self.vary, 2)) if self.vary else (self.x, self.y)
        across = axis(found.design, given.x if given else None, *_split(x), ACROSS, self.points)
        up = axis(found.design, given.y if given else None, *_split(y), UP, self.points)
        if across.name == up.name:
            raise UsageError(f"x and y are both {up.name}: expected two different parameters")
        return across, up


TwoVaried = Annotated[HowPlane, Parameter(name="*")]
AS_FILED = HowPlane()


def map_(
    file: Path,
    *,
    over: TwoVaried = AS_FILED,
    show: Literal["growth", "mechanism"] = "growth",
    asked: Asked = AS_WRITTEN,
    out: Path | None = None,
) -> None:
    """Stability over two parameters: which part of the plane squeals, why, how fast it grows, and its boundary.

    Parameters
    ----------
    file
        design file; its section [map] says what is varied, unless the options do
    show
        what the figure shades: the growth rate, or the mechanism
    out
        folder for the figure, the grid and the points of the boundary
    """
    found = read(file, asked)
    across, up = over.of(found)
    folder(out, "map", "boundary")
    found = small(found, across, up)
    reduced = isinstance(found.design, ReducedBrake)
    if reduced and over.points is None:
        across, up = (each.replace(points=min(int(each.points), COARSE)) for each in (across, up))
        print(
            f"{int(across.points)} x {int(up.points)} points, each with a spectrum of its own: --points asks for more"
        )
    with Progress(f"{int(across.points)} x {int(up.points)} points") as progress:
        grid = stability_map(found.design, {each.name: each.values for each in (across, up)})
        if not grid.outcome.ok:
            raise ComputationFailed(grid.outcome)
        progress("following the boundary")
        ends = {each.name: (each.low, each.high) for each in (across, up)}
        edge = map_boundary(grid, close=CLOSE) if reduced else stability_boundary(found.design, ends)
    plane = Plane(found.design, across, up)
    say(f"{found.design.title}, {file}", grid, edge)
    if out is not None:
        figure = _drawn(grid, edge, plane, show, found.path.name)
        boundary = write_table(out / "boundary.csv", edge.table())
        print(written(*write(grid, out, "map", figure=figure), boundary))


class Plane:
    """The two axes, in the units one reads them in."""

    def __init__(self, design: "Design", across: ParameterAxis, up: ParameterAxis) -> None:
        self.design, self.axes = design, (across, up)
        self.names = (across.name, up.name)
        (self.x, x_unit), (self.y, y_unit) = (readable(design, each, each.values) for each in self.axes)
        self.units = (x_unit, y_unit)
        self.factors = tuple(float(readable(design, each, 1.0)[0]) for each in self.axes)

    @property
    def labels(self) -> dict[str, str]:
        """Names and units of the axes, as figures take them."""
        (x_name, y_name), (x_unit, y_unit) = self.names, self.units
        return {"x_name": x_name, "x_unit": x_unit, "y_name": y_name, "y_unit": y_unit}


def _split(span: tuple[str, str, str] | None) -> tuple[str | None, tuple[str, str] | None]:
    return (None, None) if span is None else (span[0], (span[1], span[2]))


def _drawn(grid: StabilityMap, edge: Boundary, plane: Plane, show: str, title: str) -> "Figure":
    from squealbox import plots

    if show == "mechanism":
        scales = {n: (f, u) for n, f, u in zip(plane.names, plane.factors, plane.units, strict=True)}
        return plots.mechanism_map(grid, boundary=edge, scales=scales, title=title)
    curves = [points * plane.factors for points in edge.curves]
    return plots.stability_map(plane.x, plane.y, grid.growth_rate.T, **plane.labels, curves=curves, title=title)

"""`squealbox basin`: which starts lead to which motion, how likely each is, and the smallest dangerous push."""

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from squealbox.cli.answers import show, written
from squealbox.cli.inputs import NOTHING_SAID, Said, folder, in_motion, keywords, read
from squealbox.cli.options import AS_WRITTEN, Asked
from squealbox.cli.running import ComputationFailed
from squealbox.cli.states import States, box_from
from squealbox.limit_cycles import BasinSettings, basin, dangerous_push, half_widths
from squealbox.waiting import Progress
from squealbox.writing import write

ABOUT = {"basin_": "which starts lead to which motion: shares, a picture, the smallest push"}

Two = Annotated[tuple[str, str] | None, Parameter(negative="")]
Push = Annotated[bool, Parameter(negative="")]


def basin_(
    file: Path,
    *,
    how: Said[BasinSettings] = NOTHING_SAID,
    box: States = (),
    plane: Two = None,
    push: Push = False,
    asked: Asked = AS_WRITTEN,
    out: Path | None = None,
) -> None:
    """Which starts lead to which motion: the share of each with its interval, for starts in a box.

    The box has half widths V/w (displacements) and V (velocities) times --spread about steady sliding, with V the
    fastest sliding speed and w the slowest frequency, unless --box gives ends of its own to some states. With --plane
    the starts lie on a grid in that plane and make a picture.

    Parameters
    ----------
    file
        design file; squealbox init writes a first one
    box
        ends of some states, such as x=-1mm:1mm "y'=0:0.2 m/s" (a prime is a velocity); x=0 holds one
    plane
        two states to draw: x y' (a prime is a velocity)
    push
        look for the smallest push that ends in a vibration, too
    out
        folder for basin.nc, basin.csv and the figure
    """
    settings = how.over(BasinSettings())
    found = in_motion(read(file, asked))
    folder(out, "basin", "push")
    asked_of, through = keywords(settings), None
    if box:
        system = found.design.system()
        asked_of["spread"], through = box_from(system, box, half_widths(system, settings.spread))
    with Progress(f"{settings.starts:g} starts") as progress:
        result = basin(found.design, plane=plane, through=through, **asked_of)
        if result.outcome in ("no_sliding", "failed_runs"):
            raise ComputationFailed(result.outcome)
        smallest = None
        if push:
            progress("the smallest push")
            smallest = dangerous_push(found.design, seed=asked_of["seed"])
    show(f"{found.design.title}, {file}", result)
    if smallest is not None:
        show("", smallest)
    if out is not None:
        from squealbox import plots

        figure = plots.basin_picture(result, push=smallest, title=found.path.name)
        pushes = [] if smallest is None else write(smallest, out, "push")
        print(written(*write(result, out, "basin", figure=figure), *pushes))

"""`squealbox basin`: which starts lead to which motion, how likely each is, and the smallest dangerous push."""

from pathlib import Path
from typing import Annotated, Any

import numpy as np
from cyclopts import Parameter

from squealbox.cli.answers import show
from squealbox.cli.inputs import folder, in_motion, read
from squealbox.cli.options import AS_WRITTEN, Asked
from squealbox.cli.running import ComputationFailed, UsageError
from squealbox.cli.states import States, box_from
from squealbox.cli.tables import kept, written
from squealbox.limit_cycles import Basin, basin, dangerous_push
from squealbox.limit_cycles.attractors.basins import half_widths
from squealbox.limit_cycles.attractors.sections import state_names
from squealbox.waiting import Progress

ABOUT = {"basin_": "which starts lead to which motion: shares, a picture, the smallest push"}

Two = Annotated[tuple[str, str] | None, Parameter(negative="")]
Push = Annotated[bool, Parameter(negative="")]


def basin_(
    file: Path,
    *,
    starts: int = 2000,
    spread: float = 1.0,
    box: States = (),
    plane: Two = None,
    push: Push = False,
    seed: int = 1,
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
    starts
        number of starts
    spread
        size of the box, in V/w and V
    box
        ends of some states, such as x=-1mm:1mm "y'=0:0.2 m/s" (a prime is a velocity); x=0 holds one
    plane
        two states to draw: x y' (a prime is a velocity)
    push
        look for the smallest push that ends in a vibration, too
    seed
        of the starts
    out
        folder for basin.nc, basin.csv and the figure
    """
    if starts < 1 or not (np.isfinite(spread) and spread > 0.0):
        raise UsageError(f"--starts {starts} --spread {spread:g}: expected at least one start and a spread above 0")
    found = in_motion(read(file, asked))
    folder(out, "basin", "push")
    half: Any = spread
    through = None
    if box:
        system = found.design.system()
        half, through = box_from(system, box, half_widths(system, spread))
    with Progress(f"{starts} starts") as progress:
        result = basin(found.design, half, starts, plane=plane, through=through, seed=seed)
        if result.outcome in ("no_sliding", "failed_runs"):
            raise ComputationFailed(result.outcome)
        smallest = None
        if push:
            progress("the smallest push")
            smallest = dangerous_push(found.design, seed=seed)
    show(f"{found.design.title}, {file}", result)
    if smallest is not None:
        show("", smallest)
    if out is not None:
        from squealbox import plots

        figure = plots.basin_picture(result, push=smallest, title=found.path.name)
        push_file = [] if smallest is None else [smallest.save(out / "push.nc")]
        print(written(*kept(result, out / "basin", _columns(result), figure), *push_file))


def _columns(result: Basin) -> dict[str, object]:
    """One row for each start: the state, what it leads to, and how long it ran."""
    names = state_names(result.system)
    units = [*result.system.units, *(f"{unit}/s" for unit in result.system.units)]
    columns: dict[str, object] = {
        f"{name} [{unit}]": result.start[:, i] for i, (name, unit) in enumerate(zip(names, units, strict=True))
    }
    kinds = np.array([*result.kind, "failed", "not settled"], dtype=str)
    return {**columns, "attractor": result.attractor, "kind": kinds[result.attractor], "time [s]": result.time}

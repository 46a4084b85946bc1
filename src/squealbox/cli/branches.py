"""`squealbox branch`: the cycles over a range of a parameter, stable and unstable, and where they begin and end."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from squealbox.cli.answers import keep, written
from squealbox.cli.inputs import AS_FILED, NOTHING_SAID, OneVaried, Said, folder, in_motion, read, readable
from squealbox.cli.options import AS_WRITTEN, Asked
from squealbox.cli.running import ComputationFailed
from squealbox.family import ParameterAxis
from squealbox.limit_cycles import (
    Branch,
    BranchSettings,
    EstimateCurve,
    HopfPoint,
    beside_sliding,
    estimate_curves,
    hopf_point,
    isolated_branches,
    lies_on,
    stable_sliding,
    stretches,
)
from squealbox.limit_cycles import branch as followed
from squealbox.matrices import liveliest
from squealbox.result import Outcome
from squealbox.waiting import Progress
from squealbox.writing import write_table

ABOUT = {"branch": "limit cycles over a range of a parameter: stable, unstable, folds, onset"}

if TYPE_CHECKING:
    from squealbox.design import Design

AS_USUAL = BranchSettings()


def branch(
    file: Path,
    *,
    varies: OneVaried = AS_FILED,
    how: Said[BranchSettings] = NOTHING_SAID,
    asked: Asked = AS_WRITTEN,
    out: Path | None = None,
) -> None:
    """The limit cycles over a range of a parameter: amplitude, stability, and where they begin and end.

    Parameters
    ----------
    file
        design file; its section [branch] says what is varied, unless the options do
    out
        folder for a figure, the tables branch.csv and special.csv, and the data of each branch
    """
    found = read(file, asked)
    varied, settings = varies.of(found.design, found.branch), how.over(AS_USUAL)
    folder(out, "branch", "special")
    found = in_motion(found, varied)
    with Progress("looking for the onset") as progress:
        born, several = all_branches(found.design, varied, settings, progress)
    if not several:
        raise ComputationFailed(Outcome("no_cycle", "no cycle was found in the range: try more runs, or another range"))
    keep(*several)
    print(f"{found.design.title}, {file}")
    if born.outcome.ok:
        print(born.told(8))
    ends = (varied.low, varied.high)
    quiet = stable_sliding(found.design, varied.name, ends)
    for i, one in enumerate(several, 1):
        print(_said(f"Branch {i}", one, quiet))
    print(_coexistence(several, quiet, found.design, varied))
    curves = (
        estimate_curves(found.design, varied.name, (varied.low, varied.high), several) if settings.estimates else ()
    )
    for curve in curves:
        print(f"Estimate beside them: {curve}")
    if out is not None:
        print(written(*_files(several, born, curves, found.design, varied, found.path.name, out)))


def all_branches(
    design: "Design",
    varied: ParameterAxis,
    how: BranchSettings = AS_USUAL,
    progress: Progress | None = None,
) -> tuple[HopfPoint, tuple[Branch, ...]]:
    """The Hopf point, the branch from it and those that runs lead to."""
    bounds, points, say = (varied.low, varied.high), int(varied.points), progress or (lambda text: None)
    several: tuple[Branch, ...] = ()
    born = hopf_point(design, varied.name, bounds)
    if born.outcome.ok and how.start != "runs":
        say("following the branch from the Hopf point")
        first = followed(design, varied.name, bounds, born, method="shooting", points=points)
        several = (first,) if len(first.value) else ()
    if how.start != "hopf":
        say("runs, and the branches they lead to")
        tried = {"values": int(how.at), "starts": int(how.runs)}
        several += isolated_branches(design, varied.name, bounds, known=several, points=points, **tried)
    # runs may lead to a branch that goes on through the whole of an earlier one, which ended after so many points
    return born, tuple(x for i, x in enumerate(several) if not any(lies_on(x, later) for later in several[i + 1 :]))


def _said(name: str, one: Branch, quiet: list[tuple[float, float]]) -> str:
    """A branch in words, and on which stretches its cycles are stable."""
    lines = [f"{name}: {one.summary()}"]
    for ends in stretches(one, [end for each in quiet for end in each]):
        low, high = (one.read_value(one.parameter, end, 7) for end in ends[:2])
        lines.append(f"  {'stable' if ends[2] else 'unstable'} from {low} to {high}")
    return "\n".join(lines)


def _coexistence(
    several: tuple[Branch, ...], quiet: list[tuple[float, float]], design: "Design", varied: ParameterAxis
) -> str:
    """Where a stable cycle exists beside stable steady sliding."""
    both = beside_sliding(several, quiet)
    if not both:
        return "No stable cycle was found where steady sliding is stable."
    ends, unit = readable(design, varied, np.array(both))
    over = " and ".join(f"from {low:.7g} to {high:.7g}" for low, high in ends)
    return (
        f"Stable sliding and a stable cycle coexist: {varied.name} {over} {unit}".rstrip()
        + ". A run there ends in either, by its start."
    )


def _files(
    several: tuple[Branch, ...],
    born: HopfPoint,
    curves: tuple[EstimateCurve, ...],
    design: "Design",
    varied: ParameterAxis,
    title: str,
    out: Path,
) -> list[Path]:
    """Figure, tables, and the data of each branch."""
    from squealbox import plots

    scale, unit = readable(design, varied, 1.0)
    name = f"{varied.name} [{unit or '-'}]"
    system = several[0].inputs["system"]
    dof = liveliest(np.max(np.concatenate([one.amplitude for one in several]), axis=0), system.units)
    tables = [one.table() for one in several]
    table = {"branch": np.repeat(np.arange(1, len(several) + 1), [len(one.value) for one in several])}
    table |= {head: np.concatenate([each[head] for each in tables]) for head in tables[0]}
    labels = [f"branch {i}" for i in range(1, len(several) + 1)] if len(several) > 1 else []
    title = f"{title}, {several[0].inputs['system'].names[dof]}"
    figure = plots.branch_diagram(several, dof=dof, hopf=born, labels=labels, name=name, scale=1.0 / scale,
                                  estimates=curves, title=title)  # fmt: skip
    paths = [*plots.save(figure, out / "branch"), write_table(out / "branch.csv", table)]
    special: dict[str, list[Any]] = {"branch": [], "kind": [], name: [], "uncertainty": []}
    for i, one in enumerate(several, 1):
        special["branch"] += [i] * len(one.special_kind)
        special["kind"] += [str(kind) for kind in one.special_kind]
        special[name] += list(one.special_value * scale)
        special["uncertainty"] += list(one.special_uncertainty * scale)
    paths.append(write_table(out / "special.csv", special))
    return paths + [one.save(out / f"branch_{i}.nc") for i, one in enumerate(several, 1)]

"""`squealbox optimise`: the best design within bounds, one or a front of them."""

from pathlib import Path

from squealbox.cli.answers import show, written
from squealbox.cli.inputs import NOTHING_SAID, Said, folder, keywords, read, small
from squealbox.cli.options import AS_WRITTEN, Asked
from squealbox.cli.running import ComputationFailed, UsageError
from squealbox.files import write_design
from squealbox.studies import SearchSettings
from squealbox.studies import optimise as optimised
from squealbox.waiting import Progress
from squealbox.writing import write

ABOUT = {"optimise": "the best design within bounds: before and after, or a Pareto front"}


def optimise(
    file: Path,
    *,
    how: Said[SearchSettings] = NOTHING_SAID,
    asked: Asked = AS_WRITTEN,
    out: Path | None = None,
) -> None:
    """The best design within bounds and constraints: before and after, what binds, and with several goals their front.

    The section [optimise] of the file names what may be changed and what is wanted; goals over scatter take it from the
    section [scatter].

    Parameters
    ----------
    file
        design file with a section [optimise]
    out
        folder for the figure, the designs as a table, and the best one as a design file
    """
    found = read(file, asked)
    section = found.optimise
    if section is None:
        raise UsageError(f"{file} has no section [optimise], which says what may be changed and what is wanted")
    over = [goal.over for goal in section.goals] + [each.over for each in section.constraints]
    robust = set(over) != {"nominal"}
    if robust and found.scatter is None:
        raise UsageError(f"{file} has goals over scatter but no section [scatter]")
    effort = how.over(section.effort)
    folder(out, "optimum")
    found = small(found)
    with Progress(f"optimising {', '.join(section.variables)}"):
        result = optimised(
            found.design, section.variables, section.goals, section.constraints,
            scatter=found.scatter.scatter if robust and found.scatter else None, **keywords(effort),
        )  # fmt: skip
    show(f"{found.design.title}, {file}", result)
    if out is not None:
        best = [write_design(result.design, out / "optimum.toml")] if result.outcome.ok else []
        print(written(*best, *write(result, out, "optimum", title=found.path.name)))
    if not result.outcome.ok:
        raise ComputationFailed(result.outcome)

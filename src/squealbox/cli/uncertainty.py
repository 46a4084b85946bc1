"""`squealbox scatter`: parameters scatter; how probable is squeal, and which parameter matters?"""

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

from squealbox import studies
from squealbox.cli.answers import keep, written
from squealbox.cli.inputs import NOTHING_SAID, Said, folder, read, small
from squealbox.cli.options import AS_WRITTEN, Asked
from squealbox.cli.running import ComputationFailed, UsageError
from squealbox.files import STUDIES, Scattered
from squealbox.result import Result
from squealbox.studies import SampleSettings
from squealbox.waiting import Progress
from squealbox.writing import write

ABOUT = {"scatter": "parameters scatter: how probable is squeal, and which matters?"}

if TYPE_CHECKING:
    from squealbox.design import Design

Several = Annotated[tuple[str, ...], Parameter(negative="", consume_multiple=True, show_default=False)]
LEARNT = 512  # points a surrogate is made from at most


def scatter(
    file: Path,
    *,
    study: Several = (),
    how: Said[SampleSettings] = NOTHING_SAID,
    asked: Asked = AS_WRITTEN,
    out: Path | None = None,
) -> None:
    """Parameters scatter: how probable is squeal, and which parameter is it that matters?

    The section [scatter] of the file names the quantity, the distribution of each parameter and what is asked.

    Parameters
    ----------
    file
        design file with a section [scatter]
    study
        what is asked: probability, sobol, morris, form, subset, surrogate, bounds; one or several
    out
        folder for figures, tables and results
    """
    found = read(file, asked)
    section = found.scatter
    if section is None:
        raise UsageError(f"{file} has no section [scatter], which says what scatters and how")
    wanted = _wanted(study or section.studies)
    sampled = how.over(section.sampled)
    folder(out, *wanted)
    found = small(found)
    print(f"{found.design.title}, {file}")
    failed = None
    files: list[Path] = []
    for name in wanted:
        with Progress(f"{name}: {section.quantity.name}"):
            result = _run(name, found.design, section, sampled)
        keep(result)
        print(f"\n{name}\n{result}")
        failed = failed or (None if result.outcome.ok else result.outcome)
        if out is not None:
            files += write(result, out, name)
    if out is not None:
        print(f"\n{written(*files)}")
    if failed is not None:
        raise ComputationFailed(failed)


def _wanted(names: tuple[str, ...]) -> list[str]:
    for name in names:
        if name not in STUDIES:
            raise UsageError(f"--study {name[:40]}: expected one of {', '.join(STUDIES)}")
    return list(dict.fromkeys(names))


def _run(name: str, design: "Design", section: Scattered, how: SampleSettings) -> Result:
    count = int(how.samples)
    asked: dict[str, tuple[Callable[..., Result], dict[str, Any]]] = {
        "probability": (studies.squeal_probability, {"samples": count, "method": how.sampling}),
        "sobol": (studies.sobol_indices, {"samples": count}),
        "morris": (studies.morris_effects, {"trajectories": 50}),
        "form": (studies.form, {"samples": count}),
        "subset": (studies.subset_simulation, {"samples": max(count // 2, 500)}),
        "surrogate": (studies.polynomial_chaos, {"samples": min(count, LEARNT)}),
        "bounds": (studies.interval_bounds, {}),
    }
    function, more = asked[name]
    scatter = section.scatter.box() if name == "bounds" else section.scatter
    more |= {} if name in ("surrogate", "bounds") else {"level": how.level}
    return function(design, scatter, section.quantity, seed=int(how.seed), **more)

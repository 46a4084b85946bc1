"""`squealbox scatter`: parameters scatter; how probable is squeal, and which parameter matters?"""

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
from cyclopts import Parameter

from squealbox import studies
from squealbox.cli.answers import keep
from squealbox.cli.inputs import NOTHING_SAID, Said, folder, read, small
from squealbox.cli.options import AS_WRITTEN, Asked
from squealbox.cli.running import ComputationFailed, UsageError
from squealbox.cli.tables import kept, write_csv, written
from squealbox.family import unit_of
from squealbox.files import STUDIES, Scattered
from squealbox.result import Result
from squealbox.studies import SampleSettings
from squealbox.waiting import Progress

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
            files += _files(name, result, found.design, out)
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


def _files(name: str, result: Any, design: "Design", out: Path) -> list[Path]:
    columns = _columns(name, result, design)
    if result.outcome.ok:
        return kept(result, out / name, columns)
    return [result.save(out / f"{name}.nc"), write_csv(out / f"{name}.csv", columns)]


def _columns(name: str, found: Any, design: "Design") -> dict[str, Any]:
    about = found.settings["quantity"]
    unit = about["unit"] or "-"
    value = f"{about['name']} [{unit}]"
    if name in ("probability", "surrogate"):
        columns = {_headed(design, each): found.points[:, i] for i, each in enumerate(found.names)}
        more = {"squeals": found.squeals} if name == "probability" else {f"{value}, not seen": found.held_out}
        return {**columns, value: found.values, **more}
    if name == "subset":
        known = np.isfinite(found.thresholds)
        runs = np.nonzero(known)[0] + 1
        return {"run": runs, value: found.thresholds[known], "probability": found.exceedance[known]}
    columns = {"parameter": np.array(found.names)}
    if name == "sobol":
        for each in ("first", "first_low", "first_high", "total", "total_low", "total_high"):
            columns[each.replace("_", " ")] = getattr(found, each)
    if name == "morris":
        for each in ("strength", "strength_error", "direction", "spread"):
            columns[f"{each.replace('_', ' ')} [{unit}]"] = getattr(found, each)
    if name == "form":
        columns |= {"unit": _units(design, found.names), "median": found.median, "squeals at": found.point}
        columns |= {"in standard deviations": found.normal_point, "importance": found.importance}
    if name == "bounds":
        columns |= {"unit": _units(design, found.names), "least at": found.low_at, "largest at": found.high_at}
    return columns


def _headed(design: "Design", name: str) -> str:
    return f"{name} [{unit_of(design, name) or '-'}]"


def _units(design: "Design", names: Any) -> Any:
    return np.array([unit_of(design, name) or "-" for name in names])

"""`squealbox run`, `status`, `show` and `export`: studies that go on where they were stopped."""

import dataclasses
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import numpy as np
from cyclopts import Parameter

from squealbox.cli import answers
from squealbox.cli.inputs import NOTHING_SAID, Said, changed, folder, free, in_motion, small
from squealbox.cli.options import AllowCode, Changes
from squealbox.cli.running import ComputationFailed, UsageError
from squealbox.cli.study_analyses import UNITS, analysis_of
from squealbox.family import ParameterAxis
from squealbox.files import read_study
from squealbox.studies import LOG, RESULT, Space, Store, WorkerSettings, open_sweep, sweep
from squealbox.waiting import Progress
from squealbox.writing import write, write_table

ABOUT = {
    "run": "a study: any analysis over a space of parameters; stopped or killed, it goes on",
    "status": "how far a study is, and what it said last",
    "show": "what a study has found, also while it runs: table and figure",
    "export": "what a study has found as CSV, NetCDF or MAT",
}

if TYPE_CHECKING:
    from squealbox.studies import Sweep

LINES = 5  # of the log that `status` shows
ROWS = 20  # of the table that `show` prints
WIDEST = 4  # numbers of one answer in it
Where = Annotated[Path, Parameter(show_default=False)]


def run(
    file: Path,
    *,
    out: Path,
    how: Said[WorkerSettings] = NOTHING_SAID,
    scheduler: str | None = None,
    changes: Changes = (),
    allow_code: AllowCode = False,
) -> None:
    """Run a study: an analysis at every point of a space of parameters. Stopped or killed, it goes on when run again.

    Parameters
    ----------
    file
        study file: a brake and a section [study]; examples/study.toml is one to start from
    out
        folder of the study; what was finished there is kept
    scheduler
        address of a Dask scheduler whose workers compute: tcp://head:8786
    changes
        other values of the brake for this study: --set friction.static=0.4 load="2 kN"
    allow_code
        run the Python file of a friction law that the design file names
    """
    found = read_study(file, allow_code=allow_code)
    study = how.over(found.study)
    brake = dataclasses.replace(found.brake, design=changed(found.brake.design, changes))
    prepared = small if study.analysis in ("modes", "onset") else in_motion
    brake = prepared(brake, *_spans(found.space))
    found, design = dataclasses.replace(found, brake=brake), brake.design
    spread = "workers" in how.given or scheduler is None
    workers = int(study.workers) if spread and study.workers is not None else None
    with Progress(f"{len(found.space)} points") as progress:
        table = sweep(
            design, found.space, analysis_of(found), out=out, keep=found.keep,
            units=UNITS if study.analysis == "simulate" else None, seed=int(study.seed),
            chunk=None if study.chunk is None else int(study.chunk), workers=workers, scheduler=scheduler,
            time_limit=study.time_limit if workers or scheduler else None,
            progress=lambda pace: progress(str(pace), pace.share),
        )  # fmt: skip
    if table.outcome == "interrupted":
        raise ComputationFailed(table.outcome)
    answers.show(f"{design.title}, {file}", table)
    print(answers.written(out / RESULT, out / LOG))


def status(directory: Where) -> None:
    """How far is a study, is it running, and what did it say last?

    Parameters
    ----------
    directory
        folder of the study
    """
    store = Store.opened(directory)
    if store.finished:
        print(f"{directory}: finished")
    else:
        total, done = store.frame().total, sum(stop - start for start, stop in store.done)
        failed = sum(summary.failed for summary in store.done.values())
        state = "running" if store.writing else "stopped; the same run command goes on from here"
        print(f"{directory}: {state}\n{done} of {total} points in {len(store.done)} blocks, {failed} failed")
    for name in store.damaged:
        print(f"damaged, to be computed again: {name}")
    log = directory / LOG
    if log.exists():
        print("\n".join(log.read_text(encoding="utf-8").splitlines()[-LINES:]))


def show(directory: Where, *, of: str | None = None, out: Path | None = None) -> None:
    """What a study has found, also while it runs: a table, and a figure with --out.

    Parameters
    ----------
    directory
        folder of the study
    of
        the answer that the figure shows; left out, the first
    out
        folder for sweep.nc, sweep.csv and the figure
    """
    found = open_sweep(directory)
    answers.show("", found)
    print(_rows(found))
    if out is not None:
        from squealbox import plots

        if of is not None and of not in found.answers:
            raise UsageError(f"--of {of[:40]}: expected one of {', '.join(found.answers)}")
        folder(out, "sweep")
        try:
            figure = plots.sweep_overview(found, answer=of, title=str(directory))
        except ValueError as error:
            raise UsageError(f"no figure: {error}") from error
        print(answers.written(*write(found, out, "sweep", figure=figure)))


def export(directory: Where, *, format: Literal["csv", "nc", "mat"] = "csv", to: Path | None = None) -> None:
    """Write what a study has found as one file: CSV for spreadsheets, NetCDF, or MAT for MATLAB.

    Parameters
    ----------
    directory
        folder of the study
    format
        csv, nc or mat
    to
        file to write; left out, sweep.FORMAT in this folder
    """
    found = open_sweep(directory)
    path = to if to is not None else Path(f"sweep.{format}")
    folder(path.parent)
    free(path)
    if format == "csv":
        write_table(path, found.table())
    elif format == "nc":
        found.save(path)
    else:
        from squealbox.cli.matlab import write_mat

        write_mat(path, found)
    print(answers.written(path))


def _rows(found: "Sweep") -> str:
    """The first rows of the table, as text."""
    columns = found.table(ROWS, widest=WIDEST)
    names = list(columns)
    cells = [[_cell(value) for value in columns[name]] for name in names]
    widths = [max(len(name), *(len(cell) for cell in column)) for name, column in zip(names, cells, strict=True)]
    lines = ["  ".join(name.rjust(width) for name, width in zip(names, widths, strict=True))]
    for row in zip(*cells, strict=True):
        lines.append("  ".join(cell.rjust(width) for cell, width in zip(row, widths, strict=True)))
    more = int(found["outcome"].size) - len(cells[0])
    return "\n".join(lines + [f"and {more} more; squealbox export writes them all"] * (more > 0))


def _cell(value: object) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def _spans(space: Space) -> list[ParameterAxis]:
    """The range of each number that a study varies, which a finite-element brake is reduced for."""
    values = {name: np.unique(np.asarray(given)) for axis in space.axes for name, given in axis.values.items()}
    return [
        ParameterAxis(name=name, low=float(each[0]), high=float(each[-1]))
        for name, each in values.items()
        if each.dtype.kind in "fiu" and len(each) > 1
    ]

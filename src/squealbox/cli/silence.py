"""`squealbox silence`: what would silence this brake."""

from pathlib import Path

import numpy as np

from squealbox.cli.answers import keep
from squealbox.cli.inputs import folder, read, small
from squealbox.cli.options import AS_WRITTEN, Asked
from squealbox.cli.running import ComputationFailed, UsageError
from squealbox.cli.tables import write_csv, written
from squealbox.fe.reduced_brake import ReducedBrake
from squealbox.files import NotWritable
from squealbox.files.writing import cure_text
from squealbox.remedies import Remedies
from squealbox.remedies import silence as silenced
from squealbox.waiting import Progress

ABOUT = {"silence": "what would silence this brake: cures ranked, with dose, cost and cautions"}


def silence(
    file: Path,
    *,
    margin: float = 0.1,
    samples: int | None = None,
    seed: int = 0,
    asked: Asked = AS_WRITTEN,
    out: Path | None = None,
) -> None:
    """What would silence this brake: cures ranked by the squeal they leave, with dose, costs and cautions.

    Of a finite-element brake: masses on nodes, and components stiffer, softer, heavier, lighter or more damped, judged
    by all modes of its band. The section [scatter] of the file says how parameters scatter in production; without it a
    usual scatter is assumed and said.

    Parameters
    ----------
    file
        design file; squealbox init writes a first one
    margin
        by which friction may rise without squeal: 0.1 is 10 %
    samples
        brakes in the lot; left out, 2048, of large brakes fewer
    seed
        of the lot
    out
        folder for the table and a figure
    """
    found = read(file, asked)
    if (samples is not None and samples < 1) or seed < 0:
        raise UsageError(f"--samples {samples} --seed {seed}: expected at least 1 and at least 0")
    if not (np.isfinite(margin) and margin >= 0.0):
        raise UsageError(f"--margin {margin}: expected a finite number of at least 0")
    if out is not None:
        folder(out, "silence")
    brake = small(found).design
    with Progress("looking for what silences it"):
        lot = found.scatter.scatter if found.scatter is not None else None
        table = silenced(brake, lot, margin=margin, samples=samples, seed=seed)
    print(f"{found.design.title}, {file}\n{table.summary(len(table))}")
    reduced = isinstance(brake, ReducedBrake)
    lines = [f"# {line}" if reduced else _in_a_file(table, row) for row, line in enumerate(table.line)]
    if lines and not reduced:
        where = "with these values" if table.values[0] else "with these lines at its end"
        print(f"{table.name[0]}: {file.name} {where}\n\n{lines[0]}")
    keep(table)
    if out is not None:
        from squealbox import plots

        columns = {name: np.array(column) for name, *column in zip(table.heads(), *table.rows(), strict=True)}
        columns["python"], columns["toml"] = table.line, np.array(lines)
        paths = [table.save(out / "silence.nc"), write_csv(out / "silence.csv", columns)]
        print(written(*paths, *plots.save(plots.plot(table, title=found.path.name), out / "silence")))
    if not table.outcome.ok:
        raise ComputationFailed(table.outcome)


def _in_a_file(table: Remedies, row: int) -> str:
    """The lines of a design file that make the cure of a row."""
    brake = table.inputs["system"]
    try:
        return cure_text(table.design(row), brake, table.values[row])
    except NotWritable as error:
        return f"# not in a file: {error}"

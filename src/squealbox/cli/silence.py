"""`squealbox silence`: what would silence this brake."""

from pathlib import Path

import numpy as np

from squealbox.cli.answers import keep, written
from squealbox.cli.inputs import NOTHING_SAID, Said, folder, keywords, read, small
from squealbox.cli.options import AS_WRITTEN, Asked
from squealbox.cli.running import ComputationFailed
from squealbox.fe import ReducedBrake
from squealbox.files import NotWritable, cure_text
from squealbox.remedies import Remedies, SilenceSettings
from squealbox.remedies import silence as silenced
from squealbox.waiting import Progress
from squealbox.writing import write

ABOUT = {"silence": "what would silence this brake: cures ranked, with dose, cost and cautions"}


def silence(
    file: Path,
    *,
    how: Said[SilenceSettings] = NOTHING_SAID,
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
    out
        folder for the table and a figure
    """
    found = read(file, asked)
    settings = how.over(SilenceSettings())
    folder(out, "silence")
    brake = small(found).design
    with Progress("looking for what silences it"):
        lot = found.scatter.scatter if found.scatter is not None else None
        table = silenced(brake, lot, **keywords(settings))
    print(f"{found.design.title}, {file}\n{table.summary(len(table))}")
    reduced = isinstance(brake, ReducedBrake)
    lines = [f"# {line}" if reduced else _in_a_file(table, row) for row, line in enumerate(table.line)]
    if lines and not reduced:
        where = "with these values" if table.values[0] else "with these lines at its end"
        print(f"{table.name[0]}: {file.name} {where}\n\n{lines[0]}")
    keep(table)
    if out is not None:
        columns = {**table.table(), "toml": np.array(lines)}
        print(written(*write(table, out, "silence", table=columns, title=found.path.name)))
    if not table.outcome.ok:
        raise ComputationFailed(table.outcome)


def _in_a_file(table: Remedies, row: int) -> str:
    """The lines of a design file that make the cure of a row."""
    brake = table.inputs["system"]
    try:
        return cure_text(table.design(row), brake, table.values[row])
    except NotWritable as error:
        return f"# not in a file: {error}"

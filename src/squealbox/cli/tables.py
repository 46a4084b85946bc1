"""Numbers as a CSV file that spreadsheets open: a first line with names and units, then one row each."""

import csv
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from squealbox.labelled import whole
from squealbox.result import Result


def write_csv(path: Path, columns: Mapping[str, Any]) -> Path:
    """Write columns of equal length to `path`, whole or not at all; the keys are the first line."""
    with whole(path) as part, part.open("w", encoding="utf-8", newline="") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(columns)
        arrays = [np.asarray(column) for column in columns.values()]
        writer.writerows(zip(*(_cells(array) for array in arrays), strict=True))
    return path


def kept(result: Result, stem: Path, columns: Any = None, figure: Any = None, **how: Any) -> list[Path]:
    """A result as files of one name: data, a table of columns, a figure; left out, the one that `how` asks of it."""
    from squealbox import plots

    drawn = plots.plot(result, **how) if figure is None else figure
    table = [] if columns is None else [write_csv(stem.with_suffix(".csv"), columns)]
    return [result.save(stem.with_suffix(".nc")), *table, *plots.save(drawn, stem)]


def written(*paths: Path) -> str:
    """A line that says which files there are now."""
    return f"written to {paths[0].parent}: {', '.join(path.name for path in paths)}"


def _cells(array: Any) -> list[Any]:
    return [f"{value:.10g}" for value in array] if array.dtype.kind == "f" else array.tolist()

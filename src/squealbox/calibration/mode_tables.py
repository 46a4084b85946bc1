"""Modes of a test or of another code, read from a table, to stand beside those of a model.

A table has a row for each mode: a column "frequency [Hz]", perhaps "damping ratio [-]" or "[%]" or "growth rate [1/s]",
and a column for each place of the mode shape, named as the model names it, with real or complex numbers ("0.3+0.1j").
A universal file holds data sets 55; its places are "12x", the node and the axis.
"""

import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from squealbox.arguments import public
from squealbox.cells import cells
from squealbox.signals import SignalError, universal_sets

AXES = "xyz"


@dataclass(frozen=True, eq=False)
class ModeTable:
    """Measured modes: `frequency` (m,) [Hz], `damping_ratio` (m,), NaN where it is not told, `shapes` (places, m)."""

    frequency: Any
    damping_ratio: Any
    places: tuple[str, ...]
    shapes: Any
    source: str = ""


@public()
def read_mode_table(path: str | os.PathLike[str]) -> ModeTable:
    """The modes in a table (.csv, .txt) or a universal file (.uff, .unv, data sets 55).

    Raises `SignalError`, one sentence with the file's name, for a file that holds no modes.
    """
    path = Path(path)
    try:
        found = _universal(path) if path.suffix.lower() in (".uff", ".unv") else _table(path)
    except OSError as error:
        raise SignalError(f"{path.name}: cannot be read: {error.strerror or error}") from error
    frequency, damping, places, shapes = found
    if not frequency.size or not np.all(np.isfinite(frequency) & (frequency >= 0.0)):
        raise SignalError(f"{path.name}: holds no modes with frequencies of 0 Hz or more")
    if not np.all(np.isfinite(shapes)):
        raise SignalError(f"{path.name}: a mode shape has a value that is not finite")
    return ModeTable(frequency, damping, places, shapes, path.name)


def _table(path: Path) -> tuple[Any, Any, tuple[str, ...], Any]:
    try:
        rows = [row for _, row in cells(path.read_bytes())]
    except ValueError as error:
        raise SignalError(f"{path.name}: is no table of modes") from error
    head = [cell.strip() for cell in rows[0]] if rows else []
    names = [cell.partition("[")[0].strip().lower() for cell in head]
    if "frequency" not in names:
        raise SignalError(f"{path.name}: has no column 'frequency [Hz]': there is {', '.join(head)[:80] or 'nothing'}")
    if any(len(row) != len(head) for row in rows):
        raise SignalError(f"{path.name}: has rows of different lengths, expected {len(head)} cells in each")
    columns = dict(zip(names, np.array(rows[1:], dtype=object).reshape(-1, len(head)).T, strict=True))
    units = dict(zip(names, (cell.partition("[")[2].partition("]")[0].strip() for cell in head), strict=True))
    frequency = _numbers(path, "frequency", columns.pop("frequency")).real
    frequency = frequency * {"khz": 1e3}.get(units["frequency"].lower(), 1.0)
    damping = np.full(frequency.size, np.nan)
    if "damping ratio" in columns:
        damping = _numbers(path, "damping ratio", columns.pop("damping ratio")).real
        damping = damping * (0.01 if units["damping ratio"] == "%" else 1.0)
    elif "growth rate" in columns:
        growth = _numbers(path, "growth rate", columns.pop("growth rate")).real
        damping = -growth / np.hypot(growth, 2.0 * np.pi * frequency)
    written = dict(zip(names, head, strict=True))
    places = tuple(written[name].partition("[")[0].strip() for name in columns)
    shapes = [_numbers(path, place, column) for place, column in zip(places, columns.values(), strict=True)]
    return frequency, damping, places, np.array(shapes, dtype=complex).reshape(len(places), frequency.size)


def _numbers(path: Path, name: str, column: np.ndarray) -> Any:
    try:
        return np.array([complex(cell.strip().replace(" ", "").replace("i", "j")) for cell in column])
    except ValueError as error:
        raise SignalError(f"{path.name}: the column {name!r} holds what is no number: {error}") from error


def _universal(path: Path) -> tuple[Any, Any, tuple[str, ...], Any]:
    found = [each for each in universal_sets(path) if each.get("type") == 55]
    frequency, damping, shapes = [], [], []
    places: tuple[str, ...] = ()
    for each in found:
        value = complex(each["eig"]) if each.get("eig") is not None else None
        if value is not None:
            frequency.append(abs(value.imag) / (2.0 * np.pi))
            damping.append(-value.real / abs(value) if value else np.nan)
        else:
            frequency.append(float(each.get("freq", np.nan)))
            damping.append(float(each.get("modal_damp_vis") or np.nan))
        nodes = np.atleast_1d(each.get("node_nums", ())).astype(int)
        moved = [np.asarray(each.get(f"r{k}", ()), dtype=complex) for k in (1, 2, 3)]
        shapes.append(np.concatenate([part for part in moved if part.size == nodes.size] or [np.zeros(0)]))
        axes = [AXES[k] for k in range(3) if moved[k].size == nodes.size]
        own = tuple(f"{node}{axis}" for axis in axes for node in nodes)
        if places and own != places:
            raise SignalError(f"{path.name}: its modes are of different nodes, expected the same in all")
        places = own
    return np.array(frequency), np.array(damping), places, np.array(shapes, dtype=complex).reshape(-1, len(places)).T

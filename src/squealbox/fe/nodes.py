"""Places of nodes: from a CSV ``node, x, y, z[, component]`` or from the input file of Abaqus, Nastran or Ansys."""

import csv
import os
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from squealbox.fe.readers.matrix import MatrixFileError
from squealbox.fe.readers.numbers import number, text_lines
from squealbox.fe.units import unit_system


@dataclass(frozen=True, eq=False)
class Nodes:
    """Node numbers (k,), places (k, 3) [m when units are known] and the component each belongs to, or ""."""

    numbers: Any
    places: Any
    components: tuple[str, ...] = ()

    def at(self, node: int) -> Any:
        """The place of `node`, shape (3,); `KeyError` for one that is not here."""
        found = np.flatnonzero(self.numbers == node)
        if not found.size:
            raise KeyError(node)
        return self.places[found[0]]


def read_nodes(path: str | os.PathLike[str], units: str | None = None) -> Nodes:
    """The nodes of a file; raises `MatrixFileError` with the line."""
    path = Path(path)
    try:
        with path.open("rb") as stream:
            lines = list(text_lines(path, stream))
    except OSError as error:
        raise MatrixFileError(path, f"cannot be read: {error.strerror or error}") from error
    ending = path.suffix.lower()
    if ending == ".inp":
        rows = _abaqus(path, lines)
    elif ending in (".bdf", ".dat", ".nas", ".pch"):
        rows = _nastran(path, lines)
    else:
        rows = _table(path, lines)
    if not rows:
        raise MatrixFileError(path, "names no nodes: expected node, x, y, z")
    numbers = np.array([row[0] for row in rows], dtype=np.int64)
    if len(np.unique(numbers)) != len(numbers):
        values, counts = np.unique(numbers, return_counts=True)
        twice = values[counts > 1][0]
        raise MatrixFileError(path, f"names node {twice} twice: expected each once")
    length = unit_system(units).length if units else 1.0
    places = np.array([row[1] for row in rows], dtype=float) * length
    return Nodes(numbers, places, tuple(row[2] for row in rows))


def _place(path: Path, at: int, words: list[str]) -> tuple[int, list[float]]:
    try:
        node = int(words[0])
        return node, [number(word) if word.strip() else 0.0 for word in words[1:4]]
    except (ValueError, IndexError) as error:
        raise MatrixFileError(path, f"{','.join(words)[:50]!r}: expected node, x, y, z", at) from error


def _table(path: Path, lines: list[tuple[int, str]]) -> list[Any]:
    rows: list[Any] = []
    for at, text in lines:
        words = [word.strip() for word in next(csv.reader([text]))] if text.strip() else []
        if not words or words[0].startswith("#") or (not rows and not re.match(r"[+-]?\d", words[0])):
            continue  # a line of headings
        if len(words) not in (4, 5):
            raise MatrixFileError(
                path, f"{text[:50]!r} has {len(words)} columns: expected node, x, y, z[, component]", at
            )
        rows.append((*_place(path, at, words), words[4] if len(words) == 5 else ""))
    return rows


def _abaqus(path: Path, lines: list[tuple[int, str]]) -> list[Any]:
    rows, inside = [], False
    for at, text in lines:
        if text.startswith("**") or not text.strip():
            continue
        if text.startswith("*"):
            inside = text.upper().split(",")[0].strip() == "*NODE"
        elif inside:
            words = [*text.split(","), "", "", ""][:4]
            rows.append((*_place(path, at, words), ""))
    return rows


def _nastran(path: Path, lines: list[tuple[int, str]]) -> list[Any]:
    rows = []
    for at, text in lines:
        if not text.upper().startswith("GRID") or text.upper().startswith("GRID*"):
            if text.upper().startswith("GRID*"):
                raise MatrixFileError(path, "a GRID of large fields: give node, x, y, z as CSV instead", at)
            continue
        words = text.split(",") if "," in text else [text[i : i + 8] for i in range(0, 48, 8)]
        words += [""] * (6 - len(words))
        if words[2].strip() not in ("", "0"):
            raise MatrixFileError(
                path, f"GRID {words[1].strip()} has its place in coordinate system {words[2].strip()}", at
            )
        rows.append((*_place(path, at, [words[1].strip(), *words[3:6]]), ""))
    return rows

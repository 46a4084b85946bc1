"""Contact pairs of an interface: a CSV table with headings, one pair a line.

    slave, master, nx, ny, nz, area                       the least; lengths in the units of the structure
    slave, master, weight, master, weight, ..., nx, ...   an unmatched interface: a point between several masters
    ..., normal_force, stiffness, tx, ty, tz, name        what one pair has of its own

The normal points from the slave, the pad say, to the master; pressing is positive.
"""

import csv
import os
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from squealbox.fe.readers.matrix import MatrixFileError
from squealbox.fe.readers.numbers import number, text_lines

VECTORS = {"normal": ("nx", "ny", "nz"), "sliding": ("tx", "ty", "tz")}
NUMBERS = ("area", "normal_force", "stiffness")
KNOWN = ("slave", "master", "weight", *VECTORS["normal"], *VECTORS["sliding"], *NUMBERS, "name")


@dataclass(frozen=True, eq=False)
class Pair:
    """One contact pair: a slave, masters with weights that add up to 1, the normal from slave to master, and its own.

    normal and sliding are unit vectors or None, in global directions.
    """

    line: int
    slave: int
    masters: tuple[tuple[int, float], ...]
    normal: Any = None
    sliding: Any = None
    area: float | None = None
    normal_force: float | None = None
    stiffness: float | None = None
    name: str = ""


def read_pairs(path: str | os.PathLike[str]) -> tuple[Pair, ...]:
    """The pairs of a CSV; raises `MatrixFileError` with file and line."""
    path = Path(path)
    pairs: list[Pair] = []
    heads: list[str] = []
    try:
        with path.open("rb") as stream:
            for at, text in text_lines(path, stream):
                if not text.strip() or text.lstrip().startswith("#"):
                    continue
                words = [word.strip() for word in next(csv.reader([text]))]
                if not heads:
                    heads = _headings(path, at, words)
                else:
                    pairs.append(_pair(path, at, heads, words))
    except OSError as error:
        raise MatrixFileError(path, f"cannot be read: {error.strerror or error}") from error
    if not pairs:
        raise MatrixFileError(path, "holds no pairs: expected a line of headings and a pair a line")
    return tuple(pairs)


def _headings(path: Path, at: int, words: list[str]) -> list[str]:
    heads = [re.sub(r"[_ ]?\d+$", "", word.lower()) if re.match(r"(master|weight)", word.lower()) else word.lower()
             for word in words]  # fmt: skip
    unknown = [head for head in heads if head not in KNOWN]
    if unknown:
        bracket = " (no unit in a heading: numbers are in the units of the structure)" if "[" in unknown[0] else ""
        raise MatrixFileError(
            path, f"the heading {unknown[0][:30]!r} is unknown{bracket}: expected {', '.join(KNOWN)}", at
        )
    twice = [head for head in heads if heads.count(head) > 1 and head not in ("master", "weight")]
    if twice or "slave" not in heads or "master" not in heads:
        raise MatrixFileError(
            path, f"headings {', '.join(words)[:60]!r}: expected each once, slave and master among them", at
        )
    if heads.count("weight") not in (0, heads.count("master")):
        raise MatrixFileError(path, "expected as many weights as masters", at)
    return heads


def _pair(path: Path, at: int, heads: list[str], words: list[str]) -> Pair:
    if len(words) != len(heads):
        raise MatrixFileError(path, f"has {len(words)} columns: expected {len(heads)}, as many as headings", at)
    values: dict[str, list[str]] = {}
    for head, word in zip(heads, words, strict=True):
        values.setdefault(head, []).append(word)
    slave = _node(path, at, values["slave"][0], "slave")
    masters = [_node(path, at, word, "master") for word in values["master"] if word]
    if not masters:
        raise MatrixFileError(path, "no master: expected at least one", at)
    given = [word for word in values.get("weight", []) if word]
    weights = [_number(path, at, word, "weight") for word in given] or [1.0 / len(masters)] * len(masters)
    if len(weights) != len(masters) or abs(sum(weights) - 1.0) > 1e-6:
        raise MatrixFileError(path, f"{len(weights)} weights with the sum {sum(weights):.6g}: expected the sum 1", at)
    vectors = {name: _vector(path, at, values, parts, name) for name, parts in VECTORS.items()}
    numbers = {name: _number(path, at, values[name][0], name) for name in NUMBERS if name in values and values[name][0]}
    if numbers.get("area", 1.0) <= 0.0 or numbers.get("stiffness", 0.0) < 0.0:
        raise MatrixFileError(path, "area and stiffness: expected above zero", at)
    name = values.get("name", [""])[0]
    return Pair(at, slave, tuple(zip(masters, weights, strict=True)), **vectors, **numbers, name=name)


def _node(path: Path, at: int, word: str, what: str) -> int:
    if not re.fullmatch(r"\d{1,12}", word):
        raise MatrixFileError(path, f"{word[:20]!r} as {what}: expected a node number", at)
    return int(word)


def _number(path: Path, at: int, word: str, what: str) -> float:
    try:
        value = number(word)
    except ValueError as error:
        raise MatrixFileError(path, f"{error}: expected a number as {what}", at) from error
    if not np.isfinite(value):
        raise MatrixFileError(path, f"{word[:20]!r} as {what}: expected a finite number", at)
    return value


def _vector(path: Path, at: int, values: dict[str, list[str]], parts: tuple[str, ...], what: str) -> Any:
    words = [values.get(part, [""])[0] for part in parts]
    if not any(words):
        return None
    vector = np.array([_number(path, at, word or "0", part) for word, part in zip(words, parts, strict=True)])
    length = float(np.linalg.norm(vector))
    if not 1e-12 < length < 1e12:
        raise MatrixFileError(path, f"a {what} direction of length {length:g}: expected a direction", at)
    return vector / length

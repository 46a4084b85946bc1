"""Nastran DMIG cards in a punch or bulk data file: fixed fields of 8 or 16 that may touch, or free fields with commas.

    DMIG    KAAX           0       6       2       0              10     name, 0, form, types, polar, columns
    DMIG*   KAAX                     1               3                    column: grid, component
    *                      1               3 6.788227013D+06             row: grid, component, real[, imaginary]

Form 6 is one half of a symmetric matrix, 1 a square one, 2 and 9 rectangular. A row without entries is not named.
"""

from dataclasses import dataclass, field
from pathlib import Path
from typing import BinaryIO

import numpy as np

from squealbox.fe.readers.labels import between_labels, coded, decoded_labels
from squealbox.fe.readers.matrix import OTHER, Entries, FileMatrix, MatrixFile, MatrixFileError, complete, kind_of
from squealbox.fe.readers.numbers import number, significant_digits, text_lines


@dataclass
class _Card:
    """A matrix while it is read."""

    name: str
    form: int
    is_complex: bool
    columns_said: int
    line: int
    column: tuple[int, int] | None = None
    entries: list[tuple[int, int, int, int, complex, int]] = field(default_factory=list)
    words: list[str] = field(default_factory=list)


def read_dmig(path: Path, stream: BinaryIO) -> MatrixFile:
    """Every DMIG of the file; other cards are passed over."""
    cards: dict[str, _Card] = {}
    current: _Card | None = None
    wide = False
    ended = False
    for at, text in text_lines(path, stream):
        if not text.strip() or text.lstrip().startswith("$"):
            continue
        head = text[:8].upper().replace(",", " ").split()
        word = head[0] if head else ""
        if word.rstrip("*") == "DMIG":
            wide = word.endswith("*")
            current = _dmig(path, at, text, wide, cards)
            ended = False
        elif current is not None and (text[0] in "*+ " or text.startswith(",")) and not ended:
            _rows(path, at, text, wide or text[0] == "*", current)
        else:
            current, ended = None, True
    if not cards:
        raise MatrixFileError(path, "holds no DMIG: expected matrices, which an OP4 file beside it may hold")
    found = tuple(_finished(path, card) for card in cards.values())
    return MatrixFile(path, "Nastran DMIG punch", found, _digits_note(found))


def _digits_note(found: tuple[FileMatrix, ...]) -> tuple[str, ...]:
    digits = max((matrix.digits or 16 for matrix in found), default=16)
    if digits > 11:
        return ()
    return (f"numbers have {digits} digits: rigid and soft modes are found less well than in the code itself",)


def _fields(text: str, wide: bool) -> list[str]:
    """The fields behind the first of a card, in pairs of 16 when wide."""
    if "," in text:
        return [part.strip() for part in text.split(",")[1:]]
    width = 16 if wide else 8
    most = 72
    return [text[i : i + width].strip() for i in range(8, min(len(text), most), width)]


def _whole(path: Path, at: int, word: str, what: str) -> int:
    try:
        value = int(word) if word else 0
    except ValueError as error:
        raise MatrixFileError(path, f"{word[:20]!r} as {what}: expected a whole number", at) from error
    if not 0 <= value < 2**31:
        raise MatrixFileError(path, f"{value} as {what}: expected a whole number from 0 on", at)
    return value


def _dmig(path: Path, at: int, text: str, wide: bool, cards: dict[str, _Card]) -> _Card:
    words = _fields(text, wide)
    words += [""] * (8 - len(words))
    name = words[0]
    if not name:
        raise MatrixFileError(path, "a DMIG without a name", at)
    if name not in cards:
        if words[1] not in ("0", ""):
            raise MatrixFileError(path, f"DMIG {name[:8]} begins with a column: expected its header first", at)
        form, kind = _whole(path, at, words[2], "the form"), _whole(path, at, words[3], "the type")
        if form not in (1, 2, 6, 8, 9) or kind not in (1, 2, 3, 4):
            raise MatrixFileError(
                path, f"DMIG {name} has form {form} and type {kind}: expected form 1, 2, 6 or 9 and type 1 to 4", at
            )
        said = next((word for word in reversed(words[5:]) if word), "")
        cards[name] = _Card(name, form, kind > 2, _whole(path, at, said, "the number of columns"), at)
        return cards[name]
    card = cards[name]
    if words[1] == "0" and words[2] in ("1", "2", "6", "8", "9") and words[3] in ("1", "2", "3", "4"):
        raise MatrixFileError(path, f"a second header of DMIG {name}: expected one", at)
    card.column = (_whole(path, at, words[1], "a grid"), _whole(path, at, words[2], "a component"))
    if not 0 <= card.column[1] <= 6 and card.form not in (2, 9):
        raise MatrixFileError(path, f"component {card.column[1]} of grid {card.column[0]}: expected 0 to 6", at)
    rest = words[3:] if wide else words[4:]
    _take(path, at, list(rest), card)
    return card


def _rows(path: Path, at: int, text: str, wide: bool, card: _Card) -> None:
    if card.column is None:
        raise MatrixFileError(path, f"rows of DMIG {card.name} before its first column", at)
    if not any(_fields(text, wide)):
        raise MatrixFileError(path, "a continuation without fields: expected grid, component, value", at)
    _take(path, at, _fields(text, wide), card)


def _take(path: Path, at: int, words: list[str], card: _Card) -> None:
    for i in range(0, len(words), 4):
        part = [*words[i : i + 4], "", "", "", ""][:4]
        if not any(part):
            continue
        grid, component = _whole(path, at, part[0], "a grid"), _whole(path, at, part[1], "a component")
        if component > 6:
            raise MatrixFileError(path, f"component {component} of grid {grid}: expected 0 to 6", at)
        try:
            real = number(part[2])
            value: complex = complex(real, number(part[3])) if card.is_complex else real
        except ValueError as error:
            count = "two numbers" if card.is_complex else "a number"
            raise MatrixFileError(path, f"{error}: expected grid, component and {count}", at) from error
        if not card.is_complex and part[3]:
            raise MatrixFileError(path, f"{part[3]!r} behind a real value: expected nothing there", at)
        column = card.column or (0, 0)
        card.entries.append((grid, component, column[0], column[1], value, at))
        if len(card.words) < 20:
            card.words.append(part[2])


def _in_order(path: Path, card: _Card, rows: np.ndarray, columns: np.ndarray, lines: np.ndarray) -> None:
    """The code writes columns, and rows in each, in ascending order; a few lines out of order are damage."""
    same = columns[1:] == columns[:-1]
    wrong = np.flatnonzero(np.where(same, rows[1:] <= rows[:-1], columns[1:] < columns[:-1]))
    if card.form == 6:
        upper = rows <= columns
        side = upper if upper.mean() > 0.5 else rows >= columns
        wrong = np.concatenate([wrong, np.flatnonzero(~side) - 1])
    if 0 < len(wrong) <= 3 < len(rows):
        raise MatrixFileError(
            path,
            f"DMIG {card.name} has a row or column out of order: lines were moved or damaged",
            int(lines[wrong[0] + 1]),
        )


def _finished(path: Path, card: _Card) -> FileMatrix:
    if not card.entries:
        raise MatrixFileError(path, f"DMIG {card.name} has no entries: expected some", card.line)
    table = [np.array(column) for column in zip(*card.entries, strict=True)]
    card.entries = []
    rows, columns = coded(path, table[0], table[1]), coded(path, table[2], table[3])
    _in_order(path, card, rows, columns, table[5])
    kind, digits = kind_of(card.name), significant_digits(card.words)
    if card.form in (2, 9):
        codes, places = np.unique(rows), np.unique(columns)
        return complete(
            path,
            card.name,
            OTHER,
            Entries(
                np.searchsorted(codes, rows),
                np.searchsorted(places, columns),
                table[4],
                lambda i: int(table[5][i]),
            ),
            (len(codes), max(len(places), 1)),
            "full",
            labels=decoded_labels(codes),
            column_labels=decoded_labels(places),
            digits=digits,
        )
    rule = "half" if card.form == 6 else "full"
    entries = Entries(rows, columns, table[4], lambda i: int(table[5][i]))
    found = between_labels(path, card.name, kind, entries, rule, digits=digits)
    short = card.columns_said - len(found.labels)
    if short > 0 and kind == "stiffness":
        raise MatrixFileError(
            path,
            f"DMIG {card.name} says {card.columns_said} columns and holds {len(found.labels)}: the file was cut short",
            card.line,
        )
    if short > 0:
        from dataclasses import replace

        found = replace(found, notes=(f"{short} of {card.columns_said} freedoms have no entry",))
    return found

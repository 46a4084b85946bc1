"""A TOML file, read with care, and what is wrong with it: every problem at once, each with its line and key."""

import re
import stat
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

from squealbox.files.lines import Key, dotted, key_lines, line_of

LARGEST = 1_000_000  # bytes of a design file; matrices larger than this stand in files of their own
MOST = 100  # problems said in full; a file with more has one cause
_LINE = re.compile(r" \(at line (\d+), column (\d+)\)$| \(at end of document\)$")
_BARE = re.compile(
    r"\s*([\w.]+)\s*=\s*([-+]?[\d.]+(?:e[-+]?\d+)?\s*[^\W\d_][\w/^ ]*?)\s*(?:#|$)"
)  # a number and letters, without quotes


@dataclass(frozen=True)
class Problem:
    """One thing that is wrong: where it stands, its key, and one sentence."""

    path: Path
    line: int
    key: str
    message: str

    def __str__(self) -> str:
        key = f" {self.key}:" if self.key else ""
        line = f":{self.line}" if self.line else ""
        return f"{self.path}{line}:{key} {self.message}"


class DesignFileError(ValueError):
    """A file that is not a design; `problems` holds all that is wrong with it, in the order of its lines."""

    def __init__(self, problems: list[Problem]) -> None:
        self.problems = tuple(sorted(problems, key=lambda problem: problem.line))
        super().__init__("\n".join(str(problem) for problem in self.problems))


@dataclass
class Document:
    """The tables of one file, and the problems found in it so far."""

    path: Path
    text: str
    tables: Mapping[str, Any]
    problems: list[Problem] = field(default_factory=list)
    faulty: set[str | int] = field(default_factory=set)  # first parts of the keys with problems
    unsaid: int = 0
    cautions: list[str] = field(default_factory=list)  # what a reader of the results must know of the file
    allow_code: bool = False  # may a friction law be run that is Python code?
    beside: bool = True  # may files be opened that it names? not those of a text from elsewhere

    @cached_property
    def lines(self) -> dict[Key, int]:
        """The line of each key; walked through only when there is something to say."""
        return key_lines(self.text)

    def problem(self, key: Key, message: str) -> None:
        """Note what is wrong with `key` and read on."""
        self.faulty.update(key[:1])
        if len(self.problems) >= MOST:
            self.unsaid += 1
        else:
            self.problems.append(Problem(self.path, line_of(self.lines, key), dotted(key), message))

    def error(self) -> DesignFileError:
        """All that was wrong, to be raised."""
        problems = list(self.problems)
        if self.unsaid:
            last = max(self.lines.values(), default=1)
            problems.append(Problem(self.path, last, "", f"and {self.unsaid} more problems like these"))
        return DesignFileError(problems)


def open_document(path: Path) -> Document:
    """The tables of a TOML file; `DesignFileError` when it cannot be read as one."""
    return document_of(path, _text(path))


def document_of(path: Path, text: str) -> Document:
    """The tables of a TOML text that is called `path`; `DesignFileError` when it is none."""
    try:
        tables = tomllib.loads(text)
    except RecursionError as error:
        raise _error(path, "tables or arrays are nested too deeply") from error
    except ValueError as error:
        raise _syntax_error(path, text, str(error)) from error
    return Document(path, text, tables)


def read_bytes(path: Path, largest: int) -> bytes:
    """The bytes of an ordinary file no longer than `largest`; `OSError` says what it is instead."""
    about = path.stat()
    if not stat.S_ISREG(about.st_mode):
        raise OSError("it is a folder" if stat.S_ISDIR(about.st_mode) else "it is not an ordinary file")
    if about.st_size > largest:
        raise OSError(f"it has {about.st_size} bytes, expected at most {largest}")
    return path.read_bytes()


def _text(path: Path) -> str:
    try:
        raw = read_bytes(path, LARGEST)
    except FileNotFoundError as error:
        raise _error(path, "there is no such file") from error
    except (OSError, ValueError) as error:  # ValueError: a NUL in the name
        reason = error.strerror if isinstance(error, OSError) and error.strerror else error
        raise _error(path, f"cannot be read: {reason}") from error
    try:
        return raw.decode("utf-8-sig").replace("\r\n", "\n")
    except UnicodeDecodeError as error:
        line = raw.count(b"\n", 0, error.start) + 1
        raise _error(path, f"byte 0x{raw[error.start]:02x} is not UTF-8 text: expected a TOML file", line) from error


def _syntax_error(path: Path, text: str, message: str) -> DesignFileError:
    place = _LINE.search(message)
    what = message[: place.start()] if place else message
    if place is None or place[1] is None:
        line = text.count("\n") + 1 if place else 0
        return _error(path, f"not TOML: {_sentence(what)}", line)
    line = int(place[1])
    bare = _BARE.match(text.split("\n")[line - 1])
    hint = f'; a value with a unit stands in quotes: {bare[1]} = "{bare[2]}"' if bare else ""
    return _error(path, f"not TOML: {_sentence(what)} (column {place[2]}){hint}", line)


def _sentence(text: str) -> str:
    return text[:1].lower() + text[1:].split(";")[0]


def _error(path: Path, message: str, line: int = 0) -> DesignFileError:
    return DesignFileError([Problem(path, line, "", message)])

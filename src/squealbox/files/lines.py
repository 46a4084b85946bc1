"""On which line of a TOML text each key stands; the standard library's parser does not say.

The text has been read by `tomllib` before, so it is known to be right and the walk below only has to keep count.
A key is its path: ``("friction", "static")``, with the number of the element for arrays and arrays of tables.
"""

import re
import tomllib
from bisect import bisect_right
from typing import Any

Key = tuple[str | int, ...]

_SPACE = re.compile(r"(?:[ \t\r\n]+|#[^\n]*)*")
_BARE_KEY = re.compile(r"[A-Za-z0-9_-]+")
_SCALAR = re.compile(r"[^,\]}#\n]+")
_STRINGS = {
    '"""': re.compile(r'"""(?:[^\\]|\\.)*?"{3,5}', re.DOTALL),
    "'''": re.compile(r"'''.*?'{3,5}", re.DOTALL),
    '"': re.compile(r'"(?:[^"\\\n]|\\.)*"'),
    "'": re.compile(r"'[^'\n]*'"),
}


def key_lines(text: str) -> dict[Key, int]:
    """The line, from 1, of every key, table and array element of a valid TOML text."""
    return _TextWalk(text).lines


def line_of(lines: dict[Key, int], key: Key) -> int:
    """The line of `key`, or of the nearest table it would stand in; 1 for the file itself."""
    while key and key not in lines:
        key = key[:-1]
    return lines.get(key, 1)


def dotted(key: Key) -> str:
    """A path as people write it, such as ``contact[0].friction.static``."""
    text = ""
    for part in key:
        name = part if isinstance(part, int) or _BARE_KEY.fullmatch(part) else ascii(part)
        name = name if isinstance(name, int) or len(name) <= 40 else f"{name[:30]}..."
        text += f"[{name}]" if isinstance(name, int) else f".{name}" if text else name
    return text


class _TextWalk:
    """One pass over the text; `at` is the place reached."""

    def __init__(self, text: str) -> None:
        self.text, self.at = text, 0
        self.starts = [0, *(match.end() for match in re.finditer("\n", text))]
        self.lines: dict[Key, int] = {}
        self.counts: dict[Key, int] = {}
        table: Key = ()
        while self.skip():
            if text.startswith("[", self.at):
                table = self.header()
            else:
                self.pair(table)

    def skip(self) -> bool:
        """Step over space and comments; False at the end."""
        match = _SPACE.match(self.text, self.at)
        self.at = match.end() if match else self.at
        return self.at < len(self.text)

    def mark(self, key: Key, start: int) -> None:
        self.lines.setdefault(key, bisect_right(self.starts, start))

    def header(self) -> Key:
        """``[a.b]`` or ``[[a.b]]``; returns the path that the pairs below it belong to."""
        start = self.at
        several = self.text.startswith("[[", start)
        self.at += 2 if several else 1
        names = self.key()
        self.skip()
        self.at += 2 if several else 1
        table: Key = ()
        for i, name in enumerate(names):
            table = (*table, name)
            if several and i == len(names) - 1:
                self.counts[table] = self.counts.get(table, 0) + 1
            self.mark(table, start)
            if table in self.counts:
                table = (*table, self.counts[table] - 1)
                self.mark(table, start)
        return table

    def pair(self, table: Key) -> None:
        """``key = value`` inside `table`."""
        start = self.at
        key = table
        for name in self.key():
            key = (*key, name)
            self.mark(key, start)
        self.skip()
        self.at += 1
        self.value(key)

    def key(self) -> list[str]:
        """A key, dotted or not, bare or quoted."""
        names: list[str] = []
        while True:
            self.skip()
            bare = _BARE_KEY.match(self.text, self.at)
            if bare:
                names.append(bare[0])
                self.at = bare.end()
            else:
                names.append(_read(self.string()))
            self.skip()
            if not self.text.startswith(".", self.at):
                return names
            self.at += 1

    def value(self, key: Key) -> None:
        """Any value; those inside arrays and inline tables are marked too."""
        self.skip()
        first = self.text[self.at]
        if first == "[":
            self.items(key, "]")
        elif first == "{":
            self.items(key, "}")
        elif first in "\"'":
            self.string()
        else:
            match = _SCALAR.match(self.text, self.at)
            self.at = match.end() if match else self.at + 1

    def items(self, key: Key, end: str) -> None:
        """The elements of an array or the pairs of an inline table."""
        self.at += 1
        index = 0
        while self.skip() and not self.text.startswith(end, self.at):
            if end == "]":
                self.mark((*key, index), self.at)
                self.value((*key, index))
                index += 1
            else:
                self.pair(key)
            self.skip()
            if self.text.startswith(",", self.at):
                self.at += 1
        self.at += 1

    def string(self) -> str:
        """The string that begins here, with its quotes."""
        for quote, pattern in _STRINGS.items():
            if self.text.startswith(quote, self.at):
                match = pattern.match(self.text, self.at)
                if match:
                    self.at = match.end()
                    return match[0]
        raise ValueError(f"not TOML at character {self.at}")


def _read(quoted: str) -> str:
    value: Any = tomllib.loads(f"key = {quoted}")["key"]
    return str(value)

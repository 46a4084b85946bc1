"""Results as one self-contained HTML page. Depends on: result; jinja2 when a page is written.

A page is data: a title and sections of text, tables, pictures and code, nested where some of it should be folded away.
`write_page` turns it into one file: pictures are embedded, styles are inside, nothing is fetched, everything given is
escaped. It reads in light and dark, on a narrow screen and on paper.
"""

import base64
import mimetypes
import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from squealbox.result import Result

TEMPLATE = "page.html.j2"


class ReportError(ValueError):
    """A page cannot be made of what was given; the message names the piece."""


@dataclass(frozen=True)
class Text:
    """A paragraph."""

    text: str
    kind = "text"


@dataclass(frozen=True)
class Points:
    """A list of sentences."""

    items: tuple[str, ...]
    kind = "points"


@dataclass(frozen=True)
class Code:
    """Something to type, kept as it stands."""

    text: str
    kind = "code"


@dataclass(frozen=True)
class Cell:
    """A cell of a table: its text, a smaller second line, and a `mark` that the style knows (such as ``agree``)."""

    text: str
    detail: str = ""
    mark: str = ""


@dataclass(frozen=True)
class Table:
    """A table: column heads and rows of text or cells; the first column names the row."""

    head: tuple[str, ...]
    rows: tuple[tuple[str | Cell, ...], ...]
    caption: str = ""
    kind = "table"

    def __post_init__(self) -> None:
        for i, row in enumerate(self.rows):
            if len(row) != len(self.head):
                raise ReportError(f"table {self.caption!r}: row {i} has {len(row)} cells, expected {len(self.head)}")

    def cells(self) -> tuple[tuple[Cell, ...], ...]:
        """The rows with every entry as a cell."""
        return tuple(tuple(x if isinstance(x, Cell) else Cell(x) for x in row) for row in self.rows)


@dataclass(frozen=True)
class Picture:
    """A picture file (PNG, SVG or JPEG) with a caption; `alt` says in words what it shows, else the caption does."""

    path: Path
    caption: str
    alt: str = ""
    kind = "picture"

    @property
    def uri(self) -> str:
        """The picture itself as a data URI."""
        return data_uri(self.path)


@dataclass(frozen=True)
class Tiles:
    """A row of counts: (count, what it counts, mark)."""

    tiles: tuple[tuple[str, str, str], ...]
    kind = "tiles"


@dataclass(frozen=True)
class Section:
    """A titled part of a page; `folded` hides it behind its title until it is asked for."""

    title: str
    blocks: tuple[Any, ...]
    folded: bool = False
    kind = "section"


@dataclass(frozen=True)
class Page:
    """A page: its title, one or two sentences that say what it is, and its sections."""

    title: str
    lead: str
    sections: tuple[Section, ...]
    footer: str = ""


def data_uri(path: str | os.PathLike[str]) -> str:
    """The content of a file as a ``data:`` address."""
    kind, _ = mimetypes.guess_type(os.fspath(path))
    if kind is None or not kind.startswith("image/"):
        raise ReportError(f"{os.fspath(path)}: not a picture, expected PNG, SVG or JPEG")
    return f"data:{kind};base64,{base64.b64encode(Path(path).read_bytes()).decode('ascii')}"


def render(page: Page) -> str:
    """The HTML of a page."""
    import jinja2

    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("squealbox", "templates"),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    return environment.get_template(TEMPLATE).render(page=page)


def write_page(page: Page, path: str | os.PathLike[str]) -> Path:
    """Write a page to an HTML file, whole or not at all; returns the path."""
    path = Path(path)
    part = path.with_name(path.name + ".part")
    part.write_text(render(page), encoding="utf-8")
    part.replace(path)
    return path


def result_section(title: str, result: Result, pictures: tuple[Picture, ...] = (), *, folded: bool = False) -> Section:
    """A section about one result: how it ended, its pictures, its arrays, its settings and versions."""
    ended = f"Outcome: {result.outcome}. {result.outcome.message}".strip()
    arrays = tuple(_array_row(name, about) for name, about in result.to_dataset().data_vars.items())
    facts = (*_facts("settings", result.settings), *_facts("version", result.provenance))
    return Section(
        title,
        (
            Text(ended),
            *pictures,
            Table(("array", "unit", "meaning", "shape", "least", "greatest"), arrays),
            Table(("", "", ""), facts, "Settings and versions"),
        ),
        folded,
    )


def _array_row(name: Any, about: Any) -> tuple[str, ...]:
    values = about.values
    finite = np.abs(values) if np.iscomplexobj(values) else np.asarray(values, dtype=float)
    finite = finite[np.isfinite(finite)]
    least, greatest = (f"{finite.min():.6g}", f"{finite.max():.6g}") if finite.size else ("", "")
    shape = " by ".join(f"{size} {dim}" for dim, size in about.sizes.items()) or "one value"
    return str(name), about.attrs["units"], about.attrs["long_name"], shape, least, greatest


def _facts(kind: str, items: Mapping[str, Any]) -> Iterator[tuple[str, str, str]]:
    return ((kind, name, str(value)) for name, value in items.items())

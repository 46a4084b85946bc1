"""What a page is made of: text, tables, pictures, charts, sounds and code in titled sections. Data only."""

import base64
import mimetypes
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from squealbox.figure_data import FigureData

HALF_A_PAGE = 3.6  # inches
FEW_ROWS = 12


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

    @property
    def short(self) -> bool:
        """True where it is better not torn apart on paper."""
        return len(self.rows) <= FEW_ROWS

    def cells(self) -> tuple[tuple[Cell, ...], ...]:
        """The rows with every entry as a cell."""
        return tuple(tuple(x if isinstance(x, Cell) else Cell(x) for x in row) for row in self.rows)


@dataclass(frozen=True)
class Picture:
    """A picture file (PNG, SVG or JPEG) with a caption; `alt` says in words what it shows, else the caption does."""

    path: Path
    caption: str
    alt: str = ""
    inches = 0.0
    narrow = False
    kind = "picture"

    @property
    def uri(self) -> str:
        """The picture itself as a data URI."""
        return data_uri(self.path)


@dataclass(frozen=True)
class Drawing:
    """A picture given as the content of a PNG or SVG file, with a caption; `alt` says in words what it shows."""

    content: bytes
    caption: str
    alt: str = ""
    inches: float = 0.0  # width of the figure it was; 0 shows the picture at its own size
    kind = "picture"

    @property
    def narrow(self) -> bool:
        """True where two of them find room beside each other on paper."""
        return 0.0 < self.inches <= HALF_A_PAGE

    @property
    def uri(self) -> str:
        """The picture itself as a data URI."""
        kind = "png" if self.content.startswith(b"\x89PNG") else "svg+xml"
        return f"data:image/{kind};base64,{base64.b64encode(self.content).decode('ascii')}"


@dataclass(frozen=True)
class Chart:
    """A picture that can be pointed at and zoomed into: a drawing, and the same as figures of `figure_data`.

    The drawing is what is printed, and what is seen where scripts do not run.
    """

    drawing: Drawing
    figures: Sequence[FigureData]
    kind = "chart"

    def __post_init__(self) -> None:
        if not all(isinstance(figure, FigureData) for figure in self.figures):
            raise ReportError("a chart: expected figures as data, made with figure_data.FigureData")


@dataclass(frozen=True)
class Vibrating:
    """A brake that vibrates in a mode, as the workbench draws it: its drawing, or in 3-D to be turned by hand.

    Of a drawing, data and points are those of its `Shapes`, and re and im (k, 2) what the mode adds to the points.
    In 3-D data holds the names of its parts and its size [m]; arrays the places, faces, parts and touching nodes of a
    surface, a mode as re and im (k, 3), its shares (f,), the outline (e, 2); normal [N] the forces of the contacts.
    The picture `drawing` is what is printed, and what is seen where scripts do not run.
    """

    drawing: Drawing
    data: Mapping[str, Any]
    arrays: Mapping[str, Any]
    normal: tuple[float, ...] = ()
    kind = "vibrating"


@dataclass(frozen=True)
class Sound:
    """A WAV file to listen to, with a caption."""

    content: bytes
    caption: str
    kind = "sound"

    @property
    def uri(self) -> str:
        """The sound itself as a data URI."""
        return f"data:audio/wav;base64,{base64.b64encode(self.content).decode('ascii')}"


@dataclass(frozen=True)
class Tiles:
    """A row of numbers that matter: (number, what it is, mark)."""

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

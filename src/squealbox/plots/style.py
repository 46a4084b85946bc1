"""One look for every figure: readable in grey, safe for colour-blind readers, a unit on every axis.

Lines differ by dash and marker as well as by colour, areas by hatching as well as by shade. Figures are made with
matplotlib's objects, never with pyplot, so none is left open and no display is needed.
"""

import io
import os
import textwrap
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from squealbox.labelled import whole
from squealbox.parameters import with_cautions
from squealbox.plots.ticks import spread_ticks
from squealbox.signals import with_error
from squealbox.words import MINUS

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    Panels = Axes | np.ndarray | Sequence[Axes]  # one panel, or several


WIDTH = 7.0  # inches: the text width of a journal page
COLUMN = 3.4  # one column of two
ROW = 2.1  # height of a row of panels
CHARACTERS = 19.0  # of a caution, in an inch

# The colours of Okabe and Ito, in an order whose greys also differ; each with its own dash and marker.
LINES: tuple[tuple[str, Any, str], ...] = (
    ("#000000", "solid", "o"),
    ("#0072B2", (0, (5, 1.5)), "s"),
    ("#D55E00", (0, (1.2, 1.2)), "^"),
    ("#009E73", (0, (6, 1.5, 1.2, 1.5)), "D"),
    ("#CC79A7", (0, (3, 1, 1, 1, 1, 1)), "v"),
    ("#56B4E9", (0, (8, 3)), "P"),
    ("#E69F00", (0, (2, 2)), "X"),
)
UNSTABLE = {"facecolor": "#f6e6da", "hatch": "////", "edgecolor": "#c9b8ab", "linewidth": 0.0}

# What a file would say of its making, left out so that equal figures give equal files.
NAMELESS: dict[str, dict[str, None]] = {
    "png": {"Software": None},
    "svg": {"Date": None, "Creator": None},
    "pdf": {"CreationDate": None},
}
PACKED = 3  # of 9, how hard a PNG is packed: the usual 6 takes twice as long and saves a twentieth
RC: dict[str, Any] = {
    "font.family": "sans-serif",
    "font.sans-serif": ["DejaVu Sans", "Verdana", "Arial"],
    "font.size": 8.0,
    "mathtext.fontset": "dejavusans",
    "axes.titlesize": 8.0,
    "axes.labelsize": 8.0,
    "axes.linewidth": 0.6,
    "axes.axisbelow": True,
    "axes.formatter.limits": (-3, 4),
    "axes.formatter.use_mathtext": False,  # it takes as long as all else of a figure
    "axes.formatter.useoffset": False,
    "axes.unicode_minus": True,
    "agg.path.chunksize": 20_000,  # vertices at once; a line of millions is too much for the renderer otherwise
    "xtick.labelsize": 7.0,
    "ytick.labelsize": 7.0,
    "xtick.direction": "in",
    "ytick.direction": "in",
    "xtick.top": True,
    "ytick.right": True,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "lines.linewidth": 1.0,
    "lines.markersize": 3.5,
    "legend.fontsize": 7.0,
    "legend.frameon": True,
    "legend.framealpha": 0.9,
    "legend.edgecolor": "none",
    "legend.handlelength": 3.0,
    "hatch.linewidth": 0.4,
    "path.simplify": True,
    "path.simplify_threshold": 0.2,
    "figure.dpi": 100.0,
    "savefig.dpi": 200.0,
    "savefig.facecolor": "white",
    "svg.fonttype": "none",
    "pdf.fonttype": 42,
    "svg.hashsalt": "squealbox",
}
OWN = (
    "font.",
    "text.",
    "mathtext.",
    "axes.",
    "xtick.",
    "ytick.",
    "lines.",
    "legend.",
    "grid.",
    "svg.fonttype",
    "pdf.",
    "pgf.",
    "savefig.dpi",
)  # settings of matplotlib that stay those of the user, where he has changed them
NARROW = 1.9  # inches: panels beside each other that would be narrower stand under each other


@dataclass(frozen=True)
class Look:
    """How wide and high a figure is to be [inches], and matplotlib styles over the house's."""

    width: float | None = None
    height: float | None = None
    style: Any = None


USUAL = Look()
LOOK: ContextVar[Look] = ContextVar("look", default=USUAL)
_STYLED: ContextVar[bool] = ContextVar("styled", default=False)
FORMATS: ContextVar[tuple[str, ...]] = ContextVar("formats", default=("png", "svg"))
"""The kinds of file that :func:`save` writes where it is not told."""


@contextmanager
def styled() -> Iterator[None]:
    """The house's look while it lasts; matplotlib's own settings come back afterwards. Within itself it does nothing:

    setting all that matplotlib knows takes 2 ms, which a figure of many panels would pay dozens of times. What the user
    has set of `OWN` goes before the house's, and the style of the `Look` before both.
    """
    from matplotlib import rcParams, rcParamsDefault, style

    if _STYLED.get():
        yield
        return
    token = _STYLED.set(True)
    try:
        own = (name for name in rcParams if name.startswith(OWN))  # the backend, if asked for, would load pyplot
        set_ = {str(name): rcParams[name] for name in own if rcParams[name] != rcParamsDefault[name]}
        asked = LOOK.get().style
        asked = asked if isinstance(asked, (list, tuple)) else [asked] if asked is not None else []
        with style.context(["default", RC, set_, *asked]):
            yield
    finally:
        _STYLED.reset(token)


@contextmanager
def looked(figure: "Figure") -> Iterator[None]:
    """The look that a figure was made in, which its file has too."""
    token = LOOK.set(getattr(figure, "look", LOOK.get()))
    try:
        with styled():
            yield
    finally:
        LOOK.reset(token)


@contextmanager
def drawing(axes: "Panels | None", rows: int = 1, columns: int = 1, **size: Any) -> Iterator[Any]:
    """The axes to draw on, in the house's look: those given, or the panels of a new figure.

    One panel comes as itself, several as an array of `rows` x `columns` with its single axes squeezed out.
    """
    with styled():
        if axes is None:
            axes = panels(rows, columns, **size)[1]
        yield axes


def panels(
    rows: int = 1, columns: int = 1, *, width: float | None = None, height: float | None = None, **keywords: Any
) -> "tuple[Figure, Any]":
    """A figure of rows x columns panels; width and height in inches. Keywords go to ``Figure.subplots``.

    `width` [in]: of the figure; `height` [in]: of the figure.

    Returns the figure and its axes: one, or an array. Hand each to a function of this room as ``axes=``. In a `Look`
    of another width the height follows, and a row of panels that would get too narrow becomes a column.
    """
    from squealbox.plots.figure import NotebookFigure

    look = LOOK.get()
    usual = width or (COLUMN if columns == 1 else WIDTH)
    size = (look.width or usual, look.height or height or ROW * rows + 0.3)
    shape = (rows, columns)
    if look.width is not None and columns > 1 and look.width < NARROW * columns:
        for ratios in ("width_ratios", "height_ratios"):
            keywords.pop(ratios, None)
        size = (look.width, look.height or 0.9 * columns * size[1])
        rows, columns = rows * columns, 1
    elif look.width is not None and look.height is None:
        size = (look.width, size[1] * min(max(look.width / usual, 0.8), 1.5))
    with styled():
        figure = NotebookFigure(figsize=size, layout="constrained")
        axes = figure.subplots(rows, columns, **keywords)
        asked = min(shape) > 1 or keywords.get("squeeze") is False
    return figure, np.reshape(axes, shape) if asked else axes


def figure_of(axes: "Panels") -> "Figure":
    """The whole figure that one of the axes belongs to."""
    return np.ravel(np.asarray(axes, dtype=object))[0].get_figure(root=True)


def letters(axes: "Panels") -> None:
    """Name the panels (a), (b), (c) ... in the order given, before their titles."""
    with styled():
        for i, panel in enumerate(np.ravel(np.asarray(axes, dtype=object))):
            panel.set_title(f"({chr(ord('a') + i)})", loc="left")


def line(index: int, *, marker: bool = False, count: int = 0) -> dict[str, Any]:
    """Colour, dash and, if asked for, about eight markers along `count` points, of the line with this index."""
    colour, dash, shape = LINES[index % len(LINES)]
    look = {"color": colour, "linestyle": dash}
    if marker:
        stride = max(count // 8, 1)
        look |= {"marker": shape, "markevery": (index * stride // 4 % stride, stride), "markerfacecolor": "white"}
    return look


def power_of_ten(values: np.ndarray, unit: str) -> tuple[float, str]:
    """A power of ten to divide by, and the unit then read, where the values are far from one."""
    power = int(np.floor(np.log10(max(float(np.max(np.abs(values))), 1e-300))))
    if -3 <= power <= 3:
        return 1.0, unit
    return 10.0**power, f"$10^{{{power}}}$ {unit}".strip()


def uncertain(value: float, error: float) -> str:
    """A value with its error as a reader writes it."""
    return with_error(value, error).replace("+-", "±").replace("-", MINUS)


def save(
    figure: "Figure",
    path: str | os.PathLike[str],
    formats: Sequence[str] | None = None,
    *,
    dots: float | None = None,
) -> list[Path]:
    """Write a figure as path.png and path.svg, as path.pdf where it ends so, or as `formats`; returns the paths.

    `dots` [1/in] an inch, 200 by default. The files hold no date and no version, so equal figures give equal files.
    The figure is laid out once for all formats, where `Figure.savefig` alone would draw it twice for each.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    if not isinstance(figure.canvas, FigureCanvasAgg):
        FigureCanvasAgg(figure)  # one that stays knows the size of every text when the figure is drawn again
    stem, given = Path(path), Path(path).suffix.lstrip(".")
    stem = stem.with_suffix("") if given in figure.canvas.get_supported_filetypes() else stem
    if formats is None:
        formats = (given,) if stem != Path(path) and given not in FORMATS.get() else FORMATS.get()
    written = []
    with looked(figure), laid_out(figure, dots):
        for kind in formats:
            written.append(stem.with_name(f"{stem.name}.{kind}"))
            packed: dict[str, Any] = {"pil_kwargs": {"compress_level": PACKED}} if kind == "png" else {}
            with whole(written[-1]) as part:
                figure.savefig(part, format=kind, metadata=NAMELESS.get(kind), dpi=dots, **packed)
    return written


def drawn(figure: "Figure", kind: str = "png", dots: float | None = None, *, trimmed: bool = False) -> bytes:
    """The figure as the content of a PNG, SVG or PDF file, `dots` [1/in] an inch, `trimmed` of an empty margin."""
    stream = io.BytesIO()
    with looked(figure), laid_out(figure, dots):
        box = "tight" if trimmed else None
        figure.savefig(stream, format=kind, metadata=NAMELESS.get(kind), dpi=dots, bbox_inches=box)
    return stream.getvalue()


@contextmanager
def laid_out(figure: "Figure", dots: float | None) -> Iterator[None]:
    """The figure with its layout done and put to rest, so that drawing does not do it again.

    It is done at the dots an inch of the file, because letters are as wide as whole dots make them.
    """
    from matplotlib import rcParams

    engine = figure.get_layout_engine()
    if engine is None:
        yield
        return
    before, finest = figure.dpi, rcParams["savefig.dpi"]
    figure.set_dpi(dots or (before if finest == "figure" else finest))
    engine.execute(figure)
    if spread_ticks(figure):  # along axes as long as the layout leaves them; other numbers need other room
        engine.execute(figure)
    figure.set_dpi(before)
    figure.set_layout_engine(None)  # with "none" a placeholder stays, and each file is drawn twice
    try:
        yield
    finally:
        figure.set_layout_engine(engine)


def cautioned(panel: "Axes", cautions: Sequence[str], alone: bool) -> None:
    """Under a figure of one's own, what its results warn of, in at most four lines; nothing where there is none."""
    said = "; ".join(dict.fromkeys(filter(None, cautions)))
    if not said or not alone:
        return
    figure = figure_of(panel)
    width = max(int(figure.get_size_inches()[0] * CHARACTERS), 40)
    figure.supxlabel(textwrap.fill(with_cautions([], said), width, max_lines=4, placeholder=" ..."), fontsize=6.5)


def note(axes: "Axes", text: str, where: str = "upper right") -> None:
    """A small remark inside a panel, on a white ground."""
    vertical, horizontal = where.split()
    x, y = {"left": 0.03, "right": 0.97, "center": 0.5}[horizontal], {"upper": 0.95, "lower": 0.05}[vertical]
    ground = {"facecolor": "white", "edgecolor": "none", "alpha": 0.85, "pad": 1.0}
    top = "top" if vertical == "upper" else "bottom"
    axes.text(x, y, text, transform=axes.transAxes, fontsize=6.5, bbox=ground, ha=horizontal, va=top)

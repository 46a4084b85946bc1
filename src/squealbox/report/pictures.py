"""Figures and motions as blocks of a page."""

import io
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from squealbox import plots
from squealbox.report.blocks import Drawing, Text
from squealbox.report.examination import Examination
from squealbox.signals import SAMPLING, audible, sixteen_bits

if TYPE_CHECKING:
    from matplotlib.figure import Figure

LARGE = 150_000  # bytes of an SVG above which a PNG takes its place
DOTS = 170.0  # an inch of that PNG


def picture(figure: "Figure", caption: str, alt: str = "") -> Drawing:
    """A figure as SVG where that is small, else as PNG."""
    vector = plots.drawn(figure, "svg")
    content = vector if len(vector) < LARGE else plots.drawn(figure, "png", DOTS)
    return Drawing(content, caption, alt, float(figure.get_size_inches()[0]))


def wav(motion: Any, dof: int) -> bytes:
    """The motion of one degree of freedom as the content of a WAV file."""
    from scipy.io import wavfile

    stream = io.BytesIO()
    wavfile.write(stream, SAMPLING, sixteen_bits(audible(motion, dof=dof)))
    return stream.getvalue()


def why_not(found: Examination, *names: str) -> Iterator[Any]:
    """A sentence for each of these parts that could not be computed."""
    for name in names:
        if name in found.missing:
            yield Text(f"Not computed, {name}: {found.missing[name]}.")

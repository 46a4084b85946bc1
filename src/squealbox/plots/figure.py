"""The figure of the house: matplotlib's own, which a notebook shows by itself."""

import os
from typing import IO, Any

from matplotlib.figure import Figure

from squealbox.plots.style import LOOK, drawn, laid_out, looked

DOTS = 150  # an inch, sharp on most screens


class NotebookFigure(Figure):
    """A matplotlib figure that notebooks show without pyplot, which would keep every figure open.

    Its files are written in the look it was made in, by `savefig` too: text stays text in SVG and PDF.
    """

    def __init__(self, *args: Any, **keywords: Any) -> None:
        super().__init__(*args, **keywords)
        self.look = LOOK.get()

    def savefig(self, fname: str | os.PathLike[str] | IO[bytes], *args: Any, **keywords: Any) -> None:
        """As matplotlib's, in the look of this figure."""
        dots = keywords.get("dpi")
        with looked(self), laid_out(self, dots if isinstance(dots, (int, float)) else None):
            super().savefig(fname, *args, **keywords)

    def _repr_png_(self) -> bytes:
        return drawn(self, "png", DOTS, trimmed=True)

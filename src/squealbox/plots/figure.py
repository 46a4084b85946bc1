"""The figure of the house: matplotlib's own, which a notebook shows by itself."""

from matplotlib.figure import Figure

from squealbox.plots.style import drawn

DOTS = 150  # an inch, sharp on most screens


class Drawing(Figure):
    """A matplotlib figure that notebooks show without pyplot, which would keep every figure open."""

    def _repr_png_(self) -> bytes:
        return drawn(self, "png", DOTS, trimmed=True)

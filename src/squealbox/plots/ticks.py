"""Numbers along axes that a reader can take in: none runs into the next, and a power of ten stands in the unit."""

import re
from itertools import pairwise
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from matplotlib.axis import Axis
    from matplotlib.figure import Figure
    from matplotlib.ticker import ScalarFormatter

PREFIXES = {-12: "p", -9: "n", -6: "µ", -3: "m", 3: "k", 6: "M", 9: "G", 12: "T"}
PLAIN = re.compile(r"(N|Pa|J|W|Hz|m|s)\b(?!\d|²|³|\^)")  # units that take a prefix, at the beginning of a compound one
RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
OFFSET = re.compile(r"1e(-?\d+)")
UNIT = re.compile(r"\[([^\[\]]*)\]\s*$")


def spread_ticks(figure: "Figure") -> bool:
    """Fewer ticks where their numbers would run into each other, and powers of ten put into the units of labels.

    Returns whether that changed any, so that other room is needed.
    """
    from matplotlib.ticker import MaxNLocator, ScalarFormatter

    changed = False
    for panel in figure.axes:
        for axis, side in ((panel.xaxis, 0), (panel.yaxis, 1)):
            formatter = axis.get_major_formatter()
            if isinstance(formatter, ScalarFormatter) and formatter.get_offset():
                _into_the_unit(axis, formatter)
                changed = True
            locator = axis.get_major_locator()
            if isinstance(locator, MaxNLocator):
                for bins in range(len(axis.get_majorticklocs()) - 2, 1, -1):
                    if not _crowded(axis, side, 0.04 * figure.dpi):
                        break
                    locator.set_params(nbins=bins)
                    changed = True
    return changed


def prefixed(unit: str, power: int) -> tuple[int, str]:
    """The power of ten to divide values of about 10^power by, and the unit then read: (6, "MN/m"), (-16, "10⁻¹⁶")."""
    thirds = 3 * (power // 3)
    if PLAIN.match(unit) and thirds in PREFIXES:
        return thirds, PREFIXES[thirds] + unit
    return power, f"10{str(power).translate(RAISED)} {unit.strip('-')}".strip()


def _into_the_unit(axis: "Axis", formatter: "ScalarFormatter") -> None:
    """Numbers along the axis without their power of ten, which the label then says; beside it where it has no unit."""
    from matplotlib.ticker import ScalarFormatter

    label = axis.get_label_text()
    found = UNIT.search(label)
    told = OFFSET.fullmatch(formatter.get_offset().replace("\N{MINUS SIGN}", "-"))
    if found is None or told is None:
        formatter.set_useMathText(True)
        return
    power, unit = prefixed(found[1], int(told[1]))

    class Scaled(ScalarFormatter):
        """Numbers over a power of ten."""

        def __call__(self, x: float, pos: int | None = None) -> str:
            return str(super().__call__(x / 10.0**power, pos))

        def set_locs(self, locs: Any) -> None:
            super().set_locs([each / 10.0**power for each in locs])

    scaled = Scaled(useOffset=False)
    scaled.set_scientific(False)
    axis.set_major_formatter(scaled)
    axis.set_label_text(f"{label[: found.start()]}[{unit}]")


def _crowded(axis: "Axis", side: int, gap: float) -> bool:
    """True where two numbers along an axis come closer than a `gap` [dots]."""
    low, high = sorted(axis.get_view_interval())
    seen = zip(axis.get_majorticklocs(), axis.get_ticklabels(), strict=False)
    boxes = [label.get_window_extent() for at, label in seen if low <= at <= high and label.get_text()]
    spans = sorted((box.min[side], box.max[side]) for box in boxes)
    return any(after[0] < before[1] + gap for before, after in pairwise(spans))

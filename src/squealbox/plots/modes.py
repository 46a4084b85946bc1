"""Frequencies and growth rates of the modes against a parameter: coalescence."""

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from squealbox.plots.style import LINES, UNSTABLE, drawing, figure_of, line, note
from squealbox.stability import ComplexModes, TrackedModes
from squealbox.words import number, quantity_label, scaled

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from squealbox.plots.style import Panels


MOST_NAMED = 4  # modes named in the legend where there are more than looks
NONE = 1e-7  # growth rates up to this [1/s], or this share of themselves, are round-off
OF_INTEREST = 3.0  # times the largest growth: as far down the growth rates of many modes are drawn
OTHERS: dict[str, Any] = {"color": "#aaaaaa", "linewidth": 0.6, "linestyle": "-", "zorder": 1}


def coalescence(
    parameter: ArrayLike,
    modes: ComplexModes | TrackedModes | ArrayLike,
    *,
    name: str = "friction coefficient",
    unit: str = "",
    frequency_unit: str | None = None,
    title: str = "",
    axes: "Panels | None" = None,
) -> "Figure":
    """Frequency (above) and growth rate (below) of each mode against a parameter, unstable stretches hatched.

    Parameters
    ----------
    parameter : (k,), increasing values
    modes : batched complex modes, their eigenvalues (k, 2n) [1/s], or tracked modes
    name, unit : of the parameter, for the axis
    frequency_unit : "kHz", "Hz", "rad/s" or "10³ rad/s"; by default what suits the numbers
    axes : a pair of panels
    """
    values = np.asarray(parameter, dtype=float)
    eigenvalues = np.asarray(getattr(modes, "eigenvalues", modes))
    if eigenvalues.ndim != 2 or eigenvalues.shape[0] != values.size:
        raise ValueError(
            f"eigenvalues of shape {eigenvalues.shape} for {values.size} values: expected (k, 2n), a row for each"
        )
    branches = upper_branches(modes)
    frequency, growth = np.imag(branches) / (2.0 * np.pi), np.real(branches)
    hertz, read = scaled("Hz", frequency, to=frequency_unit)
    worst = np.fmax.reduce(np.real(eigenvalues), axis=-1)
    with drawing(axes, rows=2, height=3.8, sharex=True) as (above, below):
        named = _told(growth)
        for i, told in enumerate(named):
            look = {**line(int(np.sum(named[:i])), marker=True, count=values.size), "linewidth": 1.2}
            look = look if told else OTHERS
            above.plot(values, frequency[:, i] / hertz, label=f"mode {i + 1}" if told else None, **look)
            below.plot(values, growth[:, i], **look)
        below.axhline(0.0, color="#000000", linewidth=0.5)
        for panel in (above, below):
            for left, right in unstable_stretches(values, worst):
                panel.axvspan(left, right, zorder=0, **UNSTABLE)
            panel.set_xlim(values[0], values[-1])
        onsets = np.flatnonzero(~(worst[:-1] > 0.0) & (worst[1:] > 0.0))
        if len(onsets):
            told = (f"between {number(values[i])} and {number(values[i + 1])}" for i in onsets)
            note(below, f"becomes unstable {', '.join(told)} {unit}".rstrip(), "upper left")
        above.set(ylabel=quantity_label("frequency", read), title=title)
        below.set(xlabel=quantity_label(name, unit), ylabel=quantity_label("growth rate", "1/s"))
        above.legend(loc="upper right")
        if np.any(growth > 0.0) and not np.all(named):
            below.set_ylim(-OF_INTEREST * np.nanmax(growth), 1.1 * np.nanmax(growth))
        return figure_of(above)


def _told(growth: np.ndarray) -> Any:
    """Which modes of (k, n) have a look and a name of their own (n,): all of a few, else those nearest to growing.

    Of more modes than looks the others are thin and grey.
    """
    highest = np.nanmax(growth, axis=0)
    told = np.zeros(highest.size, dtype=bool)
    told[np.argsort(-highest, kind="stable")[: highest.size if highest.size <= len(LINES) else MOST_NAMED]] = True
    return told


def upper_branches(modes: ComplexModes | TrackedModes | ArrayLike) -> Any:
    """The modes with Im >= 0, or their eigenvalues (k, m), each a column that runs on smoothly; NaN where it is not."""
    rows = np.asarray(getattr(modes, "eigenvalues", modes))
    rows = rows if isinstance(modes, TrackedModes) else followed(rows)
    rows = np.where(np.isfinite(rows) & (np.imag(rows) >= 0.0), rows, complex(np.nan, np.nan))
    return rows[:, np.any(np.isfinite(rows), axis=0)]


def followed(eigenvalues: ArrayLike) -> Any:
    """The rows of `eigenvalues` (k, m) reordered so that each column runs on smoothly.

    Each row is matched to the straight continuation of the two before it, by the assignment of least total distance.
    """
    from scipy.optimize import linear_sum_assignment

    rows = np.array(eigenvalues, dtype=complex)
    for k in range(1, len(rows)):
        expected = rows[k - 1] if k < 2 else 2.0 * rows[k - 1] - rows[k - 2]
        if not (np.all(np.isfinite(expected)) and np.all(np.isfinite(rows[k]))):
            continue
        _, order = linear_sum_assignment(np.abs(expected[:, None] - rows[k][None, :]))
        rows[k] = rows[k][order]
    return rows


def unstable_stretches(values: np.ndarray, growth: np.ndarray) -> list[tuple[float, float]]:
    """Stretches of `values` (k,) where the `growth` (k,) [1/s] is positive, beyond round-off.

    They end on straight lines between the points, or half way to a point where nothing is known.
    """
    grows = growth > NONE * np.maximum(1.0, np.abs(growth))
    edges = []
    for i in np.nonzero(np.diff(np.r_[False, grows, False].astype(int)))[0].tolist():
        if i in (0, len(values)):
            edges.append(float(values[min(i, len(values) - 1)]))
            continue
        a, b = growth[i - 1], growth[i]
        share = np.clip(a / (a - b), 0.0, 1.0) if np.isfinite(a - b) and a != b else 0.5
        edges.append(float(values[i - 1] + share * (values[i] - values[i - 1])))
    return list(zip(edges[::2], edges[1::2], strict=True))

"""Figures of sweeps: an answer over one parameter as lines, over two as a map, of samples as points."""

import itertools
from typing import TYPE_CHECKING, Any

import numpy as np

from squealbox.limit_cycles import DangerousPush
from squealbox.plots.dispatch import drawn_by
from squealbox.plots.style import COLUMN, LINES, ROW, drawing, figure_of, line, note
from squealbox.studies import Sweep
from squealbox.words import PREFIXES, quantity_label, scaled

if TYPE_CHECKING:
    import xarray
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from squealbox.plots.style import Panels

MOST_LINES = 8
MOST_PANELS = 6
MOST_WORDS = len(LINES)
UNKNOWN = "#dddddd"


def numeric_answers(found: Sweep) -> list[str]:
    """Names of the answers that are real numbers, one for each point of the space."""
    dims = found.dataset["outcome"].dims
    return [name for name in found.answers if found[name].dims == dims and found[name].dtype.kind in "fiub"]


@drawn_by.register(Sweep)
def sweep_overview(
    found: Sweep, *, answer: str | None = None, title: str = "", axes: "Panels | None" = None
) -> "Figure":
    """An answer of a sweep over its parameters; failed points are crosses, or grey crossed fields.

    Parameters
    ----------
    answer : its name; left out, the first that is one number at each point, or the first of all
    axes : one panel, for a sweep over one or two axes

    Over one axis the answer is a line, or one for each of its numbers; over two a map (of the largest of its numbers);
    further axes give a panel for each of up to six combinations of their values. A sample of several parameters is
    drawn as points over the first two. Raises `ValueError` for an unknown answer and for more panels.
    """
    name = answer if answer is not None else [*numeric_answers(found), *found.answers, ""][0]
    if name not in found.answers:
        raise ValueError(
            f"answer = {name!r}: expected one of {', '.join(found.answers) or 'none, since every point failed'}"
        )
    values, dims = found[name], list(found["outcome"].dims)
    if axes is not None or len(dims) <= 2:
        with drawing(axes, width=COLUMN if len(dims) == 1 else 4.2, height=2.7) as panel:
            _panel(panel, found, values, dims, {}, title)
            return figure_of(panel)
    combinations = list(itertools.product(*(range(found.dataset.sizes[dim]) for dim in dims[2:])))
    if len(combinations) > MOST_PANELS:
        raise ValueError(f"{len(combinations)} panels: choose values of {', '.join(map(str, dims[2:]))} in the dataset")
    columns = min(len(combinations), 2)
    rows = -(-len(combinations) // columns)
    with drawing(None, rows, columns, width=3.7 * columns, height=1.3 * ROW * rows, squeeze=False) as panels:
        for panel, place in itertools.zip_longest(np.ravel(panels), combinations):
            if place is None:
                panel.set_axis_off()
                continue
            chosen = dict(zip(dims[2:], place, strict=True))
            _panel(panel, found, values.isel(chosen), dims[:2], chosen, _said(found, chosen))
        figure = figure_of(panels)
        figure.suptitle(title, fontsize=8.0)
        return figure


@drawn_by.register(DangerousPush)
def search_for_a_push(found: DangerousPush, *, title: str = "", axes: "Axes | None" = None) -> "Figure":
    """Smallest energy of a push that ends in a vibration, after each round of the search."""
    with drawing(axes, height=2.4) as panel:
        history = np.asarray(found.history)
        panel.semilogy(np.arange(history.size), history, **line(0, marker=True, count=history.size))
        panel.set(xlabel="round of the search", ylabel=quantity_label("smallest energy", "J"), title=title)
        note(panel, "each of these pushes was run and vibrates")
        return figure_of(panel)


def _panel(
    panel: "Axes", found: Sweep, values: "xarray.DataArray", dims: list[Any], chosen: dict[Any, int], title: str
) -> None:
    ended = np.asarray(found["outcome"].isel(chosen).values, dtype=str) == "completed"
    several = [dim for dim in dims if dim not in found.dataset.coords]
    if len(dims) == 1 and not several:
        _lines(panel, found, values, dims[0], ended)
        _spaced(panel, "x", found[dims[0]])
    elif len(dims) == 2 and not several:
        _map(panel, found, values, dims, ended)
        _spaced(panel, "x", found[dims[0]])
        _spaced(panel, "y", found[dims[1]])
    else:
        _points(panel, found, values, dims, ended)
    panel.set_title(title)


def _lines(panel: "Axes", found: Sweep, values: "xarray.DataArray", dim: str, ended: np.ndarray) -> None:
    x, label = _along(found[dim])
    if values.dtype.kind in "OU":
        _words_over(panel, x, values)
    else:
        y, unit = _numbers(values)
        table = y.reshape(len(x), -1)[:, : found.told(values)]
        for i in range(min(table.shape[1], MOST_LINES)):
            look: dict[str, Any] = {} if table.shape[1] == 1 else {"label": str(i + 1)}
            panel.plot(x, table[:, i], **line(i), **look, marker="." if len(x) <= 60 else "")
        if table.shape[1] > 1:
            panel.legend(title=str(values.dims[-1]).replace("_", " "), loc="best")
        panel.set_ylabel(quantity_label(_called(values), unit))
    if not np.all(ended):
        where = panel.get_xaxis_transform()
        panel.plot(
            x[~ended], np.full(np.count_nonzero(~ended), 0.03), "x", color="#D55E00", transform=where, clip_on=False
        )
        panel.set_title("crosses: failed", loc="right", color="#D55E00", fontsize=7.0)
    panel.set_xlabel(label)


def _map(panel: "Axes", found: Sweep, values: "xarray.DataArray", dims: list[Any], ended: np.ndarray) -> None:
    (x, x_label), (y, y_label) = (_along(found[dim]) for dim in dims)
    if values.dtype.kind in "OU":
        grid, words = _coded(values)
        _word_map(panel, x, y, np.where(ended, grid, -1), words)
    else:
        numbers, unit = _numbers(values)
        grid = _largest(numbers, ended.ndim)
        shown = np.ma.masked_invalid(np.where(ended, grid, np.nan))
        every = _numbers(found[str(values.name)], unit)[0]  # one scale for all panels, so that they can be compared
        known = every[np.isfinite(every)]
        low, high = (float(np.min(known)), float(np.max(known))) if known.size else (0.0, 1.0)
        signed = low < 0.0 < high
        top = max(-low, high)
        limits = {"vmin": -top, "vmax": top, "cmap": "PuOr_r"} if signed else {"vmin": low, "vmax": high}
        mesh = panel.pcolormesh(x, y, shown.T, rasterized=True, **limits)
        label = quantity_label(_called(values, numbers.ndim > ended.ndim), unit)
        figure_of(panel).colorbar(mesh, ax=panel, pad=0.02).set_label(label)
        if signed and len(x) > 1 and len(y) > 1:
            panel.contour(x, y, shown.T, levels=[0.0], colors=["#000000"], linewidths=1.0)
    _crossed(panel, x, y, ended)
    panel.set(xlabel=x_label, ylabel=y_label)


def _points(panel: "Axes", found: Sweep, values: "xarray.DataArray", dims: list[Any], ended: np.ndarray) -> None:
    """Points of a sample over the first two parameters, or over the only one; other axes lie on top of each other."""
    if found["outcome"].ndim != ended.ndim or values.dtype.kind in "OU":
        raise ValueError("words, or a sample with more than one further axis: draw them from the dataset")
    places, labels = [], []
    for name, c in found.dataset.coords.items():
        if c.dtype.kind == "f":
            along, label = _along(found[str(name)])
            shape = [-1 if dim in c.dims else 1 for dim in dims]
            places.append(np.broadcast_to(along.reshape(shape), ended.shape))
            labels.append(label)
    numbers, unit = _numbers(values)
    flat = np.where(ended, _largest(numbers, ended.ndim), np.nan)
    label = quantity_label(_called(values, numbers.ndim > ended.ndim), unit)
    panel.set_xlabel(labels[0])
    if len(places) == 1:
        panel.plot(places[0].ravel(), flat.ravel(), ".", color=LINES[1][0], markersize=3.0)
        panel.set_ylabel(label)
        return
    x, y = places[:2]
    top = float(np.nanmax(np.abs(flat), initial=0.0))
    signed = bool(np.any(flat < 0.0) and np.any(flat > 0.0))
    look = {"vmin": -top, "vmax": top, "cmap": "PuOr_r", "edgecolors": "#888888"} if signed else {"cmap": "viridis"}
    dots = panel.scatter(x.ravel(), y.ravel(), c=flat.ravel(), s=9.0, linewidths=0.2, **look)
    panel.plot(x[~ended], y[~ended], "x", color="#D55E00", markersize=3.0)
    figure_of(panel).colorbar(dots, ax=panel, pad=0.02).set_label(label)
    panel.set_ylabel(labels[1])


def _words_over(panel: "Axes", x: np.ndarray, values: "xarray.DataArray") -> None:
    codes, words = _coded(values)
    panel.plot(x, codes.reshape(len(x), -1), "o", color=LINES[1][0], markersize=3.0)
    panel.set_yticks(range(len(words)), [word.replace("_", " ") or "none" for word in words])
    panel.set_ylim(-0.5, len(words) - 0.5)


def _word_map(panel: "Axes", x: np.ndarray, y: np.ndarray, grid: np.ndarray, words: list[str]) -> None:
    from matplotlib.colors import ListedColormap
    from matplotlib.patches import Patch

    colours = [LINES[i % MOST_WORDS][0] for i in range(1, len(words) + 1)]
    shown = np.ma.masked_less(grid.reshape(len(x), len(y)), 0)
    panel.pcolormesh(x, y, shown.T, cmap=ListedColormap(colours), vmin=-0.5, vmax=len(words) - 0.5, rasterized=True)
    names = [word.replace("_", " ") or "none" for word in words]
    there = set(np.unique(shown.compressed()).tolist())
    handles = [Patch(color=colours[i], label=name) for i, name in enumerate(names) if i in there]
    panel.legend(handles=handles, loc="best")


def _crossed(panel: "Axes", x: np.ndarray, y: np.ndarray, ended: np.ndarray) -> None:
    if np.all(ended):
        return
    panel.set_facecolor(UNKNOWN)
    places = np.argwhere(~ended)
    if len(places) <= 500:
        panel.plot(x[places[:, 0]], y[places[:, 1]], "x", color="#D55E00", markersize=3.0)


def _coded(values: "xarray.DataArray") -> tuple[Any, list[str]]:
    words, codes = np.unique(np.asarray(values.values, dtype=str), return_inverse=True)
    return codes.reshape(values.shape), [str(word) for word in words]


def _numbers(values: "xarray.DataArray", to: str | None = None) -> tuple[Any, str]:
    """The values in the unit asked for, or one that reads well; the size of complex ones."""
    array = np.asarray(values.values)
    array = np.abs(array) if array.dtype.kind == "c" else array.astype(float)
    unit = str(values.attrs.get("units", ""))
    factor, read = scaled(
        unit, array[np.isfinite(array)], to=to if to in [name for _, name in PREFIXES.get(unit, ())] else None
    )
    return array / factor, "" if read == "1" else read


def _spaced(panel: "Axes", axis: str, values: "xarray.DataArray") -> None:
    """A logarithmic axis for values that were spaced so."""
    if values.dtype.kind != "f" or values.size < 3 or float(values.min()) <= 0.0:
        return
    steps, ratios = np.diff(values.values), np.diff(np.log(values.values))
    if np.ptp(ratios) < 1e-6 * np.max(np.abs(ratios)) and np.ptp(steps) > 1e-3 * np.max(np.abs(steps)):
        panel.set(**{f"{axis}scale": "log"})


def _largest(numbers: np.ndarray, ndim: int) -> Any:
    if numbers.ndim == ndim:
        return numbers
    flat = numbers.reshape(*numbers.shape[:ndim], -1)
    return np.max(np.where(np.isfinite(flat), flat, -np.inf), axis=-1, initial=-np.inf)


def _along(values: "xarray.DataArray") -> tuple[Any, str]:
    """A coordinate as numbers to draw over, and its label."""
    if values.dtype.kind in "OU":
        return np.arange(values.size), ", ".join(f"{i} {word}" for i, word in enumerate(values.values))
    unit = str(values.attrs.get("units", ""))
    factor, read = scaled(unit, values.values)
    return values.values / factor, quantity_label(str(values.name), "" if read == "1" else read)


def _called(values: "xarray.DataArray", several: bool = False) -> str:
    name = str(values.name).replace("_", " ")
    return f"largest {name}" if several else name


def _said(found: Sweep, chosen: dict[Any, int]) -> str:
    parts = []
    for dim, place in chosen.items():
        value = found[dim].values[place] if dim in found.dataset.coords else place
        parts.append(f"{dim} = {value if isinstance(value, str) else format(float(value), '.4g')}")
    return ", ".join(parts)

"""Figures of many motions at once: an ensemble over its parameters."""

from typing import TYPE_CHECKING

import numpy as np

from squealbox.matrices import liveliest
from squealbox.parameters import known_names
from squealbox.plots.dispatch import drawn_by
from squealbox.plots.maps import amplitude_map
from squealbox.plots.style import LINES, cautioned, drawing, figure_of
from squealbox.system import as_system
from squealbox.transient import Ensemble
from squealbox.words import quantity_label, scaled

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from squealbox.plots.style import Panels


@drawn_by.register(Ensemble)
def ensemble_overview(
    found: Ensemble,
    *,
    observer: str | None = None,
    dof: int | str | None = None,
    title: str = "",
    axes: "Panels | None" = None,
) -> "Figure":
    """What an observer saw over the parameters: a map over two, points over one, else sorted by size.

    `observer` names it, by default the first. Of several degrees of freedom `dof` is drawn, by default the one that
    moves most, and named; of several values the largest. Runs that did not end are left out.
    """
    name = observer or next(iter(found.observed), "")
    seen = found[name] if name else np.abs(found.q)
    of, unit = found.settings["observed"][name] if name else ("dof", "m")
    seen = np.asarray(seen, dtype=float)
    label = name.replace("_", " ") or "displacement"
    if of == "dof" and (
        unit == "m" or dof is not None
    ):  # displacements and rotations do not compare: what moves most is drawn, by name
        system = as_system(found.inputs["system"])
        sizes = np.where(np.isfinite(seen), seen, 0.0)
        names = list(system.names)
        if isinstance(dof, str) and dof not in names:
            raise ValueError(f"dof = {dof!r}: expected {known_names(dof, names)}")
        each = sizes.reshape(-1, system.size, sizes[(0,) * len(found.shape)].size // system.size)
        largest = liveliest(np.max(each, axis=(0, 2)), system.units)
        place = largest if dof is None else names.index(dof) if isinstance(dof, str) else dof
        seen, unit = (
            seen.reshape(*found.shape, system.size, -1)[..., place, :],
            unit if unit != "m" else system.units[place],
        )
        label += f" {names[place]}" if system.size > 1 else ""
    values = seen.reshape(*found.shape, -1)
    values = np.max(np.where(np.isfinite(values), values, -np.inf), axis=-1)
    values = np.where(np.isfinite(values) & (found.ended == "completed"), values, np.nan)
    if len(found.shape) == 2 and len(found.parameters) == 2:
        (x_name, x), (y_name, y) = found.parameters.items()
        x, y = (np.broadcast_to(each, found.shape) for each in (x, y))
        figure = amplitude_map(x[:, 0], y[0], values.T, x_name=x_name, x_unit=found.unit_of(x_name), y_name=y_name,
                             y_unit=found.unit_of(y_name), unit=unit, name=label, title=title, axes=axes)  # fmt: skip
        cautioned(figure.axes[0], [found.caution], axes is None)
        return figure
    if len(found.parameters) == 1:
        key, across = next(iter(found.parameters.items()))
        along, across = quantity_label(key, found.unit_of(key)), np.broadcast_to(across, found.shape).ravel()
        values = values.ravel()
    else:
        along, across, values = "run, sorted", np.arange(values.size) + 1.0, np.sort(values.ravel())
    factor, read = scaled(unit, values)
    with drawing(axes, height=2.6) as panel:
        panel.plot(across, values / factor, ".", color=LINES[0][0], markersize=3.0)
        panel.set(xlabel=along, ylabel=quantity_label(label, read), title=title)
        cautioned(panel, [found.caution], axes is None)
        return figure_of(panel)

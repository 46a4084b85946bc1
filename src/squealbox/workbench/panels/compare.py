"""What two designs are compared by; the page keeps the answer of the one and puts it beside that of the other."""

from typing import Any

import numpy as np

from squealbox.designs import Design
from squealbox.plots.cards import parameter_rows
from squealbox.plots.modes import followed
from squealbox.stability import complex_modes, critical_values, mechanism
from squealbox.workbench.frames import finite
from squealbox.workbench.panels.modes import modes_of
from squealbox.workbench.panels.panel import Answer, Options, Work, axis_of, try_value

POINTS = 161


def answer(design: Design, options: Options, work: Work) -> Answer:
    """Stability, its margin in a parameter, frequencies and growth rates over it, and all parameters in words."""
    parameter = options.parameter("parameter", design, "friction.static")
    low, high = options.span("span", design, parameter)
    axis, value = axis_of(design, parameter), try_value(design, parameter)
    grid = np.linspace(low, high, POINTS)
    spectra = complex_modes(design.replace({parameter: grid}))
    tracks = followed(spectra.eigenvalues)
    tracks = np.where(np.imag(tracks) >= 0.0, tracks, np.nan)
    tracks = tracks[:, np.any(np.isfinite(tracks), axis=0)]
    data: dict[str, Any] = {
        "axis": axis,
        "value": None if value is None else value / axis["factor"],
        "span": [low / axis["factor"], high / axis["factor"]],
        "title": design.title,
        "parameters": [[name, text] for name, text, *_ in parameter_rows(design)],
        "modes": tracks.shape[1],
        **_state(design),
        **_margin(design, parameter, (low, high), value, axis["factor"]),
    }
    arrays = {
        "values": grid / axis["factor"],
        "frequency": np.imag(tracks.T) / (2.0 * np.pi),
        "growth": np.max(np.real(spectra.eigenvalues), axis=-1),
    }
    return Answer(data, arrays)


def _state(design: Design) -> dict[str, Any]:
    modes = modes_of(design)
    if not bool(modes.exists):
        return {"state": "no steady sliding", "growth": None, "frequency": None, "damping": None, "mechanism": ""}
    worst = modes.most_unstable
    stable = bool(modes.stable)
    return {
        "state": "stable" if stable else "unstable",
        "growth": worst.growth_rate,
        "frequency": worst.frequency,
        "damping": finite(worst.damping_ratio),
        "mechanism": "" if stable else mechanism(design).name.replace("_", " "),
    }


def _margin(
    design: Design, parameter: str, span: tuple[float, float], value: float | None, factor: float
) -> dict[str, Any]:
    changes = [float(one.value) for one in critical_values(design, parameter, span) if one.changes_stability]
    if not changes or value is None:
        return {"critical": changes[0] / factor if changes else None, "margin": None}
    nearest = min(changes, key=lambda each: abs(each - value))
    return {"critical": nearest / factor, "margin": (nearest - value) / abs(value) if value else None}

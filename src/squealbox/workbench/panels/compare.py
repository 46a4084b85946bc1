"""Two designs beside each other: A that was kept and B on the page, in curves and in a table."""

from typing import Any

import numpy as np

from squealbox.design import Design
from squealbox.figure_data import FigureAxis, FigureData, across, line, span
from squealbox.plots import followed, parameter_rows
from squealbox.stability import complex_modes, mechanism
from squealbox.words import number, quantity, scaled
from squealbox.workbench.frames import finite
from squealbox.workbench.panels.declared import OVER, Panel, Place
from squealbox.workbench.panels.modes import crossings_of, modes_of
from squealbox.workbench.panels.panel import NONE, Answer, OptionError, Options, Work, table, try_value

PANEL = Panel(
    "Compare two designs", questions=("silences",), columns=2, choices=(OVER,),
    layout="two", figures=(Place("frequency", "Frequencies", 200), Place("growth", "Growth rate", 200)),
    table="The two designs in numbers",
)  # fmt: skip

POINTS = 161
KEEP = "Keep this design as A, then change it: A stays beside it."
TOLD = ("state", "mechanism", "growth", "frequency", "damping", "critical", "margin")
Side = dict[str, Any]


def answer(design: Design, options: Options, work: Work) -> Answer:
    """Frequencies and growth rates of both over a parameter, and what differs in numbers and in parameters."""
    parameter, ends = options.over(design, OVER)
    axis, words = options.axis(design, parameter, ends), KEEP
    sides = [("B", "s0", _side(design, parameter, ends))]
    try:
        other = options.design("a")
        if other is not None and parameter not in other.scalars():
            raise OptionError(f"it has no {parameter}")
        if other is not None:
            sides.append(("A", "s1", _side(other, parameter, ends)))
            words = ""
    except OptionError as error:
        words = f"A cannot be drawn over {parameter}: {str(error).removeprefix('a: ')}."
    b, a = sides[0][2], sides[1][2] if len(sides) > 1 else None
    data = {**{name: b[name] for name in TOLD}, "words": words, "table": _table(a, b, axis)}
    data["marks"] = {"compared": "yes" if a else "no"}
    return Answer(data, figures=_figures(axis, sides))


def _figures(axis: FigureAxis, sides: list[tuple[str, str, Side]]) -> list[FigureData]:
    x = sides[0][2]["grid"] / axis.factor
    factor, hertz = scaled("Hz", *(side["frequencies"] for *_, side in sides))
    modes = [line(x, row / factor, look, name) for name, look, side in sides for row in side["frequencies"].T]
    rates = [line(x, side["largest"], look, name) for name, look, side in sides]
    high = span(*(each["y"] for each in modes), room=0.2)
    upward = FigureAxis("frequency", hertz, high, factor=factor, quantity="frequency")
    rate = FigureAxis("growth rate", "1/s", span(*(each["y"] for each in rates), room=0.2), quantity="growth rate")
    return [
        FigureData("frequency", axis, upward, modes),
        FigureData("growth", axis, rate, [across(0.0), *rates], "top left"),
    ]


def _side(design: Design, parameter: str, ends: tuple[float, float]) -> Side:
    """What one of the two is compared by; SI values."""
    grid = np.linspace(*ends, POINTS)
    spectra = complex_modes(design.replace({parameter: grid}))
    tracks = followed(spectra.eigenvalues)
    tracks = np.where(np.imag(tracks) >= 0.0, tracks, np.nan)
    return {
        "grid": grid,
        "frequencies": np.imag(tracks[:, np.any(np.isfinite(tracks), axis=0)]) / (2.0 * np.pi),
        "largest": np.max(np.real(spectra.eigenvalues), axis=-1),
        "parameters": {name: text for name, text, *_ in parameter_rows(design)},
        **_state(design),
        **_margin(design, parameter, ends, try_value(design, parameter)),
    }


def _table(a: Side | None, b: Side, axis: FigureAxis) -> dict[str, Any]:
    """Rows of both sides; without A those of B. The growth rate says whether B is better or worse."""
    sides = [b] if a is None else [a, b]
    known = a is not None and a["growth"] is not None and b["growth"] is not None
    sense = np.sign(b["growth"] - a["growth"]) if a is not None and known else 0.0
    rates = [NONE if each["growth"] is None else f"{number(each['growth'], 5)} 1/s" for each in sides]
    rows: list[list[Any]] = [
        ["steady sliding", *(", ".join(filter(None, (each["state"], each["mechanism"]))) for each in sides)],
        ["worst mode", *(NONE if each["frequency"] is None else quantity(each["frequency"], "Hz", 5)
                         for each in sides)],
        ["its growth rate", *rates[:-1], (rates[-1], {-1.0: "better", 1.0: "worse"}.get(float(sense), ""))],
        [f"critical {axis.label}", *("none here" if each["critical"] is None else axis.value(each["critical"])
                                     for each in sides)],
        ["margin to it", *(NONE if each["margin"] is None else f"{number(100.0 * each['margin'], 3)} %"
                           for each in sides)],
    ]  # fmt: skip
    if a is not None:
        for name in dict.fromkeys([*a["parameters"], *b["parameters"]]):
            texts = [each["parameters"].get(name, NONE) for each in sides]
            rows += [[name, *texts]] if texts[0] != texts[1] else []
    return table(["", "A (kept)", "B (this page)"] if a is not None else ["", "B (this page)"], rows)


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


def _margin(design: Design, parameter: str, span: tuple[float, float], value: float | None) -> dict[str, Any]:
    found = crossings_of(design, parameter, span)
    near = found.nearest(span[0] if value is None else value)
    if near is None or value is None:
        return {"critical": None if near is None else float(near.value), "margin": None}
    nearest = float(near.value)
    return {"critical": nearest, "margin": (nearest - value) / abs(value) if value else None}

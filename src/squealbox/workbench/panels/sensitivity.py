"""Which parameter to change: what a little more of each does to the mode that grows first, and how much is needed."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from squealbox.design import Design
from squealbox.figure_data import Bars
from squealbox.parameters import ParameterError
from squealbox.remedies import usual_scatter
from squealbox.shapes import drawing_of
from squealbox.stability import MERGE, critical_values, sensitivity
from squealbox.system import InvalidSystem
from squealbox.workbench.frames import finite
from squealbox.workbench.panels.declared import Panel, Place, words
from squealbox.workbench.panels.modes import modes_of
from squealbox.workbench.panels.panel import Answer, Options, Work, axis_of

PANEL = Panel(
    "Which parameter to change", questions=("silences",), slow=True,
    choices=(words("for", "step", ("percent", "+1 %"), ("tolerance", "one tolerance")),),
    figures=(Place("sensitivity", bars=True),), layout="beside",
)  # fmt: skip

MOST_BARS = 16
ROUND_OFF = 1e-12  # of the eigenvalue: smaller changes of its real part are none
POINTS = 101  # of the range in which a critical value is looked for
LARGE = 40  # degrees of freedom beyond which it is not: the verdict looks along one parameter
ANGLE = np.deg2rad(1.0)  # tolerance of an angle, assumed
FAR = 0.1  # of an angle's range: what is farther is no small change
BEYOND = 0.01  # of the needed change, by which one goes further than to the edge


def answer(design: Design, options: Options, work: Work) -> Answer:
    """Change of growth rate [1/s] and frequency [Hz] for a step of each parameter, the strongest first.

    The step is one per cent, or a standard deviation of production where `usual_scatter` assumes one (1 degree of an
    angle, else one per cent). `needed` is the nearest value at which stability changes, with the way there in words,
    and a value just beyond; `place` is where the parameter is written in the drawing.
    """
    step = options.chosen(*PANEL.choices)["step"]
    modes = modes_of(design)
    if not bool(modes.exists):
        return _none(str(modes.outcome), modes.outcome.message)
    try:
        found = sensitivity(design)
    except ValueError as error:  # no steady sliding beside the design
        return _none("no_derivative", str(error))
    turn = np.sign(np.imag(found.eigenvalue)) / (2.0 * np.pi)
    steps = _steps(design, found, step)
    change = steps * found.first
    none = ROUND_OFF * abs(found.eigenvalue)
    order = [i for i in np.argsort(-np.abs(change.real), kind="stable") if abs(change[i].real) > none][:MOST_BARS]
    drawn = drawing_of(design)
    places = drawn.places()
    bars: list[dict[str, Any]] = []
    for count, i in enumerate(order):
        work.progress(count / len(order), "looking for what each needs")
        name = found.parameters[i]
        bar = {"name": name, "growth": float(change[i].real), "frequency": float(turn * change[i].imag),
               "value": float(found.values[i]), "place": places.get(name)}  # fmt: skip
        bars.append(bar | {"needed": _needed(design, name) if design.system().size <= LARGE else None})
    shown = [{"name": bar["name"], "parts": [("b0" if bar["growth"] > 0.0 else "b2", bar["growth"])],
              "sum": bar["growth"]} for bar in bars]  # fmt: skip
    told = dict(PANEL.choices[0]["options"])[step]
    data = {
        "outcome": "completed",
        "bars": bars,
        "growth": float(np.real(found.eigenvalue)),
        "condition": finite(found.condition),
        "near": found.near_defective,
        "stable": bool(modes.stable),
        "words": MERGE if found.near_defective else _words(bars, step, bool(modes.stable)),
    }
    if places:
        data |= drawn.data()
    return Answer(data, {"points": drawn.points}, [Bars("sensitivity", f"growth rate [1/s] for {told}", shown)])


def _none(outcome: str, why: str) -> Answer:
    return Answer({"outcome": outcome, "words": f"{why}.", "bars": []}, figures=[Bars("sensitivity", "", [])])


def _steps(design: Design, found: Any, step: str) -> Any:
    """The step of each parameter, in its unit."""
    percent = 0.01 * found.values
    if step == "percent":
        return percent
    try:
        scatter: Mapping[str, Any] = usual_scatter(design).distributions
    except ParameterError:  # nothing of it is known to scatter
        scatter = {}
    known = design.scalars()
    return np.array([
        float(scatter[name].frozen().std()) if name in scatter
        else ANGLE if name in known and known[name].unit == "rad" else percent[i]
        for i, name in enumerate(found.parameters)
    ])  # fmt: skip


def _needed(design: Design, name: str) -> dict[str, Any] | None:
    """The nearest value of a parameter at which stability changes, within its slider's range; None without one."""
    span, value = Options({}).span("span", design, name), float(design.value_of(name))
    try:
        change = critical_values(design, name, span, points=POINTS).nearest(value)
    except (ParameterError, InvalidSystem):  # a part of the range is none for this design
        return None
    if change is None:
        return None
    near = float(change.value)
    axis = axis_of(design, name)
    way = (near - value) / axis["factor"]
    told = f"{way:+.3g}°" if axis["unit"] == "deg" or not value else f"{100.0 * (near - value) / abs(value):+.3g} %"
    close = bool(abs(near - value) <= max(abs(value), FAR * (span[1] - span[0]) if axis["unit"] == "deg" else 0.0))
    return {"value": near, "told": told, "near": close, "beyond": value + (1.0 + BEYOND) * (near - value)}


def _words(bars: list[dict[str, Any]], step: str, stable: bool) -> str:
    if not bars:
        return "No parameter changes the growth rate."
    best = bars[0]
    much = "1 %" if step == "percent" else "One tolerance"
    less = "less" if best["growth"] > 0.0 else "more"
    said = f"{much} {less} of {best['name']} lowers growth by {abs(best['growth']):.3g} 1/s, while small."
    if any(bar["needed"] is not None for bar in bars):
        said += f" Keys: {'how far each is from the edge' if stable else 'what silences it alone'}."
    if step == "tolerance":
        said += " Assumed: friction 8 %, springs 3 %, dampers 20 %, angles 1°, others 1 %."
    without = [bar["name"] for bar in bars if bar["place"] is None]
    return said + (f" Not drawn: {', '.join(without)}." if 0 < len(without) < len(bars) else "")

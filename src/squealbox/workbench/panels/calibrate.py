"""Parameters of the design fitted to a squeal event of the recording, with intervals and what it leaves open."""

from typing import Any

from squealbox.calibration import calibrate, from_events
from squealbox.design import Design
from squealbox.parameters import ParameterError
from squealbox.signals import SignalError
from squealbox.words import number
from squealbox.workbench.frames import finite
from squealbox.workbench.panels.declared import FRICTION, Panel, over, words
from squealbox.workbench.panels.panel import Answer, OptionError, Options, Work, table, try_value
from squealbox.workbench.panels.recording import heard

PANEL = Panel(
    "Calibrate", questions=("matches",), columns=2, slow=True, apart=True, table="Fitted values",
    choices=(over("fit", "p0", FRICTION, span=""), over("and", "p1", "k3", "k2", "k", "k11", span=""),
             words("within", "share", ("0.1", "10 %"), ("0.3", "30 %"), ("0.6", "60 %"), usual="0.3")),
)  # fmt: skip

MOST = 4  # parameters
HEADS = ("parameter", "now", "fitted", "95 % interval")


def answer(design: Design, options: Options, work: Work) -> Answer:
    """Values, 95 % intervals, predictions beside the measured numbers, and words."""
    names = options.given.get("parameters")
    known = design.scalars()
    if not isinstance(names, list) or not 0 < len(names) <= MOST or any(name not in known for name in names):
        raise OptionError(f"parameters: expected one to {MOST} names of parameters of this design")
    share = options.chosen(*PANEL.choices)["share"]
    _, events = heard(options, work)
    bounds = {str(name): _bounds(design, str(name), share, known[name]) for name in names}
    work.progress(0.5, "fitting")
    try:
        measured = from_events(events, int(options.number("event", 0, 0, 1e6)))
        found = calibrate(design, bounds, measured)
    except (SignalError, ParameterError) as error:
        raise OptionError(str(error)) from error
    rows: list[dict[str, Any]] = []
    lines: list[list[str]] = []
    for i, name in enumerate(found.names):
        axis = options.axis(design, name, bounds[name])
        value, low, high = (finite(getattr(found, each)[i]) for each in ("values", "low", "high"))
        rows.append({"name": name, "values": value, "low": low, "high": high})
        before = axis.value(try_value(design, name))
        lines.append([name, before, axis.value(value), f"{axis.value(low)} to {axis.value(high)}"])
    fits = list(zip(found.settings["measured"], found.predicted, found.residuals, strict=True))
    said = [f"{text}: the fit says {number(value, 5)}, {number(away, 2)} sd apart." for text, value, away in fits]
    failed = [] if found.outcome.ok else [f"{found.outcome.message}."]
    words = " ".join([*failed, *found.cannot_tell, *said])
    data = {"outcome": str(found.outcome), "rows": rows, "fits": [[text, finite(away)] for text, _, away in fits]}
    return Answer({**data, "table": table(HEADS, lines), "words": words, "marks": {"outcome": data["outcome"]}})


def _bounds(design: Design, name: str, share: float, about: Any) -> tuple[float, float]:
    """A share of the value to either side, within the parameter's range."""
    value = try_value(design, name)
    if not value:
        raise OptionError(f"{name}: has no value to fit about")
    low, high = sorted((value * (1.0 - share), value * (1.0 + share)))
    return max(low, about.low), min(high, about.high)

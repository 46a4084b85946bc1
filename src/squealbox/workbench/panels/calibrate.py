"""Parameters of the design fitted to a squeal event of the recording, with intervals and what it leaves open."""

from typing import Any

from squealbox.calibration import calibrate
from squealbox.calibration.measured import from_events
from squealbox.designs import Design
from squealbox.files.varied import scalar_parameters
from squealbox.parameters import ParameterError
from squealbox.signals import SignalError
from squealbox.workbench.frames import finite
from squealbox.workbench.panels.panel import Answer, OptionError, Options, Work, axis_of, try_value
from squealbox.workbench.panels.recording import heard

MOST = 4  # parameters


def answer(design: Design, options: Options, work: Work) -> Answer:
    """Values, 95 % intervals, predictions beside the measured numbers, and words."""
    names = options.given.get("parameters")
    known = scalar_parameters(design)
    if not isinstance(names, list) or not 0 < len(names) <= MOST or any(name not in known for name in names):
        raise OptionError(f"parameters: expected one to {MOST} names of parameters of this design")
    share = options.number("share", 0.3, 0.001, 0.9)
    _, events = heard(options, work)
    bounds = {str(name): _bounds(design, str(name), share, known[name]) for name in names}
    work.progress(0.5, "fitting")
    try:
        measured = from_events(events, int(options.number("event", 0, 0, 1e6)))
        found = calibrate(design, bounds, measured)
    except (SignalError, ParameterError) as error:
        raise OptionError(str(error)) from error
    rows: list[dict[str, Any]] = []
    for i, name in enumerate(found.names):
        axis = axis_of(design, name)
        ends = {each: finite(getattr(found, each)[i]) for each in ("values", "low", "high")}
        rows.append({"name": name, **axis, "before": try_value(design, name), **ends})
    fits = zip(found.settings["measured"], found.predicted, found.residuals, strict=True)
    return Answer({
        "outcome": str(found.outcome), "message": found.outcome.message, "rows": rows,
        "fits": [[text, finite(value), finite(away)] for text, value, away in fits], "open": list(found.cannot_tell),
    })  # fmt: skip


def _bounds(design: Design, name: str, share: float, about: Any) -> tuple[float, float]:
    """A share of the value to either side, within the parameter's range."""
    value = try_value(design, name)
    if not value:
        raise OptionError(f"{name}: has no value to fit about")
    low, high = sorted((value * (1.0 - share), value * (1.0 + share)))
    return max(low, about.low), min(high, about.high)

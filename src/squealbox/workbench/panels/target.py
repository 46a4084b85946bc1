"""A target and how far it is: what share of production is stable up to a friction, and up to which the share asked."""

import numpy as np

from squealbox.design import Design
from squealbox.figure_data import FigureAxis, FigureData, Layer, across, line, points, text, upright
from squealbox.parameters import ParameterError
from squealbox.remedies import ASSUMED, Lot, lot_of
from squealbox.workbench.frames import finite
from squealbox.workbench.panels.declared import Panel, Place, number
from squealbox.workbench.panels.panel import Answer, OptionError, Options, Work

PANEL = Panel(
    "A target", questions=("silences",), slow=True, figures=(Place("lot", "", 150),),
    choices=(number("friction", "friction", 0.45, 0.01, 5.0, 0.01), number("for %", "share", 95.0, 1.0, 99.9, 0.1)),
)  # fmt: skip

POINTS = 241  # of the figure
TELLING = 0.05  # of the variance: less matters to nobody


def answer(design: Design, options: Options, work: Work) -> Answer:
    """Share of the lot [%] that is stable up to each friction, how far that is from the target, and words for it."""
    friction, share = options.chosen(*PANEL.choices).values()
    top = max(1.0, 1.3 * friction)
    try:
        lot = lot_of(design, top, say=lambda part: work.progress(part, "trying the lot"))
    except (ParameterError, ValueError) as error:
        raise OptionError(f"a target needs {getattr(error, 'expectation', error)}") from error
    reached, least = 100.0 * float(lot.stable(friction)), lot.friction(share / 100.0)
    low, high = _seen(lot, friction)
    axis = np.linspace(low, high, POINTS)
    data = {
        "friction": friction, "share": share, "stable": reached, "least": finite(least), "nominal": finite(lot.nominal),
        "marks": {"met": reached >= share}, "met": reached >= share,
        "brakes": len(lot.lost), "names": list(lot.names), "shares": list(lot.share),
        "words": f"{_words(lot, friction, share, reached, least)} {len(lot.lost)} brakes. {ASSUMED}.",
    }  # fmt: skip
    layers = [
        line(axis, 100.0 * lot.stable(axis)),
        across(share),
        upright(friction),
        *_named("target", friction, share),
    ]
    if np.isfinite(least):
        layers += _named("reached", least, share, "begin")
    over = FigureAxis("friction", "-", (low, high))
    return Answer(data, figures=[FigureData("lot", over, FigureAxis("stable", "%", (0.0, 105.0)), layers)])


def _named(words: str, x: float, share: float, look: str = "here") -> list[Layer]:
    """A point on the line of the share, with a word below it."""
    return [points([x], [share], look), text(x, share - 22.0, words)]


def _seen(lot: Lot, friction: float) -> tuple[float, float]:
    """The part of the axis where something happens, and the target."""
    known = lot.lost[np.isfinite(lot.lost)]
    if not len(known):
        return 0.0, lot.top
    ends = [float(known.min()), float(known.max()), friction]
    room = 0.15 * (max(ends) - min(ends)) + 0.01
    return max(min(ends) - room, 0.0), min(max(ends) + room, lot.top)


def _words(lot: Lot, friction: float, share: float, reached: float, least: float) -> str:
    low, high = (100.0 * each for each in lot.interval(friction))
    said = f"{reached:.3g} % of the lot ({low:.3g} to {high:.3g}) is stable up to {friction:.3g}"
    if not np.isfinite(least):
        edge = f"{share:.4g} % of it beyond {lot.top:.3g}"
    elif least <= lot.top / 1e4:
        edge = f"{share:.4g} % of it at no friction"
    else:
        far = f"{abs(least - friction):.2g} ({100.0 * abs(least - friction) / friction:.0f} %)"
        edge = f"{share:.4g} % of it up to {least:.3g}, {far} {'more' if least >= friction else 'short'}"
    matter = [f"{name} {100.0 * part:.0f} %" for name, part in zip(lot.names, lot.share, strict=True) if part > TELLING]
    whose = f" Spread by {', '.join(matter[:3])}." if matter else ""
    return f"{'Met' if reached >= share else 'Missed'}: {said}; {edge}.{whose}"

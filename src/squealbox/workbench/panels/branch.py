"""Limit cycles over a parameter: stable and unstable parts, where they are born, where they coexist with sliding.

Two walks: the branch born at the onset (harmonic balance, until a contact comes to rest), and the cycle at the present
design (shooting, exact stick and slip) to both sides. Every system that is made on the way asks whether somebody still
waits, so a walk can be stopped at any point.
"""

import json
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from squealbox.design import Design
from squealbox.figure_data import FigureAxis, FigureData, Layer, band, line, points, span
from squealbox.limit_cycles import (
    NEUTRAL,
    Branch,
    Cycle,
    HopfPoint,
    beside_sliding,
    branch,
    hopf_point,
    shooting,
    stable_sliding,
)
from squealbox.parameters import ParameterError
from squealbox.stability import complex_modes, critical_values
from squealbox.system import System
from squealbox.words import number, scaled, unit_at
from squealbox.workbench.frames import finite
from squealbox.workbench.panels.declared import FREEDOM, OVER, Panel, Place
from squealbox.workbench.panels.panel import Answer, OptionError, Options, Work

PANEL = Panel(
    "Limit cycles over a parameter", questions=("when",), slow=True, apart=True, along=True,
    choices=(OVER, FREEDOM),
    figures=(Place("branch", "", 270, "bent", "amplitude of the cycles: press Follow"),),
)  # fmt: skip

POINTS = 200  # of each walk to one side, at most: round two folds and back
STEP = 0.1  # longest, in shares of the range and of the motion
EDGE = (
    0.01  # share of the range left out at its lower end, where friction or load may be zero and derivatives are taken
)
ROOM = 0.005  # share of the range about an onset in which it is solved for
UPRIGHT = 1e-5  # share of the range within which a walk stands at one value
PUSHES = (0.5, 1.0, 3.0, 10.0)  # of the contacts' velocity over the sliding speed, from which a cycle is looked for
Make = Callable[[float], System]


def answer(design: Design, options: Options, work: Work) -> Answer:
    """The branches as curves (value, amplitude, stable), their special points, and the stretches of coexistence."""
    parameter, ends = options.over(design, OVER)
    ends = (ends[0] + EDGE * (ends[1] - ends[0]), ends[1])
    usual = min(max(float(design.value_of(parameter) or ends[0]), ends[0]), ends[1])
    at = max(options.number("at", usual, -1e300, 1e300), ends[0])
    if at > ends[1]:
        raise OptionError(f"at: expected a number in [{ends[0]:g}, {ends[1]:g}]")
    dof, points = options.dof(design), int(options.number("points", POINTS, 5, 1000))
    watched = _Watched(design, parameter, ends, at, work)
    try:
        born = _nearest_onset(watched, parameter, ends, at)
        cycle = _cycle(watched, design.replace({parameter: at}))
        centre = cycle is not None and bool(np.all(np.abs(np.abs(cycle.multipliers[1:]) - 1.0) < NEUTRAL))
        walks = list(_walks(watched, parameter, ends, at, born, None if centre else cycle, points))
    except ParameterError as error:
        raise OptionError(f"no limit cycles here: {error.expectation}") from error
    kept = [walk for walk in walks if len(walk.value)]
    return _drawn(design, options.axis(design, parameter, ends), ends, dof, born, kept, centre)


class _Watched:
    """The design as a function of one value that says how far a walk is, and ends where nobody waits any more."""

    def __init__(self, design: Design, parameter: str, span: tuple[float, float], at: float, work: Work) -> None:
        self.design, self.parameter, self.span, self.at, self.work = design, parameter, span, at, work
        self.share, self.room, self.text = 0.0, 0.0, ""

    def at_part(self, share: float, text: str, room: float = 0.0) -> Make:
        """The function for one part of the work, which begins at `share` and takes `room` of the whole."""
        self.share, self.room, self.text = share, room, text
        return self.make

    def make(self, value: float) -> System:
        """The system at a value of the parameter."""
        way = abs(value - self.at) / (self.span[1] - self.span[0])
        self.work.progress(min(self.share + self.room * min(way, 1.0), 0.99), self.text)
        return self.design.replace({self.parameter: value}).system()


def _nearest_onset(watched: _Watched, parameter: str, span: tuple[float, float], at: float) -> HopfPoint:
    """The onset of flutter nearest to the present value, the one the verdict speaks of."""
    make = watched.at_part(0.02, "looking for the onset")
    found = critical_values(watched.design, parameter, span)
    places = [float(each.value) for each in found.changes if each.mechanism != "divergence"]
    if not places:
        return hopf_point(make, parameter, span)
    near, room = min(places, key=lambda value: abs(value - at)), ROOM * (span[1] - span[0])
    return hopf_point(make, parameter, (max(near - room, span[0]), min(near + room, span[1])))


def _cycle(watched: _Watched, here: Design) -> Cycle | None:
    """A stable cycle at the present design, else an unstable one; None where no start led to one."""
    found = None
    for name, start in _starts(here):
        cycle = shooting(watched.at_part(0.1, f"cycle from {name}")(watched.at), start)
        if cycle.outcome.ok and cycle.stable:
            return cycle
        found = found or (cycle if cycle.outcome.ok else None)
    return found


def _starts(here: Design) -> Iterator[tuple[str, Any]]:
    modes = complex_modes(here)
    if not bool(modes.exists):
        yield "rest", "rest"
        return
    mode = modes.most_unstable
    rows = [(abs(float(c.V)), abs(c.t @ (mode.eigenvalue * mode.shape))) for c in here.system().contacts]
    swings = [moves / speed for speed, moves in rows if speed > 0.0 and moves > 0.0]
    if swings:
        for push in PUSHES:
            yield f"a push to {push:g} times the sliding speed", mode.start(push / max(swings))


def _walks(
    watched: _Watched,
    parameter: str,
    span: tuple[float, float],
    at: float,
    born: HopfPoint,
    cycle: Cycle | None,
    points: int,
) -> Iterator[Branch]:
    if born.outcome.ok:
        make = watched.at_part(0.25, "the branch born at the onset", 0.1)
        yield branch(make, parameter, span, born, points=points)
    if cycle is None:
        return
    how: dict[str, Any] = {"value": at, "method": "shooting", "points": points, "largest_step": STEP}
    for share, way, side in ((0.4, -1.0, "lower"), (0.7, 1.0, "higher")):
        make = watched.at_part(share, f"cycles at {side} values", 0.3)
        yield branch(make, parameter, span, cycle, direction=way, **how)


def _drawn(
    design: Design,
    axis: FigureAxis,
    span_: tuple[float, float],
    dof: int,
    born: HopfPoint,
    walks: list[Branch],
    centre: bool,
) -> Answer:
    own, names = unit_at(design.system(), dof), list(design.system().names)
    metre, unit = scaled(own, *(walk.amplitude[:, dof] for walk in walks)) if walks else (1.0, own)
    quiet = stable_sliding(design, axis.parameter, span_)
    together = [(a / axis.factor, b / axis.factor) for a, b in beside_sliding(walks, quiet)]
    sizes = [walk.amplitude[:, dof] / metre for walk in walks]
    _, top = span(*sizes, zero=True, room=0.3)
    layers = [band(*ends, "together") for ends in together]
    layers += [line([a / axis.factor, b / axis.factor], [0.0, 0.0], "s2", "stable sliding") for a, b in quiet]
    for walk, size in zip(walks, sizes, strict=True):
        layers += _curves(walk, size, axis.factor)
    specials = [each for walk, size in zip(walks, sizes, strict=True) for each in _specials(walk, size, span_, axis)]
    if specials:
        kinds = ", ".join(dict.fromkeys(kind for kind, *_ in specials))
        layers.append(points([x for _, x, _ in specials], [y for *_, y in specials], "begin", 5.0, column=kinds))
    hopf = finite(born.value / axis.factor) if born.outcome.ok else None
    if hopf is not None:
        layers.append(points([hopf], [0.0], column="onset"))
    ended = [f"{walk.outcome} {walk.outcome.message}".strip() for walk in walks]
    data: dict[str, Any] = {
        "hopf": hopf, "names": names, "dof": dof, "together": together, "centre": centre, "walks": len(walks),
        "parameter": axis.parameter, "factor": axis.factor,
        "marks": {"together": json.dumps(together), "walks": len(walks)},
        "words": " ".join(_words(axis, born, together, ended, specials, centre)),
    }  # fmt: skip
    upward = FigureAxis(f"amplitude of {names[dof]}", unit, (-0.03 * top, top))
    return Answer(data, figures=[FigureData("branch", axis, upward, layers)])


def _curves(walk: Branch, size: Any, factor: float) -> list[Layer]:
    """Stable stretches solid and unstable ones dashed; where they meet, the point is of both."""
    stable, x = np.asarray(walk.stable, dtype=bool), walk.value / factor
    before = np.r_[stable[:1], stable[:-1]]
    drawn = []
    for wanted, look, name in ((True, "s0", "stable cycle"), (False, "s1", "unstable cycle")):
        kept = np.where((stable == wanted) | (before == wanted), size, np.nan)
        if np.any(np.isfinite(kept)):
            drawn.append(line(x, kept, look, name))
    return drawn


def _specials(walk: Branch, size: Any, span_: tuple[float, float], axis: FigureAxis) -> list[tuple[str, float, float]]:
    if np.ptp(walk.value) <= UPRIGHT * (span_[1] - span_[0]):
        return []  # it stands at one value: each of its points looks special, by round-off
    rows = zip(walk.special_kind, walk.special_value, walk.special_point, strict=True)
    return [(str(kind).replace("_", " "), float(x) / axis.factor, float(size[int(at)])) for kind, x, at in rows]


def _words(
    axis: FigureAxis, born: HopfPoint, together: Any, ended: list[str], specials: Any, centre: bool
) -> Iterator[str]:
    unit = f" {axis.unit}" if axis.unit else ""
    if born.outcome.ok:
        yield f"Sliding loses its stability at {axis.value(float(born.value))}, {born.kind}."
    for low, high in together:
        yield (f"From {number(low)} to {number(high)}{unit} (shaded) a stable cycle exists beside stable sliding: "
               "a push decides.")  # fmt: skip
    early = list(dict.fromkeys(each for each in ended if not each.startswith("completed")))
    if early:
        yield f"Followed until: {'; '.join(early)}. Beyond that nothing is said."
    if centre:
        yield ("Closed orbits lie side by side about a centre, as nothing in the model damps them: none attracts, a "
               "push decides the size.")  # fmt: skip
    elif not ended:
        yield "No limit cycle was found from the starts tried; that does not prove there is none."
    told = list(dict.fromkeys(f"{kind} at {number(x, 5)}" for kind, x, _ in specials))
    if told:
        yield f"Circles: {', '.join(told[:6])}."

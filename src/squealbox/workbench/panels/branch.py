"""Limit cycles over a parameter: stable and unstable parts, where they are born, where they coexist with sliding.

Two walks: the branch born at the onset (harmonic balance, until a contact comes to rest), and the cycle at the present
design (shooting, exact stick and slip) to both sides. Every system that is made on the way asks whether somebody still
waits, so a walk can be stopped at any point.
"""

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from squealbox.designs import Design
from squealbox.limit_cycles import (
    Branch,
    Cycle,
    HopfPoint,
    beside_sliding,
    branch,
    hopf_point,
    shooting,
    stable_sliding,
)
from squealbox.limit_cycles.branches.stretches import NEUTRAL
from squealbox.parameters import ParameterError
from squealbox.plots.facts import unit_at
from squealbox.plots.style import scaled
from squealbox.stability import complex_modes, critical_values
from squealbox.system import System
from squealbox.workbench.frames import finite
from squealbox.workbench.panels.panel import Answer, OptionError, Options, Work, axis_of

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
    parameter = options.parameter("parameter", design, "friction.static")
    span = options.span("span", design, parameter)
    span = (span[0] + EDGE * (span[1] - span[0]), span[1])
    usual = min(max(float(design.value_of(parameter) or span[0]), span[0]), span[1])
    at = max(options.number("at", usual, -1e300, 1e300), span[0])
    if at > span[1]:
        raise OptionError(f"at: expected a number in [{span[0]:g}, {span[1]:g}]")
    dof, points = options.dof(design), int(options.number("points", POINTS, 5, 1000))
    watched = _Watched(design, parameter, span, at, work)
    try:
        born = _nearest_onset(watched, parameter, span, at)
        cycle, start = _cycle(watched, design.replace({parameter: at}))
        centre = cycle is not None and bool(np.all(np.abs(np.abs(cycle.multipliers[1:]) - 1.0) < NEUTRAL))
        walks = list(_walks(watched, parameter, span, at, born, None if centre else cycle, points))
    except ParameterError as error:
        raise OptionError(f"no limit cycles here: {error.expectation}") from error
    kept = [walk for walk in walks if len(walk.value)]
    return _drawn(design, parameter, span, dof, born, kept, start, centre)


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
    places = [float(each.value) for each in found if each.changes_stability and each.mechanism != "divergence"]
    if not places:
        return hopf_point(make, parameter, span)
    near, room = min(places, key=lambda value: abs(value - at)), ROOM * (span[1] - span[0])
    return hopf_point(make, parameter, (max(near - room, span[0]), min(near + room, span[1])))


def _cycle(watched: _Watched, here: Design) -> tuple[Cycle | None, str]:
    """A stable cycle at the present design and from where it was reached; None where no start led to one."""
    found = None
    for name, start in _starts(here):
        cycle = shooting(watched.at_part(0.1, f"cycle from {name}")(watched.at), start)
        if cycle.outcome.ok and cycle.stable:
            return cycle, name
        found = found or ((cycle, name) if cycle.outcome.ok else None)
    return found or (None, "")


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
    parameter: str,
    span: tuple[float, float],
    dof: int,
    born: HopfPoint,
    walks: list[Branch],
    start: str,
    centre: bool,
) -> Answer:
    axis, own = axis_of(design, parameter), unit_at(design.system(), dof)
    metre, unit = scaled(own, *(walk.amplitude[:, dof] for walk in walks)) if walks else (1.0, own)
    quiet = stable_sliding(design, parameter, span)
    data: dict[str, Any] = {
        "axis": axis,
        "span": [end / axis["factor"] for end in span],
        "unit": unit,
        "names": list(design.system().names),
        "dof": dof,
        "hopf": finite(born.value / axis["factor"]) if born.outcome.ok else None,
        "kind": born.kind if born.outcome.ok else "",
        "start": start,
        "centre": centre,
        "walks": [_walk(walk, span, dof, axis["factor"], metre) for walk in walks],
        "quiet": [[a / axis["factor"], b / axis["factor"]] for a, b in quiet],
        "together": [[a / axis["factor"], b / axis["factor"]] for a, b in beside_sliding(walks, quiet)],
    }
    arrays: dict[str, Any] = {}
    for i, walk in enumerate(walks):
        arrays |= {f"value{i}": walk.value / axis["factor"], f"size{i}": walk.amplitude[:, dof] / metre}
        arrays[f"stable{i}"] = np.asarray(walk.stable, dtype=float)
    return Answer(data, arrays)


def _walk(walk: Branch, span: tuple[float, float], dof: int, factor: float, metre: float) -> dict[str, Any]:
    specials = [
        [str(kind).replace("_", " "), float(value) / factor, float(walk.amplitude[int(point), dof]) / metre]
        for kind, value, point in zip(walk.special_kind, walk.special_value, walk.special_point, strict=True)
    ]
    if np.ptp(walk.value) <= UPRIGHT * (span[1] - span[0]):
        specials = []  # it stands at one value: each of its points looks special, by round-off
    return {"specials": specials, "ended": f"{walk.outcome} {walk.outcome.message}".strip()}

"""Everything a report asks of one design, computed once: no words, no figures.

What cannot be asked of a design (a limit cycle under a load that varies in time, a map where only one number can be
varied) is left out with the sentence that says why, in `missing`.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np

from squealbox.design import Design
from squealbox.family import ParameterAxis, ParameterPlane
from squealbox.fe import ReducedBrake
from squealbox.limit_cycles import Cycle, hopf_point, shooting
from squealbox.matrices import liveliest
from squealbox.parameters import ParameterError
from squealbox.remedies import silence
from squealbox.report.examination import Examination
from squealbox.schedules import Schedule, value_at
from squealbox.signals import SignalError, SoundLevel, sound_level
from squealbox.stability import (
    Sensitivity,
    band_modes,
    complex_modes,
    critical_values,
    map_boundary,
    mechanism,
    mode_energy,
    mode_table,
    sensitivity,
    stability_map,
    tracked_modes,
)
from squealbox.system import InvalidSystem
from squealbox.transient import LARGE, TIME_STEPPING, MotionSettings, usual_duration, verdict
from squealbox.words import AUDIBLE

Progress = Callable[[str], None]
MAP_POINTS = 81
MOST_MAP_POINTS = 151
CYCLE = "squealbox cycle looks for it, in its own time"
HEARD = 2.0  # seconds of motion that are made audible
SAMPLING = 88_200.0  # [Hz] of that motion
CYCLED = 0.5  # seconds of a limit cycle whose level is estimated
OF_LARGE = (0.05, 1.6)  # shares of its friction over which a finite-element brake is looked at
SPECTRA = 61  # values at which modes of a reduced brake are drawn
COARSE = 11  # points along each axis of a reduced brake's map
CLOSE, EXACT = 0.02, 1e-13  # share of a cell to which the boundary on it is located, and of any other brake
LOT = 256  # brakes of the lot that a cure is tried on
PUSHES = (1.0, 3.0)  # velocities at the contacts, over the sliding speed, from which a cycle is looked for


def examine(
    design: Design,
    *,
    onset: ParameterAxis | None = None,
    plane: ParameterPlane | None = None,
    simulate: MotionSettings | None = None,
    time: float = 0.0,
    progress: Progress = lambda text: None,
) -> Examination:
    """Stability, margin, sensitivity, energy, map, transient, sound, limit cycle and cures of a design.

    Parameters
    ----------
    design : one design, without leading axes
    onset, plane, simulate : the sections of a design file; left out, the friction at rest (else the parameter that
        matters most) is varied, with the next in the ranking beside it, and the motion from rest is followed for 200
        periods of the worst mode
    time : instant at which schedules are taken [s]
    progress : called with what is being done

    Raises `ParameterError` for a design that stands for a map. Anything else that cannot be computed is in `missing`.
    """
    work = _Work(design, time, progress)
    if work.modes.eigenvalues.ndim > 1:
        raise ParameterError(type(design).__name__, "design", "arrays", "one brake, not a map of brakes")
    work.stability(onset)
    work.margins(plane)
    work.transient(simulate)
    work.cycle()
    work.cures()
    return Examination(
        design=design, system=work.system, modes=work.modes, time=time, missing=work.missing, **work.found
    )


class _Work:
    """The parts of an examination, found one after the other."""

    def __init__(self, design: Design, time: float, progress: Progress) -> None:
        self.design, self.time, self.progress = design, time, progress
        self.system = design.system()
        self.moving = design.sliding_one_way().system() if isinstance(design, ReducedBrake) else self.system
        self.reduced = isinstance(design, ReducedBrake)
        self.long = 0 if self.reduced else LARGE  # coordinates times contacts that long motions are made of unasked
        self.modes = complex_modes(design, time)
        self.found: dict[str, Any] = {}
        self.missing: dict[str, str] = {}

    @contextmanager
    def part(self, name: str, text: str) -> Iterator[None]:
        """One part: what cannot be asked of this design is noted under its name."""
        self.progress(text)
        try:
            yield
        except ParameterError as error:
            varies = isinstance(error.value, Schedule)
            self.missing[name] = f"{error.expectation}, and something varies in time" if varies else str(error)
        except (InvalidSystem, SignalError, ValueError) as error:
            self.missing[name] = " ".join(str(error).split())

    def stability(self, onset: ParameterAxis | None) -> None:
        if not self.modes.exists:
            self.missing["stability"] = f"there is no steady sliding: {self.modes.outcome.message}"
            return
        if isinstance(self.design, ReducedBrake) and self.design.full is not None:
            with self.part("error bars", "modes with their error bars"):
                self.found["whole"] = whole = self.design.whole()
                self.found["band"] = band = band_modes(whole, self.design.band, time=self.time)
                self.found["mode_table"] = mode_table(whole, band, self.time)
        with self.part("ranking", "sensitivity"):
            self.found["ranking"] = sensitivity(self.design, self._leaves(), time=self.time)
        with self.part("energy", "energy of the worst mode"):
            self.found["why"] = mechanism(self.design, self.time)
            if self.modes.most_unstable.angular_frequency > 0.0:
                self.found["energy"] = mode_energy(self.design, None, self.time)
        with self.part("onset", "looking for the onset"):
            self.found["varied"] = varied = onset or self._usual_axis()
            self.found["crossings"] = crossings = critical_values(
                self.design, varied.name, (varied.low, varied.high), time=self.time
            )
            drawn = varied.replace(points=min(int(varied.points), SPECTRA)) if self.reduced else varied
            values = np.sort(np.append(drawn.values, crossings.value))
            if self.reduced:
                self.found["spectra"] = tracked_modes(self.design, varied.name, values, time=self.time)
            else:
                self.found["spectra"] = complex_modes(self.design.replace({varied.name: values}), self.time)
            self.found["varied"] = drawn

    def margins(self, plane: ParameterPlane | None) -> None:
        """The map over two parameters with its boundary."""
        if "spectra" not in self.found:
            return
        with self.part("map", "map over two parameters"):
            self.found["plane"] = chosen = plane or self._usual_plane()
            most = COARSE if self.reduced else MOST_MAP_POINTS
            points = [np.linspace(a.low, a.high, min(int(a.points), most)) for a in (chosen.x, chosen.y)]
            names = (chosen.x.name, chosen.y.name)
            self.found["map"] = stability_map(self.design, dict(zip(names, points, strict=True)), time=self.time)
            close = CLOSE if self.reduced else EXACT
            # ends for every design; tracing corners may not
            self.found["boundary"] = map_boundary(self.found["map"], close=close)

    def transient(self, simulate: MotionSettings | None) -> None:
        with self.part("transient", "transient (the first run compiles the engine)"):
            if simulate is None:
                self._not_too_large("a motion", "[simulate] in the file asks for one, and for how long")
            self.found["settings"] = settings = (
                simulate or MotionSettings(duration=usual_duration(self.design, self.time))
            ).lasting(self.design)
            moving = self.system if settings.contact == TIME_STEPPING else self.moving
            self.found["motion"] = motion = settings.run_closely(moving)
            if not motion.outcome.ok:
                self.missing["sound"] = f"the transient ended early: {motion.outcome.message}"
                return
            self.found["verdicts"] = tuple(verdict(motion, dof=i) for i in range(self.system.size))
        if "verdicts" not in self.found:
            return
        with self.part("sound", "sound"):
            dof = liveliest([float(one.amplitude) for one in self.found["verdicts"]], self.system.units)
            last = motion.t[-1] - 0.25 * (motion.t[-1] - motion.t[0])
            self.found["loudness"] = sound_level(motion, dof=dof, begin=last)
            pitch = float(self.found["verdicts"][dof].frequency)
            if not AUDIBLE[0] <= pitch <= AUDIBLE[1]:
                raise SignalError(f"its frequency, {pitch:.4g} Hz, is not one people hear")
            hear = "squealbox listen makes sound of a recording"
            self._not_too_large("two seconds of motion to be heard", hear, self.long)
            longer = settings.replace({"duration": max(HEARD, settings.duration or 0.0)})
            self.found["heard"] = longer.run(moving, int((longer.duration or HEARD) * SAMPLING) + 1)

    def cycle(self) -> None:
        """A limit cycle: from the usual start, the end of the transient, and pushes about steady sliding."""
        if self.modes.exists:
            with self.part("hopf", "how the cycle is born"):
                varied = self.found.get("varied")
                self._not_too_large("the birth of a cycle", CYCLE, self.long)
                if varied is not None:
                    self.found["hopf"] = hopf_point(self.design, varied.name, (varied.low, varied.high))
        tried: list[str] = []
        with self.part("cycle", "limit cycle"):
            self._not_too_large("a limit cycle", CYCLE, self.long)
            for name, start in self._starts():
                tried.append(name)
                found = shooting(self.moving, start)
                best = self.found.get("cycle")
                if best is None or (found.outcome.ok and not best.outcome.ok):
                    self.found["cycle"] = found
                if found.outcome.ok and found.stable:
                    self.found["cycle"] = found
                    break
        self.found["tried"] = tuple(tried)
        cycle = self.found.get("cycle")
        if cycle is not None and cycle.outcome.ok and cycle.stable:
            with self.part("sound of the cycle", "sound of the limit cycle"):
                self.found["cycle_loudness"] = _loudness(cycle)

    def cures(self) -> None:
        """What would silence it, or keep it silent with more friction."""
        if not self.modes.exists:
            return
        with self.part("cures", "cures"):
            if self.reduced:
                raise InvalidSystem("squealbox silence looks for cures of a finite-element brake, in its own time")
            self.found["remedies"] = silence(self.design, samples=LOT)

    def _not_too_large(self, what: str, way_out: str, most: int = LARGE) -> None:
        """Raise `InvalidSystem` where this would run for minutes."""
        if self.system.size * len(self.system.contacts) > most:
            raise InvalidSystem(
                f"{what} of {self.system.size} coordinates and {len(self.system.contacts)} contacts takes minutes and "
                f"is not looked for unasked: {way_out}"
            )

    def _starts(self) -> Iterator[tuple[str, Any]]:
        yield "the worst mode", None
        motion = self.found.get("motion")
        if motion is not None and motion.outcome.ok:
            yield "the end of the transient", motion
        if not self.modes.exists:
            return
        mode = self.modes.most_unstable
        speeds = [abs(float(value_at(contact.V, self.time))) for contact in self.system.contacts]
        motion = [abs(contact.t @ (mode.eigenvalue * mode.shape)) for contact in self.system.contacts]
        swing = [moves / speed for moves, speed in zip(motion, speeds, strict=True) if speed > 0.0]
        if max(swing, default=0.0) == 0.0:
            return
        for push in PUSHES:
            yield f"a push to {push:g} times the sliding speed", mode.start(push / max(swing))

    def _leaves(self) -> tuple[str, ...]:
        """Parameters that hold one number other than zero and can be varied; those inside a schedule cannot."""
        heads = {name for name in self.design.field_names() if isinstance(getattr(self.design, name), Schedule)}
        numbers = [name for name, _, value in self.design.leaves() if isinstance(value, float) and value != 0.0]
        known = self.design.scalars()
        return tuple(name for name in numbers if name in known and name.partition(".")[0] not in heads)

    def _usual_axis(self) -> ParameterAxis:
        known = self.design.scalars()
        rubs = "friction.static" in known and self.system.contacts
        name = "friction.static" if rubs else self._strongest([])
        return self._about(name, 0.05, 2.5)

    def _usual_plane(self) -> ParameterPlane:
        varied: ParameterAxis = self.found["varied"]
        if self.reduced:
            raise InvalidSystem("a finite-element brake is reduced for what it varies, which [map] in the file says")
        other = self._about(self._strongest([varied.name]), 0.5, 1.5)
        x = varied.replace(points=MAP_POINTS)
        return ParameterPlane(x, other.replace(points=MAP_POINTS))

    def _strongest(self, but: list[str]) -> str:
        ranking: Sensitivity | None = self.found.get("ranking")
        names = [name for name, change in ranking.ranked() if name not in but and change != 0.0] if ranking else []
        if not names:
            raise ParameterError(type(self.design).__name__, "design", "it", "a parameter that changes the growth rate")
        return names[0]

    def _about(self, name: str, low: float, high: float) -> ParameterAxis:
        return _about(self.design, name, low, high)


def _loudness(cycle: Cycle) -> SoundLevel:
    """How loud a limit cycle is: the freedom that moves most, over many periods."""
    dof = liveliest(list(cycle.amplitude), cycle.system.units)
    t = np.arange(int(CYCLED * SAMPLING)) / SAMPLING
    return sound_level(np.interp(t, cycle.t, cycle.qd[:, dof], period=cycle.period), t)


def usual_friction(design: Design, shares: tuple[float, float]) -> ParameterAxis | None:
    """The friction at rest over shares of its own value; None of a design that has none, or several."""
    known = design.scalars()
    return _about(design, "friction.static", *shares) if "friction.static" in known else None


def _about(design: Design, name: str, low: float, high: float) -> ParameterAxis:
    """A range about the design's own value in shares of it, inside what the parameter may be."""
    value, about = float(design.value_of(name)), design.scalar(name)
    ends = sorted((low * value, high * value))
    ends = [float(np.clip(end, about.low, about.high)) for end in ends]
    if about.low_open and ends[0] == about.low:
        ends[0] += 1e-3 * abs(value)
    return ParameterAxis(name, ends[0], ends[1])

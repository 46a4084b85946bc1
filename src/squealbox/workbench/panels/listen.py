"""The motion as sound at its true frequency, as it slides or braking to rest, and how loud that may be."""

from typing import Any

import numpy as np

from squealbox.design import Design
from squealbox.figure_data import FigureAxis, FigureData, heat, line, text
from squealbox.matrices import liveliest
from squealbox.signals import (
    AREA,
    AUDIBLE,
    SAMPLING,
    SignalError,
    audible,
    dominant_frequency,
    rendered,
    spectrogram,
    squeal_events,
)
from squealbox.transient import Trajectory
from squealbox.words import level_told, number, quantity, scaled
from squealbox.workbench.panels.declared import FREEDOM, Panel, Place, words
from squealbox.workbench.panels.following import followed, moving
from squealbox.workbench.panels.loudness import loudest, loudness
from squealbox.workbench.panels.panel import Answer, Elsewhere, Options, Work
from squealbox.workbench.panels.start import start_and_dof
from squealbox.workbench.panels.stop import LEFT_OUT, braking

PANEL = Panel(
    "Listen", questions=("happens",), slow=True,
    choices=(FREEDOM, words("heard", "slow", ("1", "true"), ("8", "slowed 8 times"), ("32", "slowed 32 times")),
             words("while", "braking", ("0", "as it slides"),
                   *((f"{s:g}", f"braking to rest in {s:g} s") for s in (0.5, 1, 2, 4)))),
    figures=(Place("sound", "", 170, awaited="the sound: press Play"),),
)  # fmt: skip

SECONDS = 1.5
RATE = 2.0 * SAMPLING  # of the motion: nothing heard is folded down
FADE = 0.01  # s at each end
FRAMES, TURNS = 1500, 12  # pictures that go along with a sound, and periods they seem to show
LATE = 3.0  # s that a second of a stop takes, in a process of its own
BAND, LEAST = (200.0, 16000.0), 70.0  # Hz and dB(A) of the events looked for
ROOM = 2e-5 * 10.0 ** (30.0 / 20.0)  # Pa: noise of 30 dB, which a microphone would hear too
PIECE = 0.04  # s of a column of the spectrogram
ROWS = 160  # of its picture
HARMONIC = 0.04  # by which an event may miss a multiple of a louder one and be its harmonic
MOST_TOLD = 4


def answer(design: Design, options: Options, work: Work) -> Answer:
    """The sound of one degree of freedom as samples at 44.1 kHz, in the unit named, with pitch and estimated level.

    With `braking` [s] it is that of a stop: sound pressure, its spectrogram (frequencies, times) and the squeal events.
    `frameQ`, `frameForce` and `frameState` are what the brake looks like as it sounds, lit once a period.
    """
    area, braked = options.number("area", AREA, 1e-6, 10.0), options.chosen(*PANEL.choices)["braking"]
    if braked:
        return _stop(design, braked, area, work)
    system = moving(design)
    start, dof = start_and_dof(design, options)
    motion = followed(system, SECONDS, work, 0.8, start=start, times=int(SECONDS * RATE) + 1)
    work.progress(0.8, "listening")
    if options.given.get("dof") is None and motion.outcome.ok:
        dof = loudest(motion)
    data = {"names": list(system.names), "dof": dof, "rate": SAMPLING, "outcome": str(motion.outcome)}
    if not motion.outcome.ok:
        return Answer({**data, "silent": f"The run ended early: {motion.outcome.message}."})
    try:
        pitch = dominant_frequency(motion, dof=dof)
    except SignalError as error:
        return Answer({**data, "silent": f"Nothing to hear: {error}."})
    if not AUDIBLE[0] <= pitch <= AUDIBLE[1]:
        slow = pitch < AUDIBLE[0]  # too few periods for a number: the panel of the motion takes longer
        told = f"below {AUDIBLE[0]:g} Hz" if slow else f"at {quantity(pitch, 'Hz')}"
        return Answer({**data, "silent": f"It moves {told}, which nobody hears."})
    wave = audible(motion, dof=dof, fade=FADE)
    factor, unit = scaled(system.units[dof], wave)
    data |= {
        "unit": unit,
        "factor": factor,
        "pitch": pitch,
        "largest": float(np.max(np.abs(wave))),
        **loudness(motion, dof, begin=0.75 * SECONDS, area=area),
    }
    data["words"] = f"{system.names[dof]} at {quantity(pitch, 'Hz', 5)}, {_loud(data)}"
    return Answer(data, {"wave": wave / factor, **_frames(motion, pitch)})


def _loud(data: dict[str, Any]) -> str:
    """The level while it lasts, or that it does not: the estimate looks at the end of the sound."""
    if data["level"] is None or data["level"] < 0.0:
        return "and dies away: in the end nothing is left to hear"
    return f"about {level_told(data['level'], data['weighted'])} at 1 m"


def _frames(motion: Trajectory, pitch: float) -> dict[str, Any]:
    """The motion at instants that move on with the sound, by whole periods and a small part of one."""
    share = np.arange(FRAMES) / FRAMES
    at = (np.floor(share * motion.t[-1] * pitch) + (TURNS * share) % 1.0) / pitch
    rows = np.clip(np.rint(at / motion.t[-1] * (len(motion.t) - 1)).astype(int), 0, len(motion.t) - 1)
    return {
        "frameQ": motion.q[rows], "frameForce": motion.normal_force[rows], "frameState": motion.mode[rows]
    }  # fmt: skip


def _stop(design: Design, seconds: float, area: float, work: Work) -> Answer:
    stopping, speed, unit = braking(design, seconds)
    if not work.apart:
        raise Elsewhere("following the stop", 1.0 + LATE * seconds)
    system = moving(stopping)
    motion = followed(system, seconds, work, 0.6, start="rest", times=int(seconds * RATE) + 1)
    if not motion.outcome.ok:
        data = {"names": list(system.names), "dof": 0, "rate": SAMPLING, "outcome": str(motion.outcome)}
        return Answer({**data, "silent": f"The stop ended early: {motion.outcome.message}."})
    lines = [i for i, unit in enumerate(system.units) if unit == "m"] or list(range(system.size))
    dof = lines[liveliest(np.std(motion.qd[:, lines], axis=0), tuple(system.units[i] for i in lines))]
    heard = rendered(motion, dof=dof, area=area, noise=ROOM)
    pressure, times = heard.channel(0), motion.t
    events = _events(pressure, times)
    wave = audible(pressure, times, fade=FADE)
    grid = spectrogram(pressure, times, segment=PIECE, overlap=0.5)
    pitch = max(events, key=lambda event: event[3])[2] if events else 0.0
    top = min(max(3.5 * pitch, 4000.0), BAND[1])
    seen = grid.frequency <= top
    each = max(int(np.count_nonzero(seen)) // ROWS, 1)
    count = int(np.count_nonzero(seen)) // each
    picture = grid.amplitude[: count * each].reshape(count, each, -1).max(axis=1)
    level = max((event[3] for event in events), default=None)
    data = {
        "names": list(system.names), "dof": dof, "rate": SAMPLING, "outcome": "completed", "unit": "Pa", "factor": 1.0,
        "pitch": pitch, "largest": float(np.max(np.abs(wave))), "level": level, "weighted": level, "of": "",
        "seconds": seconds, "speed": speed, "speedUnit": unit, "events": events,
        "words": _told(events, system.names[dof]),
        "assumption": f"The pressure is that of {1e4 * area:.3g} cm² of {system.names[dof]} at 1 m.",
    }  # fmt: skip
    figure = _picture(picture, grid.time, float(grid.frequency[count * each - 1]), data)
    return Answer(data, {"wave": wave, **_frames(motion, pitch or 1.0 / PIECE)}, [figure])


def _picture(picture: Any, time: Any, top: float, data: dict[str, Any]) -> FigureData:
    """The spectrogram of a stop, the speed as a line from its first value to none, and the squeal events by name."""
    span, height = (float(time[0]), float(time[-1])), top / 1e3
    falls = [height * (1.0 - each / data["seconds"]) for each in span]
    layers = [line(list(span), falls, "s2", f"speed {number(data['speed'], 3)} to 0 {data['speedUnit']}")]
    for begin, end, hertz, level in data["events"]:
        layers.append(line([begin, end], [hertz / 1e3] * 2, "s1"))
        layers.append(
            text((max(begin, span[0]) + end) / 2.0, hertz / 1e3, f"{quantity(hertz, 'Hz', 3)}, {level:.0f} dB(A)")
        )
    upward = FigureAxis("frequency", "kHz", (0.0, height), factor=1e3, quantity="frequency")
    seen = heat(picture, "decades", "sound pressure", "Pa", smooth=True)
    return FigureData("sound", FigureAxis("time", "s", span), upward, layers, "bottom left", seen)


def _events(pressure: Any, times: Any) -> list[list[float]]:
    """Begin [s], end [s], frequency [Hz] and peak level [dB(A)] of the loudest squeal events, without harmonics."""
    found = squeal_events(pressure[::2], SAMPLING, band=BAND, least_level=LEAST)
    rows = sorted(zip(found.onset, found.end, found.frequency, found.peak_level, strict=True), key=lambda row: -row[3])
    kept: list[list[float]] = []
    for row in rows:
        overtone = any(
            row[0] < other[1] and other[0] < row[1] and round(row[2] / other[2]) >= 1
            and abs(row[2] / (round(row[2] / other[2]) * other[2]) - 1.0) < HARMONIC for other in kept
        )  # fmt: skip
        if not overtone:
            kept.append([float(number) for number in row])
    return sorted(kept[:MOST_TOLD])


def _told(events: list[list[float]], name: str) -> str:
    if not events:
        return f"No squeal of {LEAST:g} dB(A) or more in this stop. {LEFT_OUT}."
    told = [f"{quantity(f, 'Hz')}, {level:.0f} dB(A), {begin:.2g} to {end:.2g} s" for begin, end, f, level in events]
    return f"Squeal of {name} at 1 m, an estimate: {'; '.join(told)}. {LEFT_OUT}."

"""The motion as sound: a second and a half of it at its true frequency, and an estimate of how loud that may be."""

import numpy as np

from squealbox.designs import Design
from squealbox.plots.style import scaled
from squealbox.signals import SignalError, audible, dominant_frequency, sound_level
from squealbox.signals.radiation import AREA, AUDIBLE
from squealbox.signals.wav import SAMPLING
from squealbox.transient import simulate
from squealbox.workbench.frames import finite
from squealbox.workbench.panels.motion import STARTS, beginning_of
from squealbox.workbench.panels.panel import Answer, OptionError, Options, Work

SECONDS = 1.5
RATE = 2.0 * SAMPLING  # of the motion: nothing heard is folded down
FADE = 0.01  # s at each end


def answer(design: Design, options: Options, work: Work) -> Answer:
    """The sound of one degree of freedom as samples at 44.1 kHz, in the unit named, with pitch and estimated level."""
    system = design.system()
    start = options.word("start", STARTS)
    dof = int(options.number("dof", 0, 0, 10_000))
    area = options.number("area", AREA, 1e-6, 10.0)
    if dof >= system.size:
        raise OptionError(f"dof: expected 0 to {system.size - 1}")
    work.progress(0.0, "following the motion")
    beginning = beginning_of(design, start, options.number("push", 0.05, 0.0, 10.0))
    motion = simulate(system, SECONDS, start=beginning, times=int(SECONDS * RATE) + 1)
    work.progress(0.8, "listening")
    data = {"names": list(system.names), "dof": dof, "rate": SAMPLING, "outcome": str(motion.outcome)}
    if not motion.outcome.ok:
        return Answer({**data, "silent": f"The run ended early: {motion.outcome.message}."})
    try:
        pitch = dominant_frequency(motion, dof=dof)
    except SignalError as error:
        return Answer({**data, "silent": f"Nothing to hear: {error}."})
    if not AUDIBLE[0] <= pitch <= AUDIBLE[1]:
        return Answer({**data, "silent": f"It moves at {pitch:.4g} Hz, which nobody hears."})
    wave = audible(motion, dof=dof, fade=FADE)
    factor, unit = scaled("m", wave)
    level = sound_level(motion, dof=dof, begin=0.75 * SECONDS, area=area)
    data |= {
        "unit": unit,
        "factor": factor,
        "pitch": pitch,
        "largest": float(np.max(np.abs(wave))),
        "level": finite(level.level),
        "weighted": finite(level.weighted),
        "assumption": level.assumption,
    }
    return Answer(data, {"wave": wave / factor})

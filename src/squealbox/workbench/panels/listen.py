"""The motion as sound: a second and a half of it at its true frequency, and an estimate of how loud that may be."""

import numpy as np

from squealbox.designs import Design
from squealbox.signals import SignalError, audible, dominant_frequency
from squealbox.signals.radiation import AREA, AUDIBLE
from squealbox.signals.wav import SAMPLING
from squealbox.words import scaled
from squealbox.workbench.panels.following import followed
from squealbox.workbench.panels.loudness import loudest, loudness
from squealbox.workbench.panels.panel import Answer, Options, Work
from squealbox.workbench.panels.start import start_and_dof

SECONDS = 1.5
RATE = 2.0 * SAMPLING  # of the motion: nothing heard is folded down
FADE = 0.01  # s at each end


def answer(design: Design, options: Options, work: Work) -> Answer:
    """The sound of one degree of freedom as samples at 44.1 kHz, in the unit named, with pitch and estimated level."""
    system = design.system()
    start, dof = start_and_dof(design, options)
    area = options.number("area", AREA, 1e-6, 10.0)
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
        told = f"below {AUDIBLE[0]:g} Hz" if slow else f"at {pitch:.4g} Hz"
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
    return Answer(data, {"wave": wave / factor})

"""`squealbox listen`: the motion as sound."""

from pathlib import Path
from typing import Any

import numpy as np

from squealbox.cli.inputs import free, in_motion, number, read
from squealbox.cli.options import AS_WRITTEN, Asked
from squealbox.cli.running import ComputationFailed, UsageError
from squealbox.signals import SignalError, column, dominant_frequency, sound, sound_level
from squealbox.transient import MotionSettings
from squealbox.waiting import Progress

ABOUT = {"listen": "the motion as sound at its true frequency (WAV), and how loud it may be"}

SAMPLES = 88_200.0  # a second: twice what a sound needs, so that nothing heard is folded down


def listen(
    file: Path,
    *,
    out: Path = Path("squeal.wav"),
    duration: str = "2s",
    dof: str | None = None,
    slower: float = 1.0,
    asked: Asked = AS_WRITTEN,
) -> None:
    """Write the motion as a WAV file at its true frequency, and say how loud it may be.

    Parameters
    ----------
    file
        design file; its section [simulate] says how the motion starts
    out
        the WAV file
    duration
        how long the motion is followed: 2s
    dof
        name of the degree of freedom; by default the one that moves most at the end
    slower
        play it this many times slower, for what is too high to hear
    """
    found = read(file, asked)
    if out.suffix.lower() != ".wav":
        raise UsageError(f"--out {out}: expected a name that ends in .wav")
    free(out)
    seconds = number(duration, "s", f"--duration {duration[:60]}")
    if not 0.0 < seconds <= 60.0:
        raise UsageError(f"--duration {duration}: expected more than 0 and at most 60 s")
    found = in_motion(found, contact=(found.simulate or MotionSettings()).contact)
    settings = (found.simulate or MotionSettings()).replace({"duration": seconds})
    with Progress("simulating (the first run compiles the engine)"):
        motion = settings.run(found.design.system(), int(seconds * SAMPLES) + 1)
    if not motion.outcome.ok:
        raise ComputationFailed(motion.outcome)
    try:
        print(_written(motion, dof, out, slower))
    except SignalError as error:
        raise UsageError(str(error)) from error


def _written(motion: Any, dof: str | None, out: Path, slower: float) -> str:
    """The WAV file and the level, in two lines."""
    late = float(motion.t[-1] - 0.25 * (motion.t[-1] - motion.t[0]))
    place = int(np.argmax(np.ptp(motion.q[motion.t >= late], axis=0))) if dof is None else column(motion, dof)
    path = sound(motion, out, dof=place, slower=slower)
    pitch = dominant_frequency(motion, dof=place)
    level = sound_level(motion, dof=place, begin=late)
    name = motion.system.names[place]
    return f"{path}: {name} at {pitch:.6g} Hz{f', played {slower:g} times slower' if slower != 1.0 else ''}\n{level}"

"""What happens in time: one transient, its spectrum, phase plane and spectrogram, and the verdict on it in words."""

from typing import Any

import numpy as np

from squealbox.designs import Design
from squealbox.files.runs import usual_duration
from squealbox.plots.facts import unit_at
from squealbox.plots.style import scaled
from squealbox.signals import SignalError, peaks, spectrogram, spectrum
from squealbox.transient import Trajectory, verdict
from squealbox.workbench.frames import finite
from squealbox.workbench.panels.following import followed
from squealbox.workbench.panels.loudness import loudest, loudness
from squealbox.workbench.panels.panel import Answer, Options, Work
from squealbox.workbench.panels.start import start_and_dof

SAMPLES = 4096  # instants kept: 40 a period over a hundred periods
DRAWN = 1024  # pairs of least and largest value along the time axis
SHOWN = 241  # instants at the end in which the brake is seen to move: six periods of a hundred
LAST = 0.25  # share of the motion that the verdict and the estimate of the sound level are about
PERIODS = 100  # followed when nothing is given
CONTACTS = ("exact", "smooth")


def answer(design: Design, options: Options, work: Work) -> Answer:
    """The motion of one degree of freedom over time, and what a signal analysis says of it."""
    system = design.system()
    start, dof = start_and_dof(design, options)
    contact = options.word("contact", CONTACTS)
    duration = options.number("duration", 0.0, 0.0, 1e6) or usual_duration(design, periods=PERIODS)
    motion = followed(system, duration, work, 0.6, start=start, times=SAMPLES, contact=contact)
    work.progress(0.6, "spectrum")
    data = {
        "names": list(system.names),
        "dof": dof,
        "duration": duration,
        "outcome": str(motion.outcome),
        "message": motion.outcome.message,
        "steps": motion.steps,
        "caution": motion.caution,
    }
    if motion.t.size < 64:
        return Answer({**data, "short": True})
    return _signals(motion, dof, data)


def _signals(motion: Trajectory, dof: int, data: dict[str, Any]) -> Answer:
    x, v, t = motion.q[:, dof], motion.qd[:, dof], motion.t
    metre, size = scaled(unit_at(motion.system, dof), x)
    second, clock = scaled("s", t)
    speed, rate = scaled(unit_at(motion.system, dof, moves=True), v)
    data |= {"unit": size, "clock": clock, "speed": rate, "lastFrom": float(t[max(len(t) - SHOWN, 0)] / second)}
    judged = verdict(motion, dof=dof)
    data |= {
        "verdict": judged.text,
        "fate": judged.fate,
        "amplitude": finite(judged.amplitude),
        "frequency": finite(judged.frequency),
        "loud": loudness(motion, loudest(motion), begin=float(t[-1] - LAST * (t[-1] - t[0]))),
        "sticking": [finite(np.mean(motion.mode[:, i] == 0)) for i in range(motion.mode.shape[1])],
        "speeds": [
            [finite(np.min(column)), finite(np.max(column))] for column in motion.sliding_velocity[len(t) // 2 :].T
        ],
    }
    low, high, at = _hull(t, x)
    late = len(t) // 2
    last = slice(max(len(t) - SHOWN, 0), None)
    arrays: dict[str, Any] = {
        "lastTime": (t[last] - t[last][0]) / second,
        "lastQ": motion.q[last],
        "lastX": x[last] / metre,
        "lastV": v[last] / speed,
        "lastForce": motion.normal_force[last],
        "lastFriction": motion.friction_force[last],
        "lastState": motion.mode[last],
        "time": at / second,
        "low": low / metre,
        "high": high / metre,
        "x": x[late:] / metre,
        "v": v[late:] / speed,
    }
    try:
        lines = spectrum(motion, dof=dof, begin=float(t[late]))
        grid = spectrogram(motion, dof=dof)
    except SignalError as error:
        return Answer({**data, "noSpectrum": str(error)}, arrays)
    top = _upto(lines, float(judged.frequency))
    shown, seen = lines.frequency <= top, grid.frequency <= top
    found = peaks(lines, 4)
    data |= {
        "peaks": [[f, a / metre] for f, a in found if f <= top],
        "resolution": lines.resolution,
        "gridTime": [float(grid.time[0] / second), float(grid.time[-1] / second)],
        "gridTop": float(grid.frequency[seen][-1]),
        "end": float(t[-1] / second),
    }
    arrays |= {
        "hertz": lines.frequency[shown],
        "amplitude": lines.amplitude[shown] / metre,
        "grid": grid.amplitude[seen] / metre,
    }
    return Answer(data, arrays)


def _upto(lines: Any, main: float) -> float:
    """The highest frequency drawn: four times that of the strongest line, so that harmonics are seen."""
    strongest = float(lines.frequency[np.argmax(lines.amplitude)])
    wanted = 4.0 * max(strongest, main if np.isfinite(main) else 0.0)
    return min(wanted, float(lines.frequency[-1])) if wanted > 0.0 else float(lines.frequency[-1])


def _hull(t: Any, x: Any) -> tuple[Any, Any, Any]:
    """Least and largest value in equal stretches, and their middle times: what a line too dense to draw looks like."""
    each = max(len(x) // DRAWN, 1)
    count = len(x) // each
    stretches = x[: count * each].reshape(count, each)
    return stretches.min(axis=1), stretches.max(axis=1), t[: count * each].reshape(count, each).mean(axis=1)

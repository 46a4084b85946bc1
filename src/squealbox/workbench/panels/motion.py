"""What happens in time: one transient, its spectrum, phase plane and spectrogram, and the verdict on it in words."""

from typing import Any

import numpy as np

from squealbox.design import Design
from squealbox.figure_data import FigureAxis, FigureData, across, heat, hull, line, span, text
from squealbox.signals import SignalError, peaks, spectrogram, spectrum
from squealbox.transient import Trajectory, Verdict, usual_duration, verdict
from squealbox.words import number as digits
from squealbox.words import scaled, unit_at
from squealbox.workbench.frames import finite
from squealbox.workbench.panels.declared import FREEDOM, START, Panel, Place, number, words
from squealbox.workbench.panels.following import followed, moving
from squealbox.workbench.panels.loudness import loudest, loudness
from squealbox.workbench.panels.panel import Answer, Options, Work
from squealbox.workbench.panels.start import start_and_dof

PANEL = Panel(
    "Motion", questions=("happens",), columns=2, slow=True, layout="two",
    choices=(*START, FREEDOM, number("", "duration", high=1e6, of="transient.MotionSettings"),
             words("", "contact", ("exact", ""), ("smooth", ""), of="transient.MotionSettings")),
    figures=(Place("time", "Displacement", 190), Place("spectrum", "Spectrum of the second half", 190),
             Place("phase", "Phase plane of the second half"), Place("spectrogram", "Spectrogram")),
)  # fmt: skip

SAMPLES = 4096  # instants kept: 40 a period over a hundred periods
DRAWN = 1024  # pairs of least and largest value along the time axis
SHOWN = 241  # instants at the end in which the brake is seen to move: six periods of a hundred
LAST = 0.25  # share of the motion that the verdict and the estimate of the sound level are about
PERIODS = 100  # followed when nothing is given


def answer(design: Design, options: Options, work: Work) -> Answer:
    """The motion of one degree of freedom over time, and what a signal analysis says of it."""
    system = moving(design)
    start, dof = start_and_dof(design, options)
    how = options.chosen(*PANEL.choices)
    duration = how["duration"] or usual_duration(design, periods=PERIODS)
    motion = followed(system, duration, work, 0.6, start=start, times=SAMPLES, contact=how["contact"])
    work.progress(0.6, "spectrum")
    data = {
        "names": list(system.names),
        "dof": dof,
        "duration": duration,
        "outcome": str(motion.outcome),
        "steps": motion.steps,
    }
    said = [motion.caution, "" if motion.outcome.ok else f"{motion.outcome.message}."]
    if motion.t.size < 64:
        return Answer({**data, "words": " ".join(filter(None, said))})
    judged = verdict(motion, dof=dof)
    data |= {"words": " ".join(filter(None, [judged.text, *said])), "verdict": judged.text, "fate": judged.fate}
    data["marks"] = {"fate": judged.fate}
    return _signals(motion, dof, judged, data)


def _signals(motion: Trajectory, dof: int, judged: Verdict, data: dict[str, Any]) -> Answer:
    x, v, t = motion.q[:, dof], motion.qd[:, dof], motion.t
    name = motion.system.names[dof]
    metre, size = scaled(unit_at(motion.system, dof), x)
    second, clock = scaled("s", t)
    speed, rate = scaled(unit_at(motion.system, dof, moves=True), v)
    late, last = len(t) // 2, slice(max(len(t) - SHOWN, 0), None)
    data |= {
        "unit": size, "clock": clock, "lastFrom": float(t[last][0] / second),
        "amplitude": finite(judged.amplitude), "frequency": finite(judged.frequency),
        "loud": loudness(motion, loudest(motion), begin=float(t[-1] - LAST * (t[-1] - t[0]))),
        "speeds": [[finite(np.min(each)), finite(np.max(each))] for each in motion.sliding_velocity[late:].T],
    }  # fmt: skip
    arrays: dict[str, Any] = {
        "lastTime": (t[last] - t[last][0]) / second, "lastQ": motion.q[last],
        "lastX": x[last] / metre, "lastV": v[last] / speed,
        "lastForce": motion.normal_force[last], "lastState": motion.mode[last],
    }  # fmt: skip
    low, high, at = (each / unit for each, unit in zip(_hull(t, x), (metre, metre, second), strict=True))
    end, orbit = float(t[-1] / second), (x[late:] / metre, v[late:] / speed)
    moves = FigureAxis(name, size, span(low, high))
    figures = [
        FigureData("time", FigureAxis("time", clock, (0.0, end)), moves, [hull(at, low, high)]),
        FigureData("phase", FigureAxis(name, size, span(orbit[0])), FigureAxis(f"d{name}/dt", rate, span(orbit[1])),
               [line(*orbit, "s1 thin")]),
    ]  # fmt: skip
    try:
        lines, grid = spectrum(motion, dof=dof, begin=float(t[late])), spectrogram(motion, dof=dof)
    except SignalError as error:
        return Answer({**data, "noSpectrum": str(error)}, arrays, figures)
    top = _upto(lines, float(judged.frequency))
    shown, seen = lines.frequency <= top, grid.frequency <= top
    found = [(f, a / metre) for f, a in peaks(lines, 4) if f <= top]
    data["marks"] |= {"frequency": found[0][0] if found else ""}
    factor, hertz = scaled("Hz", top)
    f, sizes = lines.frequency[shown] / factor, lines.amplitude[shown] / metre
    over = FigureAxis("frequency", hertz, (0.0, float(f[-1])), factor=factor, quantity="frequency")
    upward = FigureAxis("amplitude", size, (0.0, 1.18 * float(np.max(sizes)) or 1.0))
    named = [text(at / factor, a, digits(at / factor)) for at, a in found[:3]]
    figures.append(FigureData("spectrum", over, upward, [line(f, sizes), across(0.0), *named]))
    stretch = (float(grid.time[0] / second), float(grid.time[-1] / second))
    upward = FigureAxis(
        "frequency", hertz, (0.0, float(grid.frequency[seen][-1] / factor)), factor=factor, quantity="frequency"
    )
    picture = heat(grid.amplitude[seen] / metre, "decades", "amplitude", size, smooth=True)
    figures.append(FigureData("spectrogram", FigureAxis("time", clock, stretch), upward, [], heat=picture))
    return Answer(data, arrays, figures)


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

"""`squealbox simulate`: what happens in time."""

import dataclasses
from pathlib import Path
from typing import TYPE_CHECKING

from squealbox.cli.answers import keep, written
from squealbox.cli.inputs import NOTHING_SAID, Said, folder, in_motion, read
from squealbox.cli.options import AS_WRITTEN, Asked
from squealbox.cli.running import ComputationFailed
from squealbox.parameters import with_cautions
from squealbox.transient import MotionSettings
from squealbox.waiting import Progress
from squealbox.writing import write

ABOUT = {"simulate": "what happens in time: a transient with verdict, figures and data"}

if TYPE_CHECKING:
    from squealbox.transient import Trajectory, Verdict

SAMPLES_A_PERIOD = 4.0  # fewer points do not hold the motion
MOST_FIGURES = 4  # degrees of freedom that are drawn: those that move most


def simulate(
    file: Path,
    *,
    out: Path | None = None,
    how: Said[MotionSettings] = NOTHING_SAID,
    asked: Asked = AS_WRITTEN,
) -> None:
    """Follow the motion in time and say what becomes of it; with --out, write figures, data and sound.

    Parameters
    ----------
    file
        design file; its section [simulate] says how, unless the options do
    out
        folder for the verdict, figures (PNG and SVG), motion.csv, motion.nc, and motion.wav where it can be heard
    """
    found = read(file, asked)
    given = found.simulate or MotionSettings()
    if "start" in how.given:
        given = given.replace(start="rest", mode=None, amplitude=None)
    settings = how.over(given)
    found = in_motion(dataclasses.replace(found, simulate=settings), contact=settings.contact)
    settings = (found.simulate or settings).lasting(found.design)
    system = found.design.system()
    settings.start_of(system)  # what cannot be started is said before a folder is made
    folder(out, "verdict", "motion", "energy")
    with Progress("simulating (the first run compiles the engine)"):
        motion = settings.run(system)
    with Progress("judging"):
        text, judged = _judged(motion)
    paths: list[Path] = []
    if out is not None:
        with Progress("drawing"):
            paths = _files(motion, text, judged, file.name, out)
    print("\n".join([f"{found.design.title}, {file}", text, *([written(*paths)] if paths else [])]))
    if not motion.outcome.ok:
        raise ComputationFailed(motion.outcome)


def _judged(motion: "Trajectory") -> tuple[str, list["Verdict"]]:
    """The verdict on each degree of freedom, in words and as results; none of a motion too short for one."""
    from squealbox.signals import SignalError
    from squealbox.transient import resolved, verdict

    if len(motion.t) < 2:
        return "nothing was reached that could be judged or drawn", []
    try:
        judged = [verdict(motion, dof=i) for i in range(motion.system.size)]
        whole = resolved(motion) is motion
    except SignalError as error:
        return f"the motion is too short to be judged or drawn: {error}", []
    keep(motion, *judged)
    lines = [f"{name}: {each}" for name, each in zip(motion.system.names, judged, strict=True)]
    if not whole:
        lines.append(
            f"Note: {len(motion.t)} kept instants do not carry these frequencies (give more points for data and "
            "sound); the verdict and the figures come from every step of the run"
        )
    return with_cautions(lines, *motion.caution.split("; ")), judged


def _files(motion: "Trajectory", text: str, judged: list["Verdict"], title: str, out: Path) -> list[Path]:
    """The files written: data, and of what could be judged its verdict, figures of what moves most, and sound."""
    data = write(motion, out, "motion", figure=False)
    if not judged:
        return data
    from squealbox import plots
    from squealbox.transient import resolved

    said, drawn = out / "verdict.txt", resolved(motion)
    said.write_text(f"{text}\n", encoding="utf-8")
    turns = [unit == "rad" for unit in motion.system.units]
    ranked = sorted(range(len(judged)), key=lambda i: (turns[i], -float(judged[i].amplitude)))[:MOST_FIGURES]
    pictures: list[Path] = []
    for i in sorted(ranked):
        name = motion.system.names[i]
        pictures += plots.save(plots.plot(drawn, dof=i, title=f"{title}: {name}"), out / f"motion_{name}")
    pictures += plots.save(plots.energy(motion, title=title), out / "energy")
    sounds = _sound(motion, ranked[0], float(judged[ranked[0]].frequency), out)
    return [said, *data, *pictures, *sounds]


def _sound(motion: "Trajectory", dof: int, pitch: float, out: Path) -> list[Path]:
    """The motion that is largest as a WAV file, where people can hear it and its points are close enough in time."""
    from squealbox.signals import AUDIBLE, equal_steps, sound

    heard = AUDIBLE[0] <= pitch <= AUDIBLE[1] and equal_steps(motion.t)
    heard = heard and SAMPLES_A_PERIOD * pitch * (motion.t[-1] - motion.t[0]) <= len(motion.t)
    return [sound(motion, out / "motion.wav", dof=dof)] if heard else []

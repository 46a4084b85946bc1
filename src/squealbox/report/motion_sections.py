"""The sections of a page about motion: the transient, what it sounds like, and the limit cycle."""

from collections.abc import Iterator
from typing import Any

import numpy as np

from squealbox import plots
from squealbox.matrices import liveliest
from squealbox.plots import motion_and_spectrum
from squealbox.report import words
from squealbox.report.blocks import Chart, Points, Sound, Text
from squealbox.report.examination import Examination
from squealbox.report.pictures import picture, wav, why_not
from squealbox.signals import spectrum

MOST_DRAWN = 3  # degrees of freedom in the chart of the motion


def transient(found: Examination) -> Iterator[Any]:
    """The transient with its spectrum and verdicts, where its energy went, and its sound."""
    motion = found.motion
    if motion is not None and found.verdicts:
        unit = found.system.units[found.liveliest]
        alike = [i for i, each in enumerate(found.system.units) if each == unit]  # rotations have a scale of their own
        order = sorted(alike, key=lambda i: -float(np.nan_to_num(found.verdicts[i].amplitude)))
        kept = sorted(order[:MOST_DRAWN])
        names = [found.system.names[i] for i in kept]
        spectra = {}
        for i, name in zip(kept, names, strict=True):
            lines = spectrum(motion, dof=i, begin=float(motion.t[-1] - 0.5 * (motion.t[-1] - motion.t[0])))
            spectra[name] = (lines.frequency, lines.amplitude)
        pitch = float(np.nan_to_num(found.verdicts[found.liveliest].frequency)) or 1.0
        moving = motion_and_spectrum(
            motion.t, dict(zip(names, motion.q[:, kept].T, strict=True)), spectra, 4.5 * pitch, unit
        )
        figure = plots.motion_overview(motion, dof=found.liveliest)
        caption = (
            f"Displacement, phase plane and spectrum of {found.system.names[found.liveliest]} (on screen: time and the "
            "spectrum of the second half, to be zoomed into)."
        )
        yield Chart(picture(figure, caption), moving)
        yield Points(tuple(
            f"{name}: {one.text}" for name, one in zip(found.system.names, found.verdicts, strict=True)
        ))  # fmt: skip
        closed = motion.energy.relative_residual
        yield picture(
            plots.energy(motion), f"Where the energy went. The audit closes to {closed:.1e} of its largest term."
        )
        yield from _heard(found)
    elif motion is not None:
        yield Text(motion.outcome.told)
    yield from why_not(found, "transient", "sound")


def _heard(found: Examination) -> Iterator[Any]:
    if found.heard is None or found.loudness is None:
        return
    name = found.system.names[found.liveliest]
    length = words.quantity(found.heard.t[-1] - found.heard.t[0], "s")
    yield Sound(
        wav(found.heard, found.liveliest),
        f"The motion of {name} as sound, {length} at its true frequency, as loud as the file allows.",
    )
    if found.loudness.outcome.ok:
        yield picture(plots.plot(found.loudness), f"Estimated level by line. {found.loudness.assumption}")


def limit_cycle(found: Examination) -> Iterator[Any]:
    """The limit cycle, how it is born, and whether it exists beside stable sliding."""
    cycle = found.cycle
    if cycle is not None and cycle.outcome.ok:
        dof = liveliest(cycle.amplitude, found.system.units)
        caption = f"One period of {found.system.names[dof]}, its orbit, and the multipliers of a disturbance."
        yield picture(plots.cycle_overview(cycle, dof=dof), caption)
    yield Points(tuple(words.cycle(found)))
    yield from why_not(found, "cycle", "hopf")

"""The page of one design: verdict first, then what it rests on."""

import inspect
from collections.abc import Iterator
from typing import Any

import numpy as np

from squealbox import plots
from squealbox.fe import ReducedBrake
from squealbox.files import NotWritable, design_text
from squealbox.plots import has_drawing
from squealbox.report import motion_sections, stability_sections, tables, words
from squealbox.report.blocks import Code, Page, Points, Section, Text, Tiles
from squealbox.report.examination import Examination
from squealbox.report.pictures import picture
from squealbox.report.vibrating import pressed
from squealbox.result import provenance
from squealbox.system import equilibrium


def design_page(found: Examination, *, title: str = "", command: str = "", notes: tuple[str, ...] = ()) -> Page:
    """The page of an examination; `title` and `command` say which file it came from and how to make it again.

    `notes` belong to the caveats.
    """
    design = found.shown
    parts = [
        Section("Verdict", (_tiles(found), Points(tuple(words.verdict(found))))),
        Section("Caveats", (Points((*words.caveats(found), *notes)),)),
        Section("The brake", tuple(_brake(found))),
        Section("Stability", tuple(stability_sections.stability(found))),
        Section("Two parameters", tuple(stability_sections.map_of_two(found))),
        Section("Motion in time", tuple(motion_sections.transient(found))),
        Section("Limit cycle", tuple(motion_sections.limit_cycle(found))),
        Section("What silences it", tuple(stability_sections.cures(found))),
        Section("How it was computed", tuple(_provenance(found, command))),
    ]
    versions = ", ".join(f"{name} {version}" for name, version in provenance().items())
    lead = words.short_verdict(found) + (f" Design after: {design.source}." if design.source else "")
    return Page(title or design.title, lead, tuple(part for part in parts if part.blocks), f"Made by {versions}.")


def _tiles(found: Examination) -> Tiles:
    state = "stable" if found.stable else "unstable"
    tiles = [("stable" if found.stable else "unstable" if found.modes.exists else "none", "steady sliding", state)]
    if found.modes.exists and found.modes.most_unstable.frequency > 0.0:
        tiles.append((words.quantity(found.modes.most_unstable.frequency, "Hz"), "worst mode", ""))
    if found.critical is not None and found.varied is not None:
        name = found.varied.name
        tiles.append((words.value_in_words(found, name, float(found.critical.value), 4), f"critical {name}", ""))
    if found.verdicts:
        one = found.verdicts[found.liveliest]
        moves = f"half peak to peak of {found.system.names[found.liveliest]}, {one.kind.replace('_', ' ')}"
        tiles.append((words.quantity(one.amplitude, found.system.units[found.liveliest], 3), moves, ""))
    if found.cycle is not None and found.cycle.outcome.ok:
        beside = ", beside stable sliding" if found.coexists else ""
        tiles.append(
            (words.quantity(found.cycle.frequency, "Hz"), f"limit cycle{beside}", "unstable" if beside else "")
        )
    cycled = found.cycle_loudness is not None and found.cycle_loudness.outcome.ok
    for loud, known, of in ((found.cycle_loudness, cycled, " of the limit cycle"),
                            (found.loudness, not cycled and not found.dies_away, "")):  # fmt: skip
        if known and loud is not None and loud.outcome.ok:
            tiles.append((f"{float(loud.weighted):.0f} dB(A)", f"estimated level{of} at 1 m", ""))
    return Tiles(tuple(tiles))


def _brake(found: Examination) -> Iterator[Any]:
    yield from _assumptions(found)
    if has_drawing(found.design):
        caption = "The brake, angles to scale. Blue is what slides, orange are loads."
        yield picture(plots.brake_drawing(found.design), caption, f"Drawing of {found.design.title}")
    yield tables.parameters(found)
    pressure = pressed(found) if isinstance(found.design, ReducedBrake) else None
    if pressure is not None:
        yield pressure
    yield tables.contacts(found.system, found.time)
    law = getattr(found.design, "friction", None)
    state = equilibrium(found.system, found.time)
    if law is not None and state.exists and len(found.system.contacts):
        speeds = np.abs(state.sliding_speed)
        swept = _operating(found)
        top = 1.25 * max(float(np.max(speeds)), swept[1])
        figure = plots.friction_curve(law, upto=top, operating=swept, speed=float(np.max(speeds)))
        grey = "" if found.motion is None else " Grey: the sliding speeds of the transient below."
        yield picture(figure, f"The friction law.{grey}")


def _operating(found: Examination) -> tuple[float, float]:
    """Sliding speeds [m/s] the transient went through."""
    if found.motion is None or np.size(found.motion.sliding_velocity) == 0:
        return 0.0, 0.0
    speeds = np.abs(found.motion.sliding_velocity)
    return float(np.min(speeds)), float(np.quantile(speeds, 0.999))


def _assumptions(found: Examination) -> Iterator[Any]:
    told = (inspect.getdoc(type(found.shown)) or "").split(">>>")[0]
    said = [" ".join(paragraph.replace("`", "").split()) for paragraph in told.split("\n\n") if paragraph.strip()]
    yield Section("What is assumed", (
        Text("Motion of a linear structure with frictional contacts, q in m and N positive in compression:"),
        Code("M q'' + C q' + K q = f(t) + sum_c  d_c mu_c(|v_c|) sgn(v_c) N_c\n"
             "N_c = N0_c(t) + n_c . q,    v_c = V_c(t) - t_c . q'"),
        Text("Stability is that of small motions about steady sliding; transients and limit cycles keep stick, slip "
             "and reversal exactly."),
        Points(tuple(said)),
    ))  # fmt: skip


def _provenance(found: Examination, command: str) -> Iterator[Any]:
    yield Section("How each computation ended", (tables.endings(found),), folded=True)
    try:
        text = design_text(found.shown)
    except NotWritable as error:
        yield Text(f"This design cannot be written to a file: {error}")
        text = ""
    if text:
        yield Section("The design as a file", (Code(text),), folded=True)
    again = command or "from squealbox.report import report\n\nreport(design, 'report.html')"
    yield Section("Make it again", (Code(again),))

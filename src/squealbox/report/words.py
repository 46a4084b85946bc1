"""What an examination says in sentences: the verdict, and the caveats that belong to it."""

from collections.abc import Iterator

import numpy as np

from squealbox.cautions import pulling
from squealbox.fe import ReducedBrake
from squealbox.report.examination import Examination
from squealbox.signals import SoundLevel
from squealbox.stability import LINEAR, MERGE, growth_in_words, headline, margin_in_words, plain_words
from squealbox.system import equilibrium
from squealbox.words import level_told, number, quantity, read_in, sizes_told


def in_reading_unit(found: Examination, name: str) -> tuple[float, str]:
    """What SI values of a parameter are multiplied by to be read, and the unit then: degrees, kN/mm."""
    unit, factor = read_in(found.design.scalar(name), found.design.usual(name))
    return 1.0 / factor, unit


def value_in_words(found: Examination, name: str, value: float, digits: int = 5) -> str:
    """A value of a parameter with its unit."""
    factor, unit = in_reading_unit(found, name)
    return f"{number(factor * float(value), digits)} {unit}".rstrip()


def verdict(found: Examination) -> list[str]:
    """The answer in a few sentences: stable or not and why, the margin, what the motion does, how loud."""
    return [*_stability(found), *_margin(found), *_motion(found), *cycle(found), *_loudness(found)]


def short_verdict(found: Examination) -> str:
    """One sentence for the head of a page."""
    said = headline(found.modes, found.why)
    return f"{said}{', and yet a vibration can persist beside it' if found.coexists else ''}."


def _stability(found: Examination) -> Iterator[str]:
    yield short_verdict(found)
    yield growth_in_words(found.modes, found.why)


def _margin(found: Examination) -> Iterator[str]:
    if found.varied is None or found.crossings is None:
        return
    name, ends = found.varied.name, (float(found.varied.low), float(found.varied.high))
    said = margin_in_words(name, found.present, found.crossings, ends, lambda value: value_in_words(found, name, value))
    yield plain_words(said)


BEGINS = {
    "rest": "rest, with the loads applied suddenly", "sliding": "steady sliding",
    "mode": "steady sliding with a vibration in a mode",
}  # fmt: skip


def _motion(found: Examination) -> Iterator[str]:
    if not found.verdicts or found.settings is None:
        return
    one = found.verdicts[found.liveliest]
    begins = BEGINS[found.settings.start]
    name, length = found.system.names[found.liveliest], quantity(found.settings.duration, "s")
    yield f"From {begins}, followed for {length}, {name}: {one.text}"


def cycle(found: Examination) -> list[str]:
    """The limit cycle in words: which one, reached from where, and whether stable sliding exists beside it."""
    return [*_cycle(found), *_birth(found)]


def _birth(found: Examination) -> Iterator[str]:
    hopf = found.hopf
    if hopf is None or not hopf.outcome.ok:
        return
    where = f"{hopf.parameter} = {value_in_words(found, hopf.parameter, float(hopf.value))}"
    if hopf.kind == "subcritical":
        yield f"The cycle born at {where} is unstable: vibration can persist on the stable side of that value already."
    elif hopf.kind == "supercritical":
        next_ = abs(hopf.first_rest - float(hopf.value))
        far = f", for the next {number(next_, 2)} of {hopf.parameter}; beyond, sticking decides what is met"
        said = "while its contacts keep sliding" + far * bool(np.isfinite(next_))
        yield f"The cycle born at {where} is stable and grows from nothing there, {said}."


def _cycle(found: Examination) -> Iterator[str]:
    cycle = found.cycle
    if cycle is None:
        return
    if not cycle.outcome.ok:
        why = f"{_listed(found.tried)} ({cycle.outcome.message})"
        yield f"No limit cycle was found from {why}; that does not prove there is none."
        return
    kind = cycle.stability
    sizes = sizes_told(found.system.names, cycle.amplitude, found.system.units, 4)
    pitch = quantity(cycle.frequency, "Hz", 5)
    yield f"There is a {kind} limit cycle of {pitch}, half peak to peak {sizes}, reached from {found.tried[-1]}."
    if found.coexists:
        yield (
            "It exists beside stable sliding: eigenvalues call this brake quiet, yet a push large enough starts a "
            "vibration that persists."
        )


def _loudness(found: Examination) -> Iterator[str]:
    loud, cycled = found.loudness, found.cycle_loudness
    if found.dies_away:
        yield "The transient dies away: in the end nothing of it is left to hear."
    elif loud is not None and loud.outcome.ok:
        yield f"Were the last quarter of the transient to go on, it would be {_level(loud)}. {loud.assumption}"
    if cycled is not None and cycled.outcome.ok:
        yield f"The limit cycle would be {_level(cycled)}. {cycled.assumption}"


def _level(loud: SoundLevel) -> str:
    return f"about {level_told(loud.level, loud.weighted)}"


def caveats(found: Examination) -> list[str]:
    """What a reader must know before leaning on the numbers."""
    size = found.design.reduction.size if isinstance(found.design, ReducedBrake) else found.system.size
    said = [
        f"The model has {size} degrees of freedom and {len(found.system.contacts)} contacts: modes of the "
        "real parts that are not in it, temperature, wear and the scatter of friction are not in the result either.",
        LINEAR,
    ]
    if found.cycle is not None:
        said.append(
            f"Limit cycles were looked for from {_listed(found.tried)}. Others may exist that none of these reaches."
        )
    if found.ranking is not None and found.ranking.near_defective:
        said.append(MERGE)
    if found.loudness is not None:
        said.append(
            "The sound level is an estimate; differences between two designs can be trusted more than the level itself."
        )
    state, system = equilibrium(found.system, found.time), found.system
    if state.exists:
        unilateral = [contact.unilateral for contact in system.contacts]
        said += [f"In steady sliding {each}." for each in pulling(system.contact_names, unilateral, state.normal_force)]
    said += [f"Note of the {name}: {text}" for name, text in _cautions(found)]
    return said


def _cautions(found: Examination) -> Iterator[tuple[str, str]]:
    for name, part in (("transient", found.motion), ("limit cycle", found.cycle)):
        if part is not None and part.caution:
            yield name, part.caution


def _listed(names: tuple[str, ...]) -> str:
    return " and ".join((", ".join(names[:-1]), names[-1])) if len(names) > 1 else "".join(names)

"""`squealbox list`: what there is, and what each thing is made of."""

from collections.abc import Iterator, Mapping

import numpy as np

from squealbox.cli.running import UsageError
from squealbox.parameters import DataSheet, Parameter, known_names

ABOUT = {"list_": "designs with their parameters, friction laws, schedules, methods, papers"}

READ_TITLES = {  # brakes that files beside the design describe
    "assembled": "A finite-element brake from matrices of a code, with labels (docs/finite_elements.md)",
    "reduced": "A reduced brake, as squealbox reduce writes it",
}
NAMED = {
    "on": "degree of freedom", "to": "the other degree of freedom; left out, the frame",
    "against": "the other degree of freedom", "at": "contact", "along": "contacts that are shaken; left out, all",
    "sense": "degree of freedom that is measured; left out, the one it acts on",
}  # fmt: skip


def list_(name: str | None = None) -> None:
    """Print what there is: designs, friction laws, schedules, methods, countermeasures, loops and papers.

    Parameters
    ----------
    name
        a design, law, schedule, countermeasure or loop, to see its parameters with unit, default, range and meaning
    """
    print("\n".join(_overview() if name is None else _sheet(name)))


def _overview() -> Iterator[str]:
    from squealbox.files import BRAKES
    from squealbox.schedules import SCHEDULE_NAMES
    from squealbox.transient import TABLEAUX, TAYLOR

    yield from _section("designs (brake = ...)", {name: sheet.title for name, sheet in BRAKES.items()} | READ_TITLES)
    yield from _section("friction laws (law = ...)", {name: _first_line(sheet) for name, sheet in _laws().items()})
    yield from _section(
        "schedules, in place of a number", {n: _first_line(sheet) for n, sheet in SCHEDULE_NAMES.items()}
    )
    methods = {name: make().title for name, make in TABLEAUX.items()}
    usual = {"usual": f"{TAYLOR} where the equation has a series, else dormand-prince-8"}
    methods = usual | methods | {TAYLOR: "the motion's own series, for all but plain sgn"}
    yield from _section("methods (method = ...)", methods)
    schemes = {
        "exact": "stick, slip and lift-off by events", "raw": "plain sgn(v)",
        "smooth, tanh": "sgn(v) smoothed over `width`",
        "time-stepping": "fixed steps, for many contacts and for sliding in a plane",
    }  # fmt: skip
    yield from _section("contact (contact = ...)", schemes)
    for word, sheets in _around().items():
        yield from _section(f"{word} ([[{word}]], kind = ...)", {n: _first_line(sheet) for n, sheet in sheets.items()})
    yield from _section("papers (squealbox paper ...)", _papers())
    yield "squealbox list NAME shows the parameters of any of them but methods and papers"


def _around() -> dict[str, dict[str, type[DataSheet]]]:
    """What a file puts around a brake, by the section that holds it."""
    from squealbox.countermeasures import COUNTERMEASURES
    from squealbox.loops import LOOPS

    return {"countermeasures": {**COUNTERMEASURES}, "loops": {**LOOPS}}


def _laws() -> dict[str, type[DataSheet]]:
    """The friction laws a file knows, with the one that is a Python file."""
    from squealbox.friction import LAW_NAMES, OwnLaw

    return {**LAW_NAMES, "own": OwnLaw}


def _papers() -> dict[str, str]:
    from squealbox.cli.papers import PAPERS

    return {name: paper.title for name, paper in PAPERS.items()}


def _section(title: str, rows: dict[str, str]) -> Iterator[str]:
    width = max((len(name) for name in rows), default=0)
    yield f"{title}:"
    for name, about in rows.items():
        yield f"  {name.ljust(width)}  {about}".rstrip()
    yield ""


def _sheet(name: str) -> Iterator[str]:
    from squealbox.files import BRAKES
    from squealbox.friction import LAW_NAMES
    from squealbox.schedules import SCHEDULE_NAMES

    kinds: tuple[Mapping[str, type[DataSheet]], ...] = (BRAKES, LAW_NAMES, SCHEDULE_NAMES, *_around().values())
    known = [each for sheets in kinds for each in sheets]
    if name in READ_TITLES:
        yield f"{name}: {READ_TITLES[name]}"
        return
    if name not in known:
        raise UsageError(f"{name[:40]!r} is not listed: {known_names(name[:40], known)}")
    both = [sheets[name] for sheets in kinds if name in sheets]
    for sheet in both:
        yield from _parameters(name, sheet)


def _parameters(name: str, sheet: type[DataSheet]) -> Iterator[str]:
    title = getattr(sheet, "title", "") or _first_line(sheet)
    source = getattr(sheet, "source", "")
    yield f"{name}: {title}" + (f" [{source}]" if source else "")
    rows = [("parameter", "default", "range", "meaning")]
    if name in {each for sheets in _around().values() for each in sheets}:
        rows += [(f, _default(sheet, f) or "none", "a name", NAMED[f]) for f in sheet.field_names() if f in NAMED]
    rows += [
        (field, _default(sheet, field), about.range, _meaning(about)) for field, about in sheet.parameters().items()
    ]
    widths = [max(len(row[i]) for row in rows) for i in range(3)]
    for row in rows:
        yield "  " + "  ".join([*(cell.ljust(width) for cell, width in zip(row[:3], widths, strict=True)), row[3]])
    for field, words in sheet.choices().items():
        yield f"  {field} = {' | '.join(words.options)}: {words.meaning}"
    for alias, fields in sheet.aliases.items():
        yield f"  {alias} sets {' and '.join(fields)} together"
    yield ""


def _default(sheet: type[DataSheet], field: str) -> str:
    value = getattr(sheet, field, "required")
    if value is None:
        return "none"
    return f"{value:g}" if isinstance(value, (int, float, np.number)) else str(value)


def _meaning(about: Parameter) -> str:
    notes = [about.meaning, "may be a schedule" if about.schedule else "", about.source]
    return "; ".join(note for note in notes if note)


def _first_line(sheet: type[DataSheet]) -> str:
    return (sheet.__doc__ or "").strip().partition("\n")[0]

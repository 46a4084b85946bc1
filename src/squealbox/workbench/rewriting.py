"""A design file that was opened, written again: only what was changed is replaced, comments and other sections stay."""

import contextlib
import tomllib
from collections.abc import Callable, Iterator, Mapping
from typing import Any

import tomlkit
from tomlkit.exceptions import TOMLKitError
from tomlkit.items import AoT, Array, InlineTable, Table

from squealbox.design import Design
from squealbox.family import ParameterAxis
from squealbox.files import SECTIONS, STUDY, VARY, DesignFile, DesignFileError, design_text, read_text
from squealbox.units import UnitError, in_si, split, unit
from squealbox.workbench.panels import Options

STARTS = ("rest", "sliding")  # of a motion, as a file has them; a push is the page's own
LOST = "Written anew, without the comments of the opened file: they could not be kept with these changes."


def settings_of(found: DesignFile) -> dict[str, dict[str, Any]]:
    """What the sections of a file say to the page: options by panel, and the ends [SI] of the axes they name."""
    made: dict[str, dict[str, Any]] = {}
    for panel, option, axis in _axes(found):
        made.setdefault(panel, {})[option] = axis.name
        made.setdefault("page", {"ranges": {}})["ranges"].setdefault(axis.name, [axis.low, axis.high])
    if found.simulate is not None:
        made["motion"] = {"start": "push" if found.simulate.start == "mode" else found.simulate.start}
    return made


def rewritten(
    text: str, before: Design, after: Design, settings: Mapping[str, Any], read: Callable[[str], DesignFile] = read_text
) -> tuple[str, str]:
    """The text of a file with what makes `before` to `after`, and with the page's settings in the sections it has.

    `read` reads a text as the file was read. The second of what comes back says what could not be kept, or nothing.
    Raises `NotWritable` for a design that no file can hold.
    """
    new = design_text(after)
    try:
        found = tomlkit.parse(text)
        _put(found, tomllib.loads(design_text(before)), tomllib.loads(new), after)
        _ask(found, read(text), after, settings)
        whole = tomlkit.dumps(found)
        if design_text(read(whole).design) == new:
            return whole, ""
    except (TOMLKitError, DesignFileError):  # a way to write TOML that is not known here: the values come first
        found = tomlkit.parse(text)
    return with_sections(new, found), LOST


def with_sections(text: str, asked: Mapping[str, Any]) -> str:
    """The text of a design followed by what is asked of it: the sections of another file, as tomlkit has read it."""
    whole = tomlkit.parse(text)
    for name, section in asked.items():
        if name in (*SECTIONS, STUDY):
            whole[name] = section
    return tomlkit.dumps(whole)


def _put(found: Any, before: Mapping[str, Any], after: Mapping[str, Any], design: Design | None = None) -> None:
    """Change a table of the file where the design's own text has changed."""
    for name in before:
        if name not in after:
            found.pop(name, None)
    for name, new in after.items():
        old = before.get(name)
        if new == old:
            continue
        if design is not None and _alias(found, name, before, after, design):
            continue
        now: Any = found.get(name)
        if isinstance(old, dict) and isinstance(new, dict) and isinstance(now, (Table, InlineTable)):
            _put(now, old, new)
        elif isinstance(now, (AoT, Array)) and len(now) == len(_tables(old)) == len(_tables(new)):
            for each in zip(now, _tables(old), _tables(new), strict=True):
                _put(*each)
        else:
            found[name] = _like(now, new)


def _alias(found: Any, name: str, before: Mapping[str, Any], after: Mapping[str, Any], design: Design) -> bool:
    """True where the file says one value for several fields, as `load` for both shoes, and that one is changed.

    Where they are no longer equal, each is said by its own name.
    """
    for alias, names in design.innermost.aliases.items():
        if name not in names or alias not in found:
            continue
        if all(after[each] == after[name] for each in names):
            found[alias] = _like(found[alias], after[name])
            return True
        found.pop(alias)
        for each in names:
            found[each] = before[each]
    return False


def _tables(value: Any) -> list[dict[str, Any]]:
    """The tables of a list of such, none of any other value."""
    return value if isinstance(value, list) and all(isinstance(each, dict) for each in value) else []


def _like(now: Any, new: Any) -> Any:
    """A number in the unit the file has it in, where it then reads back to the same bits."""
    with contextlib.suppress(UnitError):
        if isinstance(new, str) and isinstance(now, (int, float)):
            return _si(new)
        if isinstance(new, str) and isinstance(now, str) and split(now)[1]:
            guess = f"{in_si(new, split(now)[1]):.15g} {split(now)[1]}"
            return guess if _si(guess) == _si(new) else new
    return new


def _si(text: str) -> float:
    number, name = split(text)
    return number * unit(name).factor


def _axes(found: DesignFile) -> Iterator[tuple[str, str, ParameterAxis]]:
    """(panel, its option, axis) of the sections that name one."""
    if found.map is not None:
        yield from (("map", "x", found.map.x), ("map", "y", found.map.y))
    for panel, axis in (("locus", found.onset), ("branch", found.branch)):
        if axis is not None:
            yield panel, "parameter", axis


def _told(axis: ParameterAxis) -> dict[str, Any]:
    return {"parameter": axis.name, "range": [axis.low, axis.high], "points": int(axis.points)}


def _ask(found: Any, said: DesignFile, design: Design, settings: Mapping[str, Any]) -> None:
    """Put what was chosen on the page into the sections that ask for something else."""
    chosen = {name: each for name, each in settings.items() if isinstance(each, Mapping)}
    ranges, before = chosen.get("page", {}).get("ranges"), settings_of(said).get("page", {}).get("ranges", {})
    ranges = {name: ends for name, ends in ranges.items() if ends} if isinstance(ranges, Mapping) else {}
    for panel, option, axis in _axes(said):
        name, own = chosen.get(panel, {}).get(option, axis.name), [axis.low, axis.high]
        if not isinstance(name, str) or name not in design.scalars():
            continue
        ends = ranges.get(name, own if name == axis.name else list(Options({}).span("span", design, name)))
        section = found["onset" if panel == "locus" else panel]
        renamed, moved = name != axis.name, ends != own and ends != before.get(name, own)
        if VARY in section and (renamed or moved):  # each axis in words of its own, of which one is changed
            section.pop(VARY)
            told = {each: _told(one) for part, each, one in _axes(said) if part == panel}
            section.update(told if panel == "map" else told["parameter"])
        table = section[option] if panel == "map" else section
        if renamed:
            table["parameter"] = name
        if renamed or moved:
            table["range"] = ends
    start = chosen.get("motion", {}).get("start")
    if said.simulate is not None and start in STARTS and start != said.simulate.start:
        found["simulate"]["start"] = start

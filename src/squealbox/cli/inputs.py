"""What commands share: a design file with changes from the command line, ranges, and folders for what is written."""

import dataclasses
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

import cyclopts
import numpy as np

from squealbox.cli.answers import manner
from squealbox.cli.options import AS_WRITTEN, HowAsked
from squealbox.cli.running import UsageError
from squealbox.designs import Design
from squealbox.fe.reduced_brake import ReducedBrake
from squealbox.files import DesignFile, read_file
from squealbox.files.analyses import Varied
from squealbox.files.units import UnitError, in_si
from squealbox.files.varied import quantity_of, words_of
from squealbox.parameters import Parameter, ParameterError
from squealbox.transient.simulate import TIME_STEPPING
from squealbox.waiting import Progress

Vary = Annotated[tuple[str, ...], cyclopts.Parameter(negative="", consume_multiple=True, show_default=False)]
Ends = Annotated[tuple[str, str] | None, cyclopts.Parameter(negative="")]


def read(file: Path, asked: HowAsked = AS_WRITTEN) -> DesignFile:
    """The design file with ``--set friction.static=0.4`` and the like applied."""
    found = read_file(file, allow_code=asked.allow_code)
    if found.caution:
        print(f"Caution: {found.caution}", file=sys.stderr)
    return dataclasses.replace(found, design=changed(found.design, asked.changes))


def small(found: DesignFile, *axes: Varied) -> DesignFile:
    """The file with a finite-element brake reduced for `axes` and its sections, and what that promises printed."""
    from squealbox.files.reduced import dense, promise

    with Progress("reducing the finite-element brake"):
        made = dense(found, axes)
    if isinstance(made.design, ReducedBrake):
        print(promise(made.design))
    return made


def in_motion(found: DesignFile, *axes: Varied, contact: str = "exact") -> DesignFile:
    """As :func:`small`, for motions in time by a contact scheme.

    All but one leave out friction across the sliding direction, and that is said.
    """
    from squealbox.files.reduced import ONE_WAY

    made = small(found, *axes)
    if contact == TIME_STEPPING:
        return made
    if isinstance(made.design, ReducedBrake) and made.design.reduction.arrays["across"] is not None:
        print(ONE_WAY)
        return dataclasses.replace(made, design=made.design.sliding_one_way())
    return made


def changed(design: Design, changes: Sequence[str]) -> Design:
    """The design with ``--set friction.static=0.4`` and the like applied."""
    for change in changes:
        name, equals, text = change.partition("=")
        if not equals:
            raise UsageError(f"--set {change[:60]}: expected NAME=VALUE, such as friction.static=0.4")
        design = _changed(design, name.strip(), text.strip(), change)
    return design


@dataclasses.dataclass(frozen=True)
class Option:
    """How an axis is named on the command line: the word before its ends, and the whole of it."""

    word: str
    usage: str


RANGE = Option("--range", "--parameter NAME --range LOW HIGH")


VARY = Option("--vary", "--vary NAME=LOW:HIGH")


def spans(vary: Sequence[str], count: int) -> list[tuple[str, tuple[str, str]]]:
    """NAME and (LOW, HIGH) of each of ``--vary friction.static=0:1``, of which there must be `count`."""
    found = []
    for each in vary:
        name, _, text = each.partition("=")
        low, _, high = text.partition(":")
        if not (name.strip() and low.strip() and high.strip()):
            raise UsageError(f"--vary {each[:60]}: expected NAME=LOW:HIGH, such as friction.static=0:1")
        found.append((name.strip(), (low.strip(), high.strip())))
    if len(found) != count:
        raise UsageError(f"--vary {' '.join(vary)[:60]}: expected {count} parameter{'s' * (count > 1)}")
    return found


def varied_by(vary: Sequence[str], name: str | None, ends: tuple[str, str] | None) -> tuple[Any, Any, Option]:
    """What `axis` is asked for by ``--vary``, or by ``--parameter`` and ``--range``."""
    return (*spans(vary, 1)[0], VARY) if vary else (name, ends, RANGE)


def axis(
    design: Design, given: Varied | None, name: str | None, ends: tuple[str, str] | None, option: Option
) -> Varied:
    """The axis of the file, or the one the options name."""
    name = name if name is not None else given.name if given else None
    if name is None:
        raise UsageError(f"nothing says what is varied: give {option.usage}, or a section in the file")
    if ends is None:
        if given is None or given.name != name:
            raise UsageError(f"nothing says over which range: give {option.usage}")
        return given
    label = f"{option.word} {' '.join(ends)[:60]}"
    about = _quantity(design, name, f"{option.usage.partition(' ')[0]} {name[:60]}")
    low, high = (number(end, about.unit, label) for end in ends)
    if not about.accepts(np.array([low, high])):
        raise UsageError(f"{label}: expected finite numbers in {about.range}")
    if not low < high:
        raise UsageError(f"{label}: expected the lower value first")
    return Varied(name, low, high) if given is None else given.replace(name=name, low=low, high=high)


def with_points(given: Varied, points: int | None) -> Varied:
    """The axis with another number of values."""
    try:
        return given if points is None else given.replace(points=points)
    except ParameterError as error:
        raise UsageError(f"--points {points}: {error.expectation}") from error


def readable(design: Design, varied: Varied, values: Any) -> tuple[Any, str]:
    """Values of a parameter in the unit people read it in, and that unit: angles in degrees, the rest in SI."""
    unit = quantity_of(design, varied.name).unit
    if unit == "rad":
        return np.rad2deg(values), "deg"
    return values, "" if unit == "-" else unit


def time_of(option: str, text: str) -> float:
    """A time [s] from the command line."""
    return number(text, "s", f"{option} {text[:60]}")


def folder(path: Path, *stems: str) -> Path:
    """The folder, made when it is not there; files of these names in it are only overwritten with --force."""
    try:
        path.mkdir(parents=True, exist_ok=True)
    except FileExistsError as error:
        raise UsageError(
            f"--out {path}: a file of that name is there, expected a folder or a name for a new one"
        ) from error
    except OSError as error:
        raise UsageError(
            f"--out {path}: no folder can be made there ({error.strerror}), expected one to write in"
        ) from error
    free(*(each for stem in stems for part in (".*", "_*") for each in sorted(path.glob(f"{stem}{part}"))))
    return path


def free(*paths: Path) -> None:
    """Raise `UsageError` where a file is there already and --force was not given."""
    there = [path for path in paths if path.exists()]
    if there and not manner().force:
        more = f" and {len(there) - 1} more files are" if len(there) > 1 else " is"
        raise UsageError(f"{there[0]}{more} there already: --force overwrites, another --out leaves it")


def _changed(design: Design, name: str, text: str, change: str) -> Design:
    label = f"--set {change[:60]}"
    try:
        if name in words_of(design):
            return design.replace({name: text})
        about = _quantity(design, name, label)
        return design.replace({name: number(text, about.unit, label)})
    except ParameterError as error:
        raise UsageError(f"{label}: {error.expectation}") from error


def _quantity(design: Design, name: str, label: str) -> Parameter:
    try:
        return quantity_of(design, name)
    except ParameterError as error:
        raise UsageError(f"{label}: unknown parameter, {error.expectation}") from error


def number(text: str, unit: str, label: str) -> float:
    """A number with or without a unit, in SI; `label` is what an error calls it."""
    try:
        return in_si(text, unit)
    except UnitError as error:
        raise UsageError(f"{label}: {error}") from error

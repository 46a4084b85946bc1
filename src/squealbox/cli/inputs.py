"""What commands share: a design file with changes from the command line, ranges, and folders for what is written."""

import dataclasses
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any, Generic, TypeVar, get_origin

import cyclopts
import numpy as np

from squealbox.cli.answers import manner
from squealbox.cli.options import AS_WRITTEN, HowAsked
from squealbox.cli.running import UsageError
from squealbox.design import Design
from squealbox.family import ParameterAxis
from squealbox.fe import ReducedBrake
from squealbox.files import DesignFile, read_file
from squealbox.parameters import DataSheet, Parameter, ParameterError, field_type
from squealbox.result import ResultFileError
from squealbox.transient import TIME_STEPPING
from squealbox.units import UnitError, in_si
from squealbox.waiting import Progress
from squealbox.words import as_read
from squealbox.writing import made

Sheet = TypeVar("Sheet", bound=DataSheet)
Filed = TypeVar("Filed", bound=DataSheet)
Vary = Annotated[tuple[str, ...], cyclopts.Parameter(negative="", consume_multiple=True, show_default=False)]
Ends = Annotated[tuple[str, str] | None, cyclopts.Parameter(negative="")]


def read(file: Path, asked: HowAsked = AS_WRITTEN) -> DesignFile:
    """The design file with ``--set friction.static=0.4`` and the like applied."""
    found = read_file(file, allow_code=asked.allow_code)
    if found.caution:
        print(f"Caution: {found.caution}", file=sys.stderr)
    return dataclasses.replace(found, design=changed(found.design, asked.changes))


def small(found: DesignFile, *axes: ParameterAxis) -> DesignFile:
    """The file with a finite-element brake reduced for `axes` and its sections, and what that promises printed."""
    from squealbox.files import dense, promise

    with Progress("reducing the finite-element brake"):
        made = dense(found, axes)
    if isinstance(made.design, ReducedBrake):
        print(promise(made.design))
    return made


def in_motion(found: DesignFile, *axes: ParameterAxis, contact: str = "exact") -> DesignFile:
    """As :func:`small`, for motions in time by a contact scheme.

    All but one leave out friction across the sliding direction, and that is said.
    """
    from squealbox.files import ONE_WAY

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


RANGE, VARY = "--parameter NAME --range LOW HIGH", "--vary NAME=LOW:HIGH"  # how an axis is asked for


@dataclasses.dataclass(frozen=True)
class HowVaried:
    """What a command varies, where that is not as the section of its file says.

    Parameters
    ----------
    vary
        a parameter and its lowest and highest value: friction.static=0.1:0.6, or theta1=20deg:160deg
    parameter
        its dotted name, where --range stands beside it
    range
        lowest and highest value, with or without a unit: 0 1, or 20deg 160deg
    points
        number of values; of a branch, most cycles each way
    """

    vary: Vary = ()
    parameter: str | None = None
    range: Ends = None
    points: int | None = None

    def of(self, design: Design, given: ParameterAxis | None) -> ParameterAxis:
        """The axis of the file, or the one the options name."""
        name, ends = spans(self.vary, 1)[0] if self.vary else (self.parameter, self.range)
        return axis(design, given, name, ends, VARY if self.vary else RANGE, self.points)


OneVaried = Annotated[HowVaried, cyclopts.Parameter(name="*")]
AS_FILED = HowVaried()


class Said(Generic[Sheet]):
    """What the command line says of the options of a data sheet, None where nothing.

    ``how: Said[MotionSettings] = NOTHING_SAID`` makes an option of each number, word and switch that the sheet
    declares, with its meaning as help.
    """

    def __class_getitem__(cls, sheet: Any) -> Any:
        fields = [(name, kind, None) for name in sheet.field_names() if (kind := _option(sheet, name)) is not None]
        made = dataclasses.make_dataclass(f"Said{sheet.__name__}", fields, bases=(cls,), frozen=True)
        made.__module__ = __name__
        return Annotated[made, cyclopts.Parameter(name="*")]

    @property
    def given(self) -> dict[str, Any]:
        """The options that were given."""
        return {name: value for name, value in vars(self).items() if value is not None}

    def over(self, section: Filed) -> Filed:
        """What the file says, or the usual values, with what was given instead."""
        return put_over(section, self.given)


NOTHING_SAID: Any = Said()


def _option(sheet: type[DataSheet], name: str) -> Any:
    """The type of the option for a field, with its help; None for an array of any length, which stands in a file."""
    declared, about, words = field_type(sheet, name), sheet.parameters().get(name), sheet.choices().get(name)
    pair = about is not None and about.ends
    if get_origin(declared) is Annotated and not pair:
        return None
    several = get_origin(declared) is tuple
    kind = tuple[str, str] if pair else declared if several or declared in (bool, int) else str
    unit = f" [{about.unit}]" if about and about.unit not in ("", "-") else ""
    options = f": {', '.join(words.options)}" if words and len(words.options) < 6 else ""
    meaning = about.meaning if about else words.meaning if words else sheet.told[name][1]
    usual = getattr(sheet, name, None)
    word = " ".join(usual or ()) if several else f"{usual:g}" if about and usual is not None else usual
    told = f"{meaning}{unit}{options}{'' if word in (None, '') else f' [default: {word}]'}"
    no = None if usual is True else ""  # --no-name, where the switch is on
    how = cyclopts.Parameter(help=told, negative=no, show_default=False, consume_multiple=several)
    return Annotated[kind | None, how]


def put_over(section: Filed, said: Mapping[str, Any]) -> Filed:
    """A section with other values, of which numbers with units are texts."""
    abouts = section.parameters().items()
    units = {name: about.unit for name, about in abouts if isinstance(said.get(name), (str, tuple))}
    numbers = {name: _numbers(name, said[name], unit) for name, unit in units.items()}
    try:
        return section.replace(section.spelled({**said, **numbers}))
    except ParameterError as error:
        given = said.get(error.name, error.value)
        words = " ".join(given) if isinstance(given, tuple) else given
        raise UsageError(f"--{error.name.replace('_', '-')} {words}: {error.expectation}") from error


def _numbers(name: str, text: str | tuple[str, ...], unit: str) -> Any:
    """The number of an option, or the two of a pair."""
    if isinstance(text, tuple):
        return [_numbers(name, each, unit) for each in text]
    return number(text, unit, f"--{name} {text[:60]}")


def keywords(section: DataSheet) -> dict[str, Any]:
    """The options of a sheet as its function takes them, whole numbers as such."""
    values = {name: getattr(section, name) for name in section.field_names()}
    whole = {name for name, value in values.items() if field_type(type(section), name) is int and value is not None}
    return {name: int(value) if name in whole else value for name, value in values.items()}


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


def axis(
    design: Design, given: ParameterAxis | None, name: str | None, ends: tuple[str, str] | None, usage: str, points: Any
) -> ParameterAxis:
    """The axis of the file, or the one the options name, with so many points where they are given."""
    name = name if name is not None else given.name if given else None
    if name is None:
        raise UsageError(f"nothing says what is varied: give {usage}, or a section in the file")
    if ends is not None:
        words = [word for word in usage.split() if word.startswith("--")]
        label = f"{words[-1]} {' '.join(ends)[:60]}"
        about = _quantity(design, name, f"{words[0]} {name[:60]}")
        low, high = (number(end, about.unit, label) for end in ends)
        if not about.accepts(np.array([low, high])):
            raise UsageError(f"{label}: expected finite numbers in {about.range}")
        if not low < high:
            raise UsageError(f"{label}: expected the lower value first")
        given = ParameterAxis(name, low, high) if given is None else given.replace(name=name, low=low, high=high)
    elif given is None or given.name != name:
        raise UsageError(f"nothing says over which range: give {usage}")
    return put_over(given, {} if points is None else {"points": points})


def readable(design: Design, varied: ParameterAxis, values: Any) -> tuple[Any, str]:
    """Values of a parameter in the unit people read it in, and that unit: angles in degrees, the rest in SI."""
    return as_read(values, design.scalar(varied.name).unit)


def folder(path: Path | None, *stems: str) -> None:
    """Make the folder of --out, if any; files of these names in it are only overwritten with --force."""
    if path is None:
        return
    try:
        made(path)
    except ResultFileError as error:
        raise UsageError(f"--out {error}") from error
    free(*(each for stem in stems for part in (".*", "_*") for each in sorted(path.glob(f"{stem}{part}"))))


def free(*paths: Path) -> None:
    """Raise `UsageError` where a file is there already and --force was not given."""
    there = [path for path in paths if path.exists()]
    if there and not manner().force:
        more = f" and {len(there) - 1} more files are" if len(there) > 1 else " is"
        raise UsageError(f"{there[0]}{more} there already: --force overwrites, another --out leaves it")


def _changed(design: Design, name: str, text: str, change: str) -> Design:
    label = f"--set {change[:60]}"
    try:
        if name in design.words():
            return design.replace({name: text})
        about = _quantity(design, name, label)
        return design.replace({name: number(text, about.unit, label)})
    except ParameterError as error:
        raise UsageError(f"{label}: {error.expectation}") from error


def _quantity(design: Design, name: str, label: str) -> Parameter:
    try:
        return design.scalar(name)
    except ParameterError as error:
        raise UsageError(f"{label}: unknown parameter, {error.expectation}") from error


def number(text: str, unit: str, label: str) -> float:
    """A number with or without a unit, in SI; `label` is what an error calls it."""
    try:
        return in_si(text, unit)
    except UnitError as error:
        raise UsageError(f"{label}: {error}") from error

"""The section [reduce], which makes a finite-element brake small for all analyses; and `brake = "reduced"`.

[reduce]
band = ["500 Hz", "10 kHz"]                    left out, that of [modes]
varying = { "friction.static" = [0, 0.8] }     beside what [onset], [branch], [map] and [scatter] vary
tolerance = "0.05 1/s"

brake = "reduced"
file = "small.npz"                             what squealbox reduce wrote
friction = { law = "coulomb", static = 0.4 }   in place of the law it was reduced with
values = { angular_speed = 4 }                 of what it was reduced for
"""

import dataclasses
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from squealbox.design import Design
from squealbox.family import ParameterAxis
from squealbox.fe import MatrixFileError, ReducedBrake, load_reduced, with_surface
from squealbox.files.analyses import read_spans
from squealbox.files.arrays import ArrayFileError, path_beside
from squealbox.files.document import Document
from squealbox.files.lines import Key
from squealbox.files.numbers import WRONG, only, shown, wrong
from squealbox.files.sheets import read_law, read_sheet
from squealbox.files.varied import flattened
from squealbox.parameters import DataSheet, ParameterError, Vector, above_zero, choice, parameter
from squealbox.system import InvalidSystem
from squealbox.transient import MotionSettings

if TYPE_CHECKING:
    from squealbox.files.reading import DesignFile

REDUCED = "reduced"
KEYS = ("file", "friction", "values")
RARE = 1e-6  # share of a distribution without bounds that is left out at either end
ONE_WAY = (
    "Motions leave out friction across the sliding direction, which only damps; "
    'transients by contact = "time-stepping" keep it.'
)
MISSING = 'give [reduce] band = ["500 Hz", "10 kHz"] in the file, or the band of [modes]'


class Reduce(DataSheet):
    """[reduce]: a finite-element brake is made small once, for all that needs dense matrices."""

    band: Vector = above_zero(
        "Hz", default=None, ends=True, meaning="lowest and highest frequency; left out, that of [modes]"
    )
    method: str = choice("enriched", "craig-bampton", "pod", default="enriched", meaning="which basis")
    tolerance: float = parameter("1/s", 0.0, low_open=True, default=0.05, meaning="error wanted of an eigenvalue")


@dataclass(frozen=True)
class Reduced:
    """What a section [reduce] says."""

    how: Reduce
    varying: dict[str, tuple[float, float]]


def read_reduce(document: Document, table: Mapping[str, Any], key: Key, design: Design | None) -> Reduced | None:
    """The section [reduce]."""
    rest = {name: value for name, value in table.items() if name != "varying"}
    how = read_sheet(document, Reduce, rest, key, beside=("varying",))
    given = table.get("varying", {})
    if not isinstance(given, Mapping):
        wrong(document, (*key, "varying"), given, 'a table such as { "friction.static" = [0, 0.8] }')
        return None
    varying = read_spans(document, given, (*key, "varying"), design)
    return None if how is None else Reduced(how, varying)


def read_reduced(document: Document, tables: Mapping[str, Any], beside: tuple[str, ...]) -> Design | None:
    """A brake that `squealbox reduce` wrote; None where something is wrong, which the document then holds."""
    before = len(document.problems)
    only(document, tables, (), [*KEYS, *beside])
    file, values = tables.get("file"), tables.get("values", {})
    if "file" not in tables:
        document.problem((), "the key 'file' is missing, expected the .npz file of squealbox reduce")
    elif not isinstance(file, str):
        wrong(document, ("file",), file, "the name of a .npz file in quotes")
    if not isinstance(values, Mapping):
        wrong(document, ("values",), values, "a table of numbers")
    law = read_law(document, tables["friction"], ("friction",)) if "friction" in tables else None
    if len(document.problems) > before or law is WRONG:
        return None
    try:
        brake = load_reduced(path_beside(document.path, str(file)))
    except (ArrayFileError, MatrixFileError) as error:
        document.problem(("file",), str(error))
        return None
    if law is not None:
        brake = brake.replace(friction=law)
    for name, value, place in flattened(values, ("values",), brake):
        try:
            brake = brake.replace({name: value})
        except (ParameterError, TypeError, ValueError) as error:
            document.problem(place, f"{shown(value)}: {getattr(error, 'expectation', error)}")
    return brake if len(document.problems) == before else None


def dense(found: "DesignFile", axes: Iterable[ParameterAxis] = ()) -> "DesignFile":
    """The file with its finite-element brake reduced for `axes` and for what its sections vary.

    A brake with dense matrices is returned as it is. Raises `InvalidSystem`, one sentence, without a band.
    """
    if isinstance(found.design, ReducedBrake):
        return _from_rest(found)
    if not found.design.system().is_sparse:
        return found
    about = found.reduce or Reduced(Reduce(), {})
    band = about.how.band if about.how.band is not None else found.modes.band if found.modes else None
    if band is None:
        raise InvalidSystem(f"a finite-element brake is made small for this, which needs a frequency band: {MISSING}")
    from squealbox.fe import reduce

    varying, how = _ranges(found, axes), about.how
    ends = (float(band[0]), float(band[1]))
    time = found.modes.time if found.modes else 0.0
    try:
        method: Any = how.method
        small = reduce(found.design, ends, varying=varying, method=method, tolerance=how.tolerance, time=time)
    except ValueError as error:
        if isinstance(error, (InvalidSystem, ParameterError)):
            raise
        raise InvalidSystem(str(error)) from error
    return _from_rest(dataclasses.replace(found, design=with_rest(small)))


def for_a_page(found: "DesignFile") -> Design:
    """The design of a file as a page shows it: a finite-element brake made small, with its surface to draw.

    Raises `InvalidSystem` as `dense`.
    """
    design = dense(found).design
    return with_surface(design) if isinstance(design, ReducedBrake) else design


def with_rest(small: ReducedBrake) -> ReducedBrake:
    """The brake with the coordinates of q = 0 among its arrays, so that motions can start at rest."""
    arrays = {**small.reduction.arrays, "rest": _on_basis(small, -small.full.steady)}
    return small.replace({"reduction": small.reduction.replace(arrays=arrays)})


def _on_basis(small: ReducedBrake, field: Any) -> Any:
    """Coordinates of the motion on the basis nearest to one of the full brake, V'M V p = V'M u."""
    full = small.full
    mass = full.system({}).M
    return np.linalg.solve(full.basis.T @ (mass @ full.basis), full.basis.T @ (mass @ np.asarray(field, dtype=float)))


def _from_rest(found: "DesignFile") -> "DesignFile":
    """The file with [simulate] in coordinates of its reduced brake, which are counted from steady sliding.

    "rest" is q = 0 of the full brake; what the file adds to the start has a number for each freedom of the full one.
    """
    small, asked = found.design, found.simulate or MotionSettings()
    if not isinstance(small, ReducedBrake):
        return found
    q, qd = (field if field is None or small.full is None else _on_basis(small, field) for field in (asked.q, asked.qd))
    if asked.start == "rest":
        q = small.reduction.arrays["rest"] + (0.0 if q is None else q)
    return dataclasses.replace(found, simulate=asked.replace(q=q, qd=qd))


def promise(brake: ReducedBrake) -> str:
    """What a reduced brake promises, and how far it was looked at."""
    about = brake.reduction
    corners = [point for point, _ in about.errors if point]
    names = sorted({name for point in corners for name in point})
    over = [f"{name} {min(p[name] for p in corners):g} to {max(p[name] for p in corners):g}" for name in names]
    held = "" if about.error <= about.tolerance else f", more than the {about.tolerance:g} 1/s asked for"
    count = len(about.arrays["M"])
    done = (
        f"Reduced from {about.size} to {count} coordinates" if count < about.size else f"All {count} coordinates kept"
    )
    return (
        f"{done} for {about.band[0]:g} to {about.band[1]:g} "
        f"Hz{' and ' + ', '.join(over) if over else ''}: eigenvalues in the band within {about.error:.2g} 1/s{held}, "
        f"estimated at {len(about.errors)} point{'s' * (len(about.errors) != 1)}; that no growing mode is missing is "
        "not certified here (squealbox modes --certify)."
    )


def error_table(brake: ReducedBrake) -> str:
    """The points at which a reduced brake was checked against the full one, and its largest error there."""
    rows = [f"{'error [1/s]':>12}  at"]
    for point, error in brake.reduction.errors:
        place = ", ".join(f"{name} = {value:g}" for name, value in point.items()) or "the design as the file gives it"
        rows.append(f"{float(error):>12.2g}  {place}")
    return "\n".join(rows)


def _ranges(found: "DesignFile", axes: Iterable[ParameterAxis]) -> dict[str, tuple[float, float]]:
    """Everything that is varied, each over the union of its ranges."""
    spans = [(axis.name, float(axis.low), float(axis.high)) for axis in axes]
    if found.reduce is not None:
        spans += [(name, low, high) for name, (low, high) in found.reduce.varying.items()]
    plane = () if found.map is None else (found.map.x, found.map.y)
    spans += [(a.name, float(a.low), float(a.high)) for a in (found.onset, found.branch, *plane) if a is not None]
    if found.scatter is not None:
        for name, one in found.scatter.scatter.distributions.items():
            low, high = (float(end) for end in one.support)
            ends = float(one.ppf(RARE)), float(one.ppf(1.0 - RARE))
            spans.append((name, low if np.isfinite(low) else ends[0], high if np.isfinite(high) else ends[1]))
    if found.optimise is not None:
        spans += [(name, float(low), float(high)) for name, (low, high) in found.optimise.variables.items()]
    ranges: dict[str, tuple[float, float]] = {}
    for name, low, high in spans:
        about = found.design.scalar(name)
        low, high = max(low, about.low), min(high, about.high)
        before = ranges.get(name, (low, high))
        ranges[name] = min(before[0], low), max(before[1], high)
    from squealbox.fe import MOST_AXES

    if len(ranges) > MOST_AXES:
        raise InvalidSystem(
            f"the file varies {len(ranges)} parameters of a finite-element brake ({', '.join(ranges)}): expected at "
            f"most {MOST_AXES}, because the reduced brake is checked at the corners of their ranges"
        )
    return ranges

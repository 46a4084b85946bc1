"""What every result carries: its arrays, the inputs and settings that made them, an outcome and its provenance.

A result is frozen. Its arrays are declared with :func:`quantity` (dimensions, unit, meaning), and from that one
declaration come the labelled dataset, the file and the reading back. Files are NetCDF 4, written by h5netcdf and read
by xarray; nothing in them is ever executed.
"""

import dataclasses
import importlib
import json
import os
import platform
from collections.abc import Callable, Iterable, Mapping
from functools import cache
from importlib import metadata
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple, Self, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from squealbox.labelled import Labelled, Labels, whole
from squealbox.parameters import DRAWN_BY, from_plain, load_kind, screenful, to_plain, with_cautions

if TYPE_CHECKING:
    import xarray

Array = NDArray[Any]
"""An array of a result; its dimensions and unit stand where it is declared."""
COMPLETED = "completed"
MOST_LINES = 20  # of a summary
MOST_COLUMNS = 100  # that one array gives to a table
NAMED_BY = {  # dimension to the attributes that may hold its names
    "parameter": ("parameters", "names"), "parameter2": ("parameters", "names"), "other": ("parameters", "names"),
    "scheme": ("schemes",), "law": ("names",), "damper": ("damper_names",), "row": ("names",), "sweep": ("sweeps",),
    "dof": ("dofs",), "contact": ("contacts",)
}  # fmt: skip
KEPT = {"kind": "kind of it"}  # field to its attribute in a file, where that name says the kind of the result
Analysis = TypeVar("Analysis", bound=Callable[..., Any])


class Outcome(str):
    """How a computation ended: a name that compares as a string, a sentence, and the evidence.

    >>> Outcome("step_underflow", "the step fell below 1e-18 s", time=0.01) == "step_underflow"
    True
    """

    message: str
    evidence: Mapping[str, Any]

    def __new__(cls, name: str = COMPLETED, message: str = "", **evidence: Any) -> Self:
        self = super().__new__(cls, name)
        self.message, self.evidence = message, evidence
        return self

    @property
    def ok(self) -> bool:
        """True when the computation reached its end."""
        return self == COMPLETED

    @property
    def told(self) -> str:
        """The name, and the sentence where there is one."""
        return f"{self!s}: {self.message}" if self.message else str(self)

    def to_plain(self) -> dict[str, Any]:
        """Name, message and evidence as plain data."""
        return {"name": str(self), "message": self.message, "evidence": to_plain(self.evidence)}

    @classmethod
    def from_plain(cls, data: Mapping[str, Any]) -> Self:
        """The inverse of `to_plain`."""
        return cls(data["name"], data["message"], **data["evidence"])


TABLES = (".csv", ".txt", ".tsv", ".xls", ".xlsx", ".ods", ".json", ".mat", ".npy", ".npz")  # what save does not write


class ResultFileError(OSError):
    """A file could not be read as a result; the message names the file and what is wrong with it."""


def quantity(dims: str, unit: str, meaning: str = "") -> Any:
    """Declare an array of a result: dimensions (``"time dof"``; a leading ``...`` is allowed), unit and meaning."""
    return dataclasses.field(metadata={"dims": tuple(dims.split()), "unit": unit, "meaning": meaning})


def optional(dims: str, unit: str, meaning: str = "") -> Any:
    """As `quantity`, of an array that is empty where nobody gives it, as in files of before it was there."""
    about = {"dims": tuple(dims.split()), "unit": unit, "meaning": meaning}
    shape = (0,) * len(about["dims"])
    return dataclasses.field(default_factory=lambda: np.zeros(shape), metadata=about)


class Column(NamedTuple):
    """What a study keeps of a result under one name; dims are those that come after the leading axes."""

    values: Any
    dims: tuple[str, ...] = ()
    unit: str = ""
    meaning: str = ""


def batched(analysis: Analysis) -> Analysis:
    """Declare that an analysis answers a design whose parameters are arrays (k,) with results of leading axis k.

    A study hands such an analysis whole blocks of points instead of one point at a time. The answer at a point must not
    depend on the other points of its block.
    """
    analysis.batched = True  # type: ignore[attr-defined]
    return analysis


def provenance() -> dict[str, str]:
    """Versions of what computed a result; no host name, user or date, so equal inputs give equal files."""
    return dict(_versions())


@cache
def _versions() -> tuple[tuple[str, str], ...]:
    names = ("squealbox", "numpy", "scipy")
    return (*((name, metadata.version(name)) for name in names), ("python", platform.python_version()))


@dataclasses.dataclass(frozen=True, kw_only=True, eq=False)
class Result:
    """Base of all results. Subclasses add arrays declared with :func:`quantity`."""

    inputs: Mapping[str, Any] = dataclasses.field(default_factory=dict)
    settings: Mapping[str, Any] = dataclasses.field(default_factory=dict)
    outcome: Outcome = dataclasses.field(default_factory=Outcome)
    provenance: Mapping[str, str] = dataclasses.field(default_factory=provenance)

    kinds: ClassVar[dict[str, type["Result"]]] = {}
    coordinates: ClassVar[Mapping[str, str]] = {}
    """Dimension to its attribute; dof, contact, state are named by the system, others as `NAMED_BY`."""
    derived: ClassVar[Mapping[str, tuple[str, str, str]]] = {}
    """Attributes that follow from the arrays and stand in the dataset too, with dimensions, unit and meaning."""
    table_over: ClassVar[tuple[str, ...]] = ()
    """Dimensions that have a row each in a table; empty means those of the first array."""
    swept: ClassVar[Mapping[str, tuple[str, str, str]]] = {}
    """Attributes a study keeps of each point, with dimensions, unit and meaning; empty means every declared array."""

    def __init_subclass__(cls, **keywords: Any) -> None:
        super().__init_subclass__(**keywords)
        if "__repr__" not in cls.__dict__:
            cls.__repr__ = Result.__repr__  # type: ignore[method-assign]  # a dataclass would print every array
        Result.kinds[cls.kind_name()] = cls

    def __repr__(self) -> str:
        return screenful(str(self) if type(self).__str__ is not object.__str__ else self.summary())

    def summary(self) -> str:
        """At most a screenful: how it ended, each number with its unit, each array by its shape and range."""
        name, ended, fields = type(self).__name__, self.outcome, _quantities(type(self))
        said = f"{name}: {ended}" if ended.ok else f"{name} ended as {ended.told}"
        lines = [f"  {field.name:<20s} {_told(field, getattr(self, field.name))}" for field in fields[:MOST_LINES]]
        if len(fields) > MOST_LINES:
            lines.append(f"  and {len(fields) - MOST_LINES} more arrays, listed by .to_dataset()")
        return self.warned([said, *lines])

    def warned(self, lines: Iterable[str] = ()) -> str:
        """The lines of a summary, and what is to be known of the whole before it is used."""
        return with_cautions(lines, self.warning)

    @property
    def warning(self) -> str:
        """What to know of the whole before it is used; "" also where the cautions are of its entries, as of cures."""
        return caution if isinstance(caution := getattr(self, "caution", ""), str) else ""

    @classmethod
    def kind_name(cls) -> str:
        """The name a file knows this class by, its place in the package: ``transient.trajectory.Trajectory``."""
        return f"{cls.__module__.removeprefix('squealbox.')}.{cls.__name__}"

    @property
    def outcomes(self) -> Any:
        """How each entry of the leading axes ended, by name; without leading axes, how the whole did."""
        return np.asarray(str(self.outcome))

    def columns(self) -> dict[str, Column]:
        """What a study keeps of this result: the attributes in `swept`, or every declared array."""
        arrays = {f.name: (" ".join(f.metadata["dims"]), *_about(f)) for f in _quantities(type(self))}
        return {
            name: Column(getattr(self, name), tuple(part for part in dims.split() if part != "..."), unit, meaning)
            for name, (dims, unit, meaning) in (self.swept or arrays).items()
        }

    def to_dataset(self) -> "xarray.Dataset":
        """The arrays as a labelled `xarray.Dataset`; units, inputs, settings, outcome and versions are attributes.

        Degrees of freedom and contacts are coordinates with the names the system gives them, and so is what an array
        runs over: ``motion.to_dataset()["q"].sel(time=0.01, dof="x")``. Of instants that are not exactly there the
        nearest are found by ``.sel(dof="x").sel(time=0.01, method="nearest")``; xarray finds no nearest name.
        """
        return self.labelled().dataset()

    def labelled(self) -> Labelled:
        """What `to_dataset` holds and `save` writes."""
        found = {}
        for field in _quantities(type(self)):
            array = np.asarray(getattr(self, field.name))
            found[field.name] = Labels(_dims(field.metadata["dims"], array.ndim), array, _said(*_about(field)))
        for name, (dims, unit, meaning) in self.derived.items():
            array = np.asarray(getattr(self, name))
            found[name] = Labels(_dims(tuple(dims.split()), array.ndim), array, _said(unit, meaning))
        attributes = {KEPT.get(name, name): json.dumps(to_plain(value)) for name, value in self._plain().items()}
        whole = Labelled(found, {}, {"kind": self.kind_name(), **attributes})
        return whole.with_({}, self._labels(whole))

    def to_dataframe(self) -> Any:
        """One row for each entry of what the result runs over (instants, points, trajectories), as a `pandas` table.

        Columns are the arrays over it; what runs over more gives a column each: ``q[x]``, ``q[y]``. Arrays of more than
        100, or over something else, are left out: `to_dataset` has all. ``attrs["units"]`` has the unit of each column.
        """
        dataset = self.to_dataset()
        first: tuple[Any, ...] = self.table_over or next(
            iter(dataset[field.name].dims for field in _quantities(type(self))), ()
        )
        first = tuple(dim for dim in first if dim in dataset.dims)
        twice = {name: f"{name} values" for name in dataset.coords if dataset[name].ndim > 1}  # named as a dimension
        dataset = dataset.rename_vars(twice).reset_coords([*twice.values()])
        table = dataset.drop_vars([name for name in dataset.coords if name not in first])
        columns: dict[str, Any] = {}
        for name, variable in table.data_vars.items():
            more = [dim for dim in variable.dims if dim not in first]
            if not set(first) <= set(variable.dims) or np.prod([variable.sizes[d] for d in more]) > MOST_COLUMNS:
                continue
            for at in np.ndindex(*(variable.sizes[dim] for dim in more)):
                labels = [str(dataset[d].values[i]) if d in dataset.coords else str(i)
                          for d, i in zip(more, at, strict=True)]  # fmt: skip
                own = f"{name}[{','.join(labels)}]" if labels else str(name)
                columns[own] = variable.isel(dict(zip(more, at, strict=True)))
        frame = table.drop_vars(list(table.data_vars)).assign(columns)
        made = frame.to_dataframe() if first else frame.expand_dims("row").to_dataframe()
        made.attrs["units"] = {name: str(frame[name].attrs.get("units", "")) for name in made.columns}
        return made

    def save(self, path: str | os.PathLike[str]) -> Path:
        """Write the result to a NetCDF file, whole or not at all; returns the path."""
        path = Path(path)
        if path.suffix.lower() in TABLES:
            raise ResultFileError(
                f"{path.name}: a result is saved as NetCDF, in a file whose name ends in .nc; to_dataframe() makes a "
                "table, with to_csv(...) and to_excel(...)"
            )
        if not path.parent.is_dir():
            raise ResultFileError(f"{path}: there is no folder {path.parent}, expected one that is there")
        with whole(path) as part:
            self._write(str(part))
        return path

    def _write(self, path: str) -> None:
        self.labelled().write(path)

    @classmethod
    def from_dataset(cls, dataset: "xarray.Dataset") -> Self:
        """The inverse of `to_dataset`."""
        name = str(dataset.attrs.get("kind", "no result"))
        if name not in Result.kinds:
            load_kind(name)
        kind = Result.kinds.get(name) or _moved(name)
        if kind is None or not issubclass(kind, cls):
            raise ResultFileError(f"holds {name!r}, not a {cls.__name__}")
        if kind is not cls:
            return kind.from_dataset(dataset)  # a kind may read more than its arrays
        plain = {name: json.loads(value) for name, value in dataset.attrs.items() if name != "kind"}
        fields = {kept: name for name, kept in KEPT.items()}
        plain = {fields.get(name, name): _unfolded(value) for name, value in plain.items()}
        plain["outcome"] = Outcome.from_plain(plain["outcome"])
        plain["inputs"] = from_plain(plain["inputs"])
        arrays: dict[str, Any] = {field.name: dataset[field.name].values for field in _quantities(kind)}
        return kind(**arrays, **_tuples(kind, plain))

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Self:
        """Read a result written by `save`. Raises `ResultFileError` naming the file and what is wrong."""
        import xarray

        if not os.path.exists(path):
            raise ResultFileError(f"{os.fspath(path)}: there is no such file")
        try:
            with xarray.open_dataset(path, engine="h5netcdf") as dataset:
                return cls.from_dataset(dataset.load())
        except (OSError, ValueError, KeyError, TypeError, RuntimeError) as error:
            raise ResultFileError(f"{path}: not a readable {cls.__name__}: {error}") from error

    def plot(self, **keywords: Any) -> Any:
        """The figure of this result, as `squealbox.plots.plot` draws it; keywords go to the drawing function."""
        return importlib.import_module(DRAWN_BY).plot(self, **keywords)

    def _repr_html_(self) -> str:
        """What a notebook shows: how it ended, the key numbers with units, a small figure, the arrays folded away."""
        card: str = importlib.import_module(DRAWN_BY).card(self)
        return card

    def _plain(self) -> dict[str, Any]:
        arrays = {field.name for field in _quantities(type(self))}
        kept = [f.name for f in dataclasses.fields(self) if not f.metadata.get("transient")]
        others = {name: _folded(getattr(self, name)) for name in kept if name not in arrays}
        return {**others, "outcome": self.outcome.to_plain()}

    def _labels(self, whole: Labelled) -> dict[str, Labels]:
        """Coordinates: names of freedoms and contacts, and the arrays that `coordinates` names."""
        found: dict[str, Labels] = {}
        sizes, known = whole.sizes, whole.variables
        for dim, name in self.coordinates.items():
            if dim in sizes and np.shape(getattr(self, name)) == (sizes[dim],):
                about = known[name].about if name in known else {}
                found[dim] = Labels((dim,), np.asarray(getattr(self, name)), about)
        system: Any = self.inputs.get("system") if isinstance(self.inputs, Mapping) else None
        if {"dof", "contact", "state"} & set(sizes):
            system = system.system() if hasattr(system, "system") else system
        dofs = tuple(getattr(system, "names", ()))
        names = {"dof": dofs, "contact": getattr(system, "contact_names", ()),
                 "state": (*dofs, *(f"{name}'" for name in dofs)), "end": ("low", "high"),
                 "goal": tuple(each["name"] for each in self.settings.get("goals", ()))}  # fmt: skip
        for dim in set(sizes) - set(found) - set(known):
            words = names.get(dim, ())
            for attribute in NAMED_BY.get(dim, ()):
                words = words or getattr(self, attribute, ())
            if len(set(words)) == sizes[dim] and all(isinstance(name, str) for name in words):
                found[dim] = Labels((dim,), np.array(words), {})
        return found


def _moved(name: str) -> "type[Result] | None":
    """The one class of that name in its room, for files from before its module moved; None where there is none."""
    room, _, last = name.partition(".")
    load_kind(f"{room}.{last.rpartition('.')[2]}")
    within = [kind for at, kind in Result.kinds.items() if at.startswith(f"{room}.")]
    alike = [kind for kind in within if kind.__name__ == last.rpartition(".")[2]]
    return alike[0] if len(alike) == 1 else None


def _told(field: dataclasses.Field[Any], value: ArrayLike) -> str:
    """One array in a line: a number with its unit, or shape, range and unit."""
    unit, array = field.metadata["unit"], np.asarray(value)
    behind = "" if unit in ("", "1", "-") else f" {unit}"
    if array.ndim == 0:
        return f"{array.item():.6g}{behind}" if array.dtype.kind in "fc" else f"{array.item()}{behind}"
    if array.dtype.kind in "OUSb" or array.size == 0:
        names, counts = np.unique(array.astype(str), return_counts=True)
        listed = ", ".join(f"{count} {name}" for name, count in list(zip(names, counts, strict=True))[:4])
        return f"{array.shape} {listed}{', ...' if len(names) > 4 else ''}" if array.size else f"{array.shape} empty"
    numbers = np.abs(array) if array.dtype.kind == "c" else array
    known = numbers[np.isfinite(numbers)]
    span = f"{known.min():.4g} to {known.max():.4g}{behind}" if known.size else "nothing finite"
    unknown = f", {numbers.size - known.size} not finite" if 0 < known.size < numbers.size else ""
    return f"{array.shape} {'magnitudes ' if array.dtype.kind == 'c' else ''}{span}{unknown}"


def _folded(value: Any) -> Any:
    """A result within a result as plain data, so that it goes into an attribute of the file."""
    if not isinstance(value, Result):
        return value
    arrays = {field.name: np.asarray(getattr(value, field.name)).tolist() for field in _quantities(type(value))}
    return {"result": value.kind_name(), "arrays": arrays, **{name: to_plain(v) for name, v in value._plain().items()}}


def _unfolded(value: Any) -> Any:
    """The inverse of `_folded`."""
    if not (isinstance(value, Mapping) and {"result", "arrays", "outcome"} <= set(value)):
        return value
    load_kind(value["result"])
    kind = Result.kinds[value["result"]]
    plain = {name: _unfolded(item) for name, item in value.items() if name not in ("result", "arrays")}
    plain |= {"outcome": Outcome.from_plain(plain["outcome"]), "inputs": from_plain(plain["inputs"])}
    arrays: dict[str, Any] = {name: np.asarray(item) for name, item in value["arrays"].items()}
    return kind(**arrays, **_tuples(kind, plain))


def _tuples(kind: type[Result], plain: dict[str, Any]) -> dict[str, Any]:
    """JSON knows lists alone; what a kind declares as a tuple is one again."""
    declared = {f.name for f in dataclasses.fields(kind) if str(f.type).startswith("tuple")}
    return {name: tuple(value) if name in declared and isinstance(value, list) else value
            for name, value in plain.items()}  # fmt: skip


def _said(unit: str, meaning: str) -> dict[str, str]:
    return {"units": unit, "long_name": meaning}


def _about(field: dataclasses.Field[Any]) -> tuple[str, str]:
    return field.metadata["unit"], field.metadata["meaning"]


def _quantities(kind: type[Result]) -> list[dataclasses.Field[Any]]:
    return [field for field in dataclasses.fields(kind) if "dims" in field.metadata]


def _dims(declared: tuple[str, ...], ndim: int) -> tuple[str, ...]:
    if declared[:1] != ("...",):
        return declared
    named = declared[1:]
    return (*(f"axis_{i}" for i in range(ndim - len(named))), *named)

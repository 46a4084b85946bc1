"""Labelled arrays as a table: a row for each entry of what they run over, and a column for each number of it."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, ClassVar, NamedTuple

import numpy as np

from squealbox.labelled import Labelled
from squealbox.parameters import DataSheet
from squealbox.words import as_read, quantity_label, unit_at

MOST_COLUMNS = 100  # that one array gives to a table
APART = {"parameter": "", "state": "m"}  # rows of which each has a unit of its own in arrays of that unit
MOTION = {"q": "{}", "qd": "d{}/dt"}  # heads of columns


class TableColumn(NamedTuple):
    """The numbers of one array that stand under one head; `part` is which, dimension to label."""

    name: str
    part: Mapping[str, str]
    unit: str
    values: Any


def indices(held: Labelled, over: Sequence[str]) -> Iterator[tuple[str, Any]]:
    """What each row is called by each dimension it runs over, the last one fastest: its name, and a label a row."""
    shape = [held.sizes[dim] for dim in over]
    for axis, dim in enumerate(over):
        named = held.labels(dim)
        labels = np.arange(shape[axis]) if named is None else np.asarray(named.values)
        aside = labels.reshape([-1 if i == axis else 1 for i in range(len(over))])
        yield dim, np.broadcast_to(aside, shape).ravel()


def columns(held: Labelled, over: Sequence[str], begin: int = 0) -> Iterator[TableColumn]:
    """The arrays over `over`; what runs over more gives a column for each entry, at most 100, others are left out.

    Entries of a dimension without labels are counted from `begin` on.
    """
    sizes = held.sizes
    for name, each in held.variables.items():
        more = [dim for dim in each.dims if dim not in over]
        wide = int(np.prod([sizes[dim] for dim in more]))
        if each.dims == (name,) or not set(over) <= set(each.dims) or wide > MOST_COLUMNS:
            continue
        order = [each.dims.index(dim) for dim in (*over, *more)]
        rows = int(np.prod([sizes[dim] for dim in over]))
        values = np.asarray(each.values).transpose(order).reshape(rows, *(sizes[dim] for dim in more))
        known = {dim: None if (named := held.labels(dim)) is None else np.asarray(named.values) for dim in more}
        for at in np.ndindex(*values.shape[1:]):
            part = {dim: str(i + begin if (of := known[dim]) is None else of[i])
                    for dim, i in zip(more, at, strict=True)}  # fmt: skip
            yield TableColumn(name, part, str(each.about.get("units", "")), values[(slice(None), *at)])


class Tabled:
    """What a result needs to be a table: the arrays it is `labelled` with, and which of them have a row each."""

    coordinates: ClassVar[Mapping[str, str]] = {}
    """Dimension to its attribute; dof, contact, state are named by the system, others as `NAMED_BY` says."""
    table_over: ClassVar[tuple[str, ...]] = ()
    """Dimensions that have a row each; empty means those of the first array."""
    headings: ClassVar[Mapping[str, str]] = {}
    """What the columns of an array are called, {} for the label of the entry; "" leaves them out."""
    inputs: Mapping[str, Any]
    settings: Mapping[str, Any]

    def labelled(self) -> Labelled:
        """The arrays with their names, units and labels."""
        raise NotImplementedError

    def to_dataframe(self) -> Any:
        """One row for each entry of what the result runs over (instants, points, trajectories), as a `pandas` table.

        Columns are the arrays over it; what runs over more gives a column each: ``q[x]``, ``q[y]``. Arrays of more than
        100, or over something else, are left out: `to_dataset` has all. ``attrs["units"]`` has the unit of each column.
        """
        return frame(*self._rows())

    def table(self) -> dict[str, Any]:
        """Columns of equal length as `write` puts them into a file for spreadsheets, under heads such as `load [N]`.

        Complex numbers have two columns, and of what runs over more each entry has one; angles that are parameters are
        in degrees.
        """
        held, over = self._rows()
        headings, holds, found = {**MOTION, **self.headings}, self.holds, {}
        told = [each for each in columns(held, over, begin=1) if headings.get(each.name) != ""]
        told.sort(key=lambda each: each.name not in holds)
        for dim, labels in indices(held, over):
            named = held.labels(dim)
            if (named is None and len(over) < 2) or any(np.array_equal(each.values, labels) for each in told):
                continue  # counted rows, or what a column says
            unit = "" if named is None else str(named.about.get("units", ""))
            values, unit = as_read(labels if named is not None else labels + 1, unit)
            found[_headed(holds.get(dim, dim), unit or "-", values)] = values
        rows = "".join(over)
        apart = APART.get(rows) if rows in found else None
        if apart is not None and any(each.unit == apart for each in told):
            found["unit"] = np.array([self._unit_at(rows, name, apart) or "-" for name in found[rows]])
        for each in told:
            head = holds.get(each.name) or headings.get(each.name) or each.name.replace("_", " ")
            unit, values = "" if each.unit == apart else each.unit, each.values
            for dim, label in each.part.items():
                between = ", " if dim == "contact" else " "
                head = head.replace("{}", label) if "{}" in head else f"{head}{between}{label}"
                unit = self._unit_at(dim, label, unit)
            head = head.replace("{}", each.name)  # where rows are what labels tell
            if each.name in holds or ("parameter" in each.part and not each.unit):
                values, unit = as_read(values, unit)
                unit = unit or "-"
            parts = {" real": values.real, " imaginary": values.imag} if np.iscomplexobj(values) else {"": values}
            for which, part in parts.items():
                whole = _headed(f"{head}{which}", unit, part)
                found[f"{each.name}: {whole}" if whole in found else whole] = part  # a freedom may be called "mode"
        return found

    def unit_of(self, parameter: str) -> str:
        """The unit of a dotted parameter of the design a result came from; empty where nothing tells it."""
        told = self.settings.get("parameter_units", {})
        if parameter in told:
            return str(told[parameter])
        kept = self.inputs.get("system", self.inputs.get("design")) if isinstance(self.inputs, Mapping) else None
        return kept.unit_of(parameter) if isinstance(kept, DataSheet) and parameter else ""

    def read_value(self, parameter: str, value: Any, digits: int = 6) -> str:
        """A value of a parameter with the unit it is read in: angles in degrees."""
        number, unit = as_read(float(value), self.unit_of(parameter))
        return f"{number:.{digits}g} {unit}".rstrip()

    @property
    def holds(self) -> dict[str, str]:
        """What arrays and dimensions of values are values of: parameters by their names, the quantity of a study."""
        asked, several = self.settings.get("quantity"), getattr(self, "parameters", ())
        found = {"value": getattr(self, "parameter", ""), **dict(zip(("x", "y"), several, strict=False))}
        found |= {f"parameter_{name}": name for name in several}
        if isinstance(asked, Mapping):
            found |= dict.fromkeys(("values", "thresholds"), str(asked.get("name", "")))
        along = {dim: found[name] for dim, name in self.coordinates.items() if name in found}
        return {name: held for name, held in {**found, **along}.items() if held}

    def kept_system(self) -> Any:
        """The system a result came from; None where it kept none."""
        kept: Any = self.inputs.get("system") if isinstance(self.inputs, Mapping) else None
        return kept.system() if hasattr(kept, "system") else kept

    def _rows(self) -> tuple[Labelled, tuple[str, ...]]:
        """What the result holds, and the dimensions that have a row each in a table."""
        held = self.labelled()
        first = next((each.dims for each in held.variables.values()), ())
        return held, tuple(dim for dim in self.table_over or first if dim in held.sizes)

    def _unit_at(self, dim: str, label: str, unit: str) -> str:
        """The unit of one entry of an array: freedoms may turn, and each parameter has its own."""
        if dim == "parameter" and not unit:
            return self.unit_of(label)
        if dim in ("dof", "state") and unit in ("m", "m/s"):
            return unit_at(self.kept_system(), label.rstrip("'"), moves=unit == "m/s" or label.endswith("'"))
        return unit


def _headed(name: str, unit: str, values: Any) -> str:
    """The head of a column: with the unit of measured numbers; none of words and counts, and where rows differ."""
    return quantity_label(name, unit) if unit and np.asarray(values).dtype.kind in "fc" else name


def frame(held: Labelled, over: Sequence[str]) -> Any:
    """The columns, ``q[x]``, as a table of pandas, with what rows are called as index; ``attrs["units"]`` has units."""
    import pandas as pd

    named = [*indices(held, over)]
    index: Any = pd.RangeIndex(1, name="row")
    if len(named) == 1:
        index = pd.Index(named[0][1], name=named[0][0])
    elif named:
        index = pd.MultiIndex.from_arrays([labels for _, labels in named], names=list(over))
    found, units = {}, {}
    for each in columns(held, over):
        name = f"{each.name} values" if each.name in held.sizes else each.name  # named as a dimension
        own = f"{name}[{','.join(each.part.values())}]" if each.part else name
        found[own], units[own] = each.values, each.unit
    made = pd.DataFrame(found, index=index)
    made.attrs["units"] = units
    return made

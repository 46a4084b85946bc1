"""Arrays with named dimensions, units and labels: as a dataset of xarray, and as a NetCDF file.

The file is written by h5netcdf as xarray would read it, without loading xarray: that takes longer than most analyses.
"""

import io
import os
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

if TYPE_CHECKING:
    import h5netcdf
    import xarray


@contextmanager
def whole(path: Path) -> Iterator[Path]:
    """A file to write in place of `path`, which it becomes at the end: that is there whole or not at all.

    Where the disc is full or nothing may be written there, the `OSError` names `path`.
    """
    part: Path | None = None
    try:
        handle, name = tempfile.mkstemp(dir=path.parent, prefix=path.name, suffix=".part")
        os.close(handle)
        part = Path(name)
        yield part
        part.chmod(0o644)  # a temporary file is readable by its owner alone
        part.replace(path)
    except OSError as error:
        if error.errno is None:
            raise  # a sentence of its own
        raise OSError(error.errno, error.strerror, str(path)) from error
    finally:
        if part is not None:
            part.unlink(missing_ok=True)


class Labels(NamedTuple):
    """An array with the names of its dimensions, its unit and its meaning."""

    dims: tuple[str, ...]
    values: Any
    about: Mapping[str, str]


class Labelled(NamedTuple):
    """What a dataset holds. A variable of the name of its one dimension labels it, as one of `coordinates` does."""

    variables: Mapping[str, Labels]
    coordinates: Mapping[str, Labels]
    attributes: Mapping[str, str]

    @property
    def everything(self) -> dict[str, Labels]:
        """Variables and coordinates."""
        return {**self.variables, **self.coordinates}

    @property
    def sizes(self) -> dict[str, int]:
        """Dimension to its length."""
        of = (zip(each.dims, np.shape(each.values), strict=True) for each in self.everything.values())
        return {dim: size for pairs in of for dim, size in pairs}

    def labels(self, dim: str) -> Labels | None:
        """What the entries of a dimension are called, or None where they are only counted."""
        found = self.everything.get(dim)
        return found if found is not None and found.dims == (dim,) else None

    def renamed(self, names: Mapping[str, str]) -> "Labelled":
        """With other names for some dimensions."""

        def called(part: Mapping[str, Labels]) -> dict[str, Labels]:
            return {
                key: Labels(tuple(names.get(dim, dim) for dim in dims), values, about)
                for key, (dims, values, about) in part.items()
            }

        return Labelled(called(self.variables), called(self.coordinates), self.attributes)

    def with_(self, variables: Mapping[str, Labels], coordinates: Mapping[str, Labels] | None = None) -> "Labelled":
        """With more variables and coordinates, or others of the same names."""
        return Labelled({**self.variables, **variables}, {**self.coordinates, **(coordinates or {})}, self.attributes)

    def dataset(self) -> "xarray.Dataset":
        """As xarray holds it."""
        import xarray

        return xarray.Dataset(dict(self.variables), coords=dict(self.coordinates), attrs=dict(self.attributes))

    def write(self, path: str | os.PathLike[str]) -> None:
        """As a NetCDF 4 file; equal arrays give equal bytes."""
        import h5netcdf

        made = io.BytesIO()  # HDF5 ends the whole program where it meets a full disc
        with h5netcdf.File(made, "w", invalid_netcdf=True) as file:
            file.dimensions = self.sizes
            for name, (dims, values, about) in self.everything.items():
                put(file, name, dims, np.asarray(values), about)
            put_attributes(file, {name: each.dims for name, each in self.coordinates.items()}, self.attributes)
        with open(path, "wb") as stream:
            stream.write(made.getbuffer())


def about(unit: str, meaning: str) -> dict[str, str]:
    """The attributes that say unit and meaning."""
    return {key: text for key, text in {"units": unit, "long_name": meaning}.items() if text}


def put(file: "h5netcdf.File", name: str, dims: tuple[str, ...], values: np.ndarray, about: Mapping[str, str]) -> None:
    """Write an array as a variable of an open file."""
    if values.dtype.kind == "O":
        values = values.astype(str)
    encoded = stored(values)
    if values.dtype.kind == "U":
        values = np.char.decode(encoded, "latin-1")  # as wide as its bytes
    target = created(file, name, dims, values.dtype, about)
    if values.size:
        target[...] = encoded


def put_attributes(
    file: "h5netcdf.File", coordinates: Mapping[str, tuple[str, ...]], attributes: Mapping[str, str]
) -> None:
    """Write the attributes of an open file, with the coordinates (name to dimensions) that are no dimension's own."""
    aside = [name for name, dims in coordinates.items() if (name,) != dims]
    more = {"coordinates": " ".join(aside)} if aside else {}
    for name, text in {**attributes, **more}.items():
        file.attrs[name] = text


def created(
    file: "h5netcdf.File",
    name: str,
    dims: tuple[str, ...],
    dtype: np.dtype[Any],
    about: Mapping[str, str],
    width: int = 1,
) -> Any:
    """A variable of an open file that is to be filled; a letter of its words takes up to `width` bytes."""
    kind = {"U": np.dtype(f"S{max(1, dtype.itemsize // 4 * width)}"), "b": np.dtype("i1")}.get(dtype.kind, dtype)
    variable = file.create_variable(name, dims, dtype=kind)
    marks = {"U": {"_Encoding": "utf-8"}, "b": {"dtype": "bool"}}.get(dtype.kind, {})
    for key, text in {**about, **marks}.items():
        variable.attrs[key] = text
    return variable


def stored(values: np.ndarray) -> Any:
    """The values as such a variable takes them."""
    kind = values.dtype.kind
    return in_bytes(values) if kind == "U" else values.astype("i1") if kind == "b" else values


def in_bytes(words: np.ndarray) -> Any:
    """Words as UTF-8; all the same or plain ASCII, the usual cases, on the quick road."""
    if words.size and np.all(words == words.flat[0]):
        return np.full(words.shape, str(words.flat[0]).encode())
    try:
        return words.astype("S")
    except UnicodeEncodeError:
        return np.char.encode(words, "utf-8")

"""Matrices of NumPy and MATLAB: .npy, .npz (also what `scipy.sparse.save_npz` writes) and .mat up to version 7.2.

No pickled objects; what a file says of its own size is checked before anything of that size is made.
"""

import io
import zipfile
from pathlib import Path
from tokenize import TokenError
from typing import IO, Any

import numpy as np

from squealbox.fe.readers.matrix import (
    MOST_FREEDOMS,
    OTHER,
    Entries,
    FileMatrix,
    MatrixFile,
    MatrixFileError,
    complete,
    kind_of,
)

MOST_BYTES = 8_000_000_000
BROKEN = (
    ValueError, TypeError, OSError, SyntaxError, RecursionError, MemoryError, TokenError, KeyError, IndexError,
    EOFError, zipfile.BadZipFile, OverflowError, NotImplementedError, AttributeError, UnicodeError, ArithmeticError,
)  # fmt: skip


def read_npy(path: Path) -> MatrixFile:
    """One dense matrix."""
    with path.open("rb") as stream:
        array = _one(path, stream, path.stat().st_size, path.stem)
    return MatrixFile(path, "NumPy .npy", (_matrix(path, path.stem, array),))


def _one(path: Path, stream: IO[bytes], length: int, name: str) -> Any:
    try:
        version = np.lib.format.read_magic(stream)
        head = np.lib.format.read_array_header_1_0 if version == (1, 0) else np.lib.format.read_array_header_2_0
        shape, fortran, kind = head(stream)
        count = int(np.prod(shape, dtype=object))
        if kind.hasobject or kind.kind not in "fiubSU":
            raise MatrixFileError(path, f"{name} holds {kind}: expected real numbers")
        if count * kind.itemsize > min(MOST_BYTES, length * 1100):
            raise MatrixFileError(path, f"{name} says it has the shape {shape}: expected what fits its file")
        data = stream.read(count * kind.itemsize + 1)
        if len(data) != count * kind.itemsize:
            raise MatrixFileError(path, f"{name} says it has the shape {shape}, but is not as long as that")
        array = np.frombuffer(data, kind)
        return array.reshape(shape[::-1]).T if fortran else array.reshape(shape)
    except MatrixFileError:
        raise
    except BROKEN as error:
        raise MatrixFileError(path, f"{name} is not a NumPy array: damaged or cut short") from error


def read_npz(path: Path) -> MatrixFile:
    """Each array of the archive, or the one sparse matrix of `scipy.sparse.save_npz`."""
    try:
        with zipfile.ZipFile(path) as archive:
            arrays = {}
            for entry in archive.infolist():
                if entry.filename.endswith(".npy"):
                    if entry.file_size > MOST_BYTES or entry.file_size > 1100 * max(entry.compress_size, 1):
                        raise MatrixFileError(
                            path, f"{entry.filename[:40]} unpacks to {entry.file_size} bytes: too many"
                        )
                    with archive.open(entry) as stream:
                        arrays[entry.filename[:-4]] = _one(path, stream, entry.file_size, entry.filename[:-4])
    except MatrixFileError:
        raise
    except (*BROKEN, RuntimeError) as error:
        raise MatrixFileError(path, "is not a NumPy .npz archive: damaged or cut short") from error
    except Exception as error:  # what zlib raises is no class of the standard hierarchy
        if type(error).__module__ != "zlib":
            raise
        raise MatrixFileError(path, "is not a NumPy .npz archive: damaged or cut short") from error
    if {"format", "shape", "data"} <= set(arrays):
        return MatrixFile(path, "SciPy sparse .npz", (_saved_sparse(path, arrays),))
    labels = arrays.pop("labels", None)
    found = tuple(_matrix(path, name, array) for name, array in arrays.items() if array.ndim == 2)
    if not found:
        raise MatrixFileError(path, "holds no matrix: expected arrays such as M and K")
    if labels is not None:
        from squealbox.fe.readers.matrix import with_labels

        if labels.ndim != 2 or labels.shape[1] != 2 or labels.dtype.kind not in "iu":
            raise MatrixFileError(path, f"labels have the shape {labels.shape}: expected (n, 2) whole numbers")
        found = tuple(with_labels(m, labels) if m.matrix.shape[0] == len(labels) else m for m in found)
    return MatrixFile(path, "NumPy .npz", found)


def _saved_sparse(path: Path, arrays: dict[str, Any]) -> FileMatrix:
    form = arrays["format"].tobytes().replace(b"\x00", b"").decode("ascii", "replace")
    shape = tuple(int(size) for size in arrays["shape"].ravel()[:2])
    if form not in ("csr", "csc", "coo") or len(shape) != 2 or min(shape) < 1 or max(shape) > MOST_FREEDOMS:
        raise MatrixFileError(
            path, f"is a sparse matrix of format {form[:10]!r} and shape {shape}: expected csr, csc, coo"
        )
    names = ("row", "col") if form == "coo" else ("indices", "indptr")
    if not set(names) <= set(arrays):
        raise MatrixFileError(path, f"lacks {names[0]} or {names[1]}: expected a sparse matrix")
    data = np.asarray(arrays["data"]).ravel()
    first, second = (arrays[name].ravel() for name in names)
    if data.dtype.kind not in "fiu" or first.dtype.kind not in "iu" or second.dtype.kind not in "iu":
        raise MatrixFileError(path, "holds other than real numbers and whole indices: expected a sparse matrix")
    if form != "coo":
        lines = shape[0] if form == "csr" else shape[1]
        if len(second) != lines + 1 or second[0] != 0 or np.any(np.diff(second) < 0) or second[-1] != len(first):
            raise MatrixFileError(path, "has pointers of rows that do not fit its shape: a damaged file")
        second = np.repeat(np.arange(lines), np.diff(second))
    rows, columns = (second, first) if form == "csr" else (first, second)
    return _entries(path, path.stem, rows, columns, data.astype(float), shape)


def _entries(
    path: Path, name: str, rows: np.ndarray, columns: np.ndarray, data: np.ndarray, shape: tuple[float, float]
) -> FileMatrix:
    if len(rows) != len(data) or len(columns) != len(data):
        raise MatrixFileError(path, f"{name} has {len(data)} numbers and {len(rows)} rows: a damaged file")
    if len(data) and (rows.min() < 0 or columns.min() < 0 or rows.max() >= shape[0] or columns.max() >= shape[1]):
        raise MatrixFileError(path, f"{name} has an index outside its shape {tuple(shape)}: a damaged file")
    square = shape[0] == shape[1]
    kind = kind_of(name) if square else OTHER
    rows, columns = rows.astype(np.int32), columns.astype(np.int32)
    if square and ((rows >= columns).all() or (rows <= columns).all()) and np.any(rows != columns):
        raise MatrixFileError(
            path, f"{name} holds one triangle only: expected both, because nothing in the file says it is symmetric"
        )
    size = int(shape[0]) if square else (int(shape[0]), int(shape[1]))
    return complete(path, name, kind, Entries(rows, columns, data), size, "full", digits=16)


def _matrix(path: Path, name: str, array: np.ndarray) -> FileMatrix:
    if array.ndim != 2 or array.dtype.kind not in "fiu" or min(array.shape) < 1:
        raise MatrixFileError(path, f"{name[:40]} has the shape {array.shape}: expected a matrix of real numbers")
    rows, columns = np.nonzero(array)
    return _entries(path, name, rows, columns, array[rows, columns].astype(float), array.shape)


def read_mat(path: Path) -> MatrixFile:
    """The matrices of a MATLAB file."""
    from scipy.io import loadmat
    from scipy.io.matlab import MatReadError
    from scipy.sparse import issparse

    raw = path.read_bytes()
    try:
        _check_mat(path, raw)
        found = loadmat(io.BytesIO(raw), chars_as_strings=True, verify_compressed_data_integrity=True)
    except MatrixFileError:
        raise
    except (*BROKEN, MatReadError) as error:
        raise MatrixFileError(path, "is not a MATLAB .mat file up to version 7.2: damaged or cut short") from error
    except Exception as error:
        if type(error).__module__ != "zlib":
            raise
        raise MatrixFileError(path, "is not a MATLAB .mat file up to version 7.2: damaged or cut short") from error
    matrices = []
    for name, value in found.items():
        if name.startswith("__"):
            continue
        if issparse(value):
            try:
                value.check_format(full_check=True)
                whole = value.tocoo()
            except BROKEN as error:
                raise MatrixFileError(path, f"{name[:40]} is no sparse matrix: {error}: a damaged file") from error
            if whole.data.dtype.kind not in "fiu":
                raise MatrixFileError(path, f"{name} holds {whole.data.dtype}: expected real numbers")
            matrices.append(_entries(path, name, whole.row, whole.col, whole.data.astype(float), whole.shape))
        elif isinstance(value, np.ndarray) and value.ndim == 2 and value.dtype.kind in "fiu" and min(value.shape) > 1:
            matrices.append(_matrix(path, name, value))
    if not matrices:
        raise MatrixFileError(path, "holds no matrix of real numbers: expected M and K, say")
    return MatrixFile(path, "MATLAB .mat", tuple(matrices))


def _check_mat(path: Path, raw: bytes) -> None:
    """The elements of a version 5 file, one behind the other, must end with it; SciPy overlooks what is cut."""
    if not raw.startswith(b"MATLAB 5.0"):
        return
    order = "little" if raw[126:128] == b"IM" else "big"
    at = 128
    while at < len(raw):
        if at + 8 > len(raw):
            raise MatrixFileError(path, f"ends within an element at byte {at}: the file was cut short")
        kind, size = int.from_bytes(raw[at : at + 4], order), int.from_bytes(raw[at + 4 : at + 8], order)  # type: ignore[arg-type]
        if kind not in (14, 15):
            raise MatrixFileError(path, f"an element of type {kind} at byte {at}: expected a matrix; a damaged file")
        at += 8 + size
    if at != len(raw):
        raise MatrixFileError(path, f"says it has {at} bytes and has {len(raw)}: the file was cut short")

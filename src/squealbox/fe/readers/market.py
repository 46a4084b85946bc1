"""MatrixMarket: an honest header, `general`, `symmetric`, `skew-symmetric` or `hermitian`, and what must fit it.

Also what *EXPORT,MMF of Ansys writes, with a mapping vector of nodes in a file of its own. Numbers may have Fortran's
exponent D or none; a symmetric file that holds both triangles, a pattern and a number cut off are refused.
"""

from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from squealbox.fe.readers.matrix import OTHER, Entries, FileMatrix, MatrixFile, MatrixFileError, complete, kind_of
from squealbox.fe.readers.numbers import check_index, columns_of, decoded, number, significant_digits

FIELDS = ("real", "double", "integer", "complex", "pattern")
SYMMETRIES = ("general", "symmetric", "skew-symmetric", "hermitian")


def read_market(path: Path, stream: BinaryIO) -> MatrixFile:
    """A MatrixMarket file of real numbers; the file's name tells the kind of matrix."""
    header = decoded(path, stream.readline(2000), 1).lower().split()
    if len(header) != 5 or header[1] != "matrix" or header[2] not in ("coordinate", "array"):
        raise MatrixFileError(path, "expected %%MatrixMarket matrix coordinate real general, or the like", 1)
    layout, numbers, symmetry = header[2:]
    if numbers not in FIELDS or symmetry not in SYMMETRIES:
        raise MatrixFileError(
            path, f"{numbers} {symmetry}: expected one of {', '.join(FIELDS)} and {', '.join(SYMMETRIES)}", 1
        )
    if numbers in ("pattern", "complex") or symmetry == "hermitian":
        raise MatrixFileError(path, f"holds a {numbers} {symmetry} matrix: expected real numbers", 1)
    line, creator = 1, ""
    words: list[str] = []
    while not words:
        raw = stream.readline(100_000)
        line += 1
        if not raw:
            raise MatrixFileError(path, "ends before it says its size: expected rows, columns and entries", line)
        text = decoded(path, raw, line)
        creator += text[:100] if text.startswith("%") and len(creator) < 1000 else ""
        words = [] if text.startswith("%") else text.split()
    try:
        sizes = [int(word) for word in words]
    except ValueError as error:
        raise MatrixFileError(path, f"{' '.join(words)[:60]!r}: expected whole numbers, the size", line) from error
    if len(sizes) != (3 if layout == "coordinate" else 2) or min(sizes) < 0 or min(sizes[:2]) < 1:
        raise MatrixFileError(path, f"{' '.join(words)[:60]!r}: expected rows, columns and entries", line)
    read = _coordinates if layout == "coordinate" else _array
    rows, columns, values, digits = read(path, stream, line + 1, sizes, symmetry)
    name = path.stem
    size: Any = sizes[0] if sizes[0] == sizes[1] else (sizes[0], sizes[1])
    if symmetry != "general" and sizes[0] != sizes[1]:
        raise MatrixFileError(
            path, f"says {symmetry} with {sizes[0]} rows and {sizes[1]} columns: expected a square one"
        )
    rule = "half" if symmetry == "symmetric" else "full"
    if symmetry == "skew-symmetric":
        if np.any(rows == columns):
            raise MatrixFileError(path, "says skew-symmetric and holds entries on the diagonal: expected none")
        rows, columns, values = (
            np.concatenate([rows, columns]),
            np.concatenate([columns, rows]),
            np.concatenate([values, -values]),
        )
    if symmetry == "general" and layout == "coordinate" and rows.size:
        one = (rows >= columns).all() or (rows <= columns).all()
        if one and np.any(rows != columns) and sizes[0] == sizes[1]:
            raise MatrixFileError(
                path, "says general and holds one triangle only: expected symmetric in the header, or both triangles", 1
            )
    kind = kind_of(name) if sizes[0] == sizes[1] else OTHER
    words_ = "MatrixMarket" + (", written by Ansys *EXPORT,MMF" if "ANSYS" in creator.upper() else "")
    if len(values) == 0:
        from scipy.sparse import csr_array

        return MatrixFile(path, words_, (FileMatrix(name, kind, csr_array((sizes[0], sizes[1])), "empty", 0),))
    entries = Entries(rows, columns, values, lambda i: line + 1 + i)
    del rows, columns, values
    found = complete(path, name, kind, entries, size, rule, digits=digits)
    return MatrixFile(path, words_, (found,))


def _coordinates(path: Path, stream: BinaryIO, line: int, sizes: list[int], symmetry: str) -> Any:
    rows, columns, values = columns_of(path, stream, line, 3, comma=False, comment=b"%")
    if len(values) != sizes[2]:
        raise MatrixFileError(path, f"says {sizes[2]} entries and holds {len(values)}: the file was cut or damaged")
    rows = check_index(path, rows, sizes[0], line)
    columns = check_index(path, columns, sizes[1], line)
    stream.seek(0)
    sample = [raw.decode("ascii", "replace").split() for raw in stream.readlines(20_000)[line - 1 :]]
    return rows, columns, values, significant_digits([words[-1] for words in sample if words])


def _array(path: Path, stream: BinaryIO, line: int, sizes: list[int], symmetry: str) -> Any:
    (values,) = columns_of(path, stream, line, 1, comma=False, comment=b"%")
    skew = 1 if symmetry == "skew-symmetric" else 0
    if symmetry == "general":
        rows, columns = np.tile(np.arange(sizes[0]), 1), np.arange(sizes[1])
        expected = sizes[0] * sizes[1]
        if len(values) == expected:
            rows, columns = np.tile(rows, sizes[1]), np.repeat(columns, sizes[0])
    else:
        expected = sizes[0] * (sizes[0] + 1) // 2 - skew * sizes[0]
        if len(values) == expected:
            columns, rows = np.triu_indices(sizes[0], skew)
    if len(values) != expected:
        raise MatrixFileError(path, f"says {expected} numbers and holds {len(values)}: the file was cut or damaged")
    keep = values != 0.0
    return rows[keep].astype(np.int32), columns[keep].astype(np.int32), values[keep], None


def read_vector(path: Path) -> Any:
    """Whole numbers of a MatrixMarket array or a plain list: nodes in the order of the matrix.

    Raises `MatrixFileError`.
    """
    found: list[int] = []
    with path.open("rb") as stream:
        sized = not stream.readline(100).startswith(b"%%MatrixMarket")
        stream.seek(0)
        for at, raw in enumerate(stream, 1):
            text = decoded(path, raw[:1000], at).strip()
            if text.startswith("%") or not text:
                continue
            if not sized:
                sized, said = True, text.split()
                continue
            try:
                values = [number(word) for word in text.replace(",", " ").split()]
            except ValueError as error:
                raise MatrixFileError(path, f"{error}: expected node numbers", at) from error
            if any(value != round(value) for value in values):
                raise MatrixFileError(path, f"{text[:40]!r}: expected whole node numbers", at)
            found += [int(value) for value in values]
    if "said" in locals() and said[0] != str(len(found)):
        raise MatrixFileError(path, f"says {said[0]} numbers and holds {len(found)}: the file was cut or damaged")
    return np.array(found, dtype=np.int64)

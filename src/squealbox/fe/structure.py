"""A structure as another code exported it: M, C and K with labels, aligned, in SI, and what a user should know of them.

    M q'' + C q' + K q = f          rows are labelled freedoms (node, direction)

Matrices of one model may come from several files, and a freedom without mass is not named in the mass file: they are
aligned on the union of their labels. Friction is not here; `interfaces` adds it.
"""

import os
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from squealbox.fe.frequencies import first_frequencies
from squealbox.fe.nodes import Nodes, read_nodes
from squealbox.fe.readers.labels import coded, decoded_labels
from squealbox.fe.readers.matrix import (
    DAMPING,
    MASS,
    STIFFNESS,
    STRUCTURAL,
    FileMatrix,
    MatrixFile,
    MatrixFileError,
    check_mass,
    shown_label,
)
from squealbox.fe.readers.opening import open_matrices, read_labels
from squealbox.fe.units import unit_system
from squealbox.parameters import ParameterError

if TYPE_CHECKING:
    from scipy.sparse import sparray

Source = str | os.PathLike[str] | tuple[str | os.PathLike[str], str]


@dataclass(frozen=True, eq=False)
class Structure:
    """M, C, K as sparse arrays of shape (n, n), SI when `units` are known, with the labels of their rows.

    labels (n, 2) are node and direction (1 to 3 displacements, 4 to 6 rotations, 0 a scalar point), or None; internal
    (n,) marks freedoms without a node (Lagrange multipliers, connectors; their node is negative); massless (n,) marks
    rows without mass; constrained (m, 2) are labels that the file held fixed and that are left out; nodes are places.
    """

    M: Any
    C: Any
    K: Any
    labels: Any = None
    constrained: Any = None
    units: str | None = None
    nodes: Nodes | None = None
    digits: int | None = None
    notes: tuple[str, ...] = ()

    @property
    def size(self) -> int:
        """Number n of freedoms."""
        return int(self.K.shape[0])

    @property
    def internal(self) -> Any:
        """Shape (n,), True for a freedom of no node."""
        return np.zeros(self.size, dtype=bool) if self.labels is None else self.labels[:, 0] < 0

    @property
    def massless(self) -> Any:
        """Shape (n,), True for a freedom without mass."""
        return self.M.diagonal() == 0.0

    def rows(self, node: int) -> dict[int, int]:
        """Direction to row for each freedom of `node`; empty when the structure has none of it."""
        if self.labels is None:
            raise ParameterError("structure", "labels", None, "labels, to find a node: give nodes of the rows")
        found = np.flatnonzero(self.labels[:, 0] == node)
        return {int(self.labels[row, 1]): int(row) for row in found}

    def frequencies(self, count: int = 10) -> Any:
        """The first `count` natural frequencies without friction [Hz], rigid ones included; see `first_frequencies`."""
        return first_frequencies(self.M, self.K, count)

    def total_mass(self) -> float:
        """Mass in translation [kg], from the labels; NaN without them."""
        if self.labels is None:
            return float("nan")
        masses = [0.0]
        for direction in (1, 2, 3):
            ones = (self.labels[:, 1] == direction).astype(float)
            masses.append(float(ones @ (self.M @ ones)))
        return max(masses)

    def doubts(self, frequencies: ArrayLike | None = None) -> tuple[str, ...]:
        """Sentences on what looks wrong for a brake: mass, first elastic frequency, massless and internal rows."""
        found = list(self.notes)
        if self.massless.any():
            found.append(f"{int(self.massless.sum())} freedoms without mass: {self._named(self.massless)}")
        if self.internal.any():
            found.append(f"{int(self.internal.sum())} internal freedoms of no node: {self._named(self.internal)}")
        if self.constrained is not None and len(self.constrained):
            first = ", ".join(f"{a}.{b}" for a, b in self.constrained[:3])
            found.append(f"{len(self.constrained)} constrained freedoms left out: {first}")
        given = f"units {self.units}" if self.units else "the numbers as they are"
        mass = self.total_mass()
        if self.units and np.isfinite(mass) and mass > 0.0 and not 1e-3 <= mass <= 1e4:
            found.append(f"the total mass is {mass:.3g} kg with {given}: check the units")
        if frequencies is not None:
            elastic = np.asarray(frequencies)[np.asarray(frequencies) > 1e-3 * np.max(frequencies, initial=0.0)]
            if elastic.size and not 1.0 <= elastic[0] <= 1e5:
                found.append(f"the first elastic frequency is {elastic[0]:.3g} Hz with {given}: check the units")
        return tuple(found)

    def _named(self, mask: np.ndarray, most: int = 4) -> str:
        rows = np.flatnonzero(mask)
        words = ", ".join(shown_label(self.labels, int(row)) for row in rows[:most])
        return words + (", ..." if len(rows) > most else "")


def read_matrices(
    *paths: str | os.PathLike[str],
    units: str | None = None,
    nodes: str | os.PathLike[str] | None = None,
    labels: str | os.PathLike[str] | None = None,
) -> Structure:
    """The structure that these files hold together; a matrix is known by its name in the file, or by the file's.

    Without `units` the numbers stay as they are. Raises `MatrixFileError` with file and line, `ParameterError`.

    >>> read_matrices("no_such_file.mtx")
    Traceback (most recent call last):
    squealbox.fe.readers.matrix.MatrixFileError: no_such_file.mtx: cannot be read: No such file or directory
    """
    files = [open_matrices(path) for path in paths]
    chosen: dict[str, tuple[MatrixFile, FileMatrix]] = {}
    for file in files:
        for matrix in file.matrices:
            if matrix.kind not in (MASS, STIFFNESS, DAMPING, STRUCTURAL) or not matrix.square or matrix.entries == 0:
                continue
            if matrix.kind in chosen:
                raise MatrixFileError(
                    file.path,
                    f"{matrix.name} is a second {matrix.kind} matrix: expected one; name it by read_structure",
                )
            chosen[matrix.kind] = (file, matrix)
    if STIFFNESS not in chosen:
        names = ", ".join(matrix.name for file in files for matrix in file.matrices)[:200]
        raise MatrixFileError(
            Path(paths[0]) if paths else Path(),
            f"no stiffness matrix among {names or 'no files'}: name it by read_structure",
        )
    return _aligned(chosen, units, nodes, labels)


def read_structure(
    *,
    stiffness: Source,
    mass: Source,
    damping: Source | None = None,
    units: str | None,
    nodes: str | os.PathLike[str] | None = None,
    labels: str | os.PathLike[str] | None = None,
) -> Structure:
    """The structure of these files, each named for what it holds, in SI.

    A source is a path, or (path, name) of a matrix in a file of several. `units` is a preset of
    `squealbox.fe.units.UNITS`, such as "mm t s". `nodes` is a CSV (node, x, y, z[, component]) or an input file;
    `labels` a file of labels for matrices without: a mapping vector, .dof or CSV. Raises as `read_matrices` does.
    """
    unit_system(units)
    chosen = {}
    opened: dict[Path, MatrixFile] = {}
    for kind, source in ((STIFFNESS, stiffness), (MASS, mass), (DAMPING, damping)):
        if source is not None:
            chosen[kind] = _chosen(source, kind, opened)
    return _aligned(chosen, units, nodes, labels)


def _chosen(source: Source, kind: str, opened: dict[Path, MatrixFile]) -> tuple[MatrixFile, FileMatrix]:
    path, name = source if isinstance(source, tuple) else (source, None)
    file = opened.setdefault(Path(path), open_matrices(path))
    square = [matrix for matrix in file.matrices if matrix.square]
    named = [matrix for matrix in square if (matrix.name == name if name else matrix.kind == kind)]
    found = named or (square if name is None and len(square) == 1 else [])
    if len(found) != 1:
        names = ", ".join(matrix.name for matrix in file.matrices)[:200]
        raise MatrixFileError(file.path, f"holds {names}: expected one {kind} matrix; name it as (path, name)")
    (matrix,) = found
    if kind == MASS:
        check_mass(file.path, matrix)
    return file, matrix


def _aligned(
    chosen: dict[str, tuple[MatrixFile, FileMatrix]],
    units: str | None,
    nodes: str | os.PathLike[str] | None,
    labels: str | os.PathLike[str] | None,
) -> Structure:
    files = {kind: file for kind, (file, _) in chosen.items()}
    found = {kind: matrix for kind, (_, matrix) in chosen.items()}
    order, places = _common(files, found, labels)
    size = len(order) if order is not None else max(matrix.matrix.shape[0] for matrix in found.values())
    notes = [note for file in dict.fromkeys(files.values()) for note in file.notes if "constrained" not in note]
    for matrix in found.values():
        notes += [f"{matrix.name}: {note}" for note in matrix.notes if "no entry" not in note]
    arrays = {kind: _placed(matrix.matrix, places.get(kind), size) for kind, matrix in found.items()}
    if np.iscomplexobj(arrays[STIFFNESS].data):
        notes.append("the stiffness is complex: its imaginary part, structural damping, is left out")
        arrays[STIFFNESS] = arrays[STIFFNESS].real.tocsr()
    if STRUCTURAL in arrays:
        notes.append(f"{found[STRUCTURAL].name} is structural damping, which is left out: give a viscous one")
    fixed = next((file.constrained for file in files.values() if file.constrained is not None), None)
    if fixed is not None and order is not None:
        keep = ~np.isin(coded(Path(), *order.T), coded(Path(), *fixed.T))
        arrays = {kind: array[keep][:, keep] for kind, array in arrays.items()}
        order, size = order[keep], int(keep.sum())
    from scipy.sparse import csr_array

    none = csr_array((size, size))
    mass, damping, stiffness = (arrays.get(kind, none) for kind in (MASS, DAMPING, STIFFNESS))
    if np.iscomplexobj(mass.data) or np.iscomplexobj(damping.data):
        raise MatrixFileError(files[STIFFNESS].path, "mass or damping is complex: expected real numbers")
    if units is not None:
        system = unit_system(units)
        unit = 1.0 / system.scales(order, size)
        mass, damping, stiffness = (
            _scaled(array, unit, system.energy * system.time**power)
            for array, power in ((mass, 2), (damping, 1), (stiffness, 0))
        )
        if order is None and system.length != 1.0:
            notes.append("no labels: all freedoms are taken as displacements when units are changed")
    digits = min((m.digits for m in found.values() if m.digits), default=None)
    places_of = nodes if nodes is None or isinstance(nodes, Nodes) else read_nodes(nodes, units)
    return Structure(mass, damping, stiffness, order, fixed, units, places_of, digits, tuple(dict.fromkeys(notes)))


def _common(
    files: dict[str, MatrixFile], found: dict[str, FileMatrix], given: str | os.PathLike[str] | None
) -> tuple[Any, dict[str, Any]]:
    """Labels of the rows of all matrices, and where the rows of each go."""
    sizes = {kind: matrix.matrix.shape[0] for kind, matrix in found.items()}
    most = max(sizes.values())
    carried = {kind: matrix.labels for kind, matrix in found.items()}
    if given is not None:
        read = read_labels(given, most)
        carried = {kind: read if labels is None and sizes[kind] == most else labels for kind, labels in carried.items()}
    without = [kind for kind, labels in carried.items() if labels is None]
    if without and len(set(sizes.values())) > 1:
        kind = without[0]
        words = ", ".join(f"{name} {size}" for name, size in sizes.items())
        raise MatrixFileError(
            files[kind].path, f"the matrices have different sizes ({words}) and no labels to align them by"
        )
    if without:
        known = next((labels for labels in carried.values() if labels is not None), None)
        return known, {}
    codes = {kind: coded(files[kind].path, *labels.T) for kind, labels in carried.items()}
    for kind, code in codes.items():
        if len(np.unique(code)) != len(code):
            raise MatrixFileError(files[kind].path, f"the labels of {found[kind].name} name a freedom twice")
    first = codes[STIFFNESS]
    extra = np.setdiff1d(np.concatenate(list(codes.values())), first)
    union = np.concatenate([first, extra])
    order = np.argsort(union)
    places = {kind: order[np.searchsorted(union[order], code)] for kind, code in codes.items()}
    return decoded_labels(union), places


def _placed(matrix: "sparray", places: np.ndarray | None, size: int) -> Any:
    if places is None or (len(places) == size and np.array_equal(places, np.arange(size))):
        return matrix.tocsr()
    from scipy.sparse import csr_array

    whole = matrix.tocoo()
    return csr_array((whole.data, (places[whole.row], places[whole.col])), shape=(size, size))


def _scaled(matrix: "sparray", unit: np.ndarray, factor: float) -> Any:
    scaled = matrix.tocsr().copy()
    rows = np.repeat(np.arange(matrix.shape[0]), np.diff(scaled.indptr))
    scaled.data = scaled.data * (factor * unit[rows] * unit[scaled.indices])
    return scaled


def describe(paths: Iterable[str | os.PathLike[str]], count: int = 6) -> str:
    """What these files hold, as text: format, size, entries, symmetry, labels, digits, doubts, first frequencies."""
    from squealbox.fe.describing import described

    return described(paths, count)

"""Mode shapes in the files that other programs open: VTU (points and displacements) and UFF (datasets 15 and 55)."""

import os
from pathlib import Path
from typing import Any

import numpy as np

from squealbox.extras import extra
from squealbox.fe.structure import Structure
from squealbox.parameters import ParameterError


def displacements(structure: Structure, shapes: np.ndarray) -> tuple[Any, Any, Any]:
    """Node numbers (k,), places (k, 3) [m] and displacements (k, 3, modes) of shapes (n, modes), complex, global axes
    where nodes have no coordinate system of their own; nodes without a freedom are left out.
    """
    if structure.nodes is None or structure.labels is None:
        raise ParameterError("structure", "nodes", None, "nodes = a file of node, x, y, z, to draw mode shapes")
    numbers = structure.nodes.numbers
    where = {int(node): i for i, node in enumerate(numbers)}
    moved = np.zeros((len(numbers), 3, np.shape(shapes)[1]), dtype=complex)
    used = np.zeros(len(numbers), dtype=bool)
    for row, (node, direction) in enumerate(structure.labels):
        if int(node) in where and 1 <= direction <= 3:
            moved[where[int(node)], direction - 1] = shapes[row]
            used[where[int(node)]] = True
    return numbers[used], structure.nodes.places[used], moved[used]


def write_vtu(path: str | os.PathLike[str], structure: Structure, eigenvalues: np.ndarray, shapes: np.ndarray) -> Path:
    """Every mode's real and imaginary displacement at the nodes, as a cloud of points; needs meshio."""
    with extra("fe"):
        import meshio
    _, places, moved = displacements(structure, shapes)
    data = {}
    for i, value in enumerate(eigenvalues):
        name = f"mode {i + 1}, {value.imag / (2.0 * np.pi):.6g} Hz, growth {value.real:+.4g} 1_s"
        data[f"{name}, real"], data[f"{name}, imaginary"] = moved[:, :, i].real, moved[:, :, i].imag
    cells = [("vertex", np.arange(len(places))[:, None])]
    meshio.Mesh(places, cells, point_data=data).write(str(path), file_format="vtu")
    return Path(path)


def write_uff(path: str | os.PathLike[str], structure: Structure, eigenvalues: np.ndarray, shapes: np.ndarray) -> Path:
    """Nodes (dataset 15) and complex modes (dataset 55, with their eigenvalues) of a universal file; needs pyuff."""
    with extra("fe"):
        import pyuff
    numbers, places, moved = displacements(structure, shapes)
    Path(path).unlink(missing_ok=True)
    file = pyuff.UFF(str(path))
    zeros = np.zeros(len(numbers), dtype=int)
    sets: list[dict[str, Any]] = [
        {"type": 15, "node_nums": numbers, "def_cs": zeros, "disp_cs": zeros, "color": zeros}
        | {axis: places[:, i] for i, axis in enumerate("xyz")}
    ]
    for i, value in enumerate(eigenvalues):
        text = {f"id{k}": "NONE" for k in range(1, 6)} | {"id1": f"mode {i + 1}"}
        kind = {"model_type": 1, "analysis_type": 3, "data_ch": 2, "spec_data_type": 8, "data_type": 5}
        sets.append(
            {"type": 55, **text, **kind, "n_data_per_node": 3, "load_case": 1, "mode_n": i + 1}
            | {"eig": complex(value), "modal_a": 1.0 + 0.0j, "modal_b": 1.0 + 0.0j, "node_nums": numbers}
            | {f"r{k + 1}": moved[:, k, i] for k in range(3)}
        )
    file.write_sets(sets, "overwrite")
    return Path(path)

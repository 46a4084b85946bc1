"""Mode shapes of a brake meshed here, for other programs: VTU (extra `fe`, meshio) and universal files (pyuff)."""

import os
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from squealbox.extras import extra
from squealbox.fe.grids import MeshedBody
from squealbox.fe.meshed import MeshedBrake

FORMATS = (".vtu", ".uff")


def write_shape(brake: MeshedBrake, shape: ArrayLike, eigenvalue: complex, path: str | os.PathLike[str]) -> Path:
    """Write one complex mode on the corners of the elements to `path`, which ends in .vtu or .uff.

    Parameters
    ----------
    brake : whose mode it is
    shape : (n,), on all degrees of freedom, as a `Mode` of the brake or `ReducedBrake.expand` gives it
    eigenvalue : [1/s]
    path : a .vtu holds the shape's real and imaginary part and its size as point data, and the body of each element;
        a .uff holds nodes (dataset 15) and the complex mode (dataset 55)

    Raises `ValueError` for another ending or a shape of another size.
    """
    path = Path(path)
    if path.suffix not in FORMATS:
        raise ValueError(f"{path.name}: expected a name that ends in {' or '.join(FORMATS)}")
    made = brake.structure()
    shape = np.asarray(shape, dtype=complex)
    if shape.shape != (made.size,):
        raise ValueError(f"shape has shape {shape.shape}: expected ({made.size},), all degrees of freedom of the brake")
    parts = [_corners(body, values) for body, values in zip(made.bodies, made.by_body(shape), strict=True)]
    places = np.concatenate([place for place, _, _ in parts])
    moved = np.concatenate([values for _, values, _ in parts])
    offsets = np.cumsum([0, *(len(place) for place, _, _ in parts)])
    cells = np.concatenate([cell + offset for (_, _, cell), offset in zip(parts, offsets[:-1], strict=True)])
    bodies = np.concatenate([np.full(len(cell), i) for i, (_, _, cell) in enumerate(parts)])
    if path.suffix == ".vtu":
        with extra("fe"):
            import meshio

        data = {"real": moved.real, "imag": moved.imag, "size": np.linalg.norm(moved, axis=1)}
        mesh = meshio.Mesh(places, [("hexahedron", cells)], point_data=data, cell_data={"body": [bodies]})
        mesh.write(path)
        return path
    _write_universal(path, places, moved, eigenvalue)
    return path


def _corners(body: MeshedBody, values: np.ndarray) -> tuple[Any, Any, Any]:
    """Places (k, 3), displacements (k, 3) and corners of the elements (cells, 8) in the order of VTK."""
    corner, cells = body.corners
    local = np.asarray(body.reference_corners).T.astype(int)
    order = [int(np.flatnonzero((local == at).all(axis=1))[0]) for at in VTK]
    return body.corner_places.T, values[body.freedoms[corner]].T, cells[:, order]


VTK = ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1))


def _write_universal(path: Path, places: np.ndarray, moved: np.ndarray, eigenvalue: complex) -> None:
    with extra("fe"):
        import pyuff

    numbers = np.arange(1, len(places) + 1)
    nodes = {
        "type": 15,
        "node_nums": numbers,
        "x": places[:, 0],
        "y": places[:, 1],
        "z": places[:, 2],
        "def_cs": np.zeros(len(numbers)),
        "disp_cs": np.zeros(len(numbers)),
        "color": np.zeros(len(numbers)),
    }
    mode = pyuff.prepare_55(
        model_type=1,
        id1="complex mode",
        analysis_type=3,
        data_ch=2,
        spec_data_type=8,
        data_type=5,
        r1=moved[:, 0],
        r2=moved[:, 1],
        r3=moved[:, 2],
        n_data_per_node=3,
        node_nums=numbers,
        load_case=1,
        mode_n=1,
        eig=complex(eigenvalue),
        modal_a=1.0 + 0.0j,
        modal_b=1.0 + 0.0j,
    )
    path.unlink(missing_ok=True)
    pyuff.UFF(str(path)).write_sets([nodes, mode], mode="overwrite")

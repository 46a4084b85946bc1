"""Writes the small export that caliper.toml reads: a pad on a disc, as a finite-element code would write its matrices.

Nodes have three displacements and hang on springs of their own, as blocks of rubber would, so nothing here is a real
caliper; it is small enough to be looked at with the eye. Units are mm, t (1000 kg), s, N. Run it in this folder.
"""

from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve().parent
STEP = 20.0  # [mm] between nodes
GRIDS = {"disc": (1, 4, 4, 0.0), "pad": (101, 3, 2, 8.0)}  # first node, columns, rows, height [mm]
MASS = {"disc": 4.0e-5, "pad": 2.5e-5}  # [t] of a node
AXIAL = {"disc": 9.0e3, "pad": 2.5e3}  # [N/mm] between neighbours; a third of it across
GROUND = {"disc": (4.0e3, 4.0e3, 1.2e3), "pad": (1.0e3, 2.0e3, 2.0e3)}  # [N/mm] along x, y, z
TILT = -1.3e3  # [N/mm] couples y and z of the pad, as an abutment that is not square does


def main() -> None:
    """Matrices, nodes and contact pairs."""
    nodes: dict[int, tuple[float, float, float, str]] = {}
    springs: list[tuple[int, int, str]] = []
    for name, (first, columns, rows, height) in GRIDS.items():
        for j in range(rows):
            for i in range(columns):
                node = first + i + columns * j
                nodes[node] = (100.0 + STEP * j, STEP * (i - (columns - 1) / 2), height, name)
                springs += [(node, node - 1, name)] * (i > 0) + [(node, node - columns, name)] * (j > 0)
    order = {node: 3 * k for k, node in enumerate(nodes)}
    stiffness, mass = np.zeros((3 * len(nodes),) * 2), np.zeros(3 * len(nodes))
    for a, b, name in springs:
        along = np.array(nodes[a][:3]) - np.array(nodes[b][:3])
        along /= np.linalg.norm(along)
        block = AXIAL[name] * (2 * np.outer(along, along) + np.eye(3)) / 3
        for row, column, sign in ((a, a, 1), (b, b, 1), (a, b, -1), (b, a, -1)):
            stiffness[order[row] : order[row] + 3, order[column] : order[column] + 3] += sign * block
    for node, (_, _, _, name) in nodes.items():
        at = order[node]
        uneven = 1.0 + 0.02 * (node % 7)  # no two nodes alike, so that no two modes are
        stiffness[range(at, at + 3), range(at, at + 3)] += np.array(GROUND[name]) * uneven
        mass[at : at + 3] = MASS[name] * uneven
        if name == "pad":
            stiffness[at + 1, at + 2] += TILT
            stiffness[at + 2, at + 1] += TILT
    labels = [(node, direction) for node in nodes for direction in (1, 2, 3)]
    write("caliper_MASS1.mtx", labels, np.diag(mass))
    write("caliper_STIF1.mtx", labels, stiffness)
    table = [f"{node}, {x:g}, {y:g}, {z:g}, {name}" for node, (x, y, z, name) in nodes.items()]
    (HERE / "nodes.csv").write_text("\n".join(["node, x, y, z, component", *table, ""]))
    under = [f"{101 + i + 3 * j}, {1 + i + 4 * (j + 1)}, 0, 0, -1, 400" for j in range(2) for i in range(3)]
    (HERE / "pad.csv").write_text("\n".join(["slave, master, nx, ny, nz, area", *under, ""]))


def write(name: str, labels: list[tuple[int, int]], matrix: np.ndarray) -> None:
    """The lower half in the format of *MATRIX OUTPUT, FORMAT=MATRIX INPUT."""
    rows, columns = np.nonzero(np.tril(matrix))
    lines = [
        "{},{}, {},{}, {:.9e}".format(*labels[i], *labels[j], matrix[i, j]) for i, j in zip(rows, columns, strict=True)
    ]
    (HERE / name).write_text("\n".join([*lines, ""]))


if __name__ == "__main__":
    main()

"""Small sparse brakes made here, with what an export of finite elements has: nodes of three freedoms, contacts."""

from pathlib import Path

import numpy as np
from scipy import sparse

from squealbox import Coulomb, System
from squealbox.contacts import Contacts

PUBLISHED = Path(__file__).resolve().parents[2] / "shared" / "data" / "brake_4669"


def line_of_springs(count: int):
    """A chain of `count` nodes with springs of 1 N/m between neighbours."""
    across = sparse.diags_array(
        [-np.ones(count - 1), np.ones(count)[: count - 1]], offsets=[0, 1], shape=(count - 1, count)
    )
    return across.T @ across


def plate(rows: int, columns: int, seed: int = 1):
    """M and K of a grid of nodes on a soft ground, three coupled freedoms each; masses and springs vary by node."""
    rng = np.random.default_rng(seed)
    flat = sparse.kron(line_of_springs(rows), sparse.eye_array(columns))
    flat = flat + sparse.kron(sparse.eye_array(rows), line_of_springs(columns))
    coupled = np.array([[4.0, 0.6, 0.4], [0.6, 3.0, 0.5], [0.4, 0.5, 2.0]]) * 1e6
    nodes = rows * columns
    stiffness = sparse.kron(flat, coupled) + sparse.diags_array(rng.uniform(0.5e6, 1.5e6, 3 * nodes))
    mass = sparse.diags_array(np.repeat(rng.uniform(0.8e-3, 1.2e-3, nodes), 3))
    return sparse.csr_array(mass), sparse.csr_array(stiffness)


def pad_brake(
    rows: int = 8, columns: int = 10, friction=None, *, across: bool = True, unilateral: bool = False, seed: int = 1
) -> System:
    """A plate that slides on every second node: normal z, sliding x, across y; stiffness-proportional damping."""
    mass, stiffness = plate(rows, columns, seed)
    size = mass.shape[0]
    touching = np.arange(0, rows * columns, 2)
    count = len(touching)
    rng = np.random.default_rng(seed + 100)

    def unit(direction: int):
        return sparse.csr_array((np.ones(count), (np.arange(count), 3 * touching + direction)), shape=(count, size))

    spring = 2.0e6 * rng.uniform(0.5, 1.5, count)
    normal = sparse.csr_array(sparse.diags_array(spring) @ unit(2))
    stiffness = sparse.csr_array(stiffness + unit(2).T @ normal)
    table = Contacts(
        n=normal,
        d=unit(0),
        t=unit(0),
        N0=rng.uniform(-5.0, 20.0, count) if unilateral else rng.uniform(5.0, 20.0, count),
        V=rng.uniform(0.5, 2.0, count),
        law=friction or Coulomb(0.6),
        unilateral=unilateral,
        normal=unit(2),
        across=unit(1) if across else None,
    )
    return System(mass, 1e-7 * stiffness, stiffness, rng.standard_normal(size), table)


def dense(system: System) -> System:
    """The same system with dense matrices and single contacts."""
    matrices = (matrix.toarray() for matrix in (system.M, system.C, system.K))
    return System(*matrices, system.load, system.contacts.dense(), system.names)

"""The sparse matrices of one linearised brake, Q(lambda) = lambda^2 M + lambda C + K, beside its elastic part K0."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy import sparse

from squealbox.sparse_sliding import Start, damping_across, friction_stiffness
from squealbox.system import InvalidSystem, Linearised, System, linearise

MOST_DAMPED = 0.1  # damping ratio above which a pair is no candidate for squeal and is not shown


@dataclass(frozen=True)
class Sliding:
    """A system and what its contacts add about steady sliding, each (contacts,): mu sgn V of closed ones, 1 where one
    has lifted off, N mu' along the sliding direction and mu N / |V| across it.
    """

    system: System
    coupling: Any
    lifted: Any
    along: Any
    across: Any


@dataclass(frozen=True)
class Pencil:
    """M, C_eff, K_eff, all (n, n) sparse, and elastic: K0, symmetric, without friction and without open contacts.

    across is the damping of friction across the sliding direction, which is a part of C_eff. about is the linearised
    system behind it and sliding what its contacts add, None where bare matrices were given.
    """

    M: Any
    C: Any
    K: Any
    elastic: Any
    across: Any = None
    about: Linearised | None = None
    sliding: Sliding | None = None

    @property
    def structural(self) -> tuple[Any, Any, Any]:
        """M, C and K that `sliding` adds to: those of the system, or the bare matrices themselves."""
        if self.sliding is None:
            return self.M, self.C, self.K
        return self.sliding.system.M, self.sliding.system.C, self.sliding.system.K

    @property
    def size(self) -> int:
        """Number of degrees of freedom."""
        return int(self.M.shape[0])

    def at(self, value: complex) -> Any:
        """Q(lambda), sparse and complex."""
        return sparse.csc_array(value**2 * self.M + value * self.C + self.K)

    def residual(self, values: Any, shapes: Any) -> Any:
        """Q(lambda_k) u_k for each column u_k of `shapes` (n, k)."""
        return self.K @ shapes + (self.C @ shapes) * values + (self.M @ shapes) * values**2

    def left_residual(self, values: Any, shapes: Any) -> Any:
        """Q(lambda_k)^H w_k for each column w_k of `shapes` (n, k)."""
        back = np.conj(values)
        return self.K.T @ shapes + (self.C.T @ shapes) * back + (self.M @ shapes) * back**2

    def backward_error(self, values: Any, shapes: Any) -> Any:
        """|Q(lambda) u| / ((|lambda|^2 |M| + |lambda| |C| + |K|) |u|) of each mode, norms by the largest row sum."""
        sizes = [float(abs(matrix).sum(axis=1).max()) for matrix in (self.M, self.C, self.K)]
        scale = np.abs(values) ** 2 * sizes[0] + np.abs(values) * sizes[1] + sizes[2]
        missed = np.linalg.norm(self.residual(values, shapes), axis=0)
        return missed / (scale * np.linalg.norm(shapes, axis=0))


def pencil_of(system: System, time: float = 0.0, about: Linearised | None = None, start: Start | None = None) -> Pencil:
    """The matrices of a sparse system about steady sliding at `time` [s], or as they were linearised before.

    `start` is steady sliding of a similar brake, from which the search for this one's begins. Raises `InvalidSystem`
    where there is no steady sliding, with the reason.
    """
    about = linearise(system, time, start) if about is None else about
    state = about.equilibrium
    if not state.exists:
        raise InvalidSystem(f"no steady sliding to linearise about: {state.outcome} ({state.outcome.message})")
    table = system.contacts
    closed = (state.normal_force > 0.0) | ~table.unilateral
    coupling = np.where(closed, state.friction * np.sign(state.sliding_speed), 0.0)
    stiffness = about.K + friction_stiffness(table, coupling)
    pressing = np.where(closed, state.normal_force, 0.0)
    turning = pressing * state.friction / np.abs(state.sliding_speed)
    _, slope = table.friction(state.sliding_speed)
    sliding = Sliding(system, coupling, np.where(closed, 0.0, 1.0), pressing * slope, turning)
    return Pencil(about.M, about.C, about.K, symmetric_part(stiffness), damping_across(table, turning), about, sliding)


def symmetric_part(matrix: Any) -> Any:
    """1/2 (A + A')."""
    return sparse.csr_array(0.5 * (matrix + matrix.T))


def vibrating(values: Any) -> Any:
    """True for eigenvalues with Im > 0 whose damping ratio is below 0.1 in size."""
    return (values.imag > 0.0) & (np.abs(values.real) < MOST_DAMPED * np.abs(values))

"""The sparse matrices of one linearised brake, Q(lambda) = lambda^2 M + lambda C + K, beside its elastic part K0."""

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy import sparse

from squealbox.loops import near_sliding
from squealbox.memory_rows import no_memory
from squealbox.sparse_sliding import Nearby, damping_across, damping_along, stiffness_of
from squealbox.system import Equilibrium, InvalidSystem, System, equilibrium

if TYPE_CHECKING:
    from scipy.sparse import sparray

MOST_DAMPED = 0.1  # damping ratio above which a pair is no candidate for squeal and is not shown


@dataclass(frozen=True)
class Sliding:
    """A system and what its contacts add about steady sliding, each (contacts,): mu sgn V of closed ones, 1 where one
    has lifted off, N mu' along the sliding direction and mu N / |V| across it; pushed is N0 + n . q, below 0 at a gap.
    """

    system: System
    pushed: Any
    coupling: Any
    lifted: Any
    along: Any
    across: Any


class Pencil:
    """M, C_eff, K_eff, all (n, n) sparse, and elastic: K0, symmetric, without friction and without open contacts."""

    sliding: Sliding | None = None

    def __init__(self, M: "sparray", C: "sparray", K: "sparray", elastic: "sparray") -> None:
        self.M, self.C, self.K, self.elastic = M, C, K, elastic

    @property
    def structural(self) -> tuple[Any, Any, Any]:
        """M, C and K that contacts add to; of bare matrices these themselves."""
        return self.M, self.C, self.K

    @property
    def size(self) -> int:
        """Number of degrees of freedom."""
        return int(self.M.shape[0])

    def at(self, value: complex) -> Any:
        """Q(lambda), sparse and complex."""
        return sparse.csc_array(value**2 * self.M + value * self.C + self.K)

    def stiffness_on(self, shapes: np.ndarray) -> tuple[Any, Any]:
        """K_eff V and K_eff' V of columns V (n, k)."""
        return self.K @ shapes, self.K.T @ shapes

    def damping_on(self, shapes: np.ndarray) -> Any:
        """C_eff V of columns V (n, k)."""
        return self.C @ shapes

    def residual(self, values: complex | np.ndarray, shapes: np.ndarray) -> Any:
        """Q(lambda_k) u_k for each column u_k of `shapes` (n, k)."""
        return self.K @ shapes + (self.C @ shapes) * values + (self.M @ shapes) * values**2

    def backward_error(self, values: np.ndarray, shapes: np.ndarray) -> Any:
        """|Q(lambda) u| / ((|lambda|^2 |M| + |lambda| |C| + |K|) |u|) of each mode, norms by the largest row sum."""
        sizes = [float(abs(matrix).sum(axis=1).max()) for matrix in (self.M, self.C, self.K)]
        scale = np.abs(values) ** 2 * sizes[0] + np.abs(values) * sizes[1] + sizes[2]
        missed = np.linalg.norm(self.residual(values, shapes), axis=0)
        return missed / (scale * np.linalg.norm(shapes, axis=0))


class SlidingPencil(Pencil):
    """The matrices of a system about steady sliding; C_eff, K_eff and K0 are summed up when one is asked for.

    state is steady sliding and sliding what its contacts add.
    """

    sliding: Sliding

    def __init__(self, sliding: Sliding, state: Equilibrium) -> None:
        self.sliding, self.state, self.M = sliding, state, sliding.system.M

    @property
    def structural(self) -> tuple[Any, Any, Any]:
        return self.sliding.system.M, self.sliding.system.C, self.sliding.system.K

    @cached_property
    def C(self) -> Any:
        """C + D' diag(N mu') T + A' diag(mu N / |V|) A."""
        table, along = self.sliding.system.contacts, self.sliding.along
        found = self.sliding.system.C + damping_across(table, self.sliding.across)
        return sparse.csr_array(found + damping_along(table, along) if np.any(along) else found)

    @cached_property
    def K(self) -> Any:
        """K - D' diag(mu sgn V) N - R' diag(open) N."""
        closed = self.sliding.lifted == 0.0
        return stiffness_of(self.sliding.system.K, self.sliding.system.contacts, self.sliding.coupling, closed)

    @cached_property
    def elastic(self) -> Any:
        """The symmetric part of K - R' diag(open) N."""
        lifted, system = self.sliding.lifted, self.sliding.system
        return symmetric_part(stiffness_of(system.K, system.contacts, 0.0 * lifted, lifted == 0.0))

    def stiffness_on(self, shapes: np.ndarray) -> tuple[Any, Any]:
        system, coupling, lifted = self.sliding.system, self.sliding.coupling[:, None], self.sliding.lifted[:, None]
        table = system.contacts
        felt = table.n @ shapes
        right = system.K @ shapes - table.d.T @ (coupling * felt)
        weight = coupling * (table.d @ shapes)
        if table.normal is not None:
            right -= table.normal.T @ (lifted * felt)
            weight = weight + lifted * (table.normal @ shapes)
        return right, system.K.T @ shapes - table.n.T @ weight

    def damping_on(self, shapes: np.ndarray) -> Any:
        table = self.sliding.system.contacts
        found = self.sliding.system.C @ shapes + table.d.T @ (self.sliding.along[:, None] * (table.t @ shapes))
        if table.across is not None:
            found += table.across.T @ (self.sliding.across[:, None] * (table.across @ shapes))
        return found


def pencil_of(
    system: System, time: float = 0.0, state: Equilibrium | None = None, start: Nearby | None = None
) -> SlidingPencil:
    """The matrices of a sparse system about steady sliding at `time` [s], or about a `state` that is known.

    `start` is steady sliding of a similar brake, from which the search for this one's begins. Raises `InvalidSystem`
    where there is no steady sliding, with the reason.
    """
    system = near_sliding(system)
    state = equilibrium(system, time, start) if state is None else state
    if not state.exists:
        raise InvalidSystem(f"no steady sliding to linearise about: {state.outcome} ({state.outcome.message})")
    table = system.contacts
    no_memory(table, "a sparse system")
    closed = (state.normal_force > 0.0) | ~table.unilateral
    coupling = np.where(closed, state.friction * np.sign(state.sliding_speed), 0.0)
    pressing = np.where(closed, state.normal_force, 0.0)
    turning = pressing * state.friction / np.abs(state.sliding_speed)
    _, slope = table.friction(state.sliding_speed)
    pushed = table.at("N0", time) + table.n @ state.q
    sliding = Sliding(system, pushed, coupling, np.where(closed, 0.0, 1.0), pressing * slope, turning)
    return SlidingPencil(sliding, state)


def symmetric_part(matrix: "sparray") -> Any:
    """1/2 (A + A')."""
    return sparse.csr_array(0.5 * (matrix + matrix.T))


def vibrating(values: np.ndarray) -> Any:
    """True for eigenvalues with Im > 0 whose damping ratio is below 0.1 in size."""
    return (values.imag > 0.0) & (np.abs(values.real) < MOST_DAMPED * np.abs(values))

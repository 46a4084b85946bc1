"""Steady sliding and its linearisation with sparse matrices: no dense matrix, no loop over contacts.

With the rows of all contacts as tables N, D, T, A (across) and R (normal reaction), steady sliding solves

    K q - f - D' diag(mu sgn V) N+ - R' min(N0 + N q, 0) = 0        N+ = max(N0 + N q, 0) where unilateral

by Newton steps, each of which changes the set of open contacts. The matrix K with every contact closed is factored
once; a step is solved by GMRES with that factor as preconditioner, because the set of open contacts and friction change
K by rows of the contacts alone. Where this does not settle, the matrix of the step is factored itself.
"""

from typing import Any, NamedTuple

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import LinearOperator, gmres

from squealbox.contacts import Contacts
from squealbox.factorisation import Factor, SingularMatrix, factor

STEP = 1e-12  # size of a step, relative to the displacement, at which the set of open contacts has settled
ROUGH, FINE = 1e-4, 1e-11  # residual of a step solved by GMRES: while the set of open contacts changes, and the last
KRYLOV = 200  # vectors GMRES may keep; more, and a factorisation is the quicker way


class Start(NamedTuple):
    """Steady sliding q (n,) of a similar brake and the factor of a similar stiffness, to begin a search with."""

    q: Any
    base: Factor


class SlidingState(NamedTuple):
    """Displacement q (n,), the contacts' N, V and mu (contacts,), and how the search ended."""

    q: Any
    normal: Any
    speed: Any
    mu: Any
    singular: bool
    settled: bool


def sliding_state(
    stiffness: Any, load: Any, contacts: Contacts, time: float, start: Start | None = None
) -> SlidingState:
    """Steady sliding at `time` [s], looked for from that of a similar brake where it is known."""
    speed, preload = contacts.at("V", time), contacts.at("N0", time)
    mu, _ = contacts.friction(speed)
    q = np.zeros(stiffness.shape[0]) if start is None else start.q
    closed = np.ones(len(contacts), dtype=bool)
    base = _factored(stiffness) if start is None else start.base
    exactly = not np.any(contacts.unilateral)
    for _ in range(3 + 2 * len(contacts)):
        normal = preload + contacts.n @ q
        closed = (normal > 0.0) | ~contacts.unilateral
        residual = stiffness @ q - load - contacts.d.T @ (np.where(closed, mu * np.sign(speed), 0.0) * normal)
        if contacts.normal is not None:
            residual -= contacts.normal.T @ np.where(closed, 0.0, normal)
        if np.linalg.norm(residual) == 0.0:
            return SlidingState(q, _pressing(normal, closed), speed, mu, False, True)
        try:
            jacobian = stiffness_of(stiffness, contacts, mu * np.sign(speed), closed)
            step = _step(base, jacobian, residual, FINE if exactly else ROUGH)
        except SingularMatrix:
            return SlidingState(q, _pressing(normal, closed), speed, mu, True, False)
        q = q - step
        after = preload + contacts.n @ q
        same = np.array_equal((after > 0.0) | ~contacts.unilateral, closed)
        if same and (exactly or np.linalg.norm(step) <= STEP * np.linalg.norm(q)):
            return SlidingState(q, _pressing(after, closed), speed, mu, False, True)
        exactly = same  # the last step, with the set it has settled on
    return SlidingState(q, _pressing(preload + contacts.n @ q, closed), speed, mu, False, False)


def _factored(stiffness: Any) -> Factor | None:
    try:
        return factor(stiffness)
    except SingularMatrix:
        return None


def _pressing(normal: Any, closed: Any) -> Any:
    return np.where(closed, normal, 0.0)


def _step(base: Factor | None, jacobian: Any, residual: Any, accuracy: float) -> Any:
    if base is not None:
        nearly_one = LinearOperator(jacobian.shape, matvec=lambda y: jacobian @ base.solve(y), dtype=float)
        found, missed = gmres(nearly_one, residual, rtol=accuracy, atol=0.0, restart=KRYLOV, maxiter=1)
        step = base.solve(found)
        if missed == 0 and np.linalg.norm(jacobian @ step - residual) <= 10.0 * accuracy * np.linalg.norm(residual):
            return step
    return factor(jacobian).solve(residual)


def linearised(damping: Any, stiffness: Any, contacts: Contacts, state: Any) -> tuple[Any, Any]:
    """C_eff and K_eff (n, n) about an `Equilibrium`."""
    closed = (state.normal_force > 0.0) | ~contacts.unilateral
    _, slope = contacts.friction(state.sliding_speed)
    pressing = np.where(closed, state.normal_force, 0.0)
    found = damping + damping_along(contacts, pressing * slope)
    found = found + damping_across(contacts, pressing * state.friction / np.abs(state.sliding_speed))
    coupling = state.friction * np.sign(state.sliding_speed)
    return sparse.csr_array(found), stiffness_of(stiffness, contacts, coupling, closed)


def stiffness_of(stiffness: Any, contacts: Contacts, coupling: Any, closed: Any) -> Any:
    """K less D' diag(mu sgn V) N of the closed contacts, and less R' N of the open ones."""
    found = stiffness - contacts.d.T @ _scaled(contacts.n, np.where(closed, coupling, 0.0))
    if contacts.normal is not None and not np.all(closed):
        found = found - contacts.normal.T @ _scaled(contacts.n, np.where(closed, 0.0, 1.0))
    return sparse.csr_array(found)


def friction_stiffness(contacts: Contacts, coupling: Any) -> Any:
    """D' diag(mu sgn V) N: what friction takes from the stiffness."""
    return sparse.csr_array(contacts.d.T @ _scaled(contacts.n, coupling))


def damping_along(contacts: Contacts, weight: Any) -> Any:
    """D' diag(N mu'(V)) T: what a slope of friction adds to the damping."""
    return sparse.csr_array(contacts.d.T @ _scaled(contacts.t, weight))


def damping_across(contacts: Contacts, weight: Any) -> Any:
    """A' diag(mu N / |V|) A: what friction that turns with the relative velocity adds to the damping."""
    if contacts.across is None:
        return sparse.csr_array((contacts.n.shape[1],) * 2)
    return sparse.csr_array(contacts.across.T @ _scaled(contacts.across, weight))


def _scaled(rows: Any, factors: Any) -> Any:
    return sparse.diags_array(factors) @ rows

"""Steady sliding and its linearisation with sparse matrices: no dense matrix, no loop over contacts.

With the rows of all contacts as tables N, D, T, A (across) and R (normal reaction), steady sliding solves

    K q - f - D' diag(mu sgn V) N+ - R' min(N0 + N q, 0) = 0        N+ = max(N0 + N q, 0) where unilateral

by Newton steps, each of which changes the set of open contacts. The matrix K with every contact closed is factored
once; a step is solved by generalised conjugate residuals with that factor as preconditioner, because the set of open
contacts and friction change K by rows of the contacts alone. Directions tried in one step are tried first in the next.
Where this does not settle, the matrix of the step is factored itself.
"""

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import scipy

from squealbox.contacts import Contacts
from squealbox.factorisation import Factor, SingularMatrix, factor
from squealbox.matrices import Equilibrium

if TYPE_CHECKING:
    from scipy.sparse import sparray

ROUGH, FINE = 1e-2, 1e-11  # of a step's residual: what is left of it while the set of open contacts changes, and after
FAIR = 1e-7  # what a fine step leaves at most, however close to balance it begins
LAST = 1e-6  # size of a fine step, relative to the displacement, after which no other is needed
BALANCED = 1e-10  # of the forces that act: what is left of them in balance
ASTRAY = 1e-3  # of these: what is left where round-off of a stiff brake lets nothing smaller be reached
EXACT_STEPS = 60  # of a search that factors every step
ROUGH_STEPS = 100  # of one that does not; those that settle take some ten
ROOM = 16  # directions for which memory is taken at a time
DIRECTIONS = 100  # that a step may try; more, and a factorisation is the quicker way
DEPENDENT = 1e-8  # share of the largest square length below which a remembered direction is no new one


class Nearby(NamedTuple):
    """Steady sliding q (n,) of a similar brake and the factor of a similar stiffness, to begin a search with.

    base is None where that stiffness is singular.
    """

    q: Any
    base: Factor | None


class SlidingState(NamedTuple):
    """Displacement q (n,), the contacts' N, V and mu (contacts,), and how the search ended."""

    q: Any
    normal: Any
    speed: Any
    mu: Any
    singular: bool
    settled: bool


def sliding_state(
    stiffness: "sparray", load: np.ndarray, contacts: Contacts, time: float, start: Nearby | None = None
) -> SlidingState:
    """Steady sliding at `time` [s], looked for from that of a similar brake where it is known.

    Where rough steps lead astray, as they may where the brake is all but rigid, exact ones begin anew.
    """
    begin, base = at_rest(stiffness) if start is None else start
    steps = min(3 + 2 * len(contacts), ROUGH_STEPS)
    found = _search(_Steps(stiffness, contacts, base), begin, load, time, steps)
    if not found.settled and base is not None and np.any(contacts.unilateral):
        exact = _Steps(stiffness, contacts, None)
        found = _search(exact, np.zeros(stiffness.shape[0]), load, time, min(steps, EXACT_STEPS))
    return found


def _search(steps: "_Steps", q: np.ndarray, load: np.ndarray, time: float, most: int) -> SlidingState:
    stiffness, contacts = steps.stiffness, steps.contacts
    speed, preload = contacts.at("V", time), contacts.at("N0", time)
    mu, _ = contacts.friction(speed)
    acting = float(np.linalg.norm(load) + np.linalg.norm(contacts.d.T @ (mu * preload)))
    exactly, step = not np.any(contacts.unilateral), None
    normal = preload + contacts.n @ q
    closed = (normal >= 0.0) | (not np.any(q))  # at rest all is held at first, or nothing might hold the brake
    for made in range(most):
        before, closed = closed, ((normal > 0.0) if made else closed) | ~contacts.unilateral
        drag = np.where(closed, mu * np.sign(speed), 0.0)
        residual = stiffness @ q - load - contacts.d.T @ (drag * normal)
        if contacts.normal is not None:
            residual -= contacts.normal.T @ np.where(closed, 0.0, normal)
        size = float(np.linalg.norm(residual))
        acting = acting if made else max(acting, size)
        same = step is not None and np.array_equal(before, closed)
        small = step is not None and float(np.linalg.norm(step)) <= LAST * float(np.linalg.norm(q))
        if size == 0.0 or (same and exactly and size <= (ASTRAY if small else BALANCED) * acting):
            return SlidingState(q, _pressing(normal, closed), speed, mu, False, True)
        exactly = same or not np.any(contacts.unilateral)
        try:
            enough = np.clip(0.1 * BALANCED * acting / size, FINE, FAIR)
            step = steps.solved(drag, closed, residual, enough if exactly else ROUGH)
        except SingularMatrix:
            return SlidingState(q, _pressing(normal, closed), speed, mu, True, False)
        q = q - step
        normal = preload + contacts.n @ q
    return SlidingState(q, _pressing(normal, closed), speed, mu, False, False)


def at_rest(stiffness: "sparray") -> Nearby:
    """No displacement, and the factor of the stiffness with every contact closed."""
    try:
        return Nearby(np.zeros(stiffness.shape[0]), factor(stiffness))
    except SingularMatrix:
        return Nearby(np.zeros(stiffness.shape[0]), None)


def _pressing(normal: np.ndarray, closed: np.ndarray) -> Any:
    return np.where(closed, normal, 0.0)


class _Steps:
    """Newton's steps J y = r of one search, J = K - D' diag(drag) N - R' diag(open) N, never formed.

    Every direction z = B^-1 r that was tried is kept with K z and N z: for other contacts J z is had from these.
    """

    def __init__(self, stiffness: "sparray", contacts: Contacts, base: Factor | None) -> None:
        self.stiffness, self.contacts, self.base = stiffness, contacts, base
        self.tried: list[tuple[Any, Any, Any]] = []

    def solved(self, drag: np.ndarray, closed: np.ndarray, residual: np.ndarray, accuracy: float) -> Any:
        found = None if self.base is None else self._iterated(self.base, drag, closed, residual, accuracy)
        if found is not None:
            return found
        self.base = None  # it will not settle at the next step either
        return factor(stiffness_of(self.stiffness, self.contacts, drag, closed)).solve(residual)

    def _iterated(
        self, base: Factor, drag: np.ndarray, closed: np.ndarray, residual: np.ndarray, accuracy: float
    ) -> Any:
        """By conjugate residuals; None where they do not become small."""
        small = accuracy * np.linalg.norm(residual)
        known, images = self._remembered(drag, closed)
        count = known.shape[1]
        room = [np.asfortranarray(known), np.asfortranarray(images)]
        part = images.T @ residual
        step, left = known @ part, residual - images @ part
        for made in range(count, count + DIRECTIONS):
            if np.linalg.norm(left) <= small:
                return step
            if made == room[0].shape[1]:
                room = [np.pad(part, ((0, 0), (0, ROOM))) for part in room]
            z = base.solve(left)
            self.tried.append((z, self.stiffness @ z, self.contacts.n @ z))
            image = self._image(*self.tried[-1][1:], drag, closed)
            length = np.linalg.norm(image)
            for _ in range(2):
                part = room[1][:, :made].T @ image
                image, z = image - room[1][:, :made] @ part, z - room[0][:, :made] @ part
            rest = np.linalg.norm(image)
            if not rest > 1e-12 * length:
                return None
            room[0][:, made], room[1][:, made] = z / rest, image / rest
            share = float(room[1][:, made] @ left)
            step, left = step + share * room[0][:, made], left - share * room[1][:, made]
        return None

    def _remembered(self, drag: np.ndarray, closed: np.ndarray) -> tuple[Any, Any]:
        """Combinations of the directions tried before, whose images J z are orthonormal, and those images."""
        if not self.tried:
            return np.zeros((self.stiffness.shape[0], 0)), np.zeros((self.stiffness.shape[0], 0))
        z, pushed, felt = (np.stack(columns, axis=1) for columns in zip(*self.tried, strict=True))
        images = self._image(pushed, felt, drag[:, None], closed[:, None])
        lengths = np.linalg.norm(images, axis=0)
        gram = images.T @ images / (lengths[:, None] * lengths)
        values, turns = np.linalg.eigh(gram)
        keep = values > DEPENDENT * values[-1]
        turns = turns[:, keep] / np.sqrt(values[keep]) / lengths[:, None]
        return z @ turns, images @ turns

    def _image(self, pushed: np.ndarray, felt: np.ndarray, drag: np.ndarray, closed: np.ndarray) -> Any:
        found = pushed - self.contacts.d.T @ (drag * felt)
        if self.contacts.normal is not None and not np.all(closed):
            found -= self.contacts.normal.T @ np.where(closed, 0.0, felt)
        return found


def linearised(damping: "sparray", stiffness: "sparray", contacts: Contacts, state: Equilibrium) -> tuple[Any, Any]:
    """C_eff and K_eff (n, n) about an `Equilibrium`."""
    closed = (state.normal_force > 0.0) | ~contacts.unilateral
    _, slope = contacts.friction(state.sliding_speed)
    pressing = np.where(closed, state.normal_force, 0.0)
    found = damping + damping_along(contacts, pressing * slope)
    found = found + damping_across(contacts, pressing * state.friction / np.abs(state.sliding_speed))
    coupling = state.friction * np.sign(state.sliding_speed)
    return scipy.sparse.csr_array(found), stiffness_of(stiffness, contacts, coupling, closed)


def stiffness_of(stiffness: "sparray", contacts: Contacts, coupling: np.ndarray, closed: np.ndarray) -> Any:
    """K less D' diag(mu sgn V) N of the closed contacts, and less R' N of the open ones."""
    found, sliding = stiffness, np.where(closed, coupling, 0.0)
    if np.any(sliding):
        found = found - contacts.d.T @ _scaled(contacts.n, sliding)
    if contacts.normal is not None and not np.all(closed):
        found = found - contacts.normal.T @ _scaled(contacts.n, np.where(closed, 0.0, 1.0))
    return scipy.sparse.csr_array(found)


def damping_along(contacts: Contacts, weight: np.ndarray) -> Any:
    """D' diag(N mu'(V)) T: what a slope of friction adds to the damping."""
    return scipy.sparse.csr_array(contacts.d.T @ _scaled(contacts.t, weight))


def damping_across(contacts: Contacts, weight: np.ndarray) -> Any:
    """A' diag(mu N / |V|) A: what friction that turns with the relative velocity adds to the damping."""
    if contacts.across is None:
        return scipy.sparse.csr_array((contacts.n.shape[1],) * 2)
    return scipy.sparse.csr_array(contacts.across.T @ _scaled(contacts.across, weight))


def _scaled(rows: "sparray", factors: np.ndarray) -> Any:
    return scipy.sparse.diags_array(factors) @ rows

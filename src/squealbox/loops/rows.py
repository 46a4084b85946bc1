"""What a loop is in the equation: its rows A, E, F, G, P, R, S, and these as rows of M, C and K.

A state z becomes a degree of freedom without mass, which every analysis takes. A delay is such rows too, to round-off:
what is under way, at Chebyshev points of it (Breda, Maset and Vermiglio 2005, SIAM J. Sci. Comput. 27, 482-495).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from squealbox.parameters import ParameterError

LEAST_POINTS, MOST_POINTS = 12, 72  # of a delay written as rows
LONGEST = 60.0  # radians of the brake's own motion in a delay that is written as rows
SHORTEST = 1e-7  # of such a radian: what a delay of 0 among others counts as


@dataclass(frozen=True)
class Rows:
    """The matrices of one loop; P, R, b (..., n), E, F (..., m, n), A (..., m, m), G, S (..., m).

    size (..., m) is the force a unit of each state makes, where that is known.
    """

    A: Any
    E: Any
    F: Any
    G: Any
    P: Any
    R: Any
    S: Any
    b: Any
    size: Any = None

    @property
    def memory(self) -> int:
        """Number m of states."""
        return int(np.shape(self.S)[-1])


def driven(own: Rows, rate: Any) -> Rows:
    """What a loop remembers while its command comes from outside; its own force is not among the rows."""
    n, row = own.b.size, own if rate is None else lagging(own, rate)
    A, S = np.array(row.A), np.zeros(row.memory)
    if rate is not None:
        A[-1, :-1], S[-1] = 0.0, 1.0
        A[:, -1] += row.G
    E, F = np.array(row.E), np.array(row.F)
    E[own.memory :], F[own.memory :] = 0.0, 0.0
    none = np.zeros(n)
    return Rows(A, E, F, np.zeros(row.memory), none, none, S, own.b)


def lagging(own: Rows, rate: Any) -> Rows:
    """Controller and first-order actuator, f' = rate (command - f), u = f."""
    m, n = own.memory, own.b.size
    vectors = (np.shape(row)[:-1] for row in (own.P, own.R, own.S))
    lead = np.broadcast_shapes(np.shape(rate), *vectors, np.shape(own.A)[:-2])
    A, E, F = np.zeros((*lead, m + 1, m + 1)), np.zeros((*lead, m + 1, n)), np.zeros((*lead, m + 1, n))
    G, S = np.zeros((*lead, m + 1)), np.zeros((*lead, m + 1))
    A[..., :m, :m], E[..., :m, :], F[..., :m, :], G[..., :m] = own.A, own.E, own.F, own.G
    A[..., m, :m], A[..., m, m], S[..., m] = rate[..., None] * own.S, -rate, 1.0
    E[..., m, :], F[..., m, :] = rate[..., None] * own.P, rate[..., None] * own.R
    return Rows(A, E, F, G, np.zeros(n), np.zeros(n), S, own.b)


def delayed(own: Rows, delay: float | np.ndarray, rate: float | np.ndarray, lag: Any = None) -> tuple[Rows, Any]:
    """What a loop and its delay remember while the command u comes from outside, and the row (..., m) of its force.

    The command is P q + R q' + S z; under way, w' = (2/T)(D w + D_0 u) at Chebyshev points, then an actuator that lags.
    """
    angle = float(np.max(rate * delay))
    if angle > LONGEST:
        expected = (
            f"delays of at most {LONGEST:g} radians of the brake's motion; closed_loop() gives the poles of longer"
        )
        raise ParameterError("system", "loops", f"a delay of {float(np.max(delay)):g} s", expected)
    order = int(min(LEAST_POINTS + np.ceil(1.2 * angle), MOST_POINTS))
    speed = np.asarray(2.0 / np.maximum(delay, SHORTEST / rate))
    _, D = chebyshev(order)
    m, n, more = own.memory, own.b.size, order + (lag is not None)
    vectors = (np.shape(row)[:-1] for row in (own.P, own.R, own.S))
    lead = np.broadcast_shapes(np.shape(speed), np.shape(lag), *vectors, np.shape(own.A)[:-2])
    A, E, F = (np.zeros((*lead, m + more, width)) for width in (m + more, n, n))
    G, S, force, size = (np.zeros((*lead, m + more)) for _ in range(4))
    w = slice(m, m + order)
    A[..., :m, :m], E[..., :m, :], F[..., :m, :], S[..., :m] = own.A, own.E, own.F, own.S
    A[..., w, w], G[..., w] = speed[..., None, None] * D[1:, 1:], speed[..., None] * D[1:, 0]
    if lag is not None:
        A[..., -1, -2], A[..., -1, -1] = lag, -np.asarray(lag)
    A[..., :m, -1] = own.G  # a controller feels the force the actuator really has
    force[..., -1], size[..., m:], size[..., :m] = 1.0, 1.0, force_per_state(own, rate)
    return Rows(A, E, F, G, own.P, own.R, S, own.b, size), force


def late(own: Rows, delay: np.ndarray, rate: np.float64 | np.ndarray) -> Rows:
    """Rows whose force is late: those of `delayed` with the command of the rows themselves."""
    row, force = delayed(own, delay, rate)
    A = row.A + row.G[..., :, None] * row.S[..., None, :]
    E, F = (row.G[..., :, None] * np.asarray(x)[..., None, :] + y for x, y in ((own.P, row.E), (own.R, row.F)))
    none = np.zeros(own.b.size)
    return Rows(A, E, F, 0.0 * row.G, none, none, force, own.b, row.size)


def chebyshev(order: int) -> tuple[Any, Any]:
    """Points cos(pi j/order) and the differentiation matrix on them (Trefethen 2000, Spectral Methods, ch. 6)."""
    points = np.cos(np.pi * np.arange(order + 1) / order)
    c = np.r_[2.0, np.ones(order - 1), 2.0] * (-1.0) ** np.arange(order + 1)
    apart = points[:, None] - points[None, :] + np.eye(order + 1)
    matrix = np.outer(c, 1.0 / c) / apart
    return points, matrix - np.diag(np.sum(matrix, axis=1))


def folded(system: Any, *, near: bool = False) -> Any:
    """The system with its linear loops written as rows of M, C and K; the others stay loops.

    A state z becomes a degree of freedom without mass, scaled to a displacement so that all rows are of one size. With
    `near`, loops with a limit are folded too, as linear as they are near steady sliding, and those with a delay.
    """
    chosen = [loop for loop in system.loops if (loop.sampling is None if near else loop.linear and loop.limit is None)]
    if not chosen:
        return system
    _, rate = size_and_rate(system, np.shape(system.K)[:-2])
    rows = [loop.rows(system.names) for loop in chosen]
    rows = [
        row if loop.linear else late(row, np.asarray(loop.delay), rate) for row, loop in zip(rows, chosen, strict=True)
    ]
    others = tuple(loop for loop in system.loops if loop not in chosen)
    return with_rows(system, rows)[0].replace(loops=others)


def with_rows(system: Any, rows: list[Rows]) -> tuple[Any, list[tuple[slice, Any, Any]]]:
    """The system with these rows in M, C and K, and of each where its states are, their unit and that of their rows."""
    n, more = system.size, sum(row.memory for row in rows)
    vectors = (np.shape(x)[:-1] for row in rows for x in (row.P, row.R, row.S, row.G))
    lead = np.broadcast_shapes(
        system.shape, *vectors, *(np.shape(x)[:-2] for row in rows for x in (row.A, row.E, row.F))
    )
    M, C, K = (np.zeros((*lead, n + more, n + more)) for _ in range(3))
    for into, matrix in ((M, system.M), (C, system.C), (K, system.K)):
        into[..., :n, :n] = matrix
    spring, rate = size_and_rate(system, lead)
    at, places = n, []
    for row in rows:
        m = slice(at, at + row.memory)
        at += row.memory
        size = force_per_state(row, rate)
        unit = spring[..., None] / size  # z = unit * (a displacement)
        P, R, S = (np.broadcast_to(x, (*lead, np.shape(x)[-1])) for x in (row.P, row.R, row.S))
        C[..., :n, :n] -= row.b[:, None] * R[..., None, :]
        K[..., :n, :n] -= row.b[:, None] * P[..., None, :]
        K[..., :n, m] -= row.b[:, None] * (S * unit)[..., None, :]
        scale = (spring / rate)[..., None, None] / unit[..., :, None]
        C[..., m, :n] = -scale * (row.F + row.G[..., :, None] * R[..., None, :])
        K[..., m, :n] = -scale * (row.E + row.G[..., :, None] * P[..., None, :])
        C[..., m, m] = (spring / rate)[..., None, None] * np.eye(row.memory)
        K[..., m, m] = -scale * (row.A + row.G[..., :, None] * S[..., None, :]) * unit[..., None, :]
        places.append((m, unit, scale[..., 0]))
    return _wider(system, M, C, K, more), places


def size_and_rate(system: Any, lead: tuple[int, ...]) -> tuple[Any, Any]:
    """The largest stiffness [N/m] and, with the largest mass, an angular frequency [rad/s], both (...)."""
    spring = np.max(np.abs(system.K), axis=(-1, -2)) + np.zeros(lead)
    spring = np.where(spring > 0.0, spring, 1.0)
    mass = np.max(np.abs(system.M), axis=(-1, -2))
    return spring, np.sqrt(spring / np.where(mass > 0.0, mass, 1.0))


def force_per_state(row: Rows, rate: ArrayLike) -> Any:
    """How much force a unit of each state makes within 1/rate, (..., m): directly or through others; 1 if none."""
    if row.size is not None:
        return row.size + 0.0 * np.asarray(rate)[..., None]
    size = np.abs(row.S) + 0.0 * np.asarray(rate)[..., None]
    for _ in range(row.memory):
        through = np.max(np.abs(row.A) * size[..., :, None], axis=-2, initial=0.0) / np.asarray(rate)[..., None]
        size = np.where(size > 0.0, size, through)
    return np.where(size > 0.0, size, 1.0)


def near_sliding(system: Any, held: bool = False) -> Any:
    """The system near steady sliding, its loops as rows, delays too; `ParameterError` for loops that are sampled.

    With `held` those are as if they were not, for what stands still.
    """
    if held and any(loop.sampling is not None for loop in system.loops):
        ideal: dict[str, Any] = {"sampling": None, "delay": 0.0, "computing": 0.0}
        loops = tuple(loop if loop.sampling is None else loop.replace(ideal) for loop in system.loops)
        system = system.replace(loops=loops)
    near = folded(system, near=True)
    for loop in near.loops:
        given = f"{type(loop).__name__}(on={loop.on!r}) with sampling"
        raise ParameterError("system", "loops", given, "loops that are rows of matrices: closed_loop() gives its poles")
    return near


def _wider(system: Any, M: np.ndarray, C: np.ndarray, K: np.ndarray, more: int) -> Any:
    """The system with these matrices and its contacts and load padded by rows without force."""
    names = numbered(system.names, "loop state", more)
    load, contacts = padded_load(system.load, more), padded_contacts(system.contacts, more)
    return system.replace(M=M, C=C, K=K, load=load, contacts=contacts, names=names, loops=())


def numbered(names: tuple[str, ...], name: str, more: int) -> tuple[str, ...]:
    """The names with `more` at the end that are called `name` and go on counting.

    >>> numbered(("x", "state 1"), "state", 2)
    ('x', 'state 1', 'state 2', 'state 3')
    """
    first = 1 + sum(each.rpartition(" ")[0] == name for each in names)
    return (*names, *(f"{name} {i}" for i in range(first, first + more)))


def padded(row: np.ndarray, more: int) -> Any:
    """A row (..., n) with zeros at its end."""
    return np.pad(row, [(0, 0)] * (np.ndim(row) - 1) + [(0, more)])


def padded_contacts(contacts: Sequence[Any], more: int) -> tuple[Any, ...]:
    """Contacts that neither sense nor act along `more` further rows."""
    out = []
    for contact in contacts:
        given = {name: getattr(contact, name) for name in ("n", "d", "t", "normal")}
        out.append(contact.replace({name: padded(row, more) for name, row in given.items() if row is not None}))
    return tuple(out)


def padded_load(load: np.ndarray, more: int) -> Any:
    """A load, numbers (..., n) or a schedule of them, with zeros at its end."""
    if not hasattr(load, "terms"):
        return padded(load, more)
    parts: list[Any] = []
    for weight, part in load.terms():
        level = getattr(part, "level", 1.0)
        if np.ndim(level) > 0:
            weight, part = np.asarray(weight) * level, part.replace(level=1.0)
        wide = part * padded(np.asarray(weight, dtype=float), more)
        parts.append(wide)
    total = parts[0]
    for part in parts[1:]:
        total = total + part
    return total

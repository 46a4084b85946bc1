"""What a motion remembers beside q and q', as further rows behind those of the system: they are of first order.

    a law with memory        z' = creep(v, z), one row for each such contact
    a loop with a limit      z' = A z + E q + F q' + G u, and its command w' = P q + R q' + S z, which a contact without
                             events senses and cuts: u = sat(w'); d holds b and G
    a full singular M        q = T p, p in coordinates in which M and C leave no row in between

Results show the rows in front, which are the system's own. Depends on: loops, rows, smooth_laws, start, system.
"""

from typing import Any

import numpy as np

from squealbox.loops import delayed, force_per_state, numbered, padded_contacts, padded_load
from squealbox.schedules import Schedule, value_at
from squealbox.start import Start
from squealbox.system import Contact, InvalidSystem, System
from squealbox.transient.rows import row_kinds, solved_for
from squealbox.transient.smooth_laws import Saturation

ENDLESS = 1e200  # N, of a force without a limit
NOTHING = 1e-12  # share of the largest entry below which one of a matrix in other coordinates is round-off


class RunApart(InvalidSystem):
    """Systems that the lanes of one kernel do not carry together, though each of them can be run."""


class Widened(System):
    """A system whose rows from `seen` on are its memory.

    base is what results know of it; memories are the rows of the contacts' laws, -1 without; unaudited the rows outside
    the energy audit; embedding (rows, seen) puts q and q' among the rows. Of each delay [s]: the row whose velocity is
    the command, the row that holds it a delay later, the force [N] of a unit there, and the limit [N] of it.
    """

    seen: int = 0
    base: Any = None
    memories: tuple[int, ...] = ()
    unaudited: tuple[int, ...] = ()
    embedding: Any = None
    delays: tuple[tuple[float, int, int, float, float], ...] = ()


def widened(system: System) -> System:
    """The system with rows for all it remembers; itself where that is nothing or they are there."""
    if isinstance(system, Widened):
        return system
    return _with_memory(_in_coordinates(_with_loops(system)))


def base_of(system: System) -> System:
    """The system that results know."""
    return system.base if isinstance(system, Widened) else system


def laid_open(system: System) -> System:
    """A widened system as one whose rows are all its own: results leave out nothing of what it remembers.

    What they know of it still has the masses and springs of its bodies alone, so that energies are theirs.
    """
    if not isinstance(system, Widened):
        return system
    base, more = system.base, system.size - system.base.size
    plain: dict[str, Any] = {key: np.pad(getattr(base, key), (0, more)) for key in ("M", "C", "K")}
    load, contacts = padded_load(base.load, more), padded_contacts(base.contacts, more)
    told = System(**plain, load=load, contacts=contacts, names=system.names, angles=base.angles)
    return system.replace(seen=system.size, base=told, embedding=np.eye(system.size))


def start_of(system: System, start: Start, time: float) -> tuple[Any, Any]:
    """q and q' (..., rows) of a start of the base; in steady sliding bristles are bent, else as z says or straight."""
    if not isinstance(system, Widened):
        return start.q, start.qd
    q, qd = (np.einsum("ij,...j->...i", system.embedding, x) for x in (start.q, start.qd))
    z = start.z
    for contact, row in zip(system.contacts, system.memories or (-1,) * len(system.contacts), strict=True):
        if start.sliding and row >= 0:
            deflection = contact.law.steady_deflection(value_at(contact.V, time))
            q = np.array(np.broadcast_to(q, (*np.broadcast_shapes(q.shape[:-1], np.shape(deflection)), q.shape[-1])))
            q[..., row] = deflection
    if z is not None:
        rows = [row for row in system.memories if row >= 0]
        q = np.array(np.broadcast_to(q, (*np.broadcast_shapes(q.shape[:-1], z.shape[:-1]), q.shape[-1])))
        q[..., rows] = z
    return q, qd


def _appended(system: System, more: int, name: str) -> tuple[dict[str, Any], Any]:
    """The fields of the system with `more` empty rows at its end, and its leading axes."""
    lead, n = np.broadcast_shapes(*(x.shape[:-2] for x in (system.M, system.C, system.K))), system.size
    fields: dict[str, Any] = {key: np.zeros((*lead, n + more, n + more)) for key in ("M", "C", "K")}
    for key in fields:
        fields[key][..., :n, :n] = getattr(system, key)
    fields |= {"contacts": padded_contacts(system.contacts, more), "load": padded_load(system.load, more)}
    fields["loops"] = system.loops
    fields["names"] = numbered(system.names, name, more)
    old = system if isinstance(system, Widened) else None
    fields["seen"], fields["base"] = (old.seen, old.base) if old else (n, system)
    fields["memories"], fields["delays"] = (old.memories, old.delays) if old else ((), ())
    fields["unaudited"] = (*(old.unaudited if old else ()), *range(n, n + more))
    embedding = np.eye(n) if old is None else old.embedding
    fields["embedding"] = np.vstack([embedding, np.zeros((more, embedding.shape[1]))])
    return fields, lead


def _with_memory(system: System) -> System:
    """A row for the state of each law with memory."""
    having = [c for c, contact in enumerate(system.contacts) if contact.law.has_memory]
    if not having:
        return system
    for c in having:
        if system.contacts[c].rigid:
            raise InvalidSystem(f"contacts[{c}] is rigid: a law with memory needs N = N0 + n . q; give it a stiffness")
    n = system.size
    fields, _ = _appended(system, len(having), "bristle")
    rows = dict(zip(having, range(n, n + len(having)), strict=True))
    for row in rows.values():
        fields["C"][..., row, row] = 1.0
    return Widened(**fields | {"memories": tuple(rows.get(c, -1) for c in range(len(system.contacts)))})


def _with_loops(system: System) -> System:
    """Loops with a limit that feed back more than a velocity, or with a delay, as rows, and a contact for each limit.

    The contact, without events, senses the command and cuts it; without a limit the command is rows as well.
    """
    for loop in system.loops:
        row, n, base = loop.rows(system.names), system.size, base_of(system)
        numbers: list[Any] = [(row.P, 1), (row.R, 1), (row.S, 1), (row.A, 2), (loop.limit, 0), (loop.delay, 0)]
        if any(np.ndim(x) > k for x, k in numbers):
            raise RunApart(f"a {type(loop).__name__} with a limit varies in an ensemble: run such loops one by one")
        spring, mass = (float(np.max(np.abs(x), initial=0.0)) or 1.0 for x in (system.K, system.M))
        rate = np.sqrt(spring / mass)
        under_way = loop.late > 0.0
        row, force = (
            delayed(loop.controller(system.names), loop.late, rate, loop.rate) if under_way else (row, np.zeros(0))
        )
        m, limit = row.memory, ENDLESS if loop.limit is None else float(loop.limit)
        fields, _ = _appended(system, m + 1 + under_way, "loop state")
        z, w = slice(n, n + m), n + m
        time, unit = spring / rate, spring / force_per_state(row, rate)  # z = unit times a displacement
        scale = time / unit[:, None]
        C, K = fields["C"], fields["K"]
        C[..., z, :n], K[..., z, :n] = -scale * row.F, -scale * row.E
        C[..., z, z], K[..., z, z] = time * np.eye(m), -scale * row.A * unit
        into, onto = np.zeros(len(K)), np.zeros(len(K))
        into[z], onto[:n] = time / unit * row.G, row.b
        C[..., w, w], C[..., w, :n], K[..., w, :n], K[..., w, z] = 1.0, -row.R, -row.P, -row.S * unit
        sensed = [(w, into if under_way else into + onto)]  # the row of a command, and what it drives
        if under_way:
            C[..., w + 1, w + 1], K[..., w + 1, z] = 1.0, -force * unit
            sensed.append((w + 1, onto))
            end = w - 1 - (loop.rate is not None)
            fields["delays"] = (*fields["delays"], (float(loop.late), w, end, float(unit[end - n]), limit))
        for w, acts in sensed:
            senses, none, law = -np.eye(len(K))[w], np.zeros(base.size), Saturation(limit)
            name = f"loop on {loop.on}" if np.any(acts[:n]) else f"command of the loop on {loop.on}"
            base = base.replace(
                loops=(), contacts=(*base.contacts, Contact(none, acts[: base.size], none, 1.0, 0.0, law, name=name))
            )
            cutting = Contact(np.zeros(len(K)), acts, senses, 1.0, 0.0, law, name=name)
            fields["contacts"] = (*fields["contacts"], cutting)
        system = Widened(**fields | {"loops": (), "base": base})
    return system


def _in_coordinates(system: System) -> System:
    """Where M is singular otherwise than by rows of zeros, or C joins such rows: other coordinates behind q.

    With R what M moves, N its null space, and N split by the null space of N' C N, T = [R N_1 N_2] is orthonormal.
    """
    try:
        solved_for(system, row_kinds(system))
    except InvalidSystem:
        if max(x.ndim for x in (system.M, system.C, system.K)) > 2 or isinstance(system, Widened):
            raise
        changed = _rotated(system)
        if changed is None:
            raise
        solved_for(changed, row_kinds(changed))
        return changed
    return system


def _rotated(system: System) -> System | None:
    values, vectors = np.linalg.eigh(system.M)
    heavy = np.abs(values) > NOTHING * np.max(np.abs(values), initial=0.0)
    moved, null = vectors[:, heavy], vectors[:, ~heavy]
    if not null.shape[1]:
        return None
    size = float(np.max(np.abs(system.C), initial=0.0))
    _, sizes, right = np.linalg.svd(null.T @ system.C @ null)
    rank = int(np.sum(sizes > NOTHING * size))
    first, algebraic = null @ right[:rank].T, null @ right[rank:].T
    if (
        algebraic.size
        and max(np.max(np.abs(algebraic.T @ system.C)), np.max(np.abs(system.C @ algebraic))) > 1e-9 * size
    ):
        raise InvalidSystem(
            f"a motion of {', '.join(system.names)} has neither mass nor damping of its own, and yet C joins it to "
            "others: expected a mass or a damper on it"
        )
    T, n, k = np.hstack([moved, first, algebraic]), system.size, moved.shape[1]
    spring = float(np.max(np.abs(system.K))) or 1.0
    fields, _ = _appended(system, n, "coordinate")
    for key, kept in (("M", k), ("C", k + rank), ("K", n)):
        fields[key][:n, :n] = 0.0
        fields[key][n : n + kept, n : n + kept] = _cleaned(T.T @ getattr(system, key) @ T)[:kept, :kept]
    fields["K"][:n, :n], fields["K"][:n, n:] = spring * np.eye(n), -spring * T
    contacts = []
    for contact in system.contacts:
        given = {key: getattr(contact, key) for key in ("n", "d", "t", "normal")}
        rows = {key: np.concatenate([np.zeros(n), _cleaned(row @ T)]) for key, row in given.items() if row is not None}
        contacts.append(contact.replace(rows))
    fields |= {"contacts": tuple(contacts), "load": _turned(system.load, T), "unaudited": tuple(range(n))}
    return Widened(**fields | {"embedding": np.vstack([np.eye(n), T.T])})


def _cleaned(matrix: np.ndarray) -> Any:
    return np.where(np.abs(matrix) > NOTHING * np.max(np.abs(matrix), initial=0.0), matrix, 0.0)


def _turned(load: Any, T: np.ndarray) -> Any:
    """A load in the coordinates behind q."""

    def there(weight: np.ndarray) -> Any:
        return np.concatenate([np.zeros(len(T)), np.broadcast_to(np.asarray(weight, dtype=float), (len(T),)) @ T])

    if not isinstance(load, Schedule):
        return there(load)
    total: Any = None
    for weight, part in load.terms():
        level = getattr(part, "level", 1.0)
        if np.ndim(level) > 0:
            weight, part = np.asarray(weight) * level, part.replace(level=1.0)
        total = part * there(weight) if total is None else total + part * there(weight)
    return total

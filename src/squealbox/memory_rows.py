"""Contacts with memory near steady sliding: a row without mass for the bristles of each.

With z' = a z + b v linearised (a = `relaxation`, v = -t . q') and F = N (s0 z + s1 z' + s2 v) a contact adds

    z' - a z + b t . q' = 0,      K_eff[q, z] = -d N (s0 + s1 a),      C_eff = ... + d N (s1 b + s2) t'

to the pencil, so its bristles are among the eigenvalues. Depends on: contacts, matrices.
"""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from squealbox.contacts import Contact, Contacts
from squealbox.matrices import InvalidSystem

if TYPE_CHECKING:
    from squealbox.matrices import Equilibrium


def remembering(contacts: Sequence[Contact] | Contacts) -> list[int]:
    """The contacts whose law has memory."""
    if isinstance(contacts, Contacts) and not isinstance(contacts.law, tuple):
        return list(range(len(contacts))) if contacts.law.has_memory else []
    if isinstance(contacts, Contacts):
        return [c for c, law in enumerate(contacts.law) if law.has_memory]
    return [c for c, contact in enumerate(contacts) if contact.law.has_memory]


def no_memory(contacts: Sequence[Contact] | Contacts, what: str) -> None:
    """Raise `InvalidSystem` where a law has memory: `what` knows friction of the speed alone."""
    for c in remembering(contacts):
        law = type(contacts[c].law).__name__
        raise InvalidSystem(f"contacts[{c}].law = {law}(...) has memory: {what} needs a law of the speed alone")


def with_memory(
    contacts: Sequence[Contact], matrices: tuple[Any, Any, Any], state: "Equilibrium", closed: np.ndarray
) -> tuple[tuple[Any, Any, Any], Any]:
    """M, C_eff, K_eff (..., n, n) with the rows of the bristles at their end, and q (..., n) with their deflection.

    Bristles that settle more slowly than any exponential keep their deflection and are left out.
    """
    speed, normal = state.sliding_speed, state.normal_force
    rows = []
    for c in remembering(contacts):
        rate, per_speed = (np.asarray(x) for x in contacts[c].law.relaxation(speed[..., c]))  # type: ignore[attr-defined]
        if np.any(rate != 0.0) or not np.any(state.exists):
            rows.append((c, rate, per_speed))
    n, more = matrices[0].shape[-1], len(rows)
    lead = np.broadcast_shapes(matrices[2].shape[:-2], speed.shape[:-1])
    M, C, K = (np.zeros((*lead, n + more, n + more)) for _ in range(3))
    for into, matrix in ((M, matrices[0]), (C, matrices[1]), (K, matrices[2])):
        into[..., :n, :n] = matrix
    spring = np.max(np.abs(matrices[2]), axis=(-1, -2))
    spring = np.where(np.isfinite(spring) & (spring > 0.0), spring, 1.0)
    q = np.concatenate([np.broadcast_to(state.q, (*lead, n)), np.zeros((*lead, more))], axis=-1)
    for z, (c, rate, per_speed) in enumerate(rows, n):
        contact = contacts[c]
        s0, s1, _ = (np.asarray(x) for x in contact.law.grip)  # type: ignore[attr-defined]
        level = spring / np.where(rate != 0.0, -rate, 1.0)  # rows of one size
        K[..., z, z], C[..., z, z] = -level * rate, level
        C[..., z, :n] = (level * per_speed)[..., None] * contact.t
        force = np.where(closed[..., c], normal[..., c], 0.0) * (s0 + s1 * rate)
        K[..., :n, z] = -force[..., None] * contact.d
        q[..., z] = contact.law.steady_deflection(speed[..., c])  # type: ignore[attr-defined]
    return (M, C, K), q

"""How sticking contacts that do not hold motions of their own share the force; plain loops compiled by `_engine`."""

# mypy: disable-error-code="no-untyped-def"

import numpy as np

from squealbox.transient._rigid import solve


def contact_matrix(p, s, sticking):
    """t . M^-1 d of the sticking contacts."""
    for a in range(sticking):
        for b in range(sticking):
            s.matrix[a, b] = p.g[s.stuck[a], s.stuck[b]]


def share_out(p, s, sticking):
    """Forces of sticking contacts, into s.right, that give s.wanted where contacts hold the same motion.

    Of all forces that do, those with the least sum of F^2/L, L = bias limit/|g| with the column g of t . M^-1 d:
    contacts on one motion reach their limits together whatever their levers, and one that is not pressed carries
    nothing. With B an orthonormal basis of the rows of t . M^-1 d, F = L B' (B L B')^-1 b. False where that has no
    solution. The bias is 1 until `_modes.even_out` finds that other shares hold longer.
    """
    kept = independent_rows(p, s, sticking)
    for i in range(kept):
        for j in range(kept):
            total = 0.0
            for e in range(sticking):
                total += s.basis[i, e] * s.share[e] * s.basis[j, e]
            s.matrix[i, j] = total
    if not solve(s.matrix, s.right, kept):
        return False
    for i in range(kept):
        s.multiplier[i] = s.right[i]
    for e in range(sticking):
        total = 0.0
        for i in range(kept):
            total += s.basis[i, e] * s.multiplier[i]
        s.right[e] = s.share[e] * total
    return True


def all_held(p, s, sticking):
    """Whether the forces of `share_out` give every sticking contact what it wants, not the independent ones alone."""
    for a in range(sticking):
        rest = s.wanted[a]
        size = abs(rest)
        for e in range(sticking):
            term = p.g[s.stuck[a], s.stuck[e]] * s.right[e]
            rest -= term
            size += abs(term)
        if not abs(rest) <= 1e-6 * size + 1e-300:
            return False
    return True


def independent_rows(p, s, sticking):
    """An orthonormal basis of the rows of t . M^-1 d into s.basis, what it wants into s.right; how many there are.

    By Gram and Schmidt's process, with the contacts that are pressed first. Sets s.share too: L as a share of the
    largest one; of a contact that is not pressed 1 if it alone holds a motion, else 0.
    """
    largest, most = 0.0, 0.0
    for a in range(sticking):
        limit = p.static[s.stuck[a]] * s.normal[s.stuck[a]]
        column = 0.0
        for e in range(sticking):
            column += p.g[s.stuck[e], s.stuck[a]] ** 2
        s.share[a] = s.bias[s.stuck[a]] * limit / np.sqrt(column) if column > 0.0 else 0.0
        largest, most = max(largest, limit), max(most, s.share[a])
    kept = 0
    for turn in range(2):
        for a in range(sticking):
            pressed = p.static[s.stuck[a]] * s.normal[s.stuck[a]] > 1e-13 * largest and s.share[a] > 0.0
            if pressed and turn == 0:
                s.share[a] /= most
            if pressed != (turn == 0):
                continue
            if turn == 1:
                s.share[a] = 0.0
            before = 0.0
            wanted = s.wanted[a]
            for e in range(sticking):
                s.basis[kept, e] = p.g[s.stuck[a], s.stuck[e]]
                before += s.basis[kept, e] ** 2
            for _ in range(2):
                for k in range(kept):
                    along = 0.0
                    for e in range(sticking):
                        along += s.basis[k, e] * s.basis[kept, e]
                    wanted -= along * s.right[k]
                    for e in range(sticking):
                        s.basis[kept, e] -= along * s.basis[k, e]
            after = 0.0
            for e in range(sticking):
                after += s.basis[kept, e] ** 2
            if after > 1e-18 * before:
                for e in range(sticking):
                    s.basis[kept, e] /= np.sqrt(after)
                s.right[kept] = wanted / np.sqrt(after)
                kept += 1
                if turn == 1:
                    s.share[a] = 1.0
    return kept

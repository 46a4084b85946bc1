"""How contacts that do not hold motions of their own share the force; plain loops compiled by `_engine`.

The forces x of sticking contacts, and of closed rigid ones, obey A x = b, which leaves the split open where rows of A
depend on each other. Of all splits that one is taken which has the least sum of x^2/L, with a weight L for each.
"""

# mypy: disable-error-code="no-untyped-def"

import numpy as np

RISES = 1e-100  # static limit up to which a contact never holds anything: its friction rises from zero


def contact_matrix(p, s, sticking):
    """t . M^-1 d of the sticking contacts, into s.whole and, to be solved with, s.matrix."""
    for a in range(sticking):
        for b in range(sticking):
            s.whole[a, b] = p.g[s.stuck[a], s.stuck[b]]
            s.matrix[a, b] = s.whole[a, b]


def weigh_sticking(p, s, sticking):
    """Weights L = bias limit/|g| with the column g of t . M^-1 d.

    Contacts on one motion reach their limits together whatever their levers, and one that is not pressed carries
    nothing. The bias is 1 until `_modes.even_out` finds that other shares hold longer.
    """
    largest = 1e13 * RISES
    for a in range(sticking):
        largest = max(largest, p.static[s.stuck[a]] * s.normal[s.stuck[a]])
    for a in range(sticking):
        c = s.stuck[a]
        limit = p.static[c] * s.normal[c]
        size = column_size(s, a, sticking)
        s.weight[a] = s.bias[c] * limit / size if size > 0.0 and limit > 1e-13 * largest else 0.0


def column_size(s, b, count):
    """|column b| of s.whole."""
    total = 0.0
    for a in range(count):
        total += s.whole[a, b] ** 2
    return np.sqrt(total)


def share_out(s, count):
    """Forces into s.right with s.whole x = s.wanted and the least sum of x^2/s.weight; False where there is none.

    With B an orthonormal basis of the rows of s.whole, x = L B' (B L B')^-1 b. A weight of zero makes a force zero,
    unless it alone holds a motion.
    """
    kept = independent_rows(s, count)
    for i in range(kept):
        s.multiplier[i] = 0.0
        for e in range(count):
            s.multiplier[i] += s.basis[i, e] ** 2 * s.weight[e]
        s.multiplier[i] = 1.0 / np.sqrt(max(s.multiplier[i], 1e-300))
    for i in range(kept):
        s.right[i] *= s.multiplier[i]
        for j in range(kept):
            total = 0.0
            for e in range(count):
                total += s.basis[i, e] * s.weight[e] * s.basis[j, e]
            s.matrix[i, j] = total * s.multiplier[i] * s.multiplier[j]
    if not solve(s.matrix, s.right, kept):
        return False
    for i in range(kept):
        s.multiplier[i] *= s.right[i]
    for e in range(count):
        total = 0.0
        for i in range(kept):
            total += s.basis[i, e] * s.multiplier[i]
        s.right[e] = s.weight[e] * total
    return True


def all_held(s, count, turn):
    """Whether the forces of `share_out` give every contact what it wants, not the independent ones alone.

    In later turns, which solve for what the first left, beside the terms of the first.
    """
    held = True
    for a in range(count):
        rest = s.wanted[a]
        s.terms[a] = abs(rest) if turn == 0 else s.terms[a]
        for e in range(count):
            term = s.whole[a, e] * s.right[e]
            rest -= term
            s.terms[a] += abs(term)
        held = held and abs(rest) <= 1e-6 * s.terms[a] + 1e-300
    return held


def independent_rows(s, count):
    """An orthonormal basis of the rows of s.whole into s.basis, what it wants into s.right; how many there are.

    By Gram and Schmidt's process, with those first that carry something. Brings the largest weight to 1.
    """
    most = 0.0
    for a in range(count):
        most = max(most, s.weight[a])
    kept = 0
    for turn in range(2):
        for a in range(count):
            if (s.weight[a] > 0.0) != (turn == 0):
                continue
            before = 0.0
            wanted = s.wanted[a]
            for e in range(count):
                s.basis[kept, e] = s.whole[a, e]
                before += s.basis[kept, e] ** 2
            for _ in range(2):
                for k in range(kept):
                    along = 0.0
                    for e in range(count):
                        along += s.basis[k, e] * s.basis[kept, e]
                    wanted -= along * s.right[k]
                    for e in range(count):
                        s.basis[kept, e] -= along * s.basis[k, e]
            after = 0.0
            for e in range(count):
                after += s.basis[kept, e] ** 2
            if after > 1e-18 * before:
                for e in range(count):
                    s.basis[kept, e] /= np.sqrt(after)
                s.right[kept] = wanted / np.sqrt(after)
                kept += 1
                if turn == 1:
                    s.weight[a] = max(most, 1e-300)
    for a in range(count):
        s.weight[a] /= most if most > 0.0 else 1e-300
    return kept


def solve(matrix, right, size):
    """Gaussian elimination with partial pivoting, in place; False when a pivot is lost."""
    scale = 0.0
    for i in range(size):
        for j in range(size):
            scale = max(scale, abs(matrix[i, j]))
    for k in range(size):
        best = k
        for i in range(k + 1, size):
            if abs(matrix[i, k]) > abs(matrix[best, k]):
                best = i
        if not abs(matrix[best, k]) > 1e-13 * scale:
            return False
        for j in range(k, size):
            matrix[k, j], matrix[best, j] = matrix[best, j], matrix[k, j]
        right[k], right[best] = right[best], right[k]
        for i in range(k + 1, size):
            factor = matrix[i, k] / matrix[k, k]
            for j in range(k, size):
                matrix[i, j] -= factor * matrix[k, j]
            right[i] -= factor * right[k]
    for k in range(size - 1, -1, -1):
        for j in range(k + 1, size):
            right[k] -= matrix[k, j] * right[j]
        right[k] /= matrix[k, k]
    return True

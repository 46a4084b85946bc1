"""Rigid contacts: the small linear system of their normal forces, together with the friction of those that stick.

A rigid contact has the gap g = gap0 - w . q >= 0 and the reaction -w N on the degrees of freedom, 0 <= N, N g = 0.
While it is closed, g'' = -w . q'' = 0 is the equation of N; a sliding one carries the friction sense mu N along d with
it, so its own entry of the matrix is w . M^-1 (w - sense mu d). Is that not positive, friction presses the contact
together harder than N holds it apart (Painleve 1895): forces then do not exist, or not uniquely.

The same system with velocities for accelerations and impulses for forces gives an impact: -w . q' jumps to
-restitution times what it was (Newton), and a contact whose sliding speed is brought to zero sticks. Plain loops
compiled by `_engine`. Source: Glocker 2001, Set-Valued Force Laws, chapters 5 and 8.
"""

# mypy: disable-error-code="no-untyped-def"

import numpy as np

AGAIN = 12  # turns in which the residual of a raised diagonal is solved for
NORMAL, ALONG = 0, 1  # what a row of the system holds: the gap, or the sliding velocity
APART = 2  # mode of an open contact, as OPEN in _motion


def constrain(p, mode, s, dy, impact):
    """Normal forces of closed rigid contacts and friction of sticking ones, added to the accelerations in dy.

    With `impact` dy holds velocities and s.normal, s.force become impulses. False when there is no solution.
    """
    for c in range(p.contacts):
        s.idle[c] = 0
    count = list_rows(p, mode, s)
    size_normal_forces(p, s, dy)
    solved = correct(p, mode, s, dy, count, impact, False)
    if not solved:
        solved = spread(p, mode, s, dy, impact)
    for c in range(p.contacts):
        if p.rigid[c] and mode[c] != APART and mode[c] != 0:
            s.force[c] = mode[c] * s.mu[c] * s.normal[c]
    return solved


def spread(p, mode, s, dy, impact):
    """Forces of redundant contacts: a slightly raised diagonal shares them out, its residual is solved for again.

    Friction carries nothing where normal forces do. A floor that would pull while friction on the same motion holds is
    left without force; where friction does not, it pulls, and so opens.
    """
    n = p.mk.shape[0]
    for i in range(n):
        s.before[i] = dy[n + i]
    for c in range(p.contacts):
        s.idle[c] = not impact and not p.rigid[c] and mode[c] == 0
    spread_over(p, mode, s, dy, impact)
    for c in range(p.contacts):
        s.idle[c] = s.idle[c] != 0 and holds_all_the_same(p, c, s, dy)
    solved = spread_over(p, mode, s, dy, impact)
    for _ in range(p.contacts):
        which = pulling(p, mode, s)
        if impact or which < 0 or not solved:
            return solved
        for c in range(p.contacts):
            s.idle[c] = c == which or (s.idle[c] != 0 and p.rigid[c] != 0)
        solved = spread_over(p, mode, s, dy, impact)
        for c in range(p.contacts):
            solved = solved and (s.idle[c] == 0 or holds_all_the_same(p, c, s, dy))
        if not solved:
            for c in range(p.contacts):
                s.idle[c] = 0
            return spread_over(p, mode, s, dy, impact)
    return solved


def spread_over(p, mode, s, dy, impact):
    """The forces that share, from the start; False when a matrix is singular all the same."""
    n = p.mk.shape[0]
    for i in range(n):
        dy[n + i] = s.before[i]
    count = list_rows(p, mode, s)
    solved = True
    for _ in range(AGAIN):
        solved = correct(p, mode, s, dy, count, impact, True) and solved
    return solved


def pulling(p, mode, s):
    """The first closed floor with a negative normal force, -1 without one."""
    for c in range(p.contacts):
        if p.rigid[c] and mode[c] != APART and s.normal[c] < -1e-12 * s.size[c]:
            return c
    return -1


def holds_all_the_same(p, c, s, dy):
    """Whether the other forces keep a floor closed, or friction sticking, without a force of its own."""
    n = p.mk.shape[0]
    rate = 0.0 if p.rigid[c] else s.signal[p.signals + c]
    terms = abs(rate)
    for i in range(n):
        row = p.w[c, i] if p.rigid[c] else -p.t[c, i]
        rate += row * dy[n + i]
        terms += abs(row) * (abs(dy[n + i]) + abs(s.before[i]))
    return abs(rate) <= 1e-9 * terms


def raised(p, s, a, count):
    """What is added to diagonal entry a of redundant contacts.

    It weighs the squares of the forces: friction far more than normal forces, and each in proportion to its limit.
    """
    entry = abs(s.matrix[a, a])
    if s.row_kind[a] == NORMAL:
        return 1e-9 * entry
    most = 0.0
    own = 0.0
    for b in range(count):
        c = s.row_contact[b]
        if s.row_kind[b] == ALONG and not p.rigid[c]:
            size = p.static[c] * s.normal[c] * np.sqrt(abs(p.g[c, c]))
            most = max(most, size)
            own = size if b == a else own
    return 1e-4 * entry * (min(most / own, 1e3) if own > 0.0 else 1.0 if p.rigid[s.row_contact[a]] else 1e3)


def list_rows(p, mode, s):
    """The rows of the system, into s.row_contact and s.row_kind; their forces start from zero."""
    count = 0
    for c in range(p.contacts):
        if mode[c] == APART:
            continue
        if p.rigid[c]:
            s.normal[c] = 0.0
        if p.rigid[c] and s.idle[c] == 0:
            s.row_contact[count] = c
            s.row_kind[count] = NORMAL
            count += 1
        if mode[c] == 0:
            s.force[c] = 0.0
        if mode[c] == 0 and (s.idle[c] == 0 or p.rigid[c]):
            s.row_contact[count] = c
            s.row_kind[count] = ALONG
            count += 1
    return count


def size_normal_forces(p, s, dy):
    """The size of the terms that balance in each normal force: below its round-off a force counts as zero."""
    n = p.mk.shape[0]
    for c in range(p.contacts):
        if p.rigid[c]:
            total = 0.0
            mobility = 0.0
            for i in range(n):
                total += abs(p.w[c, i] * dy[n + i])
                mobility += p.w[c, i] * p.mw[c, i]
            s.size[c] = total / mobility


def correct(p, mode, s, dy, count, impact, redundant):
    """One solve for what the forces still lack; False when the matrix is singular."""
    n = p.mk.shape[0]
    for a in range(count):
        c = s.row_contact[a]
        if s.row_kind[a] == NORMAL:
            right = s.rebound[c] if impact else 0.0
            for i in range(n):
                right += p.w[c, i] * dy[n + i]
        else:
            right = s.signal[c] if impact else s.signal[p.signals + c]
            for i in range(n):
                right -= p.t[c, i] * dy[n + i]
        s.right[a] = right
        for b in range(count):
            s.matrix[a, b] = row_times_column(p, mode, s, a, b)
        if redundant:
            s.matrix[a, a] += raised(p, s, a, count)
    if not solve(s.matrix, s.right, count):
        return False
    for b in range(count):
        for i in range(n):
            dy[n + i] += column(p, mode, s, b, i) * s.right[b]
        if s.row_kind[b] == NORMAL:
            s.normal[s.row_contact[b]] += s.right[b]
        else:
            s.force[s.row_contact[b]] += s.right[b]
    return True


def column(p, mode, s, b, i):
    """Acceleration i per unit of force b: N presses along -w and, sliding, drags along d."""
    c = s.row_contact[b]
    if s.row_kind[b] == ALONG:
        return p.md[c, i]
    if mode[c] == 0:
        return -p.mw[c, i]
    return mode[c] * s.mu[c] * p.md[c, i] - p.mw[c, i]


def row_times_column(p, mode, s, a, b):
    """How much force b changes what row a holds."""
    c = s.row_contact[a]
    total = 0.0
    for i in range(p.mk.shape[0]):
        row = -p.w[c, i] if s.row_kind[a] == NORMAL else p.t[c, i]
        total += row * column(p, mode, s, b, i)
    return total


def paradox(p, mode, s):
    """Whether some sliding rigid contact has w . M^-1 (w - sense mu d) <= 0; s.mu as last computed."""
    for c in range(p.contacts):
        if p.rigid[c] and (mode[c] == 1 or mode[c] == -1):
            total = 0.0
            for i in range(p.mk.shape[0]):
                total += p.w[c, i] * (p.mw[c, i] - mode[c] * s.mu[c] * p.md[c, i])
            if not total > 0.0:
                return True
    return False


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

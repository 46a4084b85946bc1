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

from squealbox.transient._sharing import RISES, all_held, column_size, share_out, solve

AGAIN = 12  # turns in which the residual of a raised diagonal is solved for
FLOORS_FIRST = 1e6  # times as much as friction carries what is closed, where both hold the same motion
NORMAL, ALONG = 0, 1  # what a row of the system holds: the gap, or the sliding velocity
APART = 2  # mode of an open contact, as OPEN in _motion


def constrain(p, mode, s, dy, impact):
    """Normal forces of closed rigid contacts and friction of sticking ones, added to the accelerations in dy.

    With `impact` dy holds velocities and s.normal, s.force become impulses. False when there is no solution.
    """
    for c in range(p.contacts):
        s.idle[c] = 0
        s.slack[c] = 0
    for i in range(p.mk.shape[0]):
        s.before[i] = dy[p.mk.shape[0] + i]
    size_normal_forces(p, s, dy)
    clear(p, mode, s)
    count = list_rows(p, mode, s)
    write_system(p, mode, s, dy, count, impact)
    solved = solve_raised(s, count, 0.0)
    s.spare[0] = not solved
    if solved:
        add_forces(p, mode, s, dy, count)
    else:
        solved = spread(p, mode, s, dy, impact)
    for c in range(p.contacts):
        if p.rigid[c] and mode[c] != APART and mode[c] != 0:
            s.force[c] = mode[c] * s.mu[c] * s.normal[c]
    return solved


def spread(p, mode, s, dy, impact):
    """Forces of redundant contacts.

    Friction carries nothing where normal forces do. A floor that would pull while friction on the same motion holds is
    left without force; where friction does not, it pulls, and so opens.
    """
    solved = floors_first(p, mode, s, dy, impact)
    for _ in range(p.contacts):
        which = pulling(p, mode, s)
        if impact or which < 0 or not solved:
            return solved
        s.idle[which] = 1
        solved = floors_first(p, mode, s, dy, impact)
        for c in range(p.contacts):
            solved = solved and (s.idle[c] == 0 or holds_all_the_same(p, c, s, dy, True))
            beyond = mode[c] == 0 and p.static[c] * abs(s.normal[c]) <= RISES  # what never sticks holds nothing
            solved = solved and not (beyond and abs(s.force[c]) > 1e-9 * s.size[which])
        if not solved:
            for c in range(p.contacts):
                s.idle[c] = 0
            return floors_first(p, mode, s, dy, impact)
    return solved


def floors_first(p, mode, s, dy, impact):
    """The forces where floors alone hold what they can; friction shares the rest in proportion to its limits."""
    sticks = False
    for c in range(p.contacts):
        s.slack[c] = not impact and mode[c] == 0
        sticks = sticks or (s.slack[c] != 0 and p.rigid[c] != 0)
    solved = spread_over(p, mode, s, dy, impact)
    if impact:
        return solved
    for c in range(p.contacts):
        s.slack[c] = s.slack[c] != 0 and holds_all_the_same(p, c, s, dy, False)
    solved = spread_over(p, mode, s, dy, impact)
    return spread_over(p, mode, s, dy, impact) if sticks else solved  # limits with the normal forces just found


def spread_over(p, mode, s, dy, impact):
    """The forces that share, from the start, again for what they still lack; False where there are none.

    In an impact a slightly raised diagonal shares: of contacts on one motion that rebound differently it pulls the
    slower, which so opens.
    """
    n = p.mk.shape[0]
    for i in range(n):
        dy[n + i] = s.before[i]
    count = list_rows(p, mode, s)
    write_system(p, mode, s, dy, count, impact)
    weigh(p, s, count)
    clear(p, mode, s)
    solved, held = True, True
    for turn in range(AGAIN if impact else 2):
        write_system(p, mode, s, dy, count, impact)
        if impact:
            solved = solve_raised(s, count, 1e-9) and solved
        else:
            solved = share_out(s, count) and solved
            held = all_held(s, count, turn)
        add_forces(p, mode, s, dy, count)
    return solved and held


def solve_raised(s, count, by):
    """s.right with s.whole x = s.wanted, the diagonal raised by this share, of friction by far more."""
    for a in range(count):
        s.right[a] = s.wanted[a]
        for b in range(count):
            s.matrix[a, b] = s.whole[a, b]
        s.matrix[a, a] *= 1.0 + (by if s.row_kind[a] == NORMAL else 1e5 * by)
    return solve(s.matrix, s.right, count)


def weigh(p, s, count):
    """Weights of `share_out`: friction by its limits, as in `weigh_sticking`, floors by far more than any of it."""
    most = 0.0
    for a in range(count):
        c = s.row_contact[a]
        limit = s.bias[c] * max(p.static[c] * s.normal[c], 0.0) if s.row_kind[a] == ALONG else 0.0
        s.weight[a] = limit
        most = max(most, limit)
    for a in range(count):
        size = column_size(s, a, count)
        if s.row_kind[a] == NORMAL:
            s.weight[a] = FLOORS_FIRST * most if most > 0.0 else 1.0
        elif s.weight[a] <= max(1e-13 * most, RISES):
            s.weight[a] = 0.0
        s.weight[a] = s.weight[a] / size if size > 0.0 else 0.0


def pulling(p, mode, s):
    """The first closed floor with a negative normal force, -1 without one."""
    for c in range(p.contacts):
        if p.rigid[c] and mode[c] != APART and s.normal[c] < -1e-12 * s.size[c]:
            return c
    return -1


def holds_all_the_same(p, c, s, dy, floor):
    """Whether the other forces keep a floor closed, or friction sticking, without a force of its own."""
    n = p.mk.shape[0]
    rate = 0.0 if floor else s.signal[p.signals + c]
    terms = abs(rate)
    for i in range(n):
        row = p.w[c, i] if floor else -p.t[c, i]
        rate += row * dy[n + i]
        terms += abs(row) * (abs(dy[n + i]) + abs(s.before[i]))
    return abs(rate) <= 1e-9 * terms


def list_rows(p, mode, s):
    """The rows of the system, into s.row_contact and s.row_kind; returns how many."""
    count = 0
    for c in range(p.contacts):
        if mode[c] != APART and p.rigid[c] and s.idle[c] == 0:
            s.row_contact[count] = c
            s.row_kind[count] = NORMAL
            count += 1
        if mode[c] == 0 and s.slack[c] == 0:
            s.row_contact[count] = c
            s.row_kind[count] = ALONG
            count += 1
    return count


def clear(p, mode, s):
    """The forces of the rows, and of those left out of them, start from zero."""
    for c in range(p.contacts):
        if mode[c] != APART and p.rigid[c]:
            s.normal[c] = 0.0
        if mode[c] == 0:
            s.force[c], s.share[c] = 0.0, 0.0


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


def write_system(p, mode, s, dy, count, impact):
    """What the rows still lack, into s.wanted, and how much each force changes it, into s.whole."""
    n = p.mk.shape[0]
    for a in range(count):
        c = s.row_contact[a]
        if s.row_kind[a] == NORMAL:
            wanted = s.rebound[c] if impact else 0.0
            for i in range(n):
                wanted += p.w[c, i] * dy[n + i]
        else:
            wanted = s.signal[c] if impact else s.signal[p.signals + c]
            for i in range(n):
                wanted -= p.t[c, i] * dy[n + i]
        s.wanted[a] = wanted
        for b in range(count):
            s.whole[a, b] = row_times_column(p, mode, s, a, b)


def add_forces(p, mode, s, dy, count):
    """Add the forces in s.right, and the accelerations they cause."""
    n = p.mk.shape[0]
    for b in range(count):
        c = s.row_contact[b]
        for i in range(n):
            dy[n + i] += column(p, mode, s, b, i) * s.right[b]
        if s.row_kind[b] == NORMAL:
            s.normal[c] += s.right[b]
        else:
            s.force[c] += s.right[b]
            s.share[c] = s.weight[b]


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

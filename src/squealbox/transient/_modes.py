"""Which mode each contact takes: stick, slip in either sense, or open; plain loops compiled by `_engine`.

At an instant at which several contacts have zero sliding velocity their modes depend on each other, so they are decided
together: each sticks with |force| <= static N, or slips with the acceleration of its speed in its own sense.
"""

# mypy: disable-error-code="name-defined,no-untyped-def"

from squealbox.transient._motion import (
    OPEN,
    STICK,
    contact_kinematics,
    contact_matrix,
    derivative,
    evaluate_signals,
    list_sticking,
    slip_acceleration,
    solve,
)


def slip_tolerance(p, c, y, s):
    """Speed below which a contact counts as being at zero together with another: round-off of its own terms."""
    total = abs(s.signal[c])
    for i in range(p.mk.shape[0]):
        total += abs(p.t[c, i] * y[p.mk.shape[0] + i])
    return 1e-12 * total


def apply_event(p, t, y, mode, s, j):
    """Change modes at an event of function j; False when no consistent set of modes exists."""
    m = p.contacts
    derivative(p, t, y, mode, s, s.dy)
    for c in range(m):
        s.old[c] = mode[c]
        s.forced[c] = 0
        s.at_zero[c] = mode[c] == STICK or (mode[c] != OPEN and abs(s.speed[c]) <= slip_tolerance(p, c, y, s))
    c = j if j < m else j - m
    if j >= m:
        mode[c] = OPEN
        s.at_zero[c] = 0
    elif mode[c] == OPEN:
        s.at_zero[c] = abs(s.speed[c]) <= slip_tolerance(p, c, y, s)
        mode[c] = 1 if s.speed[c] >= 0.0 else -1
    elif mode[c] == STICK:
        force_releases(p, mode, s, c)
    else:
        s.at_zero[c] = 1
    return settle(p, t, y, mode, s)


def force_releases(p, mode, s, which):
    """Release contact `which`, and with it every other one that sticks at its limit to round-off."""
    for c in range(p.contacts):
        limit = p.static[c] * s.normal[c]
        if c == which or (mode[c] == STICK and abs(s.force[c]) >= limit * (1.0 - 1e-9)):
            s.forced[c] = 1 if s.force[c] > 0.0 else -1


def start_modes(p, t, y, mode, s):
    """Modes at the start of a run: open where N < 0 may open, sliding where v is not zero, otherwise decided."""
    if p.varying:
        evaluate_signals(p, t, s)
    contact_kinematics(p, y, s)
    for c in range(p.contacts):
        s.forced[c] = 0
        s.at_zero[c] = 0
        mode[c] = 1 if s.speed[c] >= 0.0 else -1
        if p.unilateral[c] and s.normal[c] < 0.0:
            mode[c] = OPEN
        elif abs(s.speed[c]) <= slip_tolerance(p, c, y, s):
            s.at_zero[c] = 1
        s.old[c] = mode[c]
    return settle(p, t, y, mode, s)


def settle(p, t, y, mode, s):
    """Solve for the modes of all contacts at zero speed together, then remove the drift of those that stick."""
    if not decide(p, t, y, mode, s):
        return False
    contact_kinematics(p, y, s)
    for c in range(p.contacts):
        s.fresh[c] = s.at_zero[c] != 0 and mode[c] != STICK
    return remove_drift(p, y, s, list_sticking(p, mode, s))


def remove_drift(p, y, s, sticking):
    """Bring the sliding velocity of the sticking contacts to zero by impulses along their own d."""
    if sticking == 0:
        return True
    for a in range(sticking):
        s.right[a] = s.speed[s.stuck[a]]
    contact_matrix(p, s, sticking, 0.0)
    solved = solve(s.matrix, s.right, sticking)
    if not solved:
        for a in range(sticking):
            s.right[a] = s.speed[s.stuck[a]]
        contact_matrix(p, s, sticking, 1e-6)
        solved = solve(s.matrix, s.right, sticking)
    for a in range(sticking):
        for i in range(p.mk.shape[0]):
            y[p.mk.shape[0] + i] += p.md[s.stuck[a], i] * s.right[a]
    return solved


def decide(p, t, y, mode, s):
    """Modes of the contacts at zero speed: each sticks with |force| <= static N, or slips with v' in its sense.

    One complementarity problem in all of them, solved by Murty's least-index principal pivoting from all sticking; when
    static exceeds kinetic friction it may cycle, and then all combinations are tried, sticking first.
    """
    for c in range(p.contacts):
        if s.at_zero[c]:
            mode[c] = first_guess(p, c, mode, s)
    for _ in range(20 + 10 * p.contacts * p.contacts):
        if not derivative(p, t, y, mode, s, s.dy):
            return False
        changed = False
        for c in range(p.contacts):
            wanted = wanted_mode(p, c, mode, s)
            if wanted != mode[c]:
                mode[c] = wanted
                changed = True
                break
        if not changed:
            return True
    return enumerate_modes(p, t, y, mode, s)


def first_guess(p, c, mode, s):
    """Sticking, unless a release is forced or the contact is in tension and so can only pass through zero speed."""
    if s.forced[c] != 0:
        return s.forced[c]
    if s.normal[c] > 0.0:
        return STICK
    return -mode[c] if mode[c] != STICK else (1 if s.force[c] > 0.0 else -1)


def wanted_mode(p, c, mode, s):
    """The mode contact c would rather have, given the forces and accelerations just computed."""
    if not s.at_zero[c] or s.forced[c] != 0:
        return mode[c]
    if mode[c] == STICK:
        if abs(s.force[c]) <= p.static[c] * s.normal[c] * (1.0 + 1e-12):
            return STICK
        return 1 if s.force[c] > 0.0 else -1
    rate = slip_acceleration(p, c, s.dy, s)
    size = abs(s.signal[p.signals + c])
    for i in range(p.mk.shape[0]):
        size += abs(p.t[c, i] * s.dy[p.mk.shape[0] + i])
    if mode[c] * rate >= -1e-12 * size:
        return mode[c]
    return STICK if s.normal[c] > 0.0 else -mode[c]


def enumerate_modes(p, t, y, mode, s):
    """Try all 3^k combinations of the k contacts at zero speed, k <= 8; False when none is consistent."""
    k = 0
    for c in range(p.contacts):
        if s.at_zero[c]:
            s.chosen[k] = c
            k += 1
    if k > 8:
        return False
    for code in range(3**k):
        rest = code
        for a in range(k):
            mode[s.chosen[a]] = (STICK, 1, -1)[rest % 3]
            rest //= 3
        if derivative(p, t, y, mode, s, s.dy):
            consistent = True
            for c in range(p.contacts):
                consistent = consistent and wanted_mode(p, c, mode, s) == mode[c]
            if consistent:
                return True
    return False

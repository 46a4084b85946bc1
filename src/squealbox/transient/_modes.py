"""Which mode each contact takes: stick, slip in either sense, or open; plain loops compiled by `_engine`.

At an instant at which several contacts have zero sliding velocity their modes depend on each other, so they are decided
together: each sticks with |force| <= static N, or slips with the acceleration of its speed in its own sense.
"""

# mypy: disable-error-code="no-untyped-def"

import numpy as np

from squealbox.transient._impacts import gap_rate, impact, on_one_gap, project, touches
from squealbox.transient._motion import (
    OPEN,
    STICK,
    contact_kinematics,
    derivative,
    evaluate_signals,
    event_tolerance,
    force_noise,
    list_sticking,
    normal_noise,
    rate_terms,
    slip_acceleration,
    slip_tolerance,
)
from squealbox.transient._sharing import RISES, contact_matrix, share_out, solve, weigh_sticking

CLEAR = 50.0  # times the round-off of a force: what a mode that does not hold exceeds
LEAVE = 1e-8  # share of its terms below which the acceleration of a contact that leaves zero speed counts as zero
UNPRESSED = 1e-11  # share of the limit of another contact up to which one holds nothing beside it
JUMPED = 1e-5  # share of its limit by which the force of a contact lies beyond it after a jump
EVENED = 400  # turns of the rule that evens out what contacts carry
NEARLY = 1e-10  # of 1


def apply_event(p, t, y, mode, s, j):
    """Change modes at an event of function j; False when no consistent set of modes exists."""
    m = p.contacts
    for c in range(m):
        s.bias[c] = 1.0
    derivative(p, t, y, mode, s, s.dy)
    if list_sticking(p, mode, s) > 0:  # one that lets go begins to slip from zero speed, not from what it drifted
        hold_still(p, y, mode, s)
        derivative(p, t, y, mode, s, s.dy)
    reference = s.speed[j] if j < m and mode[j] != OPEN else 0.0
    for c in range(m):
        s.old[c] = mode[c]
        s.forced[c] = 0
        s.leaving[c] = 0
        s.touch[c] = p.rigid[c] != 0 and mode[c] != OPEN
        slow = abs(s.speed[c]) <= event_tolerance(p, c, y, s, reference)
        s.at_zero[c] = mode[c] == STICK or (mode[c] != OPEN and slow)
    c = j if j < m else j - m
    if p.rigid[c] and j < m and mode[c] == OPEN:
        return land(p, t, y, mode, s, c)
    lost = mode[c] == STICK and s.normal[c] <= (1e-6 * s.phi0[m + c] if p.rigid[c] else normal_noise(p, c, y, s))
    if j >= m or (p.unilateral[c] and lost):  # no force to stick with, where others hold the same motion
        mode[c] = OPEN
        s.at_zero[c] = 0
        if p.rigid[c]:
            for e in range(m):
                if e == c or (s.touch[e] and on_one_gap(p, c, e)):
                    mode[e], s.at_zero[e], s.forced[e] = OPEN, 0, OPEN
    elif mode[c] == OPEN:
        s.at_zero[c] = abs(s.speed[c]) <= slip_tolerance(p, c, y, s)
        mode[c] = 1 if s.speed[c] >= 0.0 else -1
    elif mode[c] == STICK and s.spare[0] and even_out(p, t, y, mode, s) < 1.0 - NEARLY:
        s.at_zero[c] = 1  # other shares of the force still hold
    elif mode[c] == STICK:
        force_releases(p, y, mode, s, c)
    else:
        s.at_zero[c] = 1
        if p.g[c, c] > 0.0:  # beside its reversal, where the step landed, it would at once reverse again
            for i in range(p.mk.shape[0]):
                y[p.mk.shape[0] + i] += p.md[c, i] * s.speed[c] / p.g[c, c]
    return settle(p, t, y, mode, s)


def land(p, t, y, mode, s, which):
    """Rigid contact `which` has landed: an impact of all that touch, then new modes for every contact."""
    for c in range(p.contacts):
        if p.rigid[c] and mode[c] == OPEN:
            rate, tolerance = gap_rate(p, c, y)
            if c == which or (rate < -tolerance and touches(p, c, y, s)):
                mode[c] = 1
    if not impact(p, y, mode, s):
        return False
    for c in range(p.contacts):
        slow = abs(s.speed[c]) <= slip_tolerance(p, c, y, s)
        s.at_zero[c] = slow and mode[c] != OPEN
        s.touch[c] = p.rigid[c] != 0 and mode[c] != OPEN
        if mode[c] != OPEN and not slow and p.static[c] > 0.0:
            mode[c] = 1 if s.speed[c] >= 0.0 else -1
    if not settle(p, t, y, mode, s):
        return False
    s.old[which] = -2  # a landing is an event, also when the contact rebounds
    return True


def force_releases(p, y, mode, s, which):
    """Release contact `which`, and with it every other one that sticks at its limit to round-off.

    Where forces jump, as behind a kink of a schedule, they come to lie far beyond limits: who goes is then decided.
    One whose friction rises from zero, or that is not pressed, was held by the others: it goes with them, in the sense
    in which they move it.
    """
    sense = 1 if s.force[which] > 0.0 else -1
    least = 1.0 - (1e-6 if s.spare[0] else 1e-9)
    nothing = UNPRESSED * p.static[which] * s.normal[which]
    for c in range(p.contacts):
        limit = p.static[c] * s.normal[c]
        held = p.static[c] <= RISES or (s.spare[0] != 0 and limit <= nothing)
        if p.rigid[c] and mode[c] != OPEN and s.idle[c] != 0:  # friction alone kept it from lifting off
            mode[c] = OPEN
            s.at_zero[c] = 0
            s.forced[c] = OPEN
        elif mode[c] == STICK and abs(s.force[c]) > limit * (1.0 + JUMPED) + CLEAR * force_noise(p, c, y, s):
            s.at_zero[c] = 1
        elif c == which or (mode[c] == STICK and abs(s.force[c]) >= limit * least and not held):
            s.forced[c] = 1 if s.force[c] > 0.0 else -1
        elif mode[c] == STICK and held and p.g[c, which] != 0.0:
            s.forced[c] = sense if p.g[c, which] > 0.0 else -sense


def even_out(p, t, y, mode, s):
    """Shares of the force that keep sticking contacts furthest below their limits; returns the largest |F|/limit.

    Contacts that do not hold motions of their own leave the split open, and they hold as long as any split does. The
    least largest ratio, by Lawson's multiplicative rule on the weights 1/L of `share_out`: the mean of the squared
    ratios so weighted is never above the square sought, their largest never below.
    """
    worst = 0.0
    for _ in range(EVENED):
        worst, weights, mean = 0.0, 0.0, 0.0
        sticking = list_sticking(p, mode, s)
        for a in range(sticking):
            c = s.stuck[a]
            limit = p.static[c] * s.normal[c]
            if limit > 0.0 and p.static[c] > RISES and s.share[c] > 0.0:
                worst = max(worst, abs(s.force[c]) / limit)
                weights += limit**2 / s.share[c]
                mean += s.force[c] ** 2 / s.share[c]
        if not worst > 0.0 or weights * worst**2 <= mean * (1.0 + NEARLY):
            return worst
        for a in range(sticking):
            c = s.stuck[a]
            limit = p.static[c] * s.normal[c]
            if limit > 0.0 and p.static[c] > RISES and s.share[c] > 0.0:
                ratio = max(abs(s.force[c]) / (limit * worst), 0.1)
                s.bias[c] = min(s.bias[c] / (ratio * np.sqrt(ratio)), 1e6)  # twice 3/4 of a turn would overshoot
        if not derivative(p, t, y, mode, s, s.dy):
            return np.inf
    return worst


def overloaded(p, mode, s):
    """Whether a sticking contact carries more than its limit."""
    over = False
    for c in range(p.contacts):
        over = over or (mode[c] == STICK and abs(s.force[c]) > p.static[c] * s.normal[c])
    return over


def start_modes(p, t, y, mode, s):
    """Modes at the start of a run: open where N < 0 may open, sliding where v is not zero, otherwise decided."""
    if p.varying:
        evaluate_signals(p, t, s)
    contact_kinematics(p, y, s)
    for c in range(p.contacts):
        s.forced[c] = 0
        s.at_zero[c] = 0
        s.leaving[c] = 0
        s.touch[c] = 0
        mode[c] = 1 if s.speed[c] >= 0.0 else -1
        if p.rigid[c]:
            rate, tolerance = gap_rate(p, c, y)
            s.touch[c] = touches(p, c, y, s) and rate <= tolerance
            s.at_zero[c] = s.touch[c] and abs(s.speed[c]) <= slip_tolerance(p, c, y, s)
            mode[c] = mode[c] if s.touch[c] else OPEN
        elif p.unilateral[c] and s.normal[c] < 0.0:
            mode[c] = OPEN
        elif abs(s.speed[c]) <= slip_tolerance(p, c, y, s):
            s.at_zero[c] = 1
        s.old[c] = mode[c]
    return settle(p, t, y, mode, s)


def settle(p, t, y, mode, s):
    """Solve for the modes of all contacts at zero speed together, then remove the drift of those that stick."""
    if not decide(p, t, y, mode, s):
        return False
    for c in range(p.contacts):
        s.leave[c] = LEAVE * rate_terms(p, c, y, s, p.rigid[c] != 0 and mode[c] == OPEN) + RISES
    contact_kinematics(p, y, s)
    for c in range(p.contacts):
        s.fresh[c] = s.at_zero[c] != 0 and mode[c] != STICK and mode[c] != OPEN
        if p.rigid[c] and mode[c] == OPEN:
            s.fresh[c] = s.old[c] != OPEN or s.leaving[c] != 0 or touches(p, c, y, s)
    return hold_still(p, y, mode, s)


def hold_still(p, y, mode, s):
    """Bring to zero what the modes hold there: sliding velocities, and gaps of rigid contacts with their rates."""
    if p.rigid_count > 0:
        return project(p, y, mode, s)
    return remove_drift(p, y, s, list_sticking(p, mode, s))


def remove_drift(p, y, s, sticking):
    """Bring the sliding velocity of the sticking contacts to zero by impulses along their own d."""
    if sticking == 0:
        return True
    for a in range(sticking):
        s.right[a] = s.speed[s.stuck[a]]
    contact_matrix(p, s, sticking)
    solved = solve(s.matrix, s.right, sticking)
    if not solved:
        for a in range(sticking):
            s.wanted[a] = s.speed[s.stuck[a]]
        weigh_sticking(p, s, sticking)
        solved = share_out(s, sticking)
    for a in range(sticking):
        for i in range(p.mk.shape[0]):
            y[p.mk.shape[0] + i] += p.md[s.stuck[a], i] * s.right[a]
    return solved


def decide(p, t, y, mode, s):
    """Modes of the contacts at zero speed: each sticks with |force| <= static N, or slips with v' in its sense.

    One complementarity problem in all of them, solved by principal pivoting from all sticking, in the end by Murty's
    least index; when static exceeds kinetic friction it may cycle, and then all combinations are tried, sticking first.
    """
    guess_modes(p, y, mode, s)
    if not pivoted(p, t, y, mode, s):
        return enumerate_modes(p, t, y, mode, s)
    if caught(p, y, mode, s) and not pivoted(p, t, y, mode, s):
        guess_modes(p, y, mode, s)
        pivoted(p, t, y, mode, s)
    return not pulled_while_held(p, y, mode, s)


def guess_modes(p, y, mode, s):
    """The modes from which the pivoting begins."""
    for c in range(p.contacts):
        if s.at_zero[c] or s.touch[c]:
            mode[c] = first_guess(p, c, y, mode, s)


def pivoted(p, t, y, mode, s):
    """Change modes one by one until no contact wants another; False when that does not end."""
    for turn in range(20 + 10 * p.contacts * p.contacts):
        if not derivative(p, t, y, mode, s, s.dy):
            return False  # contacts on one motion whose speeds part, or rigid ones
        if s.spare[0] and overloaded(p, mode, s):
            even_out(p, t, y, mode, s)
        if not change_one(p, y, mode, s, turn < 4 * p.contacts):
            return True
    return False


def caught(p, y, mode, s):
    """Let those that came to rest stick again where one that stuck until now was let go all the same.

    They were let go first, so that it might stay; where it does not, they come to rest as if it had slipped before.
    """
    lost = False
    for c in range(p.contacts):
        lost = lost or (s.old[c] == STICK and s.forced[c] == 0 and mode[c] != STICK and mode[c] != OPEN)
    found = False
    for c in range(p.contacts):
        new = lost and s.at_zero[c] != 0 and s.old[c] != STICK and s.forced[c] == 0 and mode[c] != OPEN
        if new and mode[c] != STICK and s.normal[c] > normal_noise(p, c, y, s):
            mode[c] = STICK
            found = True
    return found


def change_one(p, y, mode, s, by_load):
    """Give one contact that wants another mode what it wants; False when none does.

    As under a load that rises from nothing: of those that stick beyond their limits, the one furthest beyond goes first
    (`by_load`, else the first). Those that stuck until now come last: what they carry lets them go, not what they would
    carry if others stuck too. So the order in which contacts are named decides nothing.
    """
    for turn in range(2):
        which, to, most = -1, 0, -1.0
        for c in range(p.contacts):
            if (s.old[c] == STICK) == (turn == 1) and (which < 0 or by_load):
                wanted = wanted_mode(p, c, y, mode, s)
                limit = p.static[c] * s.normal[c]
                beyond = abs(s.force[c]) / limit if mode[c] == STICK and limit > 0.0 else np.inf
                if wanted != mode[c] and beyond > most:
                    which, to, most = c, wanted, beyond
        if which >= 0:
            mode[which] = to
            return True
    return False


def pulled_while_held(p, y, mode, s):
    """Whether a contact in tension is held at zero speed by one that sticks: no sense is that of its sliding."""
    for c in range(p.contacts):
        slides = s.at_zero[c] != 0 and mode[c] != STICK and mode[c] != OPEN and p.static[c] > RISES
        if slides and not p.rigid[c] and s.normal[c] < -normal_noise(p, c, y, s):
            noise = CLEAR * force_noise(p, c, y, s) * abs(p.g[c, c])
            held = abs(slip_acceleration(p, c, s.dy, s)) <= noise
            for e in range(p.contacts):
                if held and mode[e] == STICK and p.g[c, e] != 0.0:
                    return True
    return False


def first_guess(p, c, y, mode, s):
    """Sticking, unless a release is forced or the contact is in tension and so can only pass through zero speed."""
    if s.forced[c] != 0:
        return s.forced[c]
    if p.rigid[c]:
        return closed_mode(s, c)
    if s.normal[c] > -normal_noise(p, c, y, s) or s.normal[c] == 0.0:
        return STICK
    return -mode[c] if mode[c] != STICK else (1 if s.force[c] > 0.0 else -1)


def closed_mode(s, c):
    """The first guess for a closed rigid contact: stick where it may, else slip in the sense of its speed."""
    if s.at_zero[c]:
        return STICK
    return 1 if s.speed[c] >= 0.0 else -1


def wanted_mode(p, c, y, mode, s):
    """The mode contact c would rather have, given the forces and accelerations just computed."""
    if s.forced[c] != 0:
        return mode[c]
    if s.touch[c]:
        if mode[c] != OPEN and s.normal[c] < -1e-12 * s.size[c]:
            return OPEN
        if mode[c] == OPEN:
            rate, tolerance = gap_rate(p, c, s.dy)
            shut = rate < -tolerance
            for e in range(p.contacts):
                shared = e != c and p.rigid[e] and mode[e] != OPEN and s.old[c] != OPEN and rate <= tolerance
                shut = shut or (shared and on_one_gap(p, c, e))
            return closed_mode(s, c) if shut else OPEN
    if not s.at_zero[c]:
        return mode[c]
    if mode[c] == STICK:
        if abs(s.force[c]) <= p.static[c] * s.normal[c] + CLEAR * force_noise(p, c, y, s):
            return STICK
        return 1 if s.force[c] > 0.0 else -1
    if mode[c] * slip_acceleration(p, c, s.dy, s) >= -CLEAR * force_noise(p, c, y, s) * max(abs(p.g[c, c]), 1e-300):
        return mode[c]
    return STICK if s.normal[c] >= -normal_noise(p, c, y, s) else -mode[c]


def enumerate_modes(p, t, y, mode, s):
    """Try all 4^k combinations of the k contacts left open, k <= 8; False when none is consistent.

    Left open are the contacts at zero speed and the touching rigid ones, but not those whose release is forced.
    """
    k = 0
    for turn in range(2):  # what stuck until now comes last, and so is let go last
        for c in range(p.contacts):
            if (s.at_zero[c] or s.touch[c]) and s.forced[c] == 0 and (s.old[c] == STICK) == (turn == 1):
                s.chosen[k] = c
                k += 1
    if k > 8:
        return False
    for code in range(4**k):
        rest = code
        allowed = True
        for a in range(k):
            c = s.chosen[a]
            mode[c] = (STICK, 1, -1, OPEN)[rest % 4]
            rest //= 4
            if mode[c] == OPEN:
                allowed = allowed and s.touch[c] != 0
            else:
                allowed = allowed and (s.at_zero[c] != 0 or mode[c] == closed_mode(s, c))
        if allowed and derivative(p, t, y, mode, s, s.dy):
            consistent = True
            for c in range(p.contacts):
                consistent = consistent and wanted_mode(p, c, y, mode, s) == mode[c]
            if consistent:
                return not pulled_while_held(p, y, mode, s)
    return False

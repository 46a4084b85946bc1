"""Landings on rigid contacts: impulses, rebound and the drift of closed contacts; plain loops compiled by `_engine`.

At a landing every rigid contact that touches takes part. With u- and u+ the velocities before and after,

    M (u+ - u-) = sum_c -w_c P_c + d_c F_c
    0 <= P_c,  g'+ >= -e_c g'-,  complementary                      (Newton's law of restitution, g' = -w . u)
    |F_c| <= mu_c P_c: v+ = 0, or F_c = sgn(v+) mu_c P_c              (Coulomb, mu_c at the sliding speed before)

as one complementarity problem, after Moreau 1988 and Glocker 2001. A rebound slower than CLOSING times the fastest
landing of the run is none: the contact stays closed. That ends the endless sequence of ever smaller rebounds.
"""

# mypy: disable-error-code="no-untyped-def"

from squealbox.transient._motion import FASTEST, OPEN, STICK, contact_kinematics, sliding_coefficient
from squealbox.transient._rigid import constrain

CLOSING = 1e-6  # share of the fastest landing below which a rebound counts as none
TOUCH = 1e-12  # share of the terms of gap, or of its rate, below which it counts as zero


def touches(p, c, y, s):
    """Whether the gap of rigid contact c is zero to round-off."""
    total = abs(s.signal[p.contacts + c])
    gap = -s.signal[p.contacts + c]
    for i in range(p.mk.shape[0]):
        total += abs(p.w[c, i] * y[i])
        gap -= p.w[c, i] * y[i]
    return gap <= TOUCH * total


def on_one_gap(p, c, e):
    """Whether two rigid contacts close the same gap: what presses is shared between them, and neither opens alone."""
    own, other, both = 0.0, 0.0, 0.0
    for i in range(p.mk.shape[0]):
        own += p.w[c, i] * p.mw[c, i]
        other += p.w[e, i] * p.mw[e, i]
        both += p.w[c, i] * p.mw[e, i]
    return both > 0.0 and both * both >= (1.0 - 1e-12) * own * other


def gap_rate(p, c, y):
    """(g', round-off of its terms) of rigid contact c, g' = -w . q'."""
    rate = 0.0
    total = 0.0
    for i in range(p.mk.shape[0]):
        rate -= p.w[c, i] * y[p.mk.shape[0] + i]
        total += abs(p.w[c, i] * y[p.mk.shape[0] + i])
    return rate, TOUCH * total


def start_impact(p, y, mode, s):
    """Modes of the rigid contacts at the start of a run, and the impact if one lands just then."""
    contact_kinematics(p, y, s)
    landing = False
    for c in range(p.contacts):
        mode[c] = OPEN
        if p.rigid[c] and touches(p, c, y, s):
            rate, tolerance = gap_rate(p, c, y)
            landing = landing or rate < -tolerance
            if rate <= tolerance:
                mode[c] = 1 if s.speed[c] >= 0.0 else -1
    return impact(p, y, mode, s) if landing else True


def impact(p, y, mode, s):
    """Jump of the velocities at a landing; rigid contacts in a mode other than OPEN take part. False when unsolved."""
    n = p.mk.shape[0]
    contact_kinematics(p, y, s)
    for c in range(p.contacts):
        if p.rigid[c]:
            rate, tolerance = gap_rate(p, c, y)
            s.approach[c] = max(-rate, 0.0) if -rate > tolerance else 0.0
            if mode[c] != OPEN:
                s.clock[FASTEST] = max(s.clock[FASTEST], s.approach[c])
    for c in range(p.contacts):
        s.hit[c] = OPEN
        s.leaving[c] = 0
        if p.rigid[c] and mode[c] != OPEN:
            s.hit[c] = first_hit(p, c)
            s.mu[c] = max(sliding_coefficient(p, c, abs(s.speed[c])), 0.0)
            s.rebound[c] = p.restitution[c] * s.approach[c]
            if s.rebound[c] <= CLOSING * s.clock[FASTEST]:
                s.rebound[c] = 0.0
    if not solve_impact(p, y, mode, s):
        return False
    for c in range(p.contacts):
        if s.hit[c] != OPEN:
            along = 0.0
            through = 0.0
            for i in range(n):
                along += p.d[c, i] * 0.5 * (y[n + i] + s.dy[n + i])
                through -= p.w[c, i] * 0.5 * (y[n + i] + s.dy[n + i])
            y[2 * n + c] += s.force[c] * along
            y[2 * n + p.contacts + 4] += s.normal[c] * through
    for i in range(n):
        y[n + i] = s.dy[n + i]
    contact_kinematics(p, y, s)
    for c in range(p.contacts):
        if p.rigid[c] and mode[c] != OPEN:
            rate, tolerance = gap_rate(p, c, y)
            if rate > max(tolerance, 0.5 * CLOSING * s.clock[FASTEST]):
                mode[c] = OPEN
                s.leaving[c] = 1
    return True


def solve_impact(p, y, mode, s):
    """Murty's least-index pivoting on which contacts keep apart, stick or slide through the impact."""
    n = p.mk.shape[0]
    for _ in range(40 + 20 * p.contacts * p.contacts):
        for i in range(n):
            s.dy[n + i] = y[n + i]
        if not constrain(p, s.hit, s, s.dy, True):
            return False
        changed = False
        for c in range(p.contacts):
            if p.rigid[c] and mode[c] != OPEN:
                wanted = wanted_in_impact(p, c, s)
                if wanted != s.hit[c]:
                    s.hit[c] = wanted
                    changed = True
                    break
        if not changed:
            return True
    return False


def wanted_in_impact(p, c, s):
    """What contact c would rather do in the impact, given the impulses just computed."""
    n = p.mk.shape[0]
    if s.hit[c] == OPEN:
        rate, tolerance = gap_rate(p, c, s.dy)
        return first_hit(p, c) if rate < s.rebound[c] - tolerance else OPEN
    if s.normal[c] < -TOUCH * s.size[c]:
        return OPEN
    if s.hit[c] == STICK:
        if abs(s.force[c]) <= s.mu[c] * s.normal[c] * (1.0 + TOUCH) + TOUCH * s.size[c]:
            return STICK
        return 1 if s.force[c] > 0.0 else -1
    speed = s.signal[c]
    total = abs(speed)
    for i in range(n):
        speed -= p.t[c, i] * s.dy[n + i]
        total += abs(p.t[c, i] * s.dy[n + i])
    return s.hit[c] if s.hit[c] * speed >= -TOUCH * total or p.static[c] == 0.0 else STICK


def first_hit(p, c):
    """What a contact does in an impact until the impulses say otherwise; without static friction it never sticks."""
    return STICK if p.static[c] > 0.0 else 1


def project(p, y, mode, s):
    """Bring gap and gap rate of closed rigid contacts, and the sliding velocity of sticking ones, to zero."""
    n = p.mk.shape[0]
    for c in range(p.contacts):
        s.rebound[c] = 0.0
        if p.rigid[c] and mode[c] != OPEN:
            s.mu[c] = 0.0
            gap = -s.signal[p.contacts + c]
            mobility = 0.0
            for i in range(n):
                gap -= p.w[c, i] * y[i]
                mobility += p.w[c, i] * p.mw[c, i]
            for i in range(n):
                y[i] += p.mw[c, i] * gap / mobility
    for i in range(n):
        s.dy[n + i] = y[n + i]
    solved = constrain(p, mode, s, s.dy, True)
    for i in range(n):
        y[n + i] = s.dy[n + i]
    return solved

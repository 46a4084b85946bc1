"""The equation of motion as plain loops, compiled by `_engine` and run as they stand by the tests.

The leading axis of p.mk is the room for degrees of freedom, zero beyond p.size; loops over contacts run to the count.

Every function here takes the records of `packing`: the problem (p) and the scratch (s). The state y holds q, q' and
then the running energy integrals: work of each contact's friction, of the load, of the skew stiffness, energy taken
out by damping, work of taking out an open contact's reaction, and work of the normal impulses of rigid contacts.
`mode[c]` is +1 or -1 while contact c slips in that sense, 0 while it sticks and 2 while it is open; only the exact
scheme uses it. A rigid contact has -gap in the place of N while it is open; closed, its N is solved for in `_rigid`.
"""

# mypy: disable-error-code="no-untyped-def"

import numpy as np

from squealbox.transient._rigid import constrain
from squealbox.transient._sharing import all_held, contact_matrix, share_out, solve, weigh_sticking
from squealbox.transient.by_kind import (
    WITH_EVENTS,
    law_creep,
    law_grip,
    law_mu,
    law_slope,
    schedule_rate,
    schedule_value,
)

RAW, EXACT, TANH, ARCTAN = 0, 1, 2, 3  # WITH_EVENTS is true in the file compiled for EXACT
STICK, OPEN = 0, 2
ALGEBRAIC, FIRST_ORDER = 0, 1  # kinds of rows without mass, as of `rows`
ROUND_OFF = 2e-14  # of a sum, as a share of its terms
SWING = 160.0  # windows of time make one over the highest angular frequency
# s.clock: time, proposed step, logarithm of the previous error, end of the smooth piece, start of the window in which
# events are counted, last instant inside the piece, fastest landing on a rigid contact so far
TIME, STEP, LOG_ERROR, PIECE, WINDOW, INSIDE, FASTEST = 0, 1, 2, 3, 4, 5, 6
# s.count: accepted, rejected, evaluations, events, rows written, next requested time, next break, events in the window,
# steps over a reversal of sliding among the last ones, 1 after a rejected step, steps over a reversal in all
ACCEPTED, REJECTED, EVALUATIONS, EVENTS, ROWS, NEXT, BREAK, IN_WINDOW, FLIPS, CAUTIOUS = 0, 1, 2, 3, 4, 5, 6, 7, 8, 9
REVERSALS = 10


def evaluate_signals(p, t, s):
    """Speeds, preloads, load and the rates of the speeds at time t, each a sum of weighted schedules.

    s.clock[INSIDE] ends the present smooth piece, so the end of a step onto a kink sees the left side.
    """
    signal = s.signal
    t = min(t, s.clock[INSIDE])
    for i in range(p.signals):
        total = 0.0
        rate = 0.0
        for k in range(p.signal_start[i], p.signal_start[i + 1]):
            kind = p.term_kind[k]
            coefficients = p.term_coefficients[k]
            total += p.term_weight[k] * schedule_value(kind, t, coefficients)
            if i < p.contacts:
                rate += p.term_weight[k] * schedule_rate(kind, t, coefficients)
        signal[i] = total
        if i < p.contacts:
            signal[p.signals + i] = rate


def sliding_coefficient(p, c, v):
    """mu(v) of contact c at sliding speed v, continued by its tangent below zero.

    A trial step may end a little beyond a reversal; the tangent keeps the right-hand side smooth there.
    """
    coefficients = p.law_coefficients[c]
    if v >= 0.0:
        return law_mu(p.law_kind[c], v, coefficients)
    return law_mu(p.law_kind[c], 0.0, coefficients) + v * law_slope(p.law_kind[c], 0.0, coefficients)


def sliding_force(p, c, v, normal, sense):
    """Friction force of a contact that slides: exact with a given sense, raw sgn, or smoothed."""
    if WITH_EVENTS:
        return sense * sliding_coefficient(p, c, sense * v) * normal
    mu = law_mu(p.law_kind[c], abs(v), p.law_coefficients[c])
    if p.scheme == RAW:
        return mu * normal * (1.0 * (v > 0.0) - 1.0 * (v < 0.0))
    if p.scheme == TANH:
        return mu * np.tanh(v / p.smoothing) * normal
    return mu * (2.0 / np.pi) * np.arctan(v / p.smoothing) * normal


def normal_force(p, c, y, s):
    """N0 + n . q of contact c."""
    normal = s.signal[p.contacts + c]
    for i in range(p.mk.shape[0]):
        normal += p.n[c, i] * y[i]
    return normal


def sliding_velocity(p, c, y, s):
    """V - t . q' of contact c."""
    speed = s.signal[c]
    for i in range(p.mk.shape[0]):
        speed -= p.t[c, i] * y[p.mk.shape[0] + i]
    if p.smooth[c] > 0:
        for i in range(p.mk.shape[0]):
            speed -= p.s[c, i] * y[i]
    return speed


def smooth_force(p, c, v, y, s):
    """Force over normal force of a contact whose law is smooth; the rate of its memory goes into s.creep."""
    z = 0.0
    if p.memory[c] >= 0:
        z = y[p.memory[c]]
    coefficients = p.law_coefficients[c]
    s.creep[c] = law_creep(p.smooth[c] - 1, v, z, coefficients)
    return law_grip(p.smooth[c] - 1, v, z, s.creep[c], coefficients)


def slip_acceleration(p, c, dy, s):
    """V' - t . q'' of contact c."""
    rate = s.signal[p.signals + c]
    for i in range(p.mk.shape[0]):
        rate -= p.t[c, i] * dy[p.mk.shape[0] + i]
    return rate


def opening(p, stage, c):
    """Acceleration with which the gap of an open rigid contact begins to open."""
    rate = 0.0
    for i in range(p.mk.shape[0]):
        rate -= p.w[c, i] * stage[0, p.mk.shape[0] + i]
    return rate


def is_open(p, c, mode, normal):
    """Whether contact c is off: by its mode in the exact scheme, else by its normal force."""
    return mode[c] == OPEN if WITH_EVENTS else p.unilateral[c] != 0 and normal <= 0.0


def row_mode(p, c, mode, normal, speed):
    """The mode as output: that of the exact scheme, else open or the sign of the sliding velocity."""
    if WITH_EVENTS:
        return mode[c]
    if is_open(p, c, mode, normal):
        return OPEN
    return int(np.sign(speed))


def list_sticking(p, mode, s):
    """The contacts that stick, into s.stuck; returns how many."""
    sticking = 0
    for c in range(p.contacts):
        if mode[c] == STICK:
            s.stuck[sticking] = c
            sticking += 1
    return sticking


def contact_kinematics(p, y, s):
    """Normal force and sliding velocity of every contact, into s.normal and s.speed."""
    for c in range(p.contacts):
        s.normal[c] = normal_force(p, c, y, s)
        s.speed[c] = sliding_velocity(p, c, y, s)


def derivative(p, t, y, mode, s, dy):
    """dy = y' with the contacts in the given modes, their forces in s.force; True when sticking could be solved."""
    n = p.mk.shape[0]
    if p.varying:
        evaluate_signals(p, t, s)
    sticking = 0
    opened = False
    closed = False
    for c in range(p.contacts):
        normal = normal_force(p, c, y, s)
        speed = sliding_velocity(p, c, y, s)
        force = 0.0
        grip = 0.0
        if p.smooth[c] > 0:
            grip = smooth_force(p, c, speed, y, s)
        if is_open(p, c, mode, normal):
            opened = True
        elif p.smooth[c] > 0:
            force = grip * normal
        elif WITH_EVENTS and p.rigid[c]:
            closed = True
            normal = 0.0
            s.mu[c] = sliding_coefficient(p, c, mode[c] * speed)
        elif WITH_EVENTS and mode[c] == STICK:
            s.stuck[sticking] = c
            sticking += 1
        else:
            force = sliding_force(p, c, speed, normal, float(mode[c]))
        s.normal[c] = normal
        s.speed[c] = speed
        s.force[c] = force
    for i in range(n):
        dy[i] = y[n + i]
        a = s.signal[2 * p.contacts + i]
        for j in range(n):
            a -= p.mk[i, j] * y[j] + p.mc[i, j] * y[n + j]
        for c in range(p.contacts):
            a += p.md[c, i] * s.force[c]
        dy[n + i] = a
    for c in range(p.contacts):
        if p.smooth[c] > 0 and p.memory[c] >= 0:
            dy[n + p.memory[c]] = s.creep[c]
    if opened:
        release_open(p, mode, s, dy)
    solved = True
    if WITH_EVENTS and closed:
        solved = constrain(p, mode, s, dy, False)
    elif WITH_EVENTS and sticking > 0:
        solved = hold(p, s, sticking, dy)
    if p.light:
        without_mass(p, y, dy)
    energy_rates(p, y, s, opening_power(p, y, mode, s) if opened else 0.0, dy)
    return solved


def without_mass(p, y, dy):
    """Rows of first order and algebraic ones: in the place of q'' stands q' of the former, q of the latter.

    Their velocities are written into y, where the energy integrals and the output read them.
    """
    n = p.mk.shape[0]
    for i in range(n):
        if p.kind[i] == FIRST_ORDER:
            dy[i] = dy[n + i]
            y[n + i] = dy[n + i]
            dy[n + i] = 0.0
    for i in range(n):
        if p.kind[i] == ALGEBRAIC:
            y[i] = dy[n + i]
            rate = 0.0
            for j in range(n):
                if p.kind[j] != ALGEBRAIC:
                    rate -= p.mk[i, j] * y[n + j]
            y[n + i] = rate
            dy[i] = 0.0
            dy[n + i] = 0.0


def release_open(p, mode, s, dy):
    """Take the reaction of open contacts, held in K and the load, out of the accelerations."""
    n = p.mk.shape[0]
    for c in range(p.contacts):
        if is_open(p, c, mode, s.normal[c]) and not p.rigid[c]:
            for i in range(n):
                dy[n + i] += p.mw[c, i] * s.normal[c]


def opening_power(p, y, mode, s):
    """The power of that."""
    n = p.mk.shape[0]
    power = 0.0
    for c in range(p.contacts):
        if is_open(p, c, mode, s.normal[c]) and not p.rigid[c]:
            for i in range(n):
                power += p.w[c, i] * y[n + i] * s.normal[c]
    return power


def hold(p, s, sticking, dy):
    """Forces of the sticking contacts from t_c . q'' = V_c', added to the accelerations in dy.

    Contacts that hold the same motion leave the split of the force open: `share_out` chooses.
    """
    n = p.mk.shape[0]
    for a in range(sticking):
        s.right[a] = slip_acceleration(p, s.stuck[a], dy, s)
    contact_matrix(p, s, sticking)
    solved = solve(s.matrix, s.right, sticking)
    s.spare[0] = not solved
    if not solved:
        for a in range(sticking):
            s.wanted[a] = slip_acceleration(p, s.stuck[a], dy, s)
        weigh_sticking(p, s, sticking)
        solved = share_out(s, sticking) and all_held(s, sticking, 0)
    for a in range(sticking):
        c = s.stuck[a]
        s.force[c] = s.right[a]
        s.share[c] = s.weight[a]
        for i in range(n):
            dy[n + i] += p.md[c, i] * s.force[c]
    return solved


def normal_noise(p, c, y, s):
    """Round-off of the terms of a normal force."""
    total = abs(s.signal[p.contacts + c])
    for i in range(p.mk.shape[0]):
        total += abs(p.n[c, i] * y[i])
    return ROUND_OFF * total


def rate_terms(p, c, y, s, lifts):
    """Sum of the sizes of all that makes up V' - t . q'', or the opening w . q'' of a gap; forces as last computed."""
    n = p.mk.shape[0]
    total = 0.0 if lifts else abs(s.signal[p.signals + c])
    for i in range(n):
        row = abs(p.w[c, i] if lifts else p.t[c, i])
        if row != 0.0:
            terms = abs(s.signal[2 * p.contacts + i])
            for j in range(n):
                terms += abs(p.mk[i, j] * y[j]) + abs(p.mc[i, j] * y[n + j])
            for e in range(p.contacts):
                terms += abs(p.md[e, i] * s.force[e])
            total += row * terms
    return total


def slip_tolerance(p, c, y, s):
    """Speed below which a contact counts as being at zero together with another: round-off of its own terms.

    None, -1, for a contact without static friction: it never sticks, and nothing happens when it reverses.
    """
    if p.static[c] == 0.0:
        return -1.0
    total = abs(s.signal[c])
    for i in range(p.mk.shape[0]):
        total += abs(p.t[c, i] * y[p.mk.shape[0] + i])
    return 1e-12 * total


def event_tolerance(p, c, y, s, reference):
    """As `slip_tolerance` at an event, when s.dy holds the accelerations: where all speeds are zero they give a scale.

    `reference` is what is left of the speed that should be zero: another contact on the same motion has no less.
    """
    least = slip_tolerance(p, c, y, s)
    if least < 0.0:
        return least
    rates = abs(s.signal[p.signals + c])
    for i in range(p.mk.shape[0]):
        rates += abs(p.t[c, i] * s.dy[p.mk.shape[0] + i])
    least += 1e-12 * SWING * p.window * rates
    return least + min(10.0 * abs(reference), 1e6 * least)


def force_noise(p, c, y, s):
    """Round-off of the terms that balance in the force of a sticking contact, and of its limit; never zero."""
    total = rate_terms(p, c, y, s, False)
    mobility = abs(p.g[c, c])
    size = ROUND_OFF * total / mobility if mobility > 0.0 else 0.0
    return size + p.static[c] * normal_noise(p, c, y, s) + 1e-300


def energy_rates(p, y, s, opening, dy):
    """Powers of friction, load, skew stiffness, damping and opening, as derivatives of the energy integrals."""
    n = p.mk.shape[0]
    m = p.contacts
    load = 0.0
    skew = 0.0
    damping = 0.0
    for i in range(n):
        v = y[n + i]
        load += s.signal[2 * m + n + i] * v
        row = 0.0
        for j in range(n):
            row += p.c[i, j] * y[n + j]
        damping += v * row
        if p.circulatory:
            row = 0.0
            for j in range(n):
                row += p.ka[i, j] * y[j]
            skew -= v * row
    for c in range(m):
        along = 0.0
        for i in range(n):
            along += p.d[c, i] * y[n + i]
        dy[2 * n + c] = s.force[c] * along
    dy[2 * n + m] = load
    dy[2 * n + m + 1] = skew
    dy[2 * n + m + 2] = damping
    dy[2 * n + m + 3] = opening
    dy[2 * n + m + 4] = 0.0

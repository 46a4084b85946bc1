"""The march through time: steps, step control, events, output and its named ends; compiled by `_engine`.

The whole state of a march lies in the scratch arrays, so it can stop after a budget of steps, be looked at, and go on.
"""

# mypy: disable-error-code="no-untyped-def"

import numpy as np

from squealbox.transient._events import event_values, first_event, step_onto
from squealbox.transient._impacts import project, start_impact
from squealbox.transient._modes import apply_event, remove_drift, start_modes
from squealbox.transient._motion import (
    ACCEPTED,
    BREAK,
    CAUTIOUS,
    EVALUATIONS,
    EVENTS,
    FLIPS,
    IN_WINDOW,
    INSIDE,
    LOG_ERROR,
    NEXT,
    OPEN,
    PIECE,
    REJECTED,
    REVERSALS,
    ROWS,
    STEP,
    STICK,
    TIME,
    WINDOW,
    contact_kinematics,
    derivative,
    evaluate_signals,
    is_open,
    list_sticking,
    normal_force,
    row_mode,
    sliding_velocity,
)
from squealbox.transient._rigid import paradox
from squealbox.transient._runge_kutta import dense_stages, error_norm, first_step, interpolate, take_step
from squealbox.transient.by_kind import WITH_EVENTS

SMALLEST = 1e-300  # a positive number that stands for zero
SOON = 1e-3  # share of a step: what has just begun and ends before it is searched again in a shorter one
# how a call of `march` ended
COMPLETED, RUNNING, UNDERFLOW, NOT_FINITE, CHATTERING, ZENO, INCONSISTENT, STEP_LIMIT = 0, 1, 2, 3, 4, 5, 6, 7
TENSION, PAINLEVE, MISSED, NOT_CONFIRMED = 8, 9, 10, 11
SAMPLED = 16  # every so many steps one is looked at in twice as many places


def begin(p, r, s, o):
    """Modes, first derivative, first step and first output row; returns RUNNING or how it failed."""
    t0 = s.clock[TIME]
    next_piece(p, s, t0)
    evaluate_signals(p, t0, s)
    if WITH_EVENTS:
        ok = start_impact(p, s.state, s.mode, s) if p.rigid_count > 0 else True
        if not (ok and start_modes(p, t0, s.state, s.mode, s)):
            return not_consistent(p, s)
        if p.rigid_count > 0 and paradox(p, s.mode, s):
            return PAINLEVE
    derivative(p, t0, s.state, s.mode, s, s.stage[0])
    if WITH_EVENTS:
        event_values(p, t0, s.state, s.mode, s, s.phi0)
    if s.clock[STEP] == 0.0:
        s.clock[STEP] = first_step(p, r, s, t0, o.largest)
    s.count[EVALUATIONS] += 2
    keep_range(p, s, t0)
    if p.every_step or o.times[0] <= t0:
        derivative(p, t0, s.state, s.mode, s, s.dy)
        write_row(p, s, o.rows, t0, s.state)
        s.count[NEXT] += 1
    return RUNNING


def march(p, r, s, o):
    """Advance until o.end, until o.budget steps are done or the output is full (RUNNING), or until it cannot go on."""
    if s.count[EVALUATIONS] == 0:
        code = begin(p, r, s, o)
        if code != RUNNING:
            return code
    for _ in range(o.budget):
        t = s.clock[TIME]
        if t >= o.end:
            return COMPLETED
        if t >= s.clock[PIECE]:
            next_piece(p, s, t)
            restart(p, s, t)
        if output_full(p, s, o):
            return RUNNING
        if s.count[ACCEPTED] + s.count[REJECTED] >= o.most:
            return CHATTERING if chatters(p, s) else STEP_LIMIT
        end = min(o.end, s.clock[PIECE])
        h = min(s.clock[STEP], o.largest)
        last = t + h >= end - 1e-12 * h
        h = end - t if last else h
        evaluations, solved = take_step(p, r, s, t, h)
        s.count[EVALUATIONS] += evaluations
        error = error_norm(p, r, s, h) if solved else np.inf
        if not error <= 1.0:
            code = reject(p, r, s, h, error, o.least)
            if code != RUNNING:
                return code
            continue
        code = accept(p, r, s, o, t, h, end if last else t + h, error, last)
        if code != RUNNING:
            return code
    return RUNNING


def output_full(p, s, o):
    """True when one more step might not find room for its row or its events."""
    full = p.every_step and s.count[ROWS] >= o.rows.shape[0]
    return full or s.count[EVENTS] + p.contacts > o.events.shape[0]


def reject(p, r, s, h, error, least):
    """Shrink the step; a step below the least one ends the march with the reason."""
    s.count[REJECTED] += 1
    s.count[CAUTIOUS] = 1
    finite = error < np.inf
    s.clock[STEP] = h * (max(0.2, 0.9 * error ** (-1.0 / (r.error_order + 1.0))) if finite else 0.1)
    s.clock[LOG_ERROR] = 0.0
    if s.clock[STEP] > least + 4e-16 * abs(s.clock[TIME]):
        return RUNNING
    if not finite:
        return NOT_FINITE
    return CHATTERING if chatters(p, s) else UNDERFLOW


def chatters(p, s):
    """Whether sliding reverses at most steps of late, or has often reversed and the steps have become tiny."""
    return s.count[FLIPS] > 50 or (s.count[REVERSALS] > 50 and s.clock[STEP] < p.window)


def accept(p, r, s, o, t, h, t_new, error, last):
    """Take the step, or the part of it up to the first event; control the next step; write output."""
    next_step = h * step_factor(r, s, error)
    if WITH_EVENTS:
        theta, which = first_event(p, r, s, t, h)
        soon = 0.0 < theta < SOON and which < p.contacts and s.fresh[which] != 0 and theta * h > 1e-6 * p.window
        if theta < 0.0 or soon:
            s.count[REJECTED] += 1
            s.clock[STEP] = 4.0 * theta * h if soon else 0.25 * h
            return RUNNING
        if theta <= 1.0:
            if theta > 0.0:
                h = step_onto(p, r, s, t, h, theta, which)
                t_new = t + h
                finish_step(p, r, s, o, t, h, t_new)
            else:
                t_new = t
            s.clock[STEP] = max(next_step, s.clock[STEP]) if not last else s.clock[STEP]
            return change_modes(p, s, o.events, t_new, which, theta > 0.0)
        if s.count[ACCEPTED] % SAMPLED == 0 and h > p.window and not modes_held(p, r, t, h, s):
            return MISSED
    else:
        count_flips(p, s)
    finish_step(p, r, s, o, t, h, t_new)
    s.clock[STEP] = next_step if not last else max(next_step, s.clock[STEP])
    if WITH_EVENTS:
        for c in range(p.contacts):
            s.fresh[c] = 0
        if p.varying:
            keep_sticking(p, s, t_new)
            event_values(p, t_new, s.state, s.mode, s, s.phi0)
        else:
            for j in range(2 * p.contacts):
                s.phi0[j] = s.phi1[j]
        if p.rigid_count > 0:
            derivative(p, t_new, s.state, s.mode, s, s.dy)
            if paradox(p, s.mode, s):
                return PAINLEVE
    return RUNNING


def modes_held(p, r, t, h, s):
    """Whether the modes held at eighths of a step in which no event was found: a look at half the search interval."""
    s.count[EVALUATIONS] += dense_stages(p, r, s, t, h)
    held = True
    for i in range(4):
        at = 0.25 * i + 0.125
        interpolate(r, s, at, h)
        event_values(p, t + at * h, s.y_dense, s.mode, s, s.phi)
        for j in range(2 * p.contacts):
            size = max(abs(s.phi0[j]), abs(s.phi1[j]))
            held = held and s.phi[j] >= -max(1e-6, 10.0 * p.rtol) * size
    return held


def step_factor(r, s, error):
    """Proportional-integral control (Gustafsson 1991), limited to [0.2, r.growth]; no growth after a rejected step."""
    log_error = np.log(max(error, 1e-8))
    factor = 0.9 * np.exp((0.4 * s.clock[LOG_ERROR] - 0.7 * log_error) / (r.error_order + 1.0))
    s.clock[LOG_ERROR] = max(log_error, -9.0)
    growth = 1.0 if s.count[CAUTIOUS] else r.growth
    s.count[CAUTIOUS] = 0
    return min(max(factor, 0.2), growth)


def finish_step(p, r, s, o, t, h, t_new):
    """Write the output due in the step, then make its end the present state."""
    if not p.every_step and s.count[NEXT] < o.times.shape[0] and o.times[s.count[NEXT]] <= t_new:
        s.count[EVALUATIONS] += dense_stages(p, r, s, t, h)
        while s.count[NEXT] < o.times.shape[0] and o.times[s.count[NEXT]] <= t_new:
            at = o.times[s.count[NEXT]]
            interpolate(r, s, min((at - t) / h, 1.0), h)
            derivative(p, at, s.y_dense, s.mode, s, s.dy)
            write_row(p, s, o.rows, at, s.y_dense)
            s.count[NEXT] += 1
    for k in range(s.state.shape[0]):
        s.state[k] = s.state_new[k]
        s.stage[0, k] = s.stage[r.stages, k]
    s.clock[TIME] = t_new
    s.count[ACCEPTED] += 1
    keep_range(p, s, t_new)
    if p.every_step:
        if WITH_EVENTS:
            derivative(p, t_new, s.state, s.mode, s, s.dy)
        write_row(p, s, o.rows, t_new, s.state)


def keep_range(p, s, t):
    """The least normal force of each contact that is not open, and its largest sliding speed, over the whole run."""
    if p.varying:
        evaluate_signals(p, t, s)
    for c in range(p.contacts):
        normal = normal_force(p, c, s.state, s)
        if not is_open(p, c, s.mode, normal) and not p.rigid[c]:
            s.lowest[c] = min(s.lowest[c], normal)
        s.fastest[c] = max(s.fastest[c], abs(sliding_velocity(p, c, s.state, s)))


def write_row(p, s, rows, t, y):
    """One row of output: time, state, energy integrals, then N, v, force and mode of each contact as last computed."""
    row = rows[s.count[ROWS]]
    row[0] = t
    room = p.mk.shape[0]
    for k in range(p.size):
        row[1 + k] = y[k]
        row[1 + p.size + k] = y[room + k]
    for k in range(p.contacts + 5):
        row[1 + 2 * p.size + k] = y[2 * room + k]
    first = 6 + 2 * p.size + p.contacts
    for c in range(p.contacts):
        row[first + c] = s.normal[c]
        row[first + p.contacts + c] = s.speed[c]
        row[first + 2 * p.contacts + c] = s.force[c]
        row[first + 3 * p.contacts + c] = row_mode(p, c, s.mode, s.normal[c], s.speed[c])
    s.count[ROWS] += 1


def change_modes(p, s, events, t, which, moved):
    """An event: new modes, a fresh derivative, and the bound on events that ends a Zeno sequence."""
    ok = apply_event(p, t, s.state, s.mode, s, which)
    for c in range(p.contacts):
        if s.mode[c] != s.old[c]:
            events[s.count[EVENTS], 0] = t
            events[s.count[EVENTS], 1] = c
            events[s.count[EVENTS], 2] = s.mode[c]
            s.count[EVENTS] += 1
    if not ok:
        return not_consistent(p, s)
    restart(p, s, t)
    if which >= p.contacts or s.old[which] == OPEN or s.mode[which] == OPEN:
        begin_from_zero(p, s, which)
    rebounds = False
    if p.rigid_count > 0:
        if paradox(p, s.mode, s):
            return PAINLEVE
        for c in range(p.contacts):
            rebounds = rebounds or s.leaving[c] != 0
    if not (rebounds and moved):  # rebounds are bounded by the speed below which a contact stays closed
        s.count[IN_WINDOW] += 1
    if t - s.clock[WINDOW] > p.window:
        s.clock[WINDOW] = t
        s.count[IN_WINDOW] = 0
    if s.count[IN_WINDOW] <= 40 * (p.contacts + 1):
        return RUNNING
    return TENSION if pulled(p, s) else ZENO


def begin_from_zero(p, s, which):
    """A contact that has just opened or closed has N = 0: round-off of the other sign is no event of its own."""
    c = which if which < p.contacts else which - p.contacts
    j = c if s.mode[c] == OPEN else p.contacts + c
    if not p.rigid[c]:
        s.phi0[j] = max(s.phi0[j], SMALLEST)


def pulled(p, s):
    """Whether a contact that cannot open is in tension, or its normal force is just about to turn."""
    largest = 0.0
    for c in range(p.contacts):
        largest = max(largest, abs(s.normal[c]))
    for c in range(p.contacts):
        limit = 1e-3 * largest if s.at_zero[c] else 0.0
        if not p.unilateral[c] and s.normal[c] < limit:
            return True
    return False


def not_consistent(p, s):
    """Why no set of modes was found: a sliding rigid contact that presses itself together, or another reason."""
    if p.rigid_count > 0:
        for c in range(p.contacts):
            if p.rigid[c] and s.mode[c] != STICK:
                sense = s.hit[c]
                s.hit[c] = 1 if s.speed[c] >= 0.0 else -1
                found = paradox(p, s.hit, s)
                s.hit[c] = sense
                if found:
                    return PAINLEVE
    return TENSION if pulled(p, s) else INCONSISTENT


def restart(p, s, t):
    """Derivative and event functions anew after a change of mode or of a schedule's piece."""
    derivative(p, t, s.state, s.mode, s, s.stage[0])
    s.count[EVALUATIONS] += 1
    s.clock[LOG_ERROR] = 0.0
    if WITH_EVENTS:
        event_values(p, t, s.state, s.mode, s, s.phi0)


def next_piece(p, s, t):
    """The next instant at which a schedule has a kink."""
    while s.count[BREAK] < p.break_count and p.breaks[s.count[BREAK]] <= t:
        s.count[BREAK] += 1
    s.clock[PIECE] = p.breaks[s.count[BREAK]] if s.count[BREAK] < p.break_count else np.inf
    s.clock[INSIDE] = np.nextafter(s.clock[PIECE], -np.inf)


def keep_sticking(p, s, t):
    """Under a varying speed the quadrature of V' drifts from V: put sticking contacts back on it."""
    evaluate_signals(p, t, s)
    contact_kinematics(p, s.state, s)
    sticking = list_sticking(p, s.mode, s)
    if sticking > 0 or p.rigid_count > 0:
        if p.rigid_count > 0:
            project(p, s.state, s.mode, s)
        else:
            remove_drift(p, s.state, s, sticking)
        derivative(p, t, s.state, s.mode, s, s.stage[0])
        s.count[EVALUATIONS] += 1


def count_flips(p, s):
    """How many steps, in all and of late, ended with a sliding velocity of the other sign."""
    flipped = False
    for c in range(p.contacts):
        before = sliding_velocity(p, c, s.state, s)
        after = sliding_velocity(p, c, s.state_new, s)
        flipped = flipped or (before > 0.0) != (after > 0.0)
    if flipped:
        s.count[FLIPS] += 1
        s.count[REVERSALS] += 1
    elif s.count[ACCEPTED] % 10 == 0 and s.count[FLIPS] > 0:
        s.count[FLIPS] -= 1

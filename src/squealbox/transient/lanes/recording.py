"""A lane's motion as rows of output: where steps end, or at given instants; and its events. Compiled by `kernel`.

A Taylor step leaves the series of all that is followed, so a row costs no further evaluation of the equation; what lies
within a Runge-Kutta step is told by `stages_again`.
"""

# mypy: disable-error-code="no-untyped-def"

import numpy as np

from squealbox.transient._march import SAMPLED
from squealbox.transient._motion import OPEN, is_open, row_mode
from squealbox.transient.by_kind import WITH_EVENTS
from squealbox.transient.lanes.of_a_shape import (
    CONTACTS,
    DOFS,
    SHARES,
    STAGED,
    UNIT_OF_WINDOW,
    add_works,
    evaluate,
)
from squealbox.transient.lanes.stages_again import write_within

ROWS_WRITTEN, EVENTS_WRITTEN = 0, 1  # of `count`


def room_left(o):
    """Whether one more step is sure to find room for its rows and its events."""
    found = o.times.shape[0] > 0 or o.count[ROWS_WRITTEN] + SHARES <= o.rows.shape[0]
    return found and o.count[EVENTS_WRITTEN] + CONTACTS <= o.events.shape[0]


def first_row(lane, o):
    """The start, if it was asked for."""
    times, rows, count, p, s = o.times, o.rows, o.count, o.p, o.s
    t = lane.t
    for c in range(CONTACTS):
        lane.fastest[c] = abs(s.speed[c])
        if not is_open(p, c, s.mode, s.normal[c]):
            lane.lowest[c] = s.normal[c]
    if times.shape[0] == 0:
        lane.next_sample = -np.inf
    while times.shape[0] == 0 or (count[ROWS_WRITTEN] < times.shape[0] and times[count[ROWS_WRITTEN]] <= t):
        row = rows[count[ROWS_WRITTEN]]
        for k in range(row.shape[0]):
            row[k] = 0.0
        row[0] = t
        state(lane, row)
        first = 6 + 2 * DOFS + CONTACTS
        for c in range(CONTACTS):
            row[first + c] = s.normal[c]
            row[first + CONTACTS + c] = s.speed[c]
            row[first + 2 * CONTACTS + c] = s.force[c]
            row[first + 3 * CONTACTS + c] = row_mode(p, c, s.mode, s.normal[c], s.speed[c])
        count[ROWS_WRITTEN] += 1
        if times.shape[0] == 0:
            return
    if count[ROWS_WRITTEN] < times.shape[0]:
        lane.next_sample = times[count[ROWS_WRITTEN]]
    else:
        lane.next_sample = np.inf


def state(lane, row):
    """q and q' of a row from the present state."""
    for i in range(DOFS):
        row[1 + i] = lane.q[i]
        row[1 + DOFS + i] = lane.v[i]


def write_rows(lane, o):
    """The rows due in the step just taken: at most a sixth of the shortest period apart, or as asked for."""
    times, rows, count = o.times, o.rows, o.count
    t0 = lane.t_old
    t1 = lane.t
    if times.shape[0] == 0:
        if STAGED:
            write_end(lane, rows[count[ROWS_WRITTEN]], o)
            count[ROWS_WRITTEN] += 1
            return
        span = lane.span
        part = lane.window * (1e3 / 12.0)
        parts = min(max(int(np.ceil(span / part - 1e-6)), 1), SHARES)
        for k in range(1, parts + 1):
            share = k / parts
            at = t1 if k == parts else t0 + share * span
            write_from_series(lane, at, share * span, rows[count[ROWS_WRITTEN]], o)
            count[ROWS_WRITTEN] += 1
        state(lane, rows[count[ROWS_WRITTEN] - 1])
        return
    k = count[ROWS_WRITTEN]
    if STAGED and times[k] < t1:
        k = write_within(lane, k, o)
    while k < times.shape[0] and times[k] <= t1:
        if STAGED:
            write_end(lane, rows[k], o)
        else:
            write_from_series(lane, times[k], max(times[k] - t0, 0.0), rows[k], o)
            if times[k] == t1:
                state(lane, rows[k])
        k += 1
    count[ROWS_WRITTEN] = k
    lane.next_sample = times[k] if k < times.shape[0] else np.inf


def write_end(lane, row, o):
    """The row at the end of a step without events, which keeps its contacts there."""
    row[0] = lane.t
    state(lane, row)
    for k in range(CONTACTS + 4):
        row[1 + 2 * DOFS + k] = lane.done[k]
    row[5 + 2 * DOFS + CONTACTS] = 0.0
    first = 6 + 2 * DOFS + CONTACTS
    for c in range(CONTACTS):
        row[first + c] = lane.normal_end[c]
        row[first + CONTACTS + c] = lane.speed_end[c]
        row[first + 2 * CONTACTS + c] = lane.friction_end[c]
        row[first + 3 * CONTACTS + c] = row_mode(o.p, c, o.s.mode, row[first + c], row[first + CONTACTS + c])


def add_up(lane):
    """Add up the works of the Taylor step just taken, and keep how its contacts ranged."""
    for k in range(CONTACTS + 4):
        lane.was[k] = lane.done[k]
    if not lane.span > 0.0:
        return
    lane.since = lane.span / (lane.window * UNIT_OF_WINDOW)
    add_works(lane)
    for k in range(CONTACTS + 4):
        lane.done[k] += lane.gain[k]
    for c in range(CONTACTS):
        lane.lowest[c] = min(lane.lowest[c], lane.trough[c])
        lane.fastest[c] = max(lane.fastest[c], lane.peak[c])


def write_from_series(lane, t, since, row, o):
    """One row from the series of the step: time, state, works, then N, v, force and mode of each contact."""
    unit = lane.window * UNIT_OF_WINDOW
    lane.since = since / unit
    evaluate(lane)
    row[0] = t
    for i in range(DOFS):
        row[1 + i] = lane.value[i]
        row[1 + DOFS + i] = lane.slope[i] / unit
    if since < lane.span:
        add_works(lane)
        for k in range(CONTACTS + 4):
            row[1 + 2 * DOFS + k] = lane.was[k] + lane.gain[k]
    else:
        for k in range(CONTACTS + 4):
            row[1 + 2 * DOFS + k] = lane.done[k]
    row[5 + 2 * DOFS + CONTACTS] = 0.0
    first = 6 + 2 * DOFS + CONTACTS
    for k in range(3 * CONTACTS):
        row[first + k] = lane.value[DOFS + k]
    for c in range(CONTACTS):
        if WITH_EVENTS:
            mode = lane.slips[c]
            row[first + 3 * CONTACTS + c] = OPEN if lane.opened[c] > 0.0 else mode
        else:
            row[first + 3 * CONTACTS + c] = row_mode(o.p, c, o.s.mode, row[first + c], row[first + CONTACTS + c])


def series_held(lane, p):
    """Whether the modes held throughout the step just taken: every so many steps, a look in twice as many places."""
    span = lane.span
    if int(lane.taken) % SAMPLED != 0 or not span > lane.window:
        return True
    unit = lane.window * UNIT_OF_WINDOW
    first = DOFS
    held = True
    for k in range(2 * SHARES):
        lane.since = (k + 0.5) / (2 * SHARES) * span / unit
        evaluate(lane)
        for c in range(CONTACTS):
            normal = lane.value[first + c]
            speed = lane.value[first + CONTACTS + c]
            force = abs(lane.value[first + 2 * CONTACTS + c])
            slips = lane.slips[c]
            if p.smooth[c] > 0:
                continue
            if lane.opened[c] > 0.0:
                held = held and normal <= 1e-6 * abs(lane.lowest[c])
            elif p.static[c] > 0.0 and slips != 0.0:
                held = held and slips * speed >= -1e-6 * lane.fastest[c]
            elif p.static[c] > 0.0:
                limit = p.static[c] * normal
                held = held and force - limit <= 1e-6 * (force + abs(limit)) + 100.0 * lane.noise[c]
    return held


def log_event(lane, c, mode, o):
    """Contact c has taken another mode."""
    o.events[o.count[EVENTS_WRITTEN], 0] = lane.t
    o.events[o.count[EVENTS_WRITTEN], 1] = c
    o.events[o.count[EVENTS_WRITTEN], 2] = mode
    o.count[EVENTS_WRITTEN] += 1

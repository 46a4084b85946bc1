"""A lane's motion as rows of output: where steps end, or at given instants; and its events. Compiled by `kernel`.

A Taylor step leaves the series of all that is followed, so a row costs no further evaluation of the equation; what lies
within a Runge-Kutta step is told by `stages_again`.
"""

# ruff: noqa: F821  (the places of the rows and the counts are generated)
# mypy: disable-error-code="name-defined,no-untyped-def"

import numpy as np

from squealbox.transient._march import SAMPLED
from squealbox.transient._motion import OPEN, is_open, row_mode
from squealbox.transient.lanes.stages_again import write_within

ROWS_WRITTEN, EVENTS_WRITTEN = 0, 1  # of `count`


def room_left(o):
    """Whether one more step is sure to find room for its rows and its events."""
    found = o.times.shape[0] > 0 or o.count[ROWS_WRITTEN] + SHARES <= o.rows.shape[0]
    return found and o.count[EVENTS_WRITTEN] + CONTACTS <= o.events.shape[0]


def first_row(A, b, lane, o):
    """The start, if it was asked for."""
    times, rows, count, p, s = o.times, o.rows, o.count, o.p, o.s
    t = A[b + ROW_T * WIDTH + lane]
    for c in range(CONTACTS):
        A[b + (ROW_FASTEST + c) * WIDTH + lane] = abs(s.speed[c])
        if not is_open(p, c, s.mode, s.normal[c]):
            A[b + (ROW_LOWEST + c) * WIDTH + lane] = s.normal[c]
    if times.shape[0] == 0:
        A[b + ROW_NEXT_SAMPLE * WIDTH + lane] = -np.inf
    while times.shape[0] == 0 or (count[ROWS_WRITTEN] < times.shape[0] and times[count[ROWS_WRITTEN]] <= t):
        row = rows[count[ROWS_WRITTEN]]
        for k in range(row.shape[0]):
            row[k] = 0.0
        row[0] = t
        state(A, b, lane, row)
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
        A[b + ROW_NEXT_SAMPLE * WIDTH + lane] = times[count[ROWS_WRITTEN]]
    else:
        A[b + ROW_NEXT_SAMPLE * WIDTH + lane] = np.inf


def state(A, b, lane, row):
    """q and q' of a row from the present state."""
    for i in range(DOFS):
        row[1 + i] = A[b + (ROW_Q + i) * WIDTH + lane]
        row[1 + DOFS + i] = A[b + (ROW_V + i) * WIDTH + lane]


def write_rows(A, b, lane, o):
    """The rows due in the step just taken: at most a sixth of the shortest period apart, or as asked for."""
    times, rows, count = o.times, o.rows, o.count
    t0 = A[b + ROW_T_OLD * WIDTH + lane]
    t1 = A[b + ROW_T * WIDTH + lane]
    if times.shape[0] == 0:
        if STAGED:
            write_end(A, b, lane, rows[count[ROWS_WRITTEN]], o)
            count[ROWS_WRITTEN] += 1
            return
        span = A[b + ROW_SPAN * WIDTH + lane]
        part = A[b + ROW_WINDOW * WIDTH + lane] * (1e3 / 12.0)
        parts = min(max(int(np.ceil(span / part - 1e-6)), 1), SHARES)
        for k in range(1, parts + 1):
            share = k / parts
            at = t1 if k == parts else t0 + share * span
            write_from_series(A, b, lane, at, share * span, rows[count[ROWS_WRITTEN]], o)
            count[ROWS_WRITTEN] += 1
        state(A, b, lane, rows[count[ROWS_WRITTEN] - 1])
        return
    k = count[ROWS_WRITTEN]
    if STAGED and times[k] < t1:
        k = write_within(A, b, lane, k, o)
    while k < times.shape[0] and times[k] <= t1:
        if STAGED:
            write_end(A, b, lane, rows[k], o)
        else:
            write_from_series(A, b, lane, times[k], max(times[k] - t0, 0.0), rows[k], o)
            if times[k] == t1:
                state(A, b, lane, rows[k])
        k += 1
    count[ROWS_WRITTEN] = k
    A[b + ROW_NEXT_SAMPLE * WIDTH + lane] = times[k] if k < times.shape[0] else np.inf


def write_end(A, b, lane, row, o):
    """The row at the end of a step without events, which keeps its contacts there."""
    row[0] = A[b + ROW_T * WIDTH + lane]
    state(A, b, lane, row)
    for k in range(CONTACTS + 4):
        row[1 + 2 * DOFS + k] = A[b + (ROW_DONE + k) * WIDTH + lane]
    row[5 + 2 * DOFS + CONTACTS] = 0.0
    first = 6 + 2 * DOFS + CONTACTS
    for c in range(CONTACTS):
        row[first + c] = A[b + (ROW_NORMAL_END + c) * WIDTH + lane]
        row[first + CONTACTS + c] = A[b + (ROW_SPEED_END + c) * WIDTH + lane]
        row[first + 2 * CONTACTS + c] = A[b + (ROW_FRICTION_END + c) * WIDTH + lane]
        row[first + 3 * CONTACTS + c] = row_mode(o.p, c, o.s.mode, row[first + c], row[first + CONTACTS + c])


def write_from_series(A, b, lane, t, since, row, o):
    """One row from the series of the step: time, state, works, then N, v, force and mode of each contact."""
    unit = A[b + ROW_WINDOW * WIDTH + lane] * UNIT_OF_WINDOW
    A[b + ROW_SINCE] = since / unit
    evaluate(A, b)
    row[0] = t
    for i in range(DOFS):
        row[1 + i] = A[b + ROW_VALUE + i]
        row[1 + DOFS + i] = A[b + ROW_SLOPE + i] / unit
    for j in range(DOFS, DOFS + CONTACTS + 4):
        row[1 + DOFS + j] = A[b + ROW_VALUE + j]
    for j in range(DOFS + CONTACTS + 4, FOLLOWED):
        row[2 + DOFS + j] = A[b + ROW_VALUE + j]
    row[5 + 2 * DOFS + CONTACTS] = 0.0
    first = 6 + 2 * DOFS + CONTACTS
    for c in range(CONTACTS):
        if EXACT_CONTACT:
            mode = A[b + (ROW_SLIPS + c) * WIDTH + lane]
            row[first + 3 * CONTACTS + c] = OPEN if A[b + (ROW_OPENED + c) * WIDTH + lane] > 0.0 else mode
        else:
            row[first + 3 * CONTACTS + c] = row_mode(o.p, c, o.s.mode, row[first + c], row[first + CONTACTS + c])


def series_held(A, b, p):
    """Whether the modes held throughout the step just taken: every so many steps, a look in twice as many places."""
    span = A[b + ROW_SPAN]
    if int(A[b + ROW_TAKEN]) % SAMPLED != 0 or not span > A[b + ROW_WINDOW]:
        return True
    unit = A[b + ROW_WINDOW] * UNIT_OF_WINDOW
    first = b + ROW_VALUE + DOFS + CONTACTS + 4
    held = True
    for k in range(2 * SHARES):
        A[b + ROW_SINCE] = (k + 0.5) / (2 * SHARES) * span / unit
        evaluate(A, b)
        for c in range(CONTACTS):
            normal = A[first + c]
            speed = A[first + CONTACTS + c]
            force = abs(A[first + 2 * CONTACTS + c])
            slips = A[b + ROW_SLIPS + c]
            if p.smooth[c] > 0:
                continue
            if A[b + ROW_OPENED + c] > 0.0:
                held = held and normal <= 1e-6 * abs(A[b + ROW_LOWEST + c])
            elif p.static[c] > 0.0 and slips != 0.0:
                held = held and slips * speed >= -1e-6 * A[b + ROW_FASTEST + c]
            elif p.static[c] > 0.0:
                limit = p.static[c] * normal
                held = held and force - limit <= 1e-6 * (force + abs(limit)) + 100.0 * A[b + ROW_NOISE + c]
    return held


def log_event(A, b, lane, c, mode, o):
    """Contact c has taken another mode."""
    o.events[o.count[EVENTS_WRITTEN], 0] = A[b + ROW_T * WIDTH + lane]
    o.events[o.count[EVENTS_WRITTEN], 1] = c
    o.events[o.count[EVENTS_WRITTEN], 2] = mode
    o.count[EVENTS_WRITTEN] += 1

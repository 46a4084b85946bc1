"""What lies within a Runge-Kutta step of a recorded motion: the step is taken once more with the records of the scalar
march, whose dense output tells the rows asked for. Compiled by `kernel`; without events.
"""

# ruff: noqa: F821  (the places of the rows, the counts and gather are generated; load_state is of `service`)
# mypy: disable-error-code="name-defined,no-untyped-def"

import numpy as np

from squealbox.transient._march import write_row
from squealbox.transient._motion import INSIDE, ROWS, derivative, evaluate_signals, row_mode
from squealbox.transient._runge_kutta import dense_stages, interpolate, take_step


def write_end(A, b, lane, row, o):
    """The row at the end of the step just taken."""
    row[0] = A[b + ROW_T * WIDTH + lane]
    for i in range(DOFS):
        row[1 + i] = A[b + (ROW_Q + i) * WIDTH + lane]
        row[1 + DOFS + i] = A[b + (ROW_V + i) * WIDTH + lane]
    for k in range(CONTACTS + 4):
        row[1 + 2 * DOFS + k] = A[b + (ROW_DONE + k) * WIDTH + lane]
    row[5 + 2 * DOFS + CONTACTS] = 0.0
    first = 6 + 2 * DOFS + CONTACTS
    for c in range(CONTACTS):
        row[first + c] = A[b + (ROW_NORMAL_END + c) * WIDTH + lane]
        row[first + CONTACTS + c] = A[b + (ROW_SPEED_END + c) * WIDTH + lane]
        row[first + 2 * CONTACTS + c] = A[b + (ROW_FRICTION_END + c) * WIDTH + lane]
        row[first + 3 * CONTACTS + c] = row_mode(o.p, c, o.s.mode, row[first + c], row[first + CONTACTS + c])


def step_again(A, b, lane, o):
    """The step just taken once more, with the stages of its dense output; returns its length."""
    p, r, s = o.p, o.r, o.s
    room = p.mk.shape[0]
    t0 = A[b + ROW_T_OLD * WIDTH + lane]
    evaluate_signals(p, t0, s)  # the load's own, whose power no lane needs otherwise, and all that `gather` sets
    gather(A, b, lane, p, s)
    load_state(A, b, lane, p, s)
    t1 = A[b + ROW_T * WIDTH + lane]
    s.clock[INSIDE] = np.nextafter(t1, -np.inf)
    for i in range(DOFS):
        s.state[i] = A[b + (ROW_Q_OLD + i) * WIDTH + lane]
        s.state[room + i] = A[b + (ROW_V_OLD + i) * WIDTH + lane]
    for k in range(CONTACTS + 4):
        s.state[2 * room + k] = A[b + (ROW_WAS + k) * WIDTH + lane]
    derivative(p, t0, s.state, s.mode, s, s.stage[0])
    take_step(p, r, s, t0, t1 - t0)
    return t1 - t0


def write_within(A, b, lane, k, o):
    """The rows from number k on that lie before the end of the step just taken; returns the number of the next."""
    p, r, s, times = o.p, o.r, o.s, o.times
    t0 = A[b + ROW_T_OLD * WIDTH + lane]
    h = step_again(A, b, lane, o)
    dense_stages(p, r, s, t0, h)
    while k < times.shape[0] and times[k] < A[b + ROW_T * WIDTH + lane]:
        interpolate(r, s, min(max((times[k] - t0) / h, 0.0), 1.0), h)
        derivative(p, times[k], s.y_dense, s.mode, s, s.dy)
        s.count[ROWS] = k
        write_row(p, s, o.rows, times[k], s.y_dense)
        k += 1
    return k

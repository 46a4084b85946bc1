"""What lies within a Runge-Kutta step of a recorded motion: the step is taken once more with the records of the scalar
march, whose dense output tells the rows asked for and whether the modes held. Compiled by `kernel`.
"""

# ruff: noqa: F821  (the places of the rows, the counts and gather are generated; load_state is of `service`)
# mypy: disable-error-code="name-defined,no-untyped-def"

import numpy as np

from squealbox.transient._events import event_values
from squealbox.transient._march import SAMPLED, modes_held, write_row
from squealbox.transient._motion import INSIDE, ROWS, derivative, evaluate_signals, row_mode
from squealbox.transient._runge_kutta import dense_stages, interpolate, take_step


def write_end(A, b, lane, row, o):
    """The row at the end of the step just taken."""
    p, s = o.p, o.s
    t = A[b + ROW_T * WIDTH + lane]
    row[0] = t
    for i in range(DOFS):
        row[1 + i] = A[b + (ROW_Q + i) * WIDTH + lane]
        row[1 + DOFS + i] = A[b + (ROW_V + i) * WIDTH + lane]
    for k in range(CONTACTS + 4):
        row[1 + 2 * DOFS + k] = A[b + (ROW_DONE + k) * WIDTH + lane]
    row[5 + 2 * DOFS + CONTACTS] = 0.0
    if EXACT_CONTACT:
        gather(A, b, lane, p, s)
        load_state(A, b, lane, p, s)
        s.clock[INSIDE] = np.nextafter(t, -np.inf)  # a kink at the end is seen from the left
        derivative(p, t, s.state, s.mode, s, s.dy)
    first = 6 + 2 * DOFS + CONTACTS
    for c in range(CONTACTS):
        if not EXACT_CONTACT:
            s.normal[c] = A[b + (ROW_NORMAL_END + c) * WIDTH + lane]
            s.speed[c] = A[b + (ROW_SPEED_END + c) * WIDTH + lane]
            s.force[c] = A[b + (ROW_FRICTION_END + c) * WIDTH + lane]
        row[first + c] = s.normal[c]
        row[first + CONTACTS + c] = s.speed[c]
        row[first + 2 * CONTACTS + c] = s.force[c]
        row[first + 3 * CONTACTS + c] = row_mode(p, c, s.mode, s.normal[c], s.speed[c])


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


def held_between(A, b, lane, o):
    """Whether the modes held throughout the step just taken: every so many steps, a look in twice as many places."""
    p, r, s = o.p, o.r, o.s
    t0 = A[b + ROW_T_OLD * WIDTH + lane]
    if int(A[b + ROW_TAKEN * WIDTH + lane]) % SAMPLED != 0:
        return True
    if not A[b + ROW_T * WIDTH + lane] - t0 > A[b + ROW_WINDOW * WIDTH + lane]:
        return True
    h = step_again(A, b, lane, o)
    event_values(p, t0, s.state, s.mode, s, s.phi0)
    event_values(p, t0 + h, s.state_new, s.mode, s, s.phi1)
    return modes_held(p, r, t0, h, s)

"""What lies within a Runge-Kutta step of a recorded motion: the step is taken once more with the records of the scalar
march, whose dense output tells the rows asked for. Compiled by `kernel`; without events.
"""

# mypy: disable-error-code="no-untyped-def"

import numpy as np

from squealbox.transient._march import write_row
from squealbox.transient._motion import INSIDE, ROWS, derivative, evaluate_signals
from squealbox.transient._runge_kutta import dense_stages, interpolate, take_step
from squealbox.transient.lanes.of_a_shape import CONTACTS, DOFS, gather
from squealbox.transient.lanes.samples import load_state


def write_within(lane, k, o):
    """The rows from number k on that lie before the end of the step just taken; returns the number of the next."""
    p, r, s, times = o.p, o.r, o.s, o.times
    room = p.mk.shape[0]
    t0 = lane.t_old
    t1 = lane.t
    evaluate_signals(p, t0, s)  # the load's own, whose power no lane needs otherwise, and all that `gather` sets
    gather(lane, p, s)
    load_state(lane, p, s)
    s.clock[INSIDE] = np.nextafter(t1, -np.inf)
    for i in range(DOFS):
        s.state[i] = lane.q_old[i]
        s.state[room + i] = lane.v_old[i]
    for i in range(CONTACTS + 4):
        s.state[2 * room + i] = lane.was[i]
    derivative(p, t0, s.state, s.mode, s, s.stage[0])
    h = t1 - t0
    take_step(p, r, s, t0, h)
    dense_stages(p, r, s, t0, h)
    while k < times.shape[0] and times[k] < t1:
        interpolate(r, s, min(max((times[k] - t0) / h, 0.0), 1.0), h)
        derivative(p, times[k], s.y_dense, s.mode, s, s.dy)
        s.count[ROWS] = k
        write_row(p, s, o.rows, times[k], s.y_dense)
        k += 1
    return k

"""A lane's state: into the records of the scalar march, or at an instant within its last step; compiled by `kernel`."""

# mypy: disable-error-code="no-untyped-def"

import numpy as np

from squealbox.transient._motion import INSIDE, OPEN, derivative
from squealbox.transient._runge_kutta import take_step
from squealbox.transient.by_kind import WITH_EVENTS
from squealbox.transient.lanes.of_a_shape import CONTACTS, DOFS, TERMS, UNIT_OF_WINDOW


def load_state(lane, p, s):
    """State and modes of a lane into the records of the scalar march."""
    room = p.mk.shape[0]
    s.clock[INSIDE] = np.inf
    for i in range(DOFS):
        s.state[i] = lane.q[i]
        s.state[room + i] = lane.v[i]
    if WITH_EVENTS:
        for c in range(CONTACTS):
            s.bias[c] = 1.0
            s.mode[c] = OPEN if lane.opened[c] > 0.0 else int(lane.slips[c])


def on_end(lane, row):
    """The end of the step itself."""
    for i in range(DOFS):
        row[i] = lane.q[i]
        row[DOFS + i] = lane.v[i]


def on_step(lane, at, row, o):
    """By a step of the method itself from the beginning of the lane's step, in the modes it had."""
    p, r, s = o.p, o.r, o.s
    room = p.mk.shape[0]
    t0 = lane.t_old
    for i in range(DOFS):
        s.state[i] = lane.q_old[i]
        s.state[room + i] = lane.q_old[DOFS + i]
    derivative(p, t0, s.state, s.mode, s, s.stage[0])
    take_step(p, r, s, t0, max(at - t0, 0.0))
    for i in range(DOFS):
        row[i] = s.state_new[i]
        row[DOFS + i] = s.state_new[room + i]


def on_quintic(lane, at, row):
    """By the quintic of q, q' and q'' at both ends of the step."""
    t0 = lane.t_old
    h = lane.t - t0
    x = min(max((at - t0) / h, 0.0), 1.0) if h > 0.0 else 1.0
    for i in range(DOFS):
        q0 = lane.q_old[i]
        v0 = lane.q_old[DOFS + i] * h
        a0 = lane.q_old[2 * DOFS + i] * h * h
        rise = lane.q[i] - q0 - v0 - 0.5 * a0
        turn = lane.v[i] * h - v0 - a0
        bend = lane.acceleration[i] * h * h - a0
        c3 = 10.0 * rise - 4.0 * turn + 0.5 * bend
        c4 = -15.0 * rise + 7.0 * turn - bend
        c5 = 6.0 * rise - 3.0 * turn + 0.5 * bend
        row[i] = q0 + x * (v0 + x * (0.5 * a0 + x * (c3 + x * (c4 + x * c5))))
        speed = v0 + x * (a0 + x * (3.0 * c3 + x * (4.0 * c4 + x * 5.0 * c5)))
        row[DOFS + i] = speed / h if h > 0.0 else lane.v[i]


def on_series(lane, at, row):
    """By the series of a Taylor step."""
    unit = lane.window * UNIT_OF_WINDOW
    x = max(at - lane.t_old, 0.0) / unit
    for i in range(DOFS):
        q = 0.0
        v = 0.0
        for order in range(TERMS - 1, -1, -1):
            v = v * x + q
            q = q * x + lane.term[i * TERMS + order]
        row[i] = q
        row[DOFS + i] = v / unit

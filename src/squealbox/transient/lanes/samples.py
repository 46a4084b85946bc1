"""A lane's state at an instant within its last step: q, then q', into a row of samples; compiled by `kernel`."""

# ruff: noqa: F821  (the places of the rows, DOFS and TERMS are generated)
# mypy: disable-error-code="name-defined,no-untyped-def"

from squealbox.transient._motion import derivative
from squealbox.transient._runge_kutta import take_step


def on_end(A, b, lane, row):
    """The end of the step itself."""
    for i in range(DOFS):
        row[i] = A[b + (ROW_Q + i) * WIDTH + lane]
        row[DOFS + i] = A[b + (ROW_V + i) * WIDTH + lane]


def on_step(A, b, lane, at, row, o):
    """By a step of the method itself from the beginning of the lane's step, in the modes it had."""
    p, r, s = o.p, o.r, o.s
    room = p.mk.shape[0]
    t0 = A[b + ROW_T_OLD * WIDTH + lane]
    for i in range(DOFS):
        s.state[i] = A[b + (ROW_Q_OLD + i) * WIDTH + lane]
        s.state[room + i] = A[b + (ROW_Q_OLD + DOFS + i) * WIDTH + lane]
    derivative(p, t0, s.state, s.mode, s, s.stage[0])
    take_step(p, r, s, t0, max(at - t0, 0.0))
    for i in range(DOFS):
        row[i] = s.state_new[i]
        row[DOFS + i] = s.state_new[room + i]


def on_quintic(A, b, lane, at, row):
    """By the quintic of q, q' and q'' at both ends of the step."""
    t0 = A[b + ROW_T_OLD * WIDTH + lane]
    h = A[b + ROW_T * WIDTH + lane] - t0
    x = min(max((at - t0) / h, 0.0), 1.0) if h > 0.0 else 1.0
    for i in range(DOFS):
        q0 = A[b + (ROW_Q_OLD + i) * WIDTH + lane]
        v0 = A[b + (ROW_Q_OLD + DOFS + i) * WIDTH + lane] * h
        a0 = A[b + (ROW_Q_OLD + 2 * DOFS + i) * WIDTH + lane] * h * h
        rise = A[b + (ROW_Q + i) * WIDTH + lane] - q0 - v0 - 0.5 * a0
        turn = A[b + (ROW_V + i) * WIDTH + lane] * h - v0 - a0
        bend = A[b + (ROW_ACCELERATION + i) * WIDTH + lane] * h * h - a0
        c3 = 10.0 * rise - 4.0 * turn + 0.5 * bend
        c4 = -15.0 * rise + 7.0 * turn - bend
        c5 = 6.0 * rise - 3.0 * turn + 0.5 * bend
        row[i] = q0 + x * (v0 + x * (0.5 * a0 + x * (c3 + x * (c4 + x * c5))))
        speed = v0 + x * (a0 + x * (3.0 * c3 + x * (4.0 * c4 + x * 5.0 * c5)))
        row[DOFS + i] = speed / h if h > 0.0 else A[b + (ROW_V + i) * WIDTH + lane]


def on_series(A, b, lane, at, row):
    """By the series of a Taylor step."""
    unit = A[b + ROW_WINDOW * WIDTH + lane] * UNIT_OF_WINDOW
    x = max(at - A[b + ROW_T_OLD * WIDTH + lane], 0.0) / unit
    for i in range(DOFS):
        q = 0.0
        v = 0.0
        for order in range(TERMS - 1, -1, -1):
            v = v * x + q
            q = q * x + A[b + (ROW_TERM + i * TERMS + order) * WIDTH + lane]
        row[i] = q
        row[DOFS + i] = v / unit

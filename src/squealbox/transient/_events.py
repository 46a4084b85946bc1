"""Where in a step a contact changes its mode; plain loops compiled by `_engine`.

Each contact has an event function that is positive while its mode holds: the speed in its sense of slip, the margin of
static friction while it sticks, the opening (-N) while it is open; a unilateral contact that slips has a second one,
its normal force. A step is searched on the dense output. Five values of an event function define a quartic; when all
its Bernstein coefficients are positive the quartic has no root in the interval, otherwise the interval is halved. So
two crossings inside one step are not missed.
"""

# mypy: disable-error-code="name-defined,no-untyped-def"

import numpy as np

from squealbox.transient._motion import (
    EVALUATIONS,
    OPEN,
    STICK,
    contact_kinematics,
    derivative,
    evaluate_signals,
    slip_acceleration,
)
from squealbox.transient._runge_kutta import dense_stages, interpolate, take_step

NO_EVENT = 2.0  # any theta above 1


def event_values(p, t, y, mode, s, phi):
    """Event functions of all contacts: phi[c] for its mode, phi[contacts + c] for lift-off of a slipping contact."""
    m = p.contacts
    any_stick = False
    for c in range(m):
        any_stick = any_stick or mode[c] == STICK
    if any_stick:
        derivative(p, t, y, mode, s, s.dy)
    else:
        if p.varying:
            evaluate_signals(p, t, s)
        contact_kinematics(p, y, s)
    for c in range(m):
        phi[m + c] = 1.0
        if mode[c] == OPEN:
            phi[c] = -s.normal[c]
        elif mode[c] == STICK:
            phi[c] = p.static[c] * s.normal[c] - abs(s.force[c])
        else:
            phi[c] = mode[c] * s.speed[c]
            if p.unilateral[c]:
                phi[m + c] = s.normal[c]


def surely_none(p, h, mode, s, stage, last, phi0, phi1):
    """True when every contact slips and its speed's Hermite cubic stays well away from zero over the step."""
    for c in range(p.contacts):
        if mode[c] == STICK or mode[c] == OPEN or s.fresh[c] or p.unilateral[c] or p.varying:
            return False
        b1 = phi0[c] + mode[c] * slip_acceleration(p, c, stage[0], s) * h / 3.0
        b2 = phi1[c] - mode[c] * slip_acceleration(p, c, stage[last], s) * h / 3.0
        margin = 0.2 * (abs(phi1[c] - phi0[c]) + abs(b1 - phi0[c]) + abs(b2 - phi1[c]))
        if not (phi0[c] > margin and phi1[c] > margin and b1 > margin and b2 > margin):
            return False
    return True


def first_event(p, r, t, h, y, y_new, mode, s, stage):
    """(theta, j): the first root of an event function in the step, or NO_EVENT; j < contacts or contacts + c.

    s.phi0 holds the event functions at the start. theta = 0 means that a mode does not hold even there.
    """
    m = p.contacts
    event_values(p, t + h, y_new, mode, s, s.phi1)
    for c in range(m):
        if not s.fresh[c] and not s.phi0[c] > 0.0:
            return 0.0, c
    if surely_none(p, h, mode, s, stage, r.stages, s.phi0, s.phi1):
        return NO_EVENT, -1
    s.count[EVALUATIONS] += dense_stages(p, r, t, h, y, mode, s, stage)
    for i in range(1, 4):
        interpolate(r, 0.25 * i, h, y, stage, s.y_dense)
        event_values(p, t + 0.25 * i * h, s.y_dense, mode, s, s.phi)
        for j in range(2 * m):
            s.nodes[i, j] = s.phi[j]
    for j in range(2 * m):
        s.nodes[0, j] = s.phi0[j]
        s.nodes[4, j] = s.phi1[j]
    theta = NO_EVENT
    which = -1
    for j in range(2 * m):
        found = first_root(p, r, t, h, y, mode, s, stage, j)
        if found < theta:
            theta = found
            which = j
    return theta, which


def value_inside(p, r, t, h, y, mode, s, stage, theta, j, power):
    """Event function j on the dense output, over theta^power."""
    interpolate(r, theta, h, y, stage, s.y_dense)
    event_values(p, t + theta * h, s.y_dense, mode, s, s.phi)
    return s.phi[j] / theta**power


def start_power(p, h, mode, s, stage, c):
    """(power, first value) of a contact that has just begun to slip, whose speed is zero at the start of the step.

    Its speed over theta tends to its acceleration times h there. After a release without a drop of friction that is
    zero too, and the speed over theta squared is searched instead.
    """
    rate = mode[c] * h * slip_acceleration(p, c, stage[0], s)
    size = 0.0
    for i in range(1, 5):
        size = max(size, abs(s.nodes[i, c]))
    return (1, rate) if abs(rate) > 1e-8 * size else (2, 0.0)


def first_root(p, r, t, h, y, mode, s, stage, j):
    """First theta at which event function j turns negative, by Bernstein exclusion and halving; NO_EVENT when none."""
    power = 0
    if j < p.contacts and s.fresh[j]:
        power, s.nodes[0, j] = start_power(p, h, mode, s, stage, j)
        if power == 2:
            s.nodes[0, j] = value_inside(p, r, t, h, y, mode, s, stage, 1e-3, j, 2)
        if not s.nodes[0, j] > 0.0:
            return 0.0
        for i in range(1, 5):
            s.nodes[i, j] /= (0.25 * i) ** power
    stack = s.stack
    stack[0, 0] = 0.0
    stack[0, 1] = 1.0
    for i in range(5):
        stack[0, 2 + i] = s.nodes[i, j]
    top = 1
    while top > 0:
        top -= 1
        a = stack[top, 0]
        b = stack[top, 1]
        changes, lowest = bernstein(r, stack[top])
        if lowest > 0.0:
            continue
        left = stack[top, 2]
        right = stack[top, 6]
        if changes == 1 and left > 0.0 and not right > 0.0:
            return bracketed_root(p, r, t, h, y, mode, s, stage, j, power, a, b, left, right)
        if b - a < 1e-10 or top + 2 >= stack.shape[0]:
            if not right > 0.0:
                return b
            continue
        split(p, r, t, h, y, mode, s, stage, j, power, top)
        top += 2
    return NO_EVENT


def bernstein(r, row):
    """(sign changes, least) of the Bernstein coefficients of the quartic through the five values of a stack row."""
    lowest = np.inf
    changes = 0
    before = 0.0
    for i in range(5):
        total = 0.0
        for k in range(5):
            total += r.bernstein[i, k] * row[2 + k]
        lowest = min(lowest, total)
        if i > 0 and (total > 0.0) != (before > 0.0):
            changes += 1
        before = total
    return changes, lowest


def split(p, r, t, h, y, mode, s, stage, j, power, top):
    """Replace the interval on the stack by its right and left halves, the left one on top."""
    stack = s.stack
    a = stack[top, 0]
    b = stack[top, 1]
    middle = 0.5 * (a + b)
    f0, f1, f2, f3, f4 = stack[top, 2], stack[top, 3], stack[top, 4], stack[top, 5], stack[top, 6]
    width = b - a
    new = (
        value_inside(p, r, t, h, y, mode, s, stage, a + 0.125 * width, j, power),
        value_inside(p, r, t, h, y, mode, s, stage, a + 0.375 * width, j, power),
        value_inside(p, r, t, h, y, mode, s, stage, a + 0.625 * width, j, power),
        value_inside(p, r, t, h, y, mode, s, stage, a + 0.875 * width, j, power),
    )
    right = (middle, b, f2, new[2], f3, new[3], f4)
    left = (a, middle, f0, new[0], f1, new[1], f2)
    for k in range(7):
        stack[top, k] = right[k]
        stack[top + 1, k] = left[k]


def bracketed_root(p, r, t, h, y, mode, s, stage, j, power, a, b, fa, fb):
    """Root in [a, b] with fa > 0 >= fb by the Illinois rule, to 1e-8 of the step: a real step refines it."""
    side = 0
    x = b
    for _ in range(80):
        if b - a <= 1e-8 or fb == 0.0:
            return b
        x = (a * fb - b * fa) / (fb - fa)
        if not a < x < b:
            x = 0.5 * (a + b)
        fx = value_inside(p, r, t, h, y, mode, s, stage, x, j, power)
        if fx > 0.0:
            a = x
            fa = fx
            if side == 1:
                fb *= 0.5
            side = 1
        else:
            b = x
            fb = fx
            if side == -1:
                fa *= 0.5
            side = -1
    return x


def step_onto(p, r, t, h, theta, j, y, y_new, mode, s, stage):
    """Step from y exactly to the event near theta h: Newton on the length of a real step. Returns that length.

    The dense output proposes the instant and the slope; what is accepted is a step of the method itself, so the event
    inherits the method's order.
    """
    before = max(theta - 1e-4, 0.5 * theta)
    f1 = value_inside(p, r, t, h, y, mode, s, stage, theta, j, 0)
    f0 = value_inside(p, r, t, h, y, mode, s, stage, before, j, 0)
    slope = (f1 - f0) / ((theta - before) * h)
    x = theta * h
    f = value_after(p, r, t, x, y, y_new, mode, s, stage, j)
    for _ in range(8):
        if f == 0.0 or slope == 0.0:
            break
        new = x - f / slope
        if not (0.0 < new <= 1.01 * h) or abs(new - theta * h) > 0.05 * h or abs(new - x) <= 2e-16 * (abs(t) + x):
            break
        f_new = value_after(p, r, t, new, y, y_new, mode, s, stage, j)
        if not abs(f_new) < 0.5 * abs(f):
            return keep_better(p, r, t, x, f, new, f_new, y, y_new, mode, s, stage, j)
        slope = (f_new - f) / (new - x)
        x = new
        f = f_new
    return x


def keep_better(p, r, t, x, f, new, f_new, y, y_new, mode, s, stage, j):
    """End the iteration on the shorter residual; at round-off neither improves."""
    if abs(f_new) <= abs(f):
        return new
    value_after(p, r, t, x, y, y_new, mode, s, stage, j)
    return x


def value_after(p, r, t, h, y, y_new, mode, s, stage, j):
    """Event function j at the end of a real step of length h."""
    evaluations, _ = take_step(p, r, t, h, y, mode, s, stage, y_new)
    s.count[EVALUATIONS] += evaluations
    event_values(p, t + h, y_new, mode, s, s.phi1)
    return s.phi1[j]

"""Where in a step a contact changes its mode; plain loops compiled by `_engine`.

Each contact has an event function that is positive while its mode holds: the speed in its sense of slip, the margin of
static friction while it sticks, the opening (-N) while it is open; a unilateral contact that slips has a second one,
its normal force. A step is searched on the dense output. Five values of an event function define a quartic; when all
its Bernstein coefficients are positive the quartic has no root in the interval, otherwise the interval is halved. So
two crossings inside one step are not missed.
"""

# mypy: disable-error-code="no-untyped-def"

import numpy as np

from squealbox.transient._motion import (
    EVALUATIONS,
    OPEN,
    STICK,
    contact_kinematics,
    derivative,
    evaluate_signals,
    force_noise,
    opening,
    slip_acceleration,
)
from squealbox.transient._runge_kutta import dense_stages, interpolate, take_step
from squealbox.transient._sharing import RISES

NO_EVENT = 2.0  # any theta above 1
RETRY = -1.0  # a shorter step must tell
SHIFT = 1e-8  # share of a step below which an event is reached along the tangent


def event_values(p, t, y, mode, s, phi):
    """Event functions of all contacts: phi[c] for its mode, phi[contacts + c] for lift-off of a slipping contact."""
    m = p.contacts
    any_stick = False
    for c in range(m):
        any_stick = any_stick or mode[c] == STICK or (p.rigid[c] != 0 and mode[c] != OPEN)
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
            if not phi[c] > 1e-9 * abs(s.force[c]):  # at the limit to round-off it still holds
                phi[c] += force_noise(p, c, y, s)
            if p.rigid[c]:
                phi[m + c] = s.normal[c] + 1e-12 * s.size[c] + 1e-300
            elif p.unilateral[c] and p.static[c] <= RISES:  # held by another: no force of its own lets it go
                phi[m + c] = s.normal[c]
        else:
            phi[c] = mode[c] * s.speed[c] if p.static[c] > 0.0 else 1.0
            if p.rigid[c]:
                phi[m + c] = s.normal[c] + 1e-12 * s.size[c] + 1e-300
            elif p.unilateral[c]:
                phi[m + c] = s.normal[c]


def quiet(p, s, c, h, last):
    """True when contact c slips and its speed's Hermite cubic stays well away from zero over the step."""
    if s.mode[c] == STICK or s.mode[c] == OPEN or s.fresh[c] or p.unilateral[c] or p.varying:
        return False
    before = s.phi0[c]
    after = s.phi1[c]
    b1 = before + s.mode[c] * slip_acceleration(p, c, s.stage[0], s) * h / 3.0
    b2 = after - s.mode[c] * slip_acceleration(p, c, s.stage[last], s) * h / 3.0
    margin = 0.2 * (abs(after - before) + abs(b1 - before) + abs(b2 - after))
    return before > margin and after > margin and b1 > margin and b2 > margin


def is_linear(p, s, j):
    """Whether event function j is a linear function of the state alone, and so a polynomial on the dense output."""
    c = j if j < p.contacts else j - p.contacts
    if p.varying:
        return False
    if j < p.contacts:
        return s.mode[c] != STICK
    return not p.rigid[c]


def is_watched(p, s, j):
    """Whether event function j can have a root in this step at all."""
    c = j if j < p.contacts else j - p.contacts
    if j >= p.contacts:  # a sprung contact that sticks is released before its normal force can turn
        lifts = s.mode[c] != OPEN and (s.mode[c] != STICK or p.rigid[c] != 0 or p.static[c] <= RISES)
        return s.noisy[c] != 0 and p.unilateral[c] != 0 and lifts
    return s.noisy[c] != 0 and (s.mode[c] == OPEN or p.static[c] > 0.0)


def first_event(p, r, s, t, h):
    """(theta, j): the first root of an event function in the step, or NO_EVENT; j < contacts or contacts + c.

    s.phi0 holds the event functions at the start. theta = 0 means that a mode does not hold even there.
    """
    m = p.contacts
    event_values(p, t + h, s.state_new, s.mode, s, s.phi1)
    for c in range(m):
        if not s.fresh[c] and not s.phi0[c] > 0.0:
            return 0.0, c
    noisy, interpolated = False, False
    for c in range(m):
        s.noisy[c] = not quiet(p, s, c, h, r.stages)
        noisy = noisy or s.noisy[c] != 0
    if not noisy:
        return NO_EVENT, -1
    s.count[EVALUATIONS] += dense_stages(p, r, s, t, h)
    for j in range(2 * m):
        interpolated = interpolated or (is_watched(p, s, j) and not is_linear(p, s, j))
    if interpolated:
        for i in range(1, 4):
            interpolate(r, s, 0.25 * i, h)
            event_values(p, t + 0.25 * i * h, s.y_dense, s.mode, s, s.phi)
            for j in range(2 * m):
                s.nodes[i, j] = s.phi[j]
    theta, which = NO_EVENT, -1
    for j in range(2 * m):
        if is_watched(p, s, j):
            s.nodes[0, j] = s.phi0[j]
            s.nodes[4, j] = s.phi1[j]
            found = first_root(p, r, s, t, h, j)
            if found < theta:
                theta = found
                which = j
    return theta, which


def event_polynomial(p, r, s, h, j):
    """Coefficients in theta of the linear event function j on the dense output, into s.poly."""
    n = p.mk.shape[0]
    c = j if j < p.contacts else j - p.contacts
    for k in range(r.degree + 1):
        s.poly[k] = 0.0
    s.poly[0] = 0.0 if j < p.contacts and s.fresh[c] else s.phi0[j]
    for i in range(r.dense_stages):
        rate = 0.0
        if j >= p.contacts:
            for k in range(n):
                rate += p.n[c, k] * s.stage[i, k]
        elif s.mode[c] == OPEN:
            for k in range(n):
                rate -= p.n[c, k] * s.stage[i, k]
        else:
            for k in range(n):
                rate -= s.mode[c] * p.t[c, k] * s.stage[i, n + k]
        for k in range(r.degree):
            s.poly[k + 1] += h * rate * r.p[i, k]


def polynomial(r, s, theta, power):
    """s.poly over theta^power, the coefficients below `power` being zero."""
    total = 0.0
    for k in range(r.degree, power - 1, -1):
        total = total * theta + s.poly[k]
    return total


def value_inside(p, r, s, t, h, theta, j, power):
    """Event function j on the dense output, over theta^power; a linear one has its coefficients in s.poly."""
    if is_linear(p, s, j):
        return polynomial(r, s, theta, power)
    interpolate(r, s, theta, h)
    event_values(p, t + theta * h, s.y_dense, s.mode, s, s.phi)
    return s.phi[j] / theta**power


def start_power(p, s, h, c):
    """(power, first value) of a contact that has just begun to slip, whose speed is zero at the start of the step.

    Its speed over theta tends to its acceleration times h there. After a release without a drop of friction that is
    zero too, to round-off of its own terms, and the speed over theta squared is searched instead; its first value is
    that of the cubic through the others. The gap of a rigid contact that has just opened is treated likewise; where its
    normal force has come down to zero, its acceleration is zero too, and the gap begins with theta^3.
    """
    rate, noise = start_rate(p, s, c)
    if abs(rate) > noise:
        return 1, h * rate
    if s.mode[c] == OPEN:
        rate = opening(p, s.stage, c)
        if abs(rate) > s.leave[c]:
            return 2, 0.5 * h * h * rate
    power = 3 if s.mode[c] == OPEN else 2
    value = 0.0
    for i in range(1, 5):
        value += (0.0, 4.0, -6.0, 4.0, -1.0)[i] * s.nodes[i, c] * (4.0 / i) ** power
    return power, value


def start_rate(p, s, c):
    """(rate, round-off of its terms) of the event function of a contact that starts at zero."""
    n = p.mk.shape[0]
    rate = 0.0
    size = 0.0
    if s.mode[c] == OPEN:
        for i in range(n):
            rate -= p.w[c, i] * s.stage[0, i]
            size += abs(p.w[c, i] * s.stage[0, i])
        # where nothing else moves along it, what is left of its rate has no size of its own
        return rate, 1e-8 * size + 1e-4 * p.window * s.leave[c]
    return s.mode[c] * slip_acceleration(p, c, s.stage[0], s), s.leave[c]


def lowest_power(p, r, s, c):
    """The first coefficient of s.poly that is not round-off, up to the third: a lift-off begins with theta^3."""
    if p.rigid[c] or s.mode[c] != OPEN:
        rate, noise = start_rate(p, s, c)
        if abs(rate) > noise:
            return 1
        if s.mode[c] == OPEN:
            return 2 if abs(opening(p, s.stage, c)) > s.leave[c] else 3
    size = 0.0
    for k in range(r.degree + 1):
        size = max(size, abs(s.poly[k]))
    for k in range(1, 3):
        if abs(s.poly[k]) > 1e-8 * size:
            return k
    return 3


def first_root(p, r, s, t, h, j):
    """First theta at which event function j turns negative, by Bernstein exclusion and halving; NO_EVENT when none."""
    power = 0
    fresh = j < p.contacts and s.fresh[j] != 0
    if is_linear(p, s, j):
        event_polynomial(p, r, s, h, j)
        power = lowest_power(p, r, s, j) if fresh else 0
        for i in range(5):
            s.nodes[i, j] = polynomial(r, s, 0.25 * i, power)
        if fresh and not s.nodes[0, j] > 0.0:
            return 0.0
    elif fresh:
        if p.varying:
            evaluate_signals(p, t, s)
        power, s.nodes[0, j] = start_power(p, s, h, j)
        for i in range(1, 5):
            s.nodes[i, j] /= (0.25 * i) ** power
        if not s.nodes[0, j] > 0.0:
            if power == 1:
                return 0.0
            if h > 1e-4 * p.window:
                return RETRY
            s.nodes[0, j] = max(s.nodes[1, j], 1e-300)
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
        right = stack[top, 6]
        if changes == 1 and stack[top, 2] > 0.0 and not right > 0.0:
            return bracketed_root(p, r, s, t, h, j, power, top)
        if b - a < 1e-10 or top + 2 >= stack.shape[0]:
            if not right > 0.0:
                return b
            continue
        split(p, r, s, t, h, j, power, top)
        top += 2
    return NO_EVENT


def bernstein(r, row):
    """(sign changes, least) of the Bernstein coefficients of the quartic through the five values of a stack row."""
    lowest, changes, before = np.inf, 0, 0.0
    for i in range(5):
        total = 0.0
        for k in range(5):
            total += r.bernstein[i, k] * row[2 + k]
        lowest = min(lowest, total)
        if i > 0 and (total > 0.0) != (before > 0.0):
            changes += 1
        before = total
    return changes, lowest


def split(p, r, s, t, h, j, power, top):
    """Replace the interval on the stack by its right and left halves, the left one on top."""
    stack = s.stack
    a = stack[top, 0]
    b = stack[top, 1]
    middle = 0.5 * (a + b)
    f0, f1, f2, f3, f4 = stack[top, 2], stack[top, 3], stack[top, 4], stack[top, 5], stack[top, 6]
    width = b - a
    new = (
        value_inside(p, r, s, t, h, a + 0.125 * width, j, power),
        value_inside(p, r, s, t, h, a + 0.375 * width, j, power),
        value_inside(p, r, s, t, h, a + 0.625 * width, j, power),
        value_inside(p, r, s, t, h, a + 0.875 * width, j, power),
    )
    right = (middle, b, f2, new[2], f3, new[3], f4)
    left = (a, middle, f0, new[0], f1, new[1], f2)
    for k in range(7):
        stack[top, k] = right[k]
        stack[top + 1, k] = left[k]


def bracketed_root(p, r, s, t, h, j, power, top):
    """Root in an interval on the stack, positive at its start only, by the Illinois rule to 1e-8: a step refines it."""
    a, b, fa, fb = s.stack[top, 0], s.stack[top, 1], s.stack[top, 2], s.stack[top, 6]
    side = 0
    x = b
    for _ in range(80):
        if b - a <= 1e-8 or fb == 0.0:
            return b
        x = (a * fb - b * fa) / (fb - fa)
        if not a < x < b:
            x = 0.5 * (a + b)
        fx = value_inside(p, r, s, t, h, x, j, power)
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


def step_onto(p, r, s, t, h, theta, j):
    """Step from y exactly to the event near theta h: Newton on the length of a real step. Returns that length.

    The dense output proposes the instant and the slope; what is accepted is a step of the method itself, so the event
    inherits the method's order. What is left once the correction is below SHIFT of the step is a move along y', whose
    error is of the order of the square of that.
    """
    theta, slope = proposal(p, r, s, t, h, theta, j)
    x = theta * h
    f = value_after(p, r, s, t, x, j)
    for _ in range(8):
        if f == 0.0 or slope == 0.0:
            break
        new = x - f / slope
        if abs(new - x) <= SHIFT * h and new > 0.0:
            for k in range(s.state_new.shape[0]):
                s.state_new[k] += (new - x) * s.stage[r.stages, k]
            return new
        if not (0.0 < new <= 1.01 * h) or abs(new - theta * h) > 0.05 * h or abs(new - x) <= 2e-16 * (abs(t) + x):
            break
        f_new = value_after(p, r, s, t, new, j)
        if not abs(f_new) < 0.5 * abs(f):
            if abs(f_new) <= abs(f):  # the shorter residual: at round-off neither improves
                return new
            value_after(p, r, s, t, x, j)
            return x
        slope = (f_new - f) / (new - x)
        x = new
        f = f_new
    return x


def proposal(p, r, s, t, h, theta, j):
    """(theta, slope): the root near theta on the dense output and the rate of the event function there."""
    if is_linear(p, s, j):
        event_polynomial(p, r, s, h, j)
        slope = 0.0
        for _ in range(3):
            slope = 0.0
            for k in range(r.degree, 0, -1):
                slope = slope * theta + k * s.poly[k]
            if slope == 0.0:
                return theta, 0.0
            better = theta - polynomial(r, s, theta, 0) / slope
            if not (0.0 < better <= 1.0) or abs(better - theta) > 1e-4:
                break
            theta = better
        return theta, slope / h
    before = max(theta - 1e-4, 0.5 * theta)
    f1 = value_inside(p, r, s, t, h, theta, j, 0)
    f0 = value_inside(p, r, s, t, h, before, j, 0)
    return theta, (f1 - f0) / ((theta - before) * h)


def value_after(p, r, s, t, h, j):
    """Event function j at the end of a real step of length h."""
    evaluations, _ = take_step(p, r, s, t, h)
    s.count[EVALUATIONS] += evaluations
    event_values(p, t + h, s.state_new, s.mode, s, s.phi1)
    return s.phi1[j]

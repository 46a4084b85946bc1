"""One embedded Runge-Kutta step, its error and its dense output, for any tableau; plain loops compiled by `_engine`."""

# mypy: disable-error-code="no-untyped-def"

import numpy as np

from squealbox.transient._motion import derivative


def take_step(p, r, s, t, h):
    """Advance s.state by h into s.state_new; s.stage[0] holds y' at t and s.stage[r.stages] receives y' at t + h.

    Returns (evaluations, solved).
    """
    solved = True
    states = 2 * p.mk.shape[0]  # the energy integrals do not act back on the motion
    for i in range(1, r.stages):
        combine(s, r.a[i], i, h, s.y, states)
        solved = derivative(p, t + r.c[i] * h, s.y, s.mode, s, s.stage[i]) and solved
    combine(s, r.b, r.stages, h, s.state_new, s.state_new.shape[0])
    solved = derivative(p, t + h, s.state_new, s.mode, s, s.stage[r.stages]) and solved
    return r.stages, solved


def combine(s, weights, count, h, out, width):
    """out = s.state + h sum_j weights[j] s.stage[j], the first `width` entries."""
    for k in range(width):
        total = 0.0
        for j in range(count):
            total += weights[j] * s.stage[j, k]
        out[k] = s.state[k] + h * total


def error_norm(p, r, s, h):
    """Root mean square of the embedded error over atol + rtol max(|y|, |y_new|); at most 1 is accepted.

    Dormand and Prince's 8(5,3) blends two estimates as in Hairer, Norsett and Wanner, Solving Ordinary Differential
    Equations I, section II.10; the other pairs have one.
    """
    first = scaled_error(p, s, r.e, r.stages + 1)
    states = 2.0 * p.size
    if not r.blended:
        return abs(h) * np.sqrt(first / states)
    second = scaled_error(p, s, r.e3, r.stages + 1)
    if first == 0.0 and second == 0.0:
        return 0.0
    return abs(h) * first / np.sqrt((first + 0.01 * second) * states)


def scaled_error(p, s, weights, count):
    """Sum of squares of sum_j weights[j] s.stage[j] over the tolerances of the displacements and velocities."""
    total = 0.0
    for k in range(2 * p.mk.shape[0]):
        error = 0.0
        for j in range(count):
            error += weights[j] * s.stage[j, k]
        total += (error / (p.atol[k] + p.rtol * max(abs(s.state[k]), abs(s.state_new[k])))) ** 2
    return total


def dense_stages(p, r, s, t, h):
    """The extra stages a high-order dense output needs; returns the number of evaluations."""
    for i in range(r.stages + 1, r.dense_stages):
        combine(s, r.a[i], i, h, s.y, 2 * p.mk.shape[0])
        derivative(p, t + r.c[i] * h, s.y, s.mode, s, s.stage[i])
    return r.dense_stages - r.stages - 1


def interpolate(r, s, theta, h):
    """s.y_dense = y(t + theta h) from the dense output, a polynomial in theta for each stage."""
    out = s.y_dense
    for k in range(out.shape[0]):
        out[k] = s.state[k]
    for j in range(r.dense_stages):
        weight = 0.0
        for degree in range(r.degree - 1, -1, -1):
            weight = (weight + r.p[j, degree]) * theta
        weight *= h
        for k in range(out.shape[0]):
            out[k] += weight * s.stage[j, k]


def first_step(p, r, s, t, limit):
    """Hairer, Norsett and Wanner's starting step from the sizes of y, y' and a difference of y'; s.stage[0] is y'."""
    state = 2 * p.mk.shape[0]
    d0 = 0.0
    d1 = 0.0
    for k in range(state):
        scale = p.atol[k] + p.rtol * abs(s.state[k])
        d0 += (s.state[k] / scale) ** 2
        d1 += (s.stage[0, k] / scale) ** 2
    d0 = np.sqrt(d0 / (2.0 * p.size))
    d1 = np.sqrt(d1 / (2.0 * p.size))
    h0 = 1e-6 * limit if d0 < 1e-5 or d1 < 1e-5 else 0.01 * d0 / d1
    h0 = min(h0, limit)
    for k in range(state):
        s.y[k] = s.state[k] + h0 * s.stage[0, k]
    derivative(p, t + h0, s.y, s.mode, s, s.stage[1])
    d2 = 0.0
    for k in range(state):
        scale = p.atol[k] + p.rtol * abs(s.state[k])
        d2 += ((s.stage[1, k] - s.stage[0, k]) / scale) ** 2
    d2 = np.sqrt(d2 / (2.0 * p.size)) / h0
    largest = max(d1, d2)
    h1 = max(1e-6 * limit, h0 * 1e-3) if largest <= 1e-15 else (0.01 / largest) ** (1.0 / (r.error_order + 1.0))
    return min(100.0 * h0, h1, limit)

"""Moreau's time stepping: contacts as set-valued forces over a fixed step, for many contacts; compiled by `_engine`.

With the midpoint qm = q + h/2 u the step solves, for the velocities u' at its end,

    M (u' - u) = h (f - C u - K qm) + sum_c d_c P_c        P_c in h mu N_c(qm) Sgn(V_c - t_c . u')

where Sgn is the set-valued sign, so a sticking contact needs no rule of its own. The impulses P are found by projected
Gauss-Seidel on u' itself: every contact touches only the degrees of freedom it acts on, so a sweep costs time
proportional to the number of contacts. Explicit in K: the step must stay below 2/omega_max.

A contact that slides in a plane has a relative velocity w = (V - t . u', -a . u') and impulses P on d and a:

    |P| <= h mu N,    P = h mu N w/|w| where it slips, w = 0 where it sticks

so the direction of slip is part of the state; P is projected on the disc, and mu is taken at |w|.
Source: Moreau 1988, Unilateral contact and dry friction in finite freedom dynamics; Studer 2009, Numerics of Unilateral
Contacts and Friction, chapter 4.
"""

# mypy: disable-error-code="no-untyped-def"

import numpy as np

from squealbox.transient.by_kind import law_mu, schedule_value

STUCK = 1e-9  # share of the limit by which the pair of a sticking contact is below it; round-off of a projection


def signal_value(z, i, t):
    """Signal i (V, N0, M^-1 f) at time t."""
    total = 0.0
    for k in range(z.signal_start[i], z.signal_start[i + 1]):
        total += z.term_weight[k] * schedule_value(z.term_kind[k], t, z.term_coefficients[k])
    return total


def time_stepping(z, q, u, start, h, steps, sweeps, tolerance, rows, work):
    """March `steps` steps of length h; row k of `rows` holds the state after k steps.

    A row is t, q, u, N, v, force, work of each contact's friction. Returns (steps done, largest number of sweeps,
    largest remaining change of an impulse over its limit).
    """
    n = q.shape[0]
    m = z.limit.shape[0]
    worst_sweeps = 0
    worst_change = 0.0
    write_impact_row(z, q, u, start, 0.0, work, rows[0])
    for step in range(steps):
        t = start + step * h
        for i in range(n):
            z.q_mid[i] = q[i] + 0.5 * h * u[i]
        for i in range(n):
            a = signal_value(z, 2 * m + i, t + 0.5 * h)
            for k in range(z.mk_start[i], z.mk_start[i + 1]):
                a -= z.mk_value[k] * z.q_mid[z.mk_column[k]]
            for k in range(z.mc_start[i], z.mc_start[i + 1]):
                a -= z.mc_value[k] * u[z.mc_column[k]]
            z.u_new[i] = u[i] + h * a
        set_limits(z, u, t, h)
        used, change = sweep(z, t + h, sweeps, tolerance)
        worst_sweeps = max(worst_sweeps, used)
        worst_change = max(worst_change, change)
        finite = True
        for c in range(m):
            along = 0.0
            for k in range(z.d_start[c], z.d_start[c + 1]):
                along += z.d_value[k] * 0.5 * (u[z.d_column[k]] + z.u_new[z.d_column[k]])
            aside = 0.0
            for k in range(z.a_start[c], z.a_start[c + 1]):
                aside += z.a_value[k] * 0.5 * (u[z.a_column[k]] + z.u_new[z.a_column[k]])
            work[c] += z.impulse[c] * along + z.side[c] * aside
        for i in range(n):
            q[i] = z.q_mid[i] + 0.5 * h * z.u_new[i]
            u[i] = z.u_new[i]
            finite = finite and np.isfinite(u[i])
        if not finite:
            return step, worst_sweeps, worst_change
        write_impact_row(z, q, u, start + (step + 1) * h, h, work, rows[step + 1])
    return steps, worst_sweeps, worst_change


def speed_of(z, u, t, c):
    """Relative velocity of contact c along its sliding direction, V - t . u."""
    speed = signal_value(z, c, t)
    for k in range(z.t_start[c], z.t_start[c + 1]):
        speed -= z.t_value[k] * u[z.t_column[k]]
    return speed


def speed_aside(z, u, c):
    """Relative velocity of contact c across its sliding direction, -a . u."""
    speed = 0.0
    for k in range(z.a_start[c], z.a_start[c + 1]):
        speed -= z.a_value[k] * u[z.a_column[k]]
    return speed


def set_limits(z, u, t, h):
    """Largest friction impulse of each contact in the step, and the reaction an open contact must give back."""
    m = z.limit.shape[0]
    for c in range(m):
        normal = signal_value(z, m + c, t + 0.5 * h)
        for k in range(z.n_start[c], z.n_start[c + 1]):
            normal += z.n_value[k] * z.q_mid[z.n_column[k]]
        speed = np.hypot(speed_of(z, u, t, c), speed_aside(z, u, c))
        if z.unilateral[c] != 0 and normal <= 0.0:
            for k in range(z.mw_start[c], z.mw_start[c + 1]):
                z.u_new[z.mw_column[k]] += h * z.mw_value[k] * normal
            normal = 0.0
        stuck = np.hypot(z.impulse[c], z.side[c]) < z.limit[c] * (1.0 - STUCK)
        mu = z.static[c] if stuck else law_mu(z.law_kind[c], speed, z.law_coefficients[c])
        z.limit[c] = h * mu * normal
        z.impulse[c] = 0.0
        z.side[c] = 0.0


def sweep(z, t, sweeps, tolerance):
    """Projected Gauss-Seidel on the impulses; returns (sweeps used, largest last change over the limits)."""
    m = z.limit.shape[0]
    change = 0.0
    for number in range(sweeps):
        change = 0.0
        for c in range(m):
            speed = speed_of(z, z.u_new, t, c)
            limit = z.limit[c]
            if z.a_start[c] != z.a_start[c + 1]:
                change = max(change, turn(z, c, speed) / max(abs(limit), 1e-300))
                continue
            wanted = z.impulse[c] + speed / z.mobility[c]
            new = min(max(wanted, -limit), limit) if limit >= 0.0 else limit * np.sign(speed)
            delta = new - z.impulse[c]
            if delta != 0.0:
                z.impulse[c] = new
                for k in range(z.md_start[c], z.md_start[c + 1]):
                    z.u_new[z.md_column[k]] += z.md_value[k] * delta
                change = max(change, abs(delta) / max(abs(limit), 1e-300))
        if change <= tolerance:
            return number + 1, change
    return sweeps, change


def turn(z, c, speed):
    """The pair of impulses of a contact that slides in a plane, once; returns the size of its change."""
    aside = speed_aside(z, z.u_new, c)
    limit = z.limit[c]
    along = z.impulse[c] + z.hold[c, 0] * speed + z.hold[c, 1] * aside
    across = z.side[c] + z.hold[c, 2] * speed + z.hold[c, 3] * aside
    if limit < 0.0:  # pulled: as in a line, a force along the slip, of the other sign
        size = max(np.hypot(speed, aside), 1e-300)
        along = limit * speed / size
        across = limit * aside / size
    elif np.hypot(along, across) > limit:
        along = z.impulse[c] + z.reach[c] * speed
        across = z.side[c] + z.reach[c] * aside
        share = min(limit / max(np.hypot(along, across), 1e-300), 1.0)
        along *= share
        across *= share
    more, aslant = along - z.impulse[c], across - z.side[c]
    z.impulse[c] = along
    z.side[c] = across
    for k in range(z.md_start[c], z.md_start[c + 1]):
        z.u_new[z.md_column[k]] += z.md_value[k] * more
    for k in range(z.ma_start[c], z.ma_start[c + 1]):
        z.u_new[z.ma_column[k]] += z.ma_value[k] * aslant
    return np.hypot(more, aslant)


def write_impact_row(z, q, u, t, h, work, row):
    """State, contact quantities and work after a step; the force is the impulse over the step."""
    n = q.shape[0]
    m = z.limit.shape[0]
    row[0] = t
    for i in range(n):
        row[1 + i] = q[i]
        row[1 + n + i] = u[i]
    for c in range(m):
        normal = signal_value(z, m + c, t)
        for k in range(z.n_start[c], z.n_start[c + 1]):
            normal += z.n_value[k] * q[z.n_column[k]]
        row[1 + 2 * n + c] = normal
        row[1 + 2 * n + m + c] = speed_of(z, u, t, c)
        row[1 + 2 * n + 2 * m + c] = z.impulse[c] / h if h > 0.0 else 0.0
        row[1 + 2 * n + 3 * m + c] = work[c]

"""The usual event, decided without the records of the scalar march: one contact at zero speed while all others slip.

A contact that comes to zero speed holds with the force F = F_slip + (V' - t . q'')/G, G = t . M^-1 d, that keeps it
there if |F| <= static N; else it slips in the sense of F. A contact released from sticking slips in the sense of the
force that held it. `_modes.decide` comes to the same for one contact; compiled by `kernel`.
"""

# mypy: disable-error-code="no-untyped-def"

from squealbox.transient._motion import SWING
from squealbox.transient.lanes.of_a_shape import (
    CONTACTS,
    TRIES,
    contact_normal,
    contact_speed,
    contact_static,
    push,
    rate_scale,
    slip_rate,
    speed_scale,
    stop,
)


def change_alone(lane, j):
    """New mode of contact j if all others slip and it presses; False leaves everything to the general case."""
    if not others_slip(lane, j):
        return False
    normal = contact_normal(lane, j)
    g = lane.own_g[j]
    if not (normal > 0.0 and g > 0.0):
        return False
    mode = lane.slips[j]
    limit = contact_static(lane, j) * normal
    sliding = lane.zero[j] * normal
    if mode == 0.0:
        held = lane.force[j]
        if TRIES:  # that of the last trial, which need not have ended here: what the margin leaves of the limit
            size = limit - lane.phi[j]
            held = size if held > 0.0 else -size
        lane.hold[j * CONTACTS + j] = 0.0
        stop(lane, j, contact_speed(lane, j) / g)  # what it drifted while it stuck
        slip_on(lane, j, 1.0 if held > 0.0 else -1.0, held, sliding)
        return True
    before = mode * sliding
    needed = before + slip_rate(lane, j) / g
    if abs(needed) > limit * (1.0 + 1e-12):
        stop(lane, j, contact_speed(lane, j) / g)  # beside its reversal it would at once reverse again
        slip_on(lane, j, 1.0 if needed > 0.0 else -1.0, before, sliding)
        return True
    push(lane, j, needed - before)
    stop(lane, j, contact_speed(lane, j) / g)
    lane.hold[j * CONTACTS + j] = 1.0 / g
    lane.slips[j] = 0.0
    lane.fresh[j] = 0.0
    lane.phi[j] = limit - abs(needed)
    return True


def others_slip(lane, j):
    """Whether every other contact slips, well away from zero speed.

    Where all speeds are zero their rates give a scale, and what contact j has left of its own is as good as zero.
    """
    left = 100.0 * abs(contact_speed(lane, j)) if lane.slips[j] != 0.0 else 0.0
    for c in range(CONTACTS):
        if c != j:
            mode = lane.slips[c]
            rates = SWING * lane.window * rate_scale(lane, c)
            near = 1e-9 * (speed_scale(lane, c) + rates) + left
            if mode == 0.0 or not mode * contact_speed(lane, c) > near:
                return False
    return True


def slip_on(lane, j, sense, before, sliding):
    """Contact j slips from rest in the given sense; its force jumps from `before`."""
    push(lane, j, sense * sliding - before)
    lane.slips[j] = sense
    g = lane.own_g[j]
    lane.fresh[j] = 1e-8 * (rate_scale(lane, j) + g * abs(before))
    lane.phi[j] = 0.0

"""The usual event, decided without the records of the scalar march: one contact at zero speed while all others slip.

A contact that comes to zero speed holds with the force F = F_slip + (V' - t . q'')/G, G = t . M^-1 d, that keeps it
there if |F| <= static N; else it slips in the sense of F. A contact released from sticking slips in the sense of the
force that held it. `_modes.decide` comes to the same for one contact; compiled by `kernel`.
"""

# ruff: noqa: F821  (the places of the rows, TRIES and the functions of one contact, contact_normal and so on, are generated)
# mypy: disable-error-code="name-defined,no-untyped-def"


def change_alone(A, b, lane, j):
    """New mode of contact j if all others slip and it presses; False leaves everything to the general case."""
    if not others_slip(A, b, lane, j):
        return False
    normal = contact_normal(A, b, lane, j)
    g = A[b + (ROW_OWN_G + j) * WIDTH + lane]
    if not (normal > 0.0 and g > 0.0):
        return False
    mode = A[b + (ROW_SLIPS + j) * WIDTH + lane]
    limit = contact_static(A, b, lane, j) * normal
    sliding = A[b + (ROW_ZERO + j) * WIDTH + lane] * normal
    if mode == 0.0:
        held = A[b + (ROW_FORCE + j) * WIDTH + lane]
        if TRIES:  # that of the last trial, which need not have ended here: what the margin leaves of the limit
            size = limit - A[b + (ROW_PHI + j) * WIDTH + lane]
            held = size if held > 0.0 else -size
        A[b + (ROW_HOLD + j * CONTACTS + j) * WIDTH + lane] = 0.0
        stop(A, b, lane, j, contact_speed(A, b, lane, j) / g)  # what it drifted while it stuck
        slip_on(A, b, lane, j, 1.0 if held > 0.0 else -1.0, held, sliding)
        return True
    before = mode * sliding
    needed = before + slip_rate(A, b, lane, j) / g
    if abs(needed) > limit * (1.0 + 1e-12):
        stop(A, b, lane, j, contact_speed(A, b, lane, j) / g)  # beside its reversal it would at once reverse again
        slip_on(A, b, lane, j, 1.0 if needed > 0.0 else -1.0, before, sliding)
        return True
    push(A, b, lane, j, needed - before)
    stop(A, b, lane, j, contact_speed(A, b, lane, j) / g)
    A[b + (ROW_HOLD + j * CONTACTS + j) * WIDTH + lane] = 1.0 / g
    A[b + (ROW_SLIPS + j) * WIDTH + lane] = 0.0
    A[b + (ROW_FRESH + j) * WIDTH + lane] = 0.0
    A[b + (ROW_PHI + j) * WIDTH + lane] = limit - abs(needed)
    return True


def others_slip(A, b, lane, j):
    """Whether every other contact slips, well away from zero speed.

    Where all speeds are zero their rates give a scale, and what contact j has left of its own is as good as zero.
    """
    left = 100.0 * abs(contact_speed(A, b, lane, j)) if A[b + (ROW_SLIPS + j) * WIDTH + lane] != 0.0 else 0.0
    for c in range(CONTACTS):
        if c != j:
            mode = A[b + (ROW_SLIPS + c) * WIDTH + lane]
            rates = SWING * A[b + ROW_WINDOW * WIDTH + lane] * rate_scale(A, b, lane, c)
            near = 1e-9 * (speed_scale(A, b, lane, c) + rates) + left
            if mode == 0.0 or not mode * contact_speed(A, b, lane, c) > near:
                return False
    return True


def slip_on(A, b, lane, j, sense, before, sliding):
    """Contact j slips from rest in the given sense; its force jumps from `before`."""
    push(A, b, lane, j, sense * sliding - before)
    A[b + (ROW_SLIPS + j) * WIDTH + lane] = sense
    g = A[b + (ROW_OWN_G + j) * WIDTH + lane]
    A[b + (ROW_FRESH + j) * WIDTH + lane] = 1e-8 * (rate_scale(A, b, lane, j) + g * abs(before))
    A[b + (ROW_PHI + j) * WIDTH + lane] = 0.0

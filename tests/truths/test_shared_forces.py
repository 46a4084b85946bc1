"""Contacts that hold one motion together share its force by their limits: a closed form, and events that follow it."""

import numpy as np
import pytest
from scipy.optimize import brentq

from squealbox import Contact, Coulomb, DrumBrake, LinearSlope, Ramp, Sinusoid, System, simulate


def test_contacts_share_a_force_by_their_limits_throughout_a_step():
    """x rests under 0.1 cos(t/2) N: each of two contacts carries it by its limit, whose sum comes near to zero.

    Nothing moves, so only how they share it bounds the steps; its series ends near where the limits would vanish.
    """
    law, swinging = Coulomb(0.5), Sinusoid(1.0, 0.97, 0.4)
    contacts = (Contact([0.0], [1.0], [1.0], swinging, 0.0, law), Contact([0.0], [1.0], [1.0], 0.3, 0.0, law))
    system = System([[1.0]], [[0.1]], [[1.0]], Sinusoid(0.0, 0.1, 0.5 / (2.0 * np.pi), 0.5 * np.pi) * [1.0], contacts)
    t = np.linspace(0.0, 10.0, 401)
    limits = 0.5 * np.stack([swinging.value(t), np.full(t.shape, 0.3)], axis=-1)
    expected = -0.1 * np.cos(0.5 * t)[:, None] * limits / np.sum(limits, axis=-1, keepdims=True)
    motion = simulate(system, 10.0, times=t)
    assert motion.outcome == "completed"
    assert np.all(motion.mode == 0)
    np.testing.assert_allclose(motion.friction_force, expected, atol=1e-10)


def test_they_let_go_when_what_they_carry_together_is_spent():
    """Under 0.1 t N the body slips when 0.1 t = 0.5 (0.3 + 1 + 0.97 sin(0.8 pi t)), all contacts at once."""
    law, swinging = Coulomb(0.5, 0.4), Sinusoid(1.0, 0.97, 0.4)
    contacts = (Contact([0.0], [1.0], [1.0], swinging, 0.0, law), Contact([0.0], [1.0], [1.0], 0.3, 0.0, law))
    motion = simulate(System([[1.0]], [[0.1]], [[0.0]], Ramp(0.0, 0.1) * [1.0], contacts), 2.0)
    spent = brentq(lambda t: 0.1 * t - 0.5 * (1.3 + 0.97 * np.sin(0.8 * np.pi * t)), 1.3, 1.9)
    assert motion.event_time[:2] == pytest.approx([spent, spent], rel=1e-9)
    assert set(motion.event_contact[:2]) == {0, 1}


@pytest.mark.parametrize("reading", ["eq3", "eq3_signed", "componentwise"])
def test_shares_of_contacts_that_slip_end_no_series(reading):
    """Both contacts of these readings of the drum sense one motion: while one sticks, the other carries nothing."""
    motion = simulate(DrumBrake(friction=LinearSlope(0.44, -0.05), reading=reading), 0.05)
    assert motion.settings["tableau"] == "taylor"
    assert "instead_of" not in motion.settings

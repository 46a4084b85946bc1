"""Shapes for contacts that open: the closed form of one spring that is cut, and no more than is asked for."""

import numpy as np

from fe_brakes import pad_brake
from squealbox import Coulomb
from squealbox.fe import real_modes
from squealbox.fe.opening import opening_directions
from squealbox.fe.pencil import pencil_of

BAND = (3000.0, 7000.0)


def pencils():
    brake = pad_brake(6, 8, Coulomb(0.3), unilateral=True)
    return [pencil_of(brake.replace(load=share * brake.load)) for share in (1.0, 6.0)]


def test_a_shape_bends_as_a_solve_without_the_contacts_says():
    """K0^-1 on the modes of the one set of contacts, and K1^-1 of the other, differ by shapes that are all held."""
    first, second = pencils()
    lifted = [pencil.sliding.lifted for pencil in (first, second)]
    assert np.any(lifted[0] != lifted[1])
    modes = real_modes(first.elastic, first.M, 10e3)
    found = opening_directions(modes, [first, second], BAND[1], 0.0)
    below = modes.frequency < BAND[1]
    change = (first.elastic - second.elastic) @ modes.shapes[:, below]
    bent = np.linalg.solve(second.elastic.toarray(), change)
    held = found @ np.linalg.lstsq(found, bent, rcond=None)[0]
    np.testing.assert_allclose(held, bent, atol=1e-8 * np.max(np.abs(bent)))


def test_a_tolerance_leaves_out_what_costs_less():
    first, second = pencils()
    modes = real_modes(first.elastic, first.M, 10e3)
    counts = [opening_directions(modes, [first, second], BAND[1], t).shape[1] for t in (0.0, 1.0, 100.0, 1e9)]
    assert counts == sorted(counts, reverse=True)
    assert counts[0] > counts[-1] == 0


def test_nothing_opens_between_equal_brakes():
    first, _ = pencils()
    modes = real_modes(first.elastic, first.M, 10e3)
    assert opening_directions(modes, [first, first], BAND[1], 0.0).shape[1] == 0

"""Closed formulas hold for the laws they were derived for, and refuse the others with one sentence."""

import numpy as np
import pytest

from squealbox import Coulomb, Cubic, LinearSlope, Stribeck, friction
from squealbox.limit_cycles import averaged_limit, stick_slip_limit
from squealbox.parameters import ParameterError

SPEEDS = np.linspace(0.0, 2.0, 41)
SMOOTH = {
    "stribeck": Stribeck(0.4, 0.25, 0.3),
    "cubic": Cubic(0.4, 0.25, 0.5),
    "rising": Stribeck(0.2, 0.3, 0.1),
    "rising from zero": Stribeck(0.0, 0.3, 0.1),
    "cubic, rising": Cubic(0.2, 0.3, 0.5),
    "linear": LinearSlope(0.4, -0.1),
    "table": friction.Table(list(SPEEDS), list(Stribeck(0.4, 0.25, 0.3).mu(SPEEDS))),
}  # fmt: skip


@pytest.mark.parametrize("kind", SMOOTH)
def test_the_averaged_limit_is_a_root_of_its_own_integral_or_there_is_none(kind):
    law, N, c = SMOOTH[kind], 0.3, 0.05
    theta = 2.0 * np.pi * (np.arange(4096) + 0.5) / 4096

    def excess(V):
        mu = law.mu(V - V * np.cos(theta)[..., :])
        return 2.0 * N * np.mean(mu * np.cos(theta)) - c * V

    found = averaged_limit(law, N, c)
    speeds = np.linspace(0.01, 5.0, 500)
    values = np.array([excess(V) for V in speeds])
    if np.isnan(found):
        assert not np.any((values[:-1] > 1e-9) & (values[1:] <= 0.0))  # stick-slip ends nowhere
    else:
        assert excess(found) == pytest.approx(0.0, abs=1e-7)
        assert not np.any(values[speeds > found * 1.01] > 1e-9)


def test_a_jump_at_rest_is_not_averaged():
    with pytest.raises(ParameterError, match="static limit"):
        averaged_limit(Coulomb(0.4, 0.25), 1.0, 0.1)


@pytest.mark.parametrize("law", [Stribeck(0.2, 0.3, 0.1), LinearSlope(0.2, 0.1), Cubic(0.4, 0.25, 0.2)])
def test_the_end_of_stick_slip_is_that_of_laws_below_their_static_limit(law):
    """The last of them falls first and is above its static limit beyond 1.7 times its speed."""
    with pytest.raises(ParameterError, match="nowhere above its static limit"):
        stick_slip_limit(law, (0.1, 0.6), 1.0, 0.1)


def test_damping_below_zero_is_refused():
    with pytest.raises(ParameterError, match="damping"):
        stick_slip_limit(Stribeck(0.4, 0.25, 0.3), (0.2, 0.5), 1.0, -0.1)

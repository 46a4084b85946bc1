"""The solver of 2011: its added damping by theory and by run, and that it converges to the exact motion."""

import numpy as np
import pytest

from squealbox.papers.drum_brake_2011 import solver_2011
from squealbox.papers.drum_brake_2011.cases import RECONSTRUCTED, Case
from squealbox.papers.drum_brake_2011.solver_2011 import (
    EARLY,
    UPTO,
    added,
    added_damping,
    damping_of_the_table,
    decays,
    ode23,
)
from squealbox.stability import complex_modes

CASE = Case(RECONSTRUCTED)


def test_the_added_damping_is_that_of_the_amplification() -> None:
    """(w h)^4/(24 h) for small w h."""
    assert added_damping(13000.0, 1e-5) == pytest.approx(0.13**4 / 24e-5, rel=0.02)


def test_usual_settings_damp_and_then_damp_more() -> None:
    """36 to 55 1/s: both modes without the slope over 10 to 15 ms; three times the decay once the motion has died."""
    exact, _, plain = decays(CASE)
    true = -complex_modes(CASE.design()).growth_rate[:2]
    assert exact.early == pytest.approx(true, rel=1e-3)
    assert exact.late == pytest.approx(true, rel=1e-3)
    own, none = added(CASE).values()
    assert np.subtract(plain.early, exact.early) == pytest.approx(own[UPTO.index(EARLY[1])], abs=0.1)
    assert none[0][0] < 36.0 < none[-1][0] < none[-1][1] < 57.0
    assert np.all(np.divide(plain.late, exact.late) > 3.0)


def test_a_sharper_tolerance_does_not() -> None:
    """Negative twin: at 1e-6 the same method adds less than 2 1/s, and at 1e-7 it follows the exact motion."""
    sharp = solver_2011.decay_of_modes(CASE.design(), ode23(CASE.design(), rtol=1e-6), *EARLY)
    assert sharp == pytest.approx(-complex_modes(CASE.design()).growth_rate[:2], abs=2.0)
    exact = solver_2011.simulate(CASE.design(), 0.02, "rest", 401).q
    times = np.linspace(0.0, 0.02, 401)
    usual, sharp = (np.max(np.abs(ode23(CASE.design(), 0.02, rtol).at(times).q - exact)) for rtol in (1e-3, 1e-7))
    assert 20.0 * sharp < usual


def test_the_march_is_the_one_that_python_makes() -> None:
    """Machine code and Python: the same steps, and the same states but for rounding."""
    quick = ode23(CASE.design(mu=0.40), 0.005)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(solver_2011, "translated", lambda module: module)
        slow = ode23(CASE.design(mu=0.40), 0.005)
    assert slow.t == pytest.approx(quick.t, rel=1e-6)
    assert slow.q == pytest.approx(quick.q, rel=1e-6, abs=1e-12)


def test_the_tables_damping_is_a_twentieth_and_no_loss_factor() -> None:
    c = damping_of_the_table()
    assert [round(each) for each in c["0.05 sqrt(k m)"]] == list(c["printed"])
    assert not any(abs(a - b) < 1.0 for a, b in zip(c["loss factor 0.02"], c["printed"], strict=True))

"""The solver of 2011: its added damping by theory and by run, and that it converges to the exact motion."""

import numpy as np
import pytest

from squealbox.papers.drum_brake_2011 import solver_2011, steady
from squealbox.papers.drum_brake_2011.cases import RECONSTRUCTED, Case
from squealbox.papers.drum_brake_2011.solver_2011 import added_damping, damping_of_the_table, decays, ode23

CASE = Case(RECONSTRUCTED)


def test_the_added_damping_is_that_of_the_amplification() -> None:
    """(w h)^4/(24 h) for small w h."""
    assert added_damping(13000.0, 1e-5) == pytest.approx(0.13**4 / 24e-5, rel=0.02)


def test_usual_settings_damp_and_then_damp_more() -> None:
    """36 to 55 1/s early; about three times the decay once the absolute tolerance governs."""
    exact, _, plain = decays(CASE)
    eigenvalue = -steady.growth(CASE.design())
    assert exact.early == pytest.approx(float(eigenvalue), rel=0.05)
    assert 20.0 < plain.early - exact.early < 80.0
    assert 2.0 < plain.late / exact.late < 4.5


def test_a_sharper_tolerance_does_not() -> None:
    """Negative twin: at 1e-7 the same method follows the exact motion at least twenty times closer."""
    exact = solver_2011.simulate(CASE.design(), 0.02, "rest", 401).q
    times = np.linspace(0.0, 0.02, 401)
    usual, sharp = (np.max(np.abs(ode23(CASE.design(), 0.02, rtol).at(times).q - exact)) for rtol in (1e-3, 1e-7))
    assert 20.0 * sharp < usual


def test_the_tables_damping_is_a_twentieth_and_no_loss_factor() -> None:
    c = damping_of_the_table()
    assert [round(each) for each in c["0.05 sqrt(k m)"]] == list(c["printed"])
    assert not any(abs(a - b) < 1.0 for a, b in zip(c["loss factor 0.02"], c["printed"], strict=True))

"""Where there is no cycle, or none is found: named outcomes with evidence; senseless input: one clear sentence."""

import numpy as np
import pytest

from small_systems import block_on_belt, drum
from squealbox import Coulomb, ParameterError, Ramp, Stribeck, branch, harmonic_balance, hopf_point, shooting

QUIET = block_on_belt(Coulomb(0.3), 0.2, damping=0.5)


@pytest.mark.parametrize("find", [shooting, harmonic_balance])
def test_steady_sliding_is_said(find):
    cycle = find(QUIET)
    assert cycle.outcome == "steady_sliding"
    assert not cycle.stable
    assert np.all(np.isnan(cycle.multipliers))


@pytest.mark.parametrize("find", [shooting, harmonic_balance])
def test_no_convergence_has_history_and_advice(find):
    cycle = find(drum(0.45), ([1e-3, -2e-3], [3.0, 1.0], 1e-4), most_steps=2)
    assert cycle.outcome == "no_convergence"
    assert len(cycle.outcome.evidence["history"]) >= 1
    assert "start" in cycle.outcome.evidence["advice"]


def test_exact_harmonic_balance_refuses_stick_slip():
    cycle = harmonic_balance(drum(0.45), shooting(drum(0.45)), harmonics=8)
    assert cycle.outcome in ("sticking", "no_convergence", "steady_sliding")  # never a cycle


def test_no_hopf_point():
    found = hopf_point(lambda v: block_on_belt(Coulomb(0.3), v, damping=0.5), "V", (0.1, 1.0))
    assert not found.outcome.ok
    none = branch(lambda v: block_on_belt(Coulomb(0.3), v, damping=0.5), "V", (0.1, 1.0), found)
    assert none.outcome == found.outcome
    assert len(none.value) == 0


@pytest.mark.parametrize(
    ("call", "word"),
    [
        (lambda: shooting(block_on_belt(Stribeck(0.4, 0.2, 0.1), Ramp(0.1, 0.1))), "constant"),
        (lambda: shooting(QUIET, "nowhere"), "start"),
        (lambda: shooting(QUIET, ([0.0, 1.0], [0.0])), "1 finite"),
        (lambda: shooting(QUIET, contact="raw"), "contact"),
        (lambda: shooting(QUIET, shots=0), "shots"),
        (lambda: harmonic_balance(QUIET, harmonics=8, samples=8), "at least 17"),
        (lambda: branch(QUIET, "V", (0.1, 1.0), method="magic"), "method"),
    ],
)
def test_senseless_input(call, word):
    with pytest.raises(ParameterError, match=word):
        call()

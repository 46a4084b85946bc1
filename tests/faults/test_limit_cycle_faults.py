"""Where there is no cycle, or none is found: named outcomes with evidence; senseless input: one clear sentence."""

import numpy as np
import pytest

from small_systems import block_on_belt, drum
from squealbox import Coulomb, ParameterError, Ramp, Stribeck, System, branch, harmonic_balance, hopf_point, shooting
from squealbox.limit_cycles import basin
from squealbox.limit_cycles.attractors.attractor import MOST_SEARCHES
from squealbox.limit_cycles.cycles.field import Field
from squealbox.limit_cycles.cycles.shots import Newton
from squealbox.limit_cycles.cycles.variation import PERIOD_STEPS
from squealbox.system import InvalidSystem

QUIET = block_on_belt(Coulomb(0.3), 0.2, damping=0.5)


@pytest.mark.parametrize("static", [0.2, 0.27, 0.325])
def test_a_run_that_dies_down_is_said_to(static):
    """Three hundred periods leave a swing above 1e-5 V where sliding is weakly damped: no cycle, and no failure."""
    cycle = shooting(drum(static))
    assert cycle.outcome == "steady_sliding", cycle.outcome.message
    assert shooting(drum(0.36)).outcome.ok  # the twin: where sliding is unstable there is a cycle


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
    for start in (shooting(drum(0.45)), None):
        cycle = harmonic_balance(drum(0.45), start)
        assert cycle.outcome == "sticking"
        assert "shooting" in cycle.outcome.evidence["advice"]


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
        (lambda: shooting(QUIET, ([0.0, 1.0], [0.0])), "1 values each"),
        (lambda: shooting(QUIET, contact="raw"), "contact"),
        (lambda: shooting(QUIET, shots=0), "shots"),
        (lambda: harmonic_balance(QUIET, harmonics=8, samples=8), "at least 17"),
        (lambda: branch(QUIET, "V", (0.1, 1.0), method="magic"), "method"),
    ],
)
def test_senseless_input(call, word):
    with pytest.raises(ParameterError, match=word):
        call()


HOSTILE = {
    "no contact": System([[1.0]], [[0.1]], [[1.0]], [0.0]),
    "undamped centre": System([[1.0]], [[0.0]], [[1.0]], [0.0]),
    "growth without bound": System([[1.0]], [[-0.5]], [[1.0]], [0.0]),
    "no stiffness": System([[1.0]], [[0.1]], [[0.0]], [0.0]),
    "no friction": block_on_belt(Coulomb(0.0), 0.2),
    "no speed": block_on_belt(Coulomb(0.4, 0.25), 0.0),
    "no normal force": block_on_belt(Coulomb(0.4, 0.25), 0.1, normal=0.0),
    "negative stiffness": block_on_belt(Coulomb(0.4, 0.25), 0.1, stiffness=-1.0),
}
FINDS = {
    "shooting": shooting,
    "three shots": lambda system: shooting(system, shots=3),
    "a guess": lambda system: shooting(system, ([0.3], [0.05], 6.0)),
    "harmonic balance": harmonic_balance,
    "a branch": lambda system: branch(lambda _: system, "v", (0.1, 1.0), method="shooting", points=3),
    "a Hopf point": lambda system: hopf_point(lambda _: system, "v", (0.1, 1.0)),
}


@pytest.mark.parametrize("find", FINDS)
@pytest.mark.parametrize("kind", HOSTILE)
def test_systems_without_a_cycle_end_in_a_named_outcome(kind, find):
    found = FINDS[find](HOSTILE[kind])
    assert not found.outcome.ok
    assert found.outcome.message
    assert str(found.outcome) in (
        "steady_sliding", "no_cycle", "no_convergence", "no_onset", "no_equilibrium", "no_hopf"
    )  # fmt: skip
    assert found.summary()


def test_a_row_without_mass_comes_to_rest_too_and_harmonic_balance_refuses_it():
    massless = System(np.diag([1.0, 0.0]), 0.1 * np.eye(2), np.eye(2), np.zeros(2))
    assert not shooting(massless, ([0.1, 0.0], [0.0, 0.0]), settle=30.0).outcome.ok
    with pytest.raises(InvalidSystem, match="rows without mass"):
        harmonic_balance(massless)


def test_basin_of_a_belt_at_rest_has_no_sliding():
    found = basin(HOSTILE["no speed"], 1.0, 16)
    assert found.outcome == "no_sliding"
    assert len(found.attractor) == 0


def test_a_continuum_of_motions_is_searched_a_dozen_times_only():
    """Without damping, slip slower than the belt keeps its size: of 64 starts nearly each is a motion of its own."""
    found = basin(block_on_belt(Coulomb(0.25), 0.1), 0.9, 64)
    searched = [each for each in found.attractors if each.cycle is not None]
    assert len(found.attractors) > 20
    assert len(searched) == MOST_SEARCHES
    assert np.all(found.attractor >= 0)  # the others keep their names and starts


def test_a_motion_too_stiff_to_follow_ends_in_a_named_outcome():
    """A damper of 1e8 N s/m on 1 kg: 1e8 1/s beside 1 rad/s; one period is out of reach, so nothing longer is tried."""
    found = harmonic_balance(block_on_belt(Coulomb(0.4, 0.25), 0.1, damping=1e8), contact="tanh", width=0.02)
    assert found.outcome == "no_cycle"
    assert "steps" in found.outcome.message
    assert found.outcome.evidence["accepted"] <= PERIOD_STEPS


def test_newton_differentiates_only_where_it_steps_from():
    """Rejected trials cost a motion each, no derivative: one derivative an accepted step, one more to 1e-13."""
    field = Field(drum(0.45))
    x = np.concatenate([[1e-5, -2e-5], [0.25, 0.1]])
    newton = Newton(field, x[None], 5e-4, 1e-11)
    newton.solve(1e-10, 12)
    assert newton.flown > newton.derived  # some trials were rejected
    assert newton.derived <= len(newton.history) + 2

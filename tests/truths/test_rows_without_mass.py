"""Rows without mass in time: viscoelastic parts, condensed rows, loops, against closed forms and other roads."""

from typing import Any

import numpy as np
import pytest
from scipy.linalg import expm

from squealbox import Contact, Stribeck, System, simulate, simulate_ensemble
from squealbox.system import InvalidSystem

MASS, SPRING, SERIES, DAMPER, PUSH = 1.3, 40.0, 25.0, 0.7, 3.0
START = ([0.1, -0.3], [0.2, 0.0])
TIMES = np.linspace(0.0, 5.0, 11)


def standard_solid() -> System:
    """m q'' + k q + kz (q - z) = f, c z' = kz (q - z)."""
    stiffness = [[SPRING + SERIES, -SERIES], [-SERIES, SERIES]]
    return System(np.diag([MASS, 0.0]), np.diag([0.0, DAMPER]), stiffness, [PUSH, 0.0])


def solid_exactly() -> tuple[Any, Any]:
    """q, z and their velocities at TIMES by the matrix exponential in (q, q', z)."""
    state = np.array([
        [0.0, 1.0, 0.0],
        [-(SPRING + SERIES) / MASS, 0.0, SERIES / MASS],
        [SERIES / DAMPER, 0.0, -SERIES / DAMPER],
    ])  # fmt: skip
    steady = -np.linalg.solve(state, [0.0, PUSH / MASS, 0.0])
    x = np.array([expm(state * t) @ (np.array([0.1, 0.2, -0.3]) - steady) + steady for t in TIMES])
    return x[:, [0, 2]], np.stack([x[:, 1], x @ state[2]], axis=1)


@pytest.mark.parametrize(("method", "q_error", "v_error"), [
    ("taylor", 1e-12, 1e-11), ("dormand-prince-8", 1e-11, 1e-10), ("tsitouras", 1e-9, 1e-6),
])  # fmt: skip
def test_standard_solid_in_an_ensemble_is_its_matrix_exponential(method: str, q_error: float, v_error: float) -> None:
    """The samples of a method of order 5 are interpolated: their velocity is coarser than the steps."""
    found = simulate_ensemble(standard_solid(), None, 5.0, method, start=START, times=TIMES, rtol=1e-11)
    q, qd = solid_exactly()
    assert found.outcome.ok
    assert np.max(np.abs(found.sample_q - q)) < q_error
    assert np.max(np.abs(found.sample_qd - qd)) < v_error
    assert np.allclose(found.q, q[-1], atol=1e-11)
    assert np.allclose(found.qd, qd[-1], atol=1e-10)


def test_standard_solid_alone_closes_its_energy_audit() -> None:
    """Kinetic and strain energy of all rows against what the damper of the row without mass takes."""
    found = simulate(standard_solid(), 5.0, start=START, times=TIMES, rtol=1e-11)
    q, qd = solid_exactly()
    assert np.max(np.abs(found.q - q)) < 1e-11
    assert np.max(np.abs(found.qd - qd)) < 1e-10
    assert found.energy.relative_residual < 1e-8  # works are integrals of a truncated product of series


def test_the_right_answer_is_not_that_without_the_damper() -> None:
    """Negative twin: with the row left out the motion is another one."""
    found = simulate(System([[MASS]], [[0.0]], [[SPRING]], [PUSH]), 5.0, start=([0.1], [0.2]), times=TIMES)
    assert np.max(np.abs(found.q[:, 0] - solid_exactly()[0][:, 0])) > 1e-2


def chain() -> tuple[System, System]:
    """Two masses joined through a row with neither mass nor damping, which the contact senses; the same condensed."""
    stiffness = np.array([[60.0, -20.0, 0.0], [-20.0, 50.0, -30.0], [0.0, -30.0, 55.0]])
    mass, damping, load = np.diag([1.0, 0.0, 0.7]), np.diag([0.02, 0.0, 0.03]), np.array([0.0, 1.5, 0.3])
    sense, law, at = np.array([0.0, 8.0, 3.0]), Stribeck(0.5, 0.3, 0.3), [0, 2]
    whole = System(mass, damping, stiffness, load, (Contact(sense, [1.0, 0, 0], [1.0, 0, 0], 5.0, 0.4, law),))
    follow = stiffness[1, at] / stiffness[1, 1]
    contact = Contact(sense[at] - sense[1] * follow, [1.0, 0.0], [1.0, 0.0],
                      5.0 + sense[1] * load[1] / stiffness[1, 1], 0.4, law)  # fmt: skip
    small = System(mass[np.ix_(at, at)], damping[np.ix_(at, at)],
                   stiffness[np.ix_(at, at)] - np.outer(stiffness[at, 1], follow),
                   load[at] - stiffness[at, 1] * load[1] / stiffness[1, 1], (contact,))  # fmt: skip
    return whole, small


@pytest.mark.parametrize("method", ["taylor", "tsitouras"])
def test_an_algebraic_row_is_static_condensation_under_stick_slip(method: str) -> None:
    """Every event, the row itself and the work of friction; the start of the row is put where the others hold it."""
    whole, small = chain()
    times = np.linspace(0.0, 20.0, 41)
    kept: dict[str, Any] = {"method": method, "times": times, "rtol": 1e-11, "observe": ("amplitude", "energy")}
    found = simulate_ensemble(whole, None, 20.0, start=([0.1, 9.0, 0.2], [0.0] * 3), **kept)
    other = simulate_ensemble(small, None, 20.0, start=([0.1, 0.2], [0.0] * 2), **kept)
    follow = np.array([20.0, 30.0]) / 50.0
    assert found.events == other.events > 20
    assert np.max(np.abs(found.sample_q[:, [0, 2]] - other.sample_q)) < 1e-11
    assert np.max(np.abs(found.sample_q[:, 1] - other.sample_q @ follow - 1.5 / 50.0)) < 1e-11
    assert np.max(np.abs(found.sample_qd[:, 1] - other.sample_qd @ follow)) < 1e-10
    assert np.allclose(found["energy"], other["energy"], rtol=1e-9)
    assert np.allclose(found["amplitude"][[0, 2]], other["amplitude"], rtol=1e-9)


def test_an_algebraic_row_alone_closes_the_audit_and_meets_the_ensemble() -> None:
    whole, small = chain()
    times = np.linspace(0.0, 20.0, 41)
    found = simulate(whole, 20.0, start=([0.1, 9.0, 0.2], [0.0] * 3), times=times)
    other = simulate(small, 20.0, start=([0.1, 0.2], [0.0] * 2), times=times)
    assert len(found.event_time) == len(other.event_time)
    assert np.max(np.abs(found.q[:, [0, 2]] - other.q)) < 1e-9
    assert found.energy.relative_residual < 1e-8


def test_small_masses_tend_to_none_at_first_order() -> None:
    """The row's own mass e: the error falls by two for each halving of e."""
    without = simulate(standard_solid(), 5.0, start=START, times=TIMES).q[:, 0]
    errors = []
    for e in (4e-3, 2e-3, 1e-3):
        solid = standard_solid()
        start = ([0.1, -0.3], [0.2, SERIES * 0.4 / DAMPER])
        found = simulate(solid.replace(M=np.diag([MASS, e])), 5.0, start=start, times=TIMES).q[:, 0]
        errors.append(np.max(np.abs(found - without)))
    assert 1.8 < errors[0] / errors[1] < 2.2
    assert 1.8 < errors[1] / errors[2] < 2.2


NEAR = {"K": [[2.0, 0.0], [0.0, 1.0]], "M": [[1.0, 0.0], [0.0, 0.0]]}


@pytest.mark.parametrize(("matrices", "contact", "sentence"), [
    ({"K": np.diag([1.0, 0.0]), "C": np.zeros((2, 2))}, {}, "do not determine the motion without mass"),
    ({"C": [[0.0, 0.0], [0.3, 0.0]]}, {}, "feels a velocity"),
    ({"C": np.diag([0.0, 1.0])}, {"d": [1.0, 0.0], "t": [0.0, 1.0]}, "slides on"),
    ({"C": np.zeros((2, 2))}, {"d": [0.0, 1.0], "t": [1.0, 0.0]}, "would jump with its friction"),
])  # fmt: skip
@pytest.mark.parametrize("run", [simulate, simulate_ensemble])
def test_what_no_law_can_be_solved_on_is_one_sentence(run: Any, matrices: Any, contact: Any, sentence: str) -> None:
    given = {**NEAR, **matrices}
    along = {"d": [1.0, 0.0], "t": [1.0, 0.0], **contact}
    rubs = Contact(n=[0.0, 0.0], N0=1.0, V=1.0, law=Stribeck(0.4, 0.3, 1.0), **along)
    system = System(given["M"], given["C"], given["K"], 0.0, (rubs,))
    with pytest.raises(InvalidSystem, match=sentence):
        run(system, duration=1.0)

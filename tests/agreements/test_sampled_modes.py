"""Modes, critical values and maps of sampled loops: the multipliers of one exact step, as ln(z)/h."""

import numpy as np
import pytest

from squealbox import (
    PID,
    ActiveForce,
    Controlled,
    Coulomb,
    DrumBrake,
    LinearSlope,
    MassOnBelt,
    ModeCoupling,
    System,
    closed_loop,
    complex_modes,
    critical_value,
    simulate,
    stability_map,
)
from squealbox.stability import mechanism

LOOPS = [
    PID(on="q1", derivative=0.3, sampling=2.0),
    PID(on="q1", derivative=0.3, sampling=2.0, computing=1.0),
    PID(on="q1", derivative=3.9, sampling=2.0),  # one multiplier is negative
    PID(on="q1", integral=0.1, derivative=0.3, sampling=20.0, computing=2.4, bandwidth=2.0),
    ActiveForce(0.3, 0.2, PID(on="q1", proportional=0.3), sampling=8.0, bandwidth=0.5),
]


@pytest.mark.parametrize("loop", LOOPS, ids=lambda loop: f"{type(loop).__name__}{loop.computing}{loop.bandwidth}")
def test_every_multiplier_is_an_eigenvalue(loop):
    brake = System([[1.0]], [[-0.1]], [[1.0]], loops=(loop,))
    closed, modes = closed_loop(brake), complex_modes(brake)
    found = modes.eigenvalues[np.isfinite(modes.eigenvalues)]
    for pole in closed.poles:
        assert np.min(np.abs(found - pole)) < 1e-11 * max(abs(pole), 1.0)
    turning = int(np.sum((closed.multipliers.real < 0.0) & (closed.multipliers.imag == 0.0)))
    assert len(found) == len(closed.poles) + turning
    assert float(modes.largest_growth_rate) == pytest.approx(closed.growth_rate, abs=1e-11)


def test_a_motion_along_a_mode_is_that_of_its_multiplier():
    brake = System([[1.0, 0.0], [0.0, 1.0]], 0.02 * np.eye(2), [[2.0, -1.0], [-1.0, 2.0]],
                   loops=(PID(on="q1", sense="q2", derivative=0.1, sampling=3.0),))  # fmt: skip
    modes = complex_modes(brake)
    found = np.flatnonzero(np.isfinite(modes.eigenvalues))
    powers = np.exp(np.outer(np.arange(61), modes.eigenvalues[found]) / 3.0)
    run = simulate(brake, 20.0, ([1.0, 0.3], [0.0, 0.0]), times=61, rtol=1e-12)
    shares, *_ = np.linalg.lstsq(powers, run.q.astype(complex), rcond=None)
    assert np.max(np.abs(powers @ shares - run.q)) < 1e-9
    assert float(modes.largest_growth_rate) > 0.0
    for share, shape in zip(shares, modes.right[:2, found].T, strict=True):
        assert share[0] / share[1] == pytest.approx(shape[0] / shape[1], rel=1e-6)


def test_critical_values_are_those_of_closed_forms():
    """D_max = m w cot(w h/2), and the friction at which the largest multiplier of a mode coupling leaves the circle."""
    block = Controlled(
        MassOnBelt(c=0.0, sliding_speed=1.0, friction=Coulomb(0.3)), PID(on="x", derivative=1.0, sampling=2.0)
    )
    assert critical_value(block, "loops.0.derivative", (0.1, 8.0)).value == pytest.approx(1.0 / np.tan(0.25), abs=1e-10)
    brake = Controlled(ModeCoupling(friction=Coulomb(0.5), c1=0.02), PID(on="y", derivative=0.3, sampling=3.0))
    found = critical_value(brake, "friction.static", (0.8, 1.3), points=31)
    at = brake.replace({"friction.static": float(found.value)})
    assert np.max(np.abs(closed_loop(at).multipliers)) == pytest.approx(1.0, abs=1e-12)
    assert found.mechanism == "unknown"


def test_maps_over_friction_and_sampling():
    drum = DrumBrake(friction=LinearSlope(0.36, -0.05))
    brake = Controlled(drum, [PID(on=name, derivative=2000.0, sampling=2e4, computing=1.0) for name in "xy"])
    table = stability_map(brake, {"friction.static": [0.3, 0.36, 0.5]})
    for growth, mu in zip(table.growth_rate, (0.3, 0.36, 0.5), strict=True):
        assert growth == pytest.approx(closed_loop(brake.replace({"friction.static": mu})).growth_rate, rel=1e-9)
    assert table.mechanism.tolist() == [0, 0, -1]
    assert mechanism(brake.replace({"friction.static": 0.5})).name == "unknown"
    ideal = stability_map(
        brake.replace({"loops.0.sampling": None, "loops.1.sampling": None}), {"friction.static": [0.36]}
    )
    assert ideal.growth_rate[0] < table.growth_rate[1] - 100.0

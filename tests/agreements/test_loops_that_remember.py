"""Loops with memory in time, linear and cut at a limit, against their poles, each other and SciPy."""

from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from squealbox import (
    PID,
    ActiveForce,
    Contact,
    Controlled,
    Coulomb,
    DrumBrake,
    System,
    closed_loop,
    complex_modes,
    simulate,
    simulate_ensemble,
)  # fmt: skip
from squealbox.limit_cycles import harmonic_balance
from squealbox.system import InvalidSystem, as_system, equilibrium

DRUM = DrumBrake(friction=Coulomb(0.3))
LINEAR = [
    PID(on="y", proportional=1e5, integral=3e8, derivative=100.0),
    PID(on="y", proportional=1e5, derivative=100.0, bandwidth=5000.0),
    ActiveForce(mass=0.1, time_constant=1e-4, outer=PID(on="y", proportional=1e5, derivative=100.0)),
]


@pytest.mark.parametrize("loop", LINEAR, ids=lambda loop: type(loop).__name__)
def test_a_linear_closed_loop_in_time_is_its_pole(loop: Any) -> None:
    """Along the least damped vibration, alone and in an ensemble, to 1e-8 of the swing."""
    brake = Controlled(DRUM, [loop])
    modes, steady = complex_modes(brake), equilibrium(as_system(brake)).q
    swings = np.where(np.abs(modes.eigenvalues.imag) > 1.0, modes.growth_rate, -np.inf)
    at = int(np.argmax(np.nan_to_num(swings, nan=-np.inf)))
    value = modes.eigenvalues[at]
    shape = 1e-9 * modes.right[:, at] / np.max(np.abs(modes.right[:, at]))
    times = np.linspace(0.0, 0.01, 21)
    exact = (np.exp(value * times)[:, None] * shape).real
    start = (steady + shape.real, (value * shape).real)
    size = np.max(np.abs(exact))
    found = simulate(brake, 0.01, start=start, times=times, atol=1e-16, rtol=1e-12)
    assert np.max(np.abs(found.q - steady - exact)) < 1e-8 * size + 1e-15 * np.max(np.abs(steady))
    if loop is not LINEAR[2]:
        return
    many = simulate_ensemble(brake, None, 0.01, "taylor", start=start, times=times, atol=1e-16, rtol=1e-12)
    assert np.max(np.abs(many.sample_q - steady - exact)) < 1e-8 * size + 1e-15 * np.max(np.abs(steady))


@pytest.mark.parametrize("loop", [
    PID(on="y", integral=3e8, derivative=100.0),
    PID(on="y", integral=3e8, derivative=100.0, bandwidth=5000.0),
    ActiveForce(0.1, 1e-4, PID(on="y", integral=1e7, proportional=1e5), bandwidth=3e3),
], ids=repr)  # fmt: skip
def test_a_slow_pole_of_an_integral_is_not_lost(loop: Any) -> None:
    """States that push through others only are scaled by what they push: each pole to 1e-8 of itself."""
    brake = Controlled(DRUM, [loop])
    found = complex_modes(brake).eigenvalues
    found, poles = found[np.isfinite(found)], closed_loop(brake).poles
    assert len(found) == len(poles)
    assert all(np.min(np.abs(found - pole)) < 1e-8 * np.abs(pole) for pole in poles)
    assert np.min(np.abs(poles)) < 1e-3 * np.max(np.abs(poles))


def test_active_force_is_its_pid_in_time_with_stick_slip() -> None:
    """Kp + Kd/tau, Kp/tau, Kd + mass/tau on the drum at a friction at which it squeals: the same motion."""
    squealing = DrumBrake(friction=Coulomb(0.5, 0.4))
    mass, tau, kp, kd = 0.02, 1e-4, 1e5, 10.0
    loops = (
        ActiveForce(mass=mass, time_constant=tau, outer=PID(on="y", proportional=kp, derivative=kd)),
        PID(on="y", proportional=kp + kd / tau, integral=kp / tau, derivative=kd + mass / tau),
    )
    times = np.linspace(0.0, 5e-3, 26)
    one, other = (simulate(Controlled(squealing, [loop]), 5e-3, times=times) for loop in loops)
    free = simulate(squealing, 5e-3, times=times)
    assert np.max(np.abs(one.q[:, :2] - other.q[:, :2])) < 1e-8 * np.max(np.abs(one.q[:, :2]))
    assert len(one.event_time) == len(other.event_time)
    assert np.max(np.abs(one.q[:, :2] - free.q)) > 1e-3 * np.max(np.abs(free.q))


LIMITED = [
    PID(on="q1", proportional=2.0, integral=3.0, derivative=0.5, limit=0.3),
    PID(on="q1", proportional=2.0, integral=1.5, limit=0.3, bandwidth=0.8),
    PID(on="q1", proportional=-1.0, derivative=0.5, limit=0.3),
    ActiveForce(mass=0.4, time_constant=0.3, outer=PID(on="q1", proportional=2.0), limit=0.25),
]


@pytest.mark.parametrize("loop", LIMITED, ids=lambda loop: f"{type(loop).__name__}{loop.bandwidth}")
def test_a_loop_cut_at_its_limit_is_that_of_scipy(loop: Any) -> None:
    row, limit = loop.rows(("q1",)), float(loop.limit)

    def field(t: float, x: Any) -> Any:
        q, v, z = x[0], x[1], x[2:]
        u = np.clip(row.P[0] * q + row.R[0] * v + row.S @ z, -limit, limit)
        return np.r_[v, -0.1 * v - 4.0 * q + u, row.A @ z + row.E[:, 0] * q + row.F[:, 0] * v + row.G * u]

    times, begin = np.linspace(0.0, 8.0, 9), [0.5, 0.0] + [0.0] * row.memory
    exact = solve_ivp(field, (0.0, 8.0), begin, "DOP853", rtol=1e-12, atol=1e-14, t_eval=times, max_step=0.01).y[0]
    system = System([[1.0]], [[0.1]], [[4.0]], names=("q1",), loops=(loop,))
    found = simulate(system, 8.0, start=([0.5], [0.0]), times=times, rtol=1e-11)
    assert np.max(np.abs(found.q[:, 0] - exact)) < 1e-9
    assert found.q.shape == (9, 1)
    assert np.max(np.abs(found.friction_force)) == pytest.approx(limit)
    assert found.energy.relative_residual < 1e-8
    if loop is not LIMITED[1]:
        return
    many = simulate_ensemble(system, None, 8.0, "dormand-prince-8", start=([0.5], [0.0]), times=times, rtol=1e-11)
    assert np.max(np.abs(many.sample_q[:, 0] - exact)) < 1e-9


def test_without_its_limit_it_is_another_motion_and_a_series_is_refused() -> None:
    system = System([[1.0]], [[0.1]], [[4.0]], names=("q1",), loops=(LIMITED[0],))
    free = system.replace(loops=(LIMITED[0].replace(limit=None),))
    one = simulate(system, 4.0, start=([0.5], [0.0]), times=9)
    other = simulate(free, 4.0, start=([0.5, 0.0], [0.0, 0.0]), times=9)
    assert np.max(np.abs(one.q[:, 0] - other.q[:, 0])) > 1e-2
    with pytest.raises(InvalidSystem, match="remembers"):
        harmonic_balance(system)


def test_stick_slip_with_a_viscoelastic_part_is_the_limit_of_small_masses() -> None:
    """A block on a belt, its spring in series with a damper: the error of a small mass e falls in proportion to e."""
    law = Coulomb(0.6, 0.3)

    def brake(e: float) -> System:
        belt = Contact([0.0, 0.0], [1.0, 0.0], [1.0, 0.0], 1.0, 0.1, law)
        return System(np.diag([1.0, e]), np.diag([0.0, 5.0]), [[1.5, -0.5], [-0.5, 0.5]], 0.0, (belt,))

    times = np.linspace(0.0, 20.0, 21)
    found = simulate(brake(0.0), 20.0, times=times)
    errors = []
    for e in (4e-3, 2e-3, 1e-3):
        small = simulate(brake(e), 20.0, times=times)
        assert len(small.event_time) == len(found.event_time) == 6
        errors.append(np.max(np.abs(small.q - found.q)))
    assert errors[0] / errors[1] == pytest.approx(2.0, abs=0.2)
    assert errors[1] / errors[2] == pytest.approx(2.0, abs=0.2)
    assert found.energy.relative_residual < 1e-8


def test_several_loops_that_remember_stand_side_by_side() -> None:
    """Each loop alone on its own block, cut at its limit or not: two together are as each one by itself."""
    loops = (LIMITED[0], LIMITED[3].replace(on="q2"), PID(on="q2", integral=0.2))
    one = System([[1.0]], [[0.1]], [[4.0]], names=("q1",), loops=loops[:1])
    both = System(np.eye(2), 0.1 * np.eye(2), 4.0 * np.eye(2), names=("q1", "q2"), loops=loops)
    alone = simulate(one, 4.0, start=([0.5], [0.0]), times=9)
    found = simulate(both, 4.0, start=([0.5, 0.3, 0.0], [0.0, 0.0, 0.0]), times=9)
    assert np.max(np.abs(found.q[:, 0] - alone.q[:, 0])) < 1e-9
    assert len(set(found.system.names)) == len(found.system.names)
    nested = Controlled(Controlled(DRUM, [PID(on="x", integral=1e6)]), [PID(on="y", integral=1e6, limit=3.0)])
    assert complex_modes(nested).outcome == "completed"

"""Motions without friction, or with friction that only slides, in closed form.

Where a truth is a matrix exponential the tolerance is a hundred times the relative tolerance of the run: local errors
add up over the run's few dozen steps, and the motion neither grows nor decays much meanwhile.
"""

import numpy as np
import pytest
from scipy.linalg import expm

from small_systems import METHODS, block_on_belt, two_masses
from squealbox import (
    Constant,
    Contact,
    Coulomb,
    LinearSlope,
    ParameterError,
    Ramp,
    Sinusoid,
    System,
    simulate,
    simulate_ensemble,
)
from squealbox.schedules import Table

RTOL = {"bogacki-shampine": 1e-9, "dormand-prince": 1e-11, "tsitouras": 1e-11, "dormand-prince-8": 1e-12}
START = ([0.4, -0.1], [0.2, 0.3])


def exact(system, start, times):
    """States (k, 2n) of M q'' + C q' + K q = f by the matrix exponential about the static deflection."""
    n = system.size
    steady = np.concatenate([np.linalg.solve(system.K, system.load), np.zeros(n)])
    stiffness, damping = np.linalg.solve(system.M, system.K), np.linalg.solve(system.M, system.C)
    matrix = np.block([[np.zeros((n, n)), np.eye(n)], [-stiffness, -damping]])
    return np.array([steady + expm(matrix * t) @ (np.concatenate(start) - steady) for t in times])


def states(motion):
    return np.concatenate([motion.q, motion.qd], axis=1)


@pytest.mark.parametrize("method", METHODS)
def test_linear_motion_is_the_matrix_exponential(method):
    motion = simulate(two_masses(), 12.0, START, times=25, method=method, rtol=RTOL[method])
    assert motion.outcome == "completed"
    assert np.max(np.abs(states(motion) - exact(two_masses(), START, motion.t))) < 100.0 * RTOL[method]


@pytest.mark.parametrize("method", METHODS)
def test_another_stiffness_is_told_apart(method):
    near = two_masses().replace({"K": two_masses().K + 1e-6 * np.eye(2)})
    motion = simulate(near, 12.0, START, times=25, method=method, rtol=RTOL[method])
    assert np.max(np.abs(states(motion) - exact(two_masses(), START, motion.t))) > 100.0 * RTOL[method]


@pytest.mark.parametrize("contact", ["exact", "raw"])
def test_steady_slip_under_coulomb_friction_is_linear_too(contact):
    # v > 0 throughout, so friction is the constant force mu N and the block swings about (f + mu N)/k
    system = block_on_belt(Coulomb(0.4, 0.25), 1.0, stiffness=4.0, load=0.1)
    motion = simulate(system, 5.0, ([0.2], [0.0]), times=21, method="dormand-prince", contact=contact, rtol=1e-12)
    middle = (0.1 + 0.25) / 4.0
    assert np.max(np.abs(motion.q[:, 0] - middle - (0.2 - middle) * np.cos(2.0 * motion.t))) < 1e-10
    assert np.all(motion.mode == 1)
    assert motion.friction_force == pytest.approx(0.25)


def test_sudden_load_and_its_work():
    # from rest under a constant force: x = (f/k)(1 - cos w t), and the load has done the work f x
    system = System([[2.0]], [[0.0]], [[8.0]], [3.0])
    motion = simulate(system, 2.5, times=11, rtol=1e-12)
    assert np.max(np.abs(motion.q[:, 0] - 0.375 * (1.0 - np.cos(2.0 * motion.t)))) < 1e-11
    assert np.max(np.abs(motion.work_load - 3.0 * motion.q[:, 0])) < 1e-11
    assert np.max(np.abs(motion.energy.residual)) < 1e-11


def driven(load):
    return System([[1.0]], [[0.0]], [[4.0]], load)


def test_sinusoidal_load():
    # x'' + 4 x = A sin(w t) from rest: A/(4 - w^2) (sin w t - (w/2) sin 2t), w = 2 pi 0.5
    w = np.pi
    motion = simulate(driven(Sinusoid(0.0, 1.5, 0.5) * [1.0]), 6.0, times=31, rtol=1e-12)
    expected = 1.5 / (4.0 - w**2) * (np.sin(w * motion.t) - 0.5 * w * np.sin(2.0 * motion.t))
    assert np.max(np.abs(motion.q[:, 0] - expected)) < 1e-10


def ramp_response(slope, t):
    """x'' + 4 x = slope max(t, 0) from rest."""
    t = np.maximum(t, 0.0)
    return slope * (t / 4.0 - np.sin(2.0 * t) / 8.0)


def test_ramp_load_with_begin_and_stop():
    # a ramp that begins at 1 and stops at 3 is the ramp from 1 less the ramp from 3; start_time shifts nothing
    load = Ramp(start=0.0, slope=0.5, stop=1.0, begin=1.0) * [1.0]
    motion = simulate(driven(load), 7.0, times=36, rtol=1e-12)
    expected = ramp_response(0.5, motion.t - 1.0) - ramp_response(0.5, motion.t - 3.0)
    assert np.max(np.abs(motion.q[:, 0] - expected)) < 1e-10
    later = simulate(driven(load), 6.5, times=14, rtol=1e-12, start_time=0.5)
    expected = ramp_response(0.5, later.t - 1.0) - ramp_response(0.5, later.t - 3.0)
    assert np.max(np.abs(later.q[:, 0] - expected)) < 1e-10


def test_table_load_is_stepped_onto_its_kinks():
    times, values = [0.5, 1.5, 2.25], [0.0, 2.0, -1.0]
    slopes = np.diff(values) / np.diff(times)
    changes = np.diff([0.0, *slopes, 0.0])
    motion = simulate(driven(Table(times, values) * [1.0]), 4.0, times=41, rtol=1e-12)
    expected = sum(ramp_response(change, motion.t - t) for t, change in zip(times, changes, strict=True))
    assert np.max(np.abs(motion.q[:, 0] - expected)) < 1e-10
    every = simulate(driven(Table(times, values) * [1.0]), 4.0, rtol=1e-6)
    assert set(times) <= set(every.t.tolist())


def test_sum_of_loads_is_the_sum_of_motions():
    one, other = Sinusoid(0.0, 1.0, 0.3) * [1.0, 0.0], Ramp(0.0, 1.0, 2.0) * [0.2, -1.0]
    system = two_masses()
    motions = [
        simulate(system.replace({"load": load}), 6.0, times=13, rtol=1e-12).q
        for load in (one, other, one + other, Constant(1.0) * [0.0, 0.0])
    ]
    assert np.max(np.abs(motions[2] - motions[0] - motions[1])) < 1e-10
    assert np.all(motions[3] == 0.0)


def test_negative_slope_grows_at_half_its_damping():
    # while it slips, m x'' + (c + N slope) x' + k x = N (mu_s + slope V): growth rate -(c + N slope)/(2 m)
    contact = Contact([0.0], [1.0], [1.0], N0=10.0, V=2.0, law=LinearSlope(0.5, -0.05))
    system = System([[1.0]], [[0.1]], [[25.0]], 0.0, (contact,))
    middle = 10.0 * (0.5 - 0.05 * 2.0) / 25.0
    rate = -(0.1 - 0.5) / 2.0
    w = np.sqrt(25.0 - rate**2)
    motion = simulate(system, 6.0, ([middle + 0.01], [0.01 * rate]), times=61, rtol=1e-12)
    expected = 0.01 * np.exp(rate * motion.t) * np.cos(w * motion.t)
    assert np.max(np.abs(motion.q[:, 0] - middle - expected)) < 1e-10
    assert np.all(motion.mode == 1)


FREE = System(np.eye(1), np.zeros((1, 1)), np.eye(1) * (2e3 * np.pi) ** 2, np.zeros(1), ())


@pytest.mark.parametrize("method", [*METHODS, "taylor"])
def test_a_free_motion_is_as_exact_however_small_it_is(method):
    """Nothing slides: the usual tolerance is that of the motion, single and in an ensemble (it was that of 1 m/s)."""
    runs = {a: simulate(FREE, 0.0203, ([a], [0.0]), method=method, times=2) for a in (1e-12, 1e-6, 1.0)}
    steps = {motion.steps for motion in runs.values()}
    assert max(steps) - min(steps) <= 1
    for amplitude, motion in runs.items():
        assert motion.outcome == "completed"
        true = amplitude * np.cos(2e3 * np.pi * 0.0203)
        assert abs(motion.q[-1, 0] - true) < 1e-4 * amplitude  # of bogacki-shampine; the others are closer
    many = simulate_ensemble(FREE, None, 0.0203, start=(np.array([[1e-12], [1.0]]), np.zeros((2, 1))), method=method)
    assert many.q.ravel() == pytest.approx([runs[1e-12].q[-1, 0], runs[1.0].q[-1, 0]], rel=1e-12)


@pytest.mark.parametrize("push", [1e-9, 1.0])
def test_a_small_swinging_force_is_followed_as_a_large_one(push):
    force = Sinusoid(0.0, push, 900.0) * [1.0]
    damped = FREE.replace({"C": [[300.0]], "load": force})
    omega, drive = 2e3 * np.pi, 1800.0 * np.pi
    gain = push / (omega**2 - drive**2 + 300j * drive)
    motion = simulate(damped, 0.2, method="bogacki-shampine", times=2)
    assert motion.outcome == "completed"
    assert motion.q[-1, 0] == pytest.approx((gain * np.exp(1j * drive * 0.2)).imag, abs=1e-4 * abs(gain))


def test_a_run_that_begins_too_late_for_its_clock_says_so():
    late = simulate(FREE, 0.01, start_time=1e6)
    assert "start_time = 1e+06 s: instants are known to 1.2e-10 s there" in late.caution
    assert "start_time" in simulate_ensemble(FREE, None, 0.01, start=([1.0], [0.0]), start_time=1e6).caution
    assert simulate(FREE, 0.01, start_time=10.0).caution == ""


def test_a_number_joins_a_schedule_and_a_product_of_two_is_one_sentence():
    assert (Sinusoid(0.0, 1.0, 5.0) + 1.0).value(0.05) == pytest.approx(2.0)
    assert (1.0 + Ramp(1.0, -2.0)).value(0.25) == pytest.approx(1.5)
    with pytest.raises(ParameterError, match="expected a number or an array: products of schedules"):
        Sinusoid(0.0, 1.0, 5.0) * Ramp(1.0, -2.0)

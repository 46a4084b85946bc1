"""Closed forms of control: gains, delays, actuators, sampling, limits, active force control, spillover."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.optimize import brentq

from squealbox import (
    PID,
    ActiveForce,
    Controlled,
    Coulomb,
    DelayedFeedback,
    DrumBrake,
    LinearSlope,
    ModeCoupling,
    ParameterError,
    StateFeedback,
    System,
    closed_loop,
    complex_modes,
    critical_value,
    defeating_push,
    placement,
    shooting,
    simulate,
)
from squealbox.control import margins
from squealbox.result import Outcome

FRICTION = "friction.static"


def block(c, *loops, k=1.0):
    return System([[1.0]], [[c]], [[k]], loops=loops)


def hopf(b, c1, c2, a=2.0):
    """D_H of K = [[a, 1 - D], [1, b]], C = diag(c1, c2)."""
    w2 = (c1 * b + c2 * a) / (c1 + c2)
    return w2 * (a + b + c1 * c2 - w2) - a * b + 1.0


@pytest.mark.parametrize(("kp", "kd"), [(0.0, 0.0), (0.2, 0.0), (0.0, 0.1), (0.2, 0.1), (-0.2, 0.1), (0.5, 0.3)])
def test_pd_on_mode_coupling(kp, kd):
    brake = Controlled(ModeCoupling(c1=0.02, c2=0.02), PID(on="y", proportional=kp, derivative=kd))
    found = critical_value(brake, FRICTION, (0.5, 1.5)).value
    assert found == pytest.approx(hopf(2.0 + kp, 0.02, 0.02 + kd), rel=1e-9)


@pytest.mark.parametrize(("mass", "tau"), [(0.1, 0.5), (0.1, 0.1), (0.5, 0.1)])
def test_active_force_alone_is_a_damper(mass, tau):
    brake = Controlled(ModeCoupling(c1=0.02, c2=0.02), ActiveForce(mass, tau, on="y"))
    found = critical_value(brake, FRICTION, (0.5, 1.5)).value
    assert found == pytest.approx(hopf(2.0, 0.02, 0.02 + mass / tau), rel=1e-9)


def test_pid_keeps_stability_up_to_its_integral_gain():
    most = (-0.1 + 0.3) * (1.0 + 0.5)

    def rate(integral):
        loop = PID(on="q1", proportional=0.5, derivative=0.3, integral=integral)
        return complex_modes(block(-0.1, loop)).largest_growth_rate

    assert rate(most * (1 - 1e-9)) < 0.0 < rate(most * (1 + 1e-9))


@pytest.mark.parametrize(("c", "gain"), [(-0.1, 0.3), (-0.1, 0.11), (0.1, 0.5)])
def test_delayed_velocity_feedback(c, gain):
    s = np.sqrt(gain**2 - c**2)
    most = 2.0 * np.arccos(-c / gain) / (s + np.sqrt(s**2 + 4.0))
    found = closed_loop(block(c, PID(on="q1", derivative=gain)))
    assert found.delay_margin == pytest.approx(most, rel=1e-9)
    for factor, stable in ((0.99, True), (1.01, False)):
        late = closed_loop(block(c, PID(on="q1", derivative=gain, delay=factor * most)))
        assert late.outcome == "completed"
        assert late.stable == stable


def test_margins_of_gain_and_phase():
    found = closed_loop(block(-0.1, PID(on="q1", derivative=0.3)))
    assert np.rad2deg(found.phase_margin) == pytest.approx(70.528779, abs=1e-6)
    assert found.gain_margin[0] == pytest.approx(1.0 / 3.0, rel=1e-9)


@pytest.mark.parametrize(
    ("kp", "kd", "most"), [(0.5, 0.3, 0.352455567), (-0.3, 0.3, 1.661487379), (1.0, 0.2, 0.098360867)]
)
def test_delayed_pd(kp, kd, most):
    found = closed_loop(block(-0.1, PID(on="q1", proportional=kp, derivative=kd)))
    assert found.delay_margin == pytest.approx(most, abs=6e-10)


def test_displacement_fed_back_a_quarter_late_damps():
    marginal = DelayedFeedback(on="q1", proportional=-0.1, delay=0.5 * np.pi)
    assert closed_loop(block(-0.1, marginal)).growth_rate == pytest.approx(0.0, abs=1e-14)
    assert closed_loop(block(-0.1, marginal.replace(proportional=-0.11))).stable


def test_long_delays_where_an_approximation_by_pade_fails():
    found = closed_loop(block(-0.1, PID(on="q1", derivative=0.3, delay=20.0)))
    assert found.growth_rate == pytest.approx(0.065358251, abs=1e-9)
    assert found.counted == len(found.poles) > 10


def test_poles_of_a_delay_are_lambert_s():
    from squealbox.control.poles import Late, late_poles

    found, counted = late_poles(Late(np.zeros((1, 1)), [(1.0, -np.ones((1, 1)))]), -3.0)
    assert counted == 6
    expected = [-0.318131505 + 1.337235701j, -2.06227773 + 7.588631178j, -2.653191974 + 13.949208335j]
    assert np.max(np.abs(found[found.imag > 0.0] - expected)) < 1e-9


@pytest.mark.parametrize("gain", [0.0, 0.2])
def test_a_late_loop_without_gain_leaves_the_poles(gain):
    """Alone, and beside a loop that has one."""
    beside = [PID(on="q1", derivative=gain)] * (gain > 0.0)
    found = closed_loop(block(0.1, PID(on="q1", derivative=0.0, delay=0.5), *beside))
    expected = np.roots([1.0, 0.1 + gain, 1.0])
    assert found.counted == len(found.poles) == 2
    assert np.sort_complex(found.poles) == pytest.approx(np.sort_complex(expected), abs=1e-12)


def test_no_pole_of_random_delayed_systems_is_missed():
    from squealbox.control.poles import Late, late_poles

    rng = np.random.default_rng(7)
    for k in range(200):  # up to 400 poles each
        d = int(rng.integers(1, 9))
        parts = [
            (t, rng.normal(size=(d, 1)) @ rng.normal(size=(1, d)))
            for t in rng.uniform(0.1, 2.0 if k % 4 else 10.0, rng.integers(1, 3))
        ]
        late = Late(rng.normal(size=(d, d)), parts)
        found, counted = late_poles(late, -3.0 / max(t for t, _ in parts))
        assert len(found) == counted
        for s in found:
            assert np.linalg.svd(late.matrix(s), compute_uv=False)[-1] < 1e-11 * late.reach(0.0)


def test_active_force_with_an_outer_loop_is_a_pid():
    m, tau, kp, kd = 0.4, 0.2, 0.5, 0.3
    force = block(0.1, ActiveForce(m, tau, PID(on="q1", proportional=kp, derivative=kd)))
    pid = block(0.1, PID(on="q1", proportional=kp + kd / tau, derivative=kd + m / tau, integral=kp / tau))
    assert np.max(np.abs(closed_loop(force).poles - closed_loop(pid).poles)) < 1e-12
    ideal = [np.sort_complex(complex_modes(each).eigenvalues[:3]) for each in (force, pid)]
    assert np.nanmax(np.abs(ideal[0] - ideal[1])) < 1e-12


def test_proportional_active_force_needs_its_mass():
    def rate(mass, c=0.0):
        return complex_modes(block(c, ActiveForce(mass, 0.1, PID(on="q1", proportional=1.0)))).largest_growth_rate

    assert rate(0.499) == pytest.approx(3.716e-4, abs=1e-7)
    assert rate(0.501) == pytest.approx(-3.691e-4, abs=1e-7)
    assert brentq(lambda c: rate(1.0, c), -6.0, -4.0, xtol=1e-12) == pytest.approx(-5.0, rel=1e-9)


@pytest.mark.parametrize(("tau", "least"), [(0.5, 0.126315789), (1.0, 0.211111111), (3.0, 1.385714286)])
def test_a_slow_actuator_asks_for_more_gain(tau, least):
    def rate(gain):
        loop = PID(on="q1", derivative=gain, bandwidth=1.0 / (2.0 * np.pi * tau))
        return closed_loop(block(-0.1, loop)).growth_rate

    assert brentq(rate, 0.5 * least, 2.0 * least, xtol=1e-14) == pytest.approx(least, abs=6e-10)


@pytest.mark.parametrize("wh", [0.25, 0.5, 1.0, 2.0])
def test_sampled_velocity_feedback(wh):
    def rate(gain):
        return closed_loop(block(0.0, PID(on="q1", derivative=gain, sampling=1.0 / wh))).growth_rate

    most = 1.0 / np.tan(wh / 2.0)
    assert brentq(rate, 0.5 * most, 1.5 * most, xtol=1e-14) == pytest.approx(most, rel=1e-9)


def test_slow_sampling_reverses_the_sign_and_says_so():
    found = closed_loop(block(0.0, PID(on="q1", derivative=0.1, sampling=0.25)))
    assert found.outcome == "aliased"
    assert np.max(np.abs(found.multipliers)) == pytest.approx(1.037150061, abs=6e-10)
    assert "0.159155 Hz" in found.outcome.message


@pytest.mark.parametrize(("ends", "computing", "edge"), [
    ((0.05, 1.0), 0.0, 0.104291297), ((2.0, 6.0), 0.0, 3.917179234), ((0.05, 0.5), 1.0, 0.142869674),
    ((0.5, 3.0), 1.0, 1.484853056),
])  # fmt: skip
def test_gains_between_which_a_sampled_loop_holds(ends, computing, edge):
    def rate(gain):
        loop = PID(on="q1", derivative=gain, sampling=2.0, computing=computing)
        return closed_loop(block(-0.1, loop)).growth_rate

    assert brentq(rate, *ends, xtol=1e-14) == pytest.approx(edge, abs=6e-10)


def test_a_fractional_delay_of_a_sampled_loop_is_exact():
    # by hand: x' = u, u = -g x held over [k h + r, (k + 1) h + r)
    g, h, r = 0.8, 1.0, 0.3
    light = System([[0.0]], [[1.0]], [[1e-12]], loops=(PID(on="q1", proportional=g, sampling=1.0 / h, delay=r),))
    found = closed_loop(light).multipliers
    expected = np.roots([1.0, -(1.0 - g * (h - r)), g * r])
    assert np.allclose(np.sort_complex(found), np.sort_complex(expected), atol=1e-9)


@pytest.mark.parametrize(("gain", "margin"), [(1200, 40.0454), (2000, 75.8569), (5000, 88.8927), (10000, 79.1959)])
def test_the_delay_margin_of_the_drum_has_a_maximum(gain, margin):
    drum = DrumBrake(friction=LinearSlope(0.36, -0.05))
    found = closed_loop(Controlled(drum, [PID(on=name, derivative=gain) for name in "xy"]))
    assert 1e6 * found.delay_margin == pytest.approx(margin, abs=6e-5)


@pytest.mark.parametrize("bandwidth", [None, 8.0])
@pytest.mark.parametrize("seed", range(3))
def test_the_delay_margin_of_a_large_plant_is_that_of_the_kronecker_products(bandwidth, seed, monkeypatch):
    """At 134 states the products would take 10 GB: the second road must give what the first gives of small plants."""
    rng = np.random.default_rng(seed)
    factor = rng.standard_normal((4, 4))
    K = factor @ factor.T + np.diag(rng.uniform(1.0, 50.0, 4))
    K += 0.3 * (np.triu(K, 1) - np.tril(K, -1))
    loops = [PID(on=f"q{i + 1}", derivative=g, bandwidth=bandwidth) for i, g in enumerate(rng.uniform(0.3, 3.0, 3))]
    found = closed_loop(System(np.eye(4), 0.05 * np.eye(4), K, loops=tuple(loops)))
    assert found.stable
    products = margins.delay_margin(found.plant)
    monkeypatch.setattr(margins, "LARGEST_PRODUCT", 0)
    assert margins.delay_margin(found.plant) == pytest.approx(products, rel=1e-9)
    late = replace(found.plant, delay=found.plant.delay + 0.5 * products)  # a delay of all is taken off the margin
    assert margins.delay_margin(late) == pytest.approx(0.5 * products, rel=1e-9)


def test_the_delay_margin_beyond_the_products_is_where_a_pole_crosses():
    """Twenty blocks, two loops: with a delay below the margin the brake is stable, above it is not."""
    n = 20
    K = 2.0 * np.eye(n) - np.eye(n, k=1) - np.eye(n, k=-1)

    def chain(delay):
        loops = tuple(PID(on=name, derivative=0.4, delay=delay) for name in ("q1", "q12"))
        return System(np.eye(n), 0.02 * np.eye(n), K, loops=loops)

    margin = closed_loop(chain(0.0)).delay_margin
    assert [closed_loop(chain(share * margin)).stable for share in (0.99, 1.01)] == [True, False]


def test_the_slowest_sampling_of_the_drum():
    drum = DrumBrake(friction=LinearSlope(0.36, -0.05))
    found = closed_loop(Controlled(drum, [PID(on=name, derivative=2000.0) for name in "xy"]))
    assert found.sampling_margin(computing=1.0) == pytest.approx(19873.0046, abs=1e-3)
    slow = [PID(on=name, derivative=2000.0, sampling=1e4, computing=1.0) for name in "xy"]
    assert closed_loop(Controlled(drum, slow)).growth_rate == pytest.approx(940.8, abs=0.05)


def test_a_limited_loop_has_an_unstable_cycle_that_pushes_must_not_pass():
    limited = block(-0.1, PID(on="q1", derivative=0.3, limit=1.0))
    edge = shooting(limited, ([0.0], [12.59], 2.0 * np.pi))
    assert edge.outcome == "completed"
    assert float(edge.amplitude[0]) == pytest.approx(12.590048733, abs=2e-9)
    assert not edge.stable
    q, qd = np.array(edge.q[0]), np.array(edge.qd[0])
    ends = [simulate(limited, 60.0, (f * q, f * qd)).q[-200:] for f in (0.999, 1.001)]
    assert np.max(np.abs(ends[0])) < 12.59 < np.max(np.abs(ends[1]))


def test_spillover_of_a_pair_that_is_not_collocated():
    loop = PID(on="q1", sense="q2", derivative=0.1)
    chain = System(np.eye(2), 0.02 * np.eye(2), [[2.0, -1.0], [-1.0, 2.0]], loops=(loop,))
    found = closed_loop(chain)
    poles = found.poles[found.poles.imag > 0.0]
    assert np.max(np.abs(poles - [0.01492569 + 1.73306164j, -0.03492569 + 0.99876921j])) < 1e-8
    assert np.sort(found.spillover.real.ravel()) == pytest.approx([-0.025, -0.025, 0.025, 0.025], rel=1e-9)


def test_state_feedback_nyquist_and_root_locus():
    loop = StateFeedback(on="y", velocity=(0.0, 0.1))
    brake = Controlled(ModeCoupling(c1=0.02, c2=0.02, friction=Coulomb(0.9)), [loop])
    same = Controlled(ModeCoupling(c1=0.02, c2=0.02, friction=Coulomb(0.9)), [PID(on="y", derivative=0.1)])
    found, other = closed_loop(brake), closed_loop(same)
    assert np.allclose(found.poles, other.poles, rtol=1e-13)
    assert np.allclose(found.root_locus([1.0])[0], found.poles, rtol=1e-9)
    curve = found.nyquist([0.2])[0]
    plant = found.plant
    s = 2j * np.pi * 0.2
    assert curve == pytest.approx(-(plant.H[0] @ np.linalg.solve(s * np.eye(4) - plant.A, plant.B[:, 0])), rel=1e-12)


@pytest.mark.parametrize(("computing", "least", "most"), [
    (0.0, 0.104291297, 3.917179234), (1.0, 0.142869674, 1.484853056),
])  # fmt: skip
def test_margins_of_a_sampled_loop_are_those_of_its_steps(computing, least, most):
    gain = 0.3
    found = closed_loop(block(-0.1, PID(on="q1", derivative=gain, sampling=2.0, computing=computing)))
    assert found.gain_margin == pytest.approx((least / gain, most / gain), rel=1e-8)

    def rate(late):
        loop = PID(on="q1", derivative=gain, sampling=2.0, computing=computing, delay=late)
        return closed_loop(block(-0.1, loop)).growth_rate

    margin = found.delay_margin
    assert rate(margin * (1.0 - 1e-6)) < 0.0 < rate(margin * (1.0 + 1e-6))
    assert max(rate(late) for late in np.linspace(0.0, 0.999 * margin, 9)) < 0.0


def test_margins_of_fast_sampling_come_to_the_continuous_ones():
    gain, ideal = 0.3, closed_loop(block(-0.1, PID(on="q1", derivative=0.3)))
    for rate in (10.0, 100.0):
        found = closed_loop(block(-0.1, PID(on="q1", derivative=gain, sampling=rate)))
        assert found.delay_margin == pytest.approx(ideal.delay_margin - 0.5 / rate, abs=0.1 / rate**2)
        assert found.phase_margin == pytest.approx(ideal.phase_margin, abs=1.0 / rate)
        assert found.nyquist(0.2)[0] == pytest.approx(ideal.nyquist(0.2)[0], abs=1.0 / rate)


def test_an_actuator_follows_the_held_command():
    """x'' + x = f, f' = r (u - f), u = -g x' held: the discrete matrix by hand."""
    g, r, h = 0.4, 2.0, 0.5
    loop = PID(on="q1", derivative=g, bandwidth=r / (2.0 * np.pi), sampling=1.0 / h)
    A = np.array([[0.0, 1.0, 0.0, 0.0], [-1.0, 0.0, 1.0, 0.0], [0.0, 0.0, -r, r], [0.0, 0.0, 0.0, 0.0]])
    flow = expm(A * h)
    exact = np.linalg.eigvals(flow[:3, :3] + np.outer(flow[:3, 3], [0.0, -g, 0.0]))
    found = closed_loop(block(0.0, loop)).multipliers
    assert np.allclose(np.sort_complex(found), np.sort_complex(exact), atol=1e-12)


def test_placement_is_the_derivative_of_each_pole():
    drum = DrumBrake(friction=LinearSlope(0.36, -0.05))
    found, gain = placement(drum), 1e-2
    for i, sense in enumerate("xy"):
        for k, act in enumerate("xy"):
            moved = closed_loop(Controlled(drum, [PID(on=act, sense=sense, derivative=gain)])).poles
            for m, pole in enumerate(found.poles):
                slope = (moved[np.argmin(np.abs(moved - pole))] - pole) / gain
                assert found.shift[i, k, m] == pytest.approx(slope, abs=1e-4)
    sense, act, own, _ = found.ranked()[0]
    assert (sense, act) == ("y", "y")
    assert own < 0.0
    assert found.ranked()[-2][3] > 0.0  # a pair that is not collocated spills over


def test_the_push_that_defeats_a_limited_loop_lies_on_its_unstable_cycle():
    limited = block(-0.1, PID(on="q1", derivative=0.3, limit=1.0))
    found = defeating_push(limited, precision=1e-4)
    edge = shooting(limited, ([0.0], [12.59], 2.0 * np.pi))
    q, v = edge.q[:, 0], edge.qd[:, 0]
    at = int(np.flatnonzero((q[:-1] < 0.0) & (q[1:] >= 0.0))[0])
    passing = np.interp(0.0, q[at : at + 2], v[at : at + 2])
    assert float(found.kept) < float(found.defeated) <= float(found.kept) * 1.0001
    assert found.push == pytest.approx(passing, rel=2e-4)
    lags = block(-0.1, PID(on="q1", derivative=0.3, limit=1.0, bandwidth=1.0))  # one that remembers has an edge too
    assert 0.9 * found.push < defeating_push(lags, precision=1e-2).push < found.push
    unstable = defeating_push(block(-0.4, PID(on="q1", derivative=0.3, limit=1.0)))
    assert unstable.outcome == "unstable"
    assert defeating_push(block(0.1, PID(on="q1", derivative=0.3, limit=1.0))).outcome == "no_danger"
    with pytest.raises(ParameterError, match="a loop with a limit"):
        defeating_push(block(0.1, PID(on="q1", derivative=0.3)))


def test_the_edge_of_pushes_is_found_from_above_too_and_from_no_run_that_failed(monkeypatch):
    """What is told as kept has been tried: the first push may be beyond the edge. A run that fails tells nothing."""
    limited = block(-0.1, PID(on="q1", derivative=0.3, limit=1.0))
    usual = defeating_push(limited, precision=1e-2)
    monkeypatch.setattr("squealbox.control.push.FIRST", 1e3)
    above = defeating_push(limited, precision=1e-2)
    assert above.push == pytest.approx(usual.push, rel=2e-2)
    assert above.kept < above.defeated
    monkeypatch.setattr(
        "squealbox.control.push.simulate",
        lambda *given, **options: replace(simulate(*given, **options), outcome=Outcome("step_limit", "too many")),
    )
    failed = defeating_push(limited, precision=1e-2)
    assert failed.outcome == "failed_run"
    assert np.isnan(failed.kept)
    assert failed.runs <= 2

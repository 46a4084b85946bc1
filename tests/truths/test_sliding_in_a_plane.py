"""Contacts that slide in a plane, in time: the direction of slip is part of the state. Closed forms."""

import numpy as np
import pytest

from squealbox import Contact, Coulomb, LinearSlope, System, complex_modes, simulate, simulate_ensemble
from squealbox.system import InvalidSystem

STEPS = "time-stepping"


def puck(law, *, speed=0.0, load=0.0, mass=1.5, stiffness=(0.0, 0.0), turned=0.0):
    """A mass in a plane under 2 N, on a belt that runs along the direction `turned` [rad]."""
    along, across = [np.cos(turned), np.sin(turned)], [-np.sin(turned), np.cos(turned)]
    contact = Contact([0.0, 0.0], along, along, 2.0, speed, law, across=across)
    return System(mass * np.eye(2), np.zeros((2, 2)), np.diag(stiffness), load, (contact,))


@pytest.mark.parametrize(("speed", "start", "turned"), [(0.3, [0.0, 0.4], 0.0), (-0.5, [0.2, 0.1], 0.7)])
def test_a_puck_on_a_belt_slows_down_along_its_slip(speed, start, turned):
    """Relative to the belt it moves straight, by mu N/m slower each second, |w|^2 m/(2 mu N) far, and stays."""
    system = puck(Coulomb(0.4), speed=speed, turned=turned)
    belt = speed * np.array([np.cos(turned), np.sin(turned)])
    slip = belt - start
    stop = np.linalg.norm(slip) * 1.5 / 0.8
    motion = simulate(system, 2.0, ([0.0, 0.0], start), contact=STEPS, step=1e-3)
    assert motion.outcome == "completed"
    assert motion.q[-1] == pytest.approx(2.0 * belt - 0.5 * slip * stop, abs=1e-6)
    assert motion.event_time == pytest.approx([stop], abs=1e-3)
    slips = motion.t < stop - 1e-3
    angle = np.arctan2(slip[1], slip[0]) - turned
    assert np.cos(motion.slip_direction[slips, 0] - angle) == pytest.approx(1.0, abs=1e-9)
    assert np.all(np.isnan(motion.slip_direction[motion.t > stop + 1e-3]))
    assert motion.energy.relative_residual < 1e-10


@pytest.mark.parametrize("angle", [0.0, 0.8, 2.5, 0.5 * np.pi])
def test_it_breaks_away_in_any_direction_at_the_same_force(angle):
    """0.4 of 2 N hold 0.79 N and not 0.81 N, however they point; then 0.3 of 2 N slow it down."""
    push = np.array([np.cos(angle), np.sin(angle)])
    held = simulate(puck(Coulomb(0.4, 0.3), load=0.79 * push), 1.0, contact=STEPS, step=1e-3)
    assert np.max(np.abs(held.q)) < 1e-12
    away = simulate(puck(Coulomb(0.4, 0.3), load=0.81 * push), 1.0, contact=STEPS, step=1e-4)
    assert away.q[-1] == pytest.approx(0.5 * (0.81 - 0.6) / 1.5 * push, abs=2e-5)
    assert set(held.mode.ravel()) == {0}
    assert abs(away.mode[-1, 0]) == 1  # straight across it slips too
    assert np.cos(away.slip_direction[-1, 0] - angle) == pytest.approx(-1.0, abs=1e-6)


@pytest.mark.parametrize("law", [Coulomb(0.4, 0.3), LinearSlope(0.4, -0.05)])
def test_at_rest_at_the_start_it_sticks_in_a_line_too(law):
    """0.35 of 2 N are below what holds a contact at rest, though above what slips."""
    contact = Contact([0.0], [1.0], [1.0], 2.0, 0.0, law)
    motion = simulate(System([[1.0]], [[0.0]], [[0.0]], 0.7, (contact,)), 1.0, contact=STEPS, step=1e-3)
    assert np.max(np.abs(motion.q)) < 1e-12


def test_small_motion_across_dies_as_its_eigenvalue_says():
    """mu N/|V| damps across, the slope of friction feeds along: both rates, from two steps of first order."""
    system = puck(LinearSlope(0.4, -0.2), speed=0.3, mass=1.0, stiffness=(4.0, 9.0))
    steady = np.array([(0.4 - 0.2 * 0.3) * 2.0 / 4.0, 0.0])
    rates = []
    for step in (4e-4, 2e-4):
        motion = simulate(system, 4.0, (steady + 1e-6, [0.0, 0.0]), contact=STEPS, step=step)
        x, v = motion.q - steady, motion.qd
        a = np.gradient(v, motion.t, axis=0)
        inside = slice(5, -5)  # x'' + b x' + k x = 0, by least squares over the whole motion
        pairs = [np.stack([v[inside, i], x[inside, i]], axis=1) for i in (0, 1)]
        rates.append([0.5 * np.linalg.lstsq(pairs[i], a[inside, i], rcond=None)[0][0] for i in (0, 1)])
    expected = [0.5 * 0.2 * 2.0, -0.5 * 2.0 * 0.34 / 0.3]
    assert np.sort(complex_modes(system).eigenvalues.real)[[-1, 0]] == pytest.approx(expected, rel=1e-9)
    assert 2.0 * np.array(rates[1]) - rates[0] == pytest.approx(expected, rel=1e-3)


def test_what_does_not_know_the_plane_says_who_does():
    system = puck(Coulomb(0.4), speed=0.3)
    for run in (lambda: simulate(system, 1.0), lambda: simulate_ensemble(system, duration=1.0)):
        with pytest.raises(InvalidSystem, match="time-stepping"):
            run()
    pulled = Contact([0.0, 0.0], [1.0, 3.0], [1.0, 0.0], 2.0, 0.3, Coulomb(0.4), across=[0.0, 1.0])
    with pytest.raises(InvalidSystem, match=r"contacts\[0\]: .* acts against every direction"):
        simulate(system.replace(contacts=(pulled,)), 1.0, contact=STEPS)

"""Contacts that reverse, rest or land together, at zero speed or with no normal force: closed forms."""

import numpy as np
import pytest
from scipy.optimize import brentq, linprog

from small_systems import block_on_belt
from squealbox import (
    Contact,
    Coulomb,
    ElastoPlastic,
    LinearSlope,
    Ramp,
    Sinusoid,
    System,
    simulate,
    simulate_ensemble,
)
from squealbox.schedules import Constant, Table


def held(count, *, normal=1.0, law=None, mass=1.0, stiffness=0.0, load=0.0, speed=0.0):
    """One body under `count` equal contacts."""
    one = Contact(n=[0.0], d=[1.0], t=[1.0], N0=normal, V=speed, law=law or Coulomb(0.3))
    return System([[mass]], [[0.0]], [[stiffness]], load, (one,) * count)


def rigid(w, size, *, d=None, t=None, mu=0.0, restitution=0.0, gap=0.0):
    """A rigid contact along w."""
    nothing = np.zeros(size)
    return Contact(nothing, nothing if d is None else d, nothing if t is None else t, 0.0, 0.0, Coulomb(mu),
                   unilateral=True, normal=w, rigid=True, restitution=restitution, gap=gap)  # fmt: skip


@pytest.mark.parametrize("count", [2, 3, 9])
def test_parallel_contacts_are_one(count):
    """x falls by 2 mu N/k in each half period until the spring cannot move it: 1 - 2 k 0.006 count."""
    motion = simulate(held(count, stiffness=100.0), 60.0, ([1.0], [0.0]))
    one = simulate(held(1, normal=float(count), stiffness=100.0), 60.0, ([1.0], [0.0]))
    assert motion.outcome == one.outcome == "completed"
    assert motion.q[-1] == pytest.approx(one.q[-1], abs=1e-9)
    assert len(motion.event_time) == count * len(one.event_time)
    assert np.all(motion.mode[-1] == 0)


def test_two_halves_rest_at_the_closed_form():
    assert simulate(held(2, stiffness=100.0), 60.0, ([1.0], [0.0])).q[-1, 0] == pytest.approx(-0.004, abs=1e-9)


@pytest.mark.parametrize("count", [9, 12])
def test_many_contacts_beyond_their_limit(count):
    motion = simulate(held(count, load=[10.0]), 10.0)
    assert motion.outcome == "completed"
    assert motion.q[-1, 0] == pytest.approx(0.5 * (10.0 - 0.3 * count) * 100.0, rel=1e-9)
    below = simulate(held(count, load=[0.29 * count]), 10.0)
    assert (below.outcome, len(below.event_time)) == ("completed", 0)
    assert below.q[-1, 0] == pytest.approx(0.0, abs=1e-12)


def test_two_equal_blocks_that_know_nothing_of_each_other():
    rows = np.eye(2)
    both = System(rows, 0.0 * rows, 100.0 * rows, 0.0,
                  tuple(Contact([0.0, 0.0], e, e, 1.0, 0.0, Coulomb(0.3)) for e in rows))  # fmt: skip
    motion = simulate(both, 10.0, ([1.0, 1.0], [0.0, 0.0]))
    alone = simulate(held(1, stiffness=100.0), 10.0, ([1.0], [0.0]))
    assert motion.outcome == "completed"
    assert motion.q[-1] == pytest.approx(np.repeat(alone.q[-1], 2), abs=1e-9)
    assert len(motion.event_time) == 2 * len(alone.event_time)


@pytest.mark.parametrize("method", ["dormand-prince-8", "taylor", "bogacki-shampine"])
def test_two_halves_in_an_ensemble(method):
    rtol = 1e-10 if method != "bogacki-shampine" else 1e-8
    law = Coulomb(0.4, 0.25)
    halves = simulate_ensemble(held(2, normal=0.5, law=law, stiffness=1.0, speed=0.1), duration=30.0, method=method,
                               rtol=rtol)  # fmt: skip
    whole = simulate(held(1, law=law, stiffness=1.0, speed=0.1), 30.0, rtol=1e-13)
    assert halves.ended == "completed"
    assert halves.events == 2 * len(whole.event_time)
    assert halves.q[0] == pytest.approx(whole.q[-1, 0], abs=2e-8)
    resting = simulate_ensemble(held(2, stiffness=100.0), duration=10.0, start=([1.0], [0.0]), method=method)
    assert resting.ended == "completed"


@pytest.mark.parametrize("other", [0.0, 1e-12, Ramp(5.0, -2.5)])
def test_a_contact_that_is_not_pressed(other):
    """10 N and none: released at 5 s by the load t; then q'' = t - 4."""
    law = Coulomb(0.5, 0.4)
    contacts = tuple(Contact(n=[0.0], d=[1.0], t=[1.0], N0=N0, V=0.0, law=law) for N0 in (10.0, other))
    system = System([[1.0]], [[0.0]], [[0.0]], Ramp(0.0, 1.0, stop=None) * [1.0], contacts)
    motion = simulate(system, 10.0)
    assert motion.outcome == "completed"
    assert motion.event_time[0] == pytest.approx(5.0, abs=1e-9)
    assert motion.q[-1, 0] == pytest.approx(5.0**3 / 6.0 + 5.0**2 / 2.0, rel=1e-9)
    found = simulate_ensemble(system, duration=10.0, rtol=1e-10)
    assert found.ended == "completed"
    assert found.q[0] == pytest.approx(motion.q[-1, 0], rel=1e-8)


@pytest.mark.parametrize(
    "order",
    [
        [(10.0, 1.0), (0.0, 1.0)],
        [(0.0, 2.0), (10.0, 1.0)],
        [(10.0, 1.0), (0.0, -1.0)],
        [(5.0, 1.0), (1e-12, 1.0), (5.0, -1.0)],
    ],
)
@pytest.mark.parametrize("law", [Coulomb(0.4, 0.3), Coulomb(0.4)])
def test_a_contact_that_is_not_pressed_goes_with_the_one_that_lets_go(law, order):
    """Whichever of them is named first, and against whichever direction it counts: as if it was not there."""

    def driven(*given):
        contacts = tuple(Contact([0.0], [row], [row], N0, 0.2 * row, law) for N0, row in given)
        return System([[1.0]], [[0.1]], [[10.0]], [0.0], contacts)

    alone, motion = simulate(driven((10.0, 1.0)), 10.0), simulate(driven(*order), 10.0)
    assert motion.outcome == "completed"
    assert len(motion.event_time) == len(order) * len(alone.event_time)
    assert motion.q[-1] == pytest.approx(alone.q[-1], abs=1e-8)


def test_pressure_that_ebbs_away_to_nothing():
    """Without friction left the block swings freely: q = a cos(t - c) from the release on."""
    motion = simulate(block_on_belt(Coulomb(0.3), 0.0, normal=Ramp(1.0, -0.5)), 20.0, ([0.1], [0.0]))
    assert motion.outcome == "completed"
    late = motion.t > 3.0
    energy = 0.5 * motion.q[late, 0] ** 2 + 0.5 * motion.qd[late, 0] ** 2
    assert energy == pytest.approx(energy[0], rel=1e-8)


def test_a_ball_without_a_tangent():
    """From 1 m with e = 1/2: landings after t1, then 2 e t1, 2 e^2 t1, ...; at rest after 3 t1."""
    ball = System([[1.0]], [[0.0]], [[0.0]], [-9.81], (rigid([-1.0], 1, mu=0.4, restitution=0.5),))
    motion = simulate(ball, 2.0, ([1.0], [0.0]))
    first = np.sqrt(2.0 / 9.81)
    assert motion.outcome == "completed"
    assert motion.event_time[:3] == pytest.approx([first, 2.0 * first, 2.5 * first], rel=1e-9)
    assert motion.q[-1, 0] == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("height", [1e-14, 1e-9, 1e-6, 1e-2])
def test_a_ball_just_above_the_floor(height):
    contact = rigid([0.0, -1.0], 2, d=[1.0, 0.0], t=[1.0, 0.0], mu=0.3, restitution=0.5)
    ball = System(np.eye(2), np.zeros((2, 2)), np.zeros((2, 2)), [0.0, -9.81], (contact,))
    motion = simulate(ball, 2.0, ([0.0, height], [0.3, 0.0]))
    assert motion.outcome == "completed"
    assert motion.event_time[0] == pytest.approx(np.sqrt(2.0 * height / 9.81), rel=1e-6)
    assert motion.steps < 200
    assert np.all(np.abs(motion.qd[-1]) < 1e-12)


def test_friction_and_a_stop_on_one_motion():
    """1 m/s against 1 N over 0.1 m, then a stop without rebound: there it stays."""
    friction = Contact([0.0, 0.0], [1.0, 0.0], [1.0, 0.0], 1.0, 0.0, Coulomb(1.0))
    stop = rigid([1.0, 0.0], 2, d=[0.0, 1.0], t=[0.0, 1.0])
    motion = simulate(System(np.eye(2), np.zeros((2, 2)), np.zeros((2, 2)), [0.0, 0.0], (friction, stop)), 2.0,
                      ([-0.1, 0.0], [1.0, 0.0]))  # fmt: skip
    assert motion.outcome == "completed"
    assert motion.event_time[0] == pytest.approx(1.0 - np.sqrt(0.8), rel=1e-9)
    assert motion.q[-1] == pytest.approx([0.0, 0.0], abs=1e-12)


def test_three_balls_in_a_row():
    """One strikes two that touch, all impacts at once, e = 1 (Newton): -1/3, 2/3, 2/3."""
    rows = ([1.0, -1.0, 0.0], [0.0, 1.0, -1.0])
    contacts = tuple(rigid(w, 3, restitution=1.0, gap=gap) for w, gap in zip(rows, (1.0, 0.0), strict=True))
    motion = simulate(System(np.eye(3), np.zeros((3, 3)), np.zeros((3, 3)), np.zeros(3), contacts), 2.0,
                      (np.zeros(3), [1.0, 0.0, 0.0]))  # fmt: skip
    assert motion.outcome == "completed"
    assert motion.qd[-1] == pytest.approx([-1.0 / 3.0, 2.0 / 3.0, 2.0 / 3.0], abs=1e-9)


def pads(*given, V=0.05, law=None):
    """Pads at radii r on one disc, each (r, N0, n): its rim moves at r V."""
    return tuple(Contact([n], [r], [r], N0, r * V, law or Coulomb(0.4, 0.3)) for r, N0, n in given)


ROADS = ["taylor", "dormand-prince-8", "bogacki-shampine"]


@pytest.mark.parametrize("method", ROADS)
@pytest.mark.parametrize(
    ("given", "angle"),
    [
        ([(0.1, 10.0, 0.0), (0.2, 10.0, 0.0)], 0.3),  # 0.4 10 (0.1 + 0.2)/4
        ([(0.1, 10.0, 0.0), (-0.2, 10.0, 0.0)], 0.3),
        ([(0.1, 10.0, 4.0), (0.2, 10.0, -1.0)], 1.2 / (4.0 - 0.08)),  # 4 q = 0.4 (3 + 0.2 q)
        ([(0.1, Sinusoid(10.0, 5.0, 0.25), 0.0), (0.2, 7.5, 0.0)], 0.3),  # at 6 s sin(3 pi) = 0, N = 10: 1 + 1.5 < 3
    ],
)
def test_pads_at_two_radii_let_go_together(given, angle, method):
    """However the levers and the limits that vary differ: torque 4 q against all of both pads."""
    disc = System([[0.02]], [[0.0]], [[4.0]], 0.0, pads(*given))
    first = angle / 0.05
    if isinstance(given[0][1], Sinusoid):
        first = brentq(lambda t: 0.2 * t - 0.4 * (0.1 * given[0][1].value(t) + 0.2 * 7.5), 1.0, 6.0)
    motion = simulate(disc, 12.0, ([0.0], [0.05]), method=method)
    assert motion.outcome == "completed"
    assert motion.event_time[:2] == pytest.approx([first, first], rel=1e-6 if method == "bogacki-shampine" else 1e-9)
    assert sorted(motion.event_contact[:2]) == [0, 1]
    many = simulate_ensemble(disc, duration=12.0, start=([0.0], [0.05]), method=method)
    assert (many.ended, many.events) == ("completed", len(motion.event_time))
    assert many.q[0] == pytest.approx(motion.q[-1, 0], rel=1e-4 if method == "bogacki-shampine" else 1e-8)


@pytest.mark.parametrize("method", ROADS[:2])
@pytest.mark.parametrize("order", [1, -1])
def test_friction_that_rises_from_zero_is_held_by_what_sticks(method, order):
    """Both go at 0.4 N; then 0.4 + 0.3 (0.1 - q') = q + q'', which comes to rest at 0.43 m."""
    laws = (Coulomb(0.4), LinearSlope(0.0, 0.3))[::order]
    both = System([[1.0]], [[0.0]], [[1.0]], 0.0, tuple(Contact([0.0], [1.0], [1.0], 1.0, 0.1, law) for law in laws))
    motion = simulate(both, 90.0, ([0.0], [0.1]), method=method)
    assert motion.outcome == "completed"
    assert motion.event_time == pytest.approx([4.0, 4.0], rel=1e-9)
    assert motion.q[-1, 0] == pytest.approx(0.43, abs=1e-5)
    assert simulate_ensemble(both, duration=90.0, start=([0.0], [0.1]), method=method).events == 2


def test_two_belts_on_one_block():
    """At 1 s the stronger belt's speed passes that of the block the weaker one holds: it takes the block with it."""
    weak, strong = (
        Contact([0.0], [1.0], [1.0], N, V, Coulomb(0.5)) for N, V in ((1.0, 0.0), (3.0, Ramp(0.1, -0.1, -9.0)))
    )
    motion = simulate(System([[1.0]], [[0.0]], [[0.0]], -1.4, (weak, strong)), 3.0)
    assert motion.outcome == "completed"
    assert motion.qd[-1, 0] == pytest.approx(-0.2, abs=1e-9)


@pytest.mark.parametrize("seed", range(4))
def test_a_body_on_feet_that_hold_its_motions_in_several_ways(seed):
    """It holds as long as any split of the force does: the linear programme max f.u = 1, least ratio to the limits."""
    rng, (n, m) = np.random.default_rng(seed), ((2, 3), (2, 4), (3, 5), (2, 5))[seed]
    stiffness, drift = np.diag(rng.uniform(1.0, 4.0, n)), rng.uniform(-0.2, 0.2, n)
    feet = []
    for _ in range(m):
        row = rng.standard_normal(n)
        feet.append(Contact(np.zeros(n), row, row, rng.uniform(0.3, 1.0), float(row @ drift), Coulomb(0.4)))
    body = System(np.diag(rng.uniform(0.5, 2.0, n)), 0.05 * stiffness, stiffness, 0.0, tuple(feet))
    rows, limits = np.array([c.t for c in feet]), np.array([0.4 * c.N0 for c in feet])
    above = np.hstack([np.vstack([np.eye(m), -np.eye(m)]), -np.tile(limits, 2)[:, None]])

    def least_ratio(t):
        force = stiffness @ drift * t + body.C @ drift
        return linprog([0.0] * m + [1.0], above, np.zeros(2 * m), np.hstack([rows.T, np.zeros((n, 1))]), force,
                       bounds=[(None, None)] * (m + 1)).fun  # fmt: skip

    first = brentq(lambda t: least_ratio(t) - 1.0, 1e-6, 50.0)
    for method in ROADS[:2]:
        motion = simulate(body, first + 1.0, (np.zeros(n), drift), method=method)
        assert motion.outcome == "completed"
        assert motion.event_time[0] == pytest.approx(first, rel=1e-9)


@pytest.mark.parametrize("halves", [1, 2])
def test_a_guide_beside_a_floor(halves):
    """Weight on the floor, none on the guide; lifted by 2 t - 10 the guide holds 1 N more, from 5.5 s on it slides."""
    floor = rigid([0.0, -1.0], 2, d=[1.0, 0.0], t=[1.0, 0.0], mu=0.2)
    guide = Contact([0.0, 0.0], [0.0, 1.0], [0.0, 1.0], 4.0 / halves, 0.0, Coulomb(0.25))
    body = System(np.eye(2), np.zeros((2, 2)), np.zeros((2, 2)), Ramp(-10.0, 2.0, 50.0) * [0.0, 1.0],
                  (floor, *([guide] * halves)))  # fmt: skip
    motion = simulate(body, 7.0, ([0.0, 0.05], [1.0, 0.0]), times=[2.0, 4.5, 5.25, 7.0])
    assert motion.outcome == "completed"
    assert motion.normal_force[:3, 0] == pytest.approx([6.0, 1.0, 0.0], abs=1e-9)
    assert motion.friction_force[2, 1:] == pytest.approx(-0.5 / halves, abs=1e-9)
    assert motion.q[-1, 1] == pytest.approx(1.5**3 / 3.0, rel=1e-6)
    assert motion.steps + motion.rejected < 1_000


@pytest.mark.parametrize("beside", [False, True])
@pytest.mark.parametrize("method", ["dormand-prince-8", "tsitouras", "bogacki-shampine"])
def test_a_pad_lifts_off_beside_one_that_holds(method, beside):
    """y'' = N - 3, N = 10 - 4 y while pressed: y = 7/4 (1 - cos 2t), off at y = 2.5, back after 2 y'/3; x is held.

    Until the pad has no force it sticks with its share; a stop that touches elsewhere changes nothing.
    """
    size = 3 if beside else 2
    along, up, third = np.eye(size)[0], np.eye(size)[1], np.eye(size)[-1]
    pad = Contact(-4.0 * up, along, along, 10.0, 0.0, Coulomb(0.4), unilateral=True, normal=-up)
    other = Contact(0.0 * along, along, along, 1.0, 0.0, Coulomb(0.5))
    stop = (rigid(third, size),) if beside else ()
    system = System(np.eye(size), np.zeros((size, size)), 4.0 * np.outer(up, up),
                    0.3 * along + 7.0 * up + (0.1 * third if beside else 0.0), (pad, other, *stop))  # fmt: skip
    off = np.arccos(-3.0 / 7.0) / 2.0
    back = off + 2.0 * (3.5 * np.sin(2.0 * off)) / 3.0
    motion = simulate(system, 4.0, method=method)
    assert motion.outcome == "completed"
    assert motion.event_time == pytest.approx([off, back], rel=1e-5)
    assert (motion.event_contact.tolist(), motion.event_mode.tolist()) == ([0, 0], [2, 0])
    assert motion.q[-1, 0] == pytest.approx(0.0, abs=1e-12)
    if not beside:
        many = simulate_ensemble(system, duration=4.0, method=method)
        assert (many.ended, many.events) == ("completed", 2)


@pytest.mark.parametrize("other", [1e-4, 1.0, 100.0])
def test_the_friction_of_a_floor_and_of_a_pad_let_go_together(other):
    """Pulled by t against 0.4 10 N under the weight and what the pad holds: then q'' = t - both."""
    floor = rigid([0.0, -1.0], 2, d=[1.0, 0.0], t=[1.0, 0.0], mu=0.4)
    pad = Contact([0.0, 0.0], [1.0, 0.0], [1.0, 0.0], other, 0.0, Coulomb(1.0))
    load = Ramp(0.0, 1.0, stop=None) * [1.0, 0.0] + Constant(1.0) * [0.0, -10.0]
    motion = simulate(System(np.eye(2), np.zeros((2, 2)), np.zeros((2, 2)), load, (floor, pad)), 6.0 + other)
    assert (motion.outcome, motion.caution) == ("completed", "")
    assert motion.event_time == pytest.approx([4.0 + other] * 2, rel=1e-9)
    assert motion.q[-1, 0] == pytest.approx(2.0**3 / 6.0, rel=1e-7)


def test_friction_that_rises_from_zero_begins_with_a_push_that_begins():
    """At rest until 1 s, then q'' = (t - 1) - 40 q': released where nothing pushes yet."""
    block = System([[1.0]], [[0.0]], [[0.0]], Ramp(0.0, 1.0, stop=None, begin=1.0) * [1.0],
                   (Contact([0.0], [1.0], [1.0], 4.0, 0.0, LinearSlope(0.0, 10.0)),))  # fmt: skip
    for method in ("taylor", "dormand-prince-8"):
        motion = simulate(block, 3.0, method=method)
        assert motion.outcome == "completed"
        assert motion.q[-1, 0] == pytest.approx(2.0 / 40.0 - 2.0 / 1600.0 + (1.0 - np.exp(-80.0)) / 64000.0, rel=1e-8)


@pytest.mark.parametrize(
    ("law", "speed", "within"),
    [
        (Coulomb(0.5), 1.0, 1e-6),
        (ElastoPlastic(0.5, 0.5, 0.1, stiffness=1e5, damping=50.0, breakaway=0.7), 1.0, 1e-2),
        (LinearSlope(0.0, 1e3), 1.2, 1e-3),
    ],
)
def test_what_rigid_contacts_and_friction_leave_open_is_said(law, speed, within):
    """A guide holds the body that a lift takes off its floor: who carries it when the lift lets go is a matter of law.

    Lift - 1 + t to 2 s, then 3 - t; the floor rubs with 0.2. Stiff bristles are where they were at 3 s, and the floor
    has the weight, of impulse 1/2 + 9/2; what creeps has to come back first, at 3 + sqrt 2, when the impulse of the
    lift is undone: 1/2 + 7/2. Rigid contacts decide for the floor and say so.
    """
    floor = rigid([0.0, -1.0], 2, d=[1.0, 0.0], t=[1.0, 0.0], mu=0.2)
    guide = Contact([0.0, 0.0], [0.0, 1.0], [0.0, 1.0], 4.0, 0.0, law)
    lift = Table([0.0, 2.0, 6.0], [-1.0, 1.0, -3.0]) * [0.0, 1.0]
    motion = simulate(System(np.eye(2), np.zeros((2, 2)), np.zeros((2, 2)), lift, (floor, guide)), 6.0,
                      ([0.0, 0.0], [2.0, 0.0]))  # fmt: skip
    assert motion.outcome == "completed"
    assert motion.qd[-1, 0] == pytest.approx(speed, abs=within)
    assert ("carries what it can" in motion.caution) == isinstance(law, Coulomb)


@pytest.mark.parametrize("method", ["dormand-prince-8", "tsitouras", "bogacki-shampine"])
@pytest.mark.parametrize("height", [0.0, 0.02])
def test_a_load_that_ebbs_away_lets_a_body_off_its_floor_once(height, method):
    """Pressed by 1 - t beside what swings: from 1 s on y = (t - 1)^3/6; off at N = 0, and at that instant alone."""
    floor = rigid([0.0, -1.0], 2, d=[1.0, 0.0], t=[1.0, 0.0])
    load = Ramp(-1.0, 1.0, stop=None) * [0.0, 1.0]
    body = System(np.eye(2), np.zeros((2, 2)), np.diag([4.0, 0.0]), load, (floor,))
    motion = simulate(body, 3.0, ([0.3, height], [0.0, 0.0]), method=method)
    assert motion.outcome == "completed"
    assert motion.event_mode[-1] == 2
    leaving = motion.event_time[1:] if height else motion.event_time  # of some starts it closes and opens again there
    assert leaving == pytest.approx(np.ones(len(leaving)), abs=1e-5)
    assert len(leaving) in (1, 3)
    assert motion.q[-1, 1] == pytest.approx(8.0 / 6.0, rel=1e-5)


@pytest.mark.parametrize("method", ROADS[:2])
@pytest.mark.parametrize("order", [1, -1])
@pytest.mark.parametrize(("static", "start"), [(0.5, 0.0), (0.35, -1.0)])
def test_what_sticks_below_its_limit_is_not_let_go_by_a_reversal_elsewhere(static, start, order, method):
    """A plate rests on 0.5 or 0.35 N under a block that rubs it with 0.3 N and swings on a spring: it stays there.

    At each reversal the block could not stick without moving the plate, and a plate that slid would go on (0.2 N): but
    no friction that it ever feels moves it. From rest the block loses 2 0.3/4 m in each half period, pi/2 s.
    """
    plate = Contact([0.0, 0.0], [1.0, 0.0], [1.0, 0.0], 1.0, 0.0, Coulomb(static, 0.2))
    block = Contact([0.0, 0.0], [1.0, -1.0], [1.0, -1.0], 1.0, 0.0, Coulomb(0.4, 0.3))
    system = System(np.eye(2), np.zeros((2, 2)), np.diag([0.0, 4.0]), 0.0, (plate, block)[::order])
    motion = simulate(system, 2.5 * np.pi, ([0.0, 2.0], [0.0, start]), method=method)
    alone = System([[1.0]], [[0.0]], [[4.0]], 0.0, (Contact([0.0], [-1.0], [-1.0], 1.0, 0.0, block.law),))
    one = simulate(alone, 2.5 * np.pi, ([2.0], [start]), method=method)
    assert motion.outcome == "completed"
    assert motion.q[-1] == pytest.approx([0.0, one.q[-1, 0]], abs=1e-9)
    assert start or motion.q[-1, 1] == pytest.approx(-1.25, abs=1e-8)
    assert motion.event_time == pytest.approx(one.event_time, abs=1e-9)
    many = simulate_ensemble(system, duration=2.5 * np.pi, start=([0.0, 2.0], [0.0, start]), method=method)
    assert (many.ended, many.events) == ("completed", len(one.event_time))


@pytest.mark.parametrize("method", ROADS[:2])
@pytest.mark.parametrize("order", [1, -1])
def test_a_block_that_turns_back_takes_its_plate_along(order, method):
    """A plate on a floor (0.2 N), pulled by -0.15 N, under a block that slides forward and is pulled back by 0.9 N.

    The block drags the plate with 0.3 N, and the floor holds 0.15 N, until it stops at 1 s. Then it pulls the plate off
    the floor. A block that slips back, y'' = -0.6 and x'' = -0.25 m/s^2, is as consistent as one that sticks and takes
    the plate along, both -0.425 m/s^2 by 0.475 of 0.6 N. To slip it would first have to overcome 0.6 N: it sticks.
    """
    plate = Contact([0.0, 0.0], [1.0, 0.0], [1.0, 0.0], 1.0, 0.0, Coulomb(0.2))
    block = Contact([0.0, 0.0], [1.0, -1.0], [1.0, -1.0], 1.0, 0.0, Coulomb(0.6, 0.3))
    system = System(np.eye(2), np.zeros((2, 2)), np.zeros((2, 2)), [-0.15, -0.9], (plate, block)[::order])
    start = [0.0, 0.0], [0.0, 1.2]
    motion = simulate(system, 2.0, start, method=method)
    assert motion.outcome == "completed"
    assert motion.q[-1] == pytest.approx([-0.2125, 0.6 - 0.2125], abs=1e-9)
    assert motion.friction_force[-1][::order] == pytest.approx([0.2, -0.475], abs=1e-9)
    many = simulate_ensemble(system, duration=2.0, start=start, method=method)
    assert many.q == pytest.approx([-0.2125, 0.6 - 0.2125], abs=1e-9)

"""What must hold of every transient, whatever the system: Hypothesis draws it."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from small_systems import METHODS
from squealbox import Contact, Coulomb, Hyperbolic, LinearSlope, Method, Stribeck, System, simulate

FEW = settings(max_examples=20)
OUTCOMES = {"completed", "step_underflow", "not_finite", "chattering", "zeno", "inconsistent_contact", "step_limit"}

number = st.integers(-1000, 1000).map(lambda k: k / 1000.0)  # no speeds of 1e-190: the usual tolerances scale with them
share = st.integers(0, 1000).map(lambda k: k / 1000.0)
pair = st.tuples(number, number)


@st.composite
def laws(draw):
    static, kinetic, rate = 0.1 + 0.7 * draw(share), draw(share), 0.1 + draw(share)
    return draw(
        st.sampled_from(
            [
                Coulomb(static, kinetic * static),
                Coulomb(static),
                Stribeck(static, kinetic * static, rate),
                Hyperbolic(static, 3.0 * rate),
                LinearSlope(static, -0.2 * rate, 0.2 * kinetic * static),
            ]
        )
    )


@st.composite
def systems(draw, speed=None, pulling=False):
    """Two masses, positive definite M and K, one or two contacts that act where they slide.

    `pulling` lets the normal force vary with the motion, down into tension.
    """
    coupling, softness, damping = draw(share), 0.3 + draw(share), 0.2 * draw(share)
    stiffness = np.array([[softness + coupling, -coupling], [-coupling, 1.0 + coupling]])
    contacts = []
    for i in range(2 if pulling else draw(st.integers(1, 2))):
        normal = draw(pair) if pulling else (0.0, 0.0)
        row = np.eye(2)[i] if draw(st.booleans()) else np.array([1.0, -1.0 + 2.0 * i])
        force = 0.2 + draw(share)
        contacts.append(Contact(normal, row, row, force, draw(number) if speed is None else speed, draw(laws())))
    return System(np.diag([1.0, 0.5 + draw(share)]), damping * np.eye(2), stiffness, draw(pair), tuple(contacts))


@FEW
@given(systems(speed=0.0), pair, pair, st.sampled_from(METHODS))
def test_friction_never_puts_energy_in_when_the_belts_stand_still(system, q, qd, method):
    motion = simulate(system, 6.0, (q, qd), method=method, rtol=1e-6)
    assert motion.outcome == "completed", motion.outcome.message
    # each step's share is negative or zero up to the tolerance of its quadrature
    assert np.all(np.diff(motion.work_friction, axis=0) <= 1e-5)
    against = motion.friction_force * motion.sliding_velocity * (motion.mode != 0)
    assert np.all(against >= -1e-12)  # right at an event the velocity is zero to round-off


@FEW
@given(systems(), pair, pair)
def test_sticking_friction_is_within_its_limit(system, q, qd):
    motion = simulate(system, 8.0, (q, qd), rtol=1e-8, times=201)
    assert motion.outcome == "completed", motion.outcome.message
    limit = np.array([contact.law.static_limit for contact in system.contacts]) * motion.normal_force
    sticks = motion.mode == 0
    # an event is placed to the run's tolerance, between requested instants to that of the dense output
    assert np.all(np.abs(motion.friction_force)[sticks] <= limit[sticks] * (1.0 + 1e-5) + 1e-9)
    assert np.all(np.abs(motion.sliding_velocity)[sticks] <= 1e-9)


@FEW
@given(systems(), pair, pair)
def test_modes_have_the_sense_of_the_sliding_velocity(system, q, qd):
    motion = simulate(system, 8.0, (q, qd), rtol=1e-8)
    assert motion.outcome == "completed", motion.outcome.message
    slips = np.abs(motion.mode) == 1
    # right at an event the velocity is zero to round-off, of either sign
    assert np.all((motion.mode * motion.sliding_velocity)[slips] >= -1e-9)
    assert np.all(np.diff(motion.event_time) >= 0.0)
    assert np.all(np.diff(motion.t) >= 0.0)


@FEW
@given(systems(pulling=True), pair, pair, st.sampled_from(["exact", "raw", "smooth", "tanh"]))
def test_every_run_ends_with_an_outcome_and_finite_arrays(system, q, qd, contact):
    method = Method("dormand-prince", rtol=1e-5, most_steps=20_000)
    motion = simulate(system, 20.0, (q, qd), method=method, contact=contact, width=0.05)
    assert motion.outcome in OUTCOMES
    if not motion.outcome.ok:
        assert motion.outcome.message
        assert motion.outcome.evidence["time"] == motion.t[-1]
    for name in ("t", "q", "qd", "normal_force", "sliding_velocity", "friction_force", "work_friction", "event_time"):
        assert np.all(np.isfinite(getattr(motion, name))), name
    assert len(motion.t) == motion.steps + 1


@FEW
@given(systems(), pair, pair, st.lists(st.floats(0.0, 5.0, allow_subnormal=False), max_size=5).map(sorted))
def test_output_times_do_not_change_the_end(system, q, qd, times):
    plain = simulate(system, 5.0, (q, qd), rtol=1e-7, times=[5.0])
    asked = simulate(system, 5.0, (q, qd), rtol=1e-7, times=[*times, 5.0])
    assert np.array_equal(plain.q[-1], asked.q[-1])
    assert np.array_equal(plain.event_time, asked.event_time)
    assert asked.t.tolist() == [*times, 5.0]


@FEW
@given(systems(), pair, pair)
def test_the_audit_closes(system, q, qd):
    motion = simulate(system, 6.0, (q, qd), rtol=1e-9)
    assert motion.outcome == "completed", motion.outcome.message
    turned_over = np.max(np.abs(motion.energy.stored)) + np.max(np.abs(motion.work_friction)) + 1e-3
    assert np.max(np.abs(motion.energy.residual)) <= 1e-7 * turned_over


@FEW
@given(systems(), pair, pair)
def test_mirrored_motion_is_the_mirror_of_the_motion(system, q, qd):
    contacts = tuple(c.replace({"V": -c.V}) for c in system.contacts)
    mirrored = system.replace({"contacts": contacts, "load": -system.load})
    one = simulate(system, 4.0, (q, qd), rtol=1e-8, times=9)
    other = simulate(mirrored, 4.0, (-np.array(q), -np.array(qd)), rtol=1e-8, times=9)
    assert one.outcome == other.outcome
    assert np.max(np.abs(one.q + other.q)) < 1e-6

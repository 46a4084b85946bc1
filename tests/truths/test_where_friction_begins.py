"""One rule for every law: sliding begins with no more friction than the contact sticks with, mu(0+) <= static limit.

A law that breaks it has no motion for a push between the two, and is refused wherever it is made. Friction may rise
with speed from its static limit on, also from zero: such a contact reverses like any other.
"""

import numpy as np
import pytest

from squealbox import Contact, Coulomb, Cubic, LinearSlope, Stribeck, System, friction, simulate
from squealbox.files.own_law import OwnLaw, allow, own_law
from squealbox.parameters import ParameterError

CONSTANT = "def mu(v, p): return 0.4 + 0.0 * v"


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: Coulomb(0.2, 0.4), "Coulomb.kinetic = 0.4: expected at most static = 0.2"),
        (lambda: LinearSlope(0.2, 0.0, 0.3), "LinearSlope.floor = 0.3: expected at most static = 0.2"),
        (lambda: own_law(CONSTANT, static=0.2), "OwnLaw.static = 0.2: expected at least mu"),
        (lambda: own_law(CONSTANT).replace(static=0.3), "OwnLaw.static = 0.3: expected at least mu"),
        (lambda: Coulomb([0.2, 0.5], 0.4), "at most static"),
    ],
)
def test_a_gap_below_what_sliding_asks_is_refused(make, words):
    with pytest.raises(ParameterError, match=words) as caught:
        make()
    assert "neither hold the contact nor move it" in str(caught.value)


def test_a_law_read_as_data_is_looked_at_once_its_code_may_run():
    text = "def mu(v, p): return 0.45 + 0.0 * v"
    law = OwnLaw(text, 0.2)
    with pytest.raises(ParameterError, match="at least mu"):
        allow(law)


def block(law, N0=1.0, V=0.0):
    return System([[1.0]], [[0.0]], [[1.0]], 0.0, (Contact([0.0], [1.0], [1.0], N0, V, law),))


@pytest.mark.parametrize(
    "law",
    [Stribeck(0.2, 0.3, 0.1), Cubic(0.2, 0.3, 4.0), friction.Table([0.0, 0.5, 4.0], [0.2, 0.35, 0.3]),
     own_law("def mu(v, p): return p[0] + 0.1 * np.tanh(v)", static=0.2)],
)  # fmt: skip
def test_friction_may_rise_from_its_static_limit(law):
    """What is lost is the work of friction, so the audit closes, and a push below the limit is held."""
    motion = simulate(block(law), 20.0, ([3.0], [0.0]))
    assert motion.outcome == "completed"
    assert motion.energy.relative_residual < 1e-8
    assert abs(motion.q[-1, 0]) <= 0.2 + 1e-9
    assert motion.mode[-1, 0] == 0


RISING = {
    "stribeck": (lambda s: Stribeck(s, 0.3, 0.1)),
    "linear": (lambda s: LinearSlope(s, 0.2)),
    "table": (lambda s: friction.Table([0.0, 0.1, 1.0], [s, 0.2, 0.3])),
    "cubic": (lambda s: Cubic(s, 0.2, 4.0)),
    "own": (lambda s: own_law("def mu(v, p): return p[0] + 0.3 * np.tanh(v / 0.1)", static=s)),
}


@pytest.mark.parametrize("kind", RISING)
def test_friction_that_rises_from_zero_reverses(kind):
    """A static limit of exactly 0 is the limit of small ones; it was taken for no friction at the reversals."""
    zero, tiny = (simulate(block(RISING[kind](s)), 12.0, ([3.0], [0.0])) for s in (0.0, 1e-12))
    assert zero.outcome == "completed"
    assert len(zero.event_time) == len(tiny.event_time) > 2
    assert zero.q[-1] == pytest.approx(tiny.q[-1], abs=1e-7)  # a table is smooth to its slope only
    friction_power = zero.friction_force[:, 0] * zero.sliding_velocity[:, 0]
    assert np.all(friction_power >= -1e-12)  # it never drives the block


def test_no_friction_at_all_has_no_events():
    for law in (Coulomb(0.0), Stribeck(0.0, 0.0, 0.1), LinearSlope(0.0, 0.0)):
        motion = simulate(block(law), 10.0, ([1.0], [0.0]), method="dormand-prince-8")
        assert len(motion.event_time) == 0
        assert motion.q[-1, 0] == pytest.approx(np.cos(10.0), abs=1e-8)

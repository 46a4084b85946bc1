"""Branches go on past corners: the end of stick-slip against one exact orbit, the drum against shooting by itself."""

from types import SimpleNamespace

import numpy as np
import pytest

from squealbox import Contact, DrumBrake, LinearSlope, Stribeck, System, branch, hopf_point, shooting, simulate
from squealbox.limit_cycles import stick_slip_limit
from squealbox.limit_cycles.branches import corners
from squealbox.limit_cycles.branches.shooting_path import ShootingPath

LAW = Stribeck(0.4, 0.25, 0.3)
SPEEDS = (0.05, 1.0)
CORNER = stick_slip_limit(LAW, (0.2, 0.5), 1.0, 0.2)


def block(speed):
    belt = Contact(n=[0.0], d=[1.0], t=[1.0], N0=1.0, V=speed, law=LAW)
    return System([[1.0]], [[0.2]], [[1.0]], 0.0, (belt,))


@pytest.fixture(scope="module")
def around():
    """Stick-slip cycles to the corner, slipping ones back from it to where they shrink to steady sliding."""
    return branch(block, "speed", SPEEDS, value=0.28, method="shooting", points=100)


def test_the_corner_is_the_exact_end_of_stick_slip(around):
    """There a grazing makes stick-slip and slip meet; asked is 1e-6."""
    assert set(around.special_kind) == {"sticking", "fold"}
    np.testing.assert_allclose(around.special_value, CORNER, rtol=0.0, atol=1e-8)
    assert all(point.uncertainty < 1e-7 for point in around.points)
    assert abs(stick_slip_limit(LAW, (0.2, 0.5), 1.0, 0.21) - CORNER) > 1e-3  # another damping would not pass


def test_beyond_a_point_without_a_motion_nothing_is_looked_for():
    """Its events cannot be told from others: the walk ends as it ended."""
    path = SimpleNamespace(sequence=lambda x, p: None)
    walk = SimpleNamespace(equation=SimpleNamespace(y=lambda x, p: np.append(x, p)), outcome="as it ended")
    assert corners.beyond(path, walk, SimpleNamespace(x=np.ones(2), p=0.3)) == "as it ended"


def test_both_sides_of_the_corner(around):
    """Sticking and stable before it, slipping and unstable after it, and the same series as harmonic balance there."""
    top = int(np.argmax(around.value))
    before, after = slice(0, top - 1), slice(top + 3, None)
    assert np.all(around.stable[before])
    assert np.all(around.sticking[before] > 0.0)
    assert not np.any(around.stable[after])
    assert np.all(around.sticking[after] == 0.0)
    born = hopf_point(block, "speed", SPEEDS)
    slip = branch(block, "speed", SPEEDS, born, harmonics=12, points=100)
    order = np.argsort(slip.value)
    inside = around.value[after] < slip.value[order][-1]  # where the series still has points on both sides
    assert np.sum(inside) > 20
    series = np.interp(around.value[after][inside], slip.value[order], slip.amplitude[order, 0] ** 2)
    np.testing.assert_allclose(around.amplitude[after, 0][inside] ** 2, series, atol=2e-4)  # squares: nearly linear


def test_the_branch_ends_where_it_is_born(around):
    """Without the check of amplitudes the path runs through amplitude zero and back along itself."""
    born = hopf_point(block, "speed", SPEEDS)
    assert around.outcome.ok
    assert around.outcome.evidence["hopf"] == pytest.approx(float(born.value), abs=1e-6)
    assert np.sum(around.special_kind == "fold") == 1


def test_the_drum_beyond_its_corner():
    """Two contacts come to change places at a fold: the cycles beyond it are those that shooting finds by itself."""
    drum = DrumBrake(friction=LinearSlope(0.33, -0.05), reading="consistent")
    large = shooting(drum, ([3e-5, 1e-5], [0.3, -0.3]))
    up = branch(drum, "friction.static", (0.05, 0.6), large, value=0.33, method="shooting", points=70)
    (corner,) = [point for point in up.points if point.kind == "event_order"]
    assert float(corner.value) == pytest.approx(0.3365219, abs=1e-6)  # of this program; what follows is the check
    at = int(up.special_point[list(up.special_kind).index("event_order")])
    assert len(up.value) > at + 10
    for i in (at - 8, at + 8):
        half = up.unknowns.shape[1] // 2
        found = shooting(drum.replace({"friction.static": up.value[i]}), _start(up, i, half))
        assert found.outcome.ok
        assert float(found.period) == pytest.approx(up.period[i], rel=1e-8)
        np.testing.assert_allclose(found.amplitude, up.amplitude[i], rtol=1e-7)  # those of shooting are of 2049 samples
        assert found.stable == up.stable[i]


def _start(up, i, half):
    """(q, qd, period) of a point of the branch, whose unknowns leave out the velocity of y, zero at its top."""
    x = up.unknowns[i]
    return x[:half], np.array([x[half], 0.0]), x[-1]


def test_a_motion_that_jumps_is_said_soon_and_why(monkeypatch):
    """A contact that cannot open is released in the instant in which its normal force, and with it friction, is zero.

    On either side it slips away in another sense. Beyond that instant no cycle lies beside the last; no run of
    the search for one comes near the limit of steps.
    """
    drum = DrumBrake(friction=LinearSlope(0.3, -0.05), reading="eq3")
    begin = ([9.32675611e-05, -5.38643993e-05], [0.220983092, 0.0], 0.0016886172)
    steps = []

    def counted(path, *given):
        run = usual(path, *given)
        steps.append(run.steps)
        return run

    usual = ShootingPath._motion
    monkeypatch.setattr(ShootingPath, "_motion", counted)
    up = branch(drum, "sliding_speed", (0.05, 0.8), begin, value=0.32814, method="shooting", points=60)
    assert up.outcome == "jump"
    assert 0 < max(steps) < 1000  # a period takes 30
    found = up.outcome.evidence
    assert found["p"] == pytest.approx(0.33340535, abs=1e-8)  # of this program; what follows is the check
    assert (found["contact"], found["mode_before"], found["mode_after"]) == (0, -1, 1)
    assert abs(found["normal_force"]) < 1e-8 * found["largest_force"]
    last = up.start[-1]
    for beyond, same in ((-1e-6, True), (1e-6, False)):  # the last cycle, run at speeds beside it, comes back or not
        beside = drum.replace({"sliding_speed": float(up.value[-1]) + beyond})
        run = simulate(beside, float(up.period[-1]), (last[:2], last[2:]), rtol=1e-12)
        off = np.max(np.abs(run.q[-1] - last[:2])) / np.max(up.amplitude[-1])
        assert (off < 1e-3) == same

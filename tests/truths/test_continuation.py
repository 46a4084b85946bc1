"""The path follower against curves known in closed form."""

import numpy as np
import pytest

from squealbox.continuation import StepControl, follow


def test_circle_closes_and_turns_twice() -> None:
    path = follow(lambda x, p: x**2 + p**2 - 1.0, 1.0, 0.0)
    points = list(path)
    radius = [np.hypot(float(point.x[0]), point.p) for point in points]
    assert np.max(np.abs(np.array(radius) - 1.0)) < 1e-10  # Newton's tolerance, which converges quadratically
    assert sum(point.fold for point in points) == 2
    assert path.outcome == "completed"
    assert path.outcome.evidence == {"closed": True}


def test_fold_is_passed_and_the_bound_is_landed_on() -> None:
    control = StepControl(first=0.05)
    path = follow(lambda x, p: p - x + x**3, -1.5, 1.875, direction=-1.0, bounds=(-2.0, 2.0), control=control)
    points = list(path)
    assert [point.fold for point in points].count(True) == 2
    assert points[-1].p == pytest.approx(-2.0, abs=1e-12)
    turn = max(abs(point.p) for point in points if abs(float(point.x[0])) < 0.9)
    assert turn == pytest.approx(2.0 / (3.0 * np.sqrt(3.0)), abs=1e-3)  # fold of x - x^3; points are 0.1 apart at most


def test_natural_continuation_would_have_stopped_at_the_fold() -> None:
    path = follow(lambda x, p: p + x**2, 1.0, -1.0, bounds=(-1.5, np.inf))
    points = list(path)
    assert max(point.p for point in points) <= 1e-12
    assert float(points[-1].x[0]) < 0.0


def test_branch_point_is_marked() -> None:
    control = StepControl(first=0.07, largest=0.07)
    path = follow(lambda x, p: x * (p - x), 0.0, -1.0, bounds=(-2.0, 1.0), control=control)
    marked = [point.p for point in path if point.branching]
    assert len(marked) == 1
    assert 0.0 <= marked[0] < 0.07  # the first point past the crossing at p = 0


def test_a_supplied_jacobian_gives_the_same_path() -> None:
    def residual(x, p):
        return np.array([x[0] ** 2 + x[1] - p, x[1] - np.sin(p)])

    def jacobian(x, p):
        return np.array([[2.0 * x[0], 1.0], [0.0, 1.0]]), np.array([-1.0, -np.cos(p)])

    control = StepControl(first=0.1, largest=0.1)
    own, given = (
        list(follow(residual, [1.0, 0.8], 1.8, bounds=(1.0, 3.0), jacobian=choice, control=control))
        for choice in (None, jacobian)
    )
    assert len(own) == len(given)
    assert np.max(np.abs(own[-1].x - given[-1].x)) < 1e-8  # error of central differences


def test_no_root_at_the_start_is_a_named_outcome() -> None:
    path = follow(lambda x, p: x**2 + 1.0 + p**2, 1.0, 0.0)
    assert list(path) == []
    assert path.outcome == "no_start"


def test_a_path_that_ends_is_a_named_outcome() -> None:
    path = follow(lambda x, p: x - np.sqrt(1.0 - p), 1.0, 0.0, bounds=(-np.inf, 5.0))
    with np.errstate(invalid="ignore"):
        points = list(path)
    assert path.outcome == "step_underflow"
    assert points[-1].p == pytest.approx(1.0, abs=1e-3)


@pytest.mark.parametrize("far", [10.0, np.inf])
def test_newton_is_stopped_beside_a_path_that_jumps(far, monkeypatch) -> None:
    """Beyond the jump Newton's method on an arctangent overshoots ever farther; without the limit that is asked for."""
    monkeypatch.setattr("squealbox.continuation.FAR", far)
    asked = []

    def off(x, p):
        return 500.0 * (x - (0.0 if p < 0.5 else 3.0))

    def residual(x, p):
        asked.append(abs(float(x[0])))
        return np.arctan(off(x, p))

    def jacobian(x, p):
        return (500.0 / (1.0 + off(x, p) ** 2))[:, None], np.zeros(1)

    path = follow(residual, 0.0, 0.0, bounds=(-0.1, 1.0), jacobian=jacobian, control=StepControl(first=0.2))
    with np.errstate(over="ignore"):
        points = list(path)
    assert path.outcome == "step_underflow"
    assert points[-1].p == pytest.approx(0.5, abs=1e-6)
    assert (max(asked) < 100.0) == (far < np.inf)

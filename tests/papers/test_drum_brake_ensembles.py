"""Maps by transients: the kinds they name, and that they agree with single runs and with the eigenvalues."""

import numpy as np
import pytest

from squealbox.papers.drum_brake_2011 import ensemble_figures, ensembles, steady
from squealbox.papers.drum_brake_2011.cases import DEFAULT_READING, DURATION, Case
from squealbox.papers.drum_brake_2011.ensembles import BESIDE, HELD, MEANS, QUIET, RINGING, SQUEAL, UNKNOWN
from squealbox.transient import simulate

CASE = Case(DEFAULT_READING)


@pytest.fixture(scope="module")
def centres() -> ensembles.SquealMap:
    return ensembles.pressure(CASE, 15)


def test_what_is_unstable_squeals_and_the_shares_are_of_the_whole(centres) -> None:
    """Growth of 100 1/s and more from a step load fills the cycle well within 0.05 s."""
    unstable = centres.growth > 100.0
    assert unstable.any()
    assert np.all(centres.kind[unstable] == SQUEAL)
    assert np.all(centres.kind[centres.growth < -100.0] == QUIET)
    assert sum(centres.shares) == pytest.approx(1.0, abs=1e-12)  # a sum of six shares


def test_the_level_is_that_of_a_single_run(centres) -> None:
    """The peak speed of the last fifth, read off a trajectory, over the belt's."""
    i, j = np.argwhere(centres.kind == SQUEAL)[0]
    run = simulate(CASE.design(theta1=centres.x[i], theta2=centres.y[j]), DURATION, "rest", 5001)
    late = run.qd[run.t > 0.8 * DURATION]
    peak = 0.5 * np.max(np.ptp(late, axis=0)) / CASE.speed
    # a cycle limited by friction is no pure sine: its peak speed is within a quarter of 2 pi f A
    assert centres.level[i, j] == pytest.approx(peak, rel=0.25)


def test_the_map_of_growth_is_the_one_by_eigenvalues(centres) -> None:
    expected = steady.pressure_map(CASE, step=10.0)
    np.testing.assert_allclose(centres.growth, expected.growth, rtol=1e-12)


def test_each_reason_has_its_name() -> None:
    unstable = np.array([False, False, False, True, True, False])
    short = np.array([1.0, 1.0, 0.3, 0.05, 0.0, 1.0])
    longer = np.array([1.0, 0.01, 0.15, 1.0, 0.0, np.nan])
    expected = [BESIDE, RINGING, RINGING, SQUEAL, HELD, UNKNOWN]
    assert ensembles._why(unstable, short, longer).tolist() == expected


@pytest.mark.parametrize("size", [33, 34, 2])
def test_a_refined_map_is_the_full_one_with_fewer_runs(size: int) -> None:
    """A disc and a half plane on a grid of any size: every point has its kind, most without a run."""
    x, y = np.meshgrid(np.arange(size), np.arange(size), indexing="ij")
    full = np.where((x - 12) ** 2 + (y - 15) ** 2 < 40, SQUEAL, np.where(y > 24, BESIDE, QUIET))
    kind, asked = np.full(full.shape, UNKNOWN), np.zeros(full.shape, int)

    def run(there) -> None:
        asked[there] += 1
        kind[there] = full[there]

    made = ensembles.refined(full == SQUEAL, kind, run, 4)
    np.testing.assert_array_equal(kind, full)
    np.testing.assert_array_equal(asked, made.astype(int))  # none twice
    assert size != 33 or made.mean() < 0.5


def test_an_island_between_the_coarse_points_is_found_by_its_eigenvalues_alone() -> None:
    """The limit of refining, said on the page: an island of one point is seen only where an eigenvalue tells of it."""
    full = np.full((9, 9), QUIET)
    full[2, 2] = BESIDE
    for unstable, expected in ((np.zeros((9, 9), bool), QUIET), (full == BESIDE, BESIDE)):
        kind = np.full(full.shape, UNKNOWN)
        ensembles.refined(unstable, kind, lambda there, kind=kind: kind.__setitem__(there, full[there]), 4)
        assert kind[2, 2] == expected


def test_a_cycle_beside_stable_sliding_is_found() -> None:
    """theta1 = 20, theta2 = 125 deg: sliding is stable, but a step load ends on a cycle; at theta1 = 90 it does not."""
    over = {"theta1": np.deg2rad([20.0, 90.0]), "theta2": np.deg2rad([125.0, 126.0])}
    found = ensembles._map(CASE, over)
    assert np.all(found.growth < 0.0)
    assert np.all(found.kind[0] == BESIDE)
    assert np.all(found.kind[1] == QUIET)


def test_maxima_part_at_the_onset() -> None:
    found = ensembles.maxima(CASE, 5)  # mu = 0.05, 0.1875, 0.325, 0.4625, 0.6
    away = np.abs(found.from_sliding - found.sliding[:, None])
    onset = steady.onset_in_friction(CASE).value
    assert np.all(np.nan_to_num(away[found.mu < onset - 0.02]) < 1e-9)
    assert np.all(np.min(away[found.mu > onset], axis=1) > 1e-6)


def test_figures_show_both_roads_and_name_the_kinds(centres) -> None:
    figure = ensemble_figures.pressure(centres)
    assert [panel.get_title() for panel in figure.axes[:2]] == ["by eigenvalues", "by transients of 0.05 s"]
    named = [text.get_text() for text in figure.legends[0].get_texts()]
    assert named == [MEANS[kind] for kind in np.unique(centres.kind)]
    assert figure.axes[1].get_xlim() == pytest.approx((20.0, 160.0))

"""Two roads to the same spectrum, the same flag, the same boundary."""

from itertools import pairwise

import numpy as np
import pytest

from squealbox.designs import DrumBrake
from squealbox.friction import LinearSlope
from squealbox.parameters import DataSheet, parameter
from squealbox.stability import complex_modes, critical_value, stability_boundary, stability_map
from squealbox.stability.family import SteadyFamily, steady_sliding
from squealbox.stability.mechanisms import contributions
from squealbox.stability.spectra import asymptotically_stable, eigenvalues_of, largest_growth
from squealbox.system import System

# Eigenvalues of well-conditioned matrices of this size agree to some 1e-13; the worst of thousands of random ones have
# condition numbers up to 1e6.
TYPICAL, WORST = 1e-12, 1e-7


def random_systems(count: int, size: int, seed: int) -> System:
    rng = np.random.default_rng(seed)
    root = rng.normal(size=(count, size, size))
    mass = np.eye(size) + 0.1 * (root @ np.swapaxes(root, -1, -2))
    stiffness = 3.0 * np.eye(size) + rng.normal(size=(count, size, size))
    return System(M=mass, C=0.3 * rng.normal(size=(count, size, size)), K=stiffness)


def test_compiled_growth_flags_and_counts_of_two_degrees_of_freedom() -> None:
    about = steady_sliding(random_systems(6001, 2, 1))
    plain, fast = largest_growth(about, "numpy"), largest_growth(about, "compiled")
    gap = np.abs(plain[0] - fast[0])
    assert np.quantile(gap, 0.99) < TYPICAL
    assert np.max(gap) < WORST
    assert np.array_equal(plain[2], fast[2])
    assert np.array_equal(asymptotically_stable(about, "compiled"), plain[0] < 0.0)


@pytest.mark.parametrize("shared", [True, False])
def test_compiled_growth_of_a_drum_map_is_that_of_numpy(shared: bool) -> None:
    mus, loads = np.meshgrid(np.linspace(0.1, 0.6, 40), np.linspace(100.0, 2e4, 40))
    design = DrumBrake(friction=LinearSlope(mus, -0.05), load1=loads, load2=loads)
    about = steady_sliding(design if shared else design.replace(m=1.0 + 1e-3 * mus))
    plain, fast = largest_growth(about, "numpy"), largest_growth(about, "compiled")
    assert np.max(np.abs(plain[0] - fast[0])) < 1e-12 * 1.3e4
    # near a coalescence two modes have almost one growth rate, and either may be called the worst
    assert np.quantile(np.abs(plain[1] - fast[1]), 0.99) < 1e-11 * 1.3e4
    terms = [np.array(contributions(about, engine=engine)) for engine in ("numpy", "compiled")]
    assert np.max(np.abs(terms[0] - terms[1])) < 1e-6  # sums of 24 growth rates, some of them at a coalescence
    assert np.max(np.abs(np.sum(terms[1], axis=0) - plain[0])) < 1e-6


@pytest.mark.parametrize("size", [2, 6])
def test_spectrum_in_both_engines(size: int) -> None:
    about = steady_sliding(random_systems(50, size, 2))
    plain, fast = eigenvalues_of(about, "numpy"), eigenvalues_of(about, "compiled")
    assert np.max(np.min(np.abs(plain[:, :, None] - fast[:, None, :]), axis=2)) < 1e-9


def test_map_is_the_modes_point_by_point() -> None:
    axes = {"friction.static": np.linspace(0.2, 0.5, 7), "load": np.linspace(500.0, 4000.0, 5)}
    design = DrumBrake()
    found = stability_map(design, axes)
    assert found.growth_rate.shape == (7, 5)
    for i, mu in enumerate(axes["friction.static"]):
        for j, load in enumerate(axes["load"]):
            modes = complex_modes(design.replace({"friction.static": float(mu), "load": float(load)}))
            assert found.growth_rate[i, j] == pytest.approx(float(modes.largest_growth_rate), abs=1e-8)
            assert found.unstable_modes[i, j] == modes.unstable_modes
            assert (found.mechanism[i, j] == 0) == bool(modes.stable)
    names = {found.mechanism_names[code] for code in np.unique(found.mechanism)}
    assert {"stable", "flutter", "negative_slope"} <= names
    assert set(found.to_dataset().dims) == {"friction.static", "load"}


def test_a_corner_without_steady_sliding_does_not_end_a_map() -> None:
    found = stability_map(DrumBrake(), {"sliding_speed": [0.0, 0.1, 0.2]})
    assert list(found.exists) == [False, True, True]
    assert found.mechanism[0] == -1


def missed(design, bounds, resolution: int) -> tuple[int, float]:
    """Crossed grid edges farther than one cell from every traced curve, and the largest |growth rate| on the curves."""
    from scipy.spatial import cKDTree

    traced = stability_boundary(design, bounds)
    low = np.array([span[0] for span in bounds.values()])
    width = np.array([span[1] for span in bounds.values()]) - low
    grids = [np.linspace(a, a + w, resolution) for a, w in zip(low, width, strict=True)]
    unstable = stability_map(design, dict(zip(bounds, grids, strict=True)), mechanism=False).unstable
    edges = [
        np.argwhere(unstable[1:] != unstable[:-1]) + np.array([0.5, 0.0]),
        np.argwhere(unstable[:, 1:] != unstable[:, :-1]),
    ]
    crossed = np.vstack([edges[0], edges[1] + np.array([0.0, 0.5])])
    if len(crossed) == 0:
        return 0, 0.0
    if len(traced.x) == 0:
        return len(crossed), 0.0
    share = np.linspace(0.0, 1.0, 30)[:, None]
    dense = [a + (b - a) * share for curve in traced.curves for a, b in pairwise(curve)]
    points = (np.concatenate(dense) - low) / width * (resolution - 1)
    far = cKDTree(points).query(crossed)[0] > 1.0
    return int(np.sum(far)), float(np.max(np.abs(traced.growth_rate)))


@pytest.mark.parametrize(
    ("reading", "slope", "bounds"),
    [
        ("consistent", -0.02, {"theta1": (0.35, 2.8), "theta2": (0.35, 2.8)}),
        ("consistent", -0.05, {"friction.static": (0.1, 0.6), "load": (100.0, 2e4)}),
        ("eq3", 0.0, {"friction.static": (0.1, 0.6), "theta1": (0.35, 2.8)}),  # flutter tongue and divergence
    ],
)
def test_traced_boundary_misses_nothing_of_a_grid(reading: str, slope: float, bounds: dict) -> None:
    far, left = missed(DrumBrake(friction=LinearSlope(0.33, slope), reading=reading), bounds, 401)
    assert far == 0
    assert left < 1e-8  # 1/s: round-off of eigenvalues of 1e4 1/s times the steepness of growth near the curve


class IslandAndStrip(DataSheet):
    """Negative damping inside a circle of radius 0.004, and in a strip 0.002 wide."""

    x: float = parameter("-")
    y: float = parameter("-")

    def system(self) -> System:
        x, y = np.broadcast_arrays(self.x, self.y)
        damping = np.zeros((*x.shape, 2, 2))
        damping[..., 0, 0] = (x - 0.4013) ** 2 + (y - 0.3017) ** 2 - 0.004**2
        damping[..., 1, 1] = (y - 0.8 - 0.1 * x) ** 2 - 0.001**2
        return System(M=np.eye(2), C=damping, K=np.diag([1.0, 3.0]))


def test_an_island_and_a_thin_tongue_between_grid_points_are_found() -> None:
    """The cells that are started from are 0.03 wide."""
    found = stability_boundary(IslandAndStrip(0.0, 0.0), {"x": (0.0, 1.0), "y": (0.0, 1.0)})
    islands = [curve for i, curve in enumerate(found.curves) if found.closed(i)]
    assert len(islands) == 1
    assert np.hypot(islands[0][:, 0] - 0.4013, islands[0][:, 1] - 0.3017) == pytest.approx(0.004, abs=1e-7)
    assert len(found.curves) == 3  # and both sides of the strip
    assert np.max(np.abs(found.growth_rate)) < 1e-9


def test_a_rectangle_without_boundary_says_so() -> None:
    found = stability_boundary(DrumBrake(), {"friction.static": (0.05, 0.1), "load": (100.0, 500.0)})
    assert found.outcome == "no_boundary"
    assert len(found.curves) == 0


def test_boundary_passes_through_the_critical_values() -> None:
    design = DrumBrake()
    curve = stability_boundary(design, {"friction.static": (0.1, 0.6), "load": (100.0, 5e3)})
    onset = critical_value(design.replace(load=1500.0), "friction.static", (0.1, 0.6))
    on_curve = np.interp(1500.0, np.sort(curve.y), curve.x[np.argsort(curve.y)])
    assert on_curve == pytest.approx(float(onset.value), abs=2e-3)  # straight lines between points 0.04 apart


def test_family_of_a_function_is_that_of_a_design() -> None:
    design = DrumBrake()
    values = np.array([0.2, 0.4])
    batch = SteadyFamily(design, ["friction.static"]).at(values)
    single = SteadyFamily(lambda mu: design.replace({"friction.static": mu}), ["friction.static"]).at(values)
    assert np.array_equal(batch.K, single.K)
    assert np.array_equal(batch.structural, single.structural)

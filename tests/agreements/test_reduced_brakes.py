"""A reduced brake and the full one: eigenvalues within the error bar, and the same answers from every analysis."""

import numpy as np
import pytest

from fe_brakes import PUBLISHED, dense, pad_brake
from squealbox import (
    Coulomb,
    DiscBrake,
    ParameterError,
    PublishedDiscBrake,
    Result,
    complex_modes,
    critical_value,
    equilibrium,
    mechanism,
    mode_energy,
    reduce,
    silence,
    simulate,
    sweep,
    tracked_modes,
)
from squealbox.family import ParameterAxis
from squealbox.report.examining import examine
from squealbox.stability import critical_values, family, stability_boundary, stability_map
from squealbox.stability.eigenvalues import modes_of
from squealbox.system import InvalidSystem, linearise

NODES = (6, 8)
BAND = (3000.0, 7000.0)
RANGE = {"friction.static": (0.1, 0.5)}


def full_at(mu: float, **how):
    return dense(pad_brake(*NODES, friction=Coulomb(mu), **how))


def in_band(values):
    return values[(values.imag > 2 * np.pi * BAND[0]) & (values.imag < 2 * np.pi * BAND[1])]


def farthest(values, every):
    return max(float(np.min(np.abs(every - value))) for value in values)


@pytest.fixture(scope="module")
def small():
    return reduce(pad_brake(*NODES, friction=Coulomb(0.3), across=False, unilateral=True), BAND, varying=RANGE)


@pytest.mark.parametrize("mu", [0.1, 0.22, 0.3, 0.41, 0.5])
def test_eigenvalues_in_the_band_are_within_the_error(small, mu):
    every = complex_modes(full_at(mu, across=False, unilateral=True)).eigenvalues
    found = in_band(complex_modes(small.replace({"friction.static": mu})).eigenvalues)
    assert len(found) == len(in_band(every)) > 5
    assert farthest(found, every) < 0.1  # twice the tolerance asked for: between the corners the error is not bounded
    assert small.error < 0.05
    checked = small.replace({"friction.static": mu}).checked()
    assert farthest(checked.eigenvalues + checked.error, every) < 0.02


def test_steady_sliding_is_that_of_the_full_brake_with_the_same_contacts_open(small):
    for mu in (0.1, 0.3, 0.5):
        expected = equilibrium(full_at(mu, across=False, unilateral=True))
        found = equilibrium(small.replace({"friction.static": mu}).system())
        np.testing.assert_array_equal(found.normal_force == 0.0, expected.normal_force == 0.0)
        np.testing.assert_allclose(found.normal_force, expected.normal_force, atol=2e-3 * np.max(expected.normal_force))


def test_onset_and_mechanism(small):
    direct = critical_value(lambda mu: full_at(mu, across=False, unilateral=True), "mu", (0.1, 0.5), points=9)
    found = critical_value(small, "friction.static", (0.1, 0.5), points=41)
    assert abs(float(found.value) - float(direct.value)) < found.uncertainty < 1e-5
    assert found.mechanism == direct.mechanism == "flutter"
    assert mechanism(small.replace({"friction.static": 0.5})).name == "flutter"


@pytest.fixture(scope="module")
def meshed():
    brake = DiscBrake(element_size=0.05)
    return brake, reduce(brake, (2500.0, 5000.0), varying={"friction.static": (0.2, 0.6)})


def test_the_critical_friction_of_a_meshed_brake_is_that_of_its_1656_freedoms(meshed, monkeypatch):
    monkeypatch.setattr(family, "linearise", None)  # no dense matrix is linearised on the way
    brake, small = meshed
    every = critical_values(small, "friction.static", (0.2, 0.6))
    found = next(iter(every))
    assert every.unstable_below.tolist() == [1, 2]
    assert found.mechanism == "flutter"
    assert found.direction == "destabilising"
    growth = []
    for share in (-1.0, 1.0):
        there = brake.replace({"friction.static": float(found.value + share * found.uncertainty)})
        near = complex_modes(there, band=(found.frequency - 20.0, found.frequency + 20.0), method="full")
        growth.append(float(near.largest_growth_rate))
    assert growth[0] < 0.0 < growth[1]
    assert found.uncertainty < 2e-4


def test_a_map_and_an_array_of_values_are_the_modes_of_the_band_at_each(meshed):
    brake, small = meshed
    values = np.array([0.25, 0.35, 0.5])
    together = complex_modes(small.replace({"friction.static": values}))
    found = stability_map(small, {"friction.static": values})
    for i, value in enumerate(values):
        alone = complex_modes(small.replace({"friction.static": value}))
        np.testing.assert_array_equal(together.eigenvalues[i][np.isfinite(together.eigenvalues[i])], alone.eigenvalues)
        full = complex_modes(brake.replace({"friction.static": float(value)}), band=small.band)
        assert found.growth_rate[i] == pytest.approx(np.max(full.corrected.real), abs=0.5)
        assert found.unstable_modes[i] == full.unstable_modes
    assert list(found.mechanism) == [1, 1, 1]


def test_what_would_run_for_minutes_says_so_and_the_way_out(meshed):
    _, small = meshed
    with pytest.raises(InvalidSystem, match="the full brake is not kept"):
        silence(small.replace({"full": None}))
    with pytest.raises(InvalidSystem, match="map_boundary"):
        stability_boundary(small, {"friction.static": (0.2, 0.6), "friction.kinetic": (0.2, 0.6)})
    found = examine(small, onset=ParameterAxis("friction.static", 0.2, 0.6))
    assert len(found.crossings) == 2
    assert "[simulate] in the file" in found.missing["transient"]
    assert "squealbox cycle" in found.missing["cycle"]


@pytest.mark.parametrize("mu", [0.1, 0.22, 0.45])
def test_modes_of_the_band_are_those_of_the_whole_spectrum_of_the_small_brake(small, mu):
    arrays = small.reduction.arrays
    bare = {**arrays, "C": arrays["C"] - arrays["high"], "high": 0.0 * arrays["high"]}  # without what was added above
    brake = small.replace({"friction.static": mu, "reduction": small.reduction.replace(arrays=bare)})
    pairs, state = brake.band_modes()
    whole = modes_of(linearise(brake.system())).within(BAND)
    half = len(whole.eigenvalues) // 2
    assert len(pairs.values) == half
    np.testing.assert_allclose(pairs.values, whole.eigenvalues[:half], rtol=1e-10)
    np.testing.assert_allclose(np.abs(np.sum(pairs.right.conj() * whole.right[:, :half], axis=0)), 1.0, rtol=1e-6)
    np.testing.assert_allclose(state.q, whole.steady, atol=1e-9 * np.max(np.abs(whole.steady)))
    np.testing.assert_allclose(state.normal_force, whole.normal_force, atol=1e-9 * np.max(whole.normal_force))
    assert brake.band_modes((BAND[0], 2.0 * BAND[1])) is None  # beyond the band it was reduced for


def test_feed_in_of_every_contact_is_that_of_the_full_brake(small):
    brake = small.replace({"friction.static": 0.45})
    mode = complex_modes(brake).most_unstable
    energy = mode_energy(brake, mode)
    system = pad_brake(*NODES, friction=Coulomb(0.45), across=False, unilateral=True)
    full = complex_modes(system, band=BAND, method="full")
    same = full.mode(int(np.argmin(np.abs(full.eigenvalues - mode.eigenvalue))))
    expected = mode_energy(system, same)
    np.testing.assert_allclose(
        energy.circulation / energy.total,
        expected.circulation / expected.total,
        atol=1e-3 * np.max(np.abs(expected.circulation / expected.total)),
    )
    shape = brake.expand(mode.shape)
    likeness = abs(np.vdot(shape, same.shape)) ** 2 / (np.vdot(shape, shape) * np.vdot(same.shape, same.shape)).real
    assert likeness > 0.9999


def test_tracking_sweeps_and_probability_take_it(small):
    values = np.linspace(0.1, 0.5, 9)
    tracked = tracked_modes(small, "friction.static", values)
    assert np.all(np.isfinite(tracked.eigenvalues))
    swept = sweep(small, {"friction.static": values}, complex_modes)
    assert swept.dataset["largest_growth_rate"].shape == (9,)


def test_a_small_perturbation_grows_in_time_as_the_eigenvalue_says(small):
    brake = small.replace({"friction.static": 0.45})
    mode = complex_modes(brake).most_unstable
    motion = simulate(brake, 3e-4, start=mode.start(1e-9), method="dormand-prince-8")
    steady = equilibrium(brake.system()).q
    weight = brake.system().M @ mode.left
    size = np.abs((motion.q - steady) @ np.conj(weight) * mode.eigenvalue + (motion.qd) @ np.conj(weight))
    rate = np.polyfit(motion.t, np.log(size), 1)[0]
    assert rate == pytest.approx(mode.growth_rate, rel=2e-2)


@pytest.mark.parametrize("method", ["craig-bampton", "pod"])
def test_the_other_bases_know_their_error(method):
    system = pad_brake(*NODES, friction=Coulomb(0.3))
    brake = reduce(system, BAND, varying=RANGE, method=method)
    every = complex_modes(full_at(0.5)).eigenvalues
    found = in_band(complex_modes(brake.replace({"friction.static": 0.5})).eigenvalues)
    assert farthest(found, every) < 2.0 * brake.error + 1e-3
    assert brake.reduction.method == method


def test_a_bilateral_contact_that_pulls_is_named_on_the_quick_road_too():
    system = pad_brake(4, 5, friction=Coulomb(0.3))
    assert complex_modes(reduce(system, BAND)).caution == ""
    force = np.array(system.contacts.N0)
    force[3] = -8.0
    pulled = system.replace(contacts=system.contacts.replace(N0=force))
    modes = complex_modes(reduce(pulled, BAND))
    assert modes.caution.startswith("contact 4: N falls to -")
    assert modes.caution == complex_modes(dense(pulled)).caution


def test_what_it_was_not_reduced_for_is_refused(small):
    with pytest.raises(ParameterError, match="did you mean 'static'"):
        small.replace({"friction.statik": 0.2})
    with pytest.raises(ValueError, match="band"):
        reduce(pad_brake(), (7000.0, 3000.0))
    with pytest.raises(ValueError, match="dense"):
        reduce(dense(pad_brake()), BAND)
    with pytest.raises(ValueError, match="expected one of enriched"):
        reduce(pad_brake(), BAND, method="guyan")


def test_a_result_keeps_the_small_brake_but_not_the_full_one(small, tmp_path):
    modes = complex_modes(small)
    path = modes.save(tmp_path / "modes.nc")
    again = Result.load(path).inputs["system"]
    np.testing.assert_allclose(complex_modes(again).eigenvalues, modes.eigenvalues)
    with pytest.raises(ValueError, match="not kept in files"):
        again.expand(np.zeros(3))


@pytest.mark.skipif(not PUBLISHED.is_dir(), reason="the published matrices are not beside this checkout")
def test_the_published_brake_over_its_speed():
    brake = PublishedDiscBrake(folder=str(PUBLISHED), assembly="b", angular_speed=2 * np.pi)
    small = reduce(brake, (600.0, 3000.0), varying={"angular_speed": (2 * np.pi, 6 * np.pi)}, tolerance=0.1)
    assert small.error < 0.1
    between = complex_modes(small.replace({"angular_speed": 8.9})).eigenvalues  # C = A / speed + B speed: no polynomial
    known = small.checked(angular_speed=8.9)
    apart = np.min(np.abs(known.eigenvalues[:, None] - between), axis=1)
    assert np.max(apart + np.abs(known.error)) < 0.1
    for speed, expected in ((2 * np.pi, (2.0763, 783.097)), (4 * np.pi, (5.4742, 784.990))):
        values = complex_modes(small.replace({"angular_speed": speed})).eigenvalues
        nearest = values[np.argmin(np.abs(values - complex(expected[0], 2 * np.pi * expected[1])))]
        assert nearest.real == pytest.approx(expected[0], abs=small.error)
    with pytest.raises(ParameterError, match="what it was reduced for"):
        small.replace({"angular_speed": 100.0})
    with pytest.raises(InvalidSystem, match=r"from 0.01 to 100 changes . too abruptly"):
        reduce(brake, (600.0, 3000.0), varying={"angular_speed": (1e-2, 1e2)})

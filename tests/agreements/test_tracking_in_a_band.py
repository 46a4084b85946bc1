"""Modes of a reduced brake followed by those of its band, and by its whole spectrum: one answer at two prices."""

import numpy as np
import pytest

from fe_brakes import pad_brake
from squealbox import Coulomb, DiscBrake, complex_modes, reduce, tracked_modes
from squealbox.fe import band_spectrum
from squealbox.fe.pencil import vibrating
from squealbox.stability import eigenvalues as eigenvalues_module
from squealbox.system import InvalidSystem

MU = "friction.static"


@pytest.fixture(scope="module")
def small():
    brake = pad_brake(6, 8, friction=Coulomb(0.3), across=False, unilateral=True)
    return reduce(brake, (3000.0, 7000.0), varying={MU: (0.1, 0.5)})


def upper(tracked):
    return tracked.eigenvalues[:, : tracked.eigenvalues.shape[1] // 2]


def column_at(row, value):
    """The column whose eigenvalue is this one to 1e-8 of its size."""
    column = int(np.nanargmin(np.abs(row - value)))
    assert abs(row[column] - value) < 1e-8 * abs(value)
    return column


def test_each_track_is_one_track_of_the_whole_spectrum(small):
    values = np.linspace(0.1, 0.5, 9)
    found = tracked_modes(small, MU, values)
    whole = tracked_modes(lambda mu: small.replace({MU: mu}), MU, values)  # of a function nothing is known: all modes
    low, high = (2.0 * np.pi * f for f in small.band)
    inside = vibrating(whole.eigenvalues) & (whole.eigenvalues.imag >= low) & (whole.eigenvalues.imag <= high)
    np.testing.assert_array_equal(np.sum(np.isfinite(upper(found)), axis=1), np.sum(inside, axis=1))
    for track in upper(found).T:
        known = np.flatnonzero(np.isfinite(track))
        columns = {column_at(whole.eigenvalues[k], track[k]) for k in known}
        assert len(columns) == 1
        (column,) = columns
        shapes = [(found.right[k][:, np.argmin(np.abs(found.eigenvalues[k] - track[k]))], k) for k in known]
        for shape, k in shapes:
            assert abs(np.vdot(shape, whole.right[k][:, column])) == pytest.approx(1.0, abs=1e-6)
    np.testing.assert_array_equal(found.eigenvalues[:, upper(found).shape[1] :], upper(found).conj())


def test_a_mode_leaves_the_band_and_comes_back_to_its_own_place(small):
    there = np.linspace(0.1, 0.5, 9)
    values = np.r_[there, there[::-1][1:]]
    wide = upper(tracked_modes(small, MU, values))
    widths = np.ptp(wide.imag, axis=0)
    mover = int(np.nanargmax(np.where(np.all(np.isfinite(wide), axis=0), widths, 0.0)))
    end = float(np.mean(wide.imag[[0, 8], mover])) / (2.0 * np.pi)  # crossed half way, beside a coalescence
    narrow = small.replace({"reduction": small.reduction.replace(band=(small.band[0], end))})
    found = tracked_modes(narrow, MU, values)
    assert np.all(found.clear)
    expected = np.where(wide.imag <= 2.0 * np.pi * end, wide, np.nan)
    seen = expected[:, np.any(np.isfinite(expected), axis=0)]
    assert upper(found).shape == seen.shape
    order = [column_at(seen[k], track[k]) for track in upper(found).T for k in np.flatnonzero(np.isfinite(track))[:1]]
    np.testing.assert_array_equal(np.isfinite(upper(found)), np.isfinite(seen[:, order]))
    np.testing.assert_allclose(upper(found), seen[:, order], rtol=1e-8)
    mine = upper(found)[4]  # at this value all are in the band
    track = upper(found)[:, column_at(mine, wide[4, mover])]
    np.testing.assert_array_equal(np.isnan(track), np.isnan(expected[:, mover]))
    assert np.isnan(track[0])  # it comes in, leaves and comes in again, on one line
    assert "values, from" in found.summary()


def test_no_whole_spectrum_is_solved_and_each_value_once(small, monkeypatch):
    asked = []

    def counted(*args, **keywords):
        asked.append(args)
        return band_spectrum.band_pairs(*args, **keywords)

    monkeypatch.setattr("squealbox.stability.tracking.band_pairs", counted)
    monkeypatch.setattr(eigenvalues_module, "state_matrix", None)
    tracked = tracked_modes(small, MU, np.linspace(0.1, 0.5, 9))
    assert np.all(tracked.clear)
    assert len(asked) < 15


def test_a_figure_of_tracks_leaves_out_what_is_not_in_the_band(small):
    import squealbox.plots as plots

    tracked = tracked_modes(small, MU, np.linspace(0.1, 0.5, 5))
    gone = tracked.eigenvalues.copy()
    gone[3:, 5] = complex(np.nan, np.nan)
    above, below = plots.plot(type(tracked)(**{**vars(tracked), "eigenvalues": gone})).axes[:2]
    drawn = [line.get_ydata() for line in above.get_lines()]
    assert any(np.sum(np.isfinite(y)) == 3 for y in drawn)
    assert np.nanmin(np.concatenate(drawn)) > 2.9  # kHz: a missing mode is no mode at 0 Hz
    growing = np.max(np.real(complex_modes(small.replace({MU: 0.5})).eigenvalues)) > 0.0
    assert growing == (len(below.patches) > 0)


def test_the_full_brake_says_in_a_sentence_that_it_needs_to_be_reduced():
    with pytest.raises(InvalidSystem, match=r"sparse, with 1656 .*reduce\(brake, band=\(f1, f2\)\)"):
        tracked_modes(DiscBrake(element_size=0.05), MU, [0.1, 0.2])
    with pytest.raises(InvalidSystem, match="reduce"):
        tracked_modes(pad_brake(4, 5), MU, [0.1, 0.2])

"""Whether kept instants carry a motion, whatever its unit, and what is said where they do not."""

import dataclasses

import numpy as np
import pytest

from squealbox import MassOnBelt, System, plot, signals, simulate
from squealbox.plots import motion
from squealbox.transient.resolution import carries


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("times", [9, 999])
def test_a_motion_beyond_squares_is_carried_as_the_same_one_in_small(times):
    small = simulate(MassOnBelt(), 10.0 if times > 9 else 100.0, times=times)
    large = dataclasses.replace(small, q=1e200 * small.q, qd=1e200 * small.qd)
    assert carries(large) == carries(small) == (times > 9)


def swinging(count):
    """A free oscillation of 2 Hz for 20 s at `count` instants."""
    block = System([[1.0]], [[0.0]], [[(4.0 * np.pi) ** 2]])
    return simulate(block, 20.0, ([1.0], [0.0]), times=count)


def test_a_spectrum_of_too_few_instants_says_so():
    # 61 instants in 20 s: 3 a second, which fold 2 Hz to 1 Hz; 161 are four in a period
    folded, seen = (signals.spectrum(swinging(count)) for count in (61, 161))
    assert signals.peaks(folded).frequency[0] == pytest.approx(1.0, abs=0.05)
    assert "too few" in folded.caution
    assert signals.spectrogram(swinging(61)).caution == folded.caution
    assert folded.caution in str(folded).replace("\n    ", " ")
    assert signals.peaks(seen).frequency[0] == pytest.approx(2.0, abs=0.01)
    assert not seen.caution


def test_a_figure_is_of_the_motion_and_long_lines_are_thinned():
    figure = plot(swinging(61))
    history = max(figure.axes[0].lines, key=lambda line: len(line.get_xdata()))
    assert np.max(np.abs(np.diff(history.get_ydata()))) < 0.5  # no jump of an instant in three quarters of a period
    x = np.cos(0.01 * np.arange(200_000))
    x[123_456] = 3.0
    seen = motion._extremes(x)
    assert len(seen) <= motion.LARGEST
    assert (np.max(x[seen]), np.min(x[seen])) == (3.0, np.min(x))

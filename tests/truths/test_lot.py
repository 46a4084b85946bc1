"""How much friction a lot stands, against one brake at a time."""

import numpy as np
import pytest
from scipy.optimize import brentq

from squealbox import Coulomb, DrumBrake, LinearSlope, ModeCoupling, ParameterError, complex_modes
from squealbox.fe import DiscBrake
from squealbox.remedies.production import usual_scatter
from squealbox.remedies.target import lot_of
from squealbox.studies import Scatter


def growth(brake, friction):
    return float(complex_modes(brake.replace({"friction.static": friction})).most_unstable.growth_rate)


def test_share_and_friction_against_a_loop_over_complex_modes():
    drum, target = DrumBrake(), 0.33
    lot = lot_of(drum, 1.0, brakes=128, seed=3)
    assert len(lot.lost) == 128
    scatter = Scatter({k: v for k, v in usual_scatter(drum).distributions.items() if k != "friction.static"})
    drawn = scatter.sample(128, seed=3)
    one_by_one = [drum.replace({name: float(values[i]) for name, values in drawn.items()}) for i in range(128)]
    looked = np.linspace(0.005, target, 40)
    rates = (complex_modes(brake.replace({"friction.static": looked})).largest_growth_rate for brake in one_by_one)
    stable = [np.all(each <= 0.0) for each in rates]
    assert lot.stable(target) == pytest.approx(np.mean(stable))
    for i in (0, 17, 100):
        lost = brentq(lambda mu, brake=one_by_one[i]: growth(brake, mu), 0.25, 0.42, xtol=1e-9)
        assert lot.lost[i] == pytest.approx(lost, abs=2e-6)
    nominal = brentq(lambda mu: growth(drum, mu), 0.3, 0.36)
    assert lot.nominal == pytest.approx(nominal, abs=2e-6)
    least = lot.friction(0.95)
    assert lot.stable(least * (1.0 - 1e-9)) >= 0.95 > lot.stable(least * (1.0 + 1e-9)) - 1.0 / 128
    low, high = lot.interval(target)
    assert low < lot.stable(target) < high


def test_whose_scatter_matters():
    lot = lot_of(DrumBrake(), 1.0, brakes=128)
    assert set(lot.names[:2]) == {"k3", "k4"}, "the contact springs make the flutter"
    assert 0.6 < sum(lot.share[:2]) < 1.1


def test_an_undamped_brake_is_not_lost_to_round_off():
    brake = ModeCoupling(friction=Coulomb(0.3))
    lot = lot_of(brake, 1.5, brakes=128)
    critical = brentq(lambda mu: growth(brake, mu) - 1e-6, 0.6, 1.4)
    assert lot.nominal == pytest.approx(critical, abs=1e-4)


def test_what_has_no_lot_says_so():
    with pytest.raises(ParameterError, match="friction"):
        lot_of(DrumBrake(friction=LinearSlope(0.0, 0.0)))
    assert usual_scatter(DiscBrake()).names

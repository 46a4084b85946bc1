"""Verdicts on motions written down in closed form, each beside a near twin that must be judged otherwise."""

import numpy as np
import pytest

from squealbox import Coulomb, MassOnBelt, simulate
from squealbox.result import Outcome
from squealbox.signals import SignalError
from squealbox.transient.verdicts import Verdict, verdict

T = np.linspace(0.0, 0.05, 5001)
OMEGA = 2.0 * np.pi * 2000.0
A = 1e-4
WAVE = np.sin(OMEGA * T)


def approach(start, rate, t=T):
    """Envelope of a van der Pol oscillator's slow equation: from `start` to the cycle A at 2 `rate`."""
    return A / np.sqrt(1.0 + ((A / start) ** 2 - 1.0) * np.exp(-2.0 * rate * t))


def beat(difference, growth=0.0):
    return A * np.exp(growth * T) * (WAVE + 0.8 * np.sin((OMEGA + difference) * T))


def noise(share, seed=0):
    return A * share * np.random.default_rng(seed).normal(size=T.size)


MOTIONS = [
    ("decay", A * np.exp(-107.0 * T) * WAVE + 3e-4, "decays"),
    ("slow decay", A * np.exp(-1.0 * T) * WAVE, "decays"),
    ("slow growth", A * np.exp(2.0 * T) * WAVE, "grows"),
    ("no change", A * WAVE, "settles_on_cycle"),
    ("growth", 1e-9 * np.exp(150.0 * T) * WAVE + 1e-3, "grows"),
    ("growth by 10^40", np.exp(1900.0 * T) * WAVE, "grows"),
    ("decay, then growth of another mode", A * np.exp(-400.0 * T) * np.sin(1.1 * OMEGA * T)
        + 1e-8 * np.exp(150.0 * T) * WAVE, "grows"),
    ("two decays at different rates", A * (np.exp(-300.0 * T) * WAVE + 0.3 * np.exp(-60.0 * T)
        * np.sin(1.2 * OMEGA * T)), "decays"),
    ("beat that decays", beat(560.0, -60.0), "decays"),
    ("beat that grows", beat(560.0, 60.0), "grows"),
    ("beat that stays", beat(560.0), "not_decided"),
    ("slow beat whose end rises", beat(100.0, -107.0), "not_decided"),
    ("cycle from below", approach(1e-6, 400.0) * WAVE + 3e-4, "settles_on_cycle"),
    ("cycle from above", approach(1e-3, 400.0) * WAVE, "settles_on_cycle"),
    ("not yet on the cycle", approach(2e-4, 20.0) * WAVE, "not_decided"),
    ("small cycle after a large transient", A * (np.exp(-300.0 * T) * np.sin(1.2 * OMEGA * T) + 0.02 * WAVE),
        "settles_on_cycle"),
    ("nothing left", A * (np.exp(-300.0 * T) * np.sin(1.2 * OMEGA * T) + 0.0002 * WAVE), "decays"),
    ("cycle with harmonics", A * (WAVE + 0.4 * np.sin(2 * OMEGA * T) + 0.2 * np.sin(3 * OMEGA * T)),
        "settles_on_cycle"),
    ("cycle with a subharmonic", A * (WAVE + 0.7 * np.sin(OMEGA * T / 3.0 + 1.0)), "settles_on_cycle"),
    ("two frequencies without common period", A * (WAVE + 0.8 * np.sin(1.618 * OMEGA * T)), "not_decided"),
    ("dry friction: a straight decay to rest", A * np.maximum(1.0 - T / 0.03, 0.0) * WAVE, "decays"),
    ("drifting mean", A * np.exp(-200.0 * T) * WAVE + A * T / T[-1], "decays"),
    ("divergence", 1e-6 * np.exp(100.0 * T) + A, "grows"),
    ("creep", A - A * np.exp(-100.0 * T), "decays"),
    ("rest", np.full(T.size, A), "decays"),
    ("noise", noise(1.0), "not_decided"),
    ("cycle in noise", A * WAVE + noise(0.02), "settles_on_cycle"),
    ("decay in noise", A * np.exp(-80.0 * T) * WAVE + noise(0.01), "decays"),
    ("too few periods", A * np.sin(2.0 * np.pi * 60.0 * T), "not_decided"),
]  # fmt: skip


@pytest.mark.parametrize(("name", "x", "kind"), MOTIONS, ids=[name for name, _, _ in MOTIONS])
def test_kind(name, x, kind):
    assert verdict(x, T).kind == kind


def test_numbers_of_a_decay():
    found = verdict(3e-4 + A * np.exp(-50.0 * T) * WAVE, T)
    assert found.growth_rate == pytest.approx(-50.0, rel=1e-3)  # extrema do not fall on the window's middle
    assert found.frequency == pytest.approx(2000.0, rel=1e-5)
    assert found.offset == pytest.approx(3e-4, rel=1e-3)  # what a decay leaves of its mean over 12.5 ms
    # Half peak to peak over the last quarter is that of its first period.
    assert found.amplitude == pytest.approx(A * np.exp(-50.0 * 0.0375), rel=0.03)
    assert np.isnan(found.settled_at)
    quick = verdict(A * np.exp(-200.0 * T) * WAVE, T)
    # exp(-200 t) = 0.05 at 15 ms; a window is 1 ms.
    assert quick.settled_at == pytest.approx(np.log(20.0) / 200.0, abs=1.5e-3)


def test_numbers_of_a_cycle():
    found = verdict(3e-4 + approach(1e-6, 400.0) * WAVE, T)
    assert found.amplitude == pytest.approx(A, rel=1e-4)  # the cubic spline at 50 samples a period
    assert found.frequency == pytest.approx(2000.0, rel=1e-5)
    assert found.offset == pytest.approx(3e-4, rel=1e-4)
    # The envelope comes within 5 % of A when (A/start)^2 exp(-800 t) = 1/0.95^2 - 1.
    assert found.settled_at == pytest.approx(np.log(1e4 / (0.95**-2 - 1.0)) / 800.0, abs=1.5e-3)
    assert verdict(A * WAVE, T).settled_at == 0.0
    assert "100 µm" in found.text
    assert str(found) == found.text


def test_coarse_and_unequal_samples_keep_the_amplitude():
    coarse = np.linspace(0.0, 0.05, 601)  # 6 samples a period: the highest sample is up to 13 % low
    found = verdict(A * np.sin(OMEGA * coarse + 0.1), coarse)
    assert (found.kind, found.amplitude) == ("settles_on_cycle", pytest.approx(A, rel=0.01))
    uneven = np.sort(np.random.default_rng(2).uniform(0.0, 0.05, 4000))
    run = type("Run", (), {})()
    run.t, run.outcome = uneven, Outcome()
    run.q, run.qd = A * np.sin(OMEGA * uneven)[:, None], A * OMEGA * np.cos(OMEGA * uneven)[:, None]
    found = verdict(run)
    assert (found.kind, found.amplitude) == ("settles_on_cycle", pytest.approx(A, rel=0.01))
    assert found.frequency == pytest.approx(2000.0, rel=1e-4)


@pytest.mark.parametrize(("seconds", "periods"), [(2.0, 0.62), (3.0, 0.93), (3.25, 1.0), (5.0, 1.5), (12.0, 3.7)])
def test_two_periods_are_enough_for_amplitude_and_frequency(seconds, periods):
    """Stick-slip on a belt of 0.1 m/s: it slips for 2 (pi - atan(s omega / V)) / omega, s = 20 mm."""
    belt = MassOnBelt(m=1.0, c=0.0, k=100.0, load=10.0, sliding_speed=0.1, friction=Coulomb(0.5, 0.3))
    step, omega, speed = 0.02, 10.0, 0.1
    slip = 2.0 * (np.pi - np.arctan(step * omega / speed)) / omega
    period, amplitude = slip + 2.0 * step / speed, np.hypot(step, speed / omega)
    found = verdict(simulate(belt, seconds, times=2001))
    assert found.kind == "not_decided"
    assert float(found.frequency) == pytest.approx(1.0 / period, rel=1e-6)
    assert float(found.amplitude) == pytest.approx(amplitude, rel=1e-6)
    last = f"{seconds / 4:.3g} s" if seconds >= 4.0 else f"{250.0 * seconds:.3g} ms"
    assert f"the last {last} hold only {periods:g} period{'s' if periods != 1.0 else ''};" in found.text.replace(
        ")", ""
    )


@pytest.mark.parametrize("cycles", [1.3, 1.7, 1.99])
def test_less_than_two_periods_tell_no_frequency(cycles):
    t = np.linspace(0.0, cycles / 100.0, 3001)
    x = 1e-3 * np.sin(2.0 * np.pi * 100.0 * t + 0.3)
    found, last = verdict(x, t), x[t >= 0.7499 * t[-1]]
    assert found.kind == "not_decided"
    assert np.isnan(found.frequency)
    assert float(found.amplitude) == pytest.approx(0.5 * np.ptp(last), rel=2e-3)


@pytest.mark.parametrize("cycles", [2.01, 2.6, 4.4, 5.5])
def test_a_sine_of_few_periods_keeps_its_frequency(cycles):
    t = np.linspace(0.0, cycles / 100.0, 3001)
    found = verdict(1e-3 * np.sin(2.0 * np.pi * 100.0 * t + 0.3), t)
    assert float(found.frequency) == pytest.approx(100.0, rel=1e-6)
    assert float(found.amplitude) == pytest.approx(1e-3, rel=1e-4)


def test_an_interval_that_holds_zero_is_no_growth():
    """A cycle reached from below at half the record, whose amplitude still falls by 6 % towards its end."""
    late = np.clip(T - 0.03, 0.0, None)
    x = np.minimum(np.exp(300.0 * (T - 0.03)), 1.0) * (0.85 + 0.15 * np.exp(-60.0 * late)) * A * WAVE
    found = verdict(x, T)
    assert found.kind == "not_decided"
    assert "still settling" in found.text
    assert "growth rate" not in found.text
    for share in (2.0, 30.0, 100.0):
        grown = verdict(1e-9 * np.exp(share * T) * WAVE, T)
        assert grown.kind == "grows"
        assert float(grown.growth_rate) > float(grown.growth_rate_error)


def test_a_block_that_rides_on_its_belt_does_not_grow():
    """It is caught after 0.2 s at 1 m/s2, and rides at 0.2 m/s until the spring pulls it loose."""
    held = verdict(simulate(MassOnBelt(), 0.9, times=2001))
    assert held.kind == "not_decided"
    assert "belt sticks through the last part" in held.text
    assert np.isnan(held.growth_rate)
    assert float(held.amplitude) == pytest.approx(0.5 * 0.25 * 0.9 * 0.2, rel=1e-3)
    caught = verdict(simulate(MassOnBelt(), 0.05, times=2001))
    assert caught.kind == "not_decided"
    assert np.isnan(caught.growth_rate)


def test_a_stretch_is_judged_alone():
    x = np.where(T < 0.025, A * WAVE, A * np.exp(-300.0 * (T - 0.025)) * WAVE)
    assert verdict(x, T).kind == "decays"
    assert verdict(x, T, end=0.025).kind == "settles_on_cycle"


def test_thresholds_are_parameters():
    x = A * (np.exp(-300.0 * T) * np.sin(1.2 * OMEGA * T) + 0.0008 * WAVE)
    assert verdict(x, T).kind == "decays"
    assert verdict(x, T, gone=1e-4).kind == "settles_on_cycle"
    assert verdict(approach(2e-4, 20.0) * WAVE, T, steady=0.1).kind == "settles_on_cycle"
    assert verdict(A * np.sin(2.0 * np.pi * 60.0 * T), T, least_periods=0.5).kind != "decays"


@pytest.mark.parametrize("count", [0, 1, 3, 5001])
def test_a_failed_run_is_not_decided_and_says_why(count):
    run = type("Run", (), {})()
    run.t, run.q, run.qd = T[:count], (A * WAVE)[:count, None], (A * OMEGA * np.cos(OMEGA * T))[:count, None]
    run.outcome = Outcome("step_underflow", "no step was small enough", time=0.01)
    found = verdict(run)
    assert found.kind == "not_decided"
    assert found.outcome == "step_underflow"
    assert found.outcome.evidence == {"time": 0.01}
    assert "no step was small enough" in found.text
    assert np.isnan(found.amplitude) if count < 8 else found.amplitude == pytest.approx(A, rel=1e-3)


def test_too_few_samples_are_refused():
    with pytest.raises(SignalError, match="the motion has 3 samples"):
        verdict(WAVE[:3], T[:3])


def test_a_verdict_is_saved_and_read_back(tmp_path):
    found = verdict(A * WAVE, T)
    back = Verdict.load(found.save(tmp_path / "verdict.nc"))
    assert (back.kind, back.text, float(back.amplitude)) == (found.kind, found.text, found.amplitude)
    assert back.envelope.tolist() == found.envelope.tolist()

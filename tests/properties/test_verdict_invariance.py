"""A verdict depends on the motion, not on its unit, sign, offset or clock; and it always comes."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from squealbox.transient.verdicts import verdict

T = np.linspace(0.0, 0.05, 2001)


def motion(rate, beat, share, cycle):
    """Two exponentials and a cycle."""
    fast = np.exp(rate * T) * (np.sin(12566.0 * T + 0.2) + share * np.sin((12566.0 + beat) * T))
    return fast + cycle * np.sin(13000.0 * T)


RATES = st.sampled_from([-300.0, -100.0, -20.0, 0.0, 15.0, 120.0])
SHARES = st.sampled_from([0.0, 0.3, 0.9])
CYCLES = st.sampled_from([0.0, 0.02, 1.0])


@settings(max_examples=25)
@given(
    RATES, st.floats(80.0, 6000.0), SHARES, CYCLES, st.integers(-9, 6), st.sampled_from([-1.0, 1.0]),
    st.floats(-5.0, 5.0), st.floats(0.0, 10.0),
)  # fmt: skip
def test_unit_sign_offset_and_clock_change_nothing(rate, beat, share, cycle, power, sign, offset, start):
    x = motion(rate, beat, share, cycle)
    here = verdict(x, T)
    there = verdict(sign * 10.0**power * (x + offset), T + start)
    assert here.kind == there.kind
    # Numbers with the same arithmetic up to rounding; the clock's rounding is 1e-15 of 10 s over a step of 25 us.
    assert np.isclose(10.0**power * here.amplitude, there.amplitude, rtol=1e-6)
    assert np.isclose(here.frequency, there.frequency, rtol=1e-6)
    # The twin: another motion is not told as the same one.
    assert not np.isclose(verdict(2.0 * x, T).amplitude, here.amplitude, rtol=1e-6)


@settings(max_examples=25)
@given(st.integers(0, 2**31), st.integers(8, 400), st.floats(-12.0, 12.0))
def test_any_finite_motion_gets_a_verdict(seed, count, power):
    rng = np.random.default_rng(seed)
    t = np.cumsum(rng.uniform(1e-6, 1e-4, count))
    x = 10.0**power * rng.choice([rng.normal(size=count), np.cumsum(rng.normal(size=count)), rng.integers(0, 2, count)])
    found = verdict(x, t)
    assert found.kind in {"decays", "grows", "settles_on_cycle", "not_decided"}
    assert found.text.endswith(".")
    assert np.all(np.isfinite(found.envelope))

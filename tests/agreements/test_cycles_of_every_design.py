"""On every design shooting, harmonic balance and a long run find one cycle of the smoothed law.

Each case is a sheet on which sliding is unstable and a cycle attracts, with a smoothing wide enough that few harmonics
suffice. tanh stands where arctan would not do: its tail, (2/pi) mu N width/V^2 at speed V, damps Coulomb friction and
flat slopes into stability.
"""

import numpy as np
import pytest

from squealbox import Coulomb, Hyperbolic, LinearSlope, complex_modes, harmonic_balance, shooting, simulate
from squealbox.designs import DESIGNS

FLAT = Coulomb(1.2)
CASES = {
    "drum_brake": ({"friction": LinearSlope(0.45, -0.05)}, "smooth", 0.2),
    # 50 kN a shoe keep the linings closed; the damping leaves one unstable mode, two make no periodic motion
    "drum_brake_shoes": (
        {"friction": LinearSlope(0.35, -0.003, 0.1), "load": 5e4, "sliding_speed": 0.3, "points": 1, "damping": 2e-5},
        "tanh", 0.05,
    ),
    "mass_on_belt": ({}, "smooth", 0.1),
    # soft between the blocks: they move half a period apart, not as one
    "block_chain": ({"kc": 0.3}, "tanh", 0.1),
    "mode_coupling": ({"friction": FLAT, "c1": 0.05, "c2": 0.05}, "tanh", 0.6),
    # neither at right angles nor as stiff as those that make the matrices of mode_coupling
    "inclined_springs": (
        {"friction": FLAT, "c1": 0.05, "c2": 0.05, "k1": 2.5, "k2": 0.6, "angle1": 0.6, "angle2": 2.3}, "tanh", 0.8
    ),
    "damping_paradox": ({"friction": Coulomb(0.4)}, "tanh", 0.4),
    "pad_on_disc": ({}, "tanh", 0.15),
    "sprag_slip": ({"friction": Hyperbolic(0.4, 2.0), "sliding_speed": 0.3, "c": 5.0}, "tanh", 0.2),
    # the sheet is linear in the tilts and its pins may pull: the cycle is that of the equations, not of a real disc
    "wobbling_disc": (
        {"friction": Coulomb(1.0), "spin": 50.0, "h": 0.1, "load": 500.0, "dt": 0.0, "d": 0.0}, "tanh", 3.0
    ),
}  # fmt: skip
SETTLE = {"wobbling_disc": 2.0}  # growth of 9 /s: the usual run is too short
APART = {"block_chain": [0.2, 0.0]}  # a start with the blocks apart [m]


def brake(name):
    changes, contact, width = CASES[name]
    return DESIGNS[name]().replace(changes).system(), contact, width


@pytest.fixture(params=list(CASES), scope="module")
def found(request):
    """The cycle by shooting, the same by harmonic balance, contact and width."""
    system, contact, width = brake(request.param)
    start = (APART[request.param], [0.0, 0.0]) if request.param in APART else None
    shot = shooting(system, start, contact=contact, width=width, settle=SETTLE.get(request.param))
    balanced = harmonic_balance(system, shot, contact=contact, width=width, tolerance=1e-6)
    return shot, balanced, contact, width


def distance(one, other):
    """Largest relative difference of period and of the amplitudes, these over the largest of them."""
    size = np.max(other.amplitude)
    return max(
        abs(float(one.period / other.period) - 1.0), float(np.max(np.abs(one.amplitude - other.amplitude))) / size
    )


def test_every_design_has_a_case():
    assert set(CASES) == set(DESIGNS)


def test_shooting_is_harmonic_balance(found):
    shot, balanced, _, _ = found
    assert shot.stable
    assert balanced.outcome.ok, balanced.outcome.message
    assert balanced.error < 1e-6
    assert distance(balanced, shot) < 1e-6  # what the estimate says; its extremes add less, of order samples^-4


def test_another_width_is_another_cycle(found):
    """With the harmonics before the last doubling, of which the estimate speaks."""
    shot, balanced, contact, width = found
    harmonics = balanced.settings["harmonics"] // 2
    other = harmonic_balance(shot.system, shot, contact=contact, width=0.98 * width, harmonics=harmonics)
    assert other.outcome.ok
    assert distance(other, shot) > 1e-5


def test_the_blocks_of_the_chain_move_half_a_period_apart():
    system, contact, width = brake("block_chain")
    cycle = shooting(system, (APART["block_chain"], [0.0, 0.0]), contact=contact, width=width, samples=2049)
    first, second = cycle.q[:-1].T
    size = np.max(cycle.amplitude)
    assert np.max(np.abs(first - np.roll(second, 1024))) < 1e-8 * size
    assert np.max(np.abs(first - second)) > size


def test_shooting_is_a_long_run(found):
    """From a start 1 per cent off, as long as the slowest multiplier needs to take that below 1e-8."""
    shot, _, contact, width = found
    rate = float(np.max(np.abs(shot.multipliers[1:])))
    periods = int(np.ceil(np.log(1e-8) / np.log(rate))) + 20
    q, qd = shot.start
    period = float(shot.period)
    before = simulate(shot.system, periods * period, (q, 1.01 * qd), 2, contact=contact, width=width, rtol=1e-11)
    assert before.outcome.ok
    end = (before.q[-1], before.qd[-1])
    last = simulate(shot.system, period, end, 2049, contact=contact, width=width, rtol=1e-11)
    swing = 0.5 * np.ptp(last.q, axis=0)
    size = np.max(shot.amplitude)
    # the run repeats after a period of shooting: closed to 1e-7, and not after half of it
    assert np.max(np.abs(last.q[-1] - last.q[0])) < 1e-7 * size
    assert np.max(np.abs(last.q[1024] - last.q[0])) > 1e-2 * size
    # half an interval h beside an extreme (h omega/2)^2/2 = 1.2e-6 is missed, more with harmonics
    assert np.max(np.abs(swing - shot.amplitude)) < 1e-5 * size


@pytest.mark.parametrize("name", ["mode_coupling", "damping_paradox", "pad_on_disc", "wobbling_disc"])
def test_sliding_that_is_stable_has_no_cycle_to_find(name):
    """The same brakes with a friction coefficient of 0.01 slide steadily, and both searches say so by name."""
    system = DESIGNS[name]().replace({**CASES[name][0], "friction": Coulomb(0.01), **DAMPED[name]}).system()
    assert complex_modes(system).stable
    for find in (shooting, harmonic_balance):
        assert find(system, contact="tanh", width=CASES[name][2]).outcome == "steady_sliding"


# enough damping to come to rest within the usual run of 300 periods
DAMPED = {
    "mode_coupling": {"c1": 0.2, "c2": 0.2},
    "damping_paradox": {},
    "pad_on_disc": {"c1": 40.0, "c2": 40.0},
    "wobbling_disc": {"dt": 100.0, "d": 5.0},
}

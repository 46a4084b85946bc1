"""A start means the same however it is spelled, and to every analysis that takes one."""

import numpy as np
import pytest

from squealbox import (
    DrumBrake,
    LinearSlope,
    LuGre,
    ParameterError,
    complex_modes,
    read_design,
    shooting,
    simulate,
    simulate_ensemble,
)
from squealbox.cli.inputs import put_over
from squealbox.cli.running import UsageError
from squealbox.files.reading import read_text
from squealbox.limit_cycles import basin, bifurcation_diagram
from squealbox.start import SHARE, Start
from squealbox.system import InvalidSystem, as_system, equilibrium
from squealbox.transient import MotionSettings

BRAKE = DrumBrake(friction=LinearSlope(static=0.45, slope=-0.05))
SYSTEM = as_system(BRAKE)
MODES = complex_modes(BRAKE)
FILE = 'brake = "drum_brake"\nfriction = { law = "linear_slope", static = 0.45, slope = -0.05 }\n[simulate]\n'


def state(start, **how):
    return Start.of("simulate", start, SYSTEM, **how).state


@pytest.mark.parametrize(
    ("one", "other"),
    [
        (None, "rest"),
        ("rest", (np.zeros(2), np.zeros(2))),
        ("sliding", (equilibrium(SYSTEM).q, np.zeros(2))),
        ("mode", MODES.most_unstable),
        ("mode 1", MODES.mode(0)),
        ({"mode": 1, "amplitude": 1e-6}, MODES.mode(0).start(1e-6)),
        ({"mode": None, "amplitude": 2e-6}, MODES.most_unstable.start(2e-6)),
    ],
)
def test_two_spellings_of_one_start(one, other):
    assert np.array_equal(state(one), state(other))


def test_a_mode_without_an_amplitude_swings_the_sliding_speed_by_its_share():
    """The velocity of the mode along the contact it moves most swings by the share of V."""
    mode = MODES.mode(0)
    q, qd = np.split(state("mode 1"), 2)
    amplitude = float(np.linalg.norm(q - mode.steady) / np.linalg.norm(mode.shape.real))
    swings = [abs(contact.t @ (mode.eigenvalue * amplitude * mode.shape)) / contact.V for contact in SYSTEM.contacts]
    assert max(swings) == pytest.approx(SHARE, rel=1e-12)
    assert qd == pytest.approx((mode.eigenvalue * amplitude * mode.shape).real, rel=1e-9)


def test_a_small_vibration_in_a_mode_goes_as_linear_theory_has_it():
    brake = BRAKE.replace({"friction.static": 0.2})  # stable: exp(lambda t) of one mode, and of no other
    mode, t = complex_modes(brake).mode(1), 2e-4
    found = simulate(brake, t, {"mode": 2, "amplitude": 1e-10}, 2)
    turned = 1e-10 * np.exp(mode.eigenvalue * t) * mode.shape
    assert found.q[-1] - mode.steady == pytest.approx(turned.real, abs=1e-14)


def test_motions_and_cycles_hand_on():
    first = simulate(BRAKE, 2e-3, "mode")
    whole = simulate(BRAKE, 4e-3, "mode", [0.0, 4e-3])
    after = simulate(BRAKE, 2e-3, first, [0.0, 2e-3])
    assert np.array_equal(after.q[0], first.q[-1])
    assert np.array_equal(first.end[1], first.qd[-1])
    assert after.q[-1] == pytest.approx(whole.q[-1], rel=1e-5)
    cycle = shooting(BRAKE, "mode")
    round_ = simulate(BRAKE, float(cycle.period), cycle, 2)
    assert round_.q[-1] == pytest.approx(cycle.q[0], rel=1e-6)


@pytest.mark.parametrize("start", ["rest", "sliding", "mode", {"mode": 2, "amplitude": 1e-7}])
def test_an_ensemble_begins_as_its_members(start):
    values = [0.3, 0.4]
    many = simulate_ensemble(BRAKE, {"friction.static": values}, 1e-4, start=start, times=[0.0, 1e-4])
    for i, value in enumerate(values):
        one = simulate(BRAKE.replace({"friction.static": value}), 1e-4, start, [0.0, 1e-4])
        assert many.sample_q[i] == pytest.approx(one.q, rel=1e-6, abs=1e-15)


def test_bristles_begin_straight_bent_or_as_said():
    brake = BRAKE.replace({"friction": LuGre(static=0.3, kinetic=0.25, speed=0.1, stiffness=1e4, damping=10.0)})
    system = as_system(brake)
    count = len(system.contacts)
    assert Start.of("simulate", "sliding", system).sliding
    assert Start.of("simulate", "rest", system).z is None
    z = np.full(count, 1e-6)
    assert np.array_equal(Start.of("simulate", ([0, 0], [0, 0], z), system).z, z)
    with pytest.raises(ParameterError, match=f"{count} deflections"):
        Start.of("simulate", ([0, 0], [0, 0], np.zeros(count + 1)), system)


def test_attractors_take_the_same_starts():
    q, qd = MODES.mode(0).start(1e-6)
    ways = [basin(BRAKE, 0.0, 1, through=start, refine=False) for start in ((q, qd), {"mode": 1, "amplitude": 1e-6})]
    assert np.array_equal(ways[0].start, ways[1].start)
    given = [
        bifurcation_diagram(BRAKE, "friction.static", [0.4], sweeps=("up",), start=start).highest
        for start in ("sliding", (equilibrium(as_system(BRAKE.replace({"friction.static": 0.4}))).q, [0.0, 0.0]))
    ]
    assert np.array_equal(*given)


@pytest.mark.parametrize(
    ("said", "start"),
    [
        ('start = "mode 2"', "mode 2"),
        ('start = "mode"\namplitude = "1 um"', {"mode": None, "amplitude": 1e-6}),
        ('start = { mode = 1, amplitude = "1 um" }', {"mode": 1, "amplitude": 1e-6}),
        ('start = "sliding"', "sliding"),
    ],
)
def test_files_say_the_same(said, start):
    found = read_text(FILE + said)
    q, qd = found.simulate.start_of(found.design)
    assert np.array_equal(np.concatenate([q, qd]), state(start))


def test_what_is_no_start_is_one_sentence():
    for start, says in [
        ("resting", "with 2 values each, \"rest\" or \"sliding\""),
        ("mode 7", "a mode from 1 to 2"),
        ({"mode": 1, "amplitude": 0.0}, "an amplitude above 0 m"),
        (([0.0], [0.0]), "with 2 values each"),
        (([np.nan, 0.0], [0.0, 0.0]), "finite"),
    ]:  # fmt: skip
        with pytest.raises(ParameterError) as caught:
            state(start)
        assert says in str(caught.value)
        assert "\n" not in str(caught.value)
    with pytest.raises(ParameterError, match=r"expected \(q, qd\)"):  # three arrays hold no period
        shooting(BRAKE, ([1e-6, 0.0], [0.0, 0.0], [0.0, 0.0]))
    for start in ([1e-6, 0.0], ([1.0], [0.0])):  # no number stands for two freedoms, in an ensemble either
        with pytest.raises(ParameterError, match=r"of shape \(\.\.\., 2\)"):
            simulate_ensemble(BRAKE, {"friction.static": [0.2, 0.3]}, 1e-4, start=start)
    with pytest.raises(UsageError, match='--amplitude 1um: expected a start in a mode beside it, such as "mode 1"'):
        put_over(MotionSettings(), {"start": "rest", "amplitude": "1um"})
    with pytest.raises(InvalidSystem, match="there is no steady sliding to start from"):
        simulate(BRAKE.replace({"sliding_speed": 0.0}), 1e-3, "mode")


def test_a_section_without_a_start_is_at_rest(tmp_path):
    path = tmp_path / "brake.toml"
    path.write_text(FILE)
    assert np.array_equal(MotionSettings().start_of(read_design(path))[0], np.zeros(2))

"""Bad input to countermeasures, loops and remedies: one sentence that says what, where, given and expected."""

import pytest

from squealbox import (
    PID,
    ActiveForce,
    AddedMass,
    Controlled,
    Coulomb,
    Dithered,
    DrumBrake,
    LinearSlope,
    MassOnBelt,
    ModeCoupling,
    ParameterError,
    Shim,
    StateFeedback,
    System,
    TunedMass,
    best_absorber,
    closed_loop,
    complex_modes,
    harmonic_balance,
    silence,
    simulate,
)
from squealbox.files.document import DesignFileError
from squealbox.files.reading import read_text
from squealbox.system import InvalidSystem

DRUM = DrumBrake()
LATE = Controlled(DRUM, [PID(on="y", derivative=100.0, delay=1e-5)])
BAD = {
    "a degree of freedom it has not": (
        lambda: TunedMass(DRUM, "z", 0.1, 100.0).system(),
        "TunedMass.on = 'z'.*one of x, y",
    ),
    "a row of zeros": (lambda: AddedMass(DRUM, (0.0, 0.0), 0.1).system(), "AddedMass.on"),
    "no mass": (
        lambda: TunedMass(DRUM, "y", 0.0, 100.0),
        "TunedMass.mass = 0: expected a finite number in .0, inf. kg",
    ),
    "no frequency": (lambda: TunedMass(DRUM, "y", 0.1, -1.0), "TunedMass.frequency = -1"),
    "no brake": (lambda: TunedMass(3.0, "y", 0.1, 100.0), "TunedMass.brake = 3: expected a design"),
    "a delay below zero": (lambda: PID(on="y", delay=-1.0), "PID.delay = -1: expected a finite number in .0, inf. s"),
    "a limit of zero": (lambda: PID(on="y", limit=0.0), "PID.limit = 0: expected a finite number in .0, inf. N"),
    "a sensor nowhere": (lambda: Controlled(DRUM, [PID(on="y", sense="w")]), "PID.sense = 'w': expected one of x, y"),
    "a loop on nothing": (lambda: Controlled(DRUM, [PID()]), "PID.on = '': expected the degree of freedom"),
    "no loop": (lambda: Controlled(DRUM, []), "Controlled.loops = .*one loop or more"),
    "no loop at all": (lambda: Controlled(DRUM, [3]), "expected a loop, such as PID"),
    "an algebraic loop": (lambda: ActiveForce(0.1, 0.0, on="y"), "ActiveForce.time_constant = 0.*algebraic loop"),
    "too many gains": (lambda: Controlled(DRUM, [StateFeedback(on="y", velocity=(1.0,) * 3)]), "at most 2 gains"),
    "a loop that is not there": (lambda: LATE.replace({"loops.3.delay": 0.0}), "loops.3: expected one of 0"),
    "poles without loops": (lambda: closed_loop(DRUM), "a brake with loops"),
    "modes of loops of two rates": (
        lambda: complex_modes(Controlled(DRUM, [PID(on="y", sampling=1e4), PID(on="x", sampling=2e4)])),
        "one rate for all sampled loops",
    ),
    "modes of a sampled loop beside a late one": (
        lambda: complex_modes(Controlled(LATE, [PID(on="x", derivative=1.0, sampling=1e5)])),
        "no other loop that is late",
    ),
    "a contact it has not": (lambda: Shim(DRUM, "shoe 9", 1e9).system(), "Shim.at = 'shoe 9'"),
    "a contact without a spring": (lambda: Shim(MassOnBelt(), "belt", 1e9).system(), "a contact with a stiffness"),
    "dither of no contact": (lambda: Dithered(DRUM, 0.1, along="drum").system(), "Dithered.along = 'drum'"),
    "an unknown aim": (lambda: best_absorber(DRUM, "y", 0.1, "peace"), "one of decay, margin, probability"),
    "a probability of nothing": (lambda: best_absorber(DRUM, "y", 0.1, "probability"), "the scatter"),
    "silence without scatter": (lambda: silence(DRUM, 3.0), "silence.scatter = 3: expected {name:"),
}


@pytest.mark.parametrize("what", list(BAD))
def test_bad_input_is_one_sentence(what):
    call, sentence = BAD[what]
    with pytest.raises(ParameterError, match=sentence) as caught:
        call()
    assert "\n" not in str(caught.value)


def test_cautions_of_a_cure_stand_beside_its_modes():
    dithered = Dithered(DrumBrake(friction=LinearSlope(0.4, -0.05)), 0.1, 40e3)
    for brake in (dithered, Controlled(dithered, [PID(on="y", derivative=1.0)])):
        assert "stays below the sliding speed" in complex_modes(brake).caution
    assert "sliding speed" not in complex_modes(dithered.replace(velocity=0.4)).caution


def test_sampling_below_twice_a_mode_is_told():
    slow = Controlled(DRUM, [PID(on="y", derivative=1.0, sampling=2000.0)])
    for found in (simulate(slow, 1e-3), complex_modes(slow)):
        assert "samples at 2000 Hz, less than twice the mode at" in found.caution
    assert "samples" not in simulate(slow.replace({"loops.0.sampling": 1e5}), 1e-4).caution


def test_a_late_loop_is_not_left_out_of_an_estimate():
    with pytest.raises(InvalidSystem, match="has a delay"):
        harmonic_balance(LATE)


def test_a_system_says_what_is_no_loop():
    with pytest.raises(InvalidSystem, match=r"loops\[0\] = 1.0: expected a loop"):
        System([[1.0]], [[0.0]], [[1.0]], loops=(1.0,))


@pytest.mark.parametrize(("text", "line", "sentence"), [
    ('[[loops]]\nkind = "pid"\non = "z"', 2, "PID.on = 'z'"),
    ('[[loops]]\nkind = "pidd"', 3, "did you mean 'pid'"),
    ('[[loops]]\nkind = "pid"\non = "y"\ndelay = -1', 5, "expected a finite number in"),
    ("loops = 3", 2, "each under a line"),
    ('[[countermeasures]]\nkind = "tuned_mass"\non = "y"\nmass = 1', 2, "the key 'frequency' is missing"),
    ('[[countermeasures]]\nkind = "tuned_mass"\non = "y"\nmas = 1\nmass = 1\nfrequency = 2', 5, "did you mean 'mass'"),
    ('[[countermeasures]]\nkind = "shim"\nat = "shoe 3"\nstiffness = 1e9', 4, "did you mean 'shoe 2'"),
])  # fmt: skip
def test_a_bad_section_names_its_line(text, line, sentence):
    with pytest.raises(DesignFileError, match=sentence) as caught:
        read_text('brake = "drum_brake"\n' + text)
    assert caught.value.problems[0].line == line


def test_friction_of_a_countermeasure_is_found_by_its_usual_name():
    brake = TunedMass(AddedMass(ModeCoupling(friction=Coulomb(0.5)), "x", 0.1), "y", 0.1, 1.0)
    assert brake.replace({"friction.static": 0.7}).value_of("brake.brake.friction.static") == 0.7
    with pytest.raises(ParameterError, match="one of"):
        brake.replace({"nonsense": 1.0})

"""What people type by mistake, from Python: one sentence that says what, where, given and expected."""

import inspect
import pickle

import numpy as np
import pytest

import squealbox as sb
from squealbox import (
    Contact,
    Coulomb,
    DrumBrake,
    MassOnBelt,
    Method,
    ParameterError,
    Result,
    Scatter,
    Stribeck,
    System,
    TunedMass,
    best_absorber,
    branch,
    calibrate,
    closed_loop,
    compare,
    complex_modes,
    critical_value,
    fit_friction,
    harmonic_balance,
    mechanism,
    mode_energy,
    optimise,
    peaks,
    plot,
    quantities,
    reduce,
    sensitivity,
    shooting,
    silence,
    simulate,
    simulate_ensemble,
    sobol_indices,
    sound,
    sound_level,
    spectrogram,
    spectrum,
    squeal_events,
    squeal_probability,
    stability_boundary,
    stability_map,
    sweep,
    tracked_modes,
    verdict,
)
from squealbox.arguments import KINDS
from squealbox.limit_cycles import basin, bifurcation_diagram
from squealbox.result import ResultFileError
from squealbox.signals import SignalError, growth_rate
from squealbox.studies import Normal
from squealbox.system import InvalidSystem

DRUM = DrumBrake()
FRICTION = {"friction.static": (0.2, 0.4)}
SCATTER = Scatter({"k3": Normal(1.9e8, 1e7)})
ROW = {"n": [0.0], "d": [1.0], "t": [1.0]}


def pad(**changes):
    return Contact(**{**ROW, "N0": 10.0, "V": 1.0, "law": Coulomb(0.3), **changes})


def plain(contacts=(), **changes):
    return System(**{"M": [[1.0]], "C": [[0.1]], "K": [[4.0]], "load": 0.0, "contacts": contacts, **changes})


MISTAKES = {
    # a file's name or a class in the place of a design
    "simulate a file": (
        lambda: simulate("brake.toml", 1.0),
        "simulate.design_or_system = 'brake.toml': expected a design; read_design",
    ),
    "modes of a file": (lambda: complex_modes("brake.toml"), "complex_modes.design_or_system = 'brake.toml'"),
    "modes of a class": (
        lambda: complex_modes(DrumBrake),
        "the class DrumBrake: expected a design made from it, DrumBrake(...)",
    ),
    "silence a file": (lambda: silence("brake.toml"), "silence.brake = 'brake.toml'"),
    "map a number": (lambda: stability_map(3.0, {}), "stability_map.design = 3: expected a design or a System"),
    "mechanism of nothing": (lambda: mechanism(None), "mechanism.design_or_system = None: expected a design"),
    "energy of a list": (lambda: mode_energy([1.0]), "mode_energy.design_or_system = [1.0]"),
    "loop of a text": (lambda: closed_loop("drum"), "closed_loop.design_or_system = 'drum'"),
    "cycle of a class": (lambda: shooting(MassOnBelt), "the class MassOnBelt"),
    "balance of a file": (lambda: harmonic_balance("a.toml"), "harmonic_balance.design_or_system = 'a.toml'"),
    "reduce a file": (lambda: reduce("a.inp", (1.0, 2.0)), "reduce.design_or_system = 'a.inp'"),
    # numbers
    "duration with a unit": (
        lambda: simulate(DRUM, "50ms"),
        "simulate.duration = '50ms': expected a finite number in (0, inf) s",
    ),
    "no duration": (lambda: simulate(DRUM, None), "simulate.duration = None: expected a finite number"),
    "negative duration": (
        lambda: simulate(DRUM, -1.0),
        "simulate.duration = -1: expected a finite number in (0, inf) s",
    ),
    "endless duration": (lambda: simulate(DRUM, np.inf), "simulate.duration = inf"),
    "duration of an ensemble": (
        lambda: simulate_ensemble(DRUM, {"load1": [1.0]}, "1 s"),
        "simulate_ensemble.duration = '1 s'",
    ),
    "tolerance as a text": (
        lambda: simulate(DRUM, 1e-3, rtol="1e-6"),
        "simulate.rtol = '1e-6': expected a finite number in [1e-15, 1)",
    ),
    "tolerance 0": (lambda: simulate(DRUM, 1e-3, rtol=0.0), "simulate.rtol = 0"),
    "time as a text": (lambda: complex_modes(DRUM, time="0"), "complex_modes.time = '0': expected a finite number"),
    "time nan": (lambda: complex_modes(DRUM, time=np.nan), "complex_modes.time = nan"),
    "width 0": (lambda: simulate(DRUM, 1e-3, contact="smooth", width=0.0), "simulate.width = 0"),
    "half a sample": (
        lambda: squeal_probability(DRUM, {}, np.sum, samples=0.5),
        "squeal_probability.samples = 0.5: expected a whole number of at least 1",
    ),
    "a seed below 0": (lambda: silence(DRUM, seed=-1), "silence.seed = -1: expected a whole number of at least 0"),
    "points as a text": (
        lambda: critical_value(DRUM, "friction.static", (0.1, 0.5), points="many"),
        "critical_value.points = 'many'",
    ),
    "times as a text": (
        lambda: simulate(DRUM, 1e-3, times="all"),
        "simulate.times = 'all': expected a whole number of at least 2, or an array",
    ),
    "one instant": (lambda: simulate(DRUM, 1e-3, times=1), "simulate.times = 1: expected a whole number of at least 2"),
    "instants after the end": (lambda: simulate(DRUM, 1e-3, times=[0.0, 1.0]), "simulate.times"),
    # ranges
    "bounds of three": (
        lambda: critical_value(DRUM, "friction.static", (0, 1, 2)),
        "critical_value.bounds = (0, 1, 2): expected two finite numbers (low, high)",
    ),
    "bounds reversed": (
        lambda: branch(DRUM, "friction.static", (0.5, 0.3)),
        "branch.bounds = (0.5, 0.3): expected two finite numbers (low, high) with low < high",
    ),
    "one bound": (lambda: critical_value(DRUM, "friction.static", 0.4), "critical_value.bounds = 0.4"),
    "bounds of three by name": (
        lambda: stability_boundary(DRUM, {"friction.static": (0, 1, 2), "load": (1, 2)}),
        "stability_boundary.friction.static = (0, 1, 2): expected two finite numbers (low, high) with low < high",
    ),
    "a band reversed": (
        lambda: reduce(DRUM, (2000.0, 100.0)),
        "reduce.band = (2000.0, 100.0): expected (f1, f2) in Hz",
    ),
    "a band below 0": (lambda: complex_modes(DRUM, band=(-1.0, 100.0)), "complex_modes.band = (-1.0, 100.0)"),
    # names
    "a list of axes": (
        lambda: stability_map(DRUM, ["friction.static"]),
        "stability_map.axes = ['friction.static']: expected a dictionary by parameter, such as",
    ),
    "parameters forgotten": (
        lambda: simulate_ensemble(DRUM, 0.01),
        "simulate_ensemble.parameters = 0.01: expected a dictionary by parameter",
    ),
    "a list to sweep": (
        lambda: sweep(DRUM, ["load1"], complex_modes),
        "sweep.space = ['load1']: expected a dictionary by parameter",
    ),
    "scatter as a list": (lambda: squeal_probability(DRUM, [1.0], None), "squeal_probability.scatter = [1.0]"),
    "indices without names": (lambda: sobol_indices(DRUM, 0.1, None), "sobol_indices.scatter = 0.1"),
    "variables as a list": (lambda: optimise(DRUM, ["load1"], []), "optimise.variables = ['load1']"),
    "calibrate a list": (lambda: calibrate(DRUM, ["k3"], []), "calibrate.parameters = ['k3']"),
    "a typo": (
        lambda: critical_value(DRUM, "friction.statik", (0.1, 0.5)),
        "LinearSlope.statik: did you mean 'static'?",
    ),
    "a typo in a value": (
        lambda: DRUM.replace({"frictoin.static": 0.3}),
        "DrumBrake.frictoin.static = 0.3: did you mean 'friction'?",
    ),
    "a typo when made": (lambda: DrumBrake(fricton=Coulomb(0.3)), "did you mean 'friction'?"),
    "another name when made": (lambda: DrumBrake(mass=1.0), "DrumBrake.mass = 1: expected one of m, c1, c2"),
    "an alias when made": (
        lambda: DrumBrake(load=900.0),
        "DrumBrake.load = 900: expected load1, load2; replace(load=...) sets them at once",
    ),
    "a typo in a law": (lambda: Coulomb(statik=0.3), "Coulomb.statik = 0.3: did you mean 'static'?"),
    "a typo in a contact": (lambda: Contact(**ROW, N0=1.0, V=1.0, low=Coulomb(0.3)), "did you mean 'law'?"),
    "a typo in a system": (lambda: System(M=[[1.0]], C=[[0.0]], K=[[1.0]], loads=0.0), "did you mean 'load'?"),
    "a typo in an option": (lambda: simulate(DRUM, duraton=1.0), "simulate.duraton = 1: did you mean 'duration'?"),
    "an option of another": (
        lambda: mechanism(DRUM, duration=1.0),
        "mechanism.duration = 1: expected one of design_or_system, time",
    ),
    "a mode by a typo": (lambda: sensitivity(DRUM, ["k9"]), "k9"),
    "a parameter not there": (lambda: tracked_modes(DRUM, "k9", [1.0, 2.0]), "DrumBrake.k9"),
    # words
    "a method by another name": (
        lambda: simulate(DRUM, 1e-3, method="rk45"),
        "'rk45': did you mean 'dormand-prince'? one of bogacki-shampine, dormand-prince",
    ),
    "a scheme by a typo": (
        lambda: simulate(DRUM, 1e-3, contact="exakt"),
        "simulate.contact = 'exakt': did you mean 'exact'?",
    ),
    "a start by a typo": (
        lambda: simulate(DRUM, 1e-3, "restt"),
        "simulate.start = 'restt': expected (q, qd) with 2 values each",
    ),
    "a start of three": (lambda: simulate(DRUM, 1e-3, ([0.0] * 3, [0.0] * 2)), "simulate.start"),
    "a start not finite": (
        lambda: simulate(DRUM, 1e-3, ([np.nan, 0.0], [0.0, 0.0])),
        "finite displacements and velocities",
    ),
    "a reading by a typo": (lambda: DrumBrake(reading="eq4"), "did you mean 'eq3'?"),
    # systems and contacts
    "one contact alone": (lambda: plain(pad()), "contacts is a Contact: expected several, (contact,) for one"),
    "a text as contact": (lambda: plain(("pad",)), "contacts[0] = 'pad': expected a Contact"),
    "a law's class": (lambda: pad(law=Coulomb), "contact.law = Coulomb: expected a friction law"),
    "a number as law": (lambda: pad(law=0.3), "contact.law = 0.3: expected a friction law"),
    "a load with a unit": (lambda: pad(N0="10 N"), "contact.N0 = '10 N': expected an array of real numbers"),
    "complex matrices": (lambda: plain(K=[[1j]]), "K: expected an array of real numbers"),
    "negative mass": (lambda: plain(M=[[-1.0]]), "M[0, 0] = -1 is negative: expected masses >= 0"),
    "damping of another size": (lambda: plain(C=np.eye(2)), "C has shape (2, 2)"),
    "a row too long": (lambda: plain((pad(n=[0.0, 1.0]),)), "contacts[0].n"),
    "two names for one": (lambda: plain(names=("x", "y")), "names = ('x', 'y'): 2 names, expected 1"),
    "names twice": (lambda: plain(M=np.eye(2), C=np.eye(2), K=np.eye(2), names=("x", "x")), "names"),
    "unilateral without a direction": (lambda: pad(unilateral=True), "contact.normal is missing"),
    "restitution of a spring": (lambda: pad(restitution=0.5), "only a rigid contact has one"),
    "an absorber nowhere": (lambda: TunedMass(DRUM, on="z", mass=0.1, frequency=100.0, damping=0.1).system(), "z"),
    # values out of range
    "friction below 0": (lambda: Coulomb(-0.1), "Coulomb.static = -0.1: expected a finite number in [0, "),
    "a text as friction": (lambda: Coulomb("0.3"), "Coulomb.static = '0.3': expected a finite number"),
    "truth as friction": (lambda: Coulomb(True), "Coulomb.static"),
    "kinetic above static": (lambda: Coulomb(0.3, 0.4), "0.4"),
    "stiffness 0": (lambda: DrumBrake(k1=0.0), "DrumBrake.k1 = 0: expected a finite number in (0, inf) N/m"),
    "a load with kN": (lambda: DRUM.replace(load="1 kN"), "DrumBrake.load1 = '1 kN': expected a finite number"),
    "a speed as a list of texts": (lambda: MassOnBelt(sliding_speed=["1 m/s"]), "MassOnBelt.sliding_speed"),
    # one thing in the place of another
    "a number as parameter": (
        lambda: critical_value(DRUM, 0.3, (0.0, 1.0)),
        'critical_value.parameter = 0.3: expected the name of a parameter, such as "friction.static"',
    ),
    "a law as parameter": (
        lambda: critical_value(DRUM, "friction", (0.0, 1.0)),
        "expected a friction law, or a number of it, friction.static, friction.slope, friction.floor",
    ),
    "a map over a law": (lambda: stability_map(DRUM, {"friction": [0.1, 0.2], "k3": [1e8, 2e8]}), "friction.static"),
    "silence a system": (lambda: silence(plain()), "OwnBrake(M, C, K, contacts) makes one of matrices"),
    "an absorber on a system": (lambda: best_absorber(plain(), "q1", 0.1), "best_absorber.brake = System("),
    "compare modes with modes": (
        lambda: compare(complex_modes(DRUM), complex_modes(DRUM)),
        "a ComplexModes: expected squeal_events(recording)",
    ),
    "peaks of a motion": (
        lambda: peaks(simulate(DRUM, 1e-3)),
        "a Trajectory is no spectrum: expected spectrum(signal)",
    ),
    "a quantity not called": (
        lambda: sobol_indices(DRUM, SCATTER, quantities.growth_rate),
        "growth_rate, not called': expected growth_rate(...)",
    ),
    "a quantity left out": (
        lambda: squeal_probability(DRUM, SCATTER),
        "squeal_probability.quantity is missing: expected a function of a design, or a quantity such as "
        "quantities.growth_rate()",
    ),
    "bounds left out": (
        lambda: critical_value(DRUM, "k3"),
        "critical_value.bounds is missing: expected two finite numbers",
    ),
    "a figure's option by a typo": (
        lambda: plot(complex_modes(DRUM), wdth=3.4),
        "plot.wdth = 3.4: did you mean 'width'? one of ",
    ),
    "a degree of freedom of an ensemble's figure": (
        lambda: plot(simulate_ensemble(DRUM, {"k3": [1e8, 2e8]}, 1e-3), dofs="y"),
        "plot.dofs = 'y': ",
    ),
    "a fit's option by a typo": (
        lambda: fit_friction([0.0, 1.0], [0.3, 0.3], laws="stribeck"),
        "fit_friction.laws = 'stribeck': did you mean 'law'?",
    ),
    "a folder not there": (
        lambda: complex_modes(DRUM).save("/nowhere/x/m.nc"),
        "/nowhere/x/m.nc: there is no folder /nowhere/x",
    ),
    "a text as speed": (lambda: Coulomb(0.3).mu("a"), "Coulomb.velocity = 'a': expected numbers [m/s]"),
    "a branch from a word": (
        lambda: branch(DRUM, "friction.static", (0.0, 0.6), "hopf"),
        "branch.start = 'hopf': expected",
    ),
    "derivatives of modes": (
        lambda: sensitivity(complex_modes(DRUM)),
        "sensitivity.design = a ComplexModes: expected a design or a System",
    ),
    "a method of another program": (lambda: Method("tsit5"), "Method.tableau = 'tsit5': did you mean 'tsitouras'?"),
    "a system without damping": (lambda: System(M=[[1.0]], K=[[4.0]]), "System.C is missing: expected damping"),
    "a law half made": (
        lambda: Stribeck(0.4),
        "Stribeck.kinetic is missing: expected a finite number in [0, 10] (coefficient at high sliding speed)",
    ),
    "a word as names": (
        lambda: plain(M=np.eye(2), C=np.eye(2), K=np.eye(2), names="xy"),
        "names = 'xy': expected a name for each degree of freedom, such as ('x', 'y')",
    ),
    # signals
    "verdict of modes": (lambda: verdict(complex_modes(DRUM)), "a ComplexModes is no signal: expected a motion"),
    "spectrum of a brake": (lambda: spectrum(DRUM), "a DrumBrake is no signal"),
    "spectrogram of a text": (lambda: spectrogram("a.wav"), "a str is no signal"),
    "sound of a brake": (lambda: sound(DRUM, "a.wav"), "a DrumBrake is no signal"),
    "sound into a number": (lambda: sound([0.0] * 9, 3), "sound.path = 3: expected a path"),
    "level without times": (lambda: sound_level([0.0] * 100), "t is missing"),
    "growth of three samples": (lambda: growth_rate([1.0, 2.0, 3.0], [0.0, 1.0, 2.0]), "expected"),
    "events without a rate": (lambda: squeal_events([0.0] * 100), "rate"),
    "events in half a band": (
        lambda: squeal_events([0.0] * 100, rate=1e4, band=1000.0),
        "squeal_events.band = 1000: expected (f1, f2) in Hz",
    ),
    "times that go back": (lambda: spectrum(np.zeros(20), np.arange(20)[::-1]), "the times do not increase"),
    # studies and the rest
    "goals as a word": (lambda: optimise(DRUM, FRICTION, "growth"), "optimise.goals"),
    "a fit of two points": (lambda: fit_friction([1.0, 2.0], [0.3, 0.4]), "expected 5 or more speeds"),
    "nothing measured": (
        lambda: calibrate(DRUM, {"k3": (1e6, 1e9)}, []),
        "calibrate.measured = []: expected a list of Measured",
    ),
    "a file not there": (lambda: Result.load("nope.nc"), "nope.nc: there is no such file"),
    "reduce what is small": (lambda: reduce(DRUM, (100.0, 1000.0)), "needs no reduction"),
    "a basin of a class": (lambda: basin(MassOnBelt), "the class MassOnBelt"),
    "a diagram in the air": (lambda: bifurcation_diagram(DRUM, "k9", [1.0, 2.0]), "k9"),
    "threads as a text": (
        lambda: simulate_ensemble(DRUM, {"load1": [1.0]}, threads="all"),
        "simulate_ensemble.threads = 'all'",
    ),
}


@pytest.mark.parametrize("mistake", MISTAKES)
def test_a_typical_mistake_is_told_in_one_sentence(mistake):
    made, says = MISTAKES[mistake]
    with pytest.raises((ParameterError, InvalidSystem, SignalError, ResultFileError, ValueError)) as caught:
        made()
    text = str(caught.value)
    assert says in text
    assert "\n" not in text
    assert len(text) < 400


BY_THEIR_SYSTEM = {
    "equilibrium",
    "linearise",
}  # asked a thousand times by others; what they are given is looked at there


def public_functions():
    """Every function among the public names that has an argument by a known name."""
    found = (getattr(sb, name) for name in sb.__all__)
    functions = [each for each in found if inspect.isfunction(each) and each.__name__ not in BY_THEIR_SYSTEM]
    # the band of a verdict is a share of its frequency
    return [each for each in functions if set(inspect.signature(each).parameters) & set(KINDS) and each is not verdict]


@pytest.mark.parametrize("function", public_functions(), ids=lambda one: one.__name__)
def test_every_public_function_looks_at_its_arguments(function):
    """What has a duration, bounds, a seed ... refuses what cannot be one, and names itself and the argument."""
    assert function.looked_at, "@public() is missing"
    for name in function.looked_at:
        with pytest.raises(ParameterError, match=rf"^{function.__name__}\.{name} = <object"):
            function(**{name: object()})


def test_what_looks_keeps_the_function():
    assert simulate.__doc__.startswith("Integrate")
    assert list(inspect.signature(simulate).parameters)[:2] == ["design_or_system", "duration"]
    assert pickle.loads(pickle.dumps(DRUM)) == DRUM

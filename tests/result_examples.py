"""One small example of every kind of result, for the tests that hold for all of them."""

import dataclasses
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
from scipy.signal import lfilter
from scipy.sparse import dia_array

from squealbox import (
    PID,
    Contact,
    Measured,
    Sinusoid,
    System,
    calibrate,
    compare,
    forced_cycle,
    quantities,
    signals,
    stability,
    studies,
)
from squealbox.control import closed_loop, defeating_push, placement, run_loops, stable_gains
from squealbox.countermeasures import best_absorber
from squealbox.designs import DampingParadox, DrumBrake, MassOnBelt
from squealbox.fit import fit_friction
from squealbox.friction import Coulomb
from squealbox.limit_cycles import basin, bifurcation_diagram, branch, coexistence, dangerous_push, hopf_point, shooting
from squealbox.limit_cycles.branches.curves import hopf_curve
from squealbox.remedies import Remedies
from squealbox.result import Result
from squealbox.studies import sweep
from squealbox.transient import compare_contact, simulate, simulate_ensemble, verdict

FRICTION = "friction.static"
RANGE = (0.1, 0.6)


@cache
def drum() -> DrumBrake:
    """The drum brake as its paper has it: steady sliding is stable."""
    return DrumBrake()


@cache
def motion() -> Any:
    """A short transient of the drum."""
    return simulate(drum(), 5e-3, times=501)


@cache
def hopf() -> Any:
    """Where the drum's steady sliding loses its stability."""
    return hopf_point(drum(), FRICTION, RANGE)


@cache
def cycles() -> Any:
    """The branch born there."""
    return branch(drum(), FRICTION, RANGE, hopf(), points=25)


def special() -> Any:
    """A cycle at a special point of that branch."""
    return next(iter(cycles().points))


def stop() -> Any:
    """Squeal at 2 kHz that grows and dies in noise, with a braking speed that falls."""
    t = np.arange(48000) / 48000.0
    squeal = np.exp(np.minimum(60.0 * (t - 0.3), 0.0) + np.minimum(-80.0 * (t - 0.7), 0.0))
    noise = np.random.default_rng(0).standard_normal(t.size)
    return signals.squeal_events(0.5 * squeal * np.sin(2.0 * np.pi * 2000.0 * t) + 1e-3 * noise, 48000.0)


def campaign() -> Any:
    """Five stops in different conditions, two of them noisy."""
    loud = stop()
    quiet = signals.squeal_events(1e-3 * np.random.default_rng(1).standard_normal(24000), 48000.0)
    stops = [(loud, 5.0, 2e6), (loud, 8.0, 1e6), (quiet, 6.0, 2e6), (quiet, 12.0, 1e6), (quiet, 15.0, 3e6)]
    return signals.noise_matrix([
        dataclasses.replace(each, settings={**each.settings, "stop": {"speed": speed, "pressure": pressure}})
        for each, speed, pressure in stops
    ])  # fmt: skip


def fitted() -> Any:
    """The drum's k3 and load from the growth rate and frequency of its worst mode."""
    brake = drum().replace({FRICTION: 0.45})
    modes = stability.complex_modes(brake)
    worst = int(np.argmax(modes.growth_rate))
    data = [Measured("growth_rate", float(modes.growth_rate[worst]), sd=5.0),
            Measured("frequency", float(modes.frequency[worst]), sd=1.0)]  # fmt: skip
    return calibrate(brake, {"k3": (0.8 * brake.k3, 1.2 * brake.k3), FRICTION: (0.4, 0.5)}, data, profile=False)


def shaken() -> System:
    """A block on a belt whose speed swings."""
    speed = Sinusoid(mean=0.5, amplitude=1.0, frequency=3.0)
    return System([[1.0]], [[0.02]], [[1.0]], 0.0, (Contact([0.0], [1.0], [1.0], 1.0, speed, Coulomb(0.4)),))


def shaken_by_noise(pressure: float) -> Any:
    """The mode at 500 Hz of an oscillator under noise, with a growth rate of -40 + 8 pressure."""
    pole = np.exp((-40.0 + 8.0 * pressure + 2j * np.pi * 500.0) / 4000.0)
    push = np.random.default_rng(int(pressure)).standard_normal(20000)
    answer = lfilter([0.0, pole.imag], [1.0, -2.0 * pole.real, abs(pole) ** 2], push)
    return signals.operational_modes(answer, 4000.0, band=(300.0, 700.0))


def sampled() -> System:
    """An oscillator with a loop that is sampled."""
    return System([[1.0]], [[0.0]], [[1.0]], loops=(PID(on="q1", derivative=0.1, sampling=2.0),))


def limited() -> System:
    """An oscillator of negative damping with a loop of limited force."""
    return System([[1.0]], [[-0.1]], [[1.0]], loops=(PID(on="q1", derivative=0.3, limit=1.0),))


def sparse_block() -> System:
    M, C, K = (dia_array(np.diag(each)) for each in ([1.0, 1.0], [3.0, 3.0], [1e6, 4e6]))
    pad = Contact(n=[0.0, 1e5], d=[1.0, 0.0], t=[1.0, 0.0], law=Coulomb(0.3), V=1.0, N0=50.0, name="pad")
    return System(M=M, C=C, K=K, contacts=[pad])


def cures() -> Any:
    """Two rows, the second with what to know before."""
    return Remedies(
        name=np.array(["added damping on y", "friction.static down"]), dose=np.array([12.0, 0.25]),
        unit=np.array(["N s/m", ""]), reached=np.array([True, False]), growth=np.array([-3.0, 4.0]),
        growth_at_margin=np.array([-1.0, 7.0]), probability=np.array([0.02, 0.3]),
        amplitude=np.array([np.nan, 1e-6]), cost=np.array(["a damper", "another lining"]),
        caution=np.array(["", "the brake needs 40 % more force"]),
        line=np.array(['AddedDamping(brake, "y", 12.0)', 'brake.replace({"friction.static": 0.25})']),
        values=({}, {"friction.static": 0.25}), growth_before=33.0, before=0.9, amplitude_before=2e-5,
        inputs={"system": drum()},
    )  # fmt: skip


def scattered(study: Callable[..., Any], **settings: Any) -> Any:
    """A study of the growth rate of the model of the damping paradox under scatter."""
    scatter = studies.Scatter({FRICTION: studies.Normal(0.28, 0.02), "eta1": studies.Uniform(0.01, 0.03)})
    return study(DampingParadox(), scatter, quantities.growth_rate(), **settings)


EXAMPLES: dict[str, Callable[[], Result]] = {
    "Trajectory": motion,
    "Verdict": lambda: verdict(motion()),
    "ContactComparison": lambda: compare_contact(drum(), 2e-3, schemes=("exact", "raw")),
    "Ensemble": lambda: simulate_ensemble(drum(), {FRICTION: np.linspace(0.1, 0.4, 4)}, 2e-3),
    "Spectrum": lambda: signals.spectrum(motion()),
    "Spectrogram": lambda: signals.spectrogram(motion()),
    "GrowthRate": lambda: signals.growth_rate(simulate(drum(), 0.02, times=2001), begin=5e-3),
    "SoundLevel": lambda: signals.sound_level(motion()),
    "ComplexModes": lambda: stability.complex_modes(drum()),
    "CriticalValue": lambda: stability.critical_value(drum(), FRICTION, RANGE),
    "CriticalValues": lambda: stability.critical_values(drum(), FRICTION, RANGE),
    "BandModes": lambda: stability.complex_modes(sparse_block(), band=(100.0, 400.0)),
    "ModeEnergy": lambda: stability.mode_energy(drum()),
    "LocalSensitivity": lambda: stability.local_sensitivity(drum(), stability.complex_modes(drum()).most_unstable),
    "MeshDoubt": lambda: stability.MeshDoubt(
        frequency=np.array([2868.9, 3494.8, 5292.2]),
        growth_rate=np.array([2.1, 432.7, -3.0]),
        other_frequency=np.array([2910.9, 3521.7, np.nan]),
        other_growth_rate=np.array([3.0, 399.3, np.nan]),
        likeness=np.array([0.87, 0.99, 0.3]),
        element_size=0.02,
        other_size=0.03,
        freedoms=(7344, 4014),
    ),
    "Sensitivity": lambda: stability.sensitivity(drum()),
    "TrackedModes": lambda: stability.tracked_modes(drum(), FRICTION, np.linspace(0.1, 0.4, 5)),
    "StabilityMap": lambda: stability.stability_map(
        drum(), {FRICTION: np.linspace(0.1, 0.6, 7), "load": np.linspace(500.0, 5000.0, 5)}
    ),
    "Boundary": lambda: stability.stability_boundary(drum(), {FRICTION: RANGE, "k1": (18e6, 20e6)}, cells=8),
    "FiniteSpectrum": lambda: stability.finite_spectrum(drum()),
    "TransientGrowth": lambda: stability.transient_growth(drum()),
    "ExceptionalPoints": lambda: stability.exceptional_points(
        DampingParadox(), {"friction.static": (0.1, 0.5), "eta1": (0.0, 0.04)}, points=11
    ),
    "DampingSplit": lambda: stability.damping_split(
        DampingParadox(), ("eta1", "eta2"), 0.04, "friction.static", (0.05, 0.6), splits=5
    ),
    "ForcedCycle": lambda: forced_cycle(shaken()),
    "LoopRun": lambda: run_loops(sampled(), 5.0, ([1.0], [0.0])),
    "Placement": lambda: placement(drum()),
    "DefeatingPush": lambda: defeating_push(limited(), precision=0.1),
    "ClosedLoop": lambda: closed_loop(limited()),
    "BestAbsorber": lambda: best_absorber(DampingParadox(), "x", 0.02),
    "Remedies": cures,
    "StableGains": lambda: stable_gains(limited()),
    "SquealEvents": stop,
    "NoiseMatrix": campaign,
    "Calibration": fitted,
    "OperationalModes": lambda: shaken_by_noise(1.0),
    "DampingOnset": lambda: signals.damping_onset([shaken_by_noise(x) for x in (1.0, 2.0, 3.0)], [1.0, 2.0, 3.0]),
    "SoundQuality": lambda: signals.sound_quality(0.02 * np.sin(6283.0 * np.arange(24000) / 48000.0), 48000.0),
    "Comparison": lambda: compare(stability.complex_modes(drum()), stop()),
    "FrictionFit": lambda: fit_friction(np.linspace(0.0, 1.0, 8), 0.3 + 0.1 * np.exp(-np.linspace(0.0, 1.0, 8))),
    "Cycle": lambda: shooting(MassOnBelt(friction=Coulomb(0.4, 0.25))),
    "HopfPoint": hopf,
    "Branch": cycles,
    "BranchPoint": special,
    "Basin": lambda: basin(drum(), [1e-6, 1e-6, 0.0, 0.0], 4),
    "Sweep": lambda: sweep(drum(), {FRICTION: np.linspace(0.1, 0.4, 4)}, stability.complex_modes),
    "DangerousPush": lambda: dangerous_push(
        drum().replace({FRICTION: 0.3}), (2e-3, 5e-2), directions=32, rounds=1, drawn=8
    ),
    "BifurcationDiagram": lambda: bifurcation_diagram(drum(), FRICTION, [0.1, 0.3]),
    "Coexistence": lambda: coexistence(
        drum(), {FRICTION: (0.3, 0.9), "load": (900.0, 1100.0)}, columns=4, rows=2, starts=2
    ),
    "PointCurve": lambda: hopf_curve(drum(), {FRICTION: RANGE, "k1": (18e6, 20e6)}, points=6),
    "SquealProbability": lambda: scattered(studies.squeal_probability, samples=512),
    "SobolIndices": lambda: scattered(studies.sobol_indices, samples=128),
    "MorrisEffects": lambda: scattered(studies.morris_effects, trajectories=10),
    "IntervalBounds": lambda: studies.interval_bounds(
        DampingParadox(), {FRICTION: (0.2, 0.3), "eta1": (0.01, 0.03)}, quantities.growth_rate(), runs=1
    ),
    "DesignPoint": lambda: scattered(studies.form, samples=200),
    "SubsetProbability": lambda: scattered(studies.subset_simulation, samples=200),
    "Surrogate": lambda: scattered(studies.polynomial_chaos, samples=64, degree=3),
    "Optimum": lambda: studies.optimise(
        DampingParadox(), {"eta1": (0.001, 0.05)}, studies.Goal(quantities.growth_rate()), generations=5, population=8
    ),
}
EXAMPLES = {name: cache(make) for name, make in EXAMPLES.items()}  # made once for all tests of a process

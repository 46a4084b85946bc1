"""One small example of every kind of result, for the tests that hold for all of them."""

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np

from squealbox import quantities, signals, stability, studies
from squealbox.designs import DampingParadox, DrumBrake, MassOnBelt
from squealbox.fit import fit_friction
from squealbox.friction import Coulomb
from squealbox.limit_cycles import basin, bifurcation_diagram, branch, coexistence, dangerous_push, hopf_point, shooting
from squealbox.limit_cycles.branches.curves import hopf_curve
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
    "ModeEnergy": lambda: stability.mode_energy(drum()),
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
        drum(), {FRICTION: (0.1, 0.4), "load": (900.0, 1100.0)}, columns=4, rows=2, starts=4
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

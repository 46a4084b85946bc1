# The public names in the order of the story. `lazy_loader` reads the imports; people, editors and type checkers read both.
# A room with more names than the story needs is public as a whole: `squealbox.friction.Table`, `squealbox.schedules.Table`.

from . import (
    calibration,
    designs,
    files,
    friction,
    limit_cycles,
    plots,
    quantities,
    schedules,
    signals,
    stability,
    studies,
    transient,
)
from .calibration import Calibration, Measured, calibrate, compare
from .continuation import Follower, follow
from .designs import (
    BlockChain,
    DampingParadox,
    DrumBrake,
    DrumBrakeShoes,
    InclinedSprings,
    MassOnBelt,
    ModeCoupling,
    PadOnDisc,
    SpragSlip,
    WobblingDisc,
)
from .files import Body, OwnBrake, OwnContact, OwnLaw, OwnMechanism, Spring, Touch, own_law, read_design, write_design
from .fit import FrictionFit, fit_friction
from .friction import Coulomb, Cubic, FrictionLaw, Hyperbolic, LinearSlope, Stribeck
from .limit_cycles import Branch, Cycle, HopfPoint, branch, harmonic_balance, hopf_point, shooting
from .parameters import ParameterError
from .plots import plot
from .result import Outcome, Result
from .schedules import Constant, Ramp, Schedule, Sinusoid
from .signals import (
    Recording,
    SquealEvents,
    noise_matrix,
    peaks,
    read_recording,
    sound,
    sound_level,
    spectrogram,
    spectrum,
    squeal_events,
)
from .stability import (
    Boundary,
    ComplexModes,
    CriticalValue,
    CriticalValues,
    Mode,
    ModeEnergy,
    Sensitivity,
    StabilityMap,
    TrackedModes,
    complex_modes,
    critical_value,
    critical_values,
    mechanism,
    mode_energy,
    sensitivity,
    stability_boundary,
    stability_map,
    tracked_modes,
)
from .studies import (
    Constraint,
    Goal,
    Optimum,
    Quantity,
    Scatter,
    Space,
    SquealProbability,
    Sweep,
    optimise,
    sobol_indices,
    squeal_probability,
    sweep,
)
from .system import Contact, System, equilibrium, linearise
from .transient import (
    Ensemble,
    Method,
    Observer,
    Trajectory,
    Verdict,
    compare_contact,
    simulate,
    simulate_ensemble,
    verdict,
)

__version__: str

__all__ = [
    # friction laws: mu(|v|) and its slope
    "friction",
    "FrictionLaw",
    "Coulomb",
    "LinearSlope",
    "Stribeck",
    "Hyperbolic",
    "Cubic",
    # what varies in time
    "schedules",
    "Schedule",
    "Constant",
    "Ramp",
    "Sinusoid",
    # the equation, its steady sliding state and its linearisation
    "System",
    "Contact",
    "equilibrium",
    "linearise",
    # brakes on paper
    "designs",
    "DrumBrake",
    "DrumBrakeShoes",
    "MassOnBelt",
    "BlockChain",
    "ModeCoupling",
    "InclinedSprings",
    "DampingParadox",
    "PadOnDisc",
    "WobblingDisc",
    "SpragSlip",
    # your own: from a file, from matrices, as a mechanism, with a law of plain functions or from measured points
    "files",
    "read_design",
    "write_design",
    "OwnBrake",
    "OwnContact",
    "OwnMechanism",
    "Body",
    "Spring",
    "Touch",
    "OwnLaw",
    "own_law",
    "fit_friction",
    "FrictionFit",
    # is steady sliding stable, and from which value is it not?
    "stability",
    "complex_modes",
    "ComplexModes",
    "Mode",
    "critical_value",
    "CriticalValue",
    "critical_values",
    "CriticalValues",
    "mechanism",
    "sensitivity",
    "Sensitivity",
    "mode_energy",
    "ModeEnergy",
    "tracked_modes",
    "TrackedModes",
    "stability_map",
    "StabilityMap",
    "stability_boundary",
    "Boundary",
    # what happens in time, and what became of it?
    "transient",
    "simulate",
    "simulate_ensemble",
    "Ensemble",
    "Observer",
    "Method",
    "Trajectory",
    "compare_contact",
    "verdict",
    "Verdict",
    # follow the roots of any residual(x, p)
    "follow",
    "Follower",
    # what does it settle to?
    "limit_cycles",
    "shooting",
    "harmonic_balance",
    "Cycle",
    "hopf_point",
    "HopfPoint",
    "branch",
    "Branch",
    # how does the answer vary?
    "studies",
    "sweep",
    "Sweep",
    "Space",
    # how probable is squeal when parameters scatter, which matters, and what to change?
    "Scatter",
    "Quantity",
    "squeal_probability",
    "SquealProbability",
    "sobol_indices",
    "optimise",
    "Goal",
    "Constraint",
    "Optimum",
    "quantities",
    # what a signal holds
    "signals",
    "spectrum",
    "peaks",
    "spectrogram",
    "sound",
    "sound_level",
    # what was measured: recordings, the squeal in them, and the parameters that fit
    "read_recording",
    "Recording",
    "squeal_events",
    "SquealEvents",
    "noise_matrix",
    "calibration",
    "Measured",
    "calibrate",
    "Calibration",
    "compare",
    # any result as a figure
    "plots",
    "plot",
    # what every analysis hands back, and what a bad number raises
    "Result",
    "Outcome",
    "ParameterError",
]

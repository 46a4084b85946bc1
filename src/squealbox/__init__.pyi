# The public names in the order of the story. `lazy_loader` reads the imports; people, editors and type checkers read both.
# A room with more names than the story needs is public as a whole: `squealbox.friction.Table`, `squealbox.schedules.Table`.

from . import (
    control,
    countermeasures,
    designs,
    fe,
    files,
    friction,
    limit_cycles,
    loops,
    plots,
    quantities,
    schedules,
    signals,
    stability,
    studies,
    transient,
)
from .contacts import Contacts
from .continuation import Follower, follow
from .control import ClosedLoop, closed_loop
from .countermeasures import (
    AddedDamping,
    AddedMass,
    AddedStiffness,
    Asymmetry,
    BestAbsorber,
    Controlled,
    Dithered,
    LayerDamping,
    NormalDither,
    Shim,
    TunedMass,
    best_absorber,
)
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
from .fe import PublishedDiscBrake, ReducedBrake, reduce
from .files import Body, OwnBrake, OwnContact, OwnLaw, OwnMechanism, Spring, Touch, own_law, read_design, write_design
from .fit import FrictionFit, fit_friction
from .friction import Coulomb, Cubic, FrictionLaw, Hyperbolic, LinearSlope, Stribeck
from .limit_cycles import Branch, Cycle, HopfPoint, branch, harmonic_balance, hopf_point, shooting
from .loops import PID, ActiveForce, DelayedFeedback, Loop, StateFeedback
from .parameters import ParameterError
from .plots import plot
from .remedies import Remedies, silence
from .result import Outcome, Result
from .schedules import Constant, Ramp, Schedule, Sinusoid
from .signals import peaks, sound, sound_level, spectrogram, spectrum
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
    # brakes of finite elements: sparse matrices, many contacts, reduced to few coordinates with a known error
    "fe",
    "Contacts",
    "reduce",
    "ReducedBrake",
    "PublishedDiscBrake",
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
    # what is done against squeal: designs that hold a design
    "countermeasures",
    "TunedMass",
    "AddedMass",
    "AddedStiffness",
    "AddedDamping",
    "Asymmetry",
    "Shim",
    "LayerDamping",
    "Dithered",
    "NormalDither",
    "Controlled",
    "best_absorber",
    "BestAbsorber",
    # loops that sense and act, and their poles and margins
    "loops",
    "Loop",
    "PID",
    "StateFeedback",
    "DelayedFeedback",
    "ActiveForce",
    "control",
    "closed_loop",
    "ClosedLoop",
    # what would silence this brake?
    "silence",
    "Remedies",
    # what a signal holds
    "signals",
    "spectrum",
    "peaks",
    "spectrogram",
    "sound",
    "sound_level",
    # any result as a figure
    "plots",
    "plot",
    # what every analysis hands back, and what a bad number raises
    "Result",
    "Outcome",
    "ParameterError",
]

"""How does the answer vary? Spaces of parameters, sweeps over them, and the store a sweep cannot lose.

    table = sweep(brake, {"friction.static": mus, "load": loads}, complex_modes, out="study")

A study imports no analysis: it is handed one, any function of a design. So it can run the user's own as well.
Depends on: system, result, parameters.
"""

from squealbox.result import batched
from squealbox.studies.analysis import StudyError
from squealbox.studies.optimisation.goals import Constraint, Goal
from squealbox.studies.optimisation.optimum import Optimum, optimise
from squealbox.studies.quantity import Quantity, evaluate
from squealbox.studies.refinement import Refined
from squealbox.studies.settings import (
    RefineSettings,
    SampleSettings,
    SearchSettings,
    StudySettings,
    WorkerSettings,
)
from squealbox.studies.space import Axis, Space, grid, latin_hypercube, sampled, sobol_sequence, zipped
from squealbox.studies.store import (
    ForeignStore,
    Store,
    StoreDamaged,
    StoreError,
    StoreFull,
    StoreLocked,
    StudyChanged,
)
from squealbox.studies.sweep import Sweep, open_sweep, sweep
from squealbox.studies.uncertainty.chaos import Surrogate, polynomial_chaos
from squealbox.studies.uncertainty.distributions import (
    DISTRIBUTIONS,
    Beta,
    Distribution,
    Lognormal,
    Normal,
    ScipyDistribution,
    Triangular,
    TruncatedNormal,
    Uniform,
    as_distribution,
)
from squealbox.studies.uncertainty.form import DesignPoint, form
from squealbox.studies.uncertainty.intervals import IntervalBounds, interval_bounds
from squealbox.studies.uncertainty.morris import MorrisEffects, morris_effects
from squealbox.studies.uncertainty.probability import SquealProbability, squeal_probability
from squealbox.studies.uncertainty.scatter import SAMPLINGS, Scatter
from squealbox.studies.uncertainty.sobol import SobolIndices, sobol_indices
from squealbox.studies.uncertainty.subset import SubsetProbability, subset_simulation
from squealbox.studies.work import Pace

__all__ = [
    "DISTRIBUTIONS",
    "SAMPLINGS",
    "Axis",
    "Beta",
    "Constraint",
    "DesignPoint",
    "Distribution",
    "ForeignStore",
    "Goal",
    "IntervalBounds",
    "Lognormal",
    "MorrisEffects",
    "Normal",
    "Optimum",
    "Pace",
    "Quantity",
    "RefineSettings",
    "Refined",
    "SampleSettings",
    "Scatter",
    "ScipyDistribution",
    "SearchSettings",
    "SobolIndices",
    "Space",
    "SquealProbability",
    "Store",
    "StoreDamaged",
    "StoreError",
    "StoreFull",
    "StoreLocked",
    "StudyChanged",
    "StudyError",
    "StudySettings",
    "SubsetProbability",
    "Surrogate",
    "Sweep",
    "Triangular",
    "TruncatedNormal",
    "Uniform",
    "WorkerSettings",
    "as_distribution",
    "batched",
    "evaluate",
    "form",
    "grid",
    "interval_bounds",
    "latin_hypercube",
    "morris_effects",
    "open_sweep",
    "optimise",
    "polynomial_chaos",
    "sampled",
    "sobol_indices",
    "sobol_sequence",
    "squeal_probability",
    "subset_simulation",
    "sweep",
    "zipped",
]

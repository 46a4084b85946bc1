from squealbox.distributions import (
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
from squealbox.result import batched
from squealbox.scatter import SAMPLINGS, Scatter

from .analysis import StudyError
from .optimisation.goals import Constraint, Goal
from .optimisation.optimum import Optimum, optimise
from .quantity import Quantity, evaluate
from .refinement import Refined
from .settings import RefineSettings, SampleSettings, SearchSettings, StudySettings, WorkerSettings
from .space import Axis, Space, grid, latin_hypercube, sampled, sobol_sequence, zipped
from .store import ForeignStore, Store, StoreDamaged, StoreError, StoreFull, StoreLocked, StudyChanged
from .sweeping import Sweep, open_sweep, sweep
from .uncertainty.chaos import Surrogate, polynomial_chaos
from .uncertainty.form import DesignPoint, form
from .uncertainty.intervals import IntervalBounds, interval_bounds
from .uncertainty.morris import MorrisEffects, morris_effects
from .uncertainty.probability import SquealProbability, squeal_probability
from .uncertainty.sobol import SobolIndices, sobol_indices
from .uncertainty.subset import SubsetProbability, subset_simulation
from .work import Pace

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

# What neighbours may use too; no names of the reference (docs/house.md, Faces).
from .optimisation.goals import Over as Over
from .space import POINT as POINT
from .store import LOG as LOG
from .store import RESULT as RESULT
from .uncertainty.replicates import binomial_interval as binomial_interval

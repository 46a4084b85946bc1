"""How does the answer vary? Spaces of parameters, sweeps over them, and the store a sweep cannot lose.

A study imports no analysis: it is handed one, any function of a design. So it can run the user's own as well.
Depends on: system, result, parameters.
"""

from squealbox.studies.distributions import (
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
from squealbox.studies.scatter import SAMPLINGS, Scatter

__all__ = [
    "DISTRIBUTIONS",
    "SAMPLINGS",
    "Beta",
    "Distribution",
    "Lognormal",
    "Normal",
    "Scatter",
    "ScipyDistribution",
    "Triangular",
    "TruncatedNormal",
    "Uniform",
    "as_distribution",
]

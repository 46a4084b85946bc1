"""How much work a study is, for files and the command line: workers, samples, generations."""

from squealbox.parameters import DataSheet, above_zero, choice, parameter
from squealbox.scatter import SAMPLINGS
from squealbox.studies.refinement import FINEST

ANALYSES = ("modes", "onset", "simulate", "ensemble", "cycle")


class WorkerSettings(DataSheet):
    """How the points of a study are shared out."""

    workers: int | None = parameter("-", 1, 4096, default=None, optional=True, meaning="processes on this machine")
    chunk: int | None = parameter(
        "-", 1, 2**40, default=None, optional=True, meaning="points in a block; left out, it takes about a second"
    )
    time_limit: float | None = above_zero("s", default=None, meaning="of a block that a worker computes")


class StudySettings(WorkerSettings):
    """[study]: an analysis over a space of parameters."""

    analysis: str = choice(*ANALYSES, default="modes", meaning="what is asked at every point")
    seed: int = parameter("-", 0, 2**53, default=0, meaning="of samples and random numbers")
    duration: float | None = above_zero(
        "s",
        default=None,
        meaning="of each transient of an ensemble; left out, 200 periods of the brake's worst mode",
    )


class RefineSettings(DataSheet):
    """[study.refine]: the grid grows finer where an answer crosses a level."""

    of: str
    level: float = parameter("-", default=0.0, meaning="that is crossed, in the SI unit of the answer")
    rounds: int = parameter("-", 1, FINEST, default=4, meaning="of refinement; each halves the cells")


class SampleSettings(DataSheet):
    """[scatter]: how the scatter is sampled."""

    samples: int = parameter("-", 16, 100_000_000, default=4096, meaning="points of the samples")
    sampling: str = choice(*SAMPLINGS, default="sobol", meaning="kind of points")
    seed: int = parameter("-", 0, 2**31 - 1, default=0, meaning="the same seed gives the same points")
    level: float = parameter("-", 0.5, 0.9999, default=0.95, meaning="confidence level of intervals")


class SearchSettings(DataSheet):
    """[optimise]: how hard is searched."""

    method: str = choice("global", "local", default="global", meaning="whole box, or from the design of the file")
    population: int = parameter("-", 8, 10_000, default=60, meaning="candidates of a generation")
    generations: int = parameter("-", 1, 100_000, default=200, meaning="most generations")
    samples: int = parameter("-", 16, 1_000_000, default=256, meaning="points of the scatter for each candidate")
    seed: int = parameter("-", 0, 2**31 - 1, default=0, meaning="the same seed gives the same designs")

"""What is known of a number that scatters: its distribution, in the unit of the parameter it is given for.

Each is a data sheet over a frozen distribution of `scipy.stats`, so it can stand in a file, be saved with a result and
be compared. `as_distribution` takes any frozen distribution of `scipy.stats` as well. Joint scatter is in `scatter.py`.
"""

from typing import Any

import numpy as np

from squealbox.parameters import DataSheet, ParameterError, known_names, parameter


class Distribution(DataSheet):
    """Base of the distributions. Units: those of the parameter the distribution is given for."""

    def frozen(self) -> Any:
        """The same as a frozen distribution of `scipy.stats`."""
        raise NotImplementedError

    def ppf(self, u: float | np.ndarray) -> Any:
        """The value below which the share `u` in (0, 1) lies; any shape."""
        return self.frozen().ppf(u)

    def cdf(self, x: np.ndarray) -> Any:
        """The share of values below `x`; any shape."""
        return self.frozen().cdf(x)

    @property
    def average(self) -> float:
        """Mean of the distribution."""
        return float(self.frozen().mean())

    @property
    def deviation(self) -> float:
        """Standard deviation of the distribution."""
        return float(self.frozen().std())

    @property
    def support(self) -> tuple[float, float]:
        """Least and largest value that can occur, infinite where there is none."""
        low, high = self.frozen().support()
        return float(low), float(high)

    def _expect(self, ok: bool, name: str, expected: str) -> None:
        if not ok:
            raise ParameterError(type(self).__name__, name, getattr(self, name), expected)

    def _scalars(self) -> None:
        for name in self.parameters():
            self._expect(np.ndim(getattr(self, name)) == 0, name, "one number")


class Normal(Distribution):
    """Normal distribution with density exp(-(x - mean)^2 / (2 sd^2)) / (sd sqrt(2 pi)).

    It reaches beyond every bound. For a parameter that has one, such as a mass, `TruncatedNormal` is the honest choice.

    >>> round(float(Normal(mean=0.35, sd=0.03).ppf(0.95)), 6)
    0.399346
    """

    mean: float = parameter("", meaning="mean")
    sd: float = parameter("", 0.0, low_open=True, meaning="standard deviation")

    def __post_init__(self) -> None:
        super().__post_init__()
        self._scalars()

    def frozen(self) -> Any:
        from scipy.stats import norm

        return norm(self.mean, self.sd)


class Uniform(Distribution):
    """Every value between low and high equally likely.

    >>> float(Uniform(low=1.0, high=3.0).ppf(0.25))
    1.5
    """

    low: float = parameter("", meaning="least value")
    high: float = parameter("", meaning="largest value")

    def __post_init__(self) -> None:
        super().__post_init__()
        self._scalars()
        self._expect(self.low < self.high, "high", f"a number above low = {self.low:g}")

    def frozen(self) -> Any:
        from scipy.stats import uniform

        return uniform(self.low, self.high - self.low)


class Lognormal(Distribution):
    """ln x is normal; mean and sd are those of x itself, so s^2 = ln(1 + (sd/mean)^2) is the variance of ln x.

    >>> spread = Lognormal(mean=2.0, sd=0.4)
    >>> round(spread.average, 12), round(spread.deviation, 12)
    (2.0, 0.4)
    """

    mean: float = parameter("", 0.0, low_open=True, meaning="mean")
    sd: float = parameter("", 0.0, low_open=True, meaning="standard deviation")

    def __post_init__(self) -> None:
        super().__post_init__()
        self._scalars()

    @property
    def log_mean(self) -> float:
        """Mean of ln x."""
        return float(np.log(self.mean)) - 0.5 * self.log_sd**2

    @property
    def log_sd(self) -> float:
        """Standard deviation of ln x."""
        return float(np.sqrt(np.log1p((self.sd / self.mean) ** 2)))

    def frozen(self) -> Any:
        from scipy.stats import lognorm

        return lognorm(self.log_sd, scale=np.exp(self.log_mean))


class Triangular(Distribution):
    """Density that rises in a straight line from low to mode and falls to high.

    >>> round(Triangular(low=0.0, mode=1.0, high=2.0).average, 12)
    1.0
    """

    low: float = parameter("", meaning="least value")
    mode: float = parameter("", meaning="most likely value")
    high: float = parameter("", meaning="largest value")

    def __post_init__(self) -> None:
        super().__post_init__()
        self._scalars()
        self._expect(self.low < self.high, "high", f"a number above low = {self.low:g}")
        self._expect(self.low <= self.mode <= self.high, "mode", f"a number in [{self.low:g}, {self.high:g}]")

    def frozen(self) -> Any:
        from scipy.stats import triang

        width = self.high - self.low
        return triang((self.mode - self.low) / width, self.low, width)


class TruncatedNormal(Distribution):
    """Normal distribution of which only the part between low and high occurs; mean and sd are of the whole normal.

    >>> TruncatedNormal(mean=0.35, sd=0.1, low=0.0).support
    (0.0, inf)
    """

    mean: float = parameter("", meaning="mean before truncation")
    sd: float = parameter("", 0.0, low_open=True, meaning="standard deviation before truncation")
    low: float | None = parameter("", default=None, optional=True, meaning="least value; left out, none")
    high: float | None = parameter("", default=None, optional=True, meaning="largest value; left out, none")

    def __post_init__(self) -> None:
        super().__post_init__()
        self._scalars()
        self._expect(self._ends[0] < self._ends[1], "high", f"a number above low = {self._ends[0]:g}")

    @property
    def _ends(self) -> tuple[float, float]:
        return (-np.inf if self.low is None else self.low, np.inf if self.high is None else self.high)

    def frozen(self) -> Any:
        from scipy.stats import truncnorm

        low, high = ((end - self.mean) / self.sd for end in self._ends)
        return truncnorm(low, high, self.mean, self.sd)


class Beta(Distribution):
    """Beta distribution between low and high, density proportional to (x - low)^(a - 1) (high - x)^(b - 1).

    >>> round(Beta(low=0.0, high=1.0, a=2.0, b=6.0).average, 12)
    0.25
    """

    low: float = parameter("", meaning="least value")
    high: float = parameter("", meaning="largest value")
    a: float = parameter("-", 0.0, low_open=True, meaning="shape at the low end")
    b: float = parameter("-", 0.0, low_open=True, meaning="shape at the high end")

    def __post_init__(self) -> None:
        super().__post_init__()
        self._scalars()
        self._expect(self.low < self.high, "high", f"a number above low = {self.low:g}")

    def frozen(self) -> Any:
        from scipy.stats import beta

        return beta(self.a, self.b, self.low, self.high - self.low)


class ScipyDistribution(Distribution):
    """Any distribution of `scipy.stats` by its name there, with its shapes, location and scale.

    >>> float(ScipyDistribution("gumbel_r", loc=0.3, scale=0.02).support[1])
    inf
    """

    name: str
    shapes: Any = parameter("-", default=(), meaning="shape parameters in scipy's order")
    loc: float = parameter("", default=0.0, meaning="location")
    scale: float = parameter("", 0.0, low_open=True, default=1.0, meaning="scale")

    def __post_init__(self) -> None:
        super().__post_init__()
        from scipy import stats

        found = getattr(stats, str(self.name), None)
        if not isinstance(found, stats.rv_continuous):
            known = [name for name, thing in vars(stats).items() if isinstance(thing, stats.rv_continuous)]
            raise ParameterError("ScipyDistribution", "name", self.name, _few(str(self.name), known))
        count = found.numargs
        self._expect(np.size(self.shapes) == count, "shapes", f"{count} numbers ({found.shapes or 'none'})")
        with np.errstate(all="ignore"):
            self._expect(bool(np.isfinite(self.frozen().ppf(0.5))), "shapes", f"numbers that {self.name} allows")

    def frozen(self) -> Any:
        from scipy import stats

        return getattr(stats, self.name)(*np.atleast_1d(self.shapes), loc=self.loc, scale=self.scale)


DISTRIBUTIONS: dict[str, type[Distribution]] = {
    "normal": Normal,
    "uniform": Uniform,
    "lognormal": Lognormal,
    "triangular": Triangular,
    "truncated_normal": TruncatedNormal,
    "beta": Beta,
    "scipy": ScipyDistribution,
}


def as_distribution(given: Any, name: str = "distribution") -> Distribution:
    """`given` as a distribution: one of this module, or a frozen continuous distribution of `scipy.stats`.

    Raises `ParameterError` that names the parameter for anything else.

    >>> from scipy.stats import weibull_min
    >>> as_distribution(weibull_min(2.0, scale=0.4)).name
    'weibull_min'
    """
    if isinstance(given, Distribution):
        return given
    if hasattr(given, "dist") and hasattr(given, "args") and hasattr(given, "kwds"):
        return _from_scipy(given, name)
    kinds = ", ".join(kind.__name__ for kind in DISTRIBUTIONS.values())
    raise ParameterError("scatter", name, given, f"a distribution ({kinds}) or a frozen one of scipy.stats")


def _from_scipy(given: Any, name: str) -> ScipyDistribution:
    from scipy import stats

    kind: Any = given.dist
    if not isinstance(kind, stats.rv_continuous):
        raise ParameterError("scatter", name, kind, "a continuous distribution: parameters are real numbers")
    known: Any = getattr(stats, str(kind.name), None)
    if type(kind) is not type(known):
        raise ParameterError("scatter", name, kind.name, "a distribution that scipy.stats itself has")
    shapes = [shape.strip() for shape in (kind.shapes or "").split(",") if shape.strip()]
    words = {"loc": 0.0, "scale": 1.0, **dict(zip([*shapes, "loc", "scale"], given.args, strict=False)), **given.kwds}
    values = [float(words[shape]) for shape in shapes]
    return ScipyDistribution(str(kind.name), values, float(words["loc"]), float(words["scale"]))


def _few(given: str, names: list[str]) -> str:
    return known_names(given, names).partition("one of")[0] + "a continuous distribution of scipy.stats"

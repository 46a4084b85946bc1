"""Why steady sliding is lost: how much of the growth rate the circulatory and the damping part of friction each bring.

Split the linearised system into a passive base and the two parts that can feed a vibration,

    K_eff = K_0 + K_feed           K_feed: circulatory, lets two modes merge: flutter
    C_eff = C_0 + C_rest           C_rest: friction that changes with speed, and negative dampers: negative slope

with K_0 the symmetric part of K_eff, so that K_feed is its skew part, and C_0 the structure's own damping less negative
dampers; gyroscopic terms, which do no work, stay in C_0. Where friction makes the symmetric part of K_eff indefinite,
it would diverge without the skew part that holds it and is no passive base; K_0 is then the symmetric part of the
structure's own K, and friction's stiffness -mu sgn(V) d n' is switched on whole. Growth is not a sum over
parts, because each changes the modes on which the other acts. So both are switched on together, K_0 + s K_feed and
C_0 + s C_rest for s = 0 ... 1, and each step of the growth rate is credited to the two parts by the mean over the two
orders of taking it. That gives

    growth rate = base + circulation + slope

exactly, without order or label (the Aumann-Shapley value of cost sharing). An unstable state is called by the share of
what feeds it: flutter or negative slope from 60 % on, mixed between or where no part alone feeds it, divergence only
where the growing eigenvalue is real. Friction that does not change with speed leaves C_rest = 0: never negative slope.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from squealbox.arguments import public
from squealbox.fe import ReducedBrake, Small
from squealbox.stability.eigenvalues import MARGINAL
from squealbox.stability.family import Steady, entry, steady_sliding
from squealbox.stability.in_band import IDLE, eigenvalues_in_band, ranked_in_band, worst_in_band
from squealbox.stability.spectra import Engine, compiled, growth_of_parts, largest_growth
from squealbox.stability.state_matrix import spectrum
from squealbox.system import DesignOrSystem, Linearised

NAMES = ("stable", "flutter", "negative_slope", "divergence", "mixed")
STABLE, FLUTTER, NEGATIVE_SLOPE, DIVERGENCE, MIXED, UNKNOWN = 0, 1, 2, 3, 4, -1
DOMINANT = 0.6  # share from which one part gives the name: three to two
STATIC = 1e-9  # |Im lambda| below this share of the largest |lambda| is no oscillation
ROUND_OFF = 1e-13  # negative eigenvalues of C below this share of the largest are no negative damper
STEPS = 8  # of s; shares change by about 1 % from 8 to 256


@dataclass(frozen=True)
class Mechanism:
    """How one mode loses its stability: a name and the terms of its growth rate [1/s] (module's head)."""

    name: str
    base: float
    circulation: float
    slope: float

    @property
    def flutter_share(self) -> float:
        """Share of circulation in what feeds the mode, 0 to 1; NaN when nothing does."""
        return float(share(self.circulation, self.slope))

    @property
    def negative_slope_share(self) -> float:
        """Share of the damping part of friction in what feeds the mode, 0 to 1; NaN when nothing does."""
        return 1.0 - self.flutter_share

    def __str__(self) -> str:
        if self.name in ("stable", "divergence", "unknown") or not np.isfinite(self.flutter_share):
            return self.name
        parts = {"flutter": self.flutter_share, "negative slope": self.negative_slope_share}
        shares = ", ".join(f"{name} {100.0 * share:.0f} %" for name, share in parts.items())
        return f"{self.name.replace('_', ' ')} ({shares})"


def share(circulation: float | np.ndarray, slope: float | np.ndarray) -> Any:
    """circulation+ / (circulation+ + slope+), NaN where both are negative."""
    feeding, weakening = np.maximum(circulation, 0.0), np.maximum(slope, 0.0)
    with np.errstate(invalid="ignore", divide="ignore"):
        return feeding / (feeding + weakening)


def contributions(
    steady: Steady,
    *,
    rank: int = 0,
    steps: int = STEPS,
    engine: Engine = "auto",
    band: tuple[float, float] | None = None,
) -> tuple[Any, Any, Any]:
    """Base, circulation and slope [1/s], (...) each: the terms of the `rank`-th largest growth rate.

    Of one reduced brake, of those in its band [Hz].
    """
    base_stiffness = passive_stiffness(steady)
    coupling = steady.K - base_stiffness
    passive = steady.structural - negative_part(0.5 * (steady.structural + np.swapaxes(steady.structural, -1, -2)))
    rest = steady.C - passive

    def plain(x: float, y: float) -> Any:
        if band is not None:
            return ranked_in_band(Small(steady.M, passive + y * rest, base_stiffness + x * coupling), band, rank)
        part = Linearised(steady.M, passive + y * rest, base_stiffness + x * coupling, steady.equilibrium)
        return ranked_growth(part, rank, engine)

    fast = rank == 0 and steady.K.shape[-1] == 2 and compiled(steady, engine)
    growth = growth_of_parts(steady, passive, base_stiffness) if fast else plain
    base = before = growth(0.0, 0.0)
    circulation, slope = np.zeros(base.shape), np.zeros(base.shape)
    if not np.any(rest):  # one part alone: its steps add up to the whole
        return base, growth(1.0, 1.0) - base, slope
    ends = [(i / steps, (i + 1) / steps) for i in range(steps)]
    places = [place for low, high in ends for place in ((high, high), (high, low), (low, high))]
    if steady.K.ndim == 2 and band is None:  # one system: all its steps in one batch
        batch = entry(entry(steady, (None,)), np.zeros(len(places), dtype=int))
        x, y = (np.array(side)[:, None, None] for side in zip(*places, strict=True))
        part = Linearised(batch.M, passive + y * rest, base_stiffness + x * coupling, batch.equilibrium)
        grown = iter(ranked_growth(part, rank, engine))
    else:
        grown = (growth(x, y) for x, y in places)
    for after, first, second in zip(grown, grown, grown, strict=True):
        circulation = circulation + 0.5 * (first - before + after - second)
        slope = slope + 0.5 * (second - before + after - first)
        before = after
    return base, circulation, slope


def ranked_growth(about: Linearised, rank: int, engine: Engine = "auto") -> Any:
    """The `rank`-th largest growth rate [1/s] among the n modes (conjugates counted once), (...)."""
    if rank == 0:
        return largest_growth(about, engine)[0]
    values = spectrum(about)
    values = values[..., : values.shape[-1] // 2]
    rigid = (values == 0.0) & (np.asarray(about.equilibrium.floating)[..., None] > 0)
    return -np.sort(np.where(rigid, np.inf, -values.real), axis=-1)[..., rank]


def mechanism_codes(
    growth: float | np.ndarray,
    angular_frequency: float | np.ndarray,
    circulation: float | np.ndarray,
    slope: float | np.ndarray,
    scale: float | np.ndarray,
) -> Any:
    """Codes into `NAMES`: 0 stable, 1 flutter, 2 negative slope, 3 divergence, 4 mixed; -1 without a spectrum."""
    flutter = share(circulation, slope)
    conditions = [
        ~np.isfinite(growth),
        growth <= MARGINAL * scale,
        angular_frequency <= STATIC * scale,
        flutter >= DOMINANT,
        flutter <= 1.0 - DOMINANT,
    ]
    return np.select(conditions, [UNKNOWN, STABLE, DIVERGENCE, FLUTTER, NEGATIVE_SLOPE], MIXED).astype(np.int8)


def mechanism_at(
    steady: Steady,
    angular_frequency: float,
    *,
    rank: int = 0,
    steps: int = STEPS,
    band: tuple[float, float] | None = None,
) -> Mechanism:
    """The mechanism by which the `rank`-th mode of one system grows, also at the onset where it only just does.

    Of a reduced brake, the `rank`-th of its band [Hz].
    """
    if not np.all(np.isfinite(steady.structural)):  # held between samples, no part of the matrices is friction's
        return Mechanism("unknown", *(float("nan"),) * 3)
    parts = contributions(steady, rank=rank, steps=steps, engine="numpy", band=band)
    base, circulation, slope = (float(x) for x in parts)
    scale = angular_frequency if band is not None else float(np.nanmax(np.abs(spectrum(steady)), initial=0.0))
    code = mechanism_codes(np.float64(scale), np.float64(angular_frequency), circulation, slope, scale)
    return Mechanism(NAMES[int(code)], base, circulation, slope)


@public()
def mechanism(design_or_system: DesignOrSystem, time: float = 0.0) -> Mechanism:
    """Why one system is unstable at `time` [s]; "stable" when it is not, "unknown" without steady sliding.

    Under sampled loops it is "unknown" too: of what is held between samples no part is friction's.

    >>> from squealbox.system import System
    >>> coupled = System(M=[[1.0, 0.0], [0.0, 1.0]], C=[[0.0] * 2] * 2, K=[[2.0, 1.0], [-1.0, 2.0]])
    >>> mechanism(coupled).name
    'flutter'
    """
    steady = steady_sliding(design_or_system, time)
    if steady.K.ndim > 2:
        raise ValueError(f"leading axes {steady.K.shape[:-2]}: mechanism() is for one system, stability_map() for many")
    band = None
    if isinstance(design_or_system, ReducedBrake):
        band = design_or_system.band
        growth, omega, _ = worst_in_band(eigenvalues_in_band(design_or_system, time))
    else:
        growth, omega, _ = (float(x) for x in largest_growth(steady, "numpy"))
    if not np.isfinite(growth):
        return Mechanism("unknown", *(float("nan"),) * 3)
    found = mechanism_at(steady, omega, band=band)
    idle = IDLE * omega if band is not None else MARGINAL * float(np.nanmax(np.abs(spectrum(steady)), initial=0.0))
    return found if growth > idle else Mechanism("stable", found.base, found.circulation, found.slope)


def passive_stiffness(steady: Steady) -> Any:
    """K_0 of the module's head, (..., n, n): the symmetric part of K_eff where positive definite, else of K alone."""
    symmetric = 0.5 * (steady.K + np.swapaxes(steady.K, -1, -2))
    if steady.K.shape[-1] == 2:
        a, b, d = symmetric[..., 0, 0], symmetric[..., 0, 1], symmetric[..., 1, 1]
        definite = (a > 0.0) & (a * d > b * b)
    else:
        known = np.all(np.isfinite(symmetric), axis=(-2, -1))
        least = np.linalg.eigvalsh(np.where(known[..., None, None], symmetric, 0.0))[..., 0]
        definite = known & (least > 0.0)
    return np.where(definite[..., None, None], symmetric, steady.elastic)


def negative_part(symmetric: np.ndarray) -> Any:
    """The negative semidefinite part of symmetric matrices (..., n, n); exactly zero where round-off alone is left."""
    diagonal = np.diagonal(symmetric, axis1=-2, axis2=-1)
    if np.all(symmetric == diagonal[..., None] * np.eye(symmetric.shape[-1])):
        return np.minimum(symmetric, 0.0)
    values, vectors = np.linalg.eigh(symmetric)
    values = np.where(values < -ROUND_OFF * np.max(np.abs(values), axis=-1, keepdims=True), values, 0.0)
    return (vectors * values[..., None, :]) @ np.swapaxes(vectors, -1, -2)

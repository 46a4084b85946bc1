"""The smallest push from steady sliding that ends in a vibration, over all directions, in the energy norm.

A push (dq, dq') has the energy of the mechanical system without its contacts,

    E = (dq'.M dq' + dq.K_s dq)/2 = |u|^2/2,    dq = L_K^-T u_q,  dq' = L_M^-T u_v

with K_s the symmetric part of K and L the Cholesky factors. In u all directions are alike. Along each of many
directions an ensemble finds the first length that vibrates; differential evolution (SciPy) lowers it over the
directions; then starts drawn uniformly from the ball |u| < |u*| look for a smaller one.

What is guaranteed: the push found vibrates (it was run). That none is smaller is not: what is known is how large a
share of all pushes of less energy is dangerous at most, by the count among those drawn, with a confidence of 95 %.
Source: Kerswell 2018, Annu. Rev. Fluid Mech. 50, 319-345 (minimal seeds); Storn and Price 1997, J. Global Optim. 11.
"""

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from squealbox.arguments import public
from squealbox.limit_cycles.attractors.attractor import Attractor, attractors
from squealbox.limit_cycles.attractors.basins import interval
from squealbox.limit_cycles.attractors.sections import state_names
from squealbox.limit_cycles.attractors.settling import RESTS, Batch, Scales, settle
from squealbox.limit_cycles.cycles.field import q_and_qd
from squealbox.limit_cycles.cycles.pinned import at_rest_together
from squealbox.parameters import ParameterError
from squealbox.result import COMPLETED, Array, Outcome, Result, quantity
from squealbox.system import DesignOrSystem, System
from squealbox.words import sizes_told

SECTIONS = (12, 8, 8)  # lengths tried at once between two, one round after the other
FINE = (12, 12, 12, 12)  # of the last search along one direction
LENGTHS = 16  # of the first look along each direction
STRETCHES = 4  # of a run; it counts as dangerous when it has not come to rest then
AGAIN = 2  # further searches when a drawn start proves smaller


@dataclass(frozen=True, kw_only=True, eq=False)
class DangerousPush(Result):
    """The smallest push found, as :func:`dangerous_push` returns it."""

    push: Array = quantity("state", "m", "displacements [m] and velocities [m/s] beside steady sliding")
    energy: Any = quantity("", "J", "its energy")
    harmless: Any = quantity("", "J", "energy in the same direction, just below, that still comes to rest")
    drawn: Any = quantity("", "1", "starts drawn uniformly from the pushes of less energy")
    dangerous: Any = quantity("", "1", "how many of them vibrate")
    share_below: Array = quantity("end", "1", "confidence interval, 95 %, of the share of them that is dangerous")
    history: Array = quantity("round", "J", "smallest energy after each round of the search")
    runs: Any = quantity("", "1", "motions run in all")
    to: Attractor | None = field(default=None, metadata={"transient": True})

    @property
    def system(self) -> System:
        """The system that is pushed."""
        system: System = self.inputs["system"]
        return system

    def summary(self) -> str:
        """Energy, push, what it leads to and what is known below it."""
        if not self.outcome.ok:
            return self.outcome.told
        units = (*self.system.units, *(f"{unit}/s" for unit in self.system.units))
        parts = sizes_told(state_names(self.system), self.push, units, 4)
        to = f", to: {self.to.summary(self.system)}" if self.to is not None else ""
        return (
            f"smallest push found: {float(self.energy):.4g} J ({parts}){to}\n"
            f"of all pushes of less energy at most {100 * self.share_below[1]:.2g} % vibrate (95 %: "
            f"{int(self.dangerous)} of {int(self.drawn)} drawn); {int(self.runs)} runs"
        )


@public()
def dangerous_push(
    design_or_system: DesignOrSystem,
    energies: tuple[float, float] | None = None,
    *,
    directions: int = 256,
    rounds: int = 15,
    drawn: int = 1000,
    duration: float | None = None,
    seed: int = 1,
    threads: int | None = None,
) -> DangerousPush:
    """The push of least energy from steady sliding that ends in a vibration.

    Parameters
    ----------
    design_or_system : a design or a `System` with constant loads and speeds, M and the symmetric part of K positive
        definite
    energies : (least, largest) [J] looked at; None takes the kinetic energy of the largest mass at 0.01 and 3 V
    directions : looked along first; rounds : of differential evolution; drawn : starts of the last check
    duration, seed, threads : as in :func:`basin`; duration in [s]

    Outcome "completed", "no_danger" (nothing looked at vibrates) or "no_sliding". Accuracy: 0.1 % in energy along the
    direction found; over directions as the module says. Source: as this module.

    >>> from squealbox import DrumBrake, LinearSlope
    >>> drum = DrumBrake(friction=LinearSlope(0.1, -0.05))
    >>> dangerous_push(drum, (1e-8, 1e-6), directions=4, rounds=1, drawn=4).outcome
    'no_danger'
    """
    search = _Search(at_rest_together(q_and_qd(design_or_system)), duration, threads)
    low, high = (np.sqrt(2.0 * e) for e in _energies(energies, search))
    if not np.all(np.isfinite(search.rest)):
        return _nothing(search, Outcome("no_sliding", "there is no steady sliding to push"))
    looked = _directions(search.size, directions, seed)
    first = search.first(looked, np.full(directions, low), np.full(directions, high), (LENGTHS,))
    if not np.any(np.isfinite(first)):
        message = f"none of {directions} directions vibrates up to {0.5 * high**2:.3g} J"
        return _nothing(search, Outcome("no_danger", message))
    best, history = looked[np.argmin(first)], [0.5 * float(np.min(first)) ** 2]
    for attempt in range(1 + AGAIN):
        best = _evolved(search, looked[np.argsort(first)], best, history, rounds, seed + attempt)
        length, below = search.edge(best, low, high)
        points = _ball(search.size, drawn, length, seed + 100 + attempt)
        hits = search.vibrates(points)
        if not np.any(hits):
            break
        best = points[hits][np.argmin(np.linalg.norm(points[hits], axis=1))]
        best = best / np.linalg.norm(best)
    history.append(0.5 * length**2)
    _, span = interval(int(np.sum(hits)), drawn)
    ends = search.settle(length * best[None])
    found, label = attractors(search.system, ends, True)
    return DangerousPush(
        inputs={"system": search.system}, settings={"seed": seed, "directions": directions, "rounds": rounds},
        outcome=Outcome(COMPLETED), push=search.state(length * best), energy=np.asarray(0.5 * length**2),
        harmless=np.asarray(0.5 * below**2), drawn=np.asarray(drawn), dangerous=np.asarray(int(np.sum(hits))),
        share_below=span, history=np.array(history), runs=np.asarray(search.runs),
        to=found[label[0]] if label[0] >= 0 else None,
    )  # fmt: skip


def push_along(
    design_or_system: DesignOrSystem, direction: ArrayLike, bounds: tuple[float, float], *,
    duration: float | None = None, threads: int | None = None,
) -> float:  # fmt: skip
    """The first multiple of `direction` between `bounds` that ends in a vibration; NaN if none does.

    Parameters
    ----------
    design_or_system, duration, threads : as in :func:`dangerous_push`; duration in [s]
    direction : the push that is multiplied, displacements and velocities, shape (2n,) [m, m/s]
    bounds : least and largest multiple looked at [-]

    Seen from below on 16 lengths, then refined between the two it lies between, to 1e-4 of their distance. A part of a
    folded basin narrower than that is missed.
    """
    search = _Search(at_rest_together(q_and_qd(design_or_system)), duration, threads)
    along = search.unit(np.asarray(direction, dtype=float))
    size = float(np.linalg.norm(along))
    if not size > 0.0:
        raise ParameterError("push_along", "direction", direction, "a direction that is not zero")
    ends = [np.array([size * bound]) for bound in bounds]
    length = float(search.first(along[None] / size, ends[0], ends[1], (LENGTHS, *FINE), even=True)[0])
    return length / size if np.isfinite(length) else float("nan")


class _Search:
    """Runs pushes u of one system from steady sliding, and counts them."""

    def __init__(self, system: System, duration: float | None, threads: int | None) -> None:
        self.system, self.batch, self.duration = system, Batch.over(system, threads=threads), duration
        scales = Scales.of(self.batch, 1)
        self.rest, self.speed, self.size, self.runs = scales.rest[0], float(scales.speed[0]), 2 * system.size, 0
        try:
            factors = [np.linalg.cholesky(0.5 * (x + x.T)) for x in (system.K, system.M)]
        except np.linalg.LinAlgError as error:
            raise ParameterError(
                "dangerous_push", "system", "K or M", "positive definite symmetric parts, to measure a push by energy"
            ) from error
        self.factors = factors

    def state(self, u: np.ndarray) -> Any:
        """(dq, dq') of pushes u (..., 2n)."""
        n = self.system.size
        halves = (u[..., :n], u[..., n:])
        parts = [np.linalg.solve(f.T, x[..., None])[..., 0] for f, x in zip(self.factors, halves, strict=True)]
        return np.concatenate(parts, axis=-1)

    def unit(self, state: np.ndarray) -> Any:
        """u of a push (dq, dq')."""
        n = self.system.size
        return np.concatenate([self.factors[0].T @ state[:n], self.factors[1].T @ state[n:]])

    def settle(self, u: np.ndarray) -> Any:
        """What pushes (k, 2n) settle to."""
        n, states = self.system.size, self.state(u)
        self.runs += len(u)
        return settle(self.batch, self.rest + states[:, :n], states[:, n:], duration=self.duration,
                      stretches=STRETCHES)  # fmt: skip

    def vibrates(self, u: np.ndarray) -> Any:
        """True where a push does not come to rest."""
        return self.settle(u).kind != RESTS

    def first(
        self, directions: np.ndarray, low: np.ndarray, high: np.ndarray, sections: tuple[int, ...], even: bool = False
    ) -> Any:
        """The first length between low and high (k,) at which each direction vibrates; inf where none does."""
        low, high = np.array(low, dtype=float), np.array(high, dtype=float)
        space = np.linspace if even else np.geomspace
        some = np.ones(len(directions), dtype=bool)
        for i, count in enumerate(sections):
            lengths = space(low, high, count + 1, axis=1)
            begin = 0 if i == 0 else 1  # later the lower end is known to come to rest and the upper to vibrate
            inside = lengths[:, begin : count + (i == 0)]
            hits = np.zeros(lengths.shape, dtype=bool)
            hits[:, begin : count + (i == 0)] = self.vibrates(
                (inside[..., None] * directions[:, None]).reshape(-1, self.size)
            ).reshape(inside.shape)
            hits[:, -1] |= i > 0
            some &= np.any(hits, axis=1)
            at = np.argmax(hits, axis=1)
            rows = np.arange(len(at))
            low, high = lengths[rows, np.maximum(at - 1, 0)], lengths[rows, at]
        return np.where(some, high, np.inf)

    def edge(self, direction: np.ndarray, low: float, high: float) -> tuple[float, float]:
        """Length at which a direction vibrates, and one just below at which it comes to rest."""
        length = float(self.first(direction[None], np.array([low]), np.array([high]), (2 * LENGTHS, *FINE))[0])
        return length, length / (high / low) ** (1.0 / (2 * LENGTHS * np.prod(FINE)))


def _evolved(
    search: _Search, looked: np.ndarray, best: np.ndarray, history: list[float], rounds: int, seed: int
) -> Any:
    """The best direction after some rounds of differential evolution that begins with the best ones looked at."""
    from scipy.optimize import differential_evolution

    reach = np.sqrt(2.0 * history[-1])

    def lengths(x: np.ndarray) -> Any:
        along = (x / np.linalg.norm(x, axis=0)).T
        count = len(along)
        found = search.first(along, np.full(count, 0.3 * reach), np.full(count, 1.5 * reach), SECTIONS)
        return np.where(np.isfinite(found), found, 3.0 * reach)

    def note(intermediate_result: Any) -> None:
        history.append(0.5 * float(intermediate_result.fun) ** 2)

    first = np.vstack([best, looked[: 6 * search.size - 1]])
    found = differential_evolution(
        lengths, [(-1.0, 1.0)] * search.size, maxiter=rounds, init=first, polish=False, vectorized=True,
        updating="deferred", rng=seed, tol=1e-3, callback=note,
    )  # fmt: skip
    return found.x / np.linalg.norm(found.x)


def _directions(size: int, count: int, seed: int) -> Any:
    """Directions spread evenly over the sphere."""
    from scipy.stats import norm, qmc

    power = int(np.ceil(np.log2(max(count, 2))))
    normal = norm.ppf(np.clip(qmc.Sobol(size, rng=seed).random_base2(power)[:count], 1e-12, 1.0 - 1e-12))
    return normal / np.linalg.norm(normal, axis=1, keepdims=True)


def _ball(size: int, count: int, radius: float, seed: int) -> Any:
    """Points uniform in a ball."""
    rng = np.random.default_rng(seed)
    normal = rng.standard_normal((count, size))
    share = rng.random((count, 1)) ** (1.0 / size)
    return radius * share * normal / np.linalg.norm(normal, axis=1, keepdims=True)


def _energies(given: tuple[float, float] | None, search: _Search) -> tuple[float, float]:
    if given is None:
        mass = float(np.max(np.linalg.eigvalsh(0.5 * (search.system.M + search.system.M.T))))
        return 0.5 * mass * (0.01 * search.speed) ** 2, 0.5 * mass * (3.0 * search.speed) ** 2
    low, high = (float(e) for e in given)
    if not 0.0 < low < high < np.inf:
        raise ParameterError("dangerous_push", "energies", given, "0 < least < largest, in J")
    return low, high


def _nothing(search: _Search, outcome: Outcome) -> DangerousPush:
    none = np.asarray(np.nan)
    zero = np.asarray(0)
    return DangerousPush(inputs={"system": search.system}, outcome=outcome, push=np.full(search.size, np.nan),
                         energy=none, harmless=none, drawn=zero, dangerous=zero, share_below=np.full(2, np.nan),
                         history=np.zeros(0), runs=np.asarray(search.runs))  # fmt: skip

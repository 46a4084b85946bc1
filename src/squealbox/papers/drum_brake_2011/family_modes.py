"""The modes of thousands of members of the family at once, and how many of the eight claims about them each meets.

With K_eff = [[a, b], [c, d]], b = k12 and c = k21 affine in mu and alpha V, and C = diag(c11, c22) affine in the load
N, the undamped modes are q = (a + d)/2 -+ sqrt(((a - d)/2)^2 + b c), and to the first order in damping

    p_lower = (c11 (d - q1) + c22 (a - q1))/(q2 - q1),    p_upper = c11 + c22 - p_lower

which is affine in N as well. Stability in mu is decided exactly, by the criterion of Routh and Hurwitz.
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from squealbox.designs import DrumBrake
from squealbox.papers.drum_brake_2011.cases import FRICTION, LOAD, RESOLUTION
from squealbox.papers.drum_brake_2011.claims import claims
from squealbox.papers.drum_brake_2011.family import SHARES, SIGNS, TriedValues, share_of_load

BRAKE = DrumBrake(reading="eq1_printed")
BISECTIONS = 14  # of the 0.5 in which an onset is looked for: to 3e-5
LOWEST, HIGHEST = 0.10, 0.60
CLAIMS = ("mu-1", "mu-2", "mu-3", "mu-4", "mu-5", "mu-6", "N-1", "N-2")


@dataclass(frozen=True)
class Numbers:
    """What eight claims say: onset, frequencies at mu = 0.1, distance just below the onset, and so on [SI units].

    `at_onset` is the frequency at the onset, `beyond` that at 0.10 above it, `at_load` the two at 15 kN and mu = 0.3;
    `lower_grows` says which of them grows, and `load` where instability begins.
    """

    onset: float
    at_low: tuple[float, float]
    distance: float
    at_onset: float
    beyond: float
    load: float
    at_load: tuple[float, float]
    lower_grows: bool


@dataclass(frozen=True)
class Stiffness:
    """A K_eff by its numbers; arrays over members. `b` and `c` at mu = 0, and what mu takes off them."""

    b: Any
    c: Any
    along_b: Any
    along_c: Any

    def at(self, mu: float | np.ndarray) -> tuple[Any, Any]:
        """K12 and k21."""
        return self.b - mu * self.along_b, self.c - mu * self.along_c


def published() -> Numbers:
    """The numbers of the paper, as claims.toml has them."""
    given = {part.key: part.published for claim in claims() for part in claim.parts if part.published is not True}
    value = {key: float(digits) for key, digits in given.items()}
    return Numbers(
        onset=value["mu-2.onset"],
        at_low=(value["mu-3.lower"], value["mu-3.upper"]),
        distance=value["mu-4.separation"],
        at_onset=value["mu-5.frequency"],
        beyond=value["mu-6.frequency"],
        load=1e3 * value["N-1.onset"],
        at_load=(value["N-2.lower"], value["N-2.upper"]),
        lower_grows=True,
    )


def scrambled(count: int, seed: int = 2011) -> list[Numbers]:
    """Sets of numbers that a paper could have printed instead, for the same brake.

    The onset is drawn from 0.25 to 0.55 in steps of 0.01 and the load from 5 to 25 kN in steps of 5; frequencies at 0.1
    and 0.3 keep the published mean square, their distances fall from that at rest to that at the onset; the distance
    before the onset is 150 to 1500 rad/s, the frequencies at and beyond the onset lie within 400 and 900 rad/s of the
    mean. Which mode grows is a coin's throw.
    """
    draw = np.random.default_rng(seed)
    base = published()
    sets = []
    for _ in range(count):
        onset = float(draw.integers(25, 56)) / 100.0
        mean = float(np.sqrt(0.5 * sum(w**2 for w in base.at_low)))
        rest = 3700.0  # rad/s apart at mu = 0
        first = rest * float(draw.uniform(0.6, 1.0))
        second = first * float(draw.uniform(0.3, 0.9))
        sets.append(
            Numbers(
                onset=onset,
                at_low=_pair(mean, first),
                distance=float(draw.uniform(150.0, 1500.0)),
                at_onset=mean + float(draw.uniform(-400.0, 400.0)),
                beyond=mean + float(draw.uniform(-900.0, 900.0)),
                load=5e3 * float(draw.integers(1, 6)),
                at_load=_pair(float(np.sqrt(0.5 * sum(w**2 for w in base.at_load))), second),
                lower_grows=bool(draw.integers(0, 2)),
            )
        )
    return sets


def stacked(sets: list[Numbers]) -> Numbers:
    """Many sets of numbers as one, whose values are arrays (sets, 1)."""

    def column(name: str) -> Any:
        values = np.array([getattr(each, name) for each in sets])
        return values[:, None] if values.ndim == 1 else tuple(values.T[..., None])

    return Numbers(**{each.name: column(each.name) for each in fields(Numbers)})


def _pair(mean: float, apart: float) -> tuple[float, float]:
    """Two frequencies this far apart with this mean of their squares."""
    middle = np.sqrt(mean**2 - 0.25 * apart**2)
    return float(middle - 0.5 * apart), float(middle + 0.5 * apart)


class Members:
    """All members with one choice of front and belts, arrays (loads, shares, alpha, alpha V)."""

    def __init__(self, front: int, belts: int, grid: TriedValues) -> None:
        signs, belt = SIGNS[front], SIGNS[belts]
        s1, c1, s2, c2 = (float(each) for each in BRAKE.directions)
        self.weights = (c1**2, c2**2, s1**2, s2**2)
        matrix = BRAKE.system().K
        self.a, self.d = float(matrix[0, 0]), float(matrix[1, 1])
        cross = float(matrix[0, 1])
        self.grid, self.signs = grid, signs
        self.alpha = np.array(grid.alpha)[:, None]
        lost = np.array(grid.product)[None, :]
        springs = (BRAKE.k3, BRAKE.k4, BRAKE.k3, BRAKE.k4)
        self.n = [float(k * w) for k, w in zip(springs, self.weights, strict=True)]
        self.way = [f * b for f, b in zip(signs, belt, strict=True)]
        self.lost = [np.sqrt(w) * lost for w in self.weights]  # alpha |V_i|
        w, n, lost_b = self.way, self.n, self.lost
        self.stiffness = Stiffness(
            cross + w[0] * n[0] * lost_b[0] + w[1] * n[1] * lost_b[1],
            cross + w[2] * n[2] * lost_b[2] + w[3] * n[3] * lost_b[3],
            w[0] * n[0] + w[1] * n[1],
            w[2] * n[2] + w[3] * n[3],
        )
        loads = [np.array([sign[i] for sign in SIGNS])[:, None, None, None] for i in range(4)]
        self.force = (loads[0] * s1 + loads[2] * s2, loads[1] * c1 + loads[3] * c2)
        shares = [share_of_load(i, signs, self.weights) for i in range(len(SHARES))]
        self.preload = [np.array([signs[i] * share[i] for share in shares])[None, :, None, None] for i in range(4)]

    def damping(self, mu: float | np.ndarray) -> tuple[Any, Any]:
        """What a newton of load takes off c11 and c22, at the static deflection of that newton."""
        b, c = self.stiffness.at(mu)
        way = [w / s for w, s in zip(self.way, self.signs, strict=True)]  # the belts
        push = [way[i] * (mu - self.lost[i]) * self.preload[i] for i in range(4)]
        fx, fy = self.force[0] + push[0] + push[1], self.force[1] + push[2] + push[3]
        determinant = self.a * self.d - b * c
        x, y = (self.d * fx - b * fy) / determinant, (self.a * fy - c * fx) / determinant
        pressed = [self.signs[i] * self.n[i] * (y if i < 2 else x) + self.preload[i] for i in range(4)]
        return self.alpha * (pressed[0] + pressed[1]), self.alpha * (pressed[2] + pressed[3])

    def unstable(self, mu: float | np.ndarray) -> Any:
        """True where steady sliding at the table's load is unstable, by Routh and Hurwitz."""
        b, c = self.stiffness.at(mu)
        first, second = self.damping(mu)
        c11, c22 = BRAKE.c1 - LOAD * first, BRAKE.c2 - LOAD * second
        sum_, middle, last = c11 + c22, self.a + self.d + c11 * c22, c11 * self.d + c22 * self.a
        end = self.a * self.d - b * c
        stable = (sum_ > 0) & (last > 0) & (end > 0) & (sum_ * middle * last > last**2 + sum_**2 * end)
        return ~stable

    def onset(self) -> Any:
        """The friction coefficient that makes sliding unstable: 0 where it is at 0.10, infinite where not at 0.60."""
        shape = (len(SIGNS), len(SHARES), len(self.grid.alpha), len(self.grid.product))
        low, high = np.full(shape, LOWEST), np.full(shape, HIGHEST)
        never, always = ~self.unstable(high), self.unstable(low)
        for _ in range(BISECTIONS):
            middle = 0.5 * (low + high)
            beyond = self.unstable(middle)
            high, low = np.where(beyond, middle, high), np.where(beyond, low, middle)
        return np.where(always, 0.0, np.where(never, np.inf, 0.5 * (low + high)))

    def frequencies(self, mu: float | np.ndarray) -> tuple[Any, Any]:
        """The two frequencies [rad/s] without damping; equal where they have met, shape (1, alpha V)."""
        b, c = self.stiffness.at(mu)
        mean, apart = 0.5 * (self.a + self.d), np.sqrt((0.25 * (self.a - self.d) ** 2 + b * c).astype(complex))
        lower, upper = np.sqrt(mean - apart), np.sqrt(mean + apart)
        return np.abs(lower.real), np.abs(upper.real)

    def decay(self) -> tuple[Any, Any, Any, Any]:
        """P of both modes without load and what a newton takes off them, at mu = 0.3; not a number past flutter."""
        b, c = self.stiffness.at(FRICTION)
        root = 0.25 * (self.a - self.d) ** 2 + b * c
        half = np.sqrt(np.where(root > 0.0, root, np.nan))
        low = 0.5 * (self.a + self.d) - half
        shares = (self.d - low) / (2.0 * half), (self.a - low) / (2.0 * half)
        first, second = self.damping(FRICTION)
        at_rest = BRAKE.c1 * shares[0] + BRAKE.c2 * shares[1]
        taken = first * shares[0] + second * shares[1]
        return at_rest, taken, BRAKE.c1 + BRAKE.c2 - at_rest, first + second - taken


@dataclass(frozen=True)
class MembersFound:
    """What the members do, to be compared with any set of numbers."""

    members: Members
    onset: Any
    critical_load: Any
    rates: tuple[Any, Any]
    difference: Any

    @classmethod
    def of(cls, members: Members) -> "MembersFound":
        """All that does not depend on the numbers asked for."""
        lower, taken_lower, upper, taken_upper = members.decay()
        with np.errstate(divide="ignore", invalid="ignore"):
            loads = [np.where(t > 0.0, r / t, np.inf) for r, t in ((lower, taken_lower), (upper, taken_upper))]
        critical = np.where(np.isnan(taken_lower), np.nan, np.minimum(*loads))
        rates = (taken_lower * 15e3 - lower, taken_upper * 15e3 - upper)
        first, second = members.damping(0.40)
        difference = BRAKE.c2 - BRAKE.c1 - LOAD * (second - first)
        return cls(members, members.onset(), critical, rates, difference)

    def met(self, wanted: Numbers, only: Iterable[str] = CLAIMS) -> dict[str, Any]:
        """For each claim the members that meet it, by the tolerances of claims.toml.

        `wanted` may hold arrays (sets, 1) where there is one alpha: the answer then has the sets in its place.
        """
        get = self.members.frequencies
        upper_leads = self.difference > 0.0  # the lemma of theorems.which_mode_decays_more

        def close(pair: tuple[Any, Any], numbers: tuple[float, float]) -> Any:
            return (np.abs(pair[0] - numbers[0]) <= RESOLUTION) & (np.abs(pair[1] - numbers[1]) <= RESOLUTION)

        def leading(pair: tuple[Any, Any], number: float) -> Any:
            return np.abs(np.where(upper_leads, pair[1], pair[0]) - number) <= RESOLUTION

        def apart(mu: float | np.ndarray) -> Any:
            lower, upper = get(mu)
            return upper - lower

        def growing() -> Any:
            lower, upper = (rate > 0.0 for rate in self.rates)
            falling = [rate < 0.0 for rate in self.rates]
            return np.where(wanted.lower_grows, lower & falling[1], upper & falling[0])

        before = wanted.onset - 0.01
        rules: dict[str, Callable[[], Any]] = {
            "mu-1": lambda: self.onset > before,
            "mu-2": lambda: (self.onset > before) & (self.onset <= wanted.onset + 0.005),
            "mu-3": lambda: close(get(0.10), wanted.at_low),
            "mu-4": lambda: np.abs(apart(before) - wanted.distance) <= np.sqrt(2.0) * RESOLUTION,
            "mu-5": lambda: (apart(wanted.onset) < RESOLUTION) & leading(get(wanted.onset), wanted.at_onset),
            "mu-6": lambda: leading(get(wanted.onset + 0.10), wanted.beyond),
            "N-1": lambda: (self.critical_load >= wanted.load - 5e3) & (self.critical_load <= wanted.load),
            "N-2": lambda: close(get(FRICTION), wanted.at_load) & growing(),
        }
        return {name: rules[name]() for name in only}

    def score(self, wanted: Numbers) -> Any:
        """How many of the eight claims each member meets, shape (loads, shares, alpha, alpha V)."""
        return sum(each.astype(np.int8) + np.zeros(self.onset.shape, np.int8) for each in self.met(wanted).values())

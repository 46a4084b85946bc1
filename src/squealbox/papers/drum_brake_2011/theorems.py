"""What no reading of the paper can meet, whatever its equations: four small theorems with proof.

Notation for x'' + C x' + K x = 0 with two degrees of freedom and m = 1 kg: the characteristic polynomial is
(s^2 + p1 s + q1)(s^2 + p2 s + q2), so a mode has the decay rate p/2 and the frequency w with w^2 = q - p^2/4. Comparing
coefficients, with C = diag(c11, c22), K = [[a, b], [c, d]],

    p1 + p2 = c11 + c22                   q1 + q2 + p1 p2 = a + d + c11 c22
    p1 q2 + p2 q1 = c11 d + c22 a         q1 q2 = a d - b c

Published numbers enter with the tolerance their claims are judged by: 126 rad/s, what a window of 0.05 s resolves.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from squealbox.designs import DrumBrake
from squealbox.papers.drum_brake_2011.cases import RESOLUTION

FREQUENCIES = {0.10: (11240.0, 14570.0), 0.30: (11790.0, 14060.0), 0.40: (13140.0, 13140.0), 0.50: (12190.0, 12190.0)}
"""Published frequencies [rad/s] over mu: mu-3, N-2, mu-5, mu-6."""
PUBLISHED_ONSET = 0.40


@dataclass(frozen=True)
class Band:
    """The least and greatest value a quantity can have."""

    low: float
    high: float

    def apart_from(self, other: "Band") -> bool:
        """True where no value is in both."""
        return self.high < other.low or other.high < self.low


def published_trace(mu: float, tolerance: float = RESOLUTION) -> Band:
    """w1^2 + w2^2 [rad^2/s^2] of the published frequencies at `mu`, each of them known to `tolerance` [rad/s].

    >>> published_trace(0.50, 0.0).low
    297192200.0
    """
    first, second = FREQUENCIES[mu]
    return Band(*(sum((w + sign * tolerance) ** 2 for w in (first, second)) for sign in (-1.0, 1.0)))


def trace_line(known: dict[float, Band], mu: float) -> Band:
    """What w1^2 + w2^2 can be at `mu` where friction enters linearly and it is known at two other coefficients.

    Theorem. Let K_eff = K - mu F with any matrix F. Then the trace T(mu) = tr K - mu tr F is linear in mu, so two
    values give every other one; and w1^2 + w2^2 is T up to damping, which cannot lower it where the modes have met:

        w1^2 + w2^2 = T + c11 c22 - p1 p2 - (p1^2 + p2^2)/4 = T - (c11 - c22)^2/4 - p1 p2/2

    (with p1 + p2 = c11 + c22), and p1 p2 <= 0 for one mode that grows and one that decays. (c11 - c22)^2/4 is 9 with
    the table's damping, beside 3e8. Hence the frequencies at mu = 0.1 (mu-3) with those at 0.3 (N-2) or at 0.4 (mu-5)
    bound the one at 0.5 (mu-6) from below, and the published 12190 rad/s lies under the bound: not both.

    A law quadratic in mu, K_eff = K - mu F - mu^2 G, has T quadratic in mu and escapes.

    `known` has two entries. The trace at `mu` is an affine function of both, so its extremes are at their ends.
    """
    (first, a), (second, b) = known.items()
    share = (mu - first) / (second - first)
    ends = [(1.0 - share) * p + share * q for p in (a.low, a.high) for q in (b.low, b.high)]
    return Band(min(ends), max(ends))


def table_trace() -> Band:
    """T at mu = 0: the trace of the table's stiffness over its mass, k1 + k2 + k3 + k4, at any centres of pressure."""
    brake = DrumBrake()
    value = float((brake.k1 + brake.k2 + brake.k3 + brake.k4) / brake.m)
    return Band(value, value)


def trace_bounds() -> dict[str, Band]:
    """What T(0.5) can be, by the two numbers that give it; and, as "mu-6", what 12190 rad/s asks for."""
    at = {mu: published_trace(mu) for mu in FREQUENCIES}
    return {
        "mu-3 and N-2": trace_line({0.10: at[0.10], 0.30: at[0.30]}, 0.50),
        "table and mu-3": trace_line({0.0: table_trace(), 0.10: at[0.10]}, 0.50),
        "table and mu-5": trace_line({0.0: table_trace(), 0.40: at[0.40]}, 0.50),
        "mu-6": at[0.50],
    }


def which_mode_decays_more(difference: np.ndarray, a: float, d: float) -> Any:
    """The sign of p_upper - p_lower: which of two modes is damped more, by the difference c22 - c11 of the damping.

    Lemma. From the four equations of this module, with D = c22 - c11, E = p_lower - p_upper and S = c11 + c22,

        D ((a - d) + S D/4) = E ((q_upper - q_lower) + S E/4)

    (put S for p1 + p2 and the second equation into p_lower (q_upper - q_lower) = c11 (d - q_lower)
    + c22 (a - q_lower)).
    The terms with S are the square of damping beside stiffness, 1e5 beside 1e6 and more. So E has the sign of (a - d)
    D: with a > d, the lower mode decays more exactly where c22 > c11.
    """
    return -np.sign(difference) * np.sign(a - d)


def stiffness_diagonal() -> tuple[float, float]:
    """k11 and k22 [N/m] of the paper's table: 1.719e8 and 1.651e8."""
    stiffness = DrumBrake(reading="eq1_printed").system().K
    return float(stiffness[0, 0]), float(stiffness[1, 1])


def growing_mode_at_onset() -> str:
    """Which of the two nearly merged modes has to grow at mu = 0.40 for mu-5: "upper", "lower" or "either".

    In the form of Eq. (3) friction has no diagonal, so the mean of the squared frequencies stays that of the table, a
    frequency of 12981 rad/s. 13140 - 126 is above it, so of two modes within 126 rad/s it can only be the upper one.
    """
    middle = float(np.sqrt(0.5 * table_trace().low))
    published = FREQUENCIES[0.40][0]
    if published - RESOLUTION > middle:
        return "upper"
    return "lower" if published + RESOLUTION < middle else "either"


def damping_difference(
    at_low: float | np.ndarray, load: float | np.ndarray, c1: float | None = None, c2: float | None = None
) -> Any:
    """C22 - c11 [N s/m] at `load` [N], given what it is `at_low`, at the table's 1 kN.

    Theorem (mu-5 and N-2 exclude each other in the form of Eq. (3)). There c11 and c22 are the table's c1 and c2 plus
    something in proportion to N, so D(N) = (c2 - c1) + N D' and

        D(15 kN) = 15 D(1 kN) + 14 (c1 - c2) = 15 D(1 kN) + 84 N s/m

    mu-5 needs the upper of two modes to decay less at 1 kN (`growing_mode_at_onset`), N-2 the lower one at 15 kN. By
    the lemma (`which_mode_decays_more`), with k11 > k22, that is D(1 kN) > 0 and D(15 kN) < 0: impossible, because c1 >
    c2. A brake with c1 and c2 exchanged escapes. So does friction that is not free of a diagonal, or a static
    compression that varies with mu; of the latter kind the search in this package finds none.
    """
    brake = DrumBrake()
    zero = float((brake.c2 if c2 is None else c2) - (brake.c1 if c1 is None else c1))
    return zero + (at_low - zero) * load / brake.load1


def least_decay(at_rest: ArrayLike, at_ten: ArrayLike, load: float) -> Any:
    """The decay rate [1/s] of a mode at `load` [N] in (0, 10 kN), from those without load and at 10 kN.

    Theorem (V-1 and N-1 exclude each other at one speed). In Eq. (3) load enters the damping only, in proportion. To
    the first order in damping a mode decays with p = (c11 (d - q1) + c22 (a - q1))/(q2 - q1), which is then affine in
    N: a mode that decays at 10 kN (N-1) decays at 1 kN with at least 9/10 of what it has without load, 0.9 x 107 1/s.
    V-1 asks for no decay there. Speed enters steady sliding through alpha V only; within the studied speeds it shifts
    these rates by less than 1 1/s, because flutter is far (mu-1). A friction coefficient just below the onset of
    flutter, with hardly any decay left without load, escapes.
    """
    share = load / 10e3
    return (1.0 - share) * np.asarray(at_rest) + share * np.asarray(at_ten)


def squared_split(mu: float) -> float:
    """(w2^2 - w1^2)^2 [rad^4/s^4] of the published frequencies at `mu`."""
    first, second = FREQUENCIES[mu]
    return (second**2 - first**2) ** 2


def table_split() -> float:
    """(w2^2 - w1^2)^2 of the table at mu = 0: (a - d)^2 + 4 b c."""
    stiffness = DrumBrake(reading="eq1_printed").system().K
    return float((stiffness[0, 0] - stiffness[1, 1]) ** 2 + 4.0 * stiffness[0, 1] * stiffness[1, 0])


def onset_from_frequencies(
    first: float | None = None, second: float | None = None, third: float | None = None
) -> float:
    """The friction coefficient at which the published frequencies let the modes meet.

    Theorem. In the form of Eq. (3) without slope, k12 and k21 are affine in mu and the diagonal does not know mu, so

        (w2^2 - w1^2)^2 = (a - d)^2 + 4 k12(mu) k21(mu)

    is a parabola in mu. Three values fix it: the table's at mu = 0 and the published ones at 0.1 (mu-3) and 0.3 (N-2).
    Its zero, where the modes meet, is then no free choice. It lies at 0.440 and not at the published 0.40.

    With a slope alpha V the value at mu = 0 is free as well; that is how the reconstruction meets the onset, at the
    price of frequencies that are off by 105 to 117 rad/s, just within what the window resolves.
    """
    values = [
        table_split() if first is None else first,
        squared_split(0.10) if second is None else second,
        squared_split(0.30) if third is None else third,
    ]
    roots = np.roots(np.polyfit([0.0, 0.10, 0.30], values, 2))
    real = roots[np.isreal(roots)].real
    return float(np.min(real[real > 0.30]))


def least_miss(onset: float = PUBLISHED_ONSET) -> float:
    """The least by which a frequency at mu = 0.1 or 0.3 must be off [rad/s] for a parabola that meets at `onset`.

    The mean square is the table's, so at each mu one number is free. The parabola keeps the table at mu = 0, vanishes
    at `onset`, and has one coefficient left, which is varied over all that keeps the frequencies real.
    """
    start, trace = table_split(), table_trace().low
    bend = np.linspace(-2e17, 2e17, 40001)
    worst = np.zeros_like(bend)
    for mu in (0.10, 0.30):
        split = (1.0 - mu / onset) * start + bend * mu * (mu - onset)
        possible = (split >= 0.0) & (split <= trace**2)
        apart = np.sqrt(np.where(possible, split, 0.0))
        for sign, published in zip((-1.0, 1.0), FREQUENCIES[mu], strict=True):
            miss = np.abs(np.sqrt(0.5 * (trace + sign * apart)) - published)
            worst = np.maximum(worst, np.where(possible, miss, np.inf))
    return float(np.min(worst))

"""Is a mode missing? The winding number of det Q(lambda) around a rectangle, with the known eigenvalues divided out.

The number of eigenvalues inside a contour is 1/(2 pi) times the turn of the phase of det Q along it. Along a brake's
contour that phase turns fast: by lightly damped modes beside the contour, and by a smooth drift of many turns that the
damping of all the modes far away brings. So what is followed is det Q(lambda) / prod (lambda - lambda_k), lambda_k
eigenvalues that are known or believed to be, and at every point its rate along the contour is measured, by a second
determinant close by. An interval is taken when the rates at its ends and its middle agree on how far the phase turns,
and the measured phases agree with that; by how much each lambda - lambda_k turns there is known and added again. Where
they do not agree, the eigenvalues nearest to its middle are found by the factors that are there anyway and take the
place of those believed to be there; after that it is halved. What det Q turns in all is the number of modes inside.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike

from squealbox.factorisation import Factor, SingularMatrix, factor
from squealbox.fe.pencil import Pencil, vibrating
from squealbox.fe.quadratic import modes_near

MOST = 150  # factorisations
RATES_AGREE = 0.8  # rad by which two formulas for the turn of an interval may differ
PHASES_AGREE = 0.4  # rad by which measured phases may differ from the turn the rates give
PIECES = (1, 4, 1, 4)  # of each side of the rectangle at first
NEAREST = 12  # eigenvalues that are looked for where a phase cannot be followed
PROBE = 1e-5  # distance of the second determinant, as a share of the largest |lambda|
GROWTH = 1000.0  # growth rate [1/s] up to which a rectangle reaches at least


@dataclass(frozen=True)
class Certificate:
    """What the winding number says of a list of modes.

    missing is the number of eigenvalues inside that are not in the list (negative: the list holds one too many), None
    where the phase could not be followed; known how many of the list are inside; growth (low, high) [1/s] and band
    (low, high) [Hz] are the rectangle; factorisations what it cost; reason what stands in the way, or "".
    """

    missing: int | None
    known: int
    growth: tuple[float, float]
    band: tuple[float, float]
    factorisations: int
    reason: str

    @property
    def certified(self) -> bool:
        """True where no eigenvalue is missing and none is one too many."""
        return self.missing == 0

    def __str__(self) -> str:
        where = f"growth {self.growth[0]:.4g} to {self.growth[1]:.4g} 1/s, {self.band[0]:.5g} to {self.band[1]:.5g} Hz"
        if self.certified:
            return f"none missed: {self.known} modes in the rectangle {where} ({self.factorisations} factorisations)"
        return f"not certified: {self.reason} ({where}, {self.factorisations} factorisations)"


def certificate(
    pencil: Pencil,
    eigenvalues: ArrayLike,
    band: tuple[float, float],
    *,
    believed: ArrayLike = (),
    largest_growth: float | None = None,
    most: int = MOST,
    phases: dict[complex, float] | None = None,
) -> Certificate:
    """Whether `eigenvalues` holds every mode that grows, or hardly decays, in the band (f1, f2) [Hz].

    Parameters
    ----------
    pencil : the brake's matrices
    eigenvalues : all known eigenvalues [1/s] with Im > 0, shape (k,)
    band : (f1, f2) [Hz]; widened a little to where no known mode is close to its ends
    believed : others, shape (l,), that nobody vouches for or that are outside the band: none of them is counted as
        known, but they make the phase smooth
    largest_growth : [1/s] right side of the rectangle; by default 1000, or four times the largest of the known modes
        in the band whose damping ratio is below 0.1 in size
    most : factorisations after which the search gives up
    phases : of det Q at points, kept from one list of eigenvalues to the next for the same brake; those found are added
    """
    known = np.asarray(eigenvalues, dtype=complex)
    known = known[known.imag > 0.0]
    every = np.concatenate([known, np.asarray(believed, dtype=complex)])
    every = every[every.imag > 0.0]
    low, high = _band_gaps(every, band)
    left = _left_side(every, low, high)
    modes = known[vibrating(known) & (known.imag > low) & (known.imag < high)]
    right = largest_growth or max(GROWTH, 4.0 * float(np.max(modes.real, initial=0.0)))
    inside = (known.real > left) & (known.real < right) & (known.imag > low) & (known.imag < high)
    search = _Winding(pencil, every, PROBE * abs(complex(right, high)), most, {} if phases is None else phases)
    corners = [complex(left, low), complex(right, low), complex(right, high), complex(left, high)]
    turn, reason = 0.0, ""
    try:
        for start, end, parts in zip(corners, [*corners[1:], corners[0]], PIECES, strict=True):
            turn += search.turn(start, end, parts)
        missing: int | None = round(turn / (2.0 * np.pi)) - int(np.sum(inside))
    except _TooMany as error:
        missing, reason = None, str(error)
    except SingularMatrix as error:
        missing, reason = None, f"an eigenvalue lies on the contour: {error}"
    if missing is not None and missing != 0:
        what = "missing" if missing > 0 else "too many"
        reason = f"{abs(missing)} mode{'s' * (abs(missing) > 1)} {what} in the list of {int(np.sum(inside))}"
    hertz = low / (2.0 * np.pi), high / (2.0 * np.pi)
    return Certificate(missing, int(np.sum(inside)), (left, right), hertz, search.made, reason)


class _TooMany(Exception):
    """The phase could not be followed with the factorisations allowed."""


class _Winding:
    """Phases of det Q(lambda) and their rates along a contour, beside those of eigenvalues believed to be there."""

    def __init__(
        self, pencil: Pencil, known: np.ndarray, probe: float, most: int, phases: dict[complex, float]
    ) -> None:
        self.pencil, self.believed, self.probe, self.most, self.made = pencil, known, probe, most, 0
        self.phases = phases
        self.counted: set[complex] = set()
        self.last: tuple[complex, Factor] | None = None

    def turn(self, start: complex, end: complex, parts: int) -> float:
        """By how much the phase of det Q turns from `start` to `end` [rad]."""
        marks = [start + (end - start) * i / parts for i in range(parts + 1)]
        return sum(self._between(a, b) for a, b in pairwise(marks))

    def _between(self, a: complex, b: complex) -> float:
        middle = 0.5 * (a + b)
        found = self._followed(a, b)
        if found is None:
            self._look_near(middle)
            found = self._followed(a, b)
        if found is not None:
            return found
        return self._between(a, middle) + self._between(middle, b)

    def _followed(self, a: complex, b: complex) -> float | None:
        """The turn from a to b; None where rates and phases do not agree on it."""
        middle, along, length = 0.5 * (a + b), (b - a) / abs(b - a), abs(b - a)
        (first, rate_a), (last, rate_b), (half, rate) = (self._phase(point, along) for point in (a, b, middle))
        plain = 0.5 * length * (rate_a + rate_b)
        better = length * (rate_a + 4.0 * rate + rate_b) / 6.0
        first_half, second_half = (
            length * (5.0 * rate_a + 8.0 * rate - rate_b) / 24.0,
            length * (5.0 * rate_b + 8.0 * rate - rate_a) / 24.0,
        )
        misses = [_wrapped(half - first - first_half), _wrapped(last - half - second_half)]
        if abs(plain - better) < RATES_AGREE and max(map(abs, misses)) < PHASES_AGREE:
            return better + sum(misses) + float(np.sum(np.angle((b - self.believed) / (a - self.believed))))
        return None

    def _phase(self, point: complex, along: complex) -> tuple[float, float]:
        """Phase [rad] less that of the eigenvalues believed to be there, and its rate along the contour [rad s]."""
        ahead, here = self._at(point + self.probe * along), self._at(point)
        return here, _wrapped(ahead - here) / self.probe

    def _at(self, point: complex) -> float:
        if point not in self.counted and point in self.phases:
            self._count()
        elif point not in self.counted:
            self.phases[point] = self._factor(point).log_determinant.imag
        self.counted.add(point)
        return self.phases[point] - float(np.sum(np.angle(point - self.believed)))

    def _look_near(self, point: complex) -> None:
        """Put the eigenvalues nearest to a point in the place of those believed to be there."""
        base = self.last[1] if self.last is not None and self.last[0] == point else self._factor(point)
        found, _ = modes_near(self.pencil, point, NEAREST, base)
        reach = float(np.max(np.abs(found - point), initial=0.0)) * (1.0 + 1e-9)
        self.believed = np.concatenate([self.believed[np.abs(self.believed - point) > reach], found])

    def _factor(self, point: complex) -> Factor:
        self._count()
        self.last = None  # it may be large
        self.last = point, factor(self.pencil.at(point), symmetric=False, library="superlu")
        return self.last[1]

    def _count(self) -> None:
        if self.made >= self.most:
            raise _TooMany(f"the phase of det Q could not be followed with {self.most} factorisations")
        self.made += 1


def _wrapped(angle: float) -> float:
    return float((angle + np.pi) % (2.0 * np.pi) - np.pi)


def _left_side(known: np.ndarray, low: float, high: float) -> float:
    """A growth rate a little below 0 in the widest gap between the known modes of the band."""
    deepest = -0.05 * low
    rates = known.real[(known.imag > 0.9 * low) & (known.imag < 1.1 * high)]
    marks = np.sort(np.concatenate([[deepest, 0.0], rates[(rates > deepest) & (rates < 0.0)]]))
    return float(_widest(marks))


def certified_band(band: tuple[float, float]) -> tuple[float, float]:
    """The widest band (f1, f2) [Hz] that a certificate for a band may look at."""
    return 0.9 * band[0], 1.05 * band[1]


def _band_gaps(known: np.ndarray, band: tuple[float, float]) -> tuple[float, float]:
    """The band [rad/s] with its ends moved outwards, by up to a tenth, into the widest gap between known modes."""
    near = known[known.real > -0.1 * known.imag].imag
    ends = []
    for inner, outer in zip(band, certified_band(band), strict=True):
        first, last = sorted((2.0 * np.pi * inner, 2.0 * np.pi * outer))
        marks = np.sort(np.concatenate([[first, last], near[(near > first) & (near < last)]]))
        ends.append(_widest(marks))
    return ends[0], ends[1]


def _widest(marks: np.ndarray) -> float:
    place = int(np.argmax(np.diff(marks)))
    return float(0.5 * (marks[place] + marks[place + 1]))

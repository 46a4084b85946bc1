"""Which components a record holds: found one after the other above the noise, fitted all together.

Each search looks at the record under five windows (whole, its beginning, its end), because a burst of a tenth of the
record drowns in the noise of the rest. A line counts where its power is above that of the noise beside it by more than
noise alone reaches once in `CHANCE` records. Coloured noise is then made white by a prediction filter: a filter leaves
exponents as they are, so the same fit on the filtered record is the maximum of the likelihood.
"""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from squealbox.signals.exponentials import (
    Exponentials,
    FoldedSamples,
    fit_exponentials,
    matched_energy,
    prediction_filter,
)
from squealbox.signals.sampling import SignalError

CHANCE = 1e-4  # of taking noise for a line, per record
MOST = 8  # components
WINDOWS = (0.0, -8.0, 8.0, -60.0, 60.0)  # growth over the record of the windows; 0 is Hann's
TRIED = np.array([0.0, 1.0, 3.0, 8.0, 20.0, 50.0, 120.0, 300.0, 800.0])  # growth over the record, either sign
ORDER = 24  # of the prediction filter, at most
AROUND = 50  # resolutions on either side from which the noise at a component is read
RING = (5, 25)  # resolutions from a line that are its surroundings
MOST_SEEN = 64  # lines looked at
SLOW = 2.0  # cycles in the record that a component must go through before its frequency is one
CANCEL = 4.0  # most energy of the components beside that of the record
STEEPEST = -3.0  # power of the frequency with which red noise may rise; a line under a window is steeper
CROWD = 6.0  # resolutions
ROUNDING = 1e-26  # share of the power that rounding leaves


@dataclass(frozen=True)
class Tones:
    """Components of a record, the strongest first: exponents in 1/s and rad/s and their covariance."""

    exponents: Any
    energies: Any
    covariance: Any
    sharp: Any  # whether each stands above its surroundings: a hill of coloured noise does not
    rate: float
    size: int
    record: Any  # the samples the last fit is of: about their mean, filtered where the noise has a colour

    @property
    def cycles(self) -> Any:
        """Cycles of each component in the record."""
        return np.abs(self.exponents.imag) / (2.0 * np.pi) * self.size / self.rate

    def crowd(self, index: int) -> int:
        """How many components stand within `CROWD` resolutions of one, itself among them."""
        away = np.abs(self.exponents.imag - self.exponents[index].imag) / (2.0 * np.pi) * self.size / self.rate
        return int(np.count_nonzero(away <= CROWD))

    def error(self, index: int) -> tuple[float, float]:
        """Standard deviations of growth rate [1/s] and angular frequency [rad/s] of one component."""
        spread = np.sqrt(np.maximum(np.diag(self.covariance), 0.0))
        return float(spread[2 * index]), float(spread[2 * index + 1])


def tones(x: np.ndarray, rate: float, *, near: float | None = None, most: int = MOST, colour: bool = True) -> Tones:
    """The components of `x` (n,) sampled at `rate` [Hz], `most` of them; `near` [Hz] is where the first is looked for.

    `colour` False takes the noise for white.

    Raises `SignalError` for a constant signal.
    """
    record = FoldedSamples(x - np.mean(x))
    if not record.power > ROUNDING * x.size * max(float(np.max(np.abs(x))), 1e-300) ** 2:
        raise SignalError(f"the signal is constant ({x[0]:g}): it has no frequency")
    found: Exponentials | None = None
    guesses = np.zeros(0, dtype=complex)
    residual = record
    looks = _windows(x.size)
    sharp: list[bool] = []
    for _ in range(most):
        seen = _strongest(residual, looks, guesses, None if near is None or len(guesses) else near / rate)
        if seen is None:
            break
        seed, narrow = seen
        if len(guesses):  # near what is left first: many at once find no way from afar
            seed = fit_exponentials(residual, [seed], offset=False, close=1.0).exponents[0]
        trial = fit_exponentials(record, np.append(guesses, seed))
        if not _sound(trial, record.power):
            break
        found = trial
        guesses = found.exponents
        sharp.append(narrow)
        residual = FoldedSamples(found.residual)
        if residual.power <= ROUNDING * record.power:
            break
    if found is None:
        none = np.zeros(0)
        return Tones(none.astype(complex), none, np.zeros((0, 0)), none.astype(bool), rate, x.size, record.x)
    final, used = _whitened(record, found) if colour else (found, record.x)
    order = np.argsort(-found.energies, kind="stable")
    pairs = np.ravel(np.column_stack([2 * order, 2 * order + 1]))
    return Tones(
        exponents=final.exponents[order] * rate,
        energies=found.energies[order],
        covariance=final.covariance[np.ix_(pairs, pairs)] * rate**2,
        sharp=np.array(sharp)[order],
        rate=rate,
        size=x.size,
        record=used,
    )


def _sound(tried: Exponentials, power: float) -> bool:
    """Whether a fit can be used: no component has run to an end of the band or into another, none cancels another."""
    size = tried.residual.size
    cycles = tried.exponents.imag * size / (2.0 * np.pi)
    if not (np.all(np.isfinite(tried.covariance)) and np.all((cycles > 0.2) & (cycles < 0.5 * size - 0.5))):
        return False
    if np.any((np.abs(tried.exponents.real) > tried.exponents.imag) & (cycles > SLOW)):
        return False  # gone within a cycle: no oscillation
    if np.sum(tried.energies) > CANCEL * power:
        return False
    apart = np.abs(tried.exponents[:, None] - tried.exponents[None, :])[~np.eye(len(cycles), dtype=bool)]
    return bool(np.all(apart * size > 1.0)) if apart.size else True


def _whitened(record: FoldedSamples, found: Exponentials) -> tuple[Exponentials, Any]:
    from scipy.signal import lfilter

    white = prediction_filter(found.residual, ORDER)
    if len(white) == 1:
        return found, record.x
    filtered = lfilter(white, [1.0], record.x)[len(white) - 1 :]
    again = fit_exponentials(filtered, found.exponents)
    moved = np.abs(again.exponents - found.exponents) * record.size
    allowed = np.maximum(3.0, np.abs(found.exponents.real) * record.size)
    good = _sound(again, CANCEL * FoldedSamples(filtered).power) and np.all(moved < allowed)
    if not good:
        return found, record.x
    left = np.repeat(np.sqrt(_about(again.residual, again.exponents)), 2)
    return replace(again, covariance=again.covariance * np.outer(left, left)), filtered


def _about(residual: np.ndarray, exponents: np.ndarray) -> Any:
    """Power of what a filter left about each component, beside its mean: no filter of few coefficients is perfect."""
    power = np.abs(np.fft.rfft(residual)) ** 2
    places = np.round(exponents.imag * residual.size / (2.0 * np.pi)).astype(int)
    away = np.arange(3, min(AROUND, power.size // 4) + 3)
    lines = np.abs(places[:, None] + np.concatenate([-away, away]))
    last = power.size - 1
    lines = last - np.abs(last - lines)
    return np.mean(power[lines], axis=1) / np.mean(power)


def _windows(size: int) -> list[tuple[float, Any]]:
    s = np.linspace(0.0, 1.0, size, dtype=np.float32)
    hann = np.sin(np.float32(np.pi) * s) ** 2
    looks = [(0.0, hann)]
    for g in WINDOWS[1:]:
        away = s if g < 0.0 else 1.0 - s  # rises from 0, so that the skirts of a line fall quickly
        looks.append((g, away * np.exp(np.float32(-abs(g)) * away) * np.float32(np.e * abs(g))))
    return looks


def _strongest(
    record: FoldedSamples, looks: list[tuple[float, Any]], taken: np.ndarray, near: float | None
) -> tuple[complex, bool] | None:
    """A first guess of the exponent [1/sample] of the strongest line above the noise; None when there is none.

    And whether it stands above its surroundings too, which a hill of the noise does not: other than the first must.
    `near` [cycles/sample] looks at that frequency alone.
    """
    from scipy.fft import next_fast_len, rfft

    size = record.size
    length = next_fast_len(size if size > 4096 else 4 * size, real=True)
    x = (record.x / np.max(np.abs(record.x))).astype(np.float32)  # enough to see a line: the fit has all digits
    place = np.arange(length // 2 + 1) * (size / length)  # in resolutions of the record
    floor = _Floor(place)
    spectra = {}
    for growth, weights in looks:
        lines = rfft(weights * (x - np.average(x, weights=weights)), length)  # the rest of a mean is no line
        spectra[growth] = lines.real**2 + lines.imag**2
    limit = -np.log(CHANCE / (len(WINDOWS) * size))
    tops: list[tuple[int, bool]] = []
    for growth, power in spectra.items():
        width = abs(growth) / (2.0 * np.pi)
        keep = (place >= 0.2) & (power > limit * floor.of(power))
        for exponent in taken:  # what is left of a component is no other one
            keep[np.abs(place - exponent.imag * size / (2.0 * np.pi)) < 1.0 + width] = False
        if near is not None:
            keep &= np.abs(place - near * size) <= max(2.0 + width, 0.005 * near * size)
        seen = np.nonzero(keep)[0]
        seen = seen[np.argsort(-power[seen])][:MOST_SEEN]
        if not seen.size:
            continue
        step = length / size
        around = _around(power, seen, step) if growth == 0.0 else _beside(spectra[-growth], seen, width, step)
        narrow = power[seen] > limit * around
        if len(taken) == 0 or near is not None:
            tops.append((int(seen[0]), bool(narrow[0])))
        elif np.any(narrow):
            tops.append((int(seen[np.argmax(narrow)]), True))
    best: tuple[float, complex, int] | None = None
    for top in dict(tops):
        trial = (*_best_growth(record, 2.0 * np.pi * top / length), top)
        best = trial if best is None or trial[0] > best[0] else best
    if best is None:
        return None
    return best[1], any(narrow for top, narrow in tops if abs(top - best[2]) <= 2 * length // size)


def _around(power: np.ndarray, seen: np.ndarray, step: float) -> Any:
    """Median power of the lines to both sides of each place: what is as high there is a hill of the noise."""
    away = np.unique((np.arange(RING[0], RING[1] + 1) * step).astype(int))
    places = np.abs(seen[:, None] + np.concatenate([-away, away]))
    last = power.size - 1
    places = np.clip(last - np.abs(last - places), 0, last)
    return np.median(power[places], axis=1) / np.log(2.0)


def _beside(other: np.ndarray, seen: np.ndarray, width: float, step: float) -> Any:
    """Mean power at each place under the mirrored window, at the record's other end: noise is as high there."""
    half = max(round((8.0 + 2.0 * width) * step), 1)
    sums = np.concatenate([[0.0], np.cumsum(other, dtype=float)])
    low, high = np.maximum(seen - half, 0), np.minimum(seen + half + 1, other.size)
    return (sums[high] - sums[low]) / (high - low)


def _best_growth(record: FoldedSamples, omega: float) -> tuple[float, complex]:
    """The energy and the exponent of the best match among growth rates and frequencies about a line."""
    rates = np.concatenate([-TRIED[::-1], TRIED[1:]]) / record.size
    rates = rates[np.abs(rates) <= max(0.7 * omega, 1.0 / record.size)]
    best = rates[np.argmax(matched_energy(record, rates + 1j * omega))]
    offsets = np.pi / record.size * np.array([-0.7, 0.0, 0.7])
    trials = best + 1j * np.clip(omega + offsets, 1e-9, np.pi)
    energy = matched_energy(record, trials)
    top = int(np.argmax(energy))
    return float(energy[top]), complex(trials[top])


class _Floor:
    """The mean power of the noise about each place: medians over bands / ln 2, joined by lines."""

    def __init__(self, place: np.ndarray) -> None:
        count = place.size
        widths = np.unique(np.clip(np.geomspace(24, max(count, 25), 12).astype(int), 1, count))
        edges = np.unique(np.concatenate([[1], widths, np.linspace(1, count, 33).astype(int)[1:]]))
        kept = [int(edges[0])]
        for edge in edges[1:]:
            if edge - kept[-1] >= 16:
                kept.append(int(edge))
        if len(kept) == 1:
            kept.append(count)
        kept[-1] = count
        starts, ends = np.array(kept[:-1]), np.array(kept[1:])
        self.sample = np.linspace(starts, ends - 1, 65).astype(int).T  # of each band
        self.place = place
        self.middles = 0.5 * (place[starts] + place[ends - 1])
        self.low = place < self.middles[0]
        self.toward = np.log(np.maximum(place[self.low], 0.2)) - np.log(self.middles[0])

    def of(self, power: np.ndarray) -> Any:
        levels = np.maximum(np.sort(power[self.sample], axis=1)[:, 32], 1e-30)
        if levels.size >= 5:  # a wide line that fills a band is not its noise
            around = np.lib.stride_tricks.sliding_window_view(np.pad(levels, 2, mode="edge"), 5)
            levels = np.sort(around, axis=1)[:, 2]
        level = np.interp(self.place, self.middles, levels)
        if levels.size > 1 and levels[0] > levels[1]:  # red noise goes on rising below the first band
            slope = np.log(levels[1] / levels[0]) / np.log(self.middles[1] / self.middles[0])
            slope = max(slope, STEEPEST)
            level[self.low] = levels[0] * np.exp(slope * self.toward)
        return level / np.log(2.0)

"""Frequency and growth rate of the strongest component of a signal, by maximum likelihood, with honest errors."""

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from squealbox.arguments import public
from squealbox.result import Array, Result, quantity
from squealbox.signals.exponentials import fit_exponentials
from squealbox.signals.sampling import Samples, Signal, SignalError, given, unfolded
from squealbox.signals.spectra import spectrum, window_weights
from squealbox.signals.tones import SLOW, Tones, tones

LEVEL = 0.95  # of the errors
DISAGREE = 4.0  # standard deviations between the halves of a record from which its growth is not one number


@dataclass(frozen=True, kw_only=True, eq=False)
class GrowthRate(Result):
    """Growth of the component at `frequency` [Hz]: amplitude ~ exp(rate t), rate in 1/s; errors are 95 % bounds.

    `halves` are the rates of the component in the first and in the second half of what the record tells of it. Where
    they disagree by more than the noise allows the growth is not one number: `rate_error` is then their distance.
    """

    time: Array = quantity("piece", "s", "middle of each piece")
    envelope: Array = quantity("piece", "unit of the signal", "amplitude of the component in each piece")
    rate: float
    rate_error: float
    frequency: float
    frequency_error: float
    halves: tuple[float, float] = (np.nan, np.nan)
    steady: bool = True

    coordinates: ClassVar = {"piece": "time"}

    def __str__(self) -> str:
        text = f"{with_error(self.rate, self.rate_error)} 1/s at {self.frequency:.7g} Hz"
        if self.steady:
            return text
        first, second = self.halves
        return f"{text} (not one rate: {first:.3g} 1/s in its first half, {second:.3g} 1/s in its second)"


@public()
def dominant_frequency(signal: Signal, t: ArrayLike | None = None, *, above: float | None = None, **cut: Any) -> float:
    """Frequency [Hz] of the strongest component, much finer than one over the length of the record.

    The maximum-likelihood estimate for damped or growing sinusoids in noise, white or coloured (see `growth_rate`); the
    strongest is the one with the most energy in the record. `above` [Hz] leaves out slower motion; what goes through
    less than two cycles in the record is left out in any case, because a drift would look the same.

    Source: Rife and Boorstyn 1974, IEEE Transactions on Information Theory 20, 591-598.
    Raises `SignalError` when the signal is constant, and when the record cannot tell: nothing stands above the noise,
    or it holds less than two cycles.

    >>> t = np.arange(1000) / 1000.0
    >>> round(dominant_frequency(np.exp(-8.0 * t) * np.sin(2 * np.pi * 41.3 * t), t), 6)
    41.3
    """
    data = unfolded(signal, t, **cut)
    found = tones(data.x, data.rate)
    return float(found.exponents[_main(found, data, above)].imag / (2.0 * np.pi))


def highest_line(signal: Signal, t: ArrayLike | None = None, **cut: Any) -> float:
    """Frequency [Hz] at which the transform of the record under a Hann window is highest, above two cycles.

    What `dominant_frequency` was before it asked whether a record can tell: there is always a highest line, also in
    noise. For one who asks that himself. Raises `SignalError` for a constant signal.
    """
    from scipy.optimize import minimize_scalar

    data = unfolded(signal, t, **cut)
    coarse = spectrum(data.x, rate=data.rate)
    heard = coarse.frequency >= SLOW * coarse.resolution
    if not np.any(coarse.amplitude[heard] > 0.0):
        raise SignalError(f"the signal is constant ({data.x[0]:g}): it has no frequency")
    guess = coarse.frequency[heard][np.argmax(coarse.amplitude[heard])]
    weights = window_weights("hann", data.x.size)
    weighted = weights * (data.x - np.average(data.x, weights=weights))
    clock = (np.arange(data.x.size) - data.x.size / 2.0) / data.rate

    def height(frequency: float) -> float:
        return -float(np.abs(np.dot(weighted, np.exp(-2j * np.pi * frequency * clock))))

    around = (guess - coarse.resolution / 2.0, guess + coarse.resolution / 2.0)
    best = minimize_scalar(height, bounds=around, method="bounded", options={"xatol": 1e-9 * guess})
    return float(best.x)


@public()
def growth_rate(
    signal: Signal, t: ArrayLike | None = None, *, frequency: float | None = None, periods: float = 8.0, **cut: Any
) -> GrowthRate:
    """Growth rate [1/s] of the component at `frequency` [Hz], left out the strongest, by maximum likelihood.

        x = c + sum_k Re(a_k exp((g_k + i omega_k) t)) + noise

    All components that stand above the noise are fitted together, so that two tones do not disturb each other. Coloured
    noise is made white by a prediction filter first. For white or smoothly coloured Gaussian noise the errors are those
    of Cramer and Rao, for a steady tone sd(g) = sd(omega) = sqrt(24/n) s/(A T).

    Parameters
    ----------
    signal, t : as for :func:`samples`, equal steps
    frequency : of the component [Hz]; it must stand above the noise within two resolutions
    periods : [-] length of a piece of `envelope`, which is for the eye and is not used for the rate
    cut : `rate` [Hz], `dof`, `begin` [s], `end` [s]

    Returns
    -------
    GrowthRate

    Limits
    ------
    An envelope that is no exponential has no growth rate; `steady` is then False and the error is what the halves of
    the record disagree by. Two components closer than one over the length of the record are taken for one.

    Source: Rife and Boorstyn 1974; Golub and Pereyra 2003, Inverse Problems 19, R1-R26 (variable projection).
    Raises `SignalError` as :func:`dominant_frequency` does.

    >>> t = np.arange(4000) / 20000.0
    >>> round(growth_rate(np.exp(-30.0 * t) * np.sin(2 * np.pi * 2000.0 * t), t).rate, 6)
    -30.0
    """
    from scipy.special import ndtri

    data = unfolded(signal, t, **cut)
    found = tones(data.x, data.rate)
    if frequency is not None and _nearest(found, frequency) is None:
        found = tones(data.x, data.rate, near=float(frequency))
    index = _main(found, data, None) if frequency is None else _asked(found, data, float(frequency))
    crowded = found.crowd(index) > 2
    if crowded:  # an envelope that is no exponential looks like many components side by side
        alone = tones(data.x, data.rate, near=found.exponents[index].imag / (2.0 * np.pi), most=1, colour=False)
        found, index = (alone, 0) if alone.exponents.size else (found, index)
    exponent = complex(found.exponents[index])
    rate, omega = exponent.real, exponent.imag
    width = float(ndtri(0.5 + 0.5 * LEVEL))
    errors = [width * error for error in found.error(index)]
    halves, agree = _halves(found, index)
    steady = bool(agree and not crowded and found.sharp[index])
    if not steady:
        errors = [max(errors[0], abs(halves[1].real - halves[0].real)), max(errors[1], abs(halves[1] - halves[0]))]
    middle, envelope = _envelope(data, omega / (2.0 * np.pi), periods)
    return GrowthRate(
        time=middle,
        envelope=envelope,
        rate=rate,
        rate_error=errors[0],
        frequency=omega / (2.0 * np.pi),
        frequency_error=errors[1] / (2.0 * np.pi),
        halves=(halves[0].real, halves[1].real),
        steady=steady,
        settings={"periods": periods, "level": LEVEL, **given({"frequency": frequency}), **given(cut)},
    )


def _main(found: Tones, data: Samples, above: float | None) -> int:
    """The strongest component whose frequency the record can tell."""
    frequency = found.exponents.imag / (2.0 * np.pi)
    told = (found.cycles >= SLOW) & (frequency >= (0.0 if above is None else above))
    if np.any(told):
        return int(np.argmax(told))
    if found.exponents.size == 0:
        raise SignalError(
            f"nothing stands above the noise in {data.x.size} samples of {data.duration:.4g} s: the record cannot tell "
            "a frequency; expected a stronger or a longer signal"
        )
    if above is not None and np.any(found.cycles >= SLOW):
        raise SignalError(f"nothing stands above the noise from above = {above:g} Hz on")
    raise SignalError(
        f"the record of {data.duration:.4g} s holds {found.cycles[0]:.2g} cycles of its motion: it cannot tell a "
        f"frequency; expected {SLOW:g} cycles or more"
    )


def _nearest(found: Tones, frequency: float) -> int | None:
    """The component at `frequency` [Hz], within two resolutions or its own width."""
    if found.exponents.size == 0:
        return None
    away = np.abs(found.exponents.imag / (2.0 * np.pi) - frequency)
    width = np.maximum(2.0 * found.rate / found.size, np.abs(found.exponents.real) / (2.0 * np.pi))
    index = int(np.argmin(away))
    return index if away[index] <= max(width[index], 0.005 * frequency) else None


def _asked(found: Tones, data: Samples, frequency: float) -> int:
    index = _nearest(found, frequency)
    if index is None:
        raise SignalError(
            f"nothing stands above the noise at {frequency:g} Hz within {2.0 / data.duration:.3g} Hz: the record "
            "cannot tell a growth rate there"
        )
    if found.cycles[index] < SLOW:
        raise SignalError(f"the record of {data.duration:.4g} s holds {found.cycles[index]:.2g} cycles: expected 2")
    return index


def _halves(found: Tones, index: int) -> tuple[tuple[complex, complex], bool]:
    """Exponents [1/s] of the component in the halves of its energy, and whether they agree within the noise."""
    exponent = complex(found.exponents[index])
    x = found.record
    decay = 2.0 * exponent.real * x.size / found.rate
    share = 0.5 if abs(decay) < 1e-6 else float(np.log1p(0.5 * np.expm1(decay)) / decay) if decay < 500.0 else 1.0
    cut = round(share * x.size)
    cycle = 2.0 * np.pi / exponent.imag * found.rate
    if min(cut, x.size - cut) < max(2.0 * cycle, 8.0 * len(found.exponents) + 8.0):
        return (exponent, exponent), True
    fits = [fit_exponentials(part, found.exponents / found.rate) for part in (x[:cut], x[cut:])]
    parts = [complex(fit.exponents[index]) * found.rate for fit in fits]
    spread = sum(float(fit.covariance[2 * index, 2 * index]) for fit in fits) * found.rate**2
    apart = abs(parts[1].real - parts[0].real)
    agree = (
        not all(fit.converged for fit in fits) or apart <= DISAGREE * np.sqrt(spread) or apart <= 1e-6 * abs(exponent)
    )
    return (parts[0], parts[1]), agree


def _envelope(data: Samples, frequency: float, periods: float) -> tuple[Any, Any]:
    """Middles [s] of pieces of `periods` periods, and the amplitude of the component in each under a Hann window."""
    length = min(max(round(periods * data.rate / frequency), 4), data.x.size)
    count = max((2 * data.x.size) // length - 1, 1)
    starts = np.linspace(0, data.x.size - length, count).round().astype(int)
    weights = window_weights("hann", length)
    carrier = np.exp(-2j * np.pi * frequency * np.arange(length) / data.rate) * weights
    carrier = carrier - weights * (np.sum(carrier) / np.sum(weights))  # blind to an offset
    parts = np.stack([carrier.real, carrier.imag], axis=1)
    pieces = np.lib.stride_tricks.sliding_window_view(data.x, length)[starts] @ parts
    return data.t[starts] + 0.5 * length / data.rate, np.hypot(*pieces.T) * 2.0 / np.sum(weights)


def with_error(value: float, error: float) -> str:
    """A value and its error, the error to one digit and the value to the same place.

    `value` [SI]: what is written; `error` [SI]: its error, in the same unit.

    >>> with_error(-117.3, 18.0)
    '-120 +- 20'
    """
    if not (np.isfinite(error) and error > 0.0):
        return f"{value:.5g}"
    place = int(np.floor(np.log10(error)))
    decimals = max(-place, 0)
    return f"{round(float(value), -place) + 0.0:.{decimals}f} +- {round(float(error), -place):.{decimals}f}"


def slope(t: ArrayLike, y: ArrayLike) -> tuple[float, float]:
    """Slope of the line through (t, y) and its 95 % half-width, widened where successive misfits agree.

    With lag-one correlation r of the misfits, m points count as m (1 - r)/(1 + r). Fewer than three points have an
    infinite width.
    """
    from scipy.special import stdtrit

    t, y = np.asarray(t, dtype=float), np.asarray(y, dtype=float)
    if t.size < 2:
        return 0.0, np.inf
    away = t - np.mean(t)
    value = float(np.dot(away, y) / np.dot(away, away))
    if t.size < 3:
        return value, np.inf
    misfit = y - np.mean(y) - value * away
    power = float(np.dot(misfit, misfit))
    alike = max(float(np.dot(misfit[1:], misfit[:-1])) / power, 0.0) if power > 0.0 else 0.0
    free = max((t.size - 2) * (1.0 - alike) / (1.0 + alike), 1.0)
    return value, float(stdtrit(free, 0.975) * np.sqrt(power / free / np.dot(away, away)))

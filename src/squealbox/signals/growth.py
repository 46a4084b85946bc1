"""Frequency and growth rate of the strongest component of a signal."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from squealbox.result import Result, quantity
from squealbox.signals.samples import SignalError, given, samples
from squealbox.signals.spectra import spectrum


@dataclass(frozen=True, kw_only=True, eq=False)
class GrowthRate(Result):
    """Growth of the component at `frequency` [Hz]: amplitude ~ exp(rate t), rate in 1/s; errors are 95 % bounds."""

    time: Any = quantity("piece", "s", "middle of each piece")
    envelope: Any = quantity("piece", "unit of the signal", "amplitude of the component in each piece")
    rate: float
    rate_error: float
    frequency: float
    frequency_error: float

    def __str__(self) -> str:
        return f"{with_error(self.rate, self.rate_error)} 1/s at {self.frequency:.7g} Hz"


def dominant_frequency(signal: Any, t: Any = None, *, above: float | None = None, **cut: Any) -> float:
    """Frequency [Hz] of the strongest component, much finer than one over the length of the record.

    The place where the transform |sum w x exp(-i omega t)| of the record under a Hann window is greatest, found on a
    continuous frequency. For one sinusoid in white noise, with no window, this is the maximum-likelihood estimate; the
    window keeps other components and the offset from pulling it. A growing or decaying sinusoid keeps its frequency.
    `above` [Hz] leaves out slower motion; by default all below two cycles in the record.

    Source: Rife and Boorstyn 1974, IEEE Transactions on Information Theory 20, 591-598.
    Raises `SignalError` when the signal is constant.
    """
    from scipy.optimize import minimize_scalar
    from scipy.signal import get_window

    data = samples(signal, t, **cut)
    coarse = spectrum(data.x, rate=data.rate)
    heard = coarse.frequency >= (2.0 * coarse.resolution if above is None else above)
    if not np.any(coarse.amplitude[heard] > 0.0):
        raise SignalError(f"the signal is constant ({data.x[0]:g}): it has no frequency")
    guess = coarse.frequency[heard][np.argmax(coarse.amplitude[heard])]
    weights = get_window("hann", data.x.size)
    weighted = weights * (data.x - np.average(data.x, weights=weights))
    clock = (np.arange(data.x.size) - data.x.size / 2.0) / data.rate

    def height(frequency: float) -> float:
        return -float(np.abs(np.dot(weighted, np.exp(-2j * np.pi * frequency * clock))))

    around = (guess - coarse.resolution / 2.0, guess + coarse.resolution / 2.0)
    best = minimize_scalar(height, bounds=around, method="bounded", options={"xatol": 1e-9 * guess})
    return float(best.x)


def growth_rate(
    signal: Any, t: Any = None, *, frequency: float | None = None, periods: float = 8.0, **cut: Any
) -> GrowthRate:
    """Growth rate [1/s] of the component at `frequency` [Hz], by a line through the logarithm of its envelope.

    The signal is cut into pieces of `periods` periods under a Hann window, each half over the next. In each piece the
    component is z = sum w x exp(-i omega t). log|z| is fitted by a line in time, and the drift of the phase of z mends
    the frequency. `frequency` left out means the dominant one. A component nearer than 2/periods of the frequency is
    not held apart and beats in the envelope; `rate_error` then says so, because it counts neighbouring pieces as one
    where their misfits agree.

    Raises `SignalError` when fewer than four pieces fit.
    """
    from scipy.signal import get_window

    data = samples(signal, t, **cut)
    line = dominant_frequency(data.x, data.t) if frequency is None else float(frequency)
    length = round(periods * data.rate / line)
    count = (2 * data.x.size) // max(length, 1) - 1
    if count < 4 or length < 4 * periods:
        raise SignalError(
            f"{data.x.size} samples at {data.rate:g} Hz hold {data.duration * line:.3g} periods of {line:g} Hz: "
            f"expected {2.5 * periods:g} periods or more, with 4 or more samples in each"
        )
    starts = np.linspace(0, data.x.size - length, count).round().astype(int)
    weights = get_window("hann", length)
    carrier = np.exp(-2j * np.pi * line * np.arange(length) / data.rate) * weights
    carrier = carrier - weights * (np.sum(carrier) / np.sum(weights))  # blind to an offset
    pieces = np.array([np.dot(carrier, data.x[start : start + length]) for start in starts])
    pieces = pieces * np.exp(-2j * np.pi * line * starts / data.rate) * 2.0 / np.sum(weights)
    if np.any(pieces == 0.0):
        raise SignalError(f"the component at {line:g} Hz vanishes in part of the signal: expected motion throughout")
    middle = data.t[starts] + 0.5 * length / data.rate
    rate, rate_error = slope(middle, np.log(np.abs(pieces)))
    drift, drift_error = slope(middle, np.unwrap(np.angle(pieces)))
    return GrowthRate(
        time=middle,
        envelope=np.abs(pieces),
        rate=rate,
        rate_error=rate_error,
        frequency=line + drift / (2.0 * np.pi),
        frequency_error=drift_error / (2.0 * np.pi),
        settings={"periods": periods, **given(cut)},
    )


def with_error(value: float, error: float) -> str:
    """A value and its error, the error to one digit and the value to the same place.

    >>> with_error(-117.3, 18.0)
    '-120 +- 20'
    """
    if not (np.isfinite(error) and error > 0.0):
        return f"{value:.5g}"
    place = int(np.floor(np.log10(error)))
    decimals = max(-place, 0)
    return f"{round(float(value), -place) + 0.0:.{decimals}f} +- {round(float(error), -place):.{decimals}f}"


def slope(t: Any, y: Any) -> tuple[float, float]:
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

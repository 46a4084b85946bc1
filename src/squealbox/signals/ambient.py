"""Damping before squeal, from how a brake answers what shakes it anyway: the road, the lining, the dynamometer.

Under broadband forcing the power spectrum of a response is, in a band around its modes,

    P(f) = B + sum_i A_i (1 + c_i (f/f_i - 1)) / ((f_i^2 - f^2)^2 + (2 zeta_i f_i f)^2),

where c_i holds what modes forced together and the sampling add, and the lines I of a periodogram are independent and
exponential about it: -sum(log P + I/P) is their log-likelihood (Whittle 1953, Ark. Mat. 2, 423-434). Its maximum, found
by Fisher scoring, gives each mode's frequency and damping ratio, its information their errors. The growth rate
-2 pi zeta f against speed or pressure, continued to zero, is where squeal begins.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from squealbox.arguments import public
from squealbox.result import Array, Outcome, Result, quantity
from squealbox.signals.recordings import Recording, as_recording
from squealbox.signals.sampling import SignalError

SURE = 1.959963984540054  # standard deviations of a 95 % interval
MOST_MODES = 8
LEAST_LINES = 64
STEPS = 200  # of Fisher scoring
CLOSE = 1e-6  # gain in log-likelihood that is none
WIDTHS = (0.002, 0.01, 0.04)  # damping ratios a new mode is tried with
RESOLVED = 15.0  # time constants 1/(2 pi zeta f) a record must last; the resolution alone makes 2 pi of a line
SHOWN = 1000  # points of the spectrum that are kept
OF_MODE = 4  # log A, f, log zeta, c


@dataclass(frozen=True, kw_only=True, eq=False)
class OperationalModes(Result):
    """Modes of an ambient response, by frequency, as :func:`operational_modes` returns them; errors are 95 %.

    The outcome is "completed" or "no_mode", where the spectrum is as flat as noise.
    """

    frequency: Array = quantity("mode", "Hz", "undamped frequency")
    frequency_error: Array = quantity("mode", "Hz", "95 % error")
    damping_ratio: Array = quantity("mode", "1", "damping ratio, -Re / |lambda|")
    damping_error: Array = quantity("mode", "1", "95 % error")
    line: Array = quantity("line", "Hz", "frequencies at which the spectrum is kept")
    measured: Array = quantity("line", "", "mean of the periodogram about each, in the signal's unit squared")
    fitted: Array = quantity("line", "", "the spectrum of the modes and the noise")

    @property
    def growth_rate(self) -> Any:
        """-2 pi zeta f of each mode [1/s]: below 0 for what decays."""
        return -2.0 * np.pi * self.damping_ratio * self.frequency

    @property
    def growth_error(self) -> Any:
        """95 % error of the growth rates [1/s]."""
        return 2.0 * np.pi * self.damping_error * self.frequency

    def summary(self) -> str:
        """A table, one line for each mode."""
        if not self.outcome.ok:
            return self.outcome.told
        rows = zip(self.frequency, self.frequency_error, self.damping_ratio, self.damping_error, strict=True)
        lines = [f"{f:10.2f} +- {df:<6.2g}  {100.0 * z:8.4f} +- {100.0 * dz:<8.2g}" for f, df, z, dz in rows]
        notes = [f"note: {note}" for note in self.settings["notes"]]
        return "\n".join([f"{'frequency [Hz]':>19}  {'damping ratio [%]':>20}", *lines, *notes])


@public()
def operational_modes(
    recording: Recording | ArrayLike,
    rate: float | None = None,
    *,
    channel: int | str = 0,
    band: tuple[float, float],
    modes: int | None = None,
) -> OperationalModes:
    """Frequencies and damping ratios of the modes that answer broadband forcing, within a band.

    Parameters
    ----------
    recording : a `Recording`, or samples (k,) with `rate` [Hz], of a stretch without squeal
    channel : index or name
    band : lowest and highest frequency [Hz]; the forcing must be smooth in it, and modes outside it not reach into it
    modes : how many; left out, as many as pay by the Bayesian information criterion, at most 8

    Accuracy: root mean square errors within 1.2 of the Cramer-Rao bound where the record lasts 50 time constants
    1/(2 pi zeta f) or more; a shorter one widens its peaks by the resolution and says so. Raises `SignalError` for a
    band with fewer than 64 lines of the spectrum.

    >>> rng, pole = np.random.default_rng(0), np.exp(2.0 * np.pi * 500.0 * (-0.01 + 1j) / 8000.0)
    >>> x = np.zeros(80000)
    >>> for k, push in enumerate(rng.standard_normal(80000)):
    ...     x[k] = 2.0 * pole.real * x[k - 1] - abs(pole) ** 2 * x[k - 2] + push
    >>> found = operational_modes(x, 8000.0, band=(300.0, 700.0))
    >>> bool(abs(found.damping_ratio[0] - 0.01) < 2.0 * found.damping_error[0])
    True
    """
    sound = as_recording(recording, rate, "FS")
    x, rate, name = sound.channel(channel), sound.rate, sound.names[sound.index(channel)]
    low, high = (float(each) for each in band)
    if not 0.0 < low < high < 0.5 * rate:
        raise SignalError(f"band = {band} Hz at {rate:g} Hz: expected 0 < low < high < {0.5 * rate:g} Hz")
    lines, power = np.fft.rfftfreq(x.size, 1.0 / rate), np.abs(np.fft.rfft(x - np.mean(x))) ** 2 / x.size
    inside = (lines >= low) & (lines <= high)
    f, power = lines[inside], power[inside]
    if f.size < LEAST_LINES or not np.any(power > 0.0):
        raise SignalError(
            f"band = {band} Hz holds {f.size} lines of the spectrum: expected {LEAST_LINES} that are not 0"
        )
    power = np.maximum(power, 1e-30 * np.max(power))
    found = _flat(power)
    while (found.modes < MOST_MODES) if modes is None else (found.modes < modes):
        more = max((_climb(f, power, start) for start in _with_one_more(f, power, found)), key=lambda each: each.gain)
        if modes is None and more.gain - found.gain < 0.5 * OF_MODE * np.log(f.size) + 0.5 * np.log(f.size):
            break
        found = more
    return _result(f, power, found, x.size / rate, {"band": [low, high], "modes": modes, "channel": name})


@dataclass(frozen=True, kw_only=True, eq=False)
class DampingOnset(Result):
    """Where a mode's growth rate, continued along a straight line, is zero, as :func:`damping_onset` returns it.

    The outcome is "completed", or "no_onset" where the data do not tell a slope.
    """

    value: Any = quantity("", "", "where the growth rate is 0")
    low: Any = quantity("", "", "lower end of its 95 % interval")
    high: Any = quantity("", "", "upper end")
    at: Array = quantity("record", "", "speed, pressure or whatever was varied")
    frequency: Array = quantity("record", "Hz", "frequency of the mode")
    growth_rate: Array = quantity("record", "1/s", "its growth rate")
    growth_error: Array = quantity("record", "1/s", "95 % error")
    line: Array = quantity("coefficient", "", "growth rate = line[0] + line[1] at")
    caution: str = ""

    def summary(self) -> str:
        """The onset with its interval, and how far it lies beyond the data."""
        columns = zip(self.at, self.frequency, self.growth_rate, self.growth_error, strict=True)
        rows = [f"{a:12.6g}  {f:10.2f}  {g:10.4g} +- {e:.2g}" for a, f, g, e in columns]
        name = self.settings["name"]
        ended = f"growth rate 0 at {name} = {self.value:.6g}, 95 % {self.low:.6g} to {self.high:.6g}"
        ended = ended if self.outcome.ok else self.outcome.told
        head = f"{name:>12}  {'f [Hz]':>10}  {'growth rate [1/s]':>17}"
        return self.warned([head, *rows, ended])


def damping_onset(
    found: Sequence[OperationalModes], at: ArrayLike, *, near: float | None = None, name: str = "value"
) -> DampingOnset:
    """The onset of squeal from the damping before it: growth rates against `at`, continued to zero.

    The line is fitted with the errors as weights; its crossing has Fieller's interval (1954, J. R. Stat. Soc. B 16,
    175-185), which is not bounded where the slope is not told from zero: then the outcome is "no_onset".

    Parameters
    ----------
    found : the modes of each record
    at : shape (records,), what was varied: speed, pressure, friction
    near : frequency of the mode in the first record [Hz]; left out, its least damped. It is followed to the nearest
        frequency from record to record, in the order of `at`
    name : what `at` is called

    Raises `SignalError` for fewer than three records or a record without modes.
    """
    places = np.asarray(at, dtype=float)
    if len(found) < 3 or places.shape != (len(found),) or not np.all(np.isfinite(places)) or np.ptp(places) == 0.0:
        raise SignalError(f"{len(found)} records at {places.tolist()}: expected three or more, at different values")
    empty = [i for i, each in enumerate(found) if np.size(each.frequency) == 0]
    if empty:
        raise SignalError(f"record {empty[0] + 1} shows no mode: leave it out or choose another band")
    order = np.argsort(places)
    rows, last = [], near
    for i in order.tolist():
        each = found[i]
        j = int(np.argmin(each.damping_ratio if last is None else np.abs(each.frequency - last)))
        last = float(each.frequency[j])
        rows.append((last, float(each.growth_rate[j]), float(each.growth_error[j])))
    frequency, growth, error = np.array(rows).T
    places = places[order]
    middle, scale = float(np.mean(places)), float(np.ptp(places))
    design = np.stack([np.ones_like(places), (places - middle) / scale], -1) / error[:, None] * SURE
    covariance = np.linalg.inv(design.T @ design)
    level, slope = covariance @ design.T @ (growth / error * SURE)
    value, low, high, known = _crossing(level, slope, covariance)
    ends = [middle + scale * x for x in (value, low, high)]
    beyond = max(places[0] - ends[0], ends[0] - places[-1], 0.0) / scale
    caution = f"{ends[0]:.4g} lies {beyond:.2g} times the measured range beyond it: a straight line need not hold there"
    message = f"the growth rate does not change with {name} by more than its errors"
    return DampingOnset(
        value=np.asarray(ends[0]), low=np.asarray(ends[1]), high=np.asarray(ends[2]), at=places, frequency=frequency,
        growth_rate=growth, growth_error=error, line=np.array([level - slope * middle / scale, slope / scale]),
        caution=caution if known and beyond > 0.5 else "", settings={"near": near, "name": name},
        outcome=Outcome() if known else Outcome("no_onset", message, slope=float(slope / scale)),
    )  # fmt: skip


def _crossing(level: float, slope: float, covariance: np.ndarray) -> tuple[float, float, float, bool]:
    """-level / slope with Fieller's 95 % interval, and whether it is bounded."""
    (a, b), (_, c) = covariance
    square = slope**2 - SURE**2 * c
    if square <= 0.0:
        return np.nan, np.nan, np.nan, False
    half = level * slope - SURE**2 * b
    root = np.sqrt(half**2 - square * (level**2 - SURE**2 * a))
    return -level / slope, (-half - root) / square, (-half + root) / square, True


@dataclass(frozen=True)
class _Fit:
    """Parameters (log B, then log A, f, log zeta, c of each mode), their covariance, the spectrum, log-likelihood."""

    theta: Any
    covariance: Any
    spectrum: Any
    gain: float

    @property
    def modes(self) -> int:
        return int((self.theta.size - 1) // OF_MODE)


def _flat(power: np.ndarray) -> _Fit:
    level = float(np.mean(power))
    return _Fit(np.array([np.log(level)]), np.full((1, 1), 1.0 / power.size), np.full(power.size, level),
                -float(power.size * (np.log(level) + 1.0)))  # fmt: skip


def _with_one_more(f: np.ndarray, power: np.ndarray, found: _Fit) -> list[Any]:
    """Starts for one more mode, where the spectrum stands highest above what is known, one for each width."""
    ratio, starts = power / found.spectrum, []
    for zeta in WIDTHS:
        half = max(int(zeta * f[f.size // 2] / (f[1] - f[0])), 1)
        window = np.ones(2 * half + 1) / (2 * half + 1)
        if window.size > f.size // 2:
            continue
        above = np.convolve(ratio, window, mode="same")
        i = int(np.argmax(above))
        size = max(above[i] - 1.0, 0.1) * found.spectrum[i]
        mode = [np.log(size * (2.0 * zeta * f[i] ** 2) ** 2), f[i], np.log(zeta), 0.0]
        base = found.theta.copy()
        if found.modes == 0:  # the floor of the first mode is not the mean of all lines
            base[0] = np.log(np.median(power))
        starts.append(np.append(base, mode))
    return starts


def _spectrum(f: np.ndarray, theta: np.ndarray) -> tuple[Any, Any]:
    """P at the frequencies and its derivatives by each parameter, shape (parameters, lines)."""
    floor = np.exp(theta[0])
    total, slopes = np.full(f.size, floor), [np.full(f.size, floor)]
    for size, f0, width, skew in theta[1:].reshape(-1, OF_MODE):
        zeta, detuned = np.exp(width), f0**2 - f**2
        below = detuned**2 + (2.0 * zeta * f0 * f) ** 2
        bare = np.exp(size) / below
        part = bare * (1.0 + skew * (f / f0 - 1.0))
        total = total + part
        by_f0 = -part / below * (4.0 * f0 * detuned + 8.0 * zeta**2 * f0 * f**2) - bare * skew * f / f0**2
        slopes += [part, by_f0, -part / below * 2.0 * (2.0 * zeta * f0 * f) ** 2, bare * (f / f0 - 1.0)]
    return total, np.array(slopes)


def _climb(f: np.ndarray, power: np.ndarray, theta: np.ndarray) -> _Fit:
    """The nearest maximum of the likelihood by Fisher scoring with Levenberg's damping; no step leaves its peak."""
    spectrum, slopes = _spectrum(f, theta)
    gain, damping = _likelihood(power, spectrum), 1e-3
    for _ in range(STEPS):
        relative = slopes / spectrum
        information = relative @ relative.T
        scale = np.sqrt(np.maximum(np.diag(information), 1e-300))
        push = relative @ (power / spectrum - 1.0) / scale
        cap = np.ones(theta.size)
        cap[2::OF_MODE] = 2.0 * theta[2::OF_MODE] * np.exp(theta[3::OF_MODE])
        while damping < 1e12:
            step = np.linalg.solve(information / np.outer(scale, scale) + damping * np.eye(theta.size), push) / scale
            trial = theta + step / max(1.0, float(np.max(np.abs(step) / cap)))
            ahead, its_slopes = _spectrum(f, trial)
            reached = _likelihood(power, ahead)
            if reached >= gain:
                break
            damping *= 10.0
        else:
            break
        gained, damping = reached - gain, max(0.1 * damping, 1e-12)
        theta, spectrum, slopes, gain = trial, ahead, its_slopes, reached
        if gained < CLOSE:
            break
    relative = slopes / spectrum
    return _Fit(theta, np.linalg.pinv(relative @ relative.T, hermitian=True), spectrum, gain)


def _likelihood(power: np.ndarray, spectrum: np.ndarray) -> float:
    return -float(np.sum(np.log(spectrum) + power / spectrum)) if np.all(spectrum > 0.0) else -np.inf


def _result(
    f: np.ndarray, power: np.ndarray, found: _Fit, duration: float, settings: dict[str, Any]
) -> OperationalModes:
    rows = found.theta[1:].reshape(-1, OF_MODE)
    order = np.argsort(rows[:, 1])
    spread = np.sqrt(np.diag(found.covariance))[1:].reshape(-1, OF_MODE)[order]
    frequency, zeta = rows[order, 1], np.exp(rows[order, 2])
    short = duration * 2.0 * np.pi * zeta * frequency < RESOLVED
    notes = [f"{duration:.3g} s are {duration * 2.0 * np.pi * z * f0:.2g} time constants of the mode at {f0:.5g} Hz: "
             f"too few to tell its damping" for z, f0 in zip(zeta[short], frequency[short], strict=True)]  # fmt: skip
    group = max(-(-f.size // SHOWN), 1)
    kept = f.size // group * group
    line, measured, fitted = (np.mean(a[:kept].reshape(-1, group), axis=1) for a in (f, power, found.spectrum))
    nothing = Outcome("no_mode", f"between {settings['band'][0]:g} and {settings['band'][1]:g} Hz there is only noise")
    return OperationalModes(
        frequency=frequency, frequency_error=SURE * spread[:, 1], damping_ratio=zeta,
        damping_error=SURE * zeta * spread[:, 2], line=line, measured=measured, fitted=fitted,
        settings={**settings, "notes": notes}, outcome=Outcome() if frequency.size else nothing,
    )  # fmt: skip

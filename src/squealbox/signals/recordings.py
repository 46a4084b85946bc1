"""Recordings of a brake: what a microphone or an accelerometer wrote down, and how it braked meanwhile.

WAV and FLAC (through soundfile), CSV, NumPy and UFF type 58 (through pyuff) are read into one `Recording`. What a file
does not say is said: without a calibration levels are re full scale; clipped samples are counted. What cannot be used,
unequal steps, values that are not finite, a damaged file, is refused in one sentence.
"""

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from tokenize import TokenError
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from squealbox.arguments import public
from squealbox.cells import cells
from squealbox.signals.sampling import COARSEST, LEAST, SignalError, equal_steps, last_digits

LARGEST = 2_000_000_000  # bytes of a file
LARGEST_TEXT = 200_000_000
DENSEST = 512  # samples a byte of a file can stand for, at most: FLAC of silence
BLOCK = 1 << 20  # frames read at once
HUGE = 1e100  # no unit is so small that a value has to be so large
CLIPPED = 3  # neighbours at the largest value, from which it is called clipped
INSTALL = "pip install 'squealbox[recordings]'"


@dataclass(frozen=True, eq=False)
class Recording:
    """Equally spaced samples of one channel or several, in `units`, with what is known of the braking.

    `samples` has the shape (k, channels). A unit of "FS" stands for full scale: nothing said what one is worth.
    `braking` holds (times [s], values) of each quantity on its own clock. `notes` are sentences about what is missing.
    """

    samples: Any
    rate: float
    names: tuple[str, ...] = ("channel 1",)
    units: tuple[str, ...] = ("FS",)
    braking: Mapping[str, tuple[Any, Any]] = field(default_factory=dict)
    notes: tuple[str, ...] = ()
    source: str = ""

    def __repr__(self) -> str:
        channels = ", ".join(f"{name} [{unit}]" for name, unit in zip(self.names, self.units, strict=True))
        words = [
            f"Recording {self.source}".rstrip(),
            f"{len(self.samples) / self.rate:.6g} s at {self.rate:g} Hz",
            channels,
        ]
        return "; ".join([*words, *self.braking, *self.notes])

    def __post_init__(self) -> None:
        x = np.asarray(self.samples, dtype=float)
        x = x[:, None] if x.ndim == 1 else x
        if x.ndim != 2 or x.shape[0] < LEAST or x.shape[1] < 1:
            raise SignalError(
                f"{self._where}a recording of shape {x.shape}: expected {LEAST} samples or more by channels"
            )
        if not (np.isfinite(self.rate) and self.rate > 0.0):
            raise SignalError(f"{self._where}rate = {self.rate}: expected a sampling rate above 0 Hz")
        if not (np.min(x) > -HUGE and np.max(x) < HUGE):
            bad = np.argwhere(~(np.abs(x) < HUGE))
            place, channel = bad[0]
            raise SignalError(
                f"{self._where}sample {place} of channel {channel + 1} is {x[place, channel]:g}, one of {len(bad)}: "
                f"expected finite values below {HUGE:g}"
            )
        if len(self.names) != x.shape[1] or len(self.units) != x.shape[1]:
            raise SignalError(f"{len(self.names)} names and {len(self.units)} units for {x.shape[1]} channels")
        clock = {name: _clocked(name, given) for name, given in self.braking.items()}
        for name, value in (("samples", x), ("rate", float(self.rate)), ("braking", clock)):
            object.__setattr__(self, name, value)

    @property
    def _where(self) -> str:
        return f"{self.source}: " if self.source else ""

    @property
    def t(self) -> Any:
        """Times [s], from 0 on."""
        return np.arange(len(self.samples)) / self.rate

    @property
    def duration(self) -> float:
        """Length [s]."""
        return len(self.samples) / self.rate

    def index(self, channel: int | str) -> int:
        """The index of a channel given by index or name."""
        found = self.names.index(channel) if channel in self.names else channel
        if isinstance(found, str) or not 0 <= found < len(self.names):
            raise SignalError(
                f"{self._where}channel = {channel!r}: expected 0 to {len(self.names) - 1} or a name of {self.names}"
            )
        return int(found)

    def channel(self, channel: int | str = 0) -> Any:
        """The samples of one channel, shape (k,)."""
        return self.samples[:, self.index(channel)]

    def calibrated(self, channel: int | str = 0) -> bool:
        """Whether the channel is a sound pressure in Pa."""
        return self.units[self.index(channel)] == "Pa"

    def at(self, name: str, time: float) -> float:
        """A quantity of the braking at `time` [s]; NaN where it was not recorded."""
        if name not in self.braking:
            return float("nan")
        times, values = self.braking[name]
        return float(np.interp(time, times, values, left=np.nan, right=np.nan))

    def mean_of(self, name: str) -> float:
        """Mean over time of a quantity of the braking, as far as it was recorded meanwhile; NaN where it was not."""
        times, values = self.braking[name]
        begin, end = max(0.0, times[0]), min(self.duration, times[-1])
        if not begin < end:
            return float("nan")
        clock = np.unique(np.clip(np.concatenate([[begin, end], times]), begin, end))
        return float(np.trapezoid(np.interp(clock, times, values), clock) / (end - begin))


def as_recording(signal: Recording | ArrayLike, rate: float | None, unit: str) -> Recording:
    """A `Recording` as it is; samples (k,) or (k, channels) with their `rate` [Hz] as one, in `unit`.

    Raises `SignalError` when the rate is missing.
    """
    if isinstance(signal, Recording):
        return signal
    if rate is None:
        raise SignalError("rate is missing: expected the sampling rate in Hz, or a Recording")
    count = 1 if np.ndim(signal) == 1 else np.shape(signal)[1]
    return Recording(signal, rate, tuple(f"channel {i + 1}" for i in range(count)), (unit,) * count)


@public()
def read_recording(
    path: str | os.PathLike[str],
    *,
    unit: str = "",
    full_scale: float | Sequence[float] | None = None,
    rate: float | None = None,
    braking: Mapping[str, tuple[Any, Any]] | None = None,
) -> Recording:
    """The recording in a file: .wav, .flac and other sound files, .csv, .npy, .uff or .unv (type 58).

    Parameters
    ----------
    path : the file
    unit : "Pa" or "g" or another, of the channels; left out, what the file says of itself, else full scale
    full_scale : what a value of 1 of a sound file, or one unit of the numbers of another, is worth in `unit`; a
        number, or one for each channel
    rate : sampling rate [Hz], where the file has none (.npy, .csv without times)
    braking : {"speed": (times [s], values), ...}, in any units, on clocks of their own

    Raises `SignalError`, one sentence with the file's name, for a file that cannot be read or used. Memory stays in
    proportion to the file's size.
    """
    path = Path(path)
    readers = {".csv": _csv, ".txt": _csv, ".npy": _npy, ".uff": _uff, ".unv": _uff, ".uf58": _uff}
    try:
        size = path.stat().st_size
        if not path.is_file():
            raise SignalError(f"{path.name}: is not a file")
        if size > LARGEST:
            raise SignalError(f"{path.name}: has {size} bytes, expected at most {LARGEST}")
        reader = readers.get(path.suffix.lower(), _sound)
        x, own_rate, names, units, notes = reader(path, size, rate)
    except OSError as error:
        raise SignalError(f"{path.name}: cannot be read: {error.strerror or error}") from error
    except MemoryError as error:
        raise SignalError(f"{path.name}: does not fit into memory") from error
    except SignalError as error:
        raise SignalError(str(error) if path.name in str(error) else f"{path.name}: {error}") from error
    notes = [*notes, *_clipping(x, names)]
    if unit:
        units = [unit] * len(names)
    if full_scale is not None:
        scale = np.broadcast_to(np.asarray(full_scale, dtype=float), (len(names),))
        if not np.all(np.isfinite(scale) & (scale > 0.0)):
            raise SignalError(f"full_scale = {full_scale}: expected numbers above 0")
        x = x * scale
    elif reader is _sound:
        units = ["FS"] * len(names)
    missing = [name for name, each in zip(names, units, strict=True) if each in ("", "FS")]
    if missing:
        notes.append(f"no calibration of {', '.join(missing)}: levels are in dB re full scale")
        units = ["FS" if each == "" else each for each in units]
    return Recording(x, own_rate, tuple(names), tuple(units), dict(braking or {}), tuple(notes), path.name)


Read = tuple[Any, float, list[str], list[str], list[str]]  # samples, rate, names, units, notes


def _sound(path: Path, size: int, rate: float | None) -> Read:
    try:
        import soundfile
    except (ImportError, OSError) as error:
        raise SignalError(f"{path.name}: reading sound files needs soundfile: {INSTALL}") from error
    try:
        with soundfile.SoundFile(str(path)) as file:
            channels, own, kind = file.channels, float(file.samplerate), file.subtype
            if channels * file.frames > DENSEST * size:
                raise SignalError(f"{path.name}: says it has {file.frames} frames, but is not as long as that")
            blocks, count = [], 0
            while True:
                block = file.read(BLOCK, dtype="float64", always_2d=True)
                count += block.size
                if not len(block) or count > DENSEST * size:
                    break
                blocks.append(block)
    except (soundfile.LibsndfileError, RuntimeError, TypeError, ValueError) as error:
        if isinstance(error, SignalError):
            raise
        raise SignalError(
            f"{path.name}: is not a sound file that can be read: {' '.join(str(error).split())[:120]}"
        ) from error
    if not blocks:
        raise SignalError(f"{path.name}: holds no samples")
    notes = ["its samples have 8 bits: what is 48 dB below full scale is lost"] if kind in ("PCM_U8", "PCM_S8") else []
    return np.concatenate(blocks), own, [f"channel {i + 1}" for i in range(channels)], ["FS"] * channels, notes


def _csv(path: Path, size: int, rate: float | None) -> Read:
    if size > LARGEST_TEXT:
        raise SignalError(f"{path.name}: has {size} bytes, expected at most {LARGEST_TEXT} of a text")
    try:
        rows = [row for _, row in cells(path.read_bytes())]
    except ValueError as error:
        raise SignalError(f"{path.name}: is not a .csv file of numbers") from error
    if not rows:
        raise SignalError(f"{path.name}: is empty")
    head = None if _is_number(rows[0][0]) else [cell.strip() for cell in rows.pop(0)]
    width = len(rows[0]) if rows else 0
    try:
        table = np.array([[float(cell) for cell in row] for row in rows])
    except ValueError as error:
        place = next(((i, c) for i, row in enumerate(rows) for c in row if not _is_number(c)), None)
        shown = f"{place[1].strip()[:30]!r} is not a number" if place else "rows of different lengths"
        raise SignalError(f"{path.name}: row {place[0] + 1 if place else '?'}: {shown}") from error
    if table.ndim != 2 or len(table) < LEAST or (head is not None and len(head) != width):
        raise SignalError(
            f"{path.name}: {len(rows)} rows of {width} numbers: expected {LEAST} rows or more of one length"
        )
    names = head or [f"channel {i + 1}" for i in range(width)]
    first = names[0].lower().split("[")[0].split("(")[0].strip()
    if head is not None and first in ("t", "time", "zeit", "temps"):
        factor = 1e-3 if "ms" in names[0] else 1.0
        times, table, names = table[:, 0] * factor, table[:, 1:], names[1:]
        if not names:
            raise SignalError(f"{path.name}: holds times only")
        if not np.all(np.isfinite(times)):
            raise SignalError(f"{path.name}: row {int(np.argmin(np.isfinite(times))) + 1}: the time is not finite")
        rounding = last_digits([row[0] for row in rows]) * factor
        if not equal_steps(times, rounding):
            raise SignalError(f"{path.name}: {_uneven(times, rounding)}")
        rate = (len(times) - 1) / (times[-1] - times[0])
    if rate is None:
        raise SignalError(f"{path.name}: has no column of times: expected a first column 't [s]', or rate= in Hz")
    units = [name.partition("[")[2].partition("]")[0].strip() for name in names]
    return table, rate, [name.partition("[")[0].strip() or name for name in names], units, []


def _uneven(times: np.ndarray, rounding: np.ndarray) -> str:
    """Why a column of times will not do: too few digits, or which step is unlike the others."""
    steps = np.diff(times)
    usual = float(np.median(steps))
    if np.max(rounding) > COARSEST * (times[-1] - times[0]) / len(steps):
        return (
            f"the times are written to {np.max(rounding):g} s, too coarse for steps of {usual:g} s: expected more "
            "digits, or no column of times and the sampling rate instead"
        )
    worst = int(np.argmax(np.abs(steps - usual)))
    return (
        f"the times are not equally spaced: expected equal steps, but after {times[worst]:g} s comes "
        f"{times[worst + 1]:g} s where the step is {usual:g} s elsewhere"
    )


def _npy(path: Path, size: int, rate: float | None) -> Read:
    if rate is None:
        raise SignalError(f"{path.name}: has no sampling rate: expected rate= in Hz")
    try:
        mapped = np.load(path, mmap_mode="r", allow_pickle=False)
        if mapped.dtype.kind not in "fiu" or mapped.ndim not in (1, 2):
            raise SignalError(
                f"{path.name}: holds {mapped.ndim} axes of {mapped.dtype}: expected one or two of real numbers"
            )
        x = np.array(mapped, dtype=float)
    except (ValueError, TypeError, EOFError, SyntaxError, TokenError, RecursionError, OverflowError) as error:
        if isinstance(error, SignalError):
            raise
        raise SignalError(f"{path.name}: is not a NumPy .npy file of numbers") from error
    x = x[:, None] if x.ndim == 1 else x if x.shape[0] >= x.shape[1] else x.T
    return x, float(rate), [f"channel {i + 1}" for i in range(x.shape[1])], [""] * x.shape[1], []


def _uff(path: Path, size: int, rate: float | None) -> Read:
    found = [each for each in universal_sets(path) if each.get("type") == 58 and len(each.get("data", ())) > 0]
    found = [each for each in found if each.get("func_type") in (None, 0, 1)]
    if not found:
        raise SignalError(f"{path.name}: holds no time response (data set 58): it is empty, damaged or of another kind")
    steps = {(len(each["data"]), float(each.get("abscissa_inc") or 0.0)) for each in found}
    if len(steps) > 1:
        raise SignalError(f"{path.name}: its channels have different lengths or sampling rates, expected one")
    ((_, step),) = steps
    times = np.asarray(found[0].get("x", ()), dtype=float)
    step = float((times[-1] - times[0]) / (len(times) - 1)) if not step > 0.0 and len(times) > 1 else step
    if not (np.isfinite(step) and step > 0.0):
        raise SignalError(f"{path.name}: has a step of {step} s: expected equal steps above 0")
    own = 1.0 / step
    whole = round(own)
    own = float(whole) if whole > 0 and abs(own - whole) < 5e-6 * own else own  # a step is kept to six digits
    data = [np.asarray(each["data"]) for each in found]
    if any(np.iscomplexobj(each) for each in data):
        raise SignalError(f"{path.name}: holds complex numbers, expected a time response")
    x = np.stack([each.astype(float) for each in data], axis=1)
    names = [str(each.get("id1") or f"channel {i + 1}").strip() for i, each in enumerate(found)]
    names = [
        f"channel {i + 1}" if name in ("NONE", "") or names.count(name) > 1 else name for i, name in enumerate(names)
    ]
    units = [str(each.get("ordinate_axis_units_lab") or "").strip().replace("NONE", "") for each in found]
    return x, own, names, units, []


def universal_sets(path: Path) -> list[dict[str, Any]]:
    """The data sets of a universal file. Raises `SignalError` for one that cannot be read."""
    size = path.stat().st_size
    if size > LARGEST_TEXT:
        raise SignalError(f"{path.name}: has {size} bytes, expected at most {LARGEST_TEXT} of a UFF file")
    try:
        import pyuff
    except ImportError as error:
        raise SignalError(f"{path.name}: reading UFF files needs pyuff: {INSTALL}") from error
    try:
        sets = pyuff.UFF(str(path)).read_sets()
    except Exception as error:  # a damaged file makes it raise whatever comes
        raise SignalError(f"{path.name}: is not a UFF file that can be read ({type(error).__name__})") from error
    return [each for each in ([sets] if isinstance(sets, dict) else list(sets)) if isinstance(each, dict)]


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return True


def _clipping(x: np.ndarray, names: Sequence[str]) -> list[str]:
    """A sentence for each channel that stands at its largest value for several samples on end, more than once."""
    notes = []
    for i, name in enumerate(names):
        top = np.max(np.abs(x[:, i])) if np.all(np.isfinite(x[:, i])) else 0.0
        at = np.abs(x[:, i]) >= top * (1.0 - 1e-9)
        runs = np.convolve(at.astype(int), np.ones(CLIPPED, dtype=int), mode="valid") == CLIPPED
        share = float(np.mean(at))
        if top > 0.0 and share < 0.5 and np.count_nonzero(np.diff(runs.astype(int)) == 1) > 1:
            notes.append(
                f"{name} is clipped: {100.0 * share:.2g} % of its samples are at {top:.4g}, so levels are too low"
            )
    return notes


def _clocked(name: str, given: tuple[Any, Any]) -> tuple[Any, Any]:
    try:
        times, values = (np.asarray(each, dtype=float) for each in given)
    except (TypeError, ValueError) as error:
        raise SignalError(f"braking[{name!r}]: expected times [s] and values") from error
    if times.ndim != 1 or times.shape != values.shape or times.size < 2 or np.any(np.diff(times) <= 0.0):
        raise SignalError(f"braking[{name!r}]: expected increasing times [s] with a value each, two or more")
    if not (np.all(np.isfinite(times)) and np.all(np.isfinite(values))):
        raise SignalError(f"braking[{name!r}]: expected finite times and values")
    return times, values

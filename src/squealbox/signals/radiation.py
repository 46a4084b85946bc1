"""An estimate of how loud a vibrating surface is: a flat circular piston in a rigid wall, line by line.

A surface of area S = pi a^2 moves as one with the velocity v; half space in front of it, nothing reflects. Each line of
its spectrum, of angular frequency omega = c k and amplitude v, radiates the power

    W = rho c S sigma(k a) v^2 / 2,      sigma(x) = 1 - J1(2 x) / x        (x^2 / 2 for small x: a monopole)

and, spread over the half sphere of radius r, W = 2 pi r^2 p_rms^2 / (rho c), so that

    p_rms = rho c (v / sqrt 2) sqrt(S sigma / (2 pi)) / r                  (rho f S v_rms / r for small k a)

Powers of lines add. The level is 20 log10(p_rms / 20 uPa); A-weighting is that of IEC 61672-1. Source of sigma and of
the monopole: Kinsler, Frey, Coppens and Sanders, Fundamentals of Acoustics, 4th edition, sections 7.2 to 7.5; Morse and
Ingard, Theoretical Acoustics, section 7.4.
"""

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from squealbox.arguments import public
from squealbox.result import Array, Outcome, Result, quantity
from squealbox.signals.sampling import SignalError, column, folded, given
from squealbox.signals.spectra import peaks, spectrum
from squealbox.words import AUDIBLE, level_told

DENSITY = 1.204  # of air at 20 degC and 101.325 kPa [kg/m^3]
SPEED_OF_SOUND = 343.2  # in air at 20 degC [m/s]
HEARING = 20e-6  # reference pressure [Pa]
AREA = 0.01  # of the piston unless said otherwise [m^2]: a disc of 11 cm, about a drum's web or a pad's back plate


@dataclass(frozen=True, kw_only=True, eq=False)
class SoundLevel(Result):
    """An estimated sound pressure level, as :func:`sound_level` returns it.

    The outcome is "completed" or "silent" (nothing moves at a frequency people hear; the levels are then -inf).
    """

    level: Any = quantity("", "dB", "sound pressure level re 20 uPa")
    weighted: Any = quantity("", "dB(A)", "A-weighted sound pressure level")
    pressure: Any = quantity("", "Pa", "root mean square of the sound pressure")
    power: Any = quantity("", "W", "radiated sound power")
    frequency: Array = quantity("line", "Hz", "lines of the spectrum, loudest first")
    line_level: Array = quantity("line", "dB", "sound pressure level of each line")
    velocity: Array = quantity("line", "m/s", "amplitude of the surface velocity of each line")
    efficiency: Array = quantity("line", "1", "radiation efficiency of each line")

    coordinates: ClassVar = {"line": "frequency"}

    @property
    def assumption(self) -> str:
        """What the estimate rests on, in one sentence to print beside the number."""
        area, distance = self.settings["area"], self.settings["distance"]
        fixed = self.settings["efficiency"]
        how = "" if fixed is None else f" with radiation efficiency {fixed:g}"
        return (
            f"Estimate: a surface of {1e4 * area:.4g} cm² moves as a whole with the model's velocity, as a piston in a "
            f"wall{how}, heard at {distance:g} m in the open; a real part bends, and so is louder or quieter by 10 dB "
            "or more."
        )

    def summary(self) -> str:
        """The level, the loudest line, and what it rests on."""
        if not self.outcome.ok:
            return self.outcome.told
        loudest = f"loudest at {float(self.frequency[0]):.5g} Hz"
        return f"{level_told(self.level, self.weighted)}, {loudest}. {self.assumption}"


@public()
def sound_level(
    velocity: Any,
    t: ArrayLike | None = None,
    *,
    area: float = AREA,
    distance: float = 1.0,
    efficiency: float | None = None,
    lines: int = 12,
    **cut: Any,
) -> SoundLevel:
    """The sound pressure level that a surface moving with `velocity` would make: an estimate, not a prediction.

    Parameters
    ----------
    velocity, t : array (k,) [m/s] with its times [s], equal steps; or `rate` [Hz]
    area : of the surface [m^2]
    distance : from it [m]; expected well above its size and a sixth of the wavelength (far field)
    efficiency : radiation efficiency of every line [-]; None takes the piston's, sigma(k a)
    lines : most lines of the spectrum that count; those 30 dB below the highest are left out
    cut : `begin`, `end` [s], `dof`

    Returns
    -------
    SoundLevel, of the lines between 20 Hz and 20 kHz

    Raises `SignalError` for an area, distance or efficiency that is not positive, and as :func:`samples` does.

    Limits
    ------
    The level holds while the motion lasts as it is: a decaying one is taken at its mean. Bending, the body that carries
    the sound, reflections and other parts that radiate are not in it; its own digits are better than what they do.
    A halved velocity takes 6 dB away whatever the surface, so differences of levels can be trusted more than levels.

    >>> t = np.arange(8820) / 44100.0
    >>> loud = sound_level(0.1 * np.sin(2 * np.pi * 2000.0 * t), t)
    >>> round(float(loud.level) - float(sound_level(0.05 * np.sin(2 * np.pi * 2000.0 * t), t).level), 2)
    6.02
    """
    for name, value in (("area", area), ("distance", distance), ("efficiency", efficiency)):
        if value is not None and not (np.isfinite(value) and value > 0.0):
            raise SignalError(f"{name} = {value}: expected a number above 0")
    if few := folded(velocity):
        raise SignalError(few)
    if hasattr(velocity, "qd"):
        place = column(velocity, cut.pop("dof", 0))
        velocity, t = velocity.qd[:, place], velocity.t
    settings = {"area": area, "distance": distance, "efficiency": efficiency, "lines": lines, **given(cut)}
    found = _lines(velocity, t, lines, cut)
    heard = (found[0] >= AUDIBLE[0]) & (found[0] <= AUDIBLE[1])
    frequency, speed = (column[heard] for column in found)
    sigma = np.full(frequency.shape, efficiency) if efficiency is not None else piston_efficiency(frequency, area)
    power = 0.5 * DENSITY * SPEED_OF_SOUND * area * sigma * speed**2
    square = DENSITY * SPEED_OF_SOUND * power / (2.0 * np.pi * distance**2)
    order = np.argsort(-square, kind="stable")
    silent = Outcome("silent", "nothing moves at a frequency between 20 Hz and 20 kHz")
    return SoundLevel(
        level=_decibel(np.sum(square)),
        weighted=_decibel(np.sum(square * a_weighting(frequency) ** 2)),
        pressure=np.sqrt(np.sum(square)),
        power=np.sum(power),
        frequency=frequency[order],
        line_level=_decibel(square[order]),
        velocity=speed[order],
        efficiency=sigma[order],
        settings=settings,
        outcome=Outcome() if np.any(square > 0.0) else silent,
    )


def piston_efficiency(frequency: ArrayLike, area: float) -> Any:
    """Radiation efficiency sigma = 1 - J1(2 k a) / (k a) [-] of a circular piston of `area` [m^2] in a rigid wall.

    Array in, array out.
    """
    from scipy.special import j1

    x = np.asarray(2.0 * np.pi * np.asarray(frequency, dtype=float) / SPEED_OF_SOUND * np.sqrt(area / np.pi))
    with np.errstate(divide="ignore", invalid="ignore"):
        exact = 1.0 - j1(2.0 * x) / x
    return np.where(x < 1e-2, 0.5 * x**2 * (1.0 - x**2 / 6.0), exact)  # the series: exact to x^4/12 of itself, 1e-9


def a_weighting(frequency: ArrayLike) -> Any:
    """Factor [-] of A-weighting on a pressure at `frequency` [Hz], array in, array out (IEC 61672-1, annex E)."""
    f = np.asarray(frequency, dtype=float) ** 2
    low, first, second, high = (value**2 for value in (20.598997, 107.65265, 737.86223, 12194.217))
    response = high * f**2 / ((f + low) * (f + high) * np.sqrt((f + first) * (f + second)))
    return response * 10.0 ** (2.0 / 20.0)  # +2.00 dB, which the standard adds to bring 1 kHz to 0 dB


def _lines(velocity: Any, t: Any, most: int, cut: dict[str, Any]) -> tuple[Any, Any]:
    """Frequencies [Hz] and amplitudes [m/s] of the lines of a velocity; none where it stands still."""
    found = spectrum(velocity, t, **cut)
    if not np.any(found.amplitude > 0.0):
        return np.empty(0), np.empty(0)
    lines = peaks(found, most)
    return np.asarray(lines.frequency), np.asarray(lines.amplitude)


def _decibel(square: float | np.ndarray) -> Any:
    with np.errstate(divide="ignore"):
        return 10.0 * np.log10(square / HEARING**2)

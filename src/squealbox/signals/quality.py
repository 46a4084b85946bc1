"""How a squeal sounds to people: loudness, sharpness, roughness and prominence, by the optional library mosqito."""

import contextlib
import io
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from squealbox.arguments import public
from squealbox.extras import extra
from squealbox.result import Array, Result, quantity
from squealbox.signals.recordings import Recording, as_recording
from squealbox.signals.sampling import SignalError
from squealbox.signals.wav import resampled

RATE = 48000  # [Hz] the standards are written for
LEAST = 0.2  # s that a stationary sound must last


@dataclass(frozen=True, kw_only=True, eq=False)
class SoundQuality(Result):
    """What people hear of a stationary sound, as :func:`sound_quality` returns it."""

    loudness: Any = quantity("", "sone", "Zwicker's loudness, ISO 532-1, free field")
    loudness_level: Any = quantity("", "phon", "the level of a tone of 1 kHz that is as loud")
    sharpness: Any = quantity("", "acum", "DIN 45692")
    roughness: Any = quantity("", "asper", "Daniel and Weber 1997, mean over time")
    specific_loudness: Array = quantity("bark", "sone/bark", "loudness in each critical band")
    bark: Array = quantity("bark", "bark", "critical bands")

    def summary(self) -> str:
        """The four numbers."""
        return (
            f"loudness {self.loudness:.4g} sone ({self.loudness_level:.4g} phon), sharpness {self.sharpness:.3g} acum, "
            f"roughness {self.roughness:.3g} asper"
        )


@public()
def sound_quality(
    recording: Recording | ArrayLike,
    rate: float | None = None,
    *,
    channel: int | str = 0,
    begin: float | None = None,
    end: float | None = None,
) -> SoundQuality:
    """Loudness, sharpness and roughness of a stretch of sound that is about stationary.

    Parameters
    ----------
    recording : a `Recording` whose channel is in Pa, or samples (k,) in Pa with `rate` [Hz]
    channel : index or name
    begin, end : the stretch [s]; left out, all of it

    Source: ISO 532-1:2017 (loudness of stationary sounds), DIN 45692, Daniel and Weber 1997, Acustica 83, 113-123, as
    mosqito computes them. A level says little of a squeal's annoyance; these say more. Raises `SignalError` where the
    channel is not in Pa or lasts less than 0.2 s, `MissingExtra` without mosqito.
    """
    with extra("sound"):
        from mosqito.sq_metrics import loudness_zwst, roughness_dw, sharpness_din_from_loudness, sone_to_phon
    heard = as_recording(recording, rate, "Pa")
    if not heard.calibrated(channel):
        unit = heard.units[heard.index(channel)]
        raise SignalError(f"channel {channel!r} is in {unit}: loudness needs a sound pressure in Pa (unit, full_scale)")
    keep = (heard.t >= (begin or 0.0)) & (heard.t <= (np.inf if end is None else end))
    x = heard.channel(channel)[keep]
    if x.size < LEAST * heard.rate:
        raise SignalError(f"the stretch lasts {x.size / heard.rate:.3g} s: expected {LEAST} s or more")
    x = resampled(x, Fraction(RATE / heard.rate).limit_denominator(1000))
    with contextlib.redirect_stdout(io.StringIO()):  # it prints what it does
        total, specific, bark = loudness_zwst(x, RATE)
        sharpness = sharpness_din_from_loudness(total, specific)
        rough, *_ = roughness_dw(x, RATE, overlap=0.0)  # frames side by side: half the time for as much sound
    return SoundQuality(
        loudness=np.asarray(float(total)), loudness_level=np.asarray(float(sone_to_phon(total))),
        sharpness=np.asarray(float(np.squeeze(sharpness))), roughness=np.asarray(float(np.mean(rough))),
        specific_loudness=np.asarray(specific, dtype=float), bark=np.asarray(bark, dtype=float),
        settings={"channel": str(channel), "begin": begin, "end": end},
    )  # fmt: skip

"""`squealbox dither`: what fast tangential dither does to a brake, on the mean."""

from pathlib import Path

import numpy as np

from squealbox.cli.answers import written
from squealbox.cli.inputs import NOTHING_SAID, Said, folder, number, read
from squealbox.cli.options import AS_WRITTEN, Asked
from squealbox.cli.running import UsageError
from squealbox.countermeasures import Dithered, DitherSettings
from squealbox.parameters import with_cautions
from squealbox.stability import complex_modes
from squealbox.writing import write_table

ABOUT = {"dither": "fast dither of the sliding: growth rate and friction left over its amplitude"}


def dither(
    file: Path,
    *,
    velocity: tuple[str, str] = ("0.01 m/s", "1 m/s"),
    how: Said[DitherSettings] = NOTHING_SAID,
    asked: Asked = AS_WRITTEN,
    out: Path | None = None,
) -> None:
    """Fast dither of the sliding velocity: growth rate and mean friction left over its amplitude.

    Parameters
    ----------
    file
        design file
    velocity
        lowest and highest amplitude, with or without a unit: 0.01 1
    out
        folder for the table
    """
    found, settings = read(file, asked), how.over(DitherSettings())
    low, high = (number(text, "m/s", f"--velocity {text[:60]}") for text in velocity)
    if not 0.0 < low < high:
        raise UsageError(f"--velocity {' '.join(velocity)}: expected 0 < low < high")
    folder(out, "dither")
    amplitudes = np.geomspace(low, high, int(settings.points))
    cures = [Dithered(found.design, float(w), settings.frequency, settings.along) for w in amplitudes]
    growth = np.array([float(complex_modes(cure).largest_growth_rate) for cure in cures])
    left = np.array([float(np.min(cure.friction_left)) for cure in cures])
    print(f"{found.design.title}, {file}\nvelocity [m/s]  growth [1/s]  least mean friction left [%]")
    for w, g, part in zip(amplitudes, growth, left, strict=True):
        print(f"{w:14.5g}  {g:+12.5g}  {100.0 * part:10.3g}")
    said = dict.fromkeys(text for cure in (cures[0], cures[-1]) for text in cure.cautions())
    print(with_cautions([], *said))
    if out is not None:
        columns = {"velocity [m/s]": amplitudes, "growth rate [1/s]": growth, "friction left [-]": left}
        print(written(write_table(out / "dither.csv", columns)))

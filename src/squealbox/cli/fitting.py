"""`squealbox fit`: measured friction coefficients to a friction law."""

from pathlib import Path

from squealbox.cli.answers import show, written
from squealbox.cli.inputs import folder
from squealbox.cli.running import ComputationFailed
from squealbox.files import read_points
from squealbox.fit import fit_friction
from squealbox.writing import write

ABOUT = {"fit": "measured friction coefficients (CSV) to a friction law, with confidence bands"}


def fit(file: Path, *, law: tuple[str, ...] = (), level: float = 0.95, out: Path | None = None) -> None:
    """Fit friction laws to measured points, with confidence bands; the law with the least AIC comes first.

    Parameters
    ----------
    file
        CSV file of two columns, sliding speed and friction coefficient; a first line of names may tell their units,
        "v [km/h], mu [%]", else they are m/s and 1, and of more columns which are meant; titles above it, decimal
        commas and a byte order mark are read
    law
        laws to try: coulomb, linear_slope, stribeck, hyperbolic, cubic, which are all when left out; lugre and
        elasto_plastic by their curve of steady sliding
    level
        confidence level of the bands, and of what stands behind +-
    out
        folder for the figure, the curves and fit.nc
    """
    folder(out, "fit")
    found = fit_friction(*read_points(file), law=law or None, level=level)
    if not found.outcome.ok:
        raise ComputationFailed(found.outcome)
    show(f"{found.speeds.size} points, {file}", found)
    best = found.law
    numbers = ", ".join(f"{name} = {value:.6g}" for name, _, value in best.leaves() if value is not None)
    print(f'in a design file: friction = {{ law = "{found.names[found.best]}", {numbers} }}')
    if out is not None:
        print(written(*write(found, out, "fit")))

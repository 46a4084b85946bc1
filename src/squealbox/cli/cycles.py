"""`squealbox cycle`: what the motion settles to."""

from pathlib import Path

import numpy as np

from squealbox.cli.inputs import Changes, folder, read
from squealbox.cli.running import ComputationFailed
from squealbox.cli.tables import written
from squealbox.limit_cycles import shooting


def cycle(file: Path, *, changes: Changes = (), out: Path | None = None) -> None:
    """What does the motion settle to? The limit cycle, with stick and slip, and its Floquet multipliers.

    Parameters
    ----------
    file
        design file; squealbox init writes a first one
    changes
        other values for this run: --set friction.static=0.45
    out
        folder for cycle.nc, cycle.png and cycle.svg
    """
    found = read(file, changes)
    result = shooting(found.design)
    if not result.outcome.ok:
        raise ComputationFailed(result.outcome)
    print(f"{found.design.title}, {file}\n{result.summary()}")
    print("Floquet multipliers: " + ", ".join(f"{value:.6g}" for value in np.abs(result.multipliers)) + " (absolute)")
    if result.caution:
        print(f"Note: {result.caution}")
    if out is not None:
        from squealbox import plots

        folder(out)
        print(written(result.save(out / "cycle.nc"), *plots.save(plots.plot(result), out / "cycle")))

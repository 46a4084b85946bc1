"""`squealbox cycle`: what the motion settles to."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from squealbox.cli.answers import show, written
from squealbox.cli.inputs import NOTHING_SAID, Said, folder, in_motion, read
from squealbox.cli.options import AS_WRITTEN, Asked
from squealbox.cli.running import ComputationFailed, UsageError
from squealbox.cli.states import States, start_from
from squealbox.limit_cycles import LOST, Cycle, CycleSettings, lyapunov_exponents, shooting
from squealbox.stability import complex_modes
from squealbox.transient import simulate
from squealbox.writing import write

ABOUT = {"cycle": "what the motion settles to: the limit cycle, its stability, figure and data"}

if TYPE_CHECKING:
    from squealbox.design import Design

SETTLE = 300.0  # periods of the slowest mode
ALIGNED = 50  # periods run before exponents are counted


def cycle(
    file: Path,
    *,
    start: States = (),
    how: Said[CycleSettings] = NOTHING_SAID,
    asked: Asked = AS_WRITTEN,
    out: Path | None = None,
) -> None:
    """What does the motion settle to? The limit cycle, with stick and slip, and its Floquet multipliers.

    Parameters
    ----------
    file
        design file; squealbox init writes a first one
    start
        of the run that leads to the cycle: rest, sliding, or states such as x=1mm "y'=0.2 m/s" (a prime is a velocity),
        the others as in steady sliding; left out, along the most unstable mode, else from rest
    out
        folder for cycle.nc, cycle.csv and the figure
    """
    settings = how.over(CycleSettings())
    found = in_motion(read(file, asked))
    begin = start_from(found.design.system(), start)
    if settings.period is not None and begin is None:
        raise UsageError(f"--period {settings.period:g}: expected --start with the state that is on the cycle")
    folder(out, "cycle")
    guess = begin if settings.period is None or begin is None else (*begin, settings.period)
    result, exponents = shooting(found.design, guess, settle=settings.settle), int(settings.exponents)
    if not result.outcome.ok:
        if exponents:
            print(f"{found.design.title}, {file}\n{_of_the_motion(found.design, exponents)}")
        raise ComputationFailed(result.outcome)
    show(f"{found.design.title}, {file}", result)
    print("Floquet multipliers: " + ", ".join(f"{value:.6g}" for value in np.abs(result.multipliers)) + " (absolute)")
    if exponents:
        print(_beside_multipliers(result, exponents))
    if out is not None:
        print(written(*write(result, out, "cycle")))


def _beside_multipliers(cycle: Cycle, periods: int) -> str:
    """Lyapunov exponents of the motion on a cycle, and what its multipliers say they are: log|m|/T."""
    found = lyapunov_exponents(cycle.system, cycle.start, float(cycle.period), periods, aligned=ALIGNED)
    sizes = np.abs(cycle.multipliers)
    with np.errstate(divide="ignore"):
        expected = np.sort(np.log(np.where(sizes > LOST, sizes, 0.0)) / float(cycle.period))[::-1]
    return (f"Lyapunov exponents over {periods} periods: {_listed(found)} 1/s\n"
            f"  by the multipliers, log|m|/T: {_listed(expected)} 1/s")  # fmt: skip


def _of_the_motion(design: "Design", periods: int) -> str:
    """Lyapunov exponents of where the motion from rest has come to, over periods of the slowest mode."""
    rates = complex_modes(design).angular_frequency
    slow = 2.0 * np.pi / float(np.min(rates[rates > 0.0]))
    motion = simulate(design, SETTLE * slow)
    found = lyapunov_exponents(design, (motion.q[-1], motion.qd[-1]), slow, periods, aligned=ALIGNED)
    if np.isnan(found[0]):
        return "Lyapunov exponents: the motion from rest does not go on"
    error = 3.0 / (periods * slow)
    kind = "more than 0: the motion is chaotic" if found[0] > error else "not above 0 by more than it is uncertain"
    return f"Lyapunov exponents over {periods} periods of {slow:.4g} s: {_listed(found)} 1/s; the largest is {kind}"


def _listed(values: Any) -> str:
    return ", ".join(f"{value:.5g}" for value in values)

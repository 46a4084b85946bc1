"""A motion followed for a panel: with its progress, and with an end as soon as nobody waits for it."""

from typing import Any

from squealbox.design import Design
from squealbox.fe import ReducedBrake
from squealbox.system import System
from squealbox.transient import LARGE, Trajectory, needs_compiling, simulate
from squealbox.workbench.panels.panel import Elsewhere, OptionError, Work

COMPILING = "compiling the kernel for this design, which happens once"
SECONDS = 4.0  # of an idle processor of 2020 and later, for the kernel with exact contacts


def moving(design: Design) -> System:
    """The system of a design as its motion is followed: a finite-element brake slides along its own way only.

    Raises `OptionError` for one whose motion takes minutes.
    """
    if not isinstance(design, ReducedBrake):
        return design.system()
    system = design.sliding_one_way().system()
    if system.size * len(system.contacts) > LARGE:
        size = f"{system.size} coordinates and {len(system.contacts)} contacts"
        raise OptionError(f"a motion of {size} takes minutes: squealbox simulate FILE follows it")
    return system


def followed(system: System, duration: float, work: Work, share: float, **how: Any) -> Trajectory:
    """`simulate` with `how`, which takes `share` of the whole work.

    Raises `Elsewhere` where the kernel must be compiled first, unless this is that other process; `Stopped` where
    nobody waits any more, within some hundredths of a second.
    """
    work.progress(0.0, "following the motion")
    if how.get("contact", "exact") == "exact" and not work.apart and needs_compiling(system):
        raise Elsewhere(COMPILING, SECONDS)
    return simulate(
        system,
        duration,
        progress=lambda reached, end, _: work.progress(share * reached / end, "following the motion"),
        **how,
    )

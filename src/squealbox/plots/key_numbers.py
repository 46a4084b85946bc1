"""The key numbers of each kind of result, for a card, a table of a report or a line of a page."""

import dataclasses
from collections.abc import Sequence
from functools import singledispatch
from typing import Any

import numpy as np

from squealbox.limit_cycles import Branch, Cycle
from squealbox.signals import Spectrum, peaks
from squealbox.stability import CriticalValue, StabilityMap
from squealbox.transient import Ensemble, Trajectory, Verdict
from squealbox.words import MINUS, number, plain_unit, read, unit_at

Fact = tuple[str, str, str]  # name, value, unit


@singledispatch
def facts(result: Any) -> list[Fact]:
    """The key numbers of a result as (name, value, unit): its scalars, unless a kind registers others."""
    found = []
    for field in dataclasses.fields(result):
        value = getattr(result, field.name)
        if field.metadata.get("dims") == () or isinstance(value, float):
            found.append((field.name.replace("_", " "), shown(value), plain_unit(field.metadata.get("unit", ""))))
    return found


def shown(value: Any, digits: int = 6) -> str:
    """A number as a reader writes it: complex ones with i, truth values as yes and no, NaN as not known."""
    if np.ndim(value) or isinstance(value, str):
        return str(value)
    if isinstance(value, (bool, np.bool_)) or np.asarray(value).dtype == bool:
        return "yes" if value else "no"
    if np.iscomplexobj(value):
        size = number(abs(float(np.imag(value))), digits)
        return f"{number(float(np.real(value)), digits)} {MINUS if np.imag(value) < 0.0 else '+'} {size} i"
    return "not known" if np.isnan(float(value)) else number(float(value), digits)


@facts.register
def _of_trajectory(motion: Trajectory) -> list[Fact]:
    names = motion.system.names
    found = [("duration", *read(motion.t[-1] - motion.t[0] if len(motion.t) else np.nan, "s"))]
    if len(motion.t):
        found += [(f"half peak to peak of {name}", *read(0.5 * np.ptp(motion.q[:, i]), unit_at(motion.system, i)))
                  for i, name in list(enumerate(names))[:6]]  # fmt: skip
    found.append(("events (stick, slip, lift-off, landing)", str(len(motion.event_time)), ""))
    found.append(("steps, of which rejected", f"{motion.steps}, {motion.rejected}", ""))
    closed = motion.energy.relative_residual if len(motion.t) else np.nan
    return [*found, ("energy audit closes to", f"{closed:.1e}", "of the largest term")]


@facts.register
def _of_verdict(verdict: Verdict) -> list[Fact]:
    found = [
        ("amplitude, half peak to peak", *read(verdict.amplitude, "m")),
        ("frequency", *read(verdict.frequency, "Hz")),
    ]
    if verdict.kind != "settles_on_cycle":
        found.append(("growth rate", *read(verdict.growth_rate, "1/s")))
    return [*found, ("settled at", *read(verdict.settled_at, "s"))] if np.isfinite(verdict.settled_at) else found


@facts.register
def _of_cycle(cycle: Cycle) -> list[Fact]:
    if not cycle.outcome.ok:
        return []
    found = [("period", *read(cycle.period, "s", 6)), ("frequency", *read(cycle.frequency, "Hz", 6))]
    about = zip(cycle.system.names, cycle.amplitude, cycle.system.units, strict=True)
    found += [(f"amplitude of {name}", *read(size, unit)) for name, size, unit in about]
    largest = float(np.max(np.abs(cycle.multipliers[1:]), initial=0.0))
    found.append(("stable", "yes" if cycle.stable else "no", ""))
    return [*found, ("largest multiplier but the trivial one", number(largest, 4), "")]


@facts.register
def _of_critical_value(found: CriticalValue) -> list[Fact]:
    unit = found.unit_of(found.parameter)
    return [
        (found.parameter, shown(found.value, 8), unit),
        ("frequency there", *read(found.frequency, "Hz", 6)),
        ("direction", found.direction, ""),
        ("mechanism", found.mechanism.replace("_", " "), ""),
    ]


@facts.register
def _of_map(found: StabilityMap) -> list[Fact]:
    known, growing = int(np.sum(found.exists)), int(np.sum(found.unstable))
    worst = np.nanmax(found.growth_rate) if known else np.nan
    return [("points", str(found.growth_rate.size), ""), ("unstable", str(growing), f"of {known}"),
            ("largest growth rate", *read(worst, "1/s"))]  # fmt: skip


@facts.register
def _of_spectrum(found: Spectrum) -> list[Fact]:
    return [(f"line {i + 1}", *read(frequency, "Hz", 6)) for i, (frequency, _) in enumerate(peaks(found, 3))]


@facts.register
def _of_branch(branch: Branch) -> list[Fact]:
    if len(branch.value) == 0:
        return []
    unit = branch.unit_of(branch.parameter)
    low, high = float(np.min(branch.value)), float(np.max(branch.value))
    return [
        (branch.parameter, f"{number(low)} to {number(high)}", unit),
        ("points, of which stable", f"{len(branch.value)}, {int(np.sum(branch.stable))}", ""),
        *_largest(branch),
    ]


def _largest(branch: Branch) -> list[Fact]:
    """The largest amplitude, of displacements and of rotations."""
    units = np.array(getattr(branch.inputs.get("system"), "units", ["m"] * branch.amplitude.shape[1]))
    words = {"m": "largest amplitude", "rad": "largest amplitude of rotation"}
    return [(words[unit], *read(np.max(branch.amplitude[:, units == unit]), unit)) for unit in dict.fromkeys(units)]


@facts.register
def _of_ensemble(found: Ensemble) -> list[Fact]:
    names, counts = np.unique(found.ended, return_counts=True)
    ended = ", ".join(f"{count} {name}" for name, count in zip(names, counts, strict=True))
    return [("trajectories", str(np.size(found.ended)), ""), ("ended", ended, ""),
            ("varied", ", ".join(found.parameters) or "nothing", ""),
            ("observed", ", ".join(found.observed) or "nothing", "")]  # fmt: skip


def read_of(names: Sequence[str], dof: int) -> str:
    """What an axis calls the displacement of a freedom: with its name where there are several."""
    return "displacement" if len(names) < 2 else f"displacement {names[dof]}"

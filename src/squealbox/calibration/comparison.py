"""Simulated and measured side by side: frequency, growth, level; and mode shapes by the modal assurance criterion."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from squealbox.calibration.mode_tables import ModeTable
from squealbox.result import Array, Outcome, Result, quantity
from squealbox.signals import BELOW, SignalError, SquealEvents, dominant_frequency, growth_rate, sound_level
from squealbox.stability import modal_assurance
from squealbox.system import as_system
from squealbox.transient import verdict

if TYPE_CHECKING:
    from squealbox.stability import ComplexModes

FAR = 10.0  # standard deviations: what is farther away is no error of the measurement
ONSET = 0.1, 0.02  # of the last amplitude: up to the one it grows freely, below the other it must begin
ROWS, UNITS = ("frequency", "growth rate", "level"), ("Hz", "1/s")  # the level has the unit of the recording


@dataclass(frozen=True, kw_only=True, eq=False)
class Comparison(Result):
    """What was simulated beside one measured event; a number one of the two does not have is NaN."""

    simulated: Array = quantity("row", "", "what the model says")
    measured: Array = quantity("row", "", "what was measured")
    error: Array = quantity("row", "", "95 % error of the measured number; NaN where it has none")
    away: Array = quantity("row", "1", "their distance in standard deviations")

    @property
    def names(self) -> tuple[str, ...]:
        """The rows: frequency, growth rate, level; of a table of modes, frequency, damping ratio and MAC of each."""
        return tuple(self.settings["rows"])

    def summary(self) -> str:
        """A table, one line for each number."""
        lines = [f"{'':12}  {'simulated':>12}  {'measured':>12}  {'95 % error':>10}  distance"]
        for i, name in enumerate(self.names):
            numbers = "  ".join(
                "-".rjust(w) if not np.isfinite(x) else f"{x:{w}.{p}g}"
                for x, w, p in ((self.simulated[i], 12, 7), (self.measured[i], 12, 7), (self.error[i], 10, 2))
            )
            lines.append(f"{name:12}  {numbers}  {self._distance(i)}  {self.settings['units'][i]}")
        head = [] if self.outcome.ok else [self.outcome.told]
        return "\n".join([*head, *lines, *self.settings["notes"]])

    def _distance(self, i: int) -> str:
        """In standard deviations where they can be the reason, else in per cent; as it is without an error."""
        change = self.simulated[i] - self.measured[i]
        if not np.isfinite(change):
            return "-"
        if np.abs(self.away[i]) <= FAR:
            return f"{self.away[i]:+.1f} sd"
        known = np.isfinite(self.away[i]) and self.measured[i] != 0.0
        return f"{100.0 * change / abs(self.measured[i]):+.3g} %" if known else f"{change:+.3g}"


def compare(simulated: Any, events: Any, *, event: int | None = None, dof: int | str = 0) -> Comparison:
    """A motion, a limit cycle or modes beside a squeal event.

    Parameters
    ----------
    simulated : a trajectory (its frequency over the last quarter, its growth, of one that settles that of its onset,
        and the level it would make), a limit cycle (its frequency), or complex modes (frequency and growth of the one
        that grows fastest)
    events : `SquealEvents`; or, beside modes, a `ModeTable` of a test or of another code
    event : which of them; left out, the loudest
    dof : of a motion, the degree of freedom that is heard

    Modes of a table are paired with the model's by MAC over the places that both name, two or more; with fewer, by
    frequency. Raises `SignalError` when there is no such event.
    """
    if isinstance(events, ModeTable):
        return _of_table(simulated, events)
    if not isinstance(events, SquealEvents):
        raise SignalError(f"a {type(events).__name__}: expected squeal_events(recording), or a ModeTable beside modes")
    notes = [note for note in events.settings.get("notes", ()) if BELOW in note]
    if events.count == 0:
        why = [events.outcome.message or "no event", *notes]
        raise SignalError(f"there is nothing to compare with: {'; '.join(why)}")
    index = int(np.argmax(events.level)) if event is None else event
    if not 0 <= index < events.count:
        raise SignalError(f"event = {event}: expected one of {events.count} events")
    model = _said(simulated, dof, notes)
    measured = [float(events.frequency[index]), float(events.growth_rate[index]), float(events.level[index])]
    errors = [float(events.frequency_error[index]), float(events.growth_error[index]), np.nan]
    if events.settings["unit"] != "dB(A)":
        model[2] = np.nan
        notes.append("levels are not compared: the recording has no calibration")
    elif np.isfinite(model[2]):
        notes.append("the simulated level is that of a plain piston: differences of levels mean more than levels")
    units = [*UNITS, events.settings["unit"]]
    sd = np.array(errors) / 1.96
    with np.errstate(divide="ignore", invalid="ignore"):
        away = np.where(sd > 0.0, (np.array(model) - measured) / sd, np.nan)
    told = np.any(np.isfinite(model))
    outcome = Outcome() if told else Outcome("nothing_to_compare", "what was simulated has no frequency")
    return Comparison(
        simulated=np.array(model), measured=np.array(measured), error=np.array(errors), away=away,
        settings={"rows": list(ROWS), "units": units, "event": index, "notes": notes}, outcome=outcome,
    )  # fmt: skip


def _of_table(modes: "ComplexModes", table: ModeTable) -> Comparison:
    """Frequency, damping ratio and MAC of each measured mode and the model's that goes with it."""
    from scipy.optimize import linear_sum_assignment

    if not (hasattr(modes, "right") and hasattr(modes, "frequency")) or np.ndim(modes.frequency) != 1:
        raise SignalError(f"{type(modes).__name__}: expected complex modes of one brake beside a table of modes")
    once = np.nonzero(np.imag(modes.eigenvalues) > 0.0)[0]
    if once.size < table.frequency.size:
        raise SignalError(f"{table.source}: {table.frequency.size} modes beside {once.size} of the model")
    known = list(as_system(modes.inputs["system"], linear=True).names)
    both = [i for i, place in enumerate(table.places) if place in known]
    likeness = np.full((table.frequency.size, once.size), np.nan)
    if len(both) > 1:
        rows = [known.index(table.places[i]) for i in both]
        likeness = modal_assurance(table.shapes[both], modes.right[rows][:, once])
    far = np.abs(np.log(np.maximum(table.frequency, 1e-12)[:, None] / np.maximum(modes.frequency[once], 1e-12)))
    measured, found = linear_sum_assignment(far if len(both) < 2 else 1.0 - likeness + 1e-6 * far)
    lines: list[tuple[str, str, float, float]] = []
    for i, j in zip(measured.tolist(), found.tolist(), strict=True):
        at = once[j]
        lines.append((f"frequency {i + 1}", "Hz", float(modes.frequency[at]), float(table.frequency[i])))
        if np.isfinite(table.damping_ratio[i]):
            lines.append((f"damping {i + 1}", "-", float(modes.damping_ratio[at]), float(table.damping_ratio[i])))
        if len(both) > 1:
            lines.append((f"MAC {i + 1}", "-", float(likeness[i, j]), 1.0))
    names, units, model, test = zip(*lines, strict=True)
    notes = (
        [] if len(both) > 1 else ["paired by frequency: the table and the model name fewer than two places in common"]
    )
    nothing = np.full(len(lines), np.nan)
    return Comparison(
        simulated=np.array(model), measured=np.array(test), error=nothing, away=nothing,
        settings={"rows": list(names), "units": list(units), "notes": notes, "source": table.source},
    )  # fmt: skip


def _said(simulated: Any, dof: int | str, notes: list[str]) -> list[float]:
    """Frequency, growth rate and level of what was simulated; NaN for what it does not have."""
    if hasattr(simulated, "most_unstable"):
        mode = simulated.most_unstable
        return [float(mode.frequency), float(mode.growth_rate), np.nan]
    if hasattr(simulated, "period"):
        if not simulated.outcome.ok:
            notes.append(f"the limit cycle ended with {simulated.outcome}")
            return [np.nan] * 3
        return [1.0 / float(simulated.period), np.nan, np.nan]
    if not (hasattr(simulated, "t") and hasattr(simulated, "q")):
        raise SignalError(f"{type(simulated).__name__}: expected a trajectory, a limit cycle or complex modes")
    late = float(simulated.t[-1] - 0.25 * (simulated.t[-1] - simulated.t[0]))
    found = [np.nan] * 3
    try:
        found[0] = dominant_frequency(simulated, dof=dof, begin=late)
        found[1], why = _growth(simulated, dof)
        notes += [why] if why else []
        if hasattr(simulated, "qd"):
            found[2] = float(sound_level(simulated, dof=dof, begin=late).weighted)
    except SignalError as error:
        notes.append(str(error))
    return found


def _growth(motion: Any, dof: int | str) -> tuple[float, str]:
    """The growth rate of a motion, of one that settles that of its onset; NaN and why where it has none."""
    judged = verdict(motion, dof=dof)
    if judged.kind != "settles_on_cycle":
        growth = growth_rate(motion, dof=dof)
        return (growth.rate, "") if growth.steady else (np.nan, "the motion has no one growth rate")
    upto, below = (share * float(judged.amplitude) for share in ONSET)
    grown = int(np.argmax(judged.envelope >= upto))
    small = np.flatnonzero(judged.envelope[:grown] <= below)
    if not small.size:
        return np.nan, "the motion begins as large as it ends: it has no onset whose growth could be compared"
    begin, end = (float(judged.envelope_time[i]) for i in (small[0], grown))
    return growth_rate(motion, dof=dof, begin=begin, end=end).rate, ""

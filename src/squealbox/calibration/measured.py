"""What was measured, as numbers with standard deviations, and what a design says of the same thing."""

import dataclasses
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from squealbox.parameters import DataSheet, ParameterError, known_names
from squealbox.signals import LEVEL, Signal, SignalError, growth_rate
from squealbox.stability import complex_modes, first_crossings
from squealbox.transient import simulate_ensemble

if TYPE_CHECKING:
    from squealbox.signals import SquealEvents
    from squealbox.stability import ComplexModes

QUANTITIES = (
    "growth_rate", "frequency", "damping_ratio", "critical_value", "amplitude", "cycle_frequency", "friction",
)  # fmt: skip
UNITS = {"growth_rate": "1/s", "frequency": "Hz", "damping_ratio": "-", "amplitude": "m", "cycle_frequency": "Hz",
         "friction": "-"}  # fmt: skip
SURE = 1.96  # standard deviations of the 95 % errors of events
DURATION = 0.1  # s of the transient an amplitude is taken from


class Measured(DataSheet):
    """One measured number.

    Parameters
    ----------
    quantity : one of `QUANTITIES`, or a function of a design (with arrays as parameters) that gives the number
    value, sd : the number and its standard deviation, in SI
    mode : of growth_rate, frequency and damping_ratio: "unstable", the one that grows fastest; "nearest", the one whose
        frequency is nearest to `value`; or its place by frequency, from 0 on
    at : the conditions it was measured at, {parameter: value}, where they are not those of the design
    parameter, bounds : of a critical value: what was varied, and within what
    speed : of a friction coefficient: the sliding speed [m/s]
    duration : of an amplitude (half its range) or a cycle frequency, that of a squeal and not of small motion: how
        long the transient is followed [s]; both are of the freedom that moves most over its last fifth
    start, method : of that transient, as in `simulate_ensemble`; left out, from rest by the usual one, whose extremes
        between steps are right to 1e-7: ``Method("taylor", largest_step=...)`` of a thirtieth period to 1e-11

    >>> Measured("frequency", 2078.0, sd=1.0, mode="unstable").name
    'frequency'
    """

    quantity: str | Callable[[Any], Any]
    value: float
    sd: float
    mode: str | int = "unstable"
    at: Mapping[str, float] = dataclasses.field(default_factory=dict)
    parameter: str = "friction.static"
    bounds: tuple[float, float] = (0.0, 2.0)
    speed: float | None = None
    duration: float = DURATION
    start: Any = None
    method: Any = None
    label: str = ""

    def __post_init__(self) -> None:
        super().__post_init__()
        object.__setattr__(self, "bounds", tuple(self.bounds))  # a file has lists
        if isinstance(self.quantity, str) and self.quantity not in QUANTITIES:
            raise ParameterError("Measured", "quantity", self.quantity, known_names(self.quantity, list(QUANTITIES)))
        for name, value, good in (("value", self.value, True), ("sd", self.sd, np.asarray(self.sd) > 0.0)):
            if not np.isscalar(value) or not np.isfinite(value) or not good:
                expected = "a finite number" if name == "value" else "a standard deviation above 0"
                raise ParameterError("Measured", name, value, expected)
        if not (self.mode in ("unstable", "nearest") or (isinstance(self.mode, int) and self.mode >= 0)):
            raise ParameterError(
                "Measured", "mode", self.mode, "'unstable', 'nearest' or a place by frequency, from 0 on"
            )
        if self.mode == "nearest" and self.quantity != "frequency":
            raise ParameterError("Measured", "mode", self.mode, "'nearest' of a frequency only")
        if self.quantity == "friction" and not (self.speed is not None and self.speed >= 0.0):
            raise ParameterError("Measured", "speed", self.speed, "the sliding speed of a friction coefficient [m/s]")

    @property
    def name(self) -> str:
        """What it is called in tables."""
        word = self.quantity if isinstance(self.quantity, str) else getattr(self.quantity, "__name__", "quantity")
        where = ", ".join(f"{name} = {value:g}" for name, value in self.at.items())
        return self.label or (f"{word} at {where}" if where else word)

    def predicted(self, design: Any, kept: dict[str, Any] | None = None) -> Any:
        """What `design` says, shape of its leading axes; NaN where it has no answer.

        `kept` holds what another measured number has computed of the same design.
        """
        if not isinstance(self.quantity, str):
            return np.asarray(self.quantity(design), dtype=float)
        if self.quantity == "friction":
            return np.asarray(design.friction.mu(self.speed), dtype=float)
        if self.quantity == "critical_value":
            return np.asarray(first_crossings(design, self.parameter, self.bounds), dtype=float)
        if self.quantity in ("amplitude", "cycle_frequency"):
            seen = ("amplitude", "frequency")
            many = simulate_ensemble(design, None, self.duration, self.method, observe=seen, start=self.start)
            most = np.argmax(many["amplitude"], axis=-1)[..., None]
            name = "amplitude" if self.quantity == "amplitude" else "frequency"
            found = np.take_along_axis(many[name], most, axis=-1)[..., 0]
            return np.where(many.ended == "completed", found, np.nan)
        kept = {} if kept is None else kept
        if "modes" not in kept:
            kept["modes"] = complex_modes(design)
        return self._of_modes(kept["modes"])

    def _of_modes(self, modes: "ComplexModes") -> Any:
        growth, frequency = np.asarray(modes.growth_rate), np.asarray(modes.frequency)
        values = np.asarray(getattr(modes, str(self.quantity)))
        moving = frequency > 0.0
        if self.mode == "unstable":
            place = np.argmax(np.where(np.isnan(growth), -np.inf, growth), axis=-1)
        elif self.mode == "nearest":
            place = np.argmin(np.where(moving, np.abs(frequency - self.value), np.inf), axis=-1)
        else:
            order = np.argsort(np.where(moving, frequency, np.inf), axis=-1, kind="stable")
            pairs = int(self.mode)
            if pairs >= frequency.shape[-1]:
                raise ParameterError("Measured", "mode", self.mode, f"a place below {frequency.shape[-1]}")
            place = order[..., pairs]
        return np.take_along_axis(values, place[..., None], axis=-1)[..., 0]


def from_signal(
    signal: Signal, t: ArrayLike | None = None, *, mode: str | int = "unstable", **cut: Any
) -> list[Measured]:
    """Frequency and growth rate of a time signal as two measured numbers with the errors the noise leaves them.

    Raises `SignalError` when the signal cannot tell them.
    """
    found = growth_rate(signal, t, **cut)
    if not found.steady:
        raise SignalError(f"the signal has no one growth rate: {found}; expected a stretch that grows or decays alone")
    from scipy.special import ndtri

    width = float(ndtri(0.5 + 0.5 * LEVEL))
    return [
        Measured("frequency", found.frequency, sd=found.frequency_error / width, mode=mode),
        Measured("growth_rate", found.rate, sd=found.rate_error / width, mode=mode),
    ]


def from_friction(
    speeds: ArrayLike, values: ArrayLike, sd: float, at: Mapping[str, float] | None = None
) -> list[Measured]:
    """A measured friction curve, coefficients at sliding speeds [m/s], as measured numbers.

    `sd` [-]: standard deviation of a coefficient.

    >>> len(from_friction([0.1, 1.0], [0.42, 0.38], sd=0.01))
    2
    """
    pairs = np.broadcast_arrays(np.atleast_1d(speeds), values)
    return [
        Measured("friction", float(mu), sd=sd, speed=float(v), label=f"friction at {v:g} m/s", at=dict(at or {}))
        for v, mu in zip(*pairs, strict=True)
    ]


def from_events(events: "SquealEvents", index: int = 0, at: Mapping[str, str] | None = None) -> list[Measured]:
    """Frequency and growth rate of one squeal event, as far as the recording tells them.

    Where its growth is told, frequency and rate are those of the onset, of small motion as of modes; the frequency of
    the squeal itself, often lower, is that of its limit cycle. `at` says which quantities of the braking are which
    parameters, {parameter: name}: ``{"sliding_speed": "speed"}``; their values at the onset are the conditions.

    Raises `SignalError` when there is no such event, and for a quantity that was not recorded then.
    """
    if not 0 <= index < events.count:
        raise SignalError(f"event {index}: expected one of {events.count} events")
    names = list(events.settings["braking"])
    conditions = {}
    for parameter, name in (at or {}).items():
        value = float(events.braking[index, names.index(name)]) if name in names else float("nan")
        if not np.isfinite(value):
            raise SignalError(f"{name} was not recorded at the event: there is {', '.join(names) or 'nothing'}")
        conditions[parameter] = value
    if not np.isfinite(events.growth_rate[index]):
        frequency, error = events.frequency[index], events.frequency_error[index]
        return [Measured("frequency", float(frequency), sd=float(error) / SURE, at=conditions)]
    frequency, error = events.onset_frequency[index], events.onset_frequency_error[index]
    growth, spread = events.growth_rate[index], events.growth_error[index]
    return [
        Measured("frequency", float(frequency), sd=float(error) / SURE, at=conditions),
        Measured("growth_rate", float(growth), sd=float(spread) / SURE, at=conditions),
    ]

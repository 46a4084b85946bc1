"""What was measured, as numbers with standard deviations, and what a design says of the same thing."""

import dataclasses
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from squealbox.parameters import DataSheet, ParameterError, known_names
from squealbox.signals import SignalError, growth_rate
from squealbox.signals.growth import LEVEL
from squealbox.stability import complex_modes, first_crossings
from squealbox.transient import simulate_ensemble

QUANTITIES = ("growth_rate", "frequency", "damping_ratio", "critical_value", "amplitude", "friction")
UNITS = {"growth_rate": "1/s", "frequency": "Hz", "damping_ratio": "-", "amplitude": "m", "friction": "-"}
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
    duration : of an amplitude: how long the transient from rest is followed [s]

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

    def predicted(self, design: Any) -> Any:
        """What `design` says, shape of its leading axes; NaN where it has no answer."""
        if not isinstance(self.quantity, str):
            return np.asarray(self.quantity(design), dtype=float)
        if self.quantity == "friction":
            return np.asarray(design.friction.mu(self.speed), dtype=float)
        if self.quantity == "critical_value":
            return np.asarray(first_crossings(design, self.parameter, self.bounds), dtype=float)
        if self.quantity == "amplitude":
            many = simulate_ensemble(design, None, self.duration, observe=("amplitude",))
            found = np.max(many["amplitude"], axis=-1)
            return np.where(many.ended == "completed", found, np.nan)
        return self._of_modes(complex_modes(design))

    def _of_modes(self, modes: Any) -> Any:
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


def from_signal(signal: Any, t: Any = None, *, mode: str | int = "unstable", **cut: Any) -> list[Measured]:
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


def from_events(events: Any, index: int = 0) -> list[Measured]:
    """Frequency and growth rate of one squeal event, as far as the recording tells them.

    Raises `SignalError` when there is no such event.
    """
    if not 0 <= index < events.count:
        raise SignalError(f"event {index}: expected one of {events.count} events")
    found = [Measured("frequency", float(events.frequency[index]), sd=float(events.frequency_error[index]) / 1.96)]
    if np.isfinite(events.growth_rate[index]):
        error = float(events.growth_error[index]) / 1.96
        found.append(Measured("growth_rate", float(events.growth_rate[index]), sd=error))
    return found

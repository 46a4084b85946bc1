"""A stop: the brake of the page with its speed falling to zero and its load rising, held and released."""

from typing import Any

from squealbox.design import Design
from squealbox.schedules import Ramp, Table
from squealbox.workbench.panels.panel import OptionError

RISE = 0.1  # of the stop, in which the load rises; in as much it is released at the end
LEFT_OUT = (
    "Left out: heat, wear, what friction does with temperature and history, and the car whose speed would follow the "
    "brake; nothing knocks or shakes, so squeal grows from the rise of the load alone"
)


def braking(design: Design, duration: float) -> tuple[Design, float, str]:
    """The design in a stop of `duration` [s], and with which speed and unit it begins.

    Raises `OptionError` where speed or load of this design cannot vary in time.
    """
    changes: dict[str, Any] = {}
    speed, unit = 0.0, ""
    for name, about, value in design.leaves():
        if not about.schedule or not isinstance(value, float) or value == 0.0:
            continue
        if about.unit in ("m/s", "rad/s"):
            changes[name] = Ramp(start=value, slope=-value / duration)
            speed, unit = abs(value), about.unit
        elif about.unit == "N":
            times = [0.0, RISE * duration, (1.0 - RISE) * duration, duration]
            changes[name] = Table(times, [0.0, value, value, 0.0])
    if not speed:
        raise OptionError("a stop needs a sliding speed that may vary in time, which this design does not have")
    return design.replace(changes), speed, unit

"""A motion as a microphone would have recorded it: a recording whose truth is known, to try the detectors on."""

import numpy as np

from squealbox.signals.radiation import AREA, DENSITY
from squealbox.signals.recordings import Recording
from squealbox.signals.sampling import MotionLike, SignalError, column, folded, samples


def rendered(
    motion: MotionLike,
    *,
    dof: int | str = 0,
    area: float = AREA,
    distance: float = 1.0,
    noise: float = 0.0,
    seed: int = 0,
) -> Recording:
    """The sound pressure of a small surface that moves with the motion, as a `Recording` in Pa.

    `area` [m^2]: of the sounding surface; `distance` [m]: from the surface to the ear.

        p(t) = rho S a(t) / (2 pi r) + noise

    The low-frequency piston of `sound_level`, derived there. `noise` [Pa] is the standard deviation of white noise.
    Where the system of the motion is known its sliding speed and normal force come along as braking channels, those of
    its first contact. `motion` has equal time steps `t` and velocities `qd`; the acceleration is a central difference
    of them, low by (omega h)^2/6 at a step h.

    Raises `SignalError` for unequal steps, and for an area or a distance that is not positive.
    """
    for name, size in (("area", area), ("distance", distance)):
        if not (np.isfinite(size) and size > 0.0):
            raise SignalError(f"{name} = {size}: expected a number above 0")
    if not (np.isfinite(noise) and noise >= 0.0):
        raise SignalError(f"noise = {noise}: expected a standard deviation of 0 Pa or more")
    if few := folded(motion):
        raise SignalError(few)
    data = samples(np.asarray(motion.qd, dtype=float)[:, column(motion, dof)], motion.t)
    pressure = DENSITY * area / (2.0 * np.pi * distance) * np.gradient(data.x, 1.0 / data.rate)
    pressure = pressure + noise * np.random.default_rng(seed).standard_normal(pressure.size)
    braking = {}
    contacts = getattr(getattr(motion, "system", None), "contacts", ())
    if contacts:
        clock = np.linspace(data.t[0], data.t[-1], 201)
        for name, given in (("speed", contacts[0].V), ("normal_force", contacts[0].N0)):
            value = given.value(clock) if hasattr(given, "value") else np.full(clock.size, float(given))
            braking[name] = (clock - data.t[0], np.asarray(value, dtype=float))
    names = tuple(getattr(getattr(motion, "system", None), "names", ()))
    label = names[column(motion, dof)] if names else "sound pressure"
    return Recording(pressure, data.rate, (label,), ("Pa",), braking, (), "rendered")

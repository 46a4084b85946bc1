"""Friction laws and schedules written anew from their data sheets, for the slow integrator."""

import numpy as np
from scipy.interpolate import PchipInterpolator

from squealbox import friction, schedules


class EndlessEvents(RuntimeError):
    """A row of events, as of rebounds that shrink, that the slow integrator does not get through."""


def own_coefficient(law):
    """mu(v) of a law from its data sheet, written anew."""
    if isinstance(law, friction.Coulomb):
        level = law.static if law.kinetic is None else law.kinetic
        return lambda v: level
    if isinstance(law, friction.Stribeck):
        return lambda v: law.static * np.exp(-v / law.speed) + law.kinetic * -np.expm1(-v / law.speed)
    if isinstance(law, friction.LinearSlope):
        return lambda v: max(law.static + law.slope * v, -np.inf if law.floor is None else law.floor)
    if isinstance(law, friction.Hyperbolic):
        return lambda v: law.static / (1.0 + law.delta * v)
    if isinstance(law, friction.Cubic):
        return lambda v: law.static + (law.kinetic - law.static) * (3.0 - (v / law.speed) ** 2) * v / law.speed / 2.0
    if isinstance(law, friction.Table):
        curve = PchipInterpolator(law.speeds, law.values)
        return lambda v: float(curve(min(max(v, law.speeds[0]), law.speeds[-1])))
    raise TypeError(f"the slow integrator knows no {type(law).__name__}")


def own_schedule(value):
    """(value(t), rate(t)) of a number or schedule, written anew."""
    if not hasattr(value, "terms"):
        held = np.asarray(value, dtype=float)
        return (lambda t: held), (lambda t: 0.0 * held)
    parts = [(weight, *_simple(part)) for weight, part in value.terms()]
    return (lambda t: sum(w * f(t) for w, f, _ in parts)), (lambda t: sum(w * g(t) for w, _, g in parts))


def _simple(part):
    if isinstance(part, schedules.Sinusoid):
        om = 2.0 * np.pi * part.frequency
        return (
            lambda t: part.mean + part.amplitude * np.sin(om * t + part.phase),
            lambda t: part.amplitude * om * np.cos(om * t + part.phase),
        )
    if isinstance(part, schedules.Constant):
        return (lambda t: part.level), (lambda t: 0.0)
    if isinstance(part, schedules.Table):
        times, values = np.asarray(part.times, float), np.asarray(part.values, float)
        slopes = np.concatenate([[0.0], np.diff(values) / np.diff(times), [0.0]])
        rate = lambda t: slopes[np.searchsorted(times, t, side="right")]  # noqa: E731
        return (lambda t: np.interp(t, times, values)), rate
    end = np.inf if part.stop is None or part.slope == 0.0 else (part.stop - part.start) / part.slope
    end = np.inf if end <= 0.0 else end
    return (
        lambda t: part.start + part.slope * min(max(t - part.begin, 0.0), end),
        lambda t: part.slope if 0.0 <= t - part.begin < end else 0.0,
    )


def scheduled(system):
    """Every load, normal force and speed of a system."""
    return (system.load, *(x for c in system.contacts for x in (c.V, c.N0)))

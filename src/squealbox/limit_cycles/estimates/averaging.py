"""Quick estimates of a cycle, beside the numerics: one harmonic, and averaging over a fast weakly damped swing.

A block of mass m on a spring, damped by c, pressed by N on a belt of speed V swings as x' = u cos theta when friction
and damping are small against the spring. The energy both do in a period is zero when

    c u = (N/pi) integral_0^2pi mu(V - u cos theta) cos theta dtheta    (0 <= u <= V, so it never sticks)

For mu = kinetic + D exp(-v/s) the right-hand side is 2 N D exp(-V/s) I1(u/s), with I1 the modified Bessel function.
For the cubic law it is N 3/2 (D u/s) (1 - V^2/s^2 - u^2/(4 s^2)), D = static - kinetic, s the speed of least friction.
The error is of second order in damping and friction over the spring's force.
Sources: Thomsen and Fidlin 2003, International Journal of Non-Linear Mechanics 38, 389-403 (cubic law); derived here
for any law.
"""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from squealbox.arguments import public
from squealbox.family import DesignOrRecipe, Family, Varied
from squealbox.friction import Cubic, Stribeck
from squealbox.law import FrictionLaw
from squealbox.limit_cycles.cycles.cycle import Cycle
from squealbox.limit_cycles.cycles.harmonic_balance import harmonic_balance
from squealbox.parameters import ParameterError
from squealbox.schedules import value_at
from squealbox.start import StartLike
from squealbox.system import DesignOrSystem

POINTS = 256  # of the average; exponentially accurate for a smooth law
SCAN = 400
FINE = 8192  # of the touching cycle, whose law may fall steeply near v = 0


@public()
def describing_function(design_or_system: DesignOrSystem, start: StartLike = None, **options: Any) -> Cycle:
    """The cycle with one harmonic and a mean: :func:`harmonic_balance` with ``harmonics=1``.

    Parameters are those of :func:`harmonic_balance`. Accuracy: `error` of the result says nothing here; compare with
    more harmonics. Source: Gelb and Vander Velde 1968, Multiple-Input Describing Functions.

    >>> from squealbox import DrumBrake, LinearSlope
    >>> describing_function(DrumBrake(friction=LinearSlope(0.45, -0.05)), contact="smooth", width=0.05).outcome
    'completed'
    """
    return harmonic_balance(design_or_system, start, harmonics=1, **options)


def averaged_excess(
    law: FrictionLaw, swing: ArrayLike, sliding_speed: ArrayLike, normal_force: float, damping: float
) -> Any:
    """Friction's drive less damping, (N/pi) integral mu cos - c u [N], at velocity amplitudes `swing` [m/s]."""
    theta = 2.0 * np.pi * (np.arange(POINTS) + 0.5) / POINTS
    swing = np.asarray(swing, dtype=float)[..., None]
    mu = law.mu(np.asarray(sliding_speed, dtype=float)[..., None] - swing * np.cos(theta))
    drive = 2.0 * normal_force * np.mean(mu * np.cos(theta), axis=-1)
    return drive - damping * swing[..., 0]


def averaged_swings(law: FrictionLaw, sliding_speed: float, normal_force: float, damping: float) -> Any:
    """Velocity amplitudes u [m/s], shape (cycles,), of all that never stick, 0 < u < V, rising; divide by omega for m.

    Parameters
    ----------
    law : friction law
    sliding_speed, normal_force, damping : V [m/s] > 0, N [N], c [N s/m] of the block

    Accuracy: second order in (c, N mu) against the spring. Source: as this module, closed form for the cubic law.

    >>> from squealbox import Cubic
    >>> [round(float(u), 9) for u in averaged_swings(Cubic(0.4, 0.25, 0.5), 0.48, 1.0, 0.01)]
    [0.237018518]
    """
    from scipy.optimize import brentq

    if isinstance(law, Cubic):
        drop = law.static - law.kinetic
        square = 4.0 * law.speed**2 * (1.0 - (sliding_speed / law.speed) ** 2)
        square -= 4.0 * law.speed**3 * damping / (1.5 * drop * normal_force) if drop * normal_force else np.inf
        inside = 0.0 < square < sliding_speed**2
        return np.array([np.sqrt(square)]) if inside else np.zeros(0)
    grid = np.linspace(1e-4, 1.0, SCAN) * sliding_speed
    values = averaged_excess(law, grid, sliding_speed, normal_force, damping)
    places = np.flatnonzero(values[:-1] * values[1:] < 0.0)

    def excess(u: float) -> float:
        return float(averaged_excess(law, u, sliding_speed, normal_force, damping))

    return np.array([brentq(excess, grid[i], grid[i + 1], xtol=1e-15) for i in places])


@public()
def averaged_curve(design: DesignOrRecipe, parameter: Varied, values: ArrayLike | None = None) -> tuple[Any, Any]:
    """(values, amplitudes [m]) of the averaged cycles over a parameter, for a figure; empty unless it is one block.

    Parameters
    ----------
    design : a design, or a function of one value that returns a design or system
    parameter, values : {name: values (k,)}; or the name and the values one after the other

    One degree of freedom with one contact whose normal force does not depend on the displacement is a block on a belt.
    Accuracy: that of :func:`averaged_swings`; cycles that stick are not among them. Source: as this module.

    >>> from squealbox import Contact, Cubic, System
    >>> def block(speed):
    ...     belt = Contact(n=[0.0], d=[1.0], t=[1.0], N0=1.0, V=speed, law=Cubic(0.4, 0.25, 0.5))
    ...     return System([[1.0]], [[0.01]], [[1.0]], 0.0, (belt,))
    >>> averaged_curve(block, "speed", [0.48])[1].round(9).tolist()
    [0.237018518]
    """
    family, points = Family.along("averaged_curve", design, parameter, values, count=1), []
    for value in family.spans[0]:
        system = family.system(float(value))
        if system.size != 1 or len(system.contacts) != 1 or np.any(system.contacts[0].n) or system.contacts[0].rigid:
            break
        (belt,) = system.contacts
        along, across = float(belt.t[0]), float(belt.d[0])
        speed, normal = abs(float(value_at(belt.V, 0.0))), float(value_at(belt.N0, 0.0)) * across / along
        if speed <= 0.0 or along == 0.0:
            continue
        mass, damping, stiffness = (float(x[0, 0]) / along**2 for x in (system.M, system.C, system.K))
        swings = averaged_swings(belt.law, speed, normal, damping)
        points += [(value, swing * np.sqrt(mass / stiffness) / abs(along)) for swing in swings]
    table = np.array(points).reshape(-1, 2)
    return table[:, 0], table[:, 1]


def averaged_limit(law: FrictionLaw, normal_force: float, damping: float) -> float:
    """Speed V [m/s] up to which a block on a belt can stick and slip; NaN where never, inf where always.

    There u = V, the cycle just touches sticking, with `normal_force` N [N] and `damping` c [N s/m] of the block:

        c V = (N/pi) integral_0^2pi mu(V - V cos theta) cos theta dtheta
            = 2 N (static - kinetic) exp(-V/s) I1(V/s)                         exponential law
            = N 3/2 (static - kinetic) (V/s) (1 - 5 V^2/(4 s^2))               cubic law

    and by quadrature for any other law whose coefficient at v = 0 is its static limit (else `ParameterError`: a drop
    at v = 0 itself does work that the integral does not see). Of several such speeds the largest is given.
    Below it, and above the Hopf speed s ln(N (static - kinetic)/(c s)), steady sliding and stick-slip coexist. The
    error is of second order in (c, N mu). Source: derived here.

    >>> from squealbox import Stribeck
    >>> round(averaged_limit(Stribeck(0.4, 0.25, 0.3), 1.0, 0.2), 5)
    0.31543
    """
    from scipy.optimize import brentq
    from scipy.special import ive

    if not np.isclose(float(law.mu(0.0)), float(law.static_limit), rtol=1e-12, atol=1e-100):
        expected = "a law whose coefficient at v = 0 is its static limit; stick_slip cycles of others come by shooting"
        raise ParameterError("averaged_limit", "law", law, expected)
    if isinstance(law, Cubic):
        drive = 1.5 * (law.static - law.kinetic) * normal_force / law.speed
        left = 1.0 - damping / drive if drive > 0.0 else -1.0
        return float(law.speed * np.sqrt(0.8 * left)) if left > 0.0 else float("nan")
    if not isinstance(law, Stribeck):
        return _limit_by_quadrature(law, normal_force, damping)
    drop = normal_force * (law.static - law.kinetic)

    def excess(r: float) -> float:  # exp(-r) I1(r)/r falls from 1/2 to 0 monotonically
        return float(2.0 * drop * ive(1, r) / r - damping * law.speed)

    low, high = 1e-9, 1e-9
    while excess(high) > 0.0:
        high *= 2.0
        if high > 1e12:
            return float("inf")
    return float(law.speed * brentq(excess, low, high, xtol=1e-15)) if high > low else float("nan")


def _limit_by_quadrature(law: FrictionLaw, normal_force: float, damping: float) -> float:
    """The largest V at which drive and damping of the touching cycle balance, by the midpoint rule."""
    from scipy.optimize import brentq

    theta = np.pi * (np.arange(FINE) + 0.5) / FINE
    weight = np.cos(theta)

    def excess(speed: float) -> float:  # per unit of speed
        mu = law.mu(speed * (1.0 - weight))
        return float(2.0 * normal_force * np.mean((mu - law.mu(speed)) * weight) / speed - damping)

    speeds = np.geomspace(1e-6, 1e6, 481)
    values = np.array([excess(speed) for speed in speeds])
    rest = 1e-12 * max(abs(damping), abs(normal_force))
    falls = np.flatnonzero((values[:-1] > rest) & (values[1:] <= rest))
    if values[-1] > rest:
        return float("inf")
    if falls.size == 0:
        return float("nan")
    i = int(falls[-1])
    return float(brentq(excess, speeds[i], speeds[i + 1], xtol=1e-15, rtol=1e-13))

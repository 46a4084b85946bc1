"""Friction with memory: the deflection z of bristles between the surfaces, one state for each contact.

    F = N (s0 z + s1 z' + s2 v),        z' = creep(v, z)

s0 = stiffness [1/m], s1 = damping [s/m], s2 = viscous [s/m], N the normal force, v the sliding velocity; in steady
sliding s0 z = g(|v|) sgn(v), g the coefficient without its viscous part. No event tells sticking from slipping: what
sticks creeps within the bristles. An open contact has no force, and its bristles go on as if it were closed.
Each law is `friction.NAME` to files. Depends on: law, parameters.
"""

from typing import Any

import numpy as np

from squealbox.law import FrictionLaw
from squealbox.parameters import ParameterError, parameter


class BristleLaw(FrictionLaw):
    """Base of the laws with memory: what a linearisation needs of them beside their curve."""

    @property
    def grip(self) -> tuple[Any, Any, Any]:
        """s0 [1/m], s1 [s/m] and s2 [s/m]."""
        raise NotImplementedError

    def steady_deflection(self, velocity: float | np.ndarray) -> Any:
        """z [m] of steady sliding at a velocity of either sign."""
        dry = self.mu(velocity) - self.grip[2] * np.abs(velocity)
        return np.sign(velocity) * dry / self.grip[0]

    def relaxation(self, velocity: float | np.ndarray) -> tuple[Any, Any]:
        """(dz'/dz [1/s], dz'/dv [-]) in steady sliding: -s0 |v|/g and |v| g'/g."""
        speed = np.abs(velocity)
        dry, slope = self.mu(speed) - self.grip[2] * speed, self.slope_at(speed) - self.grip[2]
        return -self.grip[0] * speed / dry, speed * slope / dry

    def feeds(self, velocity: float | np.ndarray) -> Any:
        """Whether s1 |v| > 4 g, where the bristles may put energy in: (s0 z + s1 z') v < s0 z z' for some z."""
        speed = np.abs(velocity)
        dry = self.mu(speed) - self.grip[2] * speed
        return self.grip[1] * speed > 4.0 * dry

    def direct_slope(self, velocity: float | np.ndarray) -> Any:
        """s1 dz'/dv + s2 [s/m]: the rest of the slope comes with the bristles."""
        _, damping, viscous = self.grip
        return damping * self.relaxation(velocity)[1] + viscous


def lugre(v: Any, p: Any) -> Any:
    """mu = kinetic + (static - kinetic) exp(-(v/speed)^2) + viscous v, p = (static, kinetic, speed, s0, s1, s2)."""
    r = v / p[2]
    return p[1] + (p[0] - p[1]) * np.exp(-r * r) + p[5] * v


def lugre_slope(v: Any, p: Any) -> Any:
    """dmu/dv = -2 v/speed^2 (static - kinetic) exp(-(v/speed)^2) + viscous."""
    r = v / p[2]
    return -2.0 * r / p[2] * (p[0] - p[1]) * np.exp(-r * r) + p[5]


def lugre_creep(v: Any, z: Any, p: Any) -> Any:
    """z' = v - s0 |v| z/g(v)."""
    r = v / p[2]
    return v - p[3] * abs(v) * z / (p[1] + (p[0] - p[1]) * np.exp(-r * r))


def lugre_grip(v: Any, z: Any, rate: Any, p: Any) -> Any:
    """s0 z + s1 z' + s2 v."""
    return p[3] * z + p[4] * rate + p[5] * v


class LuGre(BristleLaw):
    """Bristles that bend in proportion to sliding until they give way: stick, presliding, Stribeck effect and lag.

        F = N (s0 z + s1 z' + s2 v),   z' = v - s0 |v| z/g(v),   g = kinetic + (static - kinetic) exp(-(v/speed)^2)

    with s0 = stiffness, s1 = damping, s2 = viscous; steady sliding has mu = g(|v|) + s2 |v|, and a contact at rest the
    stiffness N s0. It only takes energy out while s1 |v| <= 4 g(|v|); a run that went beyond says so. Stiff: z settles
    at s0 |v|/g, so 50 ms of the drum at s0 = 1e5/m take 1,300 Taylor steps at 0.5 m/s and 13,000 at 5 m/s, and in
    proportion to s0.

    Source: Canudas de Wit, Olsson, Astrom and Lischinsky 1995, IEEE Transactions on Automatic Control 40, 419-425.

    >>> round(float(LuGre(0.4, 0.3, 0.1, stiffness=1e5).mu(0.1)), 6)
    0.336788
    """

    static: float = parameter("-", 0.0, 10.0, low_open=True, meaning="coefficient of slow sliding")
    kinetic: float = parameter("-", 0.0, 10.0, low_open=True, meaning="coefficient at high sliding speed")
    speed: float = parameter("m/s", 0.0, low_open=True, meaning="Stribeck speed, of a Gaussian fall")
    stiffness: float = parameter("1/m", 0.0, low_open=True, default=1e5, meaning="s0 of the bristles over normal force")
    damping: float = parameter("s/m", 0.0, default=0.0, meaning="s1 of the bristles over normal force")
    viscous: float = parameter("s/m", 0.0, default=0.0, meaning="s2, viscous friction over normal force")

    formula = staticmethod(lugre)
    slope_formula = staticmethod(lugre_slope)
    creep_formula = staticmethod(lugre_creep)
    grip_formula = staticmethod(lugre_grip)

    @property
    def grip(self) -> tuple[Any, Any, Any]:
        """s0 [1/m], s1 [s/m] and s2 [s/m]."""
        return self.stiffness, self.damping, self.viscous

    def coefficients(self) -> tuple[Any, ...]:
        return (self.static, self.kinetic, self.speed, *self.grip)


def dahl(v: Any, p: Any) -> Any:
    """mu = kinetic, p = (kinetic, s0, three weights, one of which is 1)."""
    return p[0] + 0.0 * v


def dahl_slope(v: Any, p: Any) -> Any:
    """dmu/dv = 0."""
    return 0.0 * v + 0.0 * p[0]


def dahl_creep(v: Any, z: Any, p: Any) -> Any:
    """z' = v x^exponent, x = 1 - s0 z sgn(v)/kinetic."""
    r = p[1] * z / p[0]
    x = 1.0 - np.where(v > 0.0, r, -r)
    return v * x * (p[2] + x * (p[3] + x * p[4]))


def dahl_grip(v: Any, z: Any, rate: Any, p: Any) -> Any:
    """s0 z."""
    return p[1] * z


class Dahl(BristleLaw):
    """Friction as a force over displacement, with rate-independent hysteresis: dF/dx = N s0 (1 - F sgn(v)/(mu N))^i.

    With `exponent` i = 1 the force follows mu N from F0 as mu N - (mu N - F0) exp(-s0 x/mu). A larger exponent nears
    mu N more slowly than any exponential, so its bristles add no mode of steady sliding.

    Source: Dahl 1968, A solid friction model, The Aerospace Corporation TOR-0158(3107-18)-1.

    >>> float(Dahl(0.4, stiffness=1e5).mu(1.0))
    0.4
    """

    kinetic: float = parameter("-", 0.0, 10.0, low_open=True, meaning="coefficient of steady sliding")
    stiffness: float = parameter("1/m", 0.0, low_open=True, default=1e5, meaning="s0 of the bristles over normal force")
    exponent: float = parameter("-", 1.0, 3.0, default=1.0, meaning="how the force bends towards its limit: 1, 2 or 3")

    formula = staticmethod(dahl)
    slope_formula = staticmethod(dahl_slope)
    creep_formula = staticmethod(dahl_creep)
    grip_formula = staticmethod(dahl_grip)

    def __post_init__(self) -> None:
        super().__post_init__()
        if not np.all(np.isin(self.exponent, (1.0, 2.0, 3.0))):
            raise ParameterError("Dahl", "exponent", self.exponent, "1, 2 or 3")

    @property
    def grip(self) -> tuple[Any, Any, Any]:
        """s0 [1/m], s1 [s/m] and s2 [s/m]."""
        return self.stiffness, 0.0, 0.0

    @classmethod
    def guess(cls, speeds: np.ndarray, values: np.ndarray) -> dict[str, float]:
        return {}  # its curve is that of Coulomb

    def coefficients(self) -> tuple[Any, ...]:
        weights = (1.0 * (np.asarray(self.exponent) == i) for i in (1, 2, 3))
        return (self.kinetic, self.stiffness, *(float(w) if np.ndim(w) == 0 else w for w in weights))

    def relaxation(self, velocity: float | np.ndarray) -> tuple[Any, Any]:
        """(dz'/dz [1/s], dz'/dv [-]) in steady sliding; 0 for an exponent above 1."""
        rate, _ = super().relaxation(velocity)
        return np.where(np.asarray(self.exponent) == 1.0, rate, 0.0), 0.0 * rate


def elasto_plastic_creep(v: Any, z: Any, p: Any) -> Any:
    """z' = v (1 - a s0 z sgn(v)/g(v)), a = 0 below the break-away deflection and 1 at that of steady sliding.

    The share ends at 1 + 1e-7, where a is 1 to 3e-14: no kink lies where sliding is steady.
    """
    r = v / p[2]
    g = p[1] + (p[0] - p[1]) * np.exp(-r * r)
    along = np.where(v > 0.0, z, -z)
    least = p[6] * p[1] / p[3]
    share = np.minimum(np.maximum((along - least) / (g / p[3] - least), 0.0), 1.0000001)
    return v * (1.0 - (0.5 - 0.5 * np.cos(3.141592653589793 * share)) * p[3] * along / g)


class ElastoPlastic(LuGre):
    """LuGre's bristles with a purely elastic beginning, so that a contact at rest does not creep under small forces.

        F = N (s0 z + s1 z' + s2 v),   z' = v (1 - a(v, z) z/z_s(v)),   z_s = sgn(v) g(|v|)/s0

    a = 0 for |z| up to z_b = breakaway kinetic/s0, and where z and v have opposite signs; from there to |z_s| it rises
    to 1 as (1 - cos(pi share))/2. g, s1 and s2 are those of `LuGre`.

    Source: Dupont, Hayward, Armstrong and Altpeter 2002, IEEE Transactions on Automatic Control 47, 787-792.

    >>> round(float(ElastoPlastic(0.4, 0.3, 0.1, stiffness=1e5).mu(0.1)), 6)
    0.336788
    """

    breakaway: float = parameter("-", 0.0, 1.0, high_open=True, default=0.7, meaning="elastic share of the deflection")

    creep_formula = staticmethod(elasto_plastic_creep)

    def __post_init__(self) -> None:
        super().__post_init__()
        if np.any(np.asarray(self.static) < np.asarray(self.kinetic)):  # else z_b could lie beyond z_s
            raise ParameterError("ElastoPlastic", "kinetic", self.kinetic, f"at most static = {self.static}")

    def coefficients(self) -> tuple[Any, ...]:
        return (*super().coefficients(), self.breakaway)

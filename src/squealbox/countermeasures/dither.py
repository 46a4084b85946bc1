"""Dither: fast motion put onto a contact, tangential (sliding velocity) or normal (normal force).

Tangential dither w sin(2 pi f t) along the sliding turns Coulomb's step into a rise, (2 mu/pi) asin(v/w): it damps
and takes away mean friction. Below the sliding speed (w < V) it does not reverse and makes a falling law fall faster,
by I0(w/speed) for an exponential one: it destabilises. Normal dither N0 (1 + r sin) does nothing at all to a linear
brake with Coulomb friction as long as no contact lifts off (r <= 1); beyond, the mean normal force rises.
Sources: Hoffmann, Wagner and Gaul 2005, J. Sound and Vibration 279, 471-480; Michaux, Ferri and Cunefare 2005.
"""

from typing import Any, ClassVar

import numpy as np

from squealbox.countermeasures.base import Countermeasure
from squealbox.design import Design
from squealbox.friction import averaged
from squealbox.parameters import ParameterError, known_names, parameter
from squealbox.schedules import Schedule, Sinusoid, Sum, as_schedule
from squealbox.system import Contact, System, equilibrium

OWN = "chosen by the user"
EVERY = ""
CLOSE = 1e-6  # share within which a mean law falls as fast as the law itself
TWIN = 0.2  # relative distance of the dither from an eigenfrequency below which it shakes that mode


class Dithered(Countermeasure):
    """The sliding velocity of contacts shaken fast: V(t) = V + velocity sin(2 pi frequency t).

    `along` names the contact that is shaken; "" shakes all. Averaged (the default) the contact has the law slow motion
    meets, `friction.averaged`, and every analysis takes it; with direct=True it has the schedule, for runs in time and
    forced cycles. Frequency matters for the direct motion only.

    >>> from squealbox import ModeCoupling, Coulomb, complex_modes
    >>> brake = ModeCoupling(friction=Coulomb(1.5))
    >>> [bool(complex_modes(each).stable) for each in (brake, Dithered(brake, velocity=1.3, frequency=1e3))]
    [False, True]
    """

    title: ClassVar[str] = "Tangential dither"
    source: ClassVar[str] = "Hoffmann, Wagner and Gaul 2005, J. Sound and Vibration 279, 471-480"

    velocity: float = parameter("m/s", 0.0, meaning="amplitude of the dither's velocity", source=OWN)
    frequency: float = parameter("Hz", 0.0, low_open=True, default=40e3, meaning="frequency of the dither", source=OWN)
    along: str = EVERY
    direct: bool = False

    def system(self) -> System:
        """The brake's equation with the averaged law, or the moving belt."""
        base = self.brake.system()
        chosen = shaken(type(self).__name__, base, self.along)
        contacts = [self._with(contact) if i in chosen else contact for i, contact in enumerate(base.contacts)]
        return base.replace(contacts=tuple(contacts))

    def _with(self, contact: Contact) -> Contact:
        if not self.direct:
            return contact.replace(law=averaged(contact.law, self.velocity))
        return contact.replace(V=_plus(contact.V, self.velocity, self.frequency))

    @property
    def friction_left(self) -> Any:
        """Mean friction coefficient over that without dither at each contact's sliding speed, (..., contacts)."""
        base = equilibrium(self.brake.system())
        law = self.replace(direct=False).system().contacts
        left = [contact.law.mu(base.sliding_speed[..., i]) for i, contact in enumerate(law)]
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.stack(left, axis=-1) / base.friction

    def cautions(self) -> tuple[str, ...]:
        """Where this dither, or what is inside, may make it worse, in sentences."""
        base = self.brake.system()
        chosen = shaken(type(self).__name__, base, self.along)
        state = equilibrium(base)
        said = []
        for i in chosen:
            name, speed = base.contacts[i].name, float(np.max(np.abs(state.sliding_speed[..., i])))
            law = base.contacts[i].law
            slope, mean = (np.asarray(each.slope_at(speed)) for each in (law, averaged(law, self.velocity)))
            below, near = np.asarray(self.velocity) < speed, CLOSE * np.abs(slope)
            stays = f"dither of {np.max(self.velocity):g} m/s stays below the sliding speed {speed:g} m/s of {name}"
            if np.any(below & (mean < slope - near) & (slope < 0.0)):
                said.append(f"{stays}: friction that weakens with speed falls faster on the mean, which destabilises")
            elif np.any(below & (np.abs(mean - slope) <= near)):
                said.append(f"{stays}: nothing reverses, and friction rises or falls on the mean as it does without")
            if np.any(state.normal_force[..., i] < 0.0):
                said.append(f"{name} is pulled (N < 0): dither takes damping away there")
        return (*said, *resonances(self.brake, self.frequency), *super().cautions())


class NormalDither(Countermeasure):
    """The normal force of contacts shaken fast: N0 (1 + ratio sin(2 pi frequency t)); `at` names one, "" shakes all.

    Without lift-off (ratio <= 1) superposition holds for Coulomb friction: no effect on stability. Beyond, a unilateral
    contact opens in each period and its mean normal force rises, `mean_normal_force`.

    >>> from squealbox import ModeCoupling
    >>> round(float(NormalDither(ModeCoupling(), ratio=2.0).mean_normal_force), 9)
    1.217995562
    """

    title: ClassVar[str] = "Normal dither"
    source: ClassVar[str] = "Michaux, Ferri and Cunefare 2005; own closed form of the mean"

    ratio: float = parameter("-", 0.0, meaning="amplitude over the mean normal force N0", source=OWN)
    frequency: float = parameter("Hz", 0.0, low_open=True, default=40e3, meaning="frequency of the dither", source=OWN)
    at: str = EVERY

    def system(self) -> System:
        """The brake's equation with the moving normal force."""
        base = self.brake.system()
        chosen = shaken("NormalDither", base, self.at, "at")
        contacts = []
        for i, contact in enumerate(base.contacts):
            if i not in chosen:
                contacts.append(contact)
                continue
            if isinstance(contact.N0, Schedule) or contact.rigid:
                raise ParameterError("NormalDither", "at", self.at, f"{contact.name} with a constant N0 to be shaken")
            contacts.append(contact.replace(N0=_plus(contact.N0, self.ratio * contact.N0, self.frequency)))
        return base.replace(contacts=tuple(contacts))

    @property
    def mean_normal_force(self) -> Any:
        """Mean of max(1 + ratio sin, 0): 1 up to ratio 1, then (b + ratio sin b)/pi with b = acos(-1/ratio)."""
        ratio = np.asarray(self.ratio, dtype=float)
        lifted = np.maximum(ratio, 1.0)
        angle = np.arccos(-1.0 / lifted)
        return (angle + lifted * np.sin(angle)) / np.pi

    def cautions(self) -> tuple[str, ...]:
        """Where this dither does nothing, or more than meant."""
        said = []
        if np.any(np.asarray(self.ratio) > 1.0):
            said.append(
                f"normal dither of {np.max(self.ratio):g} times N0: the contact lifts off, or is pulled (N < 0)"
            )
        else:
            said.append("normal dither without lift-off does nothing to a linear brake with Coulomb friction")
        return (*said, *resonances(self.brake, self.frequency), *super().cautions())


def resonances(brake: Design, frequency: float | np.ndarray) -> list[str]:
    """A sentence for each eigenfrequency of the brake within 20 % of the dither, or at half of it (parametric)."""
    from squealbox.stability import complex_modes

    modes = complex_modes(brake)
    if not modes.outcome.ok or np.ndim(modes.growth_rate) > 1 or np.ndim(frequency) > 0:
        return []
    half = modes.frequency.shape[-1] // 2
    own = [f for f in modes.frequency[:half] if np.isfinite(f) and f > 0.0]
    near = [f for f in own if abs(float(frequency) - f) <= TWIN * f]
    said = [f"dither at {float(frequency):g} Hz lies within 20 % of the mode at {f:g} Hz and shakes it" for f in near]
    half_way = [f for f in own if abs(float(frequency) - 2.0 * f) <= 0.1 * f]
    return said + [f"dither at {float(frequency):g} Hz is twice the mode at {f:g} Hz and may pump it" for f in half_way]


def shaken(owner: str, system: System, name: str, field: str = "along") -> list[int]:
    """The places of the contacts called `name`; all for ""."""
    names = [contact.name for contact in system.contacts]
    if not names:
        raise ParameterError(owner, field, name, "a brake with contacts")
    if name == EVERY:
        return list(range(len(names)))
    if name not in names:
        raise ParameterError(owner, field, name, known_names(name, names))
    return [i for i, each in enumerate(names) if each == name]


def _plus(mean: Any, amplitude: Any, frequency: Any) -> Schedule:
    """mean + amplitude sin(2 pi frequency t), the mean a number or a schedule."""
    if isinstance(mean, Schedule):
        return Sum((*as_schedule(mean).terms(), (1.0, Sinusoid(0.0, amplitude, frequency))))
    return Sinusoid(mean, amplitude, frequency)

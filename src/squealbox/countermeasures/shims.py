"""Layers: a shim between a lining and its backing, a constrained layer on a plate.

A shim of stiffness k_s stands in series with the contact stiffness k_c of one contact, n = k_c w with w its normal:
it *isolates* (less stiffness couples friction), *damps* (its own loss), and may *move the force* (a turned normal).
Its loss is a state, for a spring k_s (1 + i eta) has no meaning in time:

    zener          k0 (s) and beside it k1 in series with a damper: s = w.q - N/k_c, k1 (s - z) = c1 z'
    kelvin_voigt   k_s s + c_s s' with c_s = eta k_s/w_f at the one frequency

With a = k1/k0 the Zener loss factor is largest, eta = a/(2 sqrt(1 + a)), at w_f = k1/(c1 sqrt(1 + a)); there
its stiffness is k0 2 (1 + a)/(2 + a), which is made the shim's `stiffness`. What a shim does: Flint 2003, SAE
2003-01-3321.
"""

from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from squealbox.countermeasures.base import Countermeasure, added, contact_index, direction, extended, outer
from squealbox.parameters import ParameterError, above_zero, choice, parameter
from squealbox.system import Contact, System

OWN = "chosen by the user"


class Shim(Countermeasure):
    """A layer in series with one contact: it isolates, damps and may move the force.

    `at` names the contact ("" where there is one). `turn` turns the contact's normal and directions in their plane, as
    a shim that moves the centre of pressure by that angle does.

    >>> from squealbox import DrumBrake
    >>> Shim(DrumBrake(), at="shoe 1", stiffness=2e9, loss_factor=0.3, frequency=2000.0).system().names
    ('x', 'y', 'shim')
    """

    title: ClassVar[str] = "Shim"
    source: ClassVar[str] = "effects of Flint 2003, SAE 2003-01-3321"

    at: str
    stiffness: float = parameter("N/m", 0.0, low_open=True, meaning="stiffness of the shim at `frequency`", source=OWN)
    loss_factor: float = parameter("-", 0.0, default=0.0, meaning="loss factor at `frequency`", source=OWN)
    frequency: float = parameter(
        "Hz", 0.0, low_open=True, default=2000.0, meaning="where the loss is given", source=OWN
    )
    turn: float = parameter("rad", -np.pi, np.pi, default=0.0, meaning="angle by which the force is moved", source=OWN)
    loss: str = choice("zener", "kelvin_voigt", default="zener", meaning="how the loss is said in time")

    def system(self) -> System:
        """The brake's equation with the contact in series with the shim."""
        base = self.brake.system()
        if np.any(self.turn):
            base = self._turned(base)
        place, unit, spring = self._contact(base)
        if not np.any(self.loss_factor):  # a spring in series, without a state
            left = self.stiffness / (self.stiffness + spring)
            contact = base.contacts[place].replace(n=np.asarray(left)[..., None] * base.contacts[place].n)
            return _with(added(base, stiffness=outer(spring * (left - 1.0), unit, unit)), place, contact)
        return (
            self._zener(base, place, unit, spring) if self.loss == "zener" else self._voigt(base, place, unit, spring)
        )

    def _contact(self, base: System) -> tuple[int, Any, Any]:
        """Place of the contact, its normal w (..., n) of length 1 and its stiffness k_c [N/m]."""
        place = contact_index("Shim", "at", base, self.at)
        contact = base.contacts[place]
        size = np.linalg.norm(contact.n, axis=-1)
        if contact.rigid or not np.all(size > 0.0):
            raise ParameterError(
                "Shim", "at", self.at, "a contact with a stiffness, n not 0: a shim acts on its spring"
            )
        unit = contact.n / size[..., None] if contact.normal is None else np.asarray(contact.normal)
        spring = np.asarray(np.sum(contact.n * unit, axis=-1) / np.sum(unit * unit, axis=-1))
        if np.any(np.abs(contact.n - spring[..., None] * unit) > 1e-9 * size[..., None]):
            raise ParameterError("Shim", "at", self.at, "a contact whose n lies along its normal")
        return place, unit, spring

    def _zener(self, base: System, place: int, unit: np.ndarray, spring: np.ndarray) -> System:
        k0, k1, c1 = standard_solid(self.stiffness, self.loss_factor, self.frequency)
        whole = extended(base, "shim")
        wide, z = np.append(unit, np.zeros((*unit.shape[:-1], 1)), axis=-1), np.eye(whole.size)[-1]
        total = spring + k0 + k1  # the layer's own deflection s = (k_c w.q + k1 z)/total is eliminated
        squeeze = spring[..., None] * wide + np.asarray(k1)[..., None] * z
        stiffness = outer(k1, z, z) - outer(1.0 / total, squeeze, squeeze)
        contact = whole.contacts[place]
        row = contact.n - (spring / total)[..., None] * squeeze
        contact = contact.replace(n=row, normal=_reaction(contact, k1 / (k0 + k1), z))
        return _with(added(whole, stiffness=stiffness, damping=outer(c1, z, z)), place, contact)

    def _voigt(self, base: System, place: int, unit: np.ndarray, spring: np.ndarray) -> System:
        damper = self.loss_factor * np.asarray(self.stiffness) / (2.0 * np.pi * np.asarray(self.frequency))
        whole = extended(base, "shim")
        wide, s = np.append(unit, np.zeros((*unit.shape[:-1], 1)), axis=-1), np.eye(whole.size)[-1]
        stiffness = outer(spring, s, s) - outer(spring, wide, s) - outer(spring, s, wide)
        stiffness = stiffness + outer(self.stiffness, s, s)
        contact = whole.contacts[place]
        row = contact.n - spring[..., None] * s
        contact = contact.replace(n=row, normal=_reaction(contact, 1.0, s))
        return _with(added(whole, stiffness=stiffness, damping=outer(damper, s, s)), place, contact)

    def _turned(self, base: System) -> System:
        place, unit, spring = self._contact(base)
        contact = base.contacts[place]
        if not np.allclose(np.sum(unit * contact.d, axis=-1), 0.0, atol=1e-9):
            raise ParameterError(
                "Shim", "turn", self.turn, "0: friction of this contact does not act across its normal"
            )
        cosine, sine = (np.asarray(f(self.turn))[..., None] for f in (np.cos, np.sin))
        normal, along = unit * cosine + contact.d * sine, contact.d * cosine - unit * sine
        turned = contact.replace(n=spring[..., None] * normal, d=along, t=along, normal=normal)
        return _with(added(base, stiffness=outer(spring, normal, normal) - outer(spring, unit, unit)), place, turned)


def standard_solid(stiffness: float | np.ndarray, loss_factor: ArrayLike, frequency: ArrayLike) -> tuple[Any, Any, Any]:
    """k0, k1 [N/m] and c1 [N s/m] of a Zener solid that has this stiffness and its largest loss at `frequency` [Hz]."""
    eta = np.asarray(loss_factor, dtype=float)
    share = 2.0 * eta**2 + 2.0 * eta * np.sqrt(eta**2 + 1.0)
    k0 = stiffness * (2.0 + share) / (2.0 * (1.0 + share))
    k1 = share * k0
    return k0, k1, k1 / np.sqrt(1.0 + share) / (2.0 * np.pi * np.asarray(frequency))


def _reaction(contact: Contact, share: ArrayLike, state: np.ndarray) -> Any:
    """The direction -normal N acts in, with what the normal force does to the shim's own state."""
    return None if contact.normal is None else contact.normal - np.asarray(share)[..., None] * state


def _with(system: System, place: int, contact: Contact) -> System:
    contacts = (*system.contacts[:place], contact, *system.contacts[place + 1 :])
    return system.replace(contacts=contacts)


def ross_kerwin_ungar(
    loss_factor: ArrayLike, stiffness_parameter: ArrayLike, shear_parameter: float | np.ndarray | None = None
) -> Any:
    """Loss factor [-] of a plate with a constrained viscoelastic layer, array in, array out, after Ross, Kerwin and
    Ungar.

        eta = eta_v Y X/(1 + (2 + Y) X + (1 + Y)(1 + eta_v^2) X^2)

    Parameters
    ----------
    loss_factor : eta_v [-] of the viscoelastic material
    stiffness_parameter : Y [-], the geometry of plate and constraining layer
    shear_parameter : X [-]; None takes the best, X = 1/sqrt((1 + Y)(1 + eta_v^2))

    Source: Ross, Ungar and Kerwin 1959, in Structural Damping, ASME, 49-87.

    >>> round(float(ross_kerwin_ungar(1.0, 1.0)), 12) == round(1.0 / 7.0, 12)
    True
    """
    eta, stiff = np.asarray(loss_factor, dtype=float), np.asarray(stiffness_parameter, dtype=float)
    square = (1.0 + stiff) * (1.0 + eta**2)
    shear = 1.0 / np.sqrt(square) if shear_parameter is None else np.asarray(shear_parameter, dtype=float)
    return eta * stiff * shear / (1.0 + (2.0 + stiff) * shear + square * shear**2)


class LayerDamping(Countermeasure):
    """A constrained layer on the plate behind one degree of freedom, of loss factor eta after Ross, Kerwin and Ungar.

    viscous    C + eta k/(2 pi frequency) a a', k = a'K a the brake's own stiffness
    zener      k as a standard solid: k (1 + i eta) at `frequency`, where eta is largest, its loss a state

    >>> from squealbox import DrumBrake
    >>> round(LayerDamping(DrumBrake(), on="y", loss_factor=1.0, stiffness_parameter=1.0, frequency=2e3).loss, 9)
    0.142857143
    """

    title: ClassVar[str] = "Constrained layer"
    source: ClassVar[str] = "Ross, Ungar and Kerwin 1959, in Structural Damping, ASME, 49-87"

    on: str
    loss_factor: float = parameter("-", 0.0, meaning="loss factor of the viscoelastic material", source=OWN)
    stiffness_parameter: float = parameter("-", 0.0, meaning="Y, geometry of plate and constraining layer", source=OWN)
    shear_parameter: float | None = above_zero("-", default=None, meaning="X of the layer; the best when left out")
    frequency: float = parameter(
        "Hz", 0.0, low_open=True, default=2000.0, meaning="where the loss is given", source=OWN
    )

    model: str = choice("viscous", "zener", default="viscous", meaning="how the loss is said in time")

    @property
    def loss(self) -> Any:
        """The loss factor of the layered plate [-]."""
        found = ross_kerwin_ungar(self.loss_factor, self.stiffness_parameter, self.shear_parameter)
        return float(found) if np.ndim(found) == 0 else found

    def system(self) -> System:
        """The brake's equation with the layer's damping."""
        base = self.brake.system()
        row = direction("LayerDamping", "on", base, self.on)
        stiffness = np.einsum("...ij,i,j->...", base.K, row, row)
        if self.model == "zener" and np.any(self.loss):
            k0, k1, c1 = standard_solid(stiffness, self.loss, self.frequency)
            whole = extended(base, "layer")
            wide, z = np.append(row, 0.0), np.eye(base.size + 1)[-1]
            springs = outer(k0 - stiffness, wide, wide) + outer(k1, wide - z, wide - z)
            return added(whole, stiffness=springs, damping=outer(c1, z, z))
        damper = self.loss * stiffness / (2.0 * np.pi * np.asarray(self.frequency))
        return added(base, damping=outer(damper, row, row))

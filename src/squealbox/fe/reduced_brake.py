"""A brake reduced to few coordinates p, q = q0 + V p: a design like any other, whose system is small and dense.

    V'M V p'' + V'C V p' + V'K V p = V'(f - K q0) + sum_c V'd_c mu_c sgn(v_c) N_c
    N_c = (N0_c + n_c . q0) + V'n_c . p

Contacts stay what they are, with their own normal force, speed, law and the right to lift off; only their rows are
projected. Where a parameter changes matrices, they are known at Chebyshev points of its range and interpolated.
"""

from collections.abc import Mapping
from functools import cached_property
from typing import Any, ClassVar, Self

import numpy as np
from numpy.typing import ArrayLike

from squealbox.contacts import Contact
from squealbox.design import Design
from squealbox.fe.band_spectrum import Pairs, band_pairs
from squealbox.fe.full_brake import FullBrake
from squealbox.fe.reduced_sliding import Sums, steady_small, sums_of, untouched, without_friction
from squealbox.fe.small import Small
from squealbox.law import FrictionLaw
from squealbox.parameters import DataSheet, ParameterError, known_names
from squealbox.shapes import Surface
from squealbox.system import Equilibrium, InvalidSystem, System, linearise

FIELDS = ("M", "C", "K", "load", "n", "d", "t", "normal", "across", "N0", "V")
SUMMED = {"n", "d", "normal", "across", "N0"}  # fields that sums over contacts are made of


class ChangeAlong(DataSheet):
    """One parameter that changes the matrices: its range, the points where they are known, and their change there.

    change[field] has shape (points, ...): the projected field there, less that at the reference.
    """

    name: str
    low: float
    high: float
    points: Any
    change: Any

    @classmethod
    def kind(cls) -> str:
        """The name files know it by."""
        return "fe.reduced_brake.Axis"

    def __post_init__(self) -> None:
        super().__post_init__()
        object.__setattr__(self, "change", {name: np.asarray(value) for name, value in self.change.items()})

    def at(self, field: str, value: ArrayLike) -> Any:
        """The change of a field at `value`, which may carry leading axes; 0.0 where the field does not change."""
        known = self.change.get(field)
        if known is None:
            return 0.0
        return np.tensordot(lagrange(np.asarray(self.points), np.asarray(value, dtype=float)), known, axes=1)


class Reduction(DataSheet):
    """The projected arrays at the reference, the axes, and how good they are.

    arrays maps the names M, C, K (m, m), load (m,), n, d, t, normal, across (contacts, m), N0, V (contacts,) to values,
    and high (m, m) to what of C was added to the directions above the band;
    laws holds one friction law, or one for each contact. errors lists, for each point that was checked against the full
    brake, its parameters and the largest error estimate [1/s] of a mode in the band.
    """

    arrays: Any
    laws: Any
    unilateral: Any
    contact_names: tuple[str, ...]
    band: tuple[float, float]
    top: float
    size: int
    axes: tuple[ChangeAlong, ...] = ()
    errors: Any = ()
    tolerance: float = 0.05
    method: str = "enriched"
    high_damping: float = 0.0
    high_growth: float = 0.0

    def __post_init__(self) -> None:
        super().__post_init__()
        arrays = {
            name: None if value is None else np.asarray(value, dtype=float) for name, value in self.arrays.items()
        }
        object.__setattr__(self, "arrays", arrays)
        for field in ("contact_names", "axes", "errors", "band"):
            object.__setattr__(self, field, tuple(getattr(self, field)))

    @cached_property
    def sums(self) -> Sums | None:
        """Sums over the contacts that all points of the ranges share; None where a parameter changes what is summed."""
        if any(SUMMED & axis.change.keys() for axis in self.axes):
            return None
        return sums_of(self.arrays, np.asarray(self.unilateral))

    @property
    def error(self) -> float:
        """The largest error estimate [1/s] of an eigenvalue in the band, over all points that were checked."""
        return max((float(error) for _, error in self.errors), default=float("nan"))


class ReducedBrake(Design):
    """A finite-element brake on few coordinates, as :func:`reduce` returns it.

    ``replace`` takes the parameters it was reduced for, and every coefficient of the friction law; ``system()`` is
    dense, so every analysis takes it. ``reduction.error`` [1/s] says how far its eigenvalues may be off; ``checked``
    measures that anywhere. Outside the ranges it was reduced for, `ParameterError`.
    """

    title: ClassVar[str] = "A finite-element brake, reduced"
    source: ClassVar[str] = "the full brake"

    reduction: Reduction
    friction: FrictionLaw | None = None
    values: Any = None
    full: Any = None
    surface: Surface | None = None  # for those who draw it

    def __post_init__(self) -> None:
        object.__setattr__(self, "values", dict(self.values or {}))

    def __repr__(self) -> str:
        return self.summary()

    def summary(self) -> str:
        """How large it is, what it may be asked, and how good it is."""
        about = self.reduction
        ranges = [f"{axis.name} from {axis.low:g} to {axis.high:g}" for axis in about.axes]
        lines = [
            f"{len(about.arrays['M'])} coordinates for {about.size} degrees of freedom, "
            f"{len(about.contact_names)} contacts, {about.band[0]:g} to {about.band[1]:g} Hz ({about.method})",
            f"largest error of an eigenvalue in the band: {about.error:.2g} 1/s at {len(about.errors)} points checked",
        ]
        if about.error > about.tolerance:
            lines.append(f"that is more than the {about.tolerance:g} 1/s asked for")
        if about.high_damping:
            lines.append(f"directions above {about.top:.5g} Hz are damped by {100 * about.high_damping:.2g} % more")
        if about.high_growth:
            lines.append(
                f"above {about.top:.5g} Hz it grows by up to {about.high_growth:.3g} 1/s, which the full brake "
                "need not: onsets and motions there are none of its own"
            )
        return "\n".join(lines + [f"may vary: {text}" for text in ranges])

    @property
    def band(self) -> tuple[float, float]:
        """(f1, f2) [Hz], in which its modes are to be trusted."""
        return self.reduction.band

    @property
    def error(self) -> float:
        """The largest error estimate [1/s] of an eigenvalue in the band, over all points that were checked."""
        return self.reduction.error

    def replace(self, changes: Mapping[str, Any] | None = None, **keywords: Any) -> Self:
        """A copy with other values of what it was reduced for, or of its friction law."""
        inner: dict[str, Any] = {}
        values, whole = dict(self.values), {}
        for name, value in {**(changes or {}), **keywords}.items():
            axis = next((axis for axis in self.reduction.axes if axis.name == name), None)
            if axis is not None:
                values[name] = _in_range(axis, value)
            elif name.startswith("friction.") and self.friction is not None:
                self.friction.value_of(name.removeprefix("friction."))  # a name the law does not have is refused
                inner[name.removeprefix("friction.")] = value
            elif name == "friction" and isinstance(value, FrictionLaw):
                whole["friction"] = value
            elif name in ("reduction", "values", "full", "surface"):
                whole[name] = value
            else:
                raise ParameterError(type(self).__name__, name, value, known_names(name, self._names()))
        law = whole.get("friction", self.friction)
        if inner and law is not None:
            whole["friction"] = law.replace(inner)
        kept = {name: getattr(self, name) for name in ("reduction", "friction", "full", "surface")}
        return type(self)(**{**kept, "values": values} | whole)

    def value_of(self, path: str) -> Any:
        """The value behind a name."""
        if path in self.values:
            return self.values[path]
        if path.startswith("friction.") and self.friction is not None:
            return self.friction.value_of(path.removeprefix("friction."))
        if path == "friction":
            return self.friction
        raise ParameterError(type(self).__name__, path, None, known_names(path, self._names()))

    def leaves(self, prefix: str = "") -> Any:
        """Every parameter that may be varied, with its range and value."""
        from squealbox.parameters import Parameter

        for axis in self.reduction.axes:
            about = Parameter("", axis.low, axis.high, meaning=f"{axis.name} of the full brake")
            yield prefix + axis.name, about, self.values[axis.name]
        if self.friction is not None:
            yield from self.friction.leaves(f"{prefix}friction.")

    def _names(self) -> list[str]:
        return [name for name, _, _ in self.leaves()]

    def array(self, field: str) -> Any:
        """A projected field at the present values; leading axes of the values are kept. None where there is none."""
        known = self.reduction.arrays[field]
        changing = [axis for axis in self.reduction.axes if field in axis.change]
        if known is None or not changing:
            return known
        return known + sum(axis.at(field, self.values[axis.name]) for axis in changing)

    def system(self) -> System:
        """The small, dense system."""
        rows = {field: self.array(field) for field in FIELDS}
        contacts = []
        for i, name in enumerate(self.reduction.contact_names):
            unilateral = bool(self.reduction.unilateral[i])
            contacts.append(
                Contact(
                    n=rows["n"][..., i, :],
                    d=rows["d"][..., i, :],
                    t=rows["t"][..., i, :],
                    N0=rows["N0"][..., i],
                    V=rows["V"][..., i],
                    law=self.law_of(i),
                    name=name,
                    unilateral=unilateral,
                    normal=rows["normal"][..., i, :] if unilateral else None,
                    across=None if rows["across"] is None else rows["across"][..., i, :],
                )
            )
        return System(rows["M"], rows["C"], rows["K"], rows["load"], tuple(contacts))

    def band_modes(
        self, band: tuple[float, float] | None = None, time: float = 0.0, *, rough: bool = False
    ) -> tuple[Pairs, Equilibrium] | None:
        """The modes in a band, by default its own, and steady sliding, at a small part of the price of a spectrum.

        The damping that was added above the band has no part in them; those whose damping ratio is above 0.1 are left
        out. None where they are not had this way: several values at once, laws that differ or remember, a band beyond
        its own, no steady sliding, or modes that did not settle. `rough`: only eigenvalues, to 1e-8.
        """
        low, high = band or self.band
        found = None if high > self.band[1] * (1.0 + 1e-9) else self._quickly(self._added)
        pairs = None if found is None else band_pairs(found[0], (low, high), rough=rough)
        return None if found is None or pairs is None else (pairs, found[1])

    def parts(self) -> tuple[Small, Equilibrium, Any, Any] | None:
        """M, C_eff and K_eff with steady sliding, and C and the symmetric part of K without friction, (m, m) each.

        The damping that was added above the band is left out; None where `band_modes` has none for its reasons.
        """
        found = self._quickly(self._added)
        if found is None:
            return None
        rows = {field: self.array(field) for field in ("C", "d", "n", "across")}
        rows["C"] = rows["C"] - self._added
        return (*found, *without_friction(rows, np.asarray(self.reduction.unilateral), *found))

    @property
    def shape(self) -> tuple[int, ...]:
        """Leading axes of its values: () for one brake."""
        return np.broadcast_shapes(*(np.shape(value) for _, _, value in self.leaves() if value is not None))

    def entry(self, index: tuple[int, ...]) -> Self:
        """One brake out of several."""
        shape = self.shape
        arrays = {name: value for name, _, value in self.leaves() if np.ndim(value)}
        return self.replace({name: float(np.broadcast_to(value, shape)[index]) for name, value in arrays.items()})

    def linearised(self, time: float = 0.0) -> Small | None:
        """M, C_eff and K_eff about steady sliding; None where there is none."""
        found = self._quickly(0.0)
        if found is not None:
            return found[0]
        about = linearise(self.system(), time)
        return Small(about.M, about.C, about.K) if about.equilibrium.exists else None

    @property
    def _added(self) -> Any:
        """What was added to C above the band."""
        return self.reduction.arrays.get("high", 0.0)

    def _quickly(self, without: float | np.ndarray) -> tuple[Small, Equilibrium] | None:
        """Linearised from tables of contacts, less some damping; None where that road does not go."""
        touching = len(self.reduction.contact_names) > 0
        if (touching and self.friction is None) or any(np.ndim(value) for value in self.values.values()):
            return None
        rows = {field: self.array(field) for field in FIELDS}
        rows["C"] = rows["C"] - without
        if not touching or self.friction is None:
            return untouched(rows)
        return steady_small(rows, self.friction, np.asarray(self.reduction.unilateral), self.reduction.sums)

    def law_of(self, index: int) -> FrictionLaw:
        """The friction law of one contact."""
        if self.friction is not None:
            return self.friction
        law: FrictionLaw = self.reduction.laws[index]
        return law

    def sliding_one_way(self) -> Self:
        """The same brake without the cross direction of friction, as a motion needs it."""
        arrays = {**self.reduction.arrays, "across": None}
        return self.replace({"reduction": self.reduction.replace(arrays=arrays)})

    def expand(self, shape: np.ndarray) -> Any:
        """A displacement or mode of the small system (m,) or (m, k) on all degrees of freedom, without q0."""
        return self.attached().basis @ shape

    def checked(self, **values: Any) -> Any:
        """Modes in the band at parameters, each with the estimate of its error against the full brake there.

        values are parameters of the full brake with `_` for `.`, or none: the present ones. Returns a `Projected`.
        """
        named = {self._full_name(name): value for name, value in values.items()}
        return self.attached().checked(self.present(named), self.band)

    def whole(self) -> Any:
        """The full design at the present values, or the full system."""
        return self.attached().at(self.present())

    def missed(self, eigenvalue: complex, x: np.ndarray, y: np.ndarray) -> complex | None:
        """The estimate [1/s] of the full brake's eigenvalue less one found here, with right and left shape (m,).

        None where the full brake is not kept, or is another one: without its cross direction, or with another law.
        """
        if self.full is None:
            return None
        like = self.reduction.arrays["across"] is not None, type(self.friction)
        return self.attached().missed(self.present(), eigenvalue, x, y, like)

    def present(self, named: Mapping[str, Any] | None = None) -> dict[str, Any]:
        """Parameters of the full brake at the present values, but for those named."""
        named = named or {}
        present = {**{axis.name: self.values[axis.name] for axis in self.reduction.axes}, **named}
        if self.friction is not None:
            inner = {f"friction.{name}": value for name, _, value in self.friction.leaves() if isinstance(value, float)}
            present = {**inner, **present}
        return present

    def _full_name(self, name: str) -> str:
        matches = [known for known in self._names() if known in (name, name.replace("_", ".", 1))]
        return matches[0] if matches else name

    def attached(self) -> FullBrake:
        """The full brake; `InvalidSystem` where it is not kept."""
        if self.full is None:
            raise InvalidSystem("the full brake is not kept in files: reduce it again to expand or check")
        full: FullBrake = self.full
        return full


def _in_range(axis: ChangeAlong, value: ArrayLike) -> Any:
    number = np.asarray(value, dtype=float)
    if not np.all((number >= axis.low) & (number <= axis.high)):
        raise ParameterError(
            "ReducedBrake", axis.name, value, f"{axis.low:g} to {axis.high:g}, what it was reduced for"
        )
    return float(number) if number.ndim == 0 else number


def chebyshev_points(low: float, high: float, count: int) -> Any:
    """Chebyshev-Lobatto points, both ends among them, in rising order: of 2 n - 1, every other one is one of n."""
    angles = np.pi * np.arange(count) / (count - 1)
    return 0.5 * (low + high) - 0.5 * (high - low) * np.cos(angles)


def lagrange(points: np.ndarray, value: np.ndarray) -> Any:
    """Weights (..., points) of the interpolating polynomial."""
    gaps = value[..., None] - points
    weights = np.ones(gaps.shape)
    for i in range(len(points)):
        for j in range(len(points)):
            if i != j:
                weights[..., i] *= gaps[..., j] / (points[i] - points[j])
    return weights

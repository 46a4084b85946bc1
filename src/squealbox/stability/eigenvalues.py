"""Complex eigenvalues of steady sliding: the question every brake study starts with.

q = u exp(lambda t) in M q'' + C_eff q' + K_eff q = 0 gives 2n eigenvalues lambda = growth + i omega. The problem is
solved as the eigenproblem of the (2n, 2n) state matrix [[0, I], [-M^-1 K, -M^-1 C]], with time scaled by a typical
angular frequency; time enters as exp(lambda t), so a positive real part grows.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np

from squealbox.arguments import public
from squealbox.cautions import aliased, out_of_range, pulling
from squealbox.fe import ReducedBrake
from squealbox.parameters import ParameterError
from squealbox.result import COMPLETED, Array, Outcome, Result, batched, quantity
from squealbox.stability.deflation import special_modes, uncertain, vibrating
from squealbox.stability.mode import Mode, OneEigenvalue, damping_ratio
from squealbox.stability.ordering import spectrum_order
from squealbox.stability.state_matrix import special_entries, stand_in, state_matrix
from squealbox.system import DesignOrSystem, Linearised, as_system, linearise

MARGINAL = 1e-12  # growth below this share of the largest |lambda| is round-off, not growth
__all__ = ["ComplexModes", "Mode", "OneEigenvalue", "complex_modes", "damping_ratio", "modes_of"]
NEAR_DEFECTIVE = 1e6  # condition number of an eigenvalue at which about 6 of 16 digits are lost

SINGULAR_PENCIL = Outcome("singular_pencil", "every number is an eigenvalue: a motion with no force on it at all")


@dataclass(frozen=True, kw_only=True, eq=False)
class ComplexModes(Result):
    """The full spectrum of steady sliding, batched over the leading axes, as :func:`complex_modes` returns it.

    The first n eigenvalues have Im >= 0, ascending in |Im|; the last n are their conjugates in the same order (of real
    eigenvalues the larger half stands in the first n). An entry without steady sliding holds NaN and exists = False.
    A rigid-body freedom, a motion that no spring feels, has eigenvalues that are exactly zero; `floating` counts such
    freedoms. They are no loss of stability: `largest_growth_rate` and `most_unstable` leave them out. A freedom
    without mass has eigenvalues at infinity, which stand as NaN behind the others.
    """

    eigenvalues: Array = quantity("... mode", "1/s", "eigenvalue, growth rate + i angular frequency")
    right: Array = quantity("... dof mode", "1", "right mode u, |u| = 1")
    left: Array = quantity("... dof mode", "s/kg", "left mode w, w^H (2 lambda M + C) u = 1")
    condition: Array = quantity("... mode", "1", "condition number of the eigenvalue; infinite = defective")
    steady: Array = quantity("... dof", "m", "steady sliding displacement")
    exists: Array = quantity("...", "1", "True where there is a spectrum")
    normal_force: Array = quantity("... contact", "N", "normal force of each contact in steady sliding, < 0 in tension")
    floating: Array = quantity("...", "1", "number of rigid-body freedoms, whose eigenvalues are zero")
    contacts: tuple[str, ...] = ()
    caution: str = ""

    swept: ClassVar = {
        "largest_growth_rate": ("", "1/s", "largest growth rate"),
        "unstable_modes": ("", "1", "number of growing modes"),
        "growth_rate": ("mode", "1/s", "growth rate of each mode"),
        "frequency": ("mode", "Hz", "frequency of each mode"),
        "damping_ratio": ("mode", "1", "damping ratio of each mode; negative grows"),
    }

    coordinates: ClassVar = {"mode": "numbers"}
    derived: ClassVar = {
        "growth_rate": ("... mode", "1/s", "growth rate of each mode"),
        "frequency": ("... mode", "Hz", "frequency of each mode"),
        "damping_ratio": ("... mode", "1", "damping ratio of each mode; negative grows"),
    }
    table_over: ClassVar = ("mode",)

    @property
    def numbers(self) -> Array:
        """What the modes are called: 1 to n, and -1 to -n for their conjugates."""
        half = self.eigenvalues.shape[-1] // 2
        return np.r_[1 : half + 1, -(np.arange(half) + 1)]

    def table(self) -> dict[str, Any]:
        """A row for each mode without its conjugate; of several spectra a row each, and columns for each mode."""
        half = self.eigenvalues.shape[-1] // 2
        told = {
            "frequency [Hz]": self.frequency, "growth rate [1/s]": self.growth_rate,
            "damping ratio [-]": self.damping_ratio, "angular frequency [rad/s]": self.angular_frequency,
        }  # fmt: skip
        if self.eigenvalues.ndim == 1:
            return {"mode": np.arange(1, half + 1), **{head: values[:half] for head, values in told.items()}}
        return {head.replace(" [", f" {i + 1} ["): values[..., i].ravel()
                for head, values in told.items() for i in range(half)}  # fmt: skip

    @property
    def outcomes(self) -> Any:
        return np.where(self.exists, COMPLETED, str(self.outcome))

    @property
    def growth_rate(self) -> Array:
        """Re lambda [1/s], shape (..., 2n); positive grows."""
        return np.real(self.eigenvalues)

    @property
    def angular_frequency(self) -> Array:
        """|Im lambda| [rad/s], shape (..., 2n)."""
        return np.abs(np.imag(self.eigenvalues))

    @property
    def frequency(self) -> Array:
        """|Im lambda| / (2 pi) [Hz], shape (..., 2n)."""
        return self.angular_frequency / (2.0 * np.pi)

    @property
    def damping_ratio(self) -> Array:
        """-Re lambda / |lambda| [-], shape (..., 2n); negative grows, NaN at lambda = 0."""
        return damping_ratio(self.eigenvalues)

    @property
    def largest_growth_rate(self) -> Array:
        """The largest growth rate [1/s] beside rigid-body motion, shape (...); NaN where there is no spectrum."""
        growth = vibrating(self.eigenvalues, self.floating)
        return np.where(self.exists, np.where(np.isneginf(growth), 0.0, growth), np.nan)

    @property
    def stable(self) -> Array:
        """True where no mode grows, shape (...); undamped modes count as stable, a missing spectrum does not."""
        return self.exists & (self.unstable_modes == 0)

    @property
    def unstable_modes(self) -> Array:
        """Number of growing modes, a complex pair counted once and real eigenvalues each, shape (...)."""
        scale = np.max(np.nan_to_num(np.abs(self.eigenvalues)), axis=-1, keepdims=True, initial=0.0)
        surely = self.growth_rate > np.maximum(MARGINAL, uncertain(self.eigenvalues, self.condition, scale)) * scale
        return np.sum(surely & (np.imag(self.eigenvalues) >= 0.0), axis=-1)

    @property
    def near_defective(self) -> Array:
        """True where an eigenvalue is (nearly) defective, as at the coalescence of two modes, shape (..., 2n)."""
        return self.condition > NEAR_DEFECTIVE

    @property
    def most_unstable(self) -> Mode:
        """The mode with the largest growth rate over all leading axes; `ValueError` where no spectrum exists."""
        if not np.any(self.exists):
            raise ValueError(f"no spectrum, so no most unstable mode: {self.outcome} ({self.outcome.message})")
        half = self.eigenvalues.shape[-1] // 2
        growth = self.growth_rate[..., :half]
        rigid = (self.eigenvalues[..., :half] == 0.0) & (np.asarray(self.floating)[..., None] > 0)
        growth = np.where(np.isnan(growth) | rigid, -np.inf, growth)
        if not np.any(np.isfinite(growth)):  # nothing but rigid-body motion moves: it neither grows nor dies
            growth = np.where(rigid, 0.0, -np.inf)
        if not np.any(np.isfinite(growth)):
            where = "with a finite eigenvalue" if half == self.steady.shape[-1] else "in the band"
            raise ValueError(f"no mode {where}, so no most unstable one")
        *entry, index = (int(i) for i in np.unravel_index(np.argmax(growth), growth.shape))
        return self.mode(index, tuple(entry))

    def within(self, band: tuple[float, float]) -> "ComplexModes":
        """Only the modes within (f1, f2) [Hz]; an entry with fewer of them than another is filled up by NaN."""
        low, high = (2.0 * np.pi * float(f) for f in band)
        half = self.eigenvalues.shape[-1] // 2
        inside = (self.eigenvalues.imag[..., :half] >= low) & (self.eigenvalues.imag[..., :half] <= high)
        most = int(np.max(np.sum(inside, axis=-1), initial=0))
        first = np.argsort(~inside, axis=-1, kind="stable")[..., :most]
        kept = np.take_along_axis(inside, first, axis=-1)
        order, kept = np.concatenate([first, first + half], axis=-1), np.concatenate([kept, kept], axis=-1)
        changes: dict[str, Any] = {}
        for name in ("eigenvalues", "condition"):
            changes[name] = np.where(kept, np.take_along_axis(getattr(self, name), order, axis=-1), np.nan)
        for name in ("right", "left"):
            columns = np.take_along_axis(getattr(self, name), order[..., None, :], axis=-1)
            changes[name] = np.where(kept[..., None, :], columns, np.nan)
        return replace(self, **changes)

    def mode(self, index: int, entry: tuple[int, ...] = ()) -> Mode:
        """Mode `index` of the system at `entry` of the leading axes; `ParameterError` where there is none."""
        count = self.eigenvalues.shape[-1]
        if not -count <= index < count:
            raise ParameterError("modes", "mode", index, f"a number from 0 to {count - 1}, the conjugates last")
        return Mode(
            eigenvalue=complex(self.eigenvalues[(*entry, index)]),
            shape=self.right[entry][:, index],
            left=self.left[entry][:, index],
            steady=self.steady[entry],
            index=index,
            entry=entry,
        )

    def summary(self) -> str:
        """A table of the n modes in plain text; with leading axes, of the most unstable entry."""
        from squealbox.stability.modes_text import summary

        return summary(self)


@batched
@public()
def complex_modes(
    design_or_system: DesignOrSystem, time: float = 0.0, *, band: tuple[float, float] | None = None, **how: Any
) -> ComplexModes:
    """Eigenvalues and modes of (lambda^2 M + lambda C_eff + K_eff) u = 0 about steady sliding at `time` [s].

    Parameters
    ----------
    design_or_system : leading axes are kept
    time : instant of schedules [s]
    band : (f1, f2) [Hz], only the modes in it; needed where the matrices are sparse, whose modes carry an error bar.
        Of a reduced brake, by default the band in which it is to be trusted
    how : of a sparse system: method "projection" or "full", tolerance [1/s] and certify, as
        :func:`squealbox.stability.band_modes` takes them

    Leading axes of the system are kept. Where there is no steady sliding (a contact with V = 0, a K_eff that is
    singular otherwise than by rigid-body motion) the arrays hold NaN, `exists` is False and `outcome` names the worst
    case; nothing is raised. Freedoms without mass and rigid-body freedoms are ordinary; see `ComplexModes`.

    Accuracy: backward stable (LAPACK geev); an eigenvalue of condition k is good to about k * 1e-16 of the largest.

    >>> from squealbox.system import System
    >>> modes = complex_modes(System(M=[[1.0]], C=[[0.2]], K=[[1.01]]))
    >>> [complex(round(x.real, 9), round(x.imag, 9)) for x in modes.eigenvalues]
    [(-0.1+1j), (-0.1-1j)]
    """
    quick = None if how else _of_reduced(design_or_system, time, band)
    if quick is not None:
        return quick
    system = as_system(design_or_system, linear=True)
    if system.is_sparse:
        from squealbox.stability.modes_in_band import band_modes  # only a large brake needs it

        return band_modes(design_or_system, band, time=time, **how)
    if how:
        raise ValueError(f"{', '.join(sorted(how))}: for sparse matrices; dense ones need no method")
    about = linearise(system, time)
    inputs = {"system": design_or_system, "time": time}
    names = system.contact_names
    state = about.equilibrium
    said = out_of_range(system, state.normal_force, state.sliding_speed) if np.any(state.exists) else ()
    if state.exists.ndim == 0 and state.exists and hasattr(design_or_system, "cautions"):
        said = (*said, *design_or_system.cautions())  # a countermeasure may make it worse
    if state.exists.ndim == 0 and system.loops:
        said = (*said, *aliased(system, system.loops))
    modes = replace(modes_of(about, inputs, names), caution="; ".join(said))
    band = getattr(design_or_system, "band", None) if band is None else band
    return modes if band is None else modes.within(band)


def _of_reduced(design: DesignOrSystem, time: float, band: tuple[float, float] | None) -> ComplexModes | None:
    """The modes of a reduced brake in its band, which it knows how to find at a small part of the price."""
    if not isinstance(design, ReducedBrake):
        return None
    if design.shape:
        return _stacked([complex_modes(design.entry(at), time, band=band) for at in np.ndindex(design.shape)], design)
    found = design.band_modes(band, time)
    if found is None:
        return None
    pairs, state = found
    both = np.concatenate
    said = pulling(design.reduction.contact_names, design.reduction.unilateral, state.normal_force)
    return ComplexModes(
        eigenvalues=both([pairs.values, pairs.values.conj()]),
        right=both([pairs.right, pairs.right.conj()], axis=1),
        left=both([pairs.left, pairs.left.conj()], axis=1),
        condition=both([pairs.condition, pairs.condition]),
        steady=state.q,
        exists=np.array(True),
        normal_force=state.normal_force,
        floating=np.array(0),
        contacts=design.reduction.contact_names,
        inputs={"system": design, "time": time},
        caution="; ".join(said),
    )


def _stacked(every: list[ComplexModes], design: Any) -> ComplexModes:
    """Modes of several brakes as one result with their leading axes, filled up by NaN where one has fewer."""
    most = max(one.eigenvalues.shape[-1] // 2 for one in every)

    def joined(name: str, fill: float | None = None) -> Any:
        parts = [np.asarray(getattr(one, name)) for one in every]
        if fill is not None:  # both halves are filled up at their ends
            halves = [np.split(part, 2, axis=-1) for part in parts]
            wide = [[(0, 0)] * (part.ndim - 1) + [(0, most - part.shape[-1] // 2)] for part in parts]
            parts = [
                np.concatenate([np.pad(half, width, constant_values=fill) for half in pair], axis=-1)
                for pair, width in zip(halves, wide, strict=True)
            ]
        return np.stack(parts).reshape(design.shape + parts[0].shape)

    worst = next((one.outcome for one in every if not one.outcome.ok), Outcome())
    return ComplexModes(
        **{name: joined(name, np.nan) for name in ("eigenvalues", "right", "left", "condition")},
        **{name: joined(name) for name in ("steady", "exists", "normal_force", "floating")},
        contacts=every[0].contacts,
        inputs={**every[0].inputs, "system": design},
        outcome=worst,
        caution="; ".join(dict.fromkeys(one.caution for one in every if one.caution)),
    )


def modes_of(
    about: Linearised, inputs: Mapping[str, Any] | None = None, contacts: tuple[str, ...] = ()
) -> ComplexModes:
    """The modes of linearised matrices; see :func:`complex_modes`."""
    matrix, rate, usable, outcome = state_matrix(about)
    special = special_entries(about)
    scaled, states = np.linalg.eig(np.where(usable[..., None, None], matrix, stand_in(matrix)))
    order = spectrum_order(scaled)
    scaled = np.take_along_axis(scaled.astype(complex), order, axis=-1)
    states = np.take_along_axis(states.astype(complex), order[..., None, :], axis=-1)
    eigenvalues = scaled * rate[..., None]
    right, left, condition = _modes(about, eigenvalues, states, np.asarray(usable))
    eigenvalues, right, left, condition, usable = map(np.array, (eigenvalues, right, left, condition, usable))
    for at in map(tuple, np.argwhere(special)):
        found = special_modes(about.M[at], about.C[at], about.K[at])
        usable[at] = found is not None
        outcome = outcome if found else SINGULAR_PENCIL
        if found:
            eigenvalues[at], right[at], left[at], condition[at] = found
    missing = ~usable
    return ComplexModes(
        eigenvalues=np.where(missing[..., None], np.nan, eigenvalues),
        right=np.where(missing[..., None, None], np.nan, right),
        left=np.where(missing[..., None, None], np.nan, left),
        condition=np.where(missing[..., None], np.nan, condition),
        steady=np.where(missing[..., None], np.nan, about.equilibrium.q),
        exists=usable,
        normal_force=about.equilibrium.normal_force,
        floating=np.broadcast_to(about.equilibrium.floating, usable.shape),
        contacts=contacts,
        inputs=inputs or {},
        outcome=outcome,
    )


def _modes(about: Linearised, eigenvalues: np.ndarray, states: np.ndarray, usable: np.ndarray) -> tuple[Any, Any, Any]:
    size = about.M.shape[-1]
    inverse, invertible = _inverse(states)
    with np.errstate(all="ignore"):
        condition = np.linalg.norm(inverse, axis=-1) * np.linalg.norm(states, axis=-2)
        right = _phased(states[..., :size, :])
        mass = np.where(usable[..., None, None], about.M, np.eye(size))
        left = np.linalg.solve(np.swapaxes(mass, -1, -2), np.conj(np.swapaxes(inverse[..., size:], -1, -2)))
    damping = np.where(usable[..., None, None], about.C, 0.0)
    stiffness = np.where(usable[..., None, None], about.K, 0.0)
    lost = ~invertible & usable
    if np.any(lost):
        null = _left_null(mass[lost], damping[lost], stiffness[lost], eigenvalues[lost])
        left[lost], condition[lost] = null, np.inf
    slope = 2.0 * eigenvalues[..., None, :] * (mass @ right) + damping @ right
    scale = np.sum(np.conj(left) * slope, axis=-2)
    with np.errstate(all="ignore"):
        scaled = left / np.conj(scale)[..., None, :]
    return right, np.where(np.isfinite(scaled), scaled, left), condition


def _inverse(states: np.ndarray) -> tuple[Any, Any]:
    largest = 0.01 / np.finfo(float).eps
    with np.errstate(all="ignore"):
        condition = np.asarray(np.linalg.cond(states, 1))  # an inverse; singular values of 480 states take twenty
        doubtful = ~(condition < 0.01 * largest)
        if np.any(doubtful):
            condition[doubtful] = np.linalg.cond(states[doubtful])
        invertible = condition < largest
    safe = np.where(invertible[..., None, None], states, np.eye(states.shape[-1]))
    return np.linalg.inv(safe), invertible


def _left_null(mass: np.ndarray, damping: np.ndarray, stiffness: np.ndarray, eigenvalues: np.ndarray) -> Any:
    """Left null vectors of lambda^2 M + lambda C + K by singular values: exact even where modes have merged."""
    value = eigenvalues[..., None, None]
    dynamic = value**2 * mass[..., None, :, :] + value * damping[..., None, :, :] + stiffness[..., None, :, :]
    vectors, _, _ = np.linalg.svd(dynamic)
    return np.swapaxes(vectors[..., -1], -1, -2)


def _phased(shapes: np.ndarray) -> Any:
    """Shapes of length 1 whose first largest part is real and positive."""
    size = np.abs(shapes)
    first = np.argmax(size >= (1.0 - 1e-6) * np.max(size, axis=-2, keepdims=True), axis=-2)
    largest = np.take_along_axis(shapes, first[..., None, :], axis=-2)
    return shapes * (np.conj(largest) / np.abs(largest)) / np.linalg.norm(shapes, axis=-2, keepdims=True)

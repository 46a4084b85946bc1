"""Complex eigenvalues of steady sliding: the question every brake study starts with.

q = u exp(lambda t) in M q'' + C_eff q' + K_eff q = 0 gives 2n eigenvalues lambda = growth + i omega. The problem is
solved as the eigenproblem of the (2n, 2n) state matrix [[0, I], [-M^-1 K, -M^-1 C]], with time scaled by a typical
angular frequency; time enters as exp(lambda t), so a positive real part grows.
"""

from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np

from squealbox.cautions import out_of_range
from squealbox.result import COMPLETED, Outcome, Result, batched, quantity
from squealbox.stability.deflation import special_modes, uncertain, vibrating
from squealbox.stability.first_order import first_order_spectra
from squealbox.stability.free_bodies import free_body_spectra
from squealbox.stability.ordering import damping_ratio, spectrum_order
from squealbox.stability.vectors import mode_vectors
from squealbox.static_deflection import levelled
from squealbox.system import Linearised, as_system, linearise

MARGINAL = 1e-12  # growth below this share of the largest |lambda| is round-off, not growth
NEAR_DEFECTIVE = 1e6  # condition number of an eigenvalue at which about 6 of 16 digits are lost

SINGULAR_PENCIL = Outcome("singular_pencil", "every number is an eigenvalue: a motion with no force on it at all")


class OneEigenvalue:
    """What follows from the one eigenvalue a result carries."""

    eigenvalue: Any

    @property
    def angular_frequency(self) -> float:
        """|Im lambda| [rad/s]."""
        return float(abs(np.imag(self.eigenvalue)))

    @property
    def frequency(self) -> float:
        """|Im lambda| / (2 pi) [Hz]."""
        return self.angular_frequency / (2.0 * np.pi)


@dataclass(frozen=True, eq=False)
class Mode(OneEigenvalue):
    """One mode of one system, from which a simulation or a limit cycle can start.

    eigenvalue [1/s]; shape u (n,) with |u| = 1 and its largest part real; left w (n,), scaled so that
    w^H (2 lambda M + C) u = 1; steady (n,), the steady sliding displacement [m]; index, the place in the spectrum;
    entry, the place in the leading axes.
    """

    eigenvalue: complex
    shape: Any
    left: Any
    steady: Any
    index: int
    entry: tuple[int, ...] = ()

    @property
    def growth_rate(self) -> float:
        """Re lambda [1/s]; positive grows."""
        return float(np.real(self.eigenvalue))

    @property
    def damping_ratio(self) -> float:
        """-Re lambda / |lambda| [-]; negative grows."""
        return float(damping_ratio(self.eigenvalue))

    def start(self, amplitude: float, phase: float = 0.0) -> tuple[Any, Any]:
        """Displacement and velocity (q, qd) about steady sliding; `amplitude` of u in m, `phase` in rad."""
        turned = amplitude * np.exp(1j * phase) * self.shape
        return self.steady + turned.real, (self.eigenvalue * turned).real


@dataclass(frozen=True, kw_only=True, eq=False)
class ComplexModes(Result):
    """The full spectrum of steady sliding, batched over the leading axes, as :func:`complex_modes` returns it.

    The first n eigenvalues have Im >= 0, ascending in |Im|; the last n are their conjugates in the same order (of real
    eigenvalues the larger half stands in the first n). An entry without steady sliding holds NaN and exists = False.
    A rigid-body freedom, a motion that no spring feels, has eigenvalues that are exactly zero; `floating` counts such
    freedoms. They are no loss of stability: `largest_growth_rate` and `most_unstable` leave them out. A freedom
    without mass has eigenvalues at infinity, which stand as NaN behind the others.
    """

    eigenvalues: Any = quantity("... mode", "1/s", "eigenvalue, growth rate + i angular frequency")
    right: Any = quantity("... dof mode", "1", "right mode u, |u| = 1")
    left: Any = quantity("... dof mode", "s/kg", "left mode w, w^H (2 lambda M + C) u = 1")
    condition: Any = quantity("... mode", "1", "condition number of the eigenvalue; infinite = defective")
    steady: Any = quantity("... dof", "m", "steady sliding displacement")
    exists: Any = quantity("...", "1", "True where there is a spectrum")
    normal_force: Any = quantity("... contact", "N", "normal force of each contact in steady sliding, < 0 in tension")
    floating: Any = quantity("...", "1", "number of rigid-body freedoms, whose eigenvalues are zero")
    contacts: tuple[str, ...] = ()
    caution: str = ""

    swept: ClassVar = {
        "largest_growth_rate": ("", "1/s", "largest growth rate"),
        "unstable_modes": ("", "1", "number of growing modes"),
        "growth_rate": ("mode", "1/s", "growth rate of each mode"),
        "frequency": ("mode", "Hz", "frequency of each mode"),
        "damping_ratio": ("mode", "1", "damping ratio of each mode; negative grows"),
    }

    @property
    def outcomes(self) -> Any:
        return np.where(self.exists, COMPLETED, str(self.outcome))

    @property
    def growth_rate(self) -> Any:
        """Re lambda [1/s], shape (..., 2n); positive grows."""
        return np.real(self.eigenvalues)

    @property
    def angular_frequency(self) -> Any:
        """|Im lambda| [rad/s], shape (..., 2n)."""
        return np.abs(np.imag(self.eigenvalues))

    @property
    def frequency(self) -> Any:
        """|Im lambda| / (2 pi) [Hz], shape (..., 2n)."""
        return self.angular_frequency / (2.0 * np.pi)

    @property
    def damping_ratio(self) -> Any:
        """-Re lambda / |lambda| [-], shape (..., 2n); negative grows, NaN at lambda = 0."""
        return damping_ratio(self.eigenvalues)

    @property
    def largest_growth_rate(self) -> Any:
        """The largest growth rate [1/s] beside rigid-body motion, shape (...); NaN where there is no spectrum."""
        growth = vibrating(self.eigenvalues, self.floating)
        return np.where(self.exists, np.where(np.isneginf(growth), 0.0, growth), np.nan)

    @property
    def stable(self) -> Any:
        """True where no mode grows, shape (...); undamped modes count as stable, a missing spectrum does not."""
        return self.exists & (self.unstable_modes == 0)

    @property
    def unstable_modes(self) -> Any:
        """Number of growing modes, a complex pair counted once and real eigenvalues each, shape (...)."""
        scale = np.max(np.nan_to_num(np.abs(self.eigenvalues)), axis=-1, keepdims=True, initial=0.0)
        surely = self.growth_rate > np.maximum(MARGINAL, uncertain(self.eigenvalues, self.condition, scale)) * scale
        return np.sum(surely & (np.imag(self.eigenvalues) >= 0.0), axis=-1)

    @property
    def near_defective(self) -> Any:
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
        """Mode `index` of the system at `entry` of the leading axes."""
        return Mode(
            eigenvalue=complex(self.eigenvalues[(*entry, index)]),
            shape=self.right[(*entry, slice(None), index)],
            left=self.left[(*entry, slice(None), index)],
            steady=self.steady[entry],
            index=index,
            entry=entry,
        )

    def summary(self) -> str:
        """A table of the n modes in plain text; with leading axes, of the most unstable entry."""
        from squealbox.stability.modes_text import summary

        return summary(self)


@batched
def complex_modes(design_or_system: Any, time: float = 0.0, *, band: Any = None, **how: Any) -> ComplexModes:
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
    system = as_system(design_or_system, linear=True)
    if system.is_sparse:
        from squealbox.stability.band_modes import band_modes  # only a large brake needs it

        return band_modes(design_or_system, band, time=time, **how)
    if how:
        raise ValueError(f"{', '.join(sorted(how))}: for sparse matrices; dense ones need no method")
    about = linearise(system, time)
    inputs = {"system": design_or_system, "time": time}
    names = tuple(contact.name or f"contact {i + 1}" for i, contact in enumerate(system.contacts))
    state = about.equilibrium
    said = out_of_range(system, state.normal_force, state.sliding_speed) if np.any(state.exists) else ()
    modes = replace(modes_of(about, inputs, names), caution="; ".join(said))
    band = getattr(design_or_system, "band", None) if band is None else band
    return modes if band is None else modes.within(band)


def modes_of(about: Linearised, inputs: Any = None, contacts: tuple[str, ...] = ()) -> ComplexModes:
    """The modes of linearised matrices; see :func:`complex_modes`."""
    matrix, rate, usable, outcome = state_matrix(about)
    special = special_entries(about)
    scaled, states = np.linalg.eig(np.where(usable[..., None, None], matrix, _stand_in(matrix)))
    order = spectrum_order(scaled)
    scaled = np.take_along_axis(scaled.astype(complex), order, axis=-1)
    states = np.take_along_axis(states.astype(complex), order[..., None, :], axis=-1)
    eigenvalues = scaled * rate[..., None]
    right, left, condition = mode_vectors(about, eigenvalues, states, usable)
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


def spectrum(about: Linearised) -> Any:
    """Only the eigenvalues (..., 2n), ordered as in :class:`ComplexModes`; NaN where there are none."""
    matrix, rate, usable, _ = state_matrix(about)
    scaled = np.linalg.eigvals(np.where(usable[..., None, None], matrix, _stand_in(matrix))).astype(complex)
    scaled = np.take_along_axis(scaled, spectrum_order(scaled), axis=-1)
    return with_special(about, np.where(usable[..., None], scaled * rate[..., None], np.nan))


def special_entries(about: Linearised) -> Any:
    """True where steady sliding exists and a freedom carries no mass or moves as a rigid body, (...)."""
    exists = np.asarray(about.equilibrium.exists)
    known = np.broadcast_to(_regular(_once(about.M)), exists.shape)
    return exists & (~known | (np.asarray(about.equilibrium.floating) > 0))


def with_special(about: Linearised, eigenvalues: Any) -> Any:
    """Eigenvalues (..., 2n) with those entries solved exactly whose pencil is singular; see `deflation`."""
    special = special_entries(about)
    if not np.any(special):
        return eigenvalues
    eigenvalues = np.array(eigenvalues)
    quick = special & (np.asarray(about.equilibrium.floating) == 0)
    if np.any(quick):
        values, answered = first_order_spectra(
            *(np.broadcast_to(part, about.K.shape)[quick] for part in (about.M, about.C, about.K))
        )
        known = np.where(
            np.isnan(values), -1e3 * np.nanmax(np.abs(values), axis=-1, keepdims=True, initial=1.0), values
        )
        values = np.take_along_axis(values, spectrum_order(known), axis=-1)
        places = np.argwhere(quick)[answered]
        eigenvalues[tuple(places.T)], special = values[answered], np.array(special)
        special[tuple(places.T)] = False
    floating = np.broadcast_to(about.equilibrium.floating, special.shape)
    free = special & (floating > 0) & np.broadcast_to(_regular(_once(about.M)), special.shape)
    if np.any(free):
        mass, damping, stiffness = (np.broadcast_to(x, about.K.shape)[free] for x in (about.M, about.C, about.K))
        values, answered = free_body_spectra(mass, damping, stiffness, floating[free])
        values = np.take_along_axis(values, spectrum_order(values), axis=-1)
        places = np.argwhere(free)[answered]
        eigenvalues[tuple(places.T)], special = values[answered], np.array(special)
        special[tuple(places.T)] = False
    for at in map(tuple, np.argwhere(special)):
        found = special_modes(about.M[at], about.C[at], about.K[at])
        eigenvalues[at] = np.nan if found is None else found[0]
    return eigenvalues


def state_matrix(about: Linearised) -> tuple[Any, Any, Any, Outcome]:
    """[[0, I], [-M^-1 K/r^2, -M^-1 C/r]], its time scale r (...) [1/s], where it can be used, and the outcome."""
    size = about.M.shape[-1]
    exists = np.asarray(about.equilibrium.exists)
    with np.errstate(all="ignore"):
        mass = _once(about.M)
        regular = _regular(mass)
        mass = np.where(regular[..., None, None], mass, np.eye(size))
        stiffness = _divided(mass, np.where(exists[..., None, None], about.K, 0.0))
        damping = _divided(mass, np.where(exists[..., None, None], about.C, 0.0))
        rate = np.maximum(np.sqrt(_largest(stiffness)), _largest(damping))
        rate = np.where(np.isfinite(rate) & (rate > 0.0), rate, 1.0)
        matrix = np.zeros((*stiffness.shape[:-2], 2 * size, 2 * size))
        matrix[..., :size, size:] = np.eye(size)
        np.divide(stiffness, -(rate[..., None, None] ** 2), out=matrix[..., size:, :size])
        np.divide(damping, -rate[..., None, None], out=matrix[..., size:, size:])
    regular = np.broadcast_to(regular, exists.shape)
    finite = np.all(np.isfinite(matrix[..., size:, :]), axis=(-1, -2))
    return matrix, rate, exists & regular & finite, _outcome(about, exists, finite | ~regular)


def _regular(mass: Any) -> Any:
    """Whether M can be inverted, judged after its rows and columns are brought to one size: kg beside kg m2."""
    with np.errstate(all="ignore"):
        regular = np.asarray(np.linalg.cond(mass, 1) < 1.0 / np.finfo(float).eps)
        if not np.all(regular):
            regular[~regular] = np.linalg.cond(levelled(mass[~regular])[0], 1) < 1.0 / np.finfo(float).eps
    return regular


def _once(mass: Any) -> Any:
    """M (n, n) where all systems share one, else as it is."""
    shared = all(step == 0 for step in mass.strides[:-2])
    return mass[(0,) * (mass.ndim - 2)] if shared and mass.size else mass


def _divided(mass: Any, matrix: Any) -> Any:
    """M^-1 A; one factorisation where all systems share one M."""
    if mass.ndim > 2 or matrix.ndim == 2:
        return np.linalg.solve(mass, matrix)
    columns = np.moveaxis(matrix, -2, 0)
    return np.moveaxis(np.linalg.solve(mass, columns.reshape(len(mass), -1)).reshape(columns.shape), 0, -2)


def _largest(matrix: Any) -> Any:
    return np.max(np.abs(matrix), axis=(-1, -2))


def _stand_in(matrix: Any) -> Any:
    """A harmless matrix for entries without a spectrum."""
    return np.diag(np.arange(1.0, matrix.shape[-1] + 1.0))


def _outcome(about: Linearised, exists: Any, finite: Any) -> Outcome:
    if not np.all(exists):
        return about.equilibrium.outcome
    if not np.all(finite):
        return Outcome("not_finite", "M^-1 K or M^-1 C overflows", entries=int(np.sum(~finite)))
    return Outcome(COMPLETED)

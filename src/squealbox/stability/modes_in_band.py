"""Complex modes of a finite-element brake in a band of frequency, each with an error bar.

The brake's real modes up to f2 / 0.7 (counted beforehand by Sturm, so none is missed) are enriched by what friction and
damping do to them; on that basis the quadratic problem is small. Every eigenvalue carries the estimate of what the
basis misses, the basis grows until no estimate is above `tolerance`, and on request the winding number of det Q says
that no growing mode is missing. See :mod:`squealbox.fe.projection` and :mod:`squealbox.fe.certificate`.
"""

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from squealbox.fe import (
    Certificate,
    GrowingBasis,
    Pencil,
    Projected,
    basis_for,
    certificate,
    certified_band,
    full_modes,
    modes_on,
    pencil_of,
    refined,
    with_shapes,
)
from squealbox.result import Array, Outcome, quantity
from squealbox.sparse_sliding import at_rest
from squealbox.stability.eigenvalues import ComplexModes
from squealbox.system import DesignOrSystem, Equilibrium, InvalidSystem, System, as_system, equilibrium

Way = Literal["projection", "full"]
TOLERANCE = 0.05  # [1/s]
KNOWN = 1e-3  # of |lambda|: estimated error above which a mode on the basis is none that is known
MOST_TOLD = 30  # modes of a table; of more only the least damped are told
NOT_ASKED = (
    "whether a growing mode is missing was not counted: certify=True, or --certify, does so by the winding number"
)


@dataclass(frozen=True, kw_only=True, eq=False)
class BandModes(ComplexModes):
    """The modes of a large brake in a band, as :func:`complex_modes` returns them of sparse matrices.

    The first half of the eigenvalues has Im > 0 and rises in frequency, the second half are the conjugates. error is
    the size of the estimated difference to the exact eigenvalue and the round-off of the small problem, `corrected` the
    eigenvalue with that estimate added. A mode counts as unstable when its growth rate is above its error bar.
    """

    error: Array = quantity("... mode", "1/s", "error bar of the eigenvalue")
    estimate: Array = quantity("... mode", "1/s", "estimate of exact less computed eigenvalue, complex")
    real_frequency: Array = quantity("real_mode", "Hz", "frequencies of the undamped modes without friction")
    band: tuple[float, float] = (0.0, 0.0)
    method: str = "projection"
    size: int = 0
    missing: int | None = None
    certified: bool = False
    certificate: str = NOT_ASKED
    real_modes_complete: bool = True

    @property
    def corrected(self) -> Any:
        """Eigenvalues with the estimate of their error added [1/s]: some ten times closer."""
        return self.eigenvalues + self.estimate

    @property
    def unstable_modes(self) -> Any:
        """Number of modes that grow by more than their error bar."""
        half = len(self.eigenvalues) // 2
        return np.array(np.sum((self.growth_rate > self.error)[:half]))

    @property
    def doubtful_modes(self) -> Any:
        """Number of modes whose growth rate is within their error bar of 0: neither stable nor unstable."""
        half = len(self.eigenvalues) // 2
        return np.array(np.sum((np.abs(self.growth_rate) <= self.error)[:half]))

    def table(self) -> dict[str, Any]:
        return {**super().table(), "error [1/s]": self.error[: len(self.error) // 2]}

    def summary(self) -> str:
        """The verdict, what is known of completeness, and a table of the modes, unstable ones first."""
        return band_table(self)


def band_modes(
    design_or_system: DesignOrSystem,
    band: tuple[float, float] | None,
    *,
    time: float = 0.0,
    method: Way = "projection",
    tolerance: float = TOLERANCE,
    certify: bool = False,
    count: int = 60,
) -> BandModes:
    """The modes of a sparse system in a band.

    Parameters
    ----------
    design_or_system : a design or system with sparse matrices
    band : (f1, f2) [Hz], 0 < f1 < f2
    time : instant of schedules [s]
    method : "projection", or "full": the whole problem by shift-invert, with no left modes and the backward error for
        an error bar; many times slower
    tolerance : [1/s] the basis grows until every error bar is below it, or four times
    certify : count the growing modes by the winding number too; some 100 factorisations
    count : eigenvalues about each shift of the full problem

    Modes whose damping ratio is above 0.1 are no candidates for squeal and are left out.
    """
    low, high = _checked_band(band)
    if method not in ("projection", "full"):
        raise ValueError(f"method = {method!r}: expected 'projection' or 'full'")
    system = as_system(design_or_system, linear=True)
    start = at_rest(system.K)
    state = equilibrium(system, time, start)
    if not state.exists:
        return _nothing(design_or_system, system, state, (low, high), time)
    pencil = pencil_of(system, time, state)
    common: dict[str, Any] = {"band": (low, high), "method": method, "size": system.size}
    common |= {"steady": state.q, "exists": np.array(True), "contacts": system.contacts.names}
    common |= {"normal_force": state.normal_force, "inputs": _inputs(design_or_system, time)}
    common["floating"] = np.array(0)  # a body that is free to move has no mode in a band above 0
    common["settings"] = {"band": [low, high], "method": method, "tolerance": tolerance, "certify": certify}
    if method == "full":
        return _full(pencil, (low, high), count, common)
    order = None if start.base is None else start.base.order
    del start  # its factor is large
    modes, basis = basis_for(pencil, (low, high), order)
    onto = GrowingBasis([pencil], basis)
    refined(onto, modes.base, (low, high), tolerance)
    found = with_shapes(onto, modes_on(onto, 0, modes.base, (low, high))[0])
    common |= {"real_frequency": modes.frequency, "real_modes_complete": modes.complete}
    if certify:
        wide, _ = modes_on(onto, 0, modes.base, certified_band((low, high)))
        known, others = known_eigenvalues(wide)
        proof = certificate(pencil, known, (low, high), believed=others)
        common |= {"missing": proof.missing, "certified": proof.certified, "certificate": str(proof)}
    return BandModes(
        eigenvalues=_both(found.eigenvalues),
        right=np.concatenate([found.right, found.right.conj()], axis=1),
        left=np.concatenate([found.left, found.left.conj()], axis=1),
        condition=np.tile(found.condition, 2),
        error=np.tile(np.abs(found.error) + _rounding(found), 2),
        estimate=_both(found.error),
        outcome=_outcome(modes.complete, modes.count, len(modes.frequency), modes.top),
        **common,
    )


def certified(
    design_or_system: DesignOrSystem,
    eigenvalues: ArrayLike,
    band: tuple[float, float],
    *,
    time: float = 0.0,
    most: int = 150,
) -> Certificate:
    """Whether a list of eigenvalues [1/s] holds every mode of a sparse system that grows in the band (f1, f2) [Hz].

    `band` [Hz]: from and to; `time` [s]: instant at which schedules are taken.

    eigenvalues, shape (k,), should hold the modes somewhat outside the band too, so that the phase stays smooth; `most`
    is the number of factorisations after which the search gives up. The answer names how many modes are missing.
    """
    system = as_system(design_or_system, linear=True)
    if not system.is_sparse:
        raise InvalidSystem("a dense system has its whole spectrum in complex_modes: there is nothing to certify")
    return certificate(pencil_of(system, time), eigenvalues, _checked_band(band), most=most)


def known_eigenvalues(found: Projected) -> tuple[Any, Any]:
    """The modes of the band, corrected, whose estimated error is small; and all others of the basis as they are."""
    known = np.abs(found.error) <= KNOWN * np.abs(found.eigenvalues)
    others = found.every[found.every.imag > 0.0]
    shown = np.array([np.any(np.abs(found.eigenvalues[known] - v) <= 1e-9 * abs(v)) for v in others], dtype=bool)
    return (found.eigenvalues + found.error)[known], others[~shown]


def band_table(modes: BandModes) -> str:
    """Verdict, completeness and the table."""
    if not bool(modes.exists):
        return f"No complex modes: {modes.outcome} ({modes.outcome.message})"
    half = len(modes.eigenvalues) // 2
    state = "STABLE" if bool(modes.stable) else "UNSTABLE"
    lines = [
        f"Steady sliding is {state} between {modes.band[0]:g} and {modes.band[1]:g} Hz: "
        f"{int(modes.unstable_modes)} of {half} modes grow ({modes.size} degrees of freedom)"
    ]
    if int(modes.doubtful_modes):
        lines.append(f"Of {int(modes.doubtful_modes)} modes the growth rate is within its error bar of 0.")
    lines.append(modes.certificate[:1].upper() + modes.certificate[1:] + ".")
    lines.append(f"{'mode':>5} {'frequency [Hz]':>15} {'growth [1/s]':>14} {'error [1/s]':>12} {'damping [%]':>12}")
    ratio = modes.damping_ratio[:half]
    shown = set(range(half)) if half <= MOST_TOLD else {*np.argsort(ratio)[:MOST_TOLD].tolist()}
    shown |= {i for i in range(half) if modes.growth_rate[i] > -modes.error[i]}
    order = sorted(shown, key=lambda i: (modes.growth_rate[i] <= modes.error[i], modes.frequency[i]))
    for i in order:
        mark = "  unstable" if modes.growth_rate[i] > modes.error[i] else ""
        cells = (modes.frequency[i], modes.growth_rate[i], modes.error[i], 100.0 * modes.damping_ratio[i])
        lines.append("{:>5} {:>15.6g} {:>+14.6g} {:>12.2g} {:>+12.4f}".format(i + 1, *cells) + mark)
    if len(shown) < half:
        lines.append(f"and {half - len(shown)} more, all better damped than these")
    return "\n".join(lines)


def _checked_band(band: tuple[float, float] | None) -> tuple[float, float]:
    if band is None:
        raise ValueError("band is missing: a sparse system needs the band of frequency looked at, band=(f1, f2) in Hz")
    if np.shape(band) != (2,) or not (np.all(np.isfinite(band)) and 0.0 < band[0] < band[1]):
        raise ValueError(f"band = {band!r}: expected (f1, f2) in Hz with 0 < f1 < f2")
    return float(band[0]), float(band[1])


def _rounding(found: Projected) -> Any:
    """What the eigenvalues of the small problem lose in floating point (k,) [1/s]: no error bar is below it.

    The order of the small problem times the unit round-off times condition and size of the eigenvalue; the residuals
    of a basis that spans everything say nothing of it.
    """
    return len(found.every) * np.finfo(float).eps * found.condition * np.abs(found.eigenvalues)


def _full(pencil: Pencil, band: tuple[float, float], count: int, common: dict[str, Any]) -> BandModes:
    found = full_modes(pencil, band, count)
    order = np.argsort(found.eigenvalues.imag, kind="stable")
    values, shapes = found.eigenvalues[order], found.shapes[:, order]
    scale = np.tile(found.backward_error[order] * np.abs(values), 2)
    outcome = Outcome()
    if not found.covered:
        outcome = Outcome("band_not_covered", f"{found.factorisations} disks left gaps in the band; ask for more modes")
    return BandModes(
        eigenvalues=_both(values),
        right=np.concatenate([shapes, shapes.conj()], axis=1),
        left=np.full((pencil.size, 2 * len(values)), np.nan + 0j),
        condition=np.full(2 * len(values), np.nan),
        error=scale,
        estimate=np.zeros(2 * len(values), dtype=complex),
        real_frequency=np.zeros(0),
        outcome=outcome,
        **common,
    )


def _nothing(
    design: DesignOrSystem, system: System, state: Equilibrium, band: tuple[float, float], time: float
) -> BandModes:
    none, flat = np.zeros((system.size, 0), dtype=complex), np.zeros(0, dtype=complex)
    return BandModes(
        eigenvalues=flat,
        right=none,
        left=none,
        condition=np.zeros(0),
        steady=np.full(system.size, np.nan),
        exists=np.array(False),
        normal_force=state.normal_force,
        floating=np.array(0),
        error=np.zeros(0),
        estimate=flat,
        real_frequency=np.zeros(0),
        band=band,
        size=system.size,
        contacts=system.contacts.names,
        inputs=_inputs(design, time),
        outcome=state.outcome,
    )


def _outcome(complete: bool, count: int, found: int, top: float) -> Outcome:
    if complete:
        return Outcome()
    message = f"{found} of {count} real modes below {top:.6g} Hz were found: the basis misses some"
    return Outcome("real_modes_missing", message, found=found, count=count)


def _inputs(design: DesignOrSystem, time: float) -> dict[str, Any]:
    """The design; a bare system of sparse matrices is too large to be kept in every result."""
    return {"system": None if isinstance(design, System) else design, "time": time}


def _both(values: np.ndarray) -> Any:
    return np.concatenate([values, np.conj(values)])

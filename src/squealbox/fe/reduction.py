"""From a large sparse brake to a small one with a known error: `reduce`.

Three bases: "enriched", real modes and what friction and damping do to them (`basis.py`), grown by the residuals of the
modes in the band until their error estimates are small at the corners of all ranges; "craig-bampton", every freedom
that a contact touches and the modes with those held; "pod", the main directions of the modes of the full problem at a
few values of what varies (Graebner et al. 2016).
"""

from collections.abc import Mapping
from itertools import product
from typing import Any, Literal

import numpy as np

from squealbox.arguments import named, public
from squealbox.factorisation import Order
from squealbox.fe.band_spectrum import band_pairs
from squealbox.fe.basis import joined
from squealbox.fe.craig_bampton import craig_bampton_basis
from squealbox.fe.full_brake import FullBrake, full_system
from squealbox.fe.growing_basis import ROWS, GrowingBasis
from squealbox.fe.opening import opening_directions
from squealbox.fe.pencil import Pencil, SlidingPencil, pencil_of, vibrating
from squealbox.fe.projection import HEADROOM, ROUNDS, Projected, basis_for, refined
from squealbox.fe.quadratic import full_modes
from squealbox.fe.reduced_brake import FIELDS, ChangeAlong, ReducedBrake, Reduction, chebyshev_points, lagrange
from squealbox.fe.reduced_sliding import steady_small
from squealbox.fe.small import Small
from squealbox.fe.undamped_modes import real_modes
from squealbox.sparse_sliding import Nearby, at_rest
from squealbox.system import DesignOrSystem, InvalidSystem, System, as_system

Basis = Literal["enriched", "craig-bampton", "pod"]
METHODS = ("enriched", "craig-bampton", "pod")
POINTS = (3, 5, 9, 17, 33)  # Chebyshev points of a parameter that changes matrices, until the new ones were foreseen
FORESEEN = 1e-5  # by so much of the largest entry; what lies between the new ones is then known far better
MOST_AXES = 4
OPENING = 10.0  # of the tolerance: what the shapes of contacts that open may lack before residuals are looked at
HIGH_DAMPING = (0.02, 0.2)  # damping ratios that are tried
SEEN = 1e-5  # share of the strongest direction from which on the band's modes have a part in a direction
INSIDE = (0.25, 0.75)  # shares of the ranges at which added damping is checked, beside their corners
HELD = 3.0  # times the band up to which modes with held contacts are taken
SNAPSHOTS = 3  # values of each parameter at which POD looks


@public(varying=named)
def reduce(
    design_or_system: Any,
    band: tuple[float, float],
    *,
    varying: Mapping[str, tuple[float, float]] | None = None,
    method: Basis = "enriched",
    tolerance: float = 0.05,
    time: float = 0.0,
) -> ReducedBrake:
    """A small brake whose modes in a band are those of a large sparse one.

    Parameters
    ----------
    design_or_system : with sparse matrices; a bare `System` can vary the coefficients of its friction law
    band : (f1, f2) [Hz]
    varying : {parameter: (low, high)}: what shall be varied later; the basis is checked at every corner of the ranges
    method : "enriched", "craig-bampton" or "pod", as the module's head says
    tolerance : [1/s] the error estimate that every eigenvalue in the band shall stay below
    time : instant of schedules [s]

    Returns a `ReducedBrake`; its `error` may be above `tolerance`, and says so. Directions above the band that the
    small brake would wrongly let grow are given modal damping (`reduction.high_damping`) as far as it leaves the band
    alone; what still grows there is `reduction.high_growth`, and the summary says so. Raises `InvalidSystem` without
    steady sliding at a corner.
    """
    low, high = _checked(band, varying or {}, method)
    ranges = dict(varying or {})
    system = as_system(design_or_system, linear=True)
    if not system.is_sparse:
        raise InvalidSystem(f"the system is dense, with {system.size} degrees of freedom: it needs no reduction")
    corners = _corners(design_or_system, ranges)
    rest = at_rest(system.K)
    reference = pencil_of(system, time, start=rest)
    order = None if rest.base is None else rest.base.order
    del rest  # its factor is large
    steady = reference.state.q
    modes, basis = _first_basis(method, design_or_system, reference, ranges, (low, high), time, order)
    full = FullBrake(design_or_system, basis, steady, modes.base, time)
    pencils = _pencils_at(full, reference, corners)
    basis = _with_statics(reference, pencils, basis)
    if method == "enriched":
        basis = joined(reference, basis, opening_directions(modes, [reference, *pencils], high, OPENING * tolerance))
    onto = GrowingBasis([reference, *pencils], basis)
    found = refined(onto, modes.base, (low, high), 0.5 * tolerance, ROUNDS if method == "enriched" else 0)
    onto.turn()
    full = FullBrake(design_or_system, onto.blocks[0], steady, modes.base, time)
    arrays = full.projected_arrays(system, onto.structural(0))
    axes, values = [], {}
    for name, (start, end) in ranges.items():
        axis = _axis(full, name, float(start), float(end), arrays)
        if axis is not None:
            axes.append(axis)
            values[name] = float(design_or_system.value_of(name))
    law = system.contacts.law
    reduction = Reduction(
        arrays=arrays,
        laws=law if isinstance(law, tuple) else [system.contacts.law_of(i) for i in range(len(system.contacts))],
        unilateral=np.array(system.contacts.unilateral),
        contact_names=system.contacts.names,
        band=(low, high),
        top=modes.top,
        size=system.size,
        axes=tuple(axes),
        tolerance=tolerance,
        method=method,
    )
    shared = None if isinstance(law, tuple) or any(np.ndim(c) for c in law.coefficients()) else law
    small = ReducedBrake(
        reduction=reduction, friction=shared if len(system.contacts) else None, values=values, full=full
    )
    inside = [small.replace(point).linearised(time) for point in _between(ranges)]
    smalls = [onto.small(i) for i in range(1 + len(pencils))] + [one for one in inside if one is not None]
    damping, amount, growth = _damped_above(smalls, onto.elastic(0), modes.top * HEADROOM, tolerance)
    arrays["C"], arrays["high"] = arrays["C"] + damping, damping
    reduction = reduction.replace(arrays=arrays, high_damping=amount, high_growth=growth)
    small = small.replace({"reduction": reduction})
    points = zip([{}, *corners], found, strict=True)
    errors = [(point, _error(small.replace(point), modes_there, time)) for point, modes_there in points]
    return small.replace({"reduction": reduction.replace(errors=tuple(errors))})


def _corners(design: DesignOrSystem, ranges: Mapping[str, tuple[float, float]]) -> list[dict[str, float]]:
    """The corners of all ranges and their middle, but for the design itself, which is looked at anyway."""
    if not ranges:
        return []
    corners = [dict(zip(ranges, values, strict=True)) for values in product(*ranges.values())]
    corners.append({name: 0.5 * (low + high) for name, (low, high) in ranges.items()})
    present = {name: _present(design, name) for name in ranges}
    return [corner for corner in corners if corner != present]


def _present(design: Any, name: str) -> float:
    """The value behind a name; NaN where it has none yet."""
    if isinstance(design, System):
        law, known = design.contacts.law, name.startswith("friction.")
        value = law.value_of(name.removeprefix("friction.")) if known and not isinstance(law, tuple) else None
    else:
        value = design.value_of(name)
    return float("nan") if value is None else float(value)


def _checked(band: tuple[float, float], varying: Mapping[str, tuple[float, float]], method: str) -> tuple[float, float]:
    if np.shape(band) != (2,) or not (np.all(np.isfinite(band)) and 0.0 < band[0] < band[1]):
        raise ValueError(f"band = {band!r}: expected (f1, f2) in Hz with 0 < f1 < f2")
    if method not in METHODS:
        raise ValueError(f"method = {method!r}: expected one of {', '.join(METHODS)}")
    if len(varying) > MOST_AXES:
        raise ValueError(f"varying holds {len(varying)} parameters: expected at most {MOST_AXES}, for their corners")
    for name, bounds in varying.items():
        if np.shape(bounds) != (2,) or not (np.all(np.isfinite(bounds)) and bounds[0] < bounds[1]):
            raise ValueError(f"varying[{name!r}] = {bounds!r}: expected (low, high) with low < high")
    return float(band[0]), float(band[1])


def _first_basis(
    method: str,
    design: DesignOrSystem,
    reference: Pencil,
    ranges: Mapping[str, Any],
    band: tuple[float, float],
    time: float,
    order: Order | None,
) -> tuple[Any, Any]:
    if method == "enriched":
        return basis_for(reference, band, order)
    modes = real_modes(reference.elastic, reference.M, band[1] / HEADROOM, order)
    if method == "craig-bampton":
        return modes, craig_bampton_basis(reference, _touched(design), HELD * band[1])
    shapes = []
    for values in product(*(np.linspace(low, high, SNAPSHOTS) for low, high in ranges.values())):
        pencil = pencil_of(full_system(design, dict(zip(ranges, map(float, values), strict=True))), time)
        mirrored = Pencil(pencil.M, pencil.C.T.tocsr(), pencil.K.T.tocsr(), pencil.elastic)
        for one in (pencil, mirrored):  # right shapes, and left ones as right shapes of the transposed matrices
            found = full_modes(one, band).shapes
            shapes += [found.real, found.imag]
    return modes, _main_directions(reference, np.concatenate(shapes, axis=1))


def _main_directions(pencil: Pencil, shapes: np.ndarray, share: float = 1e-5) -> Any:
    """The directions of `shapes` whose singular value is above `share` of the largest, V' M V = I."""
    lengths = np.sqrt(np.einsum("ij,ij->j", shapes, pencil.M @ shapes))
    shapes = shapes[:, lengths > 0.0] / lengths[lengths > 0.0]
    gram = shapes.T @ (pencil.M @ shapes)
    values, turns = np.linalg.eigh(0.5 * (gram + gram.T))
    keep = values > share**2 * values[-1]
    first = shapes @ (turns[:, keep] / np.sqrt(values[keep]))
    return joined(pencil, np.zeros((pencil.size, 0)), first)


def _touched(design: DesignOrSystem) -> Any:
    """Degrees of freedom that a contact senses or acts on."""
    table = as_system(design, linear=True).contacts
    rows = [getattr(table, field) for field in ("n", "d", "t", "normal", "across")]
    used = sum(np.asarray(abs(row).sum(axis=0)).ravel() for row in rows if row is not None)
    return np.flatnonzero(used)


def _with_statics(reference: SlidingPencil, pencils: list[SlidingPencil], basis: np.ndarray) -> Any:
    """The basis with the differences of steady sliding between the corners and the reference."""
    moved = [pencil.state.q - reference.state.q for pencil in pencils]
    columns = [q for q in moved if np.any(q)]
    return joined(reference, basis, np.stack(columns, axis=1)) if columns else basis


def _pencils_at(full: FullBrake, reference: SlidingPencil, points: list[dict[str, float]]) -> list[SlidingPencil]:
    """The matrices about steady sliding at other points, which is looked for first on the basis where it may do."""
    system, basis = reference.sliding.system, full.basis
    known = {name: None if (rows := getattr(system.contacts, name)) is None else rows @ basis for name in ROWS}
    known |= {"M": None, "C": 0.0, "K": basis.T @ (system.K @ basis), "across": None}
    found = []
    for point in points:
        there, near = full.system(point), None
        law = there.contacts.law
        if there.K is system.K and not isinstance(law, tuple):
            near = steady_small(full.projected_arrays(there, known), law, np.asarray(there.contacts.unilateral))
        q = full.steady if near is None else full.steady + basis @ near[1].q
        found.append(pencil_of(there, full.time, start=Nearby(q, full.base)))
    return found


def _axis(full: FullBrake, name: str, low: float, high: float, arrays: dict[str, Any]) -> ChangeAlong | None:
    """What changes along one parameter; None for a coefficient of the friction law, which the contacts know."""
    if name.startswith("friction."):
        return None
    points, samples, missed = np.zeros(0), [], ""
    for count in POINTS:
        before, points = points, chebyshev_points(low, high, count)
        new = points[1::2] if len(before) else points
        found = [full.projected_arrays(full.system({name: float(value)})) for value in new]
        if not len(before):
            samples = found
            continue
        missed = _not_foreseen(name, samples, found, lagrange(before, new))
        samples = [one for pair in zip(samples, [*found, None], strict=True) for one in pair if one is not None]
        if not missed:
            break
    if missed:
        raise InvalidSystem(f"{name} from {low:g} to {high:g} changes {missed} too abruptly: expected a narrower range")
    change = {}
    for field in FIELDS:
        if arrays[field] is not None:
            difference = np.stack([sample[field] for sample in samples]) - arrays[field]
            if np.max(np.abs(difference), initial=0.0) > 1e-13 * np.max(np.abs(arrays[field]), initial=0.0):
                change[field] = difference
    return ChangeAlong(name=name, low=low, high=high, points=points, change=change)


def _not_foreseen(name: str, samples: list[Any], found: list[Any], weights: np.ndarray) -> str:
    """The first field of `found` that the polynomial through `samples` misses; "" for none."""
    for field in FIELDS:
        if samples[0][field] is None:
            continue
        if any(np.shape(one[field]) != np.shape(samples[0][field]) for one in [*samples, *found]):
            raise InvalidSystem(f"{name} changes the contacts themselves: expected a parameter that keeps the mesh")
        there = np.stack([one[field] for one in found])
        off = there - np.tensordot(weights, np.stack([one[field] for one in samples]), axes=1)
        if np.max(np.abs(off), initial=0.0) > FORESEEN * np.max(np.abs(there), initial=0.0):
            return field
    return ""


def _between(ranges: Mapping[str, tuple[float, float]]) -> list[dict[str, float]]:
    """Points inside the ranges at which damping added above the band is held against it."""
    points = [{name: low + share * (high - low) for name, (low, high) in ranges.items()} for share in INSIDE]
    return points if ranges else []


def _damped_above(smalls: list[Small], elastic: np.ndarray, top: float, allowed: float) -> tuple[Any, float, float]:
    """The least damping with which no mode above `top` [Hz] grows at any point, as far as it leaves the band alone.

    It acts on the directions that no right shape of a mode below `top`, at any point, has a part in: C_h u = 0 for
    those u. What still moves a lightly damped mode below `top` by more than `allowed` [1/s] is not added. Returns the
    matrix, the damping ratio, and the growth rate [1/s] that is left above `top`.
    """
    mass, end = smalls[0].M, 2.0 * np.pi * top
    nothing = np.zeros_like(mass)
    rising = [_growth_above(small.eigenvalues(), end) for small in smalls]
    growth = max(rising)
    if growth == 0.0:
        return nothing, 0.0, 0.0
    shapes, light = [], []
    for small in smalls:
        values, right = small.right_shapes()
        below = (values.imag >= 0.0) & (values.imag <= end)
        shapes += [right[:, below].real, right[:, below].imag]
        light.append(values[below & vibrating(values)])
    half = np.linalg.cholesky(mass).T  # lengths by M
    columns = half @ np.concatenate(shapes, axis=1)
    columns = columns / np.maximum(np.linalg.norm(columns, axis=0), 1e-300)
    turned, sizes, _ = np.linalg.svd(columns)
    rest = turned[:, np.sum(sizes > SEEN * sizes[0]) :]
    if rest.shape[1] == 0:
        return nothing, 0.0, growth
    free = np.linalg.solve(half, rest)
    squares, turns = np.linalg.eigh(free.T @ elastic @ free)
    directions, rates = mass @ free @ turns, np.sqrt(np.maximum(squares, 0.0))
    best = nothing, 0.0, growth
    for amount in HIGH_DAMPING:
        damping = (directions * (2.0 * amount * rates)) @ directions.T
        worst = smalls[int(np.argmax(rising))]
        if amount != HIGH_DAMPING[-1] and _growth_above(_damped(worst, damping).eigenvalues(), end) > 0.0:
            continue  # too little
        after = [_damped(small, damping).eigenvalues() for small in smalls]
        moved = [np.min(np.abs(v - old), initial=np.inf) for v, olds in zip(after, light, strict=True) for old in olds]
        if max(moved, default=0.0) > allowed:
            break
        best = damping, amount, max(_growth_above(values, end) for values in after)
        if best[2] == 0.0:
            break
    return best


def _damped(small: Small, damping: np.ndarray) -> Small:
    return Small(small.M, small.C + damping, small.K)


def _growth_above(values: np.ndarray, top: float) -> float:
    """The largest growth rate [1/s] of eigenvalues above `top` [rad/s], 0 where none grows."""
    growing = (np.abs(values.imag) > top) & (values.real > 1e-10 * np.abs(values))
    return float(np.max(values.real[growing], initial=0.0))


def _error(small: ReducedBrake, found: Projected, time: float) -> float:
    """The largest error of an eigenvalue in the band at one point, against the full brake there.

    It adds what the basis misses to what else parts the small brake from the projected full one: interpolation over
    parameters, added damping, contacts that its steady sliding would open otherwise.
    """
    there = small.linearised(time)
    if there is None:
        return float("inf")
    pairs = band_pairs(there, small.band, rough=True)
    values = there.eigenvalues() if pairs is None else pairs.values
    beside = np.array([np.min(np.abs(values - value), initial=np.inf) for value in found.eigenvalues])
    return float(np.max(np.abs(found.error) + beside, initial=0.0))

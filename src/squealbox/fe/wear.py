"""Linings worn by running in.

By Archard's law (Archard 1953, Journal of Applied Physics 24, 981-988) what wears off a place is in proportion to its
pressure times the way it slides, and so, in a brake, to pressure times radius:

    dg = p r da,    p = max(k (u . e_n - g), 0)

with g the depth worn off, k the stiffness of contact per area and a common to all places. Where more is worn off less
is pressed, until p r is the same over all that touches. Explicit steps need dg < 2 p / k, some micrometres in all; a
step is therefore implicit, g1 = g + a r p with the p after it, which makes softer contacts of it:

    p = k / (1 + k a r) (u . e_n - g)

so one steady sliding of the same brake. a is that with which the mean depth grows by the step.

A lining comes after what it has lost. A shoe turns on its anchor, under the given force of the cylinder. A pad on
springs of a caliper would lose its load; the caliper follows, so the spring's end c moves with the pad as far as the
spring keeps the force it had when the pad was new. Both are rigid motions R of the lining that change nothing but the
gap, and what is left of the depth when they are taken out, g - (R . e_n) c, is what makes a worn contact another one.
"""

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy import sparse

from squealbox.contacts import Contacts
from squealbox.factorisation import factor
from squealbox.friction import Coulomb
from squealbox.parameters import ParameterError, parameter
from squealbox.sparse_sliding import Nearby, SlidingState, sliding_state
from squealbox.system import InvalidSystem

if TYPE_CHECKING:
    from scipy.sparse import sparray

STEPS = 8  # of one running in, each longer than the one before
LONGER = 1.5  # times
GAMMA = 1.0 - 0.5**0.5
TRIES = 20  # to find a of the last step
DEPTH_FOUND = 1e-8  # share of the last step


class Worn(NamedTuple):
    """Of each contact point: depth worn off (k,) [m], and its part that makes the contact another one (k,) [m]."""

    depth: Any
    uneven: Any


class Pressed(NamedTuple):
    """A brake as it runs in: K (n, n) with every contact closed, load (n,), rows (k, n) e_n . u and e_t . u, area (k,),
    radius (k,), stiffness of contact per area k, friction, and moving (n, linings): R of each lining.
    """

    stiffness: Any
    load: Any
    normal: Any
    along: Any
    area: Any
    radius: Any
    contact: float
    friction: float
    moving: Any


def depth_worn() -> Any:
    """The parameter `running_in`."""
    return parameter("m", 0.0, default=0.0, meaning="mean depth worn off the linings since they were new")


def check_depth(brake: str, running_in: ArrayLike, thickness: float | np.ndarray) -> None:
    """Raise `ParameterError` where more is worn off than the lining is thick [m]."""
    if not np.all(np.asarray(running_in) < thickness):
        raise ParameterError(brake, "running_in", running_in, "less than the thickness of the lining")


def friction_while_wearing() -> Any:
    """The parameter `running_in_friction`."""
    return parameter("-", 0.0, default=0.4, meaning="friction with which the linings wore")


def run_in(
    brake: Pressed, mean: float, following: "sparray | None" = None, steps: int = STEPS, longer: float = LONGER
) -> Worn:
    """Linings after `mean` [m] has been worn off them, in the mean over the area of all.

    following (n, n) are springs whose other ends come along with the lining, None where there are none. Raises
    `InvalidSystem` where the brake has no steady sliding on its way.
    """
    q = _sliding(brake, 1.0, 0.0, None).q
    brake, q, ends = _with_ends(brake, following @ brake.moving, q) if following is not None else (brake, q, 0)
    reach = brake.normal @ brake.moving
    within = np.divide(1.0, reach, out=np.zeros_like(reach), where=np.abs(reach) > 1e-3 * np.max(np.abs(reach)))
    weight, depth, order = brake.area / np.sum(brake.area), np.zeros(len(brake.area)), None
    pressure = np.maximum(brake.contact * (brake.normal @ q), 0.0)
    for at, length in enumerate(mean * _lengths(steps, longer), 1):
        step = mean - float(weight @ depth) if at == steps else float(length)
        a, base = step / float(weight @ (brake.radius * pressure)), None
        for _ in range(TRIES):
            soft = 1.0 / (1.0 + GAMMA * brake.contact * a * brake.radius)
            base = factor(_softer(brake, soft), True, order=order) if base is None else base
            first = _sliding(brake, soft, depth, Nearby(q, base))
            worn = a * brake.radius / brake.area * (1.0 - GAMMA) * first.normal
            near = first.q + brake.moving @ np.max(worn[:, None] * within, axis=0)  # what pressed presses still
            found = _sliding(brake, soft, depth + worn, Nearby(near, base))
            worn = worn + a * brake.radius / brake.area * GAMMA * found.normal
            pressure, q, order = found.normal / brake.area, found.q, base.order
            share = float(weight @ worn) / step
            if at < steps or abs(share - 1.0) < DEPTH_FOUND:  # only all of them together have a given length
                break
            a /= share
        else:
            raise InvalidSystem(f"running_in: the last step wears {share:.6g} of what it should after {TRIES} tries")
        depth = depth + worn
    if ends:
        return Worn(depth, depth - reach @ q[-ends:])
    taken = ((brake.area * depth) @ reach) / (brake.area @ reach**2)
    return Worn(depth, depth - reach @ taken)


def _lengths(steps: int, longer: float) -> Any:
    """Lengths of the steps, (steps,), together 1."""
    lengths = longer ** np.arange(steps)
    return lengths / np.sum(lengths)


def _softer(brake: Pressed, soft: float | np.ndarray) -> Any:
    """K with the stiffness of contacts times `soft` (k,)."""
    less = sparse.diags_array((1.0 - soft) * brake.contact * brake.area) @ brake.normal
    return sparse.csr_array(brake.stiffness - brake.normal.T @ less)


def _sliding(brake: Pressed, soft: float | np.ndarray, depth: float | np.ndarray, start: Nearby | None) -> SlidingState:
    """Steady sliding with contacts that are softer by `soft` (k,), after `depth` (k,) has been worn off."""
    spring = soft * brake.contact * brake.area
    contacts = Contacts(
        n=sparse.diags_array(spring) @ brake.normal,
        d=brake.along,
        t=brake.along,
        N0=-spring * depth,
        V=1.0,
        law=Coulomb(brake.friction),
        unilateral=True,
        normal=brake.normal,
    )
    stiffness = brake.stiffness if start is None else _softer(brake, soft)
    load = brake.load + brake.normal.T @ (spring * depth)  # beside K q, closed contacts press with N0, too
    found = sliding_state(stiffness, load, contacts, 0.0, start)
    if found.singular or not found.settled or not np.any(found.normal):
        said = "nothing holds or presses the linings" if found.settled or found.singular else "contacts do not settle"
        raise InvalidSystem(f"running_in: no steady sliding while the linings wear, {said}")
    return found


def _with_ends(brake: Pressed, tied: np.ndarray, q: np.ndarray) -> tuple[Pressed, Any, int]:
    """The brake with the ends c of its springs as freedoms after the others, each under the force it has at q.

    tied (n, linings): the springs' stiffness times R. Nothing to do where no spring is stretched by R.
    """
    if not np.any(tied):
        return brake, q, 0
    inner, ends = brake.moving.T @ tied, tied.shape[1]
    return (
        brake._replace(
            stiffness=sparse.block_array([[brake.stiffness, -tied], [-tied.T, inner]], format="csr"),
            load=np.concatenate([brake.load, -tied.T @ q]),
            normal=_wider(brake.normal, ends),
            along=_wider(brake.along, ends),
            moving=np.concatenate([brake.moving, np.eye(ends)]),
        ),
        np.pad(q, (0, ends)),
        ends,
    )


def _wider(rows: "sparray", more: int) -> Any:
    """Rows that do not feel `more` freedoms after the others."""
    return sparse.csr_array((rows.data, rows.indices, rows.indptr), shape=(rows.shape[0], rows.shape[1] + more))

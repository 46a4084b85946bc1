"""How the 2011 paper's friction is read: each reading of `DrumBrake` is a small function that returns contact rows.

With s = sin theta_i and c = cos theta_i, the rows (n, d, t, V, N0) of each reading stand in its function. Two readings,
`reconstructed` and `reconstructed_simple`, are not printed anywhere: they are inferred from the paper's numbers by the
search in `squealbox.papers.drum_brake_2011`, which also says how often a search of that size meets scrambled numbers
as well.

The sign in the y row
---------------------
The paper prints the friction forces as +, - (shoe 1, shoe 2) along x and -, + along y, with sgn(V_B cos theta - x')
and sgn(V_B sin theta - y'). Friction F = mu N sgn(v) d on the drum, N >= 0, at the sliding velocity v = V - t.q' of
the belt seen from the drum, does work where drum and belt slide on each other at the rate

    (F.t) (t.q' - V) = -(d.t) mu N |v|

so it takes energy only with d = t, where it drags the drum along the belt; with d = -t it pushes the drum against the
belt it slides on and feeds in at any speed. The factor before a sgn is therefore that of t within it. The sgn along y
is printed with t = +e_y, as if both belts ran towards +y; the tangent tau = (cos theta, -sin theta) would give t =
-e_y and sgn(V_B sin theta + y'). The printed minus in front counts tau's sign, the sgn does not: one of the two has
to go. What remains before sgn(V_B sin theta - y') is then the sign of the normal force alone, and that is a property
of the shoe, not of the row: the two shoes press from opposite sides, what loads one unloads the other, which is the
+, - of the x row. The same two normal forces stand in the y row, so it reads +, - as well.

This is an argument about the paper's component-wise form. The physics behind it, one contact a shoe along its tangent,
is `consistent`.
"""

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from squealbox.designs.rows import vector
from squealbox.system import Contact

if TYPE_CHECKING:
    from squealbox.designs.drum_brake import DrumBrake

TABLE_SPEED = 0.2  # m/s, the paper's table
ASSUMED_SLOPE = -0.05  # s/m: alpha is not in the paper, see docs/papers/drum_brake_2011


class Reading(NamedTuple):
    """One way to read the paper: its contact rows, the signs of the loads, and what it takes where nothing is given.

    The loads act along N1 (x1 s1, y1 c1) + N2 (x2 s2, y2 c2), with `load` = (x1, y1, x2, y2). An `inferred` reading is
    not printed: its signs, `slope` [s/m] and `sliding_speed` [m/s] were found by a search for the paper's numbers, and
    it reads the paper's amplitudes as peak to peak.
    """

    contacts: Callable[["DrumBrake"], tuple[Contact, ...]]
    load: tuple[float, float, float, float] = (1.0, -1.0, -1.0, 1.0)
    slope: float = ASSUMED_SLOPE
    sliding_speed: float = TABLE_SPEED
    inferred: bool = False


Row = tuple[str, Any, Any, str, Any]
AXES = {"x": np.array([1.0, 0.0]), "y": np.array([0.0, 1.0])}


def _componentwise(brake: "DrumBrake", rows: list[Row], preloads: tuple[Any, ...] = (0.0,) * 4) -> tuple[Contact, ...]:
    """Contacts acting and sensing along x or y, from rows of (name, n_x, n_y, axis, sliding speed) and their N0."""
    return tuple(
        Contact(vector(nx, ny), AXES[axis], AXES[axis], preload, speed, brake.friction, name=name)
        for (name, nx, ny, axis, speed), preload in zip(rows, preloads, strict=True)
    )


def _eq1_printed(brake: "DrumBrake") -> tuple[Contact, ...]:
    s1, c1, s2, c2 = brake.directions
    k3, k4, speed = brake.k3, brake.k4, brake.sliding_speed
    return _componentwise(brake, [
        ("shoe 1 x", k3 * s1**2, 0.0, "x", speed * c1),
        ("shoe 2 x", -k4 * s2**2, 0.0, "x", speed * c2),
        ("shoe 1 y", 0.0, -k3 * c1**2, "y", speed * s1),
        ("shoe 2 y", 0.0, k4 * c2**2, "y", speed * s2),
    ])  # fmt: skip


def _eq3_rows(
    brake: "DrumBrake", speed1: float | np.ndarray, speed2: float | np.ndarray, along_y: float = -1.0
) -> list[Row]:
    """The rows of Eq. (3): +, - along x; `along_y` -1 for the printed -, + along y, +1 for +, -."""
    s1, c1, s2, c2 = brake.directions
    k3, k4, speed = brake.k3, brake.k4, brake.sliding_speed
    return [
        ("shoe 1 x", 0.0, k3 * c1**2, "x", speed1),
        ("shoe 2 x", 0.0, -k4 * c2**2, "x", speed2),
        ("shoe 1 y", along_y * k3 * s1**2, 0.0, "y", speed * s1),
        ("shoe 2 y", -along_y * k4 * s2**2, 0.0, "y", speed * s2),
    ]


def _eq3(brake: "DrumBrake") -> tuple[Contact, ...]:
    _, c1, _, c2 = brake.directions
    return _componentwise(brake, _eq3_rows(brake, brake.sliding_speed * np.abs(c1), brake.sliding_speed * np.abs(c2)))


def _eq3_signed(brake: "DrumBrake") -> tuple[Contact, ...]:
    _, c1, _, c2 = brake.directions
    return _componentwise(brake, _eq3_rows(brake, brake.sliding_speed * c1, brake.sliding_speed * c2))


def _whole_compression(brake: "DrumBrake") -> tuple[Contact, ...]:
    s1, c1, s2, c2 = brake.directions
    k3, k4, speed = brake.k3, brake.k4, brake.sliding_speed
    return _componentwise(brake, [
        ("shoe 1 x", k3 * c1 * s1, k3 * c1 * c1, "x", speed * c1),
        ("shoe 2 x", -k4 * c2 * s2, -k4 * c2 * c2, "x", speed * c2),
        ("shoe 1 y", -k3 * s1 * s1, -k3 * s1 * c1, "y", speed * s1),
        ("shoe 2 y", k4 * s2 * s2, k4 * s2 * c2, "y", speed * s2),
    ])  # fmt: skip


def _consistent(brake: "DrumBrake") -> tuple[Contact, ...]:
    s1, c1, s2, c2 = brake.directions
    rows = (("shoe 1", brake.k3, s1, c1, brake.load1), ("shoe 2", brake.k4, s2, c2, brake.load2))
    return tuple(
        Contact(
            n=vector(k * s, k * c),
            d=vector(c, -s),
            t=vector(c, -s),
            N0=load,
            V=brake.sliding_speed,
            law=brake.friction,
            name=name,
            normal=vector(s, c),
        )
        for name, k, s, c, load in rows
    )


def _reconstructed_simple(brake: "DrumBrake") -> tuple[Contact, ...]:
    """`eq3_signed` with +, - along y; the loads press along the springs.

    x: -N1 s1 - N2 s2 + mu k3 c1^2 y sgn(V c1 - x') - mu k4 c2^2 y sgn(V c2 - x')
    y: -N1 c1 - N2 c2 + mu k3 s1^2 x sgn(V s1 - y') - mu k4 s2^2 x sgn(V s2 - y')
    """
    _, c1, _, c2 = brake.directions
    return _componentwise(brake, _eq3_rows(brake, brake.sliding_speed * c1, brake.sliding_speed * c2, along_y=1.0))


def _reconstructed(brake: "DrumBrake") -> tuple[Contact, ...]:
    """The same with the loads in the friction as well, as the damping of Eq. (3) with -, + for its +- asks for.

    x: -N1 s1 + N2 s2 + mu (k3 y + N1) c1^2 sgn(V c1 - x') - mu (k4 y - N2) c2^2 sgn(V c2 - x')
    y: -N1 c1 + N2 c2 + mu (k3 x - N1) s1^2 sgn(V s1 - y') - mu (k4 x - N2) s2^2 sgn(V s2 - y')

    Its preloads add -alpha N (c1^2 + c2^2) and alpha N (s1^2 - s2^2) to c1 and c2.
    """
    s1, c1, s2, c2 = brake.directions
    rows = _eq3_rows(brake, brake.sliding_speed * c1, brake.sliding_speed * c2, along_y=1.0)
    first, second = brake.load1, brake.load2
    return _componentwise(brake, rows, (first * c1**2, second * c2**2, first * -(s1**2), second * s2**2))


READINGS: dict[str, Reading] = {
    "eq1_printed": Reading(_eq1_printed),
    "eq3": Reading(_eq3),
    "eq3_signed": Reading(_eq3_signed),
    "componentwise": Reading(_whole_compression),
    "consistent": Reading(_consistent),
    "reconstructed": Reading(_reconstructed, (-1.0, -1.0, 1.0, 1.0), -0.0653, 1.48, inferred=True),
    "reconstructed_simple": Reading(_reconstructed_simple, (-1.0, -1.0, -1.0, -1.0), -0.10, 1.0, inferred=True),
}

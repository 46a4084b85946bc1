"""Drum brake with shoes as bodies: two rigid curved shoes of three degrees of freedom inside an elastically held drum.

The drum's centre moves by w = (x, y). Shoe i moves by u and turns by phi about the drum's centre, so its lining at the
angle a moves by u + R phi e_t, with e_r = (cos a, sin a) and e_t = (-sin a, cos a). The lining is cut into P points,
each with the stiffness k = lining/P. With n = (-e_r | e_r, 0) over (drum | shoe) and t = (-e_t | e_t, R),

    N = N0 + k n.q,     v = V - t.q',     K += k n n',     friction mu sgn(v) N acts along t

The shoe (mass m, centre of mass at radius b in its middle, inertia J about the drum's centre) leans on an elastic
abutment below the centre and is pushed outwards by the actuator above it; the drum turns anticlockwise, so shoe 2
leads and shoe 1 trails. `pressure` says where the normal forces at q = 0 come from:

- spring: the springs share the actuator's force F as the stiffnesses will have it, N0 = k n.K^-1 F, and q is measured
  from that loaded state
- wear: the lining has worn in while sliding, N = p sin(angle from the abutment), sized so that its moment and that of
  its friction mu(V) balance the actuator's about the abutment; q is measured from that steady sliding. A leading shoe
  that would hold itself has no such state.

A worn lining keeps its shape while q moves, so the two differ where friction depends on speed, through N mu'(V) d t'.
A point opens instead of pulling.
"""

from typing import Any, ClassVar

import numpy as np

from squealbox.design import Design
from squealbox.designs.rows import block, column, diagonal, outer
from squealbox.friction import Coulomb
from squealbox.law import FrictionLaw
from squealbox.parameters import ParameterError, choice, parameter
from squealbox.schedules import value_at
from squealbox.shapes import RIGHT, UP, Moves, Shapes
from squealbox.system import Contact, System

OWN = "chosen here, of the size of a car's brake"
MOST_POINTS = 32
SHOES = (0.0, np.pi)  # the middle of each shoe; shoe 2 is the mirror image of shoe 1


class DrumBrakeShoes(Design):
    """Two rigid curved shoes with distributed linings inside a drum: eight degrees of freedom.

    >>> DrumBrakeShoes(points=4).system().size
    8
    """

    title: ClassVar[str] = "Drum brake with shoes as bodies, eight degrees of freedom"
    source: ClassVar[str] = "derived here; the pressure of a worn-in long shoe is that of textbooks on machine design"

    drum_mass: float = parameter("kg", 0.0, low_open=True, default=5.0, meaning="mass of the drum", source=OWN)
    drum_stiffness: float = parameter(
        "N/m", 0.0, low_open=True, default=5e7, meaning="stiffness of its centre", source=OWN
    )
    mass: float = parameter("kg", 0.0, low_open=True, default=0.8, meaning="mass of a shoe", source=OWN)
    inertia: float = parameter(
        "kg m^2", 0.0, low_open=True, default=0.01, meaning="inertia of a shoe about the drum's centre", source=OWN
    )
    centre: float = parameter("m", 0.0, default=0.09, meaning="radius of a shoe's centre of mass", source=OWN)
    radius: float = parameter("m", 0.0, low_open=True, default=0.11, meaning="inner radius of the drum", source=OWN)
    arc: float = parameter(
        "rad", 0.0, np.pi, low_open=True, default=np.deg2rad(110.0), meaning="angle of a lining", source=OWN
    )
    lining: float = parameter("N/m", 0.0, low_open=True, default=2e8, meaning="stiffness of a lining", source=OWN)
    arm: float = parameter("m", 0.0, low_open=True, default=0.08, meaning="abutment from the centre", source=OWN)
    abutment: float = parameter("N/m", 0.0, low_open=True, default=3e7, meaning="stiffness of an abutment", source=OWN)
    damping: float = parameter("s", 0.0, default=1e-6, meaning="damping per stiffness, C = damping K", source=OWN)
    load: float = parameter("N", 0.0, default=1500.0, meaning="force of the actuator on each shoe", source=OWN)
    sliding_speed: Any = parameter("m/s", default=1.0, schedule=True, meaning="speed of the drum's surface", source=OWN)
    points: int = parameter("-", 1.0, MOST_POINTS, default=3, meaning="contact points of a lining", source=OWN)
    friction: FrictionLaw = Coulomb(0.35)
    pressure: str = choice("wear", "spring", default="spring", meaning="pressure of the lining before friction acts")

    def __post_init__(self) -> None:
        super().__post_init__()
        if np.ndim(self.points) or self.points != int(self.points):
            raise ParameterError("DrumBrakeShoes", "points", self.points, f"a whole number in [1, {MOST_POINTS}]")
        object.__setattr__(self, "points", int(self.points))
        if np.any(np.asarray(self.inertia) <= np.asarray(self.mass) * np.asarray(self.centre) ** 2):
            raise ParameterError("DrumBrakeShoes", "inertia", self.inertia, "more than mass times centre^2")

    def system(self) -> System:
        """The equation of motion; leading axes of the parameters are kept."""
        shape = np.broadcast_shapes(*(np.shape(value) for _, about, value in self.leaves() if not about.schedule))
        mass = np.zeros((*shape, 8, 8))
        mass[..., :2, :2] = diagonal(self.drum_mass, self.drum_mass)
        stiffness = np.zeros((*shape, 8, 8))
        stiffness[..., :2, :2] = diagonal(self.drum_stiffness, self.drum_stiffness)
        load = np.zeros((*shape, 8))
        each = column(self.lining) / self.points
        for shoe in (0, 1):
            place = slice(2 + 3 * shoe, 5 + 3 * shoe)
            mass[..., place, place] = self._shoe_mass(shoe)
            for row in self.point_rows(self.abutment_point(shoe), place):
                stiffness += block(self.abutment) * outer(row, row)
            load += column(self.load) * self.actuator_row(shoe)
            for _, normal, _ in self.lining_rows(shoe):
                stiffness += each[..., None] * outer(normal, normal)
        loaded = np.linalg.solve(stiffness, load[..., None])[..., 0]
        contacts: list[Contact] = []
        friction = self._friction_factor()
        load = np.zeros((*np.broadcast_shapes(shape, np.shape(friction)), 8))
        for shoe in (0, 1):
            worn = self._worn_preloads(shoe)
            for i, (name, normal, along) in enumerate(self.lining_rows(shoe)):
                pressed = np.sum(each * normal * loaded, axis=-1)
                if self.pressure == "wear":
                    load = load - column(friction * worn[i]) * along
                preload = worn[i] if self.pressure == "wear" else pressed
                rows = (each * normal, along, along)
                contacts.append(Contact(*rows, preload, self.sliding_speed, self.friction, name, True, normal))
        names = ("drum_x", "drum_y", "shoe1_x", "shoe1_y", "shoe1_turn", "shoe2_x", "shoe2_y", "shoe2_turn")
        return System(mass, block(self.damping) * stiffness, stiffness, load, tuple(contacts), names)

    def draw(self, shapes: Shapes) -> None:
        """The drum with both shoes to scale of its radius, contact points, abutments and actuator."""
        drum: Moves = {0: RIGHT, 1: UP}
        shapes.circle((0.0, 0.0), 1.12, moves=drum)
        shapes.circle((0.0, 0.0), 1.0, "hollow", drum)
        half, top = 0.5 * self.arc, self.arm / self.radius
        for shoe, side in ((0, 1.0), (1, -1.0)):
            middle = SHOES[shoe]
            own: Moves = {2 + 3 * shoe: RIGHT, 3 + 3 * shoe: UP, 4 + 3 * shoe: float(self.radius)}
            shapes.ring(0.9, 0.14, middle - half, middle + half, "shoe", own)
            shapes.ring(1.0, 0.1, middle - half, middle + half, "lining", own)
            for angle in self.lining_angles(shoe):
                out = np.array([np.cos(angle), np.sin(angle)])
                shapes.line(0.88 * out, out, role="contact", width=1.2, moves=(own,))
                shapes.contact(0.95 * out, -out, own)
            foot = self.abutment_point(shoe) / self.radius
            low, high = ((0.83 * np.cos(a), 0.83 * np.sin(a)) for a in (middle - side * half, middle + side * half))
            shapes.line(low, foot, role="part", width=2.0, moves=(own,))
            shapes.circle(foot, 0.03, "pivot", own)
            shapes.line(high, (side * 0.42, top), role="part", width=2.0, moves=(own,))
            shapes.load((side * 0.05, top), (side * 0.42, top), "F", "load", (side * 0.2, top + 0.1), own)
            shapes.text((side * 0.55, -0.3), f"shoe {shoe + 1}", size=7.0, moves=own)
        shapes.text((0.0, -top - 0.13), "abutments", "abutment", size=7.0)
        shapes.turning(1.22, np.deg2rad(60.0), np.deg2rad(120.0), "V", "sliding_speed")
        shapes.text(
            (0.0, 0.02), f"R = {1e3 * self.radius:.0f} mm\n{2 * self.points} contact points", "radius points", size=7.0
        )

    def lining_angles(self, shoe: int) -> Any:
        """Angles of the points of a lining, in the middle of equal pieces, shape (points, ...)."""
        fraction = (np.arange(self.points) + 0.5) / self.points - 0.5
        return np.array([SHOES[shoe] + f * np.asarray(self.arc) for f in fraction])

    def abutment_point(self, shoe: int) -> Any:
        """Where a shoe leans: both abutments are below the centre, shape (..., 2) [m]."""
        side = 1.0 if shoe == 0 else -1.0
        return np.stack(np.broadcast_arrays(side * 0.35 * np.asarray(self.arm), -np.asarray(self.arm)), axis=-1)

    def actuator_row(self, shoe: int) -> Any:
        """Generalised force per newton of the actuator, which pushes the shoe outwards from above the centre."""
        side = 1.0 if shoe == 0 else -1.0
        row = np.zeros((*np.shape(self.arm), 8))
        row[..., 2 + 3 * shoe] = side
        row[..., 4 + 3 * shoe] = -side * np.asarray(self.arm)  # moment x Fy - y Fx about the centre, at y = arm
        return row

    def point_rows(self, point: np.ndarray, place: slice) -> tuple[Any, Any]:
        """Rows r with r.q the displacement along x and y of a point of the shoe at `place`."""
        rows = []
        for axis in (0, 1):
            row = np.zeros((*np.shape(point)[:-1], 8))
            row[..., place.start + axis] = 1.0
            row[..., place.start + 2] = -point[..., 1] if axis == 0 else point[..., 0]
            rows.append(row)
        return rows[0], rows[1]

    def lining_rows(self, shoe: int) -> list[tuple[str, Any, Any]]:
        """Name, unit normal and t of each contact point of a shoe."""
        rows, start = [], 2 + 3 * shoe
        for i, angle in enumerate(self.lining_angles(shoe)):
            cosine, sine = np.cos(angle), np.sin(angle)
            shape = np.broadcast_shapes(np.shape(angle), np.shape(self.radius))
            normal, along = np.zeros((*shape, 8)), np.zeros((*shape, 8))
            for place, sign in ((0, -1.0), (start, 1.0)):
                normal[..., place], normal[..., place + 1] = sign * cosine, sign * sine
                along[..., place], along[..., place + 1] = -sign * sine, sign * cosine
            along[..., start + 2] = self.radius
            rows.append((f"shoe {shoe + 1} point {i + 1}", normal, along))
        return rows

    def _friction_factor(self) -> Any:
        """Mu(V) sgn(V) of steady sliding."""
        speed = value_at(self.sliding_speed, 0.0)
        return np.asarray(self.friction.mu(speed)) * np.sign(speed)

    def _worn_preloads(self, shoe: int) -> list[Any]:
        if self.pressure == "spring":
            return []
        angles, point = self.lining_angles(shoe), self.abutment_point(shoe)
        friction, side = self._friction_factor(), 1.0 if shoe == 0 else -1.0
        # moments about the abutment P, anticlockwise: P x e_r of a normal force -N e_r, R - P.e_r of friction along e_t
        normal = [point[..., 0] * np.sin(a) - point[..., 1] * np.cos(a) for a in angles]
        along = [self.radius - point[..., 0] * np.cos(a) - point[..., 1] * np.sin(a) for a in angles]
        share = [np.abs(arm) for arm in normal]  # |P| |sin(a - angle of P)|
        total = sum(s * (n + friction * t) for s, n, t in zip(share, normal, along, strict=True))
        if np.any(side * total <= 0.0):
            shown = float(np.max(np.abs(friction)))
            raise ParameterError("DrumBrakeShoes", "friction", shown, "less: with pressure = wear a shoe holds itself")
        return [2.0 * np.asarray(self.arm) * self.load * side * s / total for s in share]

    def _shoe_mass(self, shoe: int) -> Any:
        off = np.asarray(self.mass) * np.asarray(self.centre) * np.cos(SHOES[shoe])  # the centre of mass lies on x
        shape = np.broadcast_shapes(np.shape(off), np.shape(self.inertia))
        mass = np.zeros((*shape, 3, 3))
        mass[..., 0, 0] = mass[..., 1, 1] = self.mass
        mass[..., 2, 2] = self.inertia
        mass[..., 1, 2] = mass[..., 2, 1] = off
        return mass

"""The surface of a finite-element brake, for those who draw it: places, faces, and which freedoms move each node.

A brake that meshes itself has quadrilaterals between the corners of its elements. Exported matrices name no elements:
of them the nodes are known, and each stands for itself.
"""

from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from squealbox.fe.assembled import AssembledBrake
from squealbox.fe.disc_brake import DiscBrake
from squealbox.fe.grids import MeshedBody
from squealbox.fe.meshed import MeshedBrake
from squealbox.fe.reduced_brake import ReducedBrake

MOST_FACES = 5000


@dataclass(frozen=True, eq=False)
class Surface:
    """Of k nodes their places (k, 3) [m], and faces (f, 4), nodes in a turn; a lone node stands there four times.

    parts (f,) numbers the component of each face in `names`. rows (k, 3) is the freedom along x, y and z, -1 where it
    is held; of a reduced brake moves (k, 3, m) is what each of its m coordinates does to the nodes instead. touching
    (contacts, 3) [m] is where the contacts are, empty where that is not known. Every `step`-th line of the mesh, or
    node, is there.
    """

    places: Any
    faces: Any
    parts: Any
    names: tuple[str, ...]
    rows: Any
    touching: Any
    step: int
    moves: Any = None

    left_out_of_files: ClassVar[bool] = True

    @property
    def lone(self) -> bool:
        """True where it has no faces, only nodes."""
        return bool(np.all(self.faces[:, :1] == self.faces))

    @property
    def size(self) -> float:
        """Half the diagonal of the box it stands in [m]."""
        return 0.5 * float(np.linalg.norm(np.ptp(self.places, axis=0)))

    @property
    def middle(self) -> Any:
        """Middle of that box, (3,) [m]."""
        return 0.5 * (self.places.min(axis=0) + self.places.max(axis=0))

    def moved(self, shape: ArrayLike) -> Any:
        """Displacement (k, 3) of the nodes in a shape, turned and scaled so that its largest component is 1.

        The shape is one of all freedoms (n,), of a reduced brake one of its coordinates (m,).
        """
        if self.moves is None:
            moved = np.where(self.rows >= 0, np.asarray(shape)[self.rows], 0.0)
        else:
            moved = np.asarray(self.moves, dtype=float) @ shape
        return moved / moved.flat[np.argmax(np.abs(moved))]

    def shares(self, moved: np.ndarray) -> Any:
        """Of the motion of each face, the share (f,) of that of the node that moves most."""
        size = np.linalg.norm(np.abs(moved), axis=1)
        return np.mean(size[self.faces], axis=1) / np.max(size)

    def next_to_contacts(self) -> Any:
        """The node nearest to each contact (contacts,)."""
        nearest = [int(np.argmin(np.sum((self.places - at) ** 2, axis=1))) for at in self.touching]
        return np.array(nearest, dtype=int)


def surface_of(brake: Any, most: int = MOST_FACES) -> Surface | None:
    """The surface of a finite-element brake with at most `most` faces, coarser where it has more; None of others.

    Where nodes of exported matrices have a coordinate system of their own their motion is shown along its axes.
    """
    if isinstance(brake, MeshedBrake):
        step = 1
        while len((found := _meshed(brake, step)).faces) > most:
            step += 1
        return found
    return _cloud(brake, most) if isinstance(brake, AssembledBrake) else None


def with_surface(small: ReducedBrake, most: int = MOST_FACES) -> ReducedBrake:
    """The reduced brake with its surface and without the full one, so that it goes to where it is drawn."""
    full = small.full
    found = None if full is None else surface_of(full.design, most)
    if found is None:
        return small.replace({"full": None})
    moves = np.where((found.rows >= 0)[..., None], full.basis[found.rows], 0.0).astype(np.float32)
    return small.replace({"full": None, "surface": replace(found, moves=moves)})


def _meshed(brake: MeshedBrake, step: int) -> Surface:
    made = brake.structure()
    number = np.full(sum(body.size for body in made.bodies), -1)
    number[made.kept] = np.arange(made.size)
    places, faces, parts, rows, first, start = [], [], [], [], 0, 0
    for part, body in enumerate(made.bodies):
        quads = _outside(body, step)
        used, local = np.unique(quads, return_inverse=True)
        places.append(body.corner_places[:, used].T)
        faces.append(local.reshape(-1, 4) + first)
        parts.append(np.full(len(quads), part))
        rows.append(number[start + body.freedoms[body.corners[0][:, used]].T])
        first, start = first + len(used), start + body.size
    touching = made.place[:, brake.touching(made)].T
    names = ("disc", "pad 1", "pad 2") if isinstance(brake, DiscBrake) else ("drum", "shoe 1", "shoe 2")
    whole, quads, kinds, freedoms = (np.concatenate(each) for each in (places, faces, parts, rows))
    return Surface(whole, quads, kinds, names, freedoms, touching, step)


def _outside(body: MeshedBody, step: int) -> Any:
    """Quadrilaterals (f, 4) of corners of the open grid on the outside of a body, over every `step`-th line."""
    at = [np.rint(np.interp(x, b, np.arange(len(b)))).astype(int) for b, x in
          zip(body.breaks, body.grid_points, strict=True)]  # fmt: skip
    corner = np.zeros([len(b) for b in body.breaks], dtype=int)
    corner[tuple(at)] = np.arange(len(at[0]))
    lines = [np.unique(np.r_[0 : len(b) : step, len(b) - 1]) for b in body.breaks]
    corner = corner[np.ix_(*lines)]
    found = []
    for axis in range(3):
        if axis == 1 and body.closed:
            continue  # the ends of a ring are inside
        for end in (0, -1):
            side = np.take(corner, end, axis=axis)
            quads = np.stack([side[:-1, :-1], side[1:, :-1], side[1:, 1:], side[:-1, 1:]], axis=-1).reshape(-1, 4)
            found.append(quads if (end == 0) == (axis == 1) else quads[:, ::-1])
    return np.concatenate(found)


def _cloud(brake: AssembledBrake, most: int) -> Surface | None:
    structure = brake.exported()
    if structure.nodes is None or structure.labels is None:
        return None
    nodes = structure.nodes
    place = {int(node): i for i, node in enumerate(nodes.numbers)}
    rows = np.full((len(place), 3), -1)
    for row, (node, direction) in enumerate(structure.labels):
        if int(node) in place and 1 <= direction <= 3:
            rows[place[int(node)], direction - 1] = row
    step = -(-len(place) // most)
    some = np.arange(0, len(place), step)
    names = tuple(sorted(set(nodes.components))) or ("nodes",)
    parts = np.array([names.index(nodes.components[i]) for i in some]) if nodes.components else np.zeros(len(some), int)
    faces = np.repeat(np.arange(len(some))[:, None], 4, axis=1)
    return Surface(nodes.places[some], faces, parts, names, rows[some], np.zeros((0, 3)), step)

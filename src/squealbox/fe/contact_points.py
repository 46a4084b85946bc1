"""Rows at the quadrature points of faces that touch another body, gathered face by face for a `MeshedStructure`."""

from typing import Any

import numpy as np
from scipy import sparse

from squealbox.fe.grids import FacePoints, MeshedBody
from squealbox.fe.meshed import FreedomsOfBodies

ROWS = ("normal", "along", "across")


class ContactPoints:
    """The contact points of a brake's linings, which touch body number `other` of the frame."""

    def __init__(self, frame: FreedomsOfBodies, other: int, touched: MeshedBody) -> None:
        self.frame, self.other, self.touched = frame, other, touched
        self._found: dict[str, list[Any]] = {key: [] for key in (*ROWS, "area", "place", "angle", "side")}

    def add(
        self, face: FacePoints, body: int, directions: tuple[Any, Any, Any], below: np.ndarray, angle: np.ndarray
    ) -> None:
        """A lining's face with its directions into the other body, along and across sliding, each (3, k).

        below (3, k) [m] is the place on the other body under each point, angle (k,) [rad] from the lining's middle.
        """
        rows = self.touched.points(below)
        for key, direction in zip(ROWS, directions, strict=True):
            lower = sum(sparse.diags_array(direction[j]) @ rows[j] for j in range(3))
            self._found[key].append(self.frame.rows(face.along(direction), body) - self.frame.rows(lower, self.other))
        side = len(self._found["side"])
        about = {"area": face.area, "place": face.place, "angle": angle, "side": np.full(len(face.area), side)}
        for key, value in about.items():
            self._found[key].append(value)

    def fields(self, lining: str) -> dict[str, Any]:
        """What a `Structure` holds of its contact points; `lining` is the word for what touches."""
        place, side = np.concatenate(self._found["place"], axis=1), np.concatenate(self._found["side"])
        return {
            **{key: sparse.vstack(self._found[key], format="csr") for key in ROWS},
            "area": np.concatenate(self._found["area"]),
            "place": place,
            "radius": np.hypot(place[0], place[1]),
            "angle": np.concatenate(self._found["angle"]),
            "side": side,
            "names": tuple(f"{lining} {s + 1} point {i + 1}" for i, s in enumerate(side)),
        }

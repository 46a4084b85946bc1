"""The same brake on a second mesh: which modes are found again, and how far their growth rates lie apart.

Frequencies converge with the mesh, growth rates hardly do, so one mesh alone says nothing of its own doubt. Modes of
the two meshes are the same by the MAC of their shapes at common places, the corners of the elements of the coarser one,
and paired so that the sum of all is largest (Kuhn 1955, Naval Research Logistics Quarterly 2, 83-97). Of modes that two
shapes share, a doublet of a disc, neither may be found again.
"""

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from squealbox.arguments import public
from squealbox.fe import MeshedBrake
from squealbox.parameters import ParameterError
from squealbox.result import Array, Outcome, Result, quantity
from squealbox.stability.eigenvalues import complex_modes
from squealbox.stability.mode import modal_assurance
from squealbox.system import InvalidSystem

COARSER = 1.5  # times the element size, where none is given
WIDER = 0.05  # share of the band in which modes of the other mesh are looked for beyond it
ALIKE = 0.5  # MAC from which two modes are one
ONE_MESH = (
    "Doubt: one mesh was looked at. Frequencies settle with the mesh, growth rates hardly do: export a finer one and "
    "compare before believing a growth rate."
)


@dataclass(frozen=True, kw_only=True, eq=False)
class MeshDoubt(Result):
    """Modes of a brake beside those of the same brake on another mesh, as :func:`mesh_doubt` returns them.

    Outcome "completed", "no_second_mesh" where the brake has no mesh, or no modes, of that element size, or "same_mesh"
    where both sizes make one mesh, as very coarse ones do: then nothing is told of it.
    """

    frequency: Array = quantity("mode", "Hz", "frequency of each mode")
    growth_rate: Array = quantity("mode", "1/s", "growth rate of each mode")
    other_frequency: Array = quantity("mode", "Hz", "frequency on the other mesh, NaN where it is not found again")
    other_growth_rate: Array = quantity("mode", "1/s", "growth rate on the other mesh")
    likeness: Array = quantity("mode", "1", "MAC of the two shapes at common places")
    element_size: Any = quantity("", "m", "element size")
    other_size: Any = quantity("", "m", "element size of the other mesh")
    freedoms: tuple[int, int] = (0, 0)

    table_over: ClassVar = ("mode",)

    @property
    def sentence(self) -> str:
        """What a reader of growth rates must know, about the modes that grow on either mesh."""
        if not self.outcome.ok:
            return f"{ONE_MESH} {self.outcome.message}."
        growing = (self.growth_rate > 0.0) | (self.other_growth_rate > 0.0)
        lost = int(np.sum(np.isnan(self.other_frequency[growing])))
        found = growing & np.isfinite(self.other_frequency)
        sizes = f"elements of {1e3 * float(self.other_size):g} mm instead of {1e3 * float(self.element_size):g} mm"
        if not np.any(growing):
            return f"Mesh: with {sizes} no mode grows either."
        told = []
        if np.any(found):
            off = np.max(np.abs(self.other_frequency[found] / self.frequency[found] - 1.0))
            apart = np.max(np.abs(self.other_growth_rate[found] - self.growth_rate[found]))
            told.append(
                f"the growing modes move by up to {100.0 * off:.2g} % and their growth rates by up to {apart:.3g} 1/s"
            )
        if lost:
            told.append(
                f"{lost} of {int(np.sum(growing))} growing modes {'is' if lost == 1 else 'are'} not found again"
            )
        return f"Mesh: with {sizes} {'; '.join(told)}."

    def summary(self) -> str:
        """The sentence, and a table of the modes that grow on either mesh."""
        rows = [f"{'mode':>4} {'frequency [Hz]':>15} {'there':>10} {'growth rate [1/s]':>18} {'there':>12} {'MAC':>6}"]
        for i in np.flatnonzero((self.growth_rate > 0.0) | (self.other_growth_rate > 0.0)):
            rows.append(
                f"{i + 1:>4} {self.frequency[i]:>15.6g} {self.other_frequency[i]:>10.6g} {self.growth_rate[i]:>+18.6g} "
                f"{self.other_growth_rate[i]:>+12.6g} {self.likeness[i]:>6.2f}"
            )
        return "\n".join([self.sentence, *(rows if len(rows) > 1 else [])])


@public(parameters=None)
def mesh_doubt(brake: MeshedBrake, modes: Any, element_size: float | None = None) -> MeshDoubt:
    """The modes of a brake that meshes itself beside those on a second mesh.

    Parameters
    ----------
    brake : a design with `element_size`, such as `DiscBrake` or `MeshedDrumBrake`
    modes : its modes, ``complex_modes(brake, band=(f1, f2))``
    element_size : of the second mesh [m]; None takes 1.5 times the brake's, which costs a fraction of the first

    Raises `ParameterError` for a brake whose mesh is not its own, or modes of another one.
    """
    if not isinstance(brake, MeshedBrake) or not hasattr(brake, "element_size"):
        raise ParameterError(
            "mesh_doubt", "brake", type(brake).__name__, "a brake that meshes itself, with element_size"
        )
    size = COARSER * float(brake.value_of("element_size")) if element_size is None else float(element_size)
    other = brake.replace({"element_size": size})
    low, high = modes.band
    half = len(modes.eigenvalues) // 2
    own: dict[str, Any] = {
        "frequency": modes.eigenvalues[:half].imag / (2.0 * np.pi), "growth_rate": modes.eigenvalues[:half].real,
        "element_size": float(brake.value_of("element_size")), "other_size": size, "inputs": {"system": brake},
    }  # fmt: skip
    try:
        there = complex_modes(other, band=((1.0 - WIDER) * low, (1.0 + WIDER) * high))
        why = "" if there.outcome.ok else str(there.outcome.message)
    except (ParameterError, InvalidSystem) as error:  # too coarse for a part of the brake
        why = str(error)
    if why:
        message = f"with elements of {1e3 * size:g} mm there are no modes to compare with: {why}"
        none = np.full(half, np.nan)
        return MeshDoubt(**own, other_frequency=none, other_growth_rate=none, likeness=0.0 * none,
                         freedoms=(len(modes.right), 0), outcome=Outcome("no_second_mesh", message))  # fmt: skip
    others = len(there.eigenvalues) // 2
    coarser = brake if float(own["element_size"]) > size else other
    places = [body.corner_places for body in coarser.structure().bodies]
    here = _moved(brake, modes.right[:, :half], places)
    likeness = modal_assurance(here, _moved(other, there.right[:, :others], places))
    partner = _paired(likeness)
    alike = np.array([likeness[i, j] if j >= 0 else 0.0 for i, j in enumerate(partner)])
    again = alike >= ALIKE
    values = np.where(again, there.eigenvalues[:others][partner] if others else np.nan, np.nan + 0j)
    grids = [[body.breaks for body in each.structure().bodies] for each in (brake, other)]
    same = all(np.array_equal(a, b) for one, two in zip(*grids, strict=True) for a, b in zip(one, two, strict=True))
    message = f"elements of {1e3 * size:g} mm make the same mesh as those of {1e3 * own['element_size']:g} mm"
    return MeshDoubt(
        **own,
        outcome=Outcome("same_mesh", message) if same else Outcome(),
        other_frequency=np.where(again, values.imag / (2.0 * np.pi), np.nan),
        other_growth_rate=np.where(again, values.real, np.nan),
        likeness=alike,
        freedoms=(len(modes.right), len(there.right)),
    )


def _moved(brake: MeshedBrake, shapes: np.ndarray, places: list[Any]) -> Any:
    """Displacements at the places, one after another, of shapes (n, modes)."""
    made = brake.structure()
    parts = zip(made.bodies, made.by_body(shapes), places, strict=True)
    return np.concatenate([row @ values for body, values, place in parts for row in body.points(place)])


def _paired(likeness: np.ndarray) -> Any:
    """The partner of each mode, -1 where there is none."""
    from scipy.optimize import linear_sum_assignment

    partner = np.full(len(likeness), -1)
    first, second = linear_sum_assignment(-likeness)
    partner[first] = second
    return partner

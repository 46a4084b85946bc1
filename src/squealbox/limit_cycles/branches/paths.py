"""What a branch follows: cycles as roots over a parameter, by whichever method, and what is told of each."""

from collections.abc import Callable, Sequence
from typing import Any, Protocol, Self

import numpy as np

from squealbox.continuation import Path
from squealbox.limit_cycles.cycles.cycle import Cycle
from squealbox.system import System


class CyclePath(Path, Protocol):
    """A path of cycles. `has_corners`: where its residual is continuous but has another derivative beyond.

    What it tells of the cycle at (x, p): `multipliers`, `least_slip` [m/s], the longest `sticking` [s], all of these
    with period and extremes by `describe`, and the `cycle` itself.
    """

    make: Callable[[Any], System]
    has_corners: bool

    def multipliers(self, x: np.ndarray, p: float) -> Any:
        """Floquet multipliers, the trivial one first."""

    def least_slip(self, x: np.ndarray, p: float) -> float:
        """Least sliding speed in the sense of V [m/s]."""

    def sticking(self, x: np.ndarray, p: float) -> float:
        """Longest sticking of a contact [s]."""

    def describe(self, x: np.ndarray, p: float) -> dict[str, Any]:
        """All that a branch keeps of a point."""

    def cycle(self, x: np.ndarray, p: float) -> Cycle:
        """The cycle at a point."""

    def confirmed(self, values: Sequence[float]) -> bool:
        """Whether what was followed are the systems at these values; where not, another walk follows those."""

    def again(self, make: Callable[[float], System] | None = None) -> Self:
        """The path over the parameter of a family beside this one, or to begin elsewhere on the same cycles."""

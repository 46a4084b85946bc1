"""The limit state of squeal in the space of independent standard normal numbers, and OpenTURNS at work on it."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from squealbox.extras import extra
from squealbox.family import DesignOrRecipe
from squealbox.scatter import Scatter
from squealbox.studies.quantity import Quantity, evaluate

FAR = 1e30  # stands for an infinite distance, which differences cannot be taken of


class LimitState:
    """g(z) = -excess(quantity at x(z)): negative squeals; counts its evaluations and those without an answer."""

    def __init__(self, design: DesignOrRecipe | None, scatter: Scatter, quantity: Quantity) -> None:
        self.design, self.scatter, self.quantity = design, scatter, quantity
        self.evaluations = 0
        self.unknown = 0
        self.ties = 0  # points exactly at the limit
        self.failure: BaseException | None = None  # what the quantity raised within OpenTURNS, which hides it
        self.broken = ""  # what OpenTURNS itself complained of

    @property
    def dimension(self) -> int:
        """Number of parameters that scatter."""
        return len(self.scatter.names)

    def values(self, z: ArrayLike) -> Any:
        """The quantity at points `z`, shape (n, d): shape (n,)."""
        z = np.atleast_2d(np.asarray(z, dtype=float))
        found = evaluate(self.design, self.quantity, self.scatter.from_normal(z), strict=False)
        self.evaluations += len(z)
        self.unknown += int(np.count_nonzero(np.isnan(found)))
        return found

    def __call__(self, z: np.ndarray) -> Any:
        """g at points `z`, shape (n,); a point without an answer counts as far from squeal."""
        g = -self.quantity.excess(self.values(z))
        self.ties += int(np.count_nonzero(g == 0.0))
        return np.clip(np.where(np.isnan(g), FAR, g), -FAR, FAR)

    def _kept(self, z: np.ndarray) -> Any:
        try:
            return self(z)
        except Exception as error:
            self.failure = error
            raise

    def event(self) -> Any:
        """The event g < 0 for OpenTURNS."""
        with extra("studies"):
            import openturns as ot

        function = ot.PythonFunction(
            self.dimension,
            1,
            func=lambda z: [float(self._kept(np.asarray(z))[0])],
            func_sample=lambda z: self._kept(np.asarray(z))[:, None],
        )
        vector = ot.CompositeRandomVector(function, ot.RandomVector(ot.Normal(self.dimension)))
        return ot.ThresholdEvent(vector, ot.Less(), 0.0)


@contextmanager
def seeded(seed: int) -> Iterator[None]:
    """OpenTURNS with this seed and silent; its global generator is as it was afterwards."""
    with extra("studies"):
        import openturns as ot

    state, said = ot.RandomGenerator.GetState(), ot.Log.Flags()
    ot.RandomGenerator.SetSeed(int(seed))
    ot.Log.Show(ot.Log.NONE)
    try:
        yield
    finally:
        ot.RandomGenerator.SetState(state)
        ot.Log.Show(said)

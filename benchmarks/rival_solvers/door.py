"""One door for all solvers: `prepare(drums, setting)` returns a call that runs them all and gives (drums, 2) ends."""

from collections.abc import Callable
from dataclasses import dataclass

import jax
import jax.numpy as jnp
import numpy as np

jax.config.update("jax_enable_x64", True)

SCALE = 1e-6  # displacements are of this size [m]; absolute tolerances are relative to it
MOST = 10**7


@dataclass(frozen=True)
class Rival:
    """One solver in one formulation; `takes` trajectories are given to it at once."""

    name: str
    prepare: Callable
    settings: tuple
    takes: int = 8

    @staticmethod
    def said(setting):
        """A setting in words."""
        return f"{setting[0]:.0e}" + (f", width {setting[1]:.0e}" if len(setting) == 2 else "")


def of_each(make):
    """`prepare` for a solver of one trajectory: make(drum, *setting) returns its call."""

    def prepare(drums, setting):
        calls = [make(drum, *setting) for drum in drums]
        return lambda: np.array([call() for call in calls])

    return prepare


def stacked(drums):
    """All numbers of many drums, one array for each name."""
    names = ("k", "c", "f", "p", "t", "n", "N0", "V", "g", "static", "slope")
    return {name: jnp.asarray(np.stack([getattr(x, name) for x in drums])) for name in names}

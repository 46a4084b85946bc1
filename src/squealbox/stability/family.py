"""A design with some parameters left free: values in, linearised matrices out, in one batched call."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np

from squealbox.family import DesignOrRecipe, Family
from squealbox.fe import ReducedBrake
from squealbox.parameters import ParameterError
from squealbox.system import DesignOrSystem, Equilibrium, InvalidSystem, Linearised, System, as_system, linearise


@dataclass(frozen=True)
class Steady(Linearised):
    """The linearised matrices with two of the structure without friction, all (..., n, n).

    structural is its damping C, with that of friction across the sliding direction; elastic the symmetric part of its
    K, without the contacts that are open.
    """

    structural: Any
    elastic: Any


def steady_sliding(design_or_system: DesignOrSystem, time: float = 0.0) -> Steady:
    """M, C_eff, K_eff and the structure's own C about steady sliding at `time` [s]."""
    quick = design_or_system.parts() if isinstance(design_or_system, ReducedBrake) else None
    if quick is not None:
        small, state, damping, elastic = quick
        return Steady(small.M, small.C, small.K, state, damping, elastic)
    system: System = as_system(design_or_system, linear=True)
    if system.is_sparse:
        as_system(system)  # says what to do instead
    about = linearise(system, time)
    if any(loop.sampling is not None for loop in system.loops):  # of what is held between samples no part is friction's
        unknown = np.full(about.K.shape, np.nan)
        return Steady(about.M, about.C, about.K, about.equilibrium, unknown, unknown)
    structural = np.zeros(about.C.shape)
    structural[..., : system.size, : system.size] = system.C
    for row in range(system.size, about.C.shape[-1]):
        structural[..., row, row] = about.C[..., row, row]
    if any(contact.across is not None for contact in system.contacts):
        structural = structural + np.sum([x[..., None, None] * a for x, a in across_dampers(system, about)], axis=0)
    return Steady(about.M, about.C, about.K, about.equilibrium, structural, _elastic(system, about))


def across_dampers(system: System, about: Linearised) -> list[tuple[Any, Any]]:
    """Of each contact mu N / |V| (...) [N s/m] and a a' (..., n, n); zeros where it has no cross direction."""
    found, state = [], about.equilibrium
    for i, contact in enumerate(system.contacts):
        normal, speed, mu = (a[..., i] for a in (state.normal_force, state.sliding_speed, state.friction))
        if contact.across is None:
            found.append((np.zeros(np.shape(normal)), np.zeros((system.size, system.size))))
            continue
        with np.errstate(divide="ignore", invalid="ignore"):  # V = 0: there is no steady sliding
            weight = np.where((normal > 0.0) | (not contact.unilateral), mu * normal / np.abs(speed), 0.0)
        found.append((weight, contact.across[..., :, None] * contact.across[..., None, :]))
    return found


def _elastic(system: System, about: Linearised) -> Any:
    """K_eff with the coupling mu sgn(V) d n' of each closed contact taken out, made symmetric."""
    state, stiffness = about.equilibrium, np.array(about.K)
    for i, contact in enumerate(system.contacts):
        normal, speed, mu = (a[..., i] for a in (state.normal_force, state.sliding_speed, state.friction))
        closed = (normal > 0.0) if contact.unilateral else True
        force = np.where(closed, mu * np.sign(speed), 0.0)[..., None] * contact.d
        n = system.size
        stiffness[..., :n, :n] += force[..., None] * np.asarray(contact.n)[..., None, :]
    return 0.5 * (stiffness + np.swapaxes(stiffness, -1, -2))


class SteadyFamily(Family):
    """A family linearised about steady sliding; `time` [s] is the instant of schedules."""

    def __init__(
        self, design: DesignOrRecipe, parameters: Iterable[str], spans: Iterable[Any] = (), time: float = 0.0
    ) -> None:  # fmt: skip
        super().__init__(design, parameters, spans)
        self.time = time

    @property
    def band(self) -> tuple[float, float] | None:
        """The band [Hz] of a reduced brake: above it, it has modes that are none of the full one. None of any other."""
        return self.design.band if isinstance(self.design, ReducedBrake) else None

    @property
    def inputs(self) -> dict[str, Any]:
        """What a result keeps of the family; a callable cannot be written to a file and is left out."""
        return {"system": None if self.recipe else self.design, "parameters": list(self.parameters), "time": self.time}

    def at(self, *values: Any) -> Steady:
        """The matrices at arrays of values, one array for each parameter, broadcast to a common shape."""
        arrays = np.broadcast_arrays(*(np.asarray(value, dtype=float) for value in values))
        shape = arrays[0].shape
        if self.recipe is None and self.band is None:
            try:
                steady = steady_sliding(self.one(*arrays), self.time)
            except (InvalidSystem, ParameterError):
                if as_system(self.design, linear=True).is_sparse:
                    as_system(self.design)  # of no large brake there is a batch: it says so
                raise
            if steady.K.shape[:-2] == shape:
                return steady
            return _joined([steady], lambda parts, rank: np.broadcast_to(parts[0], shape + _tail(parts[0], rank)))
        points = zip(*(array.ravel() for array in arrays), strict=True)
        parts = [steady_sliding(self.one(*(float(x) for x in point)), self.time) for point in points]
        return _joined(parts, lambda parts, rank: np.stack(parts).reshape(shape + _tail(parts[0], rank)))


def entry(steady: Steady, index: Any) -> Steady:
    """One system out of a batch, or several: `index` is a tuple or a mask over the leading axes."""
    return _joined([steady], lambda parts, rank: parts[0][index])


_STATE = {"q": 1, "normal_force": 1, "sliding_speed": 1, "friction": 1, "exists": 0, "floating": 0}
_MATRICES = {"M": 2, "C": 2, "K": 2, "structural": 2, "elastic": 2}


def _tail(array: bool | np.bool_ | np.ndarray, rank: int) -> tuple[int, ...]:
    return np.shape(array)[np.ndim(array) - rank :]


def _joined(parts: list[Steady], join: Callable[[list[Any], int], Any]) -> Steady:
    """Every array of the parts handed to `join` with the number of its own axes."""
    states = [part.equilibrium for part in parts]
    worst = next((state.outcome for state in states if not state.outcome.ok), states[0].outcome)
    state = {name: join([getattr(s, name) for s in states], rank) for name, rank in _STATE.items()}
    matrices = {name: join([getattr(part, name) for part in parts], rank) for name, rank in _MATRICES.items()}
    return Steady(**matrices, equilibrium=Equilibrium(**state, outcome=worst))

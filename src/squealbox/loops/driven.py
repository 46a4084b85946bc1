"""A brake whose sampled and late loops are driven from outside: its commands are what a hold or a delay hands on."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from squealbox.loops.kinds import Loop
from squealbox.loops.rows import driven, folded, force_per_state, size_and_rate, with_rows
from squealbox.parameters import ParameterError


@dataclass(frozen=True, eq=False)
class Driven:
    """A brake whose `loops` are driven by commands u: they load its rows by `columns` and sense by P and R, all (a, n).

    force (a, n) reads the force of an actuator that is among the rows; zeros where the command is the force, b (a, n).
    """

    system: Any
    loops: tuple[Loop, ...]
    columns: Any
    P: Any
    R: Any
    force: Any
    b: Any

    @property
    def limits(self) -> Any:
        """Limits (a,) [N] of the commands, inf without."""
        return np.array([np.inf if loop.limit is None else float(loop.limit) for loop in self.loops])

    def wanted(self, q: np.ndarray, qd: np.ndarray) -> Any:
        """Commands (..., a) at states (..., n), not cut."""
        return q @ self.P.T + qd @ self.R.T

    def commands(self, q: np.ndarray, qd: np.ndarray) -> Any:
        """Commands (..., a) at states (..., n), cut at their limits."""
        limits = self.limits
        return np.clip(self.wanted(q, qd), -limits, limits)

    def forces(self, q: np.ndarray, u: np.ndarray) -> Any:
        """Forces (..., a) [N] of the actuators."""
        ideal = ~np.any(self.force, axis=-1)
        return np.where(ideal, u, q @ self.force.T)


def driven_brake(system: Any) -> Driven:
    """The brake with its sampled and late loops driven from outside, the others as rows."""
    bare = folded(system)
    late = tuple(loop for loop in bare.loops if not loop.linear)
    for loop in bare.loops:
        rows = loop.rows(bare.names)
        if loop.linear and (rows.memory or np.any(rows.P)):
            given = f"{type(loop).__name__}(on={loop.on!r}) with a limit"
            expected = "beside sampled or late loops only velocity feedback with a limit, or a limit there too"
            raise ParameterError("simulate", "loops", given, expected)
    if system.shape != () or any(np.ndim(loop.rows(bare.names).P) > 1 for loop in bare.loops):
        raise ParameterError("simulate", "loops", "leading axes", "one brake: sampled and late loops run one by one")
    own = [loop.controller(bare.names) for loop in late]
    _, rate = size_and_rate(bare, ())
    rows = [
        replace(driven(row, loop.rate), size=force_per_state(loop.rows(bare.names), rate))
        for row, loop in zip(own, late, strict=True)
    ]
    whole, places = with_rows(bare.replace(loops=()), rows)
    n, size = bare.size, whole.size
    columns, P, R, force, b = (np.zeros((len(late), size)) for _ in range(5))
    for a, (row, loop, (m, unit, scale)) in enumerate(zip(own, late, places, strict=True)):
        z = slice(m.start, m.start + row.memory)
        b[a, :n] = row.b
        if loop.rate is None:
            columns[a, :n], columns[a, z] = row.b, scale[: row.memory] * row.G
        else:
            columns[a, m.stop - 1], force[a, m.stop - 1] = scale[-1] * float(loop.rate), unit[-1]
        P[a, :n], R[a, :n], P[a, z] = row.P, row.R, row.S * unit[: row.memory]
    return Driven(whole.replace(loops=tuple(x for x in bare.loops if x.linear)), late, columns, P, R, force, b)

"""What a search for cycles asks of a system with other states than q and q', answered by its motion alone.

Rows without mass have displacements of their own or none, a law with memory has its bristles, a loop with a limit its
states. All are rows of one widened system, so a state is the displacements and velocities of all rows. `independent`
are those that neither follow from others nor are without any effect, as the integral of a loop's command is.
"""

from typing import Any

import numpy as np

from squealbox.limit_cycles.cycles.cycle import ordered
from squealbox.limit_cycles.cycles.field import Autonomous, Field, check_autonomous
from squealbox.matrices import Equilibrium
from squealbox.stability import complex_modes
from squealbox.start import Start
from squealbox.system import DesignOrSystem, InvalidSystem, System, as_system, equilibrium
from squealbox.transient import (
    ALGEBRAIC,
    WITH_MASS,
    Latest,
    Trajectory,
    Widened,
    base_of,
    in_time,
    laid_open,
    row_kinds,
    simulate,
    start_of,
    system_of,
)

LATE = Latest(16)
INSTANT = 1e-5  # of a period over 2 pi: of the differences that give a rate


class Remembering(Autonomous):
    """A system with rows without mass or with memory, as shooting sees it."""

    def __init__(self, asked: System, contact: str = "exact", width: float = 1e-3) -> None:
        wide = self._wide = with_delays(asked)
        check_autonomous(wide)
        self.asked = asked
        frequency = float(np.max(self.own_modes()[0], initial=0.0)) or 1.0
        super().__init__(asked, base_of(wide), laid_open(wide), contact, width, frequency)
        kinds = np.array(row_kinds(self.held_fast))
        felt = np.any(self.held_fast.K != 0.0, axis=0) | np.any(self.n != 0.0, axis=0)
        felt[[row for row in getattr(wide, "memories", ()) if row >= 0]] = True
        self.independent = np.concatenate([(kinds != ALGEBRAIC) & felt, kinds == WITH_MASS])

    def own_modes(self) -> tuple[Any, Any]:
        modes = complex_modes(self.asked.replace(contacts=(), loops=()))
        rates = np.imag(modes.eigenvalues)
        swings = np.flatnonzero(np.isfinite(rates) & (rates > 0.0))
        shapes = [modes.mode(int(i)).shape[: self.asked.size] for i in swings]
        return rates[swings], np.array(shapes).reshape(-1, self.asked.size).T

    def sliding(self) -> Equilibrium:
        return equilibrium(self.asked)

    def state(self, q: np.ndarray, qd: np.ndarray, memory: np.ndarray | None = None) -> Any:
        q, qd = start_of(self._wide, Start(q, qd), 0.0)
        if memory is not None and len(memory):
            q = np.concatenate([q[: len(q) - len(memory)], memory])
        return np.concatenate([q, qd])

    def rate(self, x: np.ndarray, mode: np.ndarray) -> Any:
        """x' from the first instants of the motion, which takes its modes itself."""
        h, n = INSTANT / self.frequency, self.size
        times = np.array([0.0, h, 2.0 * h])
        run = simulate(
            self.held_fast, 2.0 * h, (x[:n], x[n:]), times, rtol=1e-13, contact=self.contact, width=self.width
        )
        early, middle, late = np.hstack([run.q, run.qd])
        return (4.0 * middle - 3.0 * early - late) / (2.0 * h)

    def delay_error(self, run: Trajectory) -> float:
        late = getattr(self._wide, "delays", ())
        worst, phase = 0.0, run.t - run.t[0]
        fine = np.flatnonzero(np.diff(phase, prepend=-np.inf) > 1e-9 * phase[-1])
        for delay, row, end, unit, limit in late:
            command = np.clip(run.qd[fine, row], -limit, limit)
            earlier = np.interp(phase[fine] - delay, phase[fine], command, period=phase[-1])
            off = np.max(np.abs(run.q[fine, end] * unit - earlier))
            worst = max(worst, float(off) / (float(np.max(np.abs(command))) or 1.0))
        return worst

    def multipliers(self, monodromy: np.ndarray) -> Any:
        inside = monodromy[np.ix_(self.independent, self.independent)]
        if not np.all(np.isfinite(inside)):
            return np.full(len(inside), np.nan)
        return ordered(np.linalg.eigvals(inside))


def with_delays(asked: System) -> System:
    """The system in time, with what is under way in its delays as rows; `InvalidSystem` for loops that are sampled."""
    for i, loop in enumerate(asked.loops):
        if loop.sampling is not None:
            raise InvalidSystem(
                f"loops[{i}] has sampling, a clock of its own: a motion under it has no period unless that is a whole "
                "number of samples; simulate() runs it, complex_modes() gives its growth"
            )
    late = any(not loop.linear for loop in asked.loops)
    if late:
        check_autonomous(asked)
    found: System = LATE.of(asked, (), lambda: in_time(asked, delays=True)) if late else system_of(asked)
    return found


def field_of(design_or_system: DesignOrSystem, contact: str = "exact", width: float = 1e-3) -> Autonomous:
    """The equation of a system whose states are q and q', else what its motion tells."""
    system = as_system(design_or_system)
    wide = with_delays(system)
    alone = not isinstance(wide, Widened) and all(kind == WITH_MASS for kind in row_kinds(wide))
    return Field(system, contact, width) if alone else Remembering(system, contact, width)

"""Where many motions of one system lead in a given time, each from a start of its own: the table is made once."""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from squealbox.system import System
from squealbox.transient import packing
from squealbox.transient._march import COMPLETED
from squealbox.transient.lanes.batch import stacked
from squealbox.transient.lanes.kernel import lane_kernel
from squealbox.transient.lanes.orders import Orders
from squealbox.transient.lanes.shape import layout, parameter_rows
from squealbox.transient.lanes.table import Jobs, tabulate
from squealbox.transient.lanes.work import EVERY, GROUPS, HEAD, on_a_line
from squealbox.transient.methods import Method


class Ends(NamedTuple):
    """Where motions ended: states (k, 2n), and whether each did without failing (k,), with its events (k,)."""

    states: Any
    ok: Any
    events: Any


def rows_of_all(jobs: Jobs) -> Any:
    """The parameter rows of each job, shape (jobs, rows)."""
    found = np.tile(jobs.fixed[3 : 3 + len(jobs.varies)], (len(jobs.table), 1))
    differ = jobs.varies >= 0
    found[:, differ] = jobs.table[:, jobs.varies[differ]]
    return found


class Flows:
    """The motions of a system, or of several alike, over about `duration` [s]; results do not depend on it.

    numbers (systems, rows) : what each system is, by the `names` of the rows; others of the same structure may stand
        there as well
    """

    def __init__(self, systems: Sequence[System], method: Method, scheme: int, width: float, duration: float) -> None:
        system = systems[0] if len(systems) == 1 else stacked(systems)
        n, rest = system.size, np.zeros((len(systems), system.size))
        jobs = tabulate(system, method, scheme, width, (rest, rest), duration, 0.0, (), (), False)
        self.names = parameter_rows(jobs.shape)
        self.numbers = rows_of_all(jobs)
        self.varies, self.first = np.arange(len(self.names)), self.names.index("start0") if n else 0
        self.fixed, self.shape, self.size = jobs.fixed, jobs.shape, len(layout(jobs.shape)) * jobs.shape.lanes
        self.alive = layout(jobs.shape).places["alive"] * jobs.shape.lanes
        self.record = packing.pack(jobs.template, method, scheme, width, False)
        self.scratch = packing.scratch(self.record, np.zeros(n), np.zeros(n), 0.0, 0.0)
        self.rule = packing.rule(method.tableau)
        self.kernel = lane_kernel(jobs.shape)

    def to(self, duration: float, starts: Any, of: Any = 0) -> Ends:
        """Ends of the motions from `starts` (k, 2n) of the systems numbered `of` (k,), all within `duration` [s]."""
        count, n = len(starts), self.shape.n
        table = self.numbers[np.broadcast_to(of, count)]
        table[:, self.first : self.first + 2 * n] = starts
        self.fixed[0] = duration
        out = np.full((count, HEAD + 2 * n + 2 * self.shape.m), np.nan)
        groups, live = on_a_line(GROUPS * self.size), np.zeros(GROUPS, dtype=np.int64)
        groups[self.alive] = -1.0
        orders = Orders(
            table, self.varies, self.fixed, np.zeros(0), np.zeros((1, 1, 1)),
            np.zeros(1, dtype=np.int64), count, out, self.record.copy(), self.rule, self.scratch,
            np.zeros(1, dtype=np.int64), EVERY,
        )  # fmt: skip
        self.kernel(groups, live, orders)
        return Ends(out[:, HEAD : HEAD + 2 * n], out[:, 0] == COMPLETED, out[:, 4])

"""What a kernel is told to do, handed over as one: jobs in, results out."""

from typing import Any, NamedTuple

import numpy as np

NOTHING = np.zeros((1, 1))


class Orders(NamedTuple):
    """The jobs of a kernel and where their results go; `p`, `r` and `s` are the records of the scalar march.

    table (jobs, columns), varies (rows,), fixed : as `table.Jobs` has them
    times (k,), samples (jobs, k, 2n) : instants at which states are kept
    counter (1,) : the next job, which threads raise; total : how many there are
    out (jobs, numbers) : how each ended
    stop (1,) : set to end it early; every : trials between two looks at it
    rows, events, count (2,) : of a recorded motion, and how many of both are written
    """

    table: Any
    varies: Any
    fixed: Any
    times: Any
    samples: Any
    counter: Any
    total: int
    out: Any
    p: Any
    r: Any
    s: Any
    stop: Any
    every: int
    rows: Any = NOTHING
    events: Any = NOTHING
    count: Any = np.zeros(2, dtype=np.int64)

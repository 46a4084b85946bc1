"""A friction law of one's own, named by own_law.toml: falling with speed, then rising again."""

import numpy as np


def mu(v, p):
    """The coefficient at v [m/s]; p[0] is the static limit, p[1] and so on the numbers of the design file."""
    return p[1] + (p[0] - p[1]) * np.exp(-v / p[2]) + p[3] * v

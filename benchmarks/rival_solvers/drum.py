"""The drum with its numbers in plain arrays, for solvers that know nothing of friction: see `rivals.py`."""

from dataclasses import dataclass

import numba as nb
import numpy as np


@dataclass(frozen=True)
class Drum:
    """y'' = f - k y - c y' + sum_c p_c force_c, with M divided out; m contacts, n degrees of freedom.

    g holds t_b . p_c: by how much a unit of friction at c slows the sliding of b.
    """

    k: np.ndarray
    c: np.ndarray
    f: np.ndarray
    p: np.ndarray
    t: np.ndarray
    n: np.ndarray
    N0: np.ndarray
    V: np.ndarray
    static: float
    slope: float

    @property
    def g(self):
        """(m, m)."""
        return self.t @ self.p.T

    @classmethod
    def each_of(cls, system):
        """One for each system of a batch, in the order of its flattened axes."""
        inverse, m = np.linalg.inv(system.M), len(system.contacts)
        names, count, size = ("n", "d", "t"), int(np.prod(system.shape)), system.K.shape[-1]

        def spread(values, *tail):
            return np.broadcast_to(values, (*system.shape, *tail)).reshape(count, *tail)

        k, c = spread(inverse @ system.K, size, size), spread(inverse @ system.C, size, size)
        f = spread(np.einsum("...ij,...j->...i", inverse, np.asarray(system.load)), size)
        inverse = spread(inverse, size, size)
        n, d, t = (np.stack([spread(getattr(x, name), size) for x in system.contacts], axis=1) for name in names)
        N0, V = (np.stack([spread(getattr(x, name)) for x in system.contacts], axis=1) for name in ("N0", "V"))
        law = system.contacts[0].law
        assert all(x.law == law for x in system.contacts), f"one law for all of {m} contacts"
        return [
            cls(k[i], c[i], f[i], d[i] @ inverse[i].T, t[i], n[i], N0[i], V[i], float(law.static), float(law.slope))
            for i in range(count)
        ]

    def flat(self, width):
        """All numbers for `tanh_rates`."""
        rows = np.concatenate([self.p, self.t, self.n, self.N0[:, None], self.V[:, None]], axis=1)
        return np.concatenate([[width, self.static, self.slope, len(self.V)], self.f, self.k.ravel(), self.c.ravel(),
                               rows.ravel()])  # fmt: skip

    def hold_by(self, s):
        """The inverse of g over the contacts that stick (s = 0), zero elsewhere."""
        h, rest = np.zeros_like(self.g), np.flatnonzero(s == 0.0)
        h[np.ix_(rest, rest)] = np.linalg.inv(self.g[np.ix_(rest, rest)])
        return h

    def sliding(self, y, s):
        """Accelerations by all but the sticking contacts' friction, and all normal forces."""
        speed, normal = self.V - self.t @ y[2:], self.N0 + self.n @ y[:2]
        slip = s * (self.static + self.slope * s * speed) * normal
        return self.f - self.k @ y[:2] - self.c @ y[2:] + self.p.T @ slip, normal

    def needed(self, y, s, hold_by):
        """Friction forces that keep the sticking contacts from sliding, and all normal forces."""
        rates, normal = self.sliding(y, s)
        return -hold_by @ (self.t @ rates), normal

    def after_stop(self, y, s, c):
        """Modes after contact c came to rest: it sticks if friction holds it, else it slides to where it is pulled."""
        s = s.copy()
        s[c] = 0.0
        hold, normal = self.needed(y, s, self.hold_by(s))
        if abs(hold[c]) > self.static * normal[c]:
            s[c] = np.sign(hold[c])
        return s


@nb.njit
def tanh_rates(y, dy, p):
    """y' with smoothed friction of two degrees of freedom; p as `Drum.flat` has it."""
    dy[0], dy[1] = y[2], y[3]
    a0 = p[4] - p[6] * y[0] - p[7] * y[1] - p[10] * y[2] - p[11] * y[3]
    a1 = p[5] - p[8] * y[0] - p[9] * y[1] - p[12] * y[2] - p[13] * y[3]
    for c in range(int(p[3])):
        at = 14 + 8 * c
        v = p[at + 7] - p[at + 2] * y[2] - p[at + 3] * y[3]
        normal = p[at + 6] + p[at + 4] * y[0] + p[at + 5] * y[1]
        force = (p[1] + p[2] * abs(v)) * np.tanh(v / p[0]) * normal
        a0 += p[at] * force
        a1 += p[at + 1] * force
    dy[2], dy[3] = a0, a1

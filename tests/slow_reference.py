"""A slow integrator of the tests' own: nothing of it is shared with the program but the system's numbers.

Steps of SciPy's DOP853 at rtol 1e-12, none longer than a sixteenth of the fastest period in sight; every step is
looked at in 12 places and at the minima between them, roots by Brent's rule. After an event each combination of modes
is tried by integrating a short stretch with it: one that holds to its end is taken, sticking first.
"""

from itertools import product
from types import SimpleNamespace

import numpy as np
from scipy.integrate import DOP853, solve_ivp
from scipy.optimize import brentq, minimize_scalar

from squealbox.schedules import Sinusoid, value_at

STICK, OPEN = 0, 2
PLACES = np.linspace(0.0, 1.0, 13)


def angular_frequencies(system):
    """Of the system without friction and of its harmonic schedules [rad/s]."""
    found = [0.0, *np.sqrt(np.abs(np.linalg.eigvals(np.linalg.solve(system.M, system.K))))]
    for value in (system.load, *(x for c in system.contacts for x in (c.V, c.N0))):
        for _, part in value.terms() if hasattr(value, "terms") else ():
            found += [2.0 * np.pi * part.frequency] if isinstance(part, Sinusoid) else []
    return found


class Slow:
    """One system with its modes."""

    def __init__(self, system):
        self.system, self.n, self.m = system, system.size, len(system.contacts)
        self.d, self.t = (np.array([getattr(c, x) for c in system.contacts]).reshape(self.m, self.n) for x in "dt")
        self.inverse = np.linalg.inv(system.M)
        self.static = np.array([float(c.law.static_limit) for c in system.contacts])
        self.step = 2.0 * np.pi / 16.0 / max(max(angular_frequencies(system)), 1e-3)
        self.modes = [1] * self.m
        self.laws = [(type(c.law).formula, c.law.coefficients()) for c in system.contacts]

    def mu(self, c, v):
        formula, coefficients = self.laws[c]
        return float(formula(v, coefficients))

    def given(self, t, y):
        q, v = y[: self.n], y[self.n :]
        normal = np.array([float(value_at(c.N0, t) + c.n @ q) for c in self.system.contacts])
        speed = np.array([float(value_at(c.V, t) - c.t @ v) for c in self.system.contacts])
        rate = np.array([float(c.V.rate(t)) if hasattr(c.V, "rate") else 0.0 for c in self.system.contacts])
        return normal, speed, rate

    def motion(self, t, y, modes):
        """(y', forces, normal forces, speeds) with the contacts in these modes."""
        system, q, v = self.system, y[: self.n], y[self.n :]
        normal, speed, rate = self.given(t, y)
        force = np.zeros(self.m)
        push = np.asarray(value_at(system.load, t), dtype=float) - system.C @ v - system.K @ q
        for c, contact in enumerate(system.contacts):
            if modes[c] in (1, -1):
                force[c] = modes[c] * self.mu(c, max(modes[c] * speed[c], 0.0)) * normal[c]
            elif modes[c] == OPEN:
                push = push + contact.normal * normal[c]
        a = self.inverse @ (push + self.d.T @ force)
        held = [c for c in range(self.m) if modes[c] == STICK]
        if held:
            weight = np.array([max(self.static[c] * normal[c], 0.0) for c in held])
            weight = np.diag(weight / max(weight.max(), 1e-300))
            matrix = self.t[held] @ self.inverse @ self.d[held].T @ weight
            force[held] = weight @ np.linalg.lstsq(matrix, rate[held] - self.t[held] @ a, rcond=1e-11)[0]
            a = a + self.inverse @ (self.d[held].T @ force[held])
        return np.concatenate([v, a]), force, normal, speed

    def functions(self, t, y, modes):
        """Positive while the modes hold."""
        _, force, normal, speed = self.motion(t, y, modes)
        out = []
        for c in range(self.m):
            unilateral = self.system.contacts[c].unilateral
            if modes[c] == OPEN:
                out.append(-normal[c])
            elif modes[c] == STICK:
                out.append(self.static[c] * normal[c] - abs(force[c]) if normal[c] > 1e-12 else 1.0)
            else:
                out.append(modes[c] * speed[c] if self.static[c] > 0.0 else 1.0)
                out += [normal[c]] if unilateral else []
        return np.array(out)

    def choose(self, t, y, until):
        """Modes that hold over a short stretch, sticking first."""
        normal, speed, _ = self.given(t, y)
        choices = []
        for c, contact in enumerate(self.system.contacts):
            size = abs(float(value_at(contact.V, t))) + np.sum(np.abs(contact.t * y[self.n :])) + 1e-3
            slow, slides = abs(speed[c]) <= 1e-9 * size, 1 if speed[c] > 0 else -1
            here = [STICK, 1, -1] if slow else [slides]
            if contact.unilateral and normal[c] <= 1e-11 * (1.0 + abs(normal).max()):
                here = [*here, OPEN] if abs(normal[c]) <= 1e-11 * (1.0 + abs(normal).max()) else [OPEN]
            choices.append(here)
        best, least = None, np.inf
        combinations = sorted(product(*choices), key=lambda modes: -sum(mode == STICK for mode in modes))
        for length in (1e-4, 1e-6, 1e-2):
            stretch = min(length * self.step, until - t)
            for modes in combinations:
                broken = self.broken(t, self.held(t, y, modes), modes, stretch)
                if broken <= 1e-12:
                    return list(modes)
                if broken < least:
                    best, least = modes, broken
        return list(best)

    def broken(self, t, y, modes, stretch):
        """By how much the modes fail over a stretch, over the size of what fails."""
        out = solve_ivp(lambda s, x: self.motion(s, x, modes)[0], (t, t + stretch), y, method="DOP853",
                        rtol=1e-12, atol=1e-16, t_eval=t + stretch * np.array([0.3, 1.0]))  # fmt: skip
        worst = 0.0
        for s, x in zip(out.t, out.y.T, strict=True):
            values = self.functions(s, x, modes)
            sizes = 1e-4 * stretch / self.step + np.zeros(len(values))
            worst = max(worst, float(np.max(-values / sizes, initial=0.0)))
        return worst

    def held(self, t, y, modes):
        """Sticking contacts put exactly on their speed."""
        held = [c for c in range(self.m) if modes[c] == STICK]
        if not held:
            return y
        _, speed, _ = self.given(t, y)
        matrix = self.t[held] @ self.inverse @ self.d[held].T
        impulse = np.linalg.lstsq(matrix, speed[held], rcond=1e-11)[0]
        out = y.copy()
        out[self.n :] += self.inverse @ (self.d[held].T @ impulse)
        return out

    def run(self, duration, q, v):
        """q, v, and the events (time, contact, mode) of the whole run."""
        t, y, events = 0.0, np.concatenate([np.asarray(q, float), np.asarray(v, float)]), []
        kinks = [duration]
        for value in (self.system.load, *(x for c in self.system.contacts for x in (c.V, c.N0))):
            kinks += [b for b in value.breaks() if 0.0 < b < duration] if hasattr(value, "breaks") else []
        for end in sorted(set(kinks)):
            while t < end:
                chosen = self.choose(t, y, end)
                if t > 0.0:
                    events += [(t, c, chosen[c]) for c in range(self.m) if chosen[c] != self.modes[c]]
                self.modes = chosen
                y = self.held(t, y, self.modes)
                t, y = self.until_event(t, y, end)
        return SimpleNamespace(q=y[: self.n], qd=y[self.n :], events=events, modes=self.modes)

    def until_event(self, t, y, end):
        """March with fixed modes to the first event or the end."""
        modes, first = list(self.modes), True
        solver = DOP853(lambda s, x: self.motion(s, x, modes)[0], t, y, end, max_step=self.step, rtol=1e-12, atol=1e-14)
        while solver.status == "running":
            solver.step()
            dense, a, h = solver.dense_output(), solver.t_old, solver.t - solver.t_old

            def values(x, dense=dense, a=a, h=h):
                return self.functions(a + x * h, dense(a + x * h), modes)

            places = PLACES
            if first:  # what has just changed starts at zero
                places = np.concatenate([[min(1e-4 * self.step / h, 0.5)], PLACES[1:]])
                first = False
            table = np.array([values(x) for x in places])
            best = 2.0
            for j in range(table.shape[1]):
                best = min(best, self.root(places, table[:, j], lambda x, j=j: values(x)[j]))
            if best <= 1.0:
                return a + best * h, dense(a + best * h)
        return solver.t, solver.y

    @staticmethod
    def root(places, column, function):
        """The first root of one function, 2 when there is none."""
        for i in range(len(places)):
            if column[i] <= 0.0:
                return places[0] if i == 0 else brentq(function, places[i - 1], places[i], xtol=1e-15)
            if (
                0 < i < len(places) - 1
                and places[i - 1] < places[i + 1]
                and column[i] <= column[i - 1]
                and column[i] <= column[i + 1]
            ):
                low = minimize_scalar(function, bounds=(places[i - 1], places[i + 1]), method="bounded",
                                      options={"xatol": 1e-10})  # fmt: skip
                if low.fun <= 0.0:
                    return brentq(function, places[i - 1], low.x, xtol=1e-15)
        return 2.0


def slow(system, duration, q=None, v=None):
    """The end of a motion and its events."""
    rest = np.zeros(system.size)
    return Slow(system).run(duration, rest if q is None else q, rest if v is None else v)

"""A slow integrator of the tests' own: nothing of it is shared with the program but the system's numbers.

Steps of SciPy's DOP853 at rtol 1e-12, none longer than a sixteenth of the fastest period in sight; every step is
looked at in 12 places and at the minima between them, roots by Brent's rule. After an event each combination of modes
is tried by integrating a short stretch with it: one that holds to its end is taken, sticking first. Landings on rigid
contacts try every combination of impulses. Rows without mass are solved for their velocities (damping among them) or
their displacements (stiffness alone), before anything else.
"""

from itertools import product
from types import SimpleNamespace

import numpy as np
from scipy.integrate import DOP853, solve_ivp
from scipy.optimize import brentq, minimize_scalar

from slow_laws import EndlessEvents, own_coefficient, own_schedule, scheduled
from squealbox import schedules

STICK, OPEN = 0, 2
PLACES = np.linspace(0.0, 1.0, 13)
MOST = 600  # looks for new modes, or steps between two, after which the slow integrator gives up
NOTHING = 1e-30  # N of a closed floor that carries nothing
CLOSED = 1e-6  # share of the fastest landing below which a rebound counts as none: a convention of the program


class Slow:
    """One system with its modes."""

    def __init__(self, system):
        self.system, self.n, self.m = system, system.size, len(system.contacts)
        rows = {x: np.array([np.zeros(self.n) if getattr(c, x) is None else getattr(c, x) for c in system.contacts])
                for x in ("n", "d", "t", "normal")}  # fmt: skip
        self.N, self.d, self.t, self.w = (x.reshape(self.m, self.n) for x in rows.values())
        self.rigid = np.array([c.rigid for c in system.contacts], dtype=bool)
        self.unilateral = np.array([c.unilateral for c in system.contacts], dtype=bool)
        self.gap0 = np.array([c.gap for c in system.contacts])
        self.restitution = np.array([c.restitution for c in system.contacts])
        self.mu = [own_coefficient(c.law) for c in system.contacts]
        self.static = np.array([float(c.law.coefficients()[0]) for c in system.contacts])
        rubs = [any(mu(v) != 0.0 for v in (0.0, 1e-3, 1.0)) for mu in self.mu]
        self.rubs = np.array(rubs, dtype=bool) & np.any(self.t != 0.0, axis=1)
        self.rising = self.rubs & (self.static == 0.0)  # a force without a jump: no mode, no event
        self.rubs &= ~self.rising
        self.load, self.normal_given = own_schedule(system.load)[0], [own_schedule(c.N0)[0] for c in system.contacts]
        self.speed_given = [own_schedule(c.V) for c in system.contacts]
        self.massive = np.any(system.M != 0.0, axis=1)
        self.light, self.some_light = ~self.massive, not np.all(self.massive)
        self.inverse = np.zeros((self.n, self.n))
        self.inverse[np.ix_(self.massive, self.massive)] = np.linalg.inv(system.M[np.ix_(self.massive, self.massive)])
        self.damped = self.light & np.any(system.C != 0.0, axis=1)
        self.static_rows = self.light & ~self.damped
        self.step = 2.0 * np.pi / 16.0 / max(*self.angular_frequencies(), 1.0)  # a free body too is looked at
        reach = np.linalg.norm(self.d @ self.inverse, axis=1)
        self.reach = np.where(reach > 0.0, reach, 1.0)  # contacts on one motion come to their limits together
        self.modes, self.fastest, self.inside = [1] * self.m, 0.0, np.inf
        self.alike = [(a, b, sign) for b in range(self.m) for a in range(b) if (sign := self.on_one_motion(a, b))]

    def on_one_motion(self, a, b):
        """The sign between the speeds of two contacts that always slide together; 0 where they do not."""
        size = np.linalg.norm(self.t[b]) / max(np.linalg.norm(self.t[a]), 1e-300)
        for sign in (1, -1) if self.rubs[a] and self.rubs[b] else ():
            one, other = self.system.contacts[a].V, self.system.contacts[b].V
            held = not hasattr(one, "terms") and not hasattr(other, "terms") and np.isclose(sign * size * one, other)
            if np.allclose(self.t[b], sign * size * self.t[a]) and (held or (one is other and sign * size == 1.0)):
                return sign
        return 0

    def angular_frequencies(self):
        """Of the system without friction and of its harmonic schedules [rad/s]."""
        rates = np.linalg.eigvals(self.inverse @ self.system.K)
        found = [0.0, *np.sqrt(np.abs(rates))]
        for value in scheduled(self.system):
            for _, part in value.terms() if hasattr(value, "terms") else ():
                found += [2.0 * np.pi * part.frequency] if isinstance(part, schedules.Sinusoid) else []
        return found

    def completed(self, t, y):
        """q and v with the rows without mass solved for."""
        q, v = y[: self.n], y[self.n :]
        system = self.system
        if self.some_light:
            q, v = q.copy(), v.copy()
            a, b = self.static_rows, self.damped
            f = self.load(t) * np.ones(self.n)
            if np.any(a):  # K_aa q_a = f_a - K_ao q_o
                q[a] = np.linalg.solve(system.K[np.ix_(a, a)], f[a] - system.K[np.ix_(a, ~a)] @ q[~a])
            if np.any(b):  # C_bb v_b = f_b - K_b q - C_bm v_m
                m = self.massive
                right = f[b] - system.K[b] @ q - system.C[np.ix_(b, m)] @ v[m]
                v[b] = np.linalg.solve(system.C[np.ix_(b, b)], right)
        return q, v

    def given(self, t, q, v):
        normal = np.array([float(x(t)) for x in self.normal_given]) + self.N @ q
        speed = np.array([float(x(t)) for x, _ in self.speed_given]) - self.t @ v
        return normal, speed

    def motion(self, t, y, modes):
        """(y', forces, normal forces, speeds) with the contacts in these modes."""
        t = min(t, self.inside)
        q, v = self.completed(t, y)
        normal, speed = self.given(t, q, v)
        force = np.zeros(self.m)
        push = self.load(t) - self.system.C @ v - self.system.K @ q
        unknown = []  # (contact, row, right side, direction, weight, is it a normal force)
        for c in range(self.m):
            mode = modes[c]
            if mode == OPEN:
                if not self.rigid[c]:
                    push = push + self.w[c] * normal[c]
                normal[c] = normal[c] if not self.rigid[c] else 0.0
                continue
            slip = mode * self.mu[c](max(mode * speed[c], 0.0)) if mode != STICK else 0.0
            slip = np.sign(speed[c]) * self.mu[c](abs(speed[c])) if self.rising[c] else slip
            if self.rigid[c]:
                unknown.append((c, self.w[c], 0.0, slip * self.d[c] - self.w[c], 1.0, True))
            elif mode != STICK:
                force[c] = slip * normal[c]
            if mode == STICK:
                weight = 1.0 if self.rigid[c] else np.sqrt(max(self.static[c] * normal[c], 0.0) / self.reach[c])
                unknown.append((c, self.t[c], float(self.speed_given[c][1](t)), self.d[c], weight, False))
        a = self.inverse @ (push + self.d.T @ force)
        found, rest = self.solved(unknown, a)
        for lost in [u[0] for u, x in zip(unknown, found, strict=True) if u[5] and x < 0.0]:
            fewer = [u for u in unknown if u[0] != lost]  # a floor that would pull, where friction holds all the same
            other, left = self.solved(fewer, a)
            gone = max(abs(u[1] @ left - u[2]) for u in unknown if u[0] == lost)
            if gone <= 1e-8 * (np.sum(np.abs(a)) + np.sum(np.abs(left)) + 1e-9):
                unknown, found, rest, normal[lost] = fewer, other, left, NOTHING
        for (c, *_, pressing), x in zip(unknown, found, strict=True):
            if pressing:
                normal[c] = x
            else:
                force[c] = x
        return np.concatenate([v, rest]), force, normal, speed

    def solved(self, unknown, a):
        """The unknown forces, floors carrying what they can, and the accelerations with them."""
        if not unknown:
            return [], a
        rows, right = np.array([u[1] for u in unknown]), np.array([u[2] for u in unknown])
        floors = np.array([u[5] for u in unknown])  # friction beside them carries nothing
        weight = np.array([u[4] for u in unknown]) * np.where(floors | ~np.any(floors), 1.0, 1e-5)
        weight /= max(weight.max(), 1e-300)
        columns = self.inverse @ np.array([u[3] for u in unknown]).T
        found = weight * np.linalg.lstsq(rows @ columns * weight, right - rows @ a, rcond=1e-11)[0]
        return found, a + columns @ found

    def gap(self, q):
        return self.gap0 - self.w @ q

    def functions(self, t, y, modes):
        """Two for each contact, positive while the modes hold."""
        t = min(t, self.inside)
        rates, force, normal, speed = self.motion(t, y, modes)
        gap, a = self.gap(self.completed(t, y)[0]), rates[self.n :]
        out = np.ones((self.m, 2))
        for c in range(self.m):
            if modes[c] == OPEN:
                out[c, 0] = gap[c] if self.rigid[c] else -normal[c]
                continue
            if modes[c] == STICK:
                out[c, 0] = self.spared(c, modes, force, normal) if normal[c] > 1e-12 else 1.0
                asked, got = float(self.speed_given[c][1](t)), self.t[c] * a
                parted = abs(np.sum(got) - asked) > 1e-7 * (abs(asked) + np.sum(np.abs(got)) + 1e-3)
                out[c, 0] = -1.0 if parted else out[c, 0]  # two speeds on one motion do not stick together
            elif self.rubs[c]:
                out[c, 0] = modes[c] * speed[c]
            if self.unilateral[c]:
                out[c, 1] = normal[c]
        return out.ravel()

    def spared(self, c, modes, force, normal):
        """How far the contacts that stick on the motion of one are below what they can carry together."""
        total, limit, own = force[c], self.static[c] * normal[c], np.linalg.norm(self.d[c])
        for a, b, sign in self.alike:
            other = a if b == c else b if a == c else -1
            if other >= 0 and modes[other] == STICK:
                lever = np.linalg.norm(self.d[other]) / own
                total += sign * lever * force[other]
                limit += lever * self.static[other] * max(normal[other], 0.0)
        return limit - abs(total)

    def choices(self, t, y):
        """What each contact may do now."""
        q, v = self.completed(t, y)
        normal, speed = self.given(t, q, v)
        gap, rate = self.gap(q), -self.w @ v
        out = []
        for c in range(self.m):
            size = abs(float(self.speed_given[c][0](t))) + np.sum(np.abs(self.t[c] * v)) + 1e-3
            still, slides = abs(speed[c]) <= 1e-9 * size and self.rubs[c], 1 if speed[c] > 0 else -1
            here = [STICK, 1, -1] if still else [slides if self.rubs[c] else 1]
            if self.rigid[c]:
                touching = gap[c] <= 1e-10 * (1.0 + abs(self.gap0[c]))
                apart = rate[c] > 1e-9 * (1.0 + np.sum(np.abs(self.w[c] * v)))
                here = [OPEN] if not touching or apart else [*here, OPEN]
            elif self.unilateral[c] and normal[c] <= 1e-11 * (1.0 + abs(normal).max()):
                here = [*here, OPEN] if abs(normal[c]) <= 1e-11 * (1.0 + abs(normal).max()) else [OPEN]
            out.append(here)
        return out

    def choose(self, t, y, until):
        """Modes that hold over a short stretch: the present ones, else sticking first."""
        choices = self.choices(t, y)
        best, least = None, np.inf
        firm = self.firm(t, y)
        combinations = sorted(product(*choices), key=lambda modes: (
            sum(mode != STICK for mode, held in zip(modes, firm, strict=True) if held),
            -sum(mode == STICK for mode in modes)))  # fmt: skip
        combinations = [x for x in combinations if all(OPEN in (x[a], x[b]) or x[b] == s * x[a]
                                                       for a, b, s in self.alike)]  # fmt: skip
        for length in (1e-4, 1e-6, 1e-2):
            stretch = min(length * self.step, until - t)
            for modes in combinations:
                broken = self.broken(t, self.held(t, y, modes), modes, stretch)
                if broken <= 1e-12:
                    return list(modes)
                if broken < least:
                    best, least = modes, broken
        return list(best)

    def firm(self, t, y):
        """The contacts that stick below their limits: nothing lets them go but what another does."""
        if t == 0.0:
            return [False] * self.m
        _, force, normal, _ = self.motion(t, y, self.modes)
        limit = self.static * normal
        return [mode == STICK and abs(f) < (1.0 - 1e-7) * g
                for mode, f, g in zip(self.modes, force, limit, strict=True)]  # fmt: skip

    def broken(self, t, y, modes, stretch):
        """By how much the modes fail over a stretch, over the size of what fails."""
        out = solve_ivp(lambda s, x: self.motion(s, x, modes)[0], (t, t + stretch), y, method="DOP853",
                        rtol=1e-12, atol=1e-16, t_eval=t + stretch * np.array([0.3, 1.0]))  # fmt: skip
        worst = 0.0
        for s, x in zip(out.t, out.y.T, strict=True):
            worst = max(worst, float(np.max(-self.functions(s, x, modes) / (1e-4 * stretch / self.step), initial=0.0)))
        return worst

    def held(self, t, y, modes):
        """Sticking contacts put exactly on their speed, closed rigid ones on their floor."""
        stuck = [c for c in range(self.m) if modes[c] == STICK]
        closed = [c for c in range(self.m) if self.rigid[c] and modes[c] != OPEN]
        out = y.copy()
        if not stuck and not closed:
            return out
        if closed:
            column = self.inverse @ self.w[closed].T
            gap = self.gap(out[: self.n])[closed]
            out[: self.n] += column @ np.linalg.lstsq(self.w[closed] @ column, gap, rcond=1e-11)[0]
        q, v = self.completed(t, out)
        _, speed = self.given(t, q, v)
        rows = np.vstack([self.t[stuck], self.w[closed]])
        right = np.concatenate([speed[stuck], -self.w[closed] @ v])
        column = self.inverse @ np.vstack([self.d[stuck], self.w[closed]]).T
        out[self.n :] += column @ np.linalg.lstsq(rows @ column, right, rcond=1e-11)[0]
        return out

    def land(self, t, y):
        """Velocities after an impact of all rigid contacts that touch: Newton's restitution, Coulomb's impulses."""
        q, v = self.completed(t, y)
        _, speed = self.given(t, q, v)
        rate = -self.w @ v
        approach = np.where(rate < -1e-11, -rate, 0.0)
        touching = [c for c in range(self.m) if self.rigid[c] and self.gap(q)[c] <= 1e-9 and rate[c] <= 1e-9]
        self.fastest = max([self.fastest, *approach[touching]])
        rebound = self.restitution * approach
        rebound[rebound <= CLOSED * self.fastest] = 0.0
        kinds = [([STICK, 1, -1] if self.rubs[c] else [1 if speed[c] >= 0 else -1]) + [OPEN]
                 for c in touching]  # fmt: skip
        best, least = v, np.inf
        for combination in product(*kinds):
            rows, right, directions, about = [], [], [], []
            for c, kind in zip(touching, combination, strict=True):
                mu = max(self.mu[c](abs(speed[c])), 0.0)
                if kind == OPEN:
                    continue
                slip = 0.0 if kind == STICK else kind * mu
                rows.append(-self.w[c])
                right.append(rebound[c] - rate[c])
                directions.append(slip * self.d[c] - self.w[c])
                about.append((c, "normal"))
                if kind == STICK:
                    rows.append(self.t[c])
                    right.append(speed[c])
                    directions.append(self.d[c])
                    about.append((c, "along"))
            after, impulse = v, {}
            if rows:
                column = self.inverse @ np.array(directions).T
                found = np.linalg.lstsq(np.array(rows) @ column, np.array(right), rcond=1e-11)[0]
                after, impulse = v + column @ found, dict(zip(about, found, strict=True))
            new_speed = speed + self.t @ v - self.t @ after
            fault = 0.0
            for c, kind in zip(touching, combination, strict=True):
                mu, size = max(self.mu[c](abs(speed[c])), 0.0), impulse.get((c, "normal"), 0.0)
                faults = [-size, rebound[c] + self.w[c] @ after]
                if kind == STICK:
                    faults.append(abs(impulse[c, "along"]) - mu * size)
                elif kind != OPEN and self.rubs[c]:
                    faults.append(-kind * new_speed[c])
                fault = max(fault, *faults)
            if fault < least - 1e-13:
                best, least = after, fault
        out = np.concatenate([q, best])
        landed = [c for c in touching if approach[c] > 0.0]
        return out, landed

    def run(self, duration, q, v):
        """q, v, and the events (time, contact, mode) of the whole run."""
        t, y, events, turns = 0.0, np.concatenate([np.asarray(q, float), np.asarray(v, float)]), [], 0
        before = -np.inf  # the event before the last: intervals that shrink are followed as they do
        kinks = [duration]
        for value in scheduled(self.system):
            kinks += [b for b in value.breaks() if 0.0 < b < duration] if hasattr(value, "breaks") else []
        for end in sorted(set(kinks)):
            self.inside = np.nextafter(end, 0.0)  # the end of a piece sees the slopes before its kink
            while t < end:
                if (turns := turns + 1) > MOST:
                    raise EndlessEvents(f"more than {MOST} turns to t = {t:.6g} s")
                landed = []
                if np.any(self.rigid):
                    y, landed = self.land(t, y)
                chosen = self.choose(t, y, end)
                changed = bool(landed) or list(chosen) != list(self.modes)
                self.last, before = (before, t) if changed else (-np.inf, before)
                if t > 0.0:
                    events += [(t, c, chosen[c]) for c in range(self.m) if chosen[c] != self.modes[c] or c in landed]
                self.modes = chosen
                y = self.held(t, y, self.modes)
                t, y = self.until_event(t, y, end)
        q, v = self.completed(t, y)
        return SimpleNamespace(q=q, qd=v, events=events, modes=self.modes)

    def until_event(self, t, y, end):
        """March with fixed modes to the first event or the end."""
        modes, first, steps = list(self.modes), True, 0
        solver = DOP853(lambda s, x: self.motion(s, x, modes)[0], t, y, end, max_step=self.step, rtol=1e-12, atol=1e-14)
        while solver.status == "running":
            solver.step()
            if (steps := steps + 1) > MOST:
                raise EndlessEvents(f"{MOST} steps to t = {solver.t:.6g} s")
            dense, a, h = solver.dense_output(), solver.t_old, solver.t - solver.t_old

            def values(x, dense=dense, a=a, h=h):
                return self.functions(a + x * h, dense(a + x * h), modes)

            places, begin = PLACES, 0 * values(0.0)
            if first:  # what has just changed starts at zero
                soon = min(1e-4 * self.step, 0.1 * self.flight(a, dense(a), modes), 0.01 * max(a - self.last, 1e-9))
                begin = values(0.0)
                early = np.geomspace(np.clip(soon / h, 1e-9, 0.5 * PLACES[1]), PLACES[1], 16)  # short flights
                places = np.concatenate([early[:-1], PLACES[1:]])
                first = False
            table = np.array([values(x) for x in places])
            best = 2.0
            for j in range(table.shape[1]):
                at, column = places, table[:, j]
                if begin[j] > 1e-7 * np.max(np.abs(column)):  # has not just changed, and may end at once
                    at, column = np.r_[0.0, places], np.r_[begin[j], column]
                best = min(best, self.root(at, column, lambda x, j=j: values(x)[j]))
            if best <= 1.0:
                return a + best * h, dense(a + best * h)
        return solver.t, solver.y

    def flight(self, t, y, modes):
        """How long the shortest rebound that has just begun will last."""
        rates = self.motion(t, y, modes)[0]
        rate, falls = -self.w @ rates[: self.n], self.w @ rates[self.n :]
        off = self.rigid & (np.array(modes) == OPEN) & (rate > 0.0) & (falls > 0.0) & (self.gap(y[: self.n]) < 1e-9)
        return float(np.min(2.0 * rate[off] / falls[off], initial=np.inf))

    @staticmethod
    def root(places, column, function):
        """The first root of one function, 2 when there is none."""
        if np.ptp(column) == 0.0 and column[0] > 0.0:
            return 2.0
        for i in range(len(places)):
            if column[i] <= 0.0:
                return places[0] if i == 0 else brentq(function, places[i - 1], places[i], xtol=1e-15)
            if (
                0 < i < len(places) - 1
                and places[i - 1] < places[i + 1]
                and column[i] <= column[i - 1]
                and column[i] <= column[i + 1]
                and column[i] <= 2.0 * (max(column[i - 1], column[i + 1]) - column[i])  # else far above zero
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

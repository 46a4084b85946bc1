"""Exact sticking by the solvers' own events: heyoka and CyRK decide the next mode in Python, diffrax in its loop."""

import CyRK
import diffrax
import heyoka as hy
import jax
import jax.numpy as jnp
import numpy as np
import optimistix
from ensembles import DURATION

from .door import SCALE, Rival, of_each, stacked

# A contact let go by its bound starts with v = v' = 0: rounding must not stop it again at once. [m/s]
AWAY = 1e-12


def jax_hold(p, s):
    """The inverse of g over the sticking contacts: the others' rows are those of the unit matrix."""
    rest = s == 0.0
    both = rest[:, None] & rest[None, :]
    return jnp.where(both, jnp.linalg.inv(jnp.where(both, p["g"], jnp.eye(s.size))), 0.0)


def jax_forces(y, s, p):
    """Friction of the slipping and of the sticking contacts, normal forces, sliding speeds."""
    speed, normal = p["V"] - p["t"] @ y[2:], p["N0"] + p["n"] @ y[:2]
    slip = s * (p["static"] + p["slope"] * s * speed) * normal
    rates = p["f"] - p["k"] @ y[:2] - p["c"] @ y[2:] + p["p"].T @ slip
    return slip, -jax_hold(p, s) @ (p["t"] @ rates), normal, speed


def jax_rates(t, y, args):
    """y' of the exact formulation in given modes."""
    p, s = args
    slip, hold, _, _ = jax_forces(y, s, p)
    rates = p["f"] - p["k"] @ y[:2] - p["c"] @ y[2:] + p["p"].T @ (slip + hold)
    return jnp.concatenate([y[2:], rates])


def jax_events(count):
    """For each contact: slip ends, and the hold meets either bound. Each falls through zero."""

    def event(kind, c):
        def value(t, y, args, **_):
            p, s = args
            _, hold, normal, speed = jax_forces(y, s, p)
            inside = (s[c] * speed[c] + AWAY, p["static"] * normal[c] - hold[c], p["static"] * normal[c] + hold[c])
            return jnp.where((s[c] == 0.0) == (kind > 0), inside[kind], 1.0)

        return value

    return [event(kind, c) for c in range(count) for kind in range(3)]


def jax_next(y, s, p, hit):
    """Modes after the event: `Drum.after_stop` for a stop, else slip to the side whose bound was met."""
    hits = jnp.stack(hit).reshape(-1, 3)
    for c in range(s.size):
        trial = s.at[c].set(0.0)
        _, hold, normal, _ = jax_forces(y, trial, p)
        stopped = jnp.where(jnp.abs(hold[c]) > p["static"] * normal[c], jnp.sign(hold[c]), 0.0)
        s = s.at[c].set(jnp.where(hits[c, 0], stopped, jnp.where(hits[c, 1], 1.0, jnp.where(hits[c, 2], -1.0, s[c]))))
    return s


def diffrax_events(drums, setting):
    """diffrax ends a solve at an event; a loop around it, compiled as well, goes on in the next modes."""
    rtol = setting[0]
    finder = optimistix.Newton(1e-13, 1e-13, optimistix.rms_norm)
    event = diffrax.Event(jax_events(len(drums[0].V)), finder, direction=False)
    control = diffrax.PIDController(rtol=rtol, atol=rtol * SCALE, dtmax=1e-4)

    def leg(state, p):
        t, y, s, legs = state
        found = diffrax.diffeqsolve(
            diffrax.ODETerm(jax_rates), diffrax.Dopri8(), t, DURATION, 1e-7, y, (p, s), max_steps=None, event=event,
            stepsize_controller=control, saveat=diffrax.SaveAt(t1=True), adjoint=diffrax.ForwardMode(), throw=False,
        )  # fmt: skip
        return found.ts[0], found.ys[0], jax_next(found.ys[0], s, p, found.event_mask), legs + 1

    def one(p):
        start = (jnp.asarray(0.0), jnp.zeros(4), jnp.sign(p["V"]), 0)
        ended = jax.lax.while_loop(lambda x: (x[0] < DURATION) & (x[3] < 5_000), lambda x: leg(x, p), start)
        return jnp.where(ended[0] >= DURATION, ended[1][:2], jnp.nan)

    compiled, p = jax.jit(jax.vmap(one)), stacked(drums)
    compiled(p)
    return lambda: np.asarray(compiled(p))


def dot(row, x):
    """Their product without the terms that vanish."""
    return sum((float(a) * b for a, b in zip(row, x, strict=True) if a != 0.0), 0.0 * x[0])


def heyoka_free(drum, q, v):
    """Sliding speeds, normal forces, and the accelerations without friction."""
    speed = [float(V) - dot(t, v) for V, t in zip(drum.V, drum.t, strict=True)]
    normal = [float(N) + dot(n, q) for N, n in zip(drum.N0, drum.n, strict=True)]
    free = [float(f) - dot(k, q) - dot(c, v) for f, k, c in zip(drum.f, drum.k, drum.c, strict=True)]
    return speed, normal, free


class HeyokaEvents:
    """Terminal events of heyoka; parameters are the senses of slip s (0 sticks) and the inverse of G over those."""

    def __init__(self, drum, rtol):
        m = len(drum.V)
        self.drum, self.m = drum, m
        q, v = hy.make_vars("q0", "q1"), hy.make_vars("v0", "v1")
        speed, normal, free = heyoka_free(drum, q, v)
        s, h = [hy.par[c] for c in range(m)], [[hy.par[m + m * a + b] for b in range(m)] for a in range(m)]
        slip = [s[c] * (drum.static + drum.slope * s[c] * speed[c]) * normal[c] for c in range(m)]
        sliding = [free[i] + dot(drum.p[:, i], slip) for i in range(2)]
        lacking = [-dot(drum.t[c], sliding) for c in range(m)]
        hold = [sum(h[c][b] * lacking[b] for b in range(m)) for c in range(m)]
        a = [sliding[i] + dot(drum.p[:, i], hold) for i in range(2)]
        events = []
        for c in range(m):
            slips = s[c] * s[c]
            bounds = [drum.static * normal[c] - hold[c], drum.static * normal[c] + hold[c]]
            events += [s[c] * speed[c] + AWAY + (1.0 - slips), *((1.0 - slips) * x + slips for x in bounds)]
        falling = hy.event_direction.negative
        self.ta = hy.taylor_adaptive([*zip(q, v, strict=True), *zip(v, a, strict=True)], np.zeros(4), tol=rtol,
                                     t_events=[hy.t_event(x, direction=falling) for x in events])  # fmt: skip

    def set(self, s):
        """Modes into the parameters; those of the last contacts may not occur in the equation."""
        values = np.concatenate([s, self.drum.hold_by(s).ravel()])
        self.ta.pars[:] = values[: len(self.ta.pars)]

    def __call__(self):
        """From rest to the end."""
        ta, s = self.ta, np.sign(self.drum.V)
        ta.time, ta.state[:] = 0.0, 0.0
        ta.reset_cooldowns()
        self.set(s)
        while True:
            outcome = ta.propagate_until(DURATION)[0]
            if outcome == hy.taylor_outcome.time_limit:
                return ta.state[:2].copy()
            c, kind = divmod(-int(outcome) - 1, 3)
            s = self.drum.after_stop(ta.state, s, c) if kind == 0 else with_sense(s, c, (1.0, -1.0)[kind - 1])
            self.set(s)


def with_sense(s, c, sense):
    """A copy in which contact c slides so."""
    s = s.copy()
    s[c] = sense
    return s


class CyRKEvents:
    """Events of CyRK are Python functions, so its right-hand side is one too; the numbers of the modes are shared."""

    def __init__(self, drum, rtol):
        self.drum, self.rtol, self.s = drum, rtol, None
        self.events = [self.event(c, kind) for c in range(len(drum.V)) for kind in range(3)]

    def rates(self, t, y):
        """y' in the present modes."""
        rates, _ = self.drum.sliding(y, self.s)
        return np.concatenate([y[2:], rates - self.drum.p.T @ (self.hold @ (self.drum.t @ rates))])

    def event(self, c, kind):
        """As in `jax_events`."""

        def value(t, y):
            if (self.s[c] == 0.0) != (kind > 0):
                return 1.0
            if kind == 0:
                return self.s[c] * (self.drum.V[c] - self.drum.t[c] @ y[2:]) + AWAY
            hold, normal = self.drum.needed(y, self.s, self.hold)
            return self.drum.static * normal[c] + (hold[c] if kind == 2 else -hold[c])

        value.terminal, value.direction = True, -1
        return value

    def __call__(self):
        """From rest to the end."""
        t, y, self.s = 0.0, np.zeros(4), np.sign(self.drum.V)
        while t < DURATION:
            self.hold = self.drum.hold_by(self.s)
            found = CyRK.pysolve_ivp(self.rates, (t, DURATION), y, "DOP853", events=self.events, rtol=self.rtol,
                                     atol=self.rtol * SCALE, max_step=1e-4)  # fmt: skip
            if not found.success:
                return np.full(2, np.nan)
            t, y = found.t[-1], np.array(found.y)[:, -1]
            for c in range(len(self.s)):
                hits = [len(found.t_events[3 * c + kind]) > 0 for kind in range(3)]
                if hits[0]:
                    self.s = self.drum.after_stop(y, self.s, c)
                elif hits[1] or hits[2]:
                    self.s = with_sense(self.s, c, 1.0 if hits[1] else -1.0)
        return y[:2]


SETTINGS = tuple((rtol,) for rtol in (1e-6, 1e-9, 1e-12))
EXACT = (
    Rival("heyoka, events", of_each(HeyokaEvents), SETTINGS),
    Rival("diffrax, events", diffrax_events, SETTINGS, takes=64),
    Rival("CyRK, events", of_each(CyRKEvents), SETTINGS[:2], takes=2),
)

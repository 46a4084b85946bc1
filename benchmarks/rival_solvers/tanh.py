"""Friction smoothed by tanh(v / width): CyRK, numbalsoda, diffrax and heyoka's batch mode."""

import os
import sys

import CyRK
import diffrax
import heyoka as hy
import jax
import jax.numpy as jnp
import numba as nb
import numbalsoda
import numpy as np
from ensembles import DURATION

from .door import MOST, SCALE, Rival, of_each, stacked
from .drum import tanh_rates


def silent(prepare):
    """numbalsoda's C writes a line for each stiff stretch to standard output."""

    def prepared(drums, setting):
        run = prepare(drums, setting)

        def silently():
            sys.stdout.flush()
            kept, nowhere = os.dup(1), os.open(os.devnull, os.O_WRONLY)
            os.dup2(nowhere, 1)
            try:
                return run()
            finally:
                os.dup2(kept, 1)
                os.close(kept)
                os.close(nowhere)

        return silently

    return prepared


@nb.cfunc(numbalsoda.lsoda_sig)
def for_numbalsoda(t, u, du, p):
    """The signature numbalsoda wants."""
    given = nb.carray(p, (4,))
    tanh_rates(nb.carray(u, (4,)), nb.carray(du, (4,)), nb.carray(p, (14 + 8 * int(given[3]),)))


def numbalsoda_tanh(solver):
    """LSODA switches between Adams and BDF by itself; DOP853 is explicit."""

    def make(drum, rtol, width):
        p, span, start = drum.flat(width), np.array([0.0, DURATION]), np.zeros(4)

        def run():
            u, success = solver(for_numbalsoda.address, start, span, p, rtol=rtol, atol=rtol * SCALE, mxstep=MOST)
            return u[-1, :2] if success else np.full(2, np.nan)

        return run

    return silent(of_each(make))


@nb.njit
def for_cyrk(dy, t, y, p):
    """The signature CyRK wants."""
    tanh_rates(y, dy, p)


def cyrk_tanh(method):
    """CyRK's C++ solvers with a compiled right-hand side and its numbers as arguments."""
    found_at = []

    def make(drum, rtol, width):
        if not found_at:
            found_at.append(CyRK.nb_diffeq_addr(for_cyrk))
        p = drum.flat(width)

        def run():
            found = CyRK.nbsolve2_ivp(found_at[0], (0.0, DURATION), np.zeros(4), method, args=p, rtol=rtol,
                                      atol=rtol * SCALE, max_num_steps=MOST)  # fmt: skip
            return np.array(found.y)[:2, -1] if found.success else np.full(2, np.nan)

        return run

    return of_each(make)


def diffrax_tanh(drums, setting):
    """Side by side by vmap, compiled by JAX as one loop."""
    rtol, width = setting

    def field(t, y, p):
        speed, normal = p["V"] - p["t"] @ y[2:], p["N0"] + p["n"] @ y[:2]
        force = (p["static"] + p["slope"] * jnp.abs(speed)) * jnp.tanh(speed / width) * normal
        return jnp.concatenate([y[2:], p["f"] - p["k"] @ y[:2] - p["c"] @ y[2:] + p["p"].T @ force])

    def one(p):
        control = diffrax.PIDController(rtol=rtol, atol=rtol * SCALE)
        return diffrax.diffeqsolve(
            diffrax.ODETerm(field), diffrax.Dopri8(), 0.0, DURATION, 1e-6, jnp.zeros(4), p, max_steps=None,
            stepsize_controller=control, saveat=diffrax.SaveAt(t1=True), adjoint=diffrax.ForwardMode(),
        ).ys[0, :2]  # fmt: skip

    compiled, p = jax.jit(jax.vmap(one)), stacked(drums)
    compiled(p)
    return lambda: np.asarray(compiled(p))


def heyoka_tanh(drums, setting):
    """Taylor methods in batch; |v| tanh is written without the corner, for Taylor series want analytic functions."""
    rtol, width = setting
    lanes = hy.recommended_simd_size()
    numbers = np.array([drum.flat(1.0)[4:] for drum in drums])
    moving = np.flatnonzero(np.ptp(numbers, axis=0) > 0)
    terms = [hy.par[list(moving).index(k)] if k in moving else float(numbers[0, k]) for k in range(numbers.shape[1])]
    q, v = hy.make_vars("q0", "q1"), hy.make_vars("v0", "v1")
    rows = [(terms[i], terms[2 + 2 * i : 4 + 2 * i], terms[6 + 2 * i : 8 + 2 * i]) for i in range(2)]
    a = [f - k[0] * q[0] - k[1] * q[1] - b[0] * v[0] - b[1] * v[1] for f, k, b in rows]
    for c in range(len(drums[0].V)):
        p, t, n = (terms[10 + 8 * c + 2 * k : 12 + 8 * c + 2 * k] for k in range(3))
        speed = terms[17 + 8 * c] - t[0] * v[0] - t[1] * v[1]
        normal = terms[16 + 8 * c] + n[0] * q[0] + n[1] * q[1]
        sense = hy.tanh(speed / width)
        force = (drums[0].static + drums[0].slope * sense * speed) * sense * normal
        a = [a[i] + p[i] * force for i in range(2)]
    rows = [(q[0], v[0]), (q[1], v[1]), (v[0], a[0]), (v[1], a[1])]
    ta = hy.taylor_adaptive_batch(rows, np.zeros((4, lanes)), tol=rtol)

    def run():
        out = []
        for first in range(0, len(drums), lanes):
            ta.set_time(0.0)
            ta.state[:], ta.pars[:] = 0.0, numbers[first : first + lanes, moving].T
            ta.propagate_until([DURATION] * lanes, max_steps=MOST)
            out.append(ta.state[:2].T.copy())
        return np.concatenate(out)

    return run


WIDTHS, TOLERANCES = (1e-3, 1e-4, 1e-5, 1e-6), (1e-6, 1e-9)
SETTINGS = tuple((rtol, width) for width in WIDTHS for rtol in TOLERANCES)
SMOOTHED = (
    Rival("heyoka batch, tanh", heyoka_tanh, SETTINGS),
    Rival("CyRK DOP853, tanh", cyrk_tanh("DOP853"), SETTINGS),
    Rival("CyRK LSODA, tanh", cyrk_tanh("LSODA"), SETTINGS),
    Rival("numbalsoda LSODA, tanh", numbalsoda_tanh(numbalsoda.lsoda), SETTINGS),
    Rival("numbalsoda DOP853, tanh", numbalsoda_tanh(numbalsoda.dop853), SETTINGS),
    Rival("diffrax Dopri8, tanh", diffrax_tanh, SETTINGS[:6], takes=64),
)

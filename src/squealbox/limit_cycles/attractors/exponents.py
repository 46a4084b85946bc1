"""Lyapunov exponents of motions with stick and slip.

They come from the derivative of the flow, saltation matrices included, re-orthonormalised by QR: sum log|R_ii| / time.
A sticking phase forgets a direction; its exponent is minus infinity. On a cycle of period T and Floquet multipliers m_i
they are log|m_i| / T.
Sources: Benettin, Galgani, Giorgilli and Strelcyn 1980, Meccanica 15, 9-30; Mueller 1995, Chaos, Solitons and
Fractals 5, 1671-1681 (jumps at events).
"""

from typing import Any

import numpy as np

from squealbox.arguments import public
from squealbox.limit_cycles.cycles.field import Field
from squealbox.limit_cycles.cycles.starting import state_of
from squealbox.limit_cycles.cycles.variation import quick_flight
from squealbox.start import StartLike
from squealbox.system import DesignOrSystem, as_system

LOST = 1e-13  # growth over a span below which a direction is forgotten


@public()
def lyapunov_exponents(
    design_or_system: DesignOrSystem,
    start: StartLike,
    span: float,
    spans: int,
    *,
    aligned: int = 0,
    rtol: float = 1e-11,
    history: bool = False,
) -> Any:
    """Lyapunov exponents [1/s] in falling order, shape (2n,), over `spans` stretches of `span` seconds from (q, qd).

    Parameters
    ----------
    design_or_system : with constant loads and speeds; a harmonic drive is one more degree of freedom without damping,
        coupled one way, which adds two exponents 0
    start : on the attractor, as for `simulate`: leave transients behind first
    span : [s] between two orthonormalisations, such as a period; spans : how many
    aligned : spans run before, uncounted, in which the directions find their order
    rtol : relative tolerance of the integration [-]
    history : return the estimates after each span, shape (spans, 2n), which tell whether they have converged

    -inf where sticking forgets a direction. Accuracy: statistical, about 1/(spans span) for regular motions, slower,
    as 1/sqrt, for chaotic ones; on a cycle with span = period, and once aligned, log|multiplier|/T to 1e-8.
    NaN when a run fails. Source: as this module.

    >>> from squealbox import Contact, Coulomb, System
    >>> belt = Contact(n=[0.0], d=[1.0], t=[1.0], N0=1.0, V=0.1, law=Coulomb(0.4, 0.25))
    >>> block = System([[1.0]], [[0.0]], [[1.0]], 0.0, (belt,))
    >>> bool(abs(lyapunov_exponents(block, ([0.4], [0.0999]), 7.317597861, 40)[0]) < 0.02)
    True
    """
    field = Field(as_system(design_or_system))
    x = state_of(field, start)
    frame = field.beside
    total, still = np.zeros(frame.shape[1]), np.zeros(x.size - frame.shape[1])  # of a free common motion: exactly 0
    seen = np.full((spans, x.size), np.nan)
    for k in range(-aligned, spans):
        total = np.zeros(frame.shape[1]) if k == 0 else total
        flown = quick_flight(field, x, span, rtol)
        if not flown.outcome.ok:
            return seen if history else np.full(x.size, np.nan)
        x = flown.x
        frame, total = _grown(flown.phi * (field.scale[:, None] / field.scale) @ frame, total)
        if k >= 0:
            seen[k] = np.sort(np.concatenate([total / (span * (k + 1)), still]))[::-1]
    return seen if history else seen[-1]


def _grown(moved: np.ndarray, total: np.ndarray) -> tuple[Any, Any]:
    """The frame orthonormal again, and the sums of logarithms; directions that were forgotten come last.

    A column that falls into the span of those before it grows no more. Left in its place, the arbitrary direction that
    QR puts there would take the growth of a later column, and that of a forgotten direction would be counted twice.
    """
    size = np.abs(np.diag(np.linalg.qr(moved)[1]))
    order = np.argsort(size <= LOST, kind="stable")
    frame, growth = np.linalg.qr(moved[:, order])
    size = np.abs(np.diag(growth))
    with np.errstate(divide="ignore"):
        return frame, total[order] + np.where(size > LOST, np.log(size), -np.inf)

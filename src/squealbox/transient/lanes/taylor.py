"""What a Taylor step does with its series in all lanes: their growth, and how far they reach."""

from typing import Any

from squealbox.compiled import Lanes, Truth, minimum, where
from squealbox.transient.lanes.rough import rough_exp, rough_log
from squealbox.transient.lanes.series import Series, above, at, plus_product, times

FINITE = 1e300
SHARE = 0.1  # of the tolerance that each of the last two terms may take
FAR, HIDDEN, SEEN, FALL = 27.0, 19.0, 6.0, 0.7  # speeds over the width of a tanh, and the share to which one may fall


def grow(
    q: tuple[Any, ...], v: tuple[Any, ...], grown: tuple[Any, ...], a: tuple[Any, ...], unit: Lanes, order: int
) -> None:
    """Coefficients of q to order + 1 and of v to `order` from q' = v, v' = a, which asks for those before.

    `grown` are the velocities of rows with mass, a their accelerations; those of other rows follow from the state.
    """
    for k in range(order + 1):
        share = unit * (1.0 / (k + 1))
        for displacement, velocity in zip(q, v, strict=True):
            displacement.known.append(times(at(velocity, k), share))
        for velocity, acceleration in zip(grown, a, strict=True) if k < order else ():
            velocity.known.append(times(at(acceleration, k), share))
    for series in (*q, *grown):  # polynomials from here on, whose products have twice as many terms
        series.rule = lambda k: None


def reach(v: tuple[Any, ...], sizes: tuple[Any, ...], unit: Lanes, order: int) -> tuple[Lanes, Truth]:
    """(the longest step at which each of the last two terms of v is small enough, whether all is finite).

    `sizes` are the tolerances of displacements [m]; unit times a velocity is one.
    """
    reaches, fine = [], None
    for k in (order - 1, order):
        total: Any = None
        for velocity, size in zip(v, sizes, strict=True):
            term = times(at(velocity, k), unit / size)
            total = plus_product(total, term, term)
        total = 0.0 * unit if total is None else total * (1.0 / (SHARE * SHARE * len(v)))
        reaches.append(rough_exp(-0.5 / k * rough_log(total + 1e-300)))
        fine = total < FINITE if fine is None else fine & (total < FINITE)
    assert fine is not None
    return minimum(*reaches), fine


def surely_slips(s: Lanes, speed: Any, x: Lanes, order: int) -> Truth:
    """Whether a contact slips and the terms of its speed, all taken against it, do not bring it to zero."""
    left: Any = None
    for k in range(order, 0, -1):
        term = at(speed, k)
        left = plus_product(None if term is None else abs(term), left, x)
    return (s * s > 0.5) & (s * at(speed, 0) > (0.0 if left is None else left * x))


def ready(order: int, *series: Any) -> None:
    """Let all coefficients be computed here: inside a branch they would be lost to what follows it."""
    for each in series:
        at(each, order)


def ends_near_zero(speed: Any, width: Lanes) -> None:
    """End a step where a speed has come so near to zero that tanh(v/width) begins to turn.

    tanh leaves 1 by 2 exp(-2 v/width), at 19 widths below the round-off of a series from farther out; one from nearer
    sees what it meets while the speed falls to no less than 0.7 of what it was.
    """
    if not isinstance(speed, Series):
        return
    size, sense = abs(speed[0]), where(speed[0] < 0.0, -1.0, 1.0)
    least = where(size > FAR * width, HIDDEN * width, FALL * size)
    above(speed * sense, where(size > SEEN * width, least, -FINITE))

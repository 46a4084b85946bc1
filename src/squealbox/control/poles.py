"""Poles of loops with delay, x' = A x + sum_a B_a H_a x(t - T_a): all to the right of a line, and that they are all.

Every pole solves det D(s) = 0, D(s) = s I - A - sum_a B_a H_a exp(-s T_a). A pseudospectral discretisation (Breda,
Maset and Vermiglio 2005, SIAM J. Sci. Comput. 27, 482-495) gives the poles to the right of a line nearly, Newton's
method on s and its vector exactly; the argument principle counts how many there must be,

    (1/2 pi i) contour of (det D)'/det D ds

around the rectangle that holds every pole to the right of the line: |s| <= |A| + sum |B_a H_a| exp(-line T_a). Only its
side on the line is walked; beyond that reach det D = s^d det(I - X/s) with |X/s| < 1, whose argument is known.
"""

from typing import Any

import numpy as np

from squealbox.loops.rows import chebyshev

FIRST_ORDER, LAST_ORDER = 16, 72  # Chebyshev points of the discretisation
LARGEST = 160  # rows of a discretisation, unless `FIRST_ORDER` points make more
GRIDS = (0.6, 0.25, 0.1)  # steps of the grid, over the longest delay, on which poles are looked for that it missed
SAME = 1e-8  # relative distance below which two refined poles are one
MOST_POINTS = 400_000  # of a contour


class Late:
    """x' = A x + sum_k A_k x(t - T_k) with time scaled, each T_k > 0."""

    def __init__(self, A: Any, parts: list[tuple[float, Any]]) -> None:
        from scipy.linalg import matrix_balance

        size = np.abs(A) + sum((np.abs(part) for _, part in parts), np.zeros_like(A))
        _, (scale, _) = matrix_balance(size, permute=False, separate=True)
        self.A = A * scale / scale[:, None]
        self.parts = [(delay, part * scale / scale[:, None]) for delay, part in parts]
        self.own, self.sizes = _norm(self.A), [_norm(part) for _, part in self.parts]

    def matrix(self, s: Any) -> Any:
        """D(s) for s (...), shape (..., d, d)."""
        s = np.asarray(s, dtype=complex)[..., None, None]
        late = (part * np.exp(np.minimum(-s.real * delay, 600.0) - 1j * s.imag * delay) for delay, part in self.parts)
        return s * np.eye(len(self.A)) - self.A - sum(late)

    def slope(self, s: Any) -> Any:
        """dD/ds."""
        s = np.asarray(s, dtype=complex)[..., None, None]
        late = (
            delay * part * np.exp(np.minimum(-s.real * delay, 600.0) - 1j * s.imag * delay)
            for delay, part in self.parts
        )
        return np.eye(len(self.A)) + sum(late)

    def reach(self, line: Any) -> Any:
        """No pole with Re s >= line is farther from 0 than this."""
        late = (size * np.exp(-line * delay) for size, (delay, _) in zip(self.sizes, self.parts, strict=True))
        return self.own + sum(late)


def late_poles(late: Late, line: float) -> tuple[Any, int]:
    """All poles with Re s > line, by falling growth, and the number the argument principle gives."""
    reach = late.reach(line)
    longest = max(delay for delay, _ in late.parts)
    found = refined(late, discretised(late, reach), line)
    counted = count(late, _beside(line, found, reach), reach)
    for step in GRIDS:
        if len(found) == counted:
            break
        found = refined(late, np.concatenate([found, in_cells(late, line, step / longest)]), line)
    return found, counted


def in_cells(late: Late, line: float, step: float) -> Any:
    """Middles of the cells of a grid, Im s >= 0, around which the argument of det D turns."""
    right = line
    for _ in range(60):  # the largest x with x <= |A| + sum |A_k| exp(-x T_k)
        right = 0.5 * (right + late.reach(right)) if late.reach(right) > right else right
    height = late.reach(line)
    step = max(step, np.sqrt((right - line + 2.0 * step) * height / MOST_POINTS))
    x = np.arange(line - step, right + 2.0 * step, step)
    y = np.arange(-0.5 * step, height + 2.0 * step, step)
    reach = late.reach(x - 2.0 * step) + 2.0 * step
    inside = np.abs(x[:, None] + 1j * y) <= reach[:, None]
    phase = np.ones(inside.shape, dtype=complex)
    phase[inside] = _phase(late, (x[:, None] + 1j * y)[inside])
    across, up = np.angle(phase[1:] / phase[:-1]), np.angle(phase[:, 1:] / phase[:, :-1])
    turns = across[:, :-1] + up[1:] - across[:, 1:] - up[:-1]
    i, k = np.nonzero((np.abs(turns) > np.pi) & inside[:-1, :-1] & inside[1:, 1:])
    return x[i] + 0.5 * step + 1j * np.maximum(y[k] + 0.5 * step, 0.0)


def discretised(late: Late, reach: float) -> Any:
    """Eigenvalues with what is under way in each delay on Chebyshev points: x' = A x + sum U w(-T), w(0) = V x."""
    split = []
    for delay, part in late.parts:
        left, sizes, right = np.linalg.svd(part)
        kept = sizes > 1e-14 * sizes[0] if sizes.size else sizes > 0.0
        split.append((delay, left[:, kept] * sizes[kept], right[kept]))
    d, width = len(late.A), sum(len(right) for _, _, right in split)
    most = max(FIRST_ORDER, min(LAST_ORDER, LARGEST // max(width, 1)))
    orders = [int(np.clip(FIRST_ORDER + 0.7 * reach * delay, FIRST_ORDER, most)) for delay, _, _ in split]
    size = d + sum(order * len(right) for order, (_, _, right) in zip(orders, split, strict=True))
    big, at = np.zeros((size, size)), d
    big[:d, :d] = late.A
    for order, (delay, left, right) in zip(orders, split, strict=True):
        derivative, rank = chebyshev(order)[1] * 2.0 / delay, len(right)
        line = slice(at, at + order * rank)
        big[line, line] = np.kron(derivative[1:, 1:], np.eye(rank))
        big[line, :d] = np.kron(derivative[1:, :1], right)
        at += order * rank
        big[:d, at - rank : at] = left
    values: Any = np.linalg.eigvals(big)
    return values


def refined(late: Late, guesses: Any, line: float) -> Any:
    """The poles behind the guesses with Re s > line, by Newton's method on s and its vector, each once."""
    scale = late.reach(line)
    near = guesses[(guesses.real > line - 0.1 * abs(line) - 0.02 * scale) & (np.abs(guesses) < 1.2 * scale)]
    near = near[near.imag >= -1e-9 * scale]
    kept: list[complex] = []
    for value in sorted(newton(late, near), key=lambda each: -each.real) if len(near) else []:
        value = complex(value) if abs(value.imag) > 1e-11 * abs(value) + 1e-13 * scale else complex(value.real)
        value = complex(value.real, abs(value.imag))
        if value.real > line and all(abs(value - other) > SAME * max(abs(value), 1e-3 * scale) for other in kept):
            kept.append(value)
    both = [*kept, *(value.conjugate() for value in kept if value.imag > 0.0)]
    return np.array(sorted(both, key=lambda s: (-s.real, -s.imag)), dtype=complex)


def newton(late: Late, guesses: Any, most: int = 16) -> Any:
    """The poles near the guesses (k,): Newton's method on D(s) v = 0, c.v = 1; without those that do not converge."""
    s = np.array(guesses, dtype=complex)
    d, scale = len(late.A), late.reach(0.0)
    _, _, right = np.linalg.svd(late.matrix(s))
    v = right[:, -1].conj()
    c, last = v.conj(), np.full(len(s), np.inf)
    for _ in range(most):
        matrix = late.matrix(s)
        big = np.zeros((len(s), d + 1, d + 1), dtype=complex)
        big[:, :d, :d], big[:, d, :d] = matrix, c
        big[:, :d, d] = np.einsum("kij,kj->ki", late.slope(s), v)
        defect = np.concatenate(
            [np.einsum("kij,kj->ki", matrix, v), np.sum(c * v, axis=1, keepdims=True) - 1.0], axis=1
        )
        usable = np.all(np.isfinite(big), axis=(1, 2)) & np.all(np.isfinite(defect), axis=1)
        s, v, c, last, big, defect = (each[usable] for each in (s, v, c, last, big, defect))
        try:
            step = np.linalg.solve(big, -defect[..., None])[..., 0]
        except np.linalg.LinAlgError:  # one of them is singular: it is left out
            usable = np.linalg.cond(big) < 1e15
            s, v, c, last, big, defect = (each[usable] for each in (s, v, c, last, big, defect))
            step = np.linalg.solve(big, -defect[..., None])[..., 0]
        v, s, last = v + step[:, :d], s + step[:, d], np.abs(step[:, d])
        if len(s) == 0 or np.all(last <= 4e-16 * np.abs(s) + 1e-16 * scale):
            break
    return s[last < 1e-11 * np.abs(s) + 1e-12 * scale]


def count(late: Late, line: float, reach: float) -> int:
    """Number of poles with Re s > line, by the argument of det D along the line up to beyond their reach."""
    top = 1.01 * reach + 1e-300
    corner = complex(line, top)
    ratios = np.linalg.eigvals(np.eye(len(late.A)) - late.matrix(corner) / corner)
    around = len(late.A) * np.angle(corner) + float(np.sum(np.angle(1.0 - ratios)))
    longest = max(delay for delay, _ in late.parts)
    points = int(np.clip(64 + 8.0 * top * longest, 64, MOST_POINTS // 8))
    path = line + 1j * np.linspace(top, 0.0, points)
    phase = _phase(late, path)
    for _ in range(40):
        turns = np.angle(phase[1:] / phase[:-1])
        wide = np.flatnonzero(np.abs(turns) > 1.0)
        if wide.size == 0 or path.size > MOST_POINTS:
            break
        middle = 0.5 * (path[wide] + path[wide + 1])
        path, phase = np.insert(path, wide + 1, middle), np.insert(phase, wide + 1, _phase(late, middle))
    return int(np.rint((around + np.sum(np.angle(phase[1:] / phase[:-1]))) / np.pi))


def _phase(late: Late, s: Any) -> Any:
    return np.linalg.slogdet(late.matrix(s))[0]


def _beside(line: float, poles: Any, reach: float) -> float:
    """A line a little to the left of `line` when a pole lies on it, else the line."""
    return line if not len(poles) or np.min(np.abs(poles.real - line)) > 1e-6 * reach else line - 2e-6 * reach


def _norm(matrix: Any) -> float:
    return float(np.linalg.norm(matrix, 2))

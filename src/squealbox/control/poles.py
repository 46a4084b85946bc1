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
from numpy.typing import ArrayLike

from squealbox.loops import chebyshev

FIRST_ORDER, LAST_ORDER = 16, 72  # Chebyshev points of the discretisation
LARGEST = 160  # rows of a discretisation, unless `FIRST_ORDER` points make more
GRIDS = (0.6, 0.25, 0.1)  # steps of the grid, over the longest delay, on which poles are looked for that it missed
SAME = 1e-8  # relative distance below which two refined poles are one
MOST_POINTS = 400_000  # of a contour
WELL = 1e6  # condition of the eigenvectors of A up to which its modes tell the phase of det D


class Late:
    """x' = A x + sum_k A_k x(t - T_k) with time scaled, each T_k > 0."""

    def __init__(self, A: np.ndarray, parts: list[tuple[float, Any]]) -> None:
        from scipy.linalg import matrix_balance

        size = np.abs(A) + sum((np.abs(part) for _, part in parts), np.zeros_like(A))
        _, (scale, _) = matrix_balance(size, permute=False, separate=True)
        self.A = A * scale / scale[:, None]
        self.parts = [(delay, part * scale / scale[:, None]) for delay, part in parts]
        self.own, self.sizes = _norm(self.A), [_norm(part) for _, part in self.parts]
        self.split = [(delay, *_halves(part)) for delay, part in self.parts]
        values, vectors = np.linalg.eig(self.A)
        heard = any(len(right) for *_, right in self.split)  # else no loop has a gain
        self.values, self.known = values, heard and bool(np.linalg.cond(vectors) < WELL)
        if self.known:
            into = np.linalg.solve(vectors, np.hstack([left for _, left, _ in self.split]))
            out = np.vstack([right for _, _, right in self.split]) @ vectors
            self.way = (out.T[:, :, None] * into[:, None, :]).reshape(len(values), -1)  # V (sI - A)^-1 U by modes of A

    def matrix(self, s: ArrayLike) -> Any:
        """D(s) for s (...), shape (..., d, d)."""
        s = np.asarray(s, dtype=complex)[..., None, None]
        late = (part * np.exp(np.minimum(-s.real * delay, 600.0) - 1j * s.imag * delay) for delay, part in self.parts)
        return s * np.eye(len(self.A)) - self.A - sum(late)

    def slope(self, s: ArrayLike) -> Any:
        """dD/ds."""
        s = np.asarray(s, dtype=complex)[..., None, None]
        late = (
            delay * part * np.exp(np.minimum(-s.real * delay, 600.0) - 1j * s.imag * delay)
            for delay, part in self.parts
        )
        return np.eye(len(self.A)) + sum(late)

    def phase(self, s: np.ndarray) -> Any:
        """det D/|det D| for s (k,), by det D = det(sI - A) det(I - V (sI - A)^-1 U e(s)) with what is late as U e V."""
        if not self.known:
            return np.linalg.slogdet(self.matrix(s))[0]
        gap = s[:, None] - self.values
        size = round(np.sqrt(self.way.shape[1]))
        e = np.concatenate([np.full(len(right), delay) for delay, _, right in self.split])
        with np.errstate(all="ignore"):  # at an eigenvalue of A, and where exp is beyond all numbers: the other way
            small = np.eye(size) - ((1.0 / gap) @ self.way).reshape(-1, size, size) * np.exp(-s[:, None] * e)[:, None]
            small = small[:, 0, 0] if size == 1 else np.linalg.det(small)
            found = np.prod(gap / np.abs(gap), axis=1) * small / np.abs(small)
        lost = ~np.isfinite(found)
        found[lost] = np.linalg.slogdet(self.matrix(s[lost]))[0]
        return found

    def reach(self, line: float | np.ndarray) -> Any:
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
    height = late.reach(line)
    low, right = line, height
    for _ in range(30):  # the largest x with x <= |A| + sum |A_k| exp(-x T_k)
        middle = 0.5 * (low + right)
        low, right = (middle, right) if late.reach(middle) > middle else (low, middle)
    step = max(step, np.sqrt((right - line + 2.0 * step) * height / MOST_POINTS))
    x = np.arange(line - step, right + 2.0 * step, step)
    y = np.arange(-0.5 * step, height + 2.0 * step, step)
    reach = late.reach(x - 2.0 * step) + 2.0 * step
    inside = np.abs(x[:, None] + 1j * y) <= reach[:, None]
    phase = np.ones(inside.shape, dtype=complex)
    phase[inside] = late.phase((x[:, None] + 1j * y)[inside])
    across, up = np.angle(phase[1:] / phase[:-1]), np.angle(phase[:, 1:] / phase[:, :-1])
    turns = across[:, :-1] + up[1:] - across[:, 1:] - up[:-1]
    i, k = np.nonzero((np.abs(turns) > np.pi) & inside[:-1, :-1] & inside[1:, 1:])
    return x[i] + 0.5 * step + 1j * np.maximum(y[k] + 0.5 * step, 0.0)


def discretised(late: Late, reach: float) -> Any:
    """Eigenvalues with what is under way in each delay on Chebyshev points: x' = A x + sum U w(-T), w(0) = V x."""
    split = late.split
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


def refined(late: Late, guesses: np.ndarray, line: float) -> Any:
    """The poles behind the guesses with Re s > line, by Newton's method on s and its vector, each once."""
    scale = late.reach(line)
    near = guesses[(guesses.real > line - 0.1 * abs(line) - 0.02 * scale) & (np.abs(guesses) < 1.2 * scale)]
    near = near[near.imag >= -1e-9 * scale]
    values = newton(late, near) if len(near) else near
    values = np.where(np.abs(values.imag) > 1e-11 * np.abs(values) + 1e-13 * scale, values, values.real + 0j)
    values = values.real + 1j * np.abs(values.imag)
    values = values[values.real > line]
    values = values[np.argsort(-values.real)]
    alike = np.abs(values[:, None] - values) <= SAME * np.maximum(np.abs(values), 1e-3 * scale)[:, None]
    kept = values[~np.any(np.tril(alike, -1), axis=1)]
    both = np.concatenate([kept, kept[kept.imag > 0.0].conj()])
    return both[np.lexsort((-both.imag, -both.real))]


def newton(late: Late, guesses: ArrayLike, most: int = 16) -> Any:
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
    phase = late.phase(path)
    for _ in range(40):
        turns = np.angle(phase[1:] / phase[:-1])
        wide = np.flatnonzero(np.abs(turns) > 1.0)
        if wide.size == 0 or path.size > MOST_POINTS:
            break
        middle = 0.5 * (path[wide] + path[wide + 1])
        path, phase = np.insert(path, wide + 1, middle), np.insert(phase, wide + 1, late.phase(middle))
    return int(np.rint((around + np.sum(np.angle(phase[1:] / phase[:-1]))) / np.pi))


def _halves(part: np.ndarray) -> tuple[Any, Any]:
    """U and V of part = U V, of as few columns as it needs."""
    left, sizes, right = np.linalg.svd(part)
    kept = sizes > 1e-14 * sizes[0]
    return left[:, kept] * sizes[kept], right[kept]


def _beside(line: float, poles: np.ndarray, reach: float) -> float:
    """A line a little to the left of `line` when a pole lies on it, else the line."""
    return line if not len(poles) or np.min(np.abs(poles.real - line)) > 1e-6 * reach else line - 2e-6 * reach


def _norm(matrix: np.ndarray) -> float:
    return float(np.linalg.norm(matrix, 2))

"""How far is a stable loop from the edge? Margins of gain, phase, delay and sampling.

With loop a broken and all others closed, a factor k on its force and a further delay T put a pole on s = i w where

    k exp(-i w T) L(i w) = 1,     L(s) = exp(-s T_a) H_a (s I - A')^-1 B_a

so k and T follow from the frequencies where L is real and positive, and where |L| = 1. The first are real eigenvalues
of the polynomial pencil Im L = 0, the second imaginary eigenvalues of a Hamiltonian matrix; with a delay in the loop
they are looked for on a grid and refined. A delay common to all loops puts z = exp(-i w T) on the unit circle in

    det[ z^2 I (x) A1 + z (A0 (+) A0) + A1 (x) I ] = 0        A0 = A, A1 = B H   (Louisell 2001, IEEE TAC 46)

whose order is twice the square of that of A. For larger plants the frequencies are those where an eigenvalue of the
small H (i w - A)^-1 B has the size 1, looked for on a grid that is dense at every resonance, open and closed.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from squealbox.control.plants import Plant

LARGEST_PRODUCT = 16  # states up to which the Kronecker products are built: 512 rows, at 134 they would take 10 GB
BESIDE = 41  # frequencies looked at beside each resonance
GRID = 4001  # frequencies looked at for a loop with a delay of its own


def unit_gain(A: np.ndarray, B: np.ndarray, H: np.ndarray) -> Any:
    """Angular frequencies > 0 at which |H (i w - A)^-1 B| = 1, one input and output."""
    big = np.block([[A, np.outer(B, B)], [-np.outer(H, H), -A.T]])
    values = np.linalg.eigvals(big)
    size = np.max(np.abs(values), initial=0.0)
    near = np.abs(values[(np.abs(values.real) < 1e-5 * size) & (values.imag > 0.0)].imag)

    def gain(w: float) -> float:
        return float(np.log(abs(_loop(A, B, H, w))))

    return _sharpened(gain, near)


def real_gain(A: np.ndarray, B: np.ndarray, H: np.ndarray) -> Any:
    """Angular frequencies > 0 at which H (i w - A)^-1 B is real: -A^-1 turns Im L into a pencil in w^2."""
    # Im L = -w H (w^2 + A^2)^-1 B: zeros of the system (-A^2, B, H) in w^2
    d = len(A)
    pencil = np.block([[-A @ A, B[:, None]], [H[None], np.zeros((1, 1))]])
    right = np.zeros((d + 1, d + 1))
    right[:d, :d] = np.eye(d)
    from scipy.linalg import eigvals

    values = eigvals(pencil, right)
    values = values[np.isfinite(values)]
    size = np.max(np.abs(A)) ** 2
    squares = values.real[(np.abs(values.imag) < 1e-7 * np.abs(values)) & (values.real > 1e-12 * size)]

    def imaginary(w: float) -> float:
        return float(_loop(A, B, H, w).imag)

    return _sharpened(imaginary, np.sqrt(squares))


def gain_margin(plant: Plant, a: int) -> tuple[float, float]:
    """Between which factors the gain of loop a may lie (0 and inf where it has no bound)."""
    A, B, H = broken(plant, a)
    w = real_gain(A, B, H) if plant.delay[a] == 0.0 else _grid_roots(plant, a, A, B, H)
    values = np.array([_loop(A, B, H, x, float(plant.delay[a])) for x in w])
    still = _loop(A, B, H, 0.0) if np.linalg.cond(A) < 1e15 else np.nan
    factors = np.array([1.0 / v.real for v in np.append(values, still) if np.isfinite(v) and v.real > 0.0])
    return float(max(factors[factors < 1.0], default=0.0)), float(min(factors[factors > 1.0], default=np.inf))


def phase_margin(plant: Plant, a: int) -> float:
    """The least angle [rad] by which loop a may turn; pi where its gain is nowhere 1."""
    A, B, H = broken(plant, a)
    w = unit_gain(A, B, H)
    return float(min((abs(np.angle(_loop(A, B, H, x, float(plant.delay[a])))) for x in w), default=np.pi))


def delay_margin(plant: Plant) -> float:
    """The further delay [s] of all loops at which the stable loop loses its stability; inf where none does."""
    one = len(plant.loops) == 1
    if one:
        w = unit_gain(plant.A, plant.B[:, 0], plant.H[0])
        delays = []
        for x in w:
            angle = np.angle(_loop(plant.A, plant.B[:, 0], plant.H[0], x, float(plant.delay[0])))
            delays.append((angle % (2.0 * np.pi)) / x)
        return float(min(delays, default=np.inf))
    if np.ptp(plant.delay) > 0.0:
        return _common_by_grid(plant)
    exact = len(plant.A) <= LARGEST_PRODUCT
    crossings = _crossings(plant.A, plant.B @ plant.H) if exact else _crossings_by_grid(plant)
    own = float(plant.delay[0])
    later = [
        w_t - own for w, t in crossings for w_t in (t + 2.0 * np.pi / w * np.arange(64)) if w_t > own * (1 + 1e-12)
    ]
    return float(min(later, default=np.inf))


def _crossings(A0: np.ndarray, A1: np.ndarray) -> list[tuple[float, float]]:
    """(w, T) with a pole i w of x' = A0 x + A1 x(t - T), each T the least that is not negative."""
    size = float(np.max(np.abs(np.linalg.eigvals(A0)))) or 1.0
    from scipy.linalg import eig, matrix_balance

    _, (scale, _) = matrix_balance(np.abs(A0) + np.abs(A1), permute=False, separate=True)
    A0, A1 = (part * scale / scale[:, None] / size for part in (A0, A1))
    d, one = len(A0), np.eye(len(A0))
    square, linear, constant = np.kron(A1, one), np.kron(A0, one) + np.kron(one, A0), np.kron(one, A1)
    unit, zero = np.eye(d * d), np.zeros((d * d, d * d))
    left = np.block([[zero, unit], [-constant, -linear]])
    right = np.block([[unit, zero], [zero, square]])
    values = eig(left, right, right=False)
    values = values[np.isfinite(values)]
    found: list[tuple[float, float]] = []
    for z in values[np.abs(np.abs(values) - 1.0) < 1e-4]:
        for s in np.linalg.eigvals(A0 + z / abs(z) * A1):
            if s.imag > 1e-9 and abs(s.real) < 1e-3 * max(abs(s), 1.0):
                pair = _polished(A0, A1, float(s.imag), float(-np.angle(z)))
                if pair is not None and all(abs(pair[0] - w) > 1e-9 or abs(pair[1] - p) > 1e-8 for w, p in found):
                    found.append(pair)
    return [(w * size, (phase % (2.0 * np.pi)) / (w * size)) for w, phase in found]


def _crossings_by_grid(plant: Plant) -> list[tuple[float, float]]:
    """The same of a large plant: where the sorted |eigenvalues| of H (i w - A)^-1 B pass 1, dense at each resonance."""
    from scipy.linalg import matrix_balance
    from scipy.optimize import brentq

    poles = np.concatenate([np.linalg.eigvals(plant.A), np.linalg.eigvals(plant.closed)])
    poles = poles[poles.imag > 0.0]
    size = float(np.max(np.abs(poles), initial=0.0)) or 1.0
    about = poles.imag[:, None] + np.abs(poles.real)[:, None] * np.tan(np.linspace(-1.5, 1.5, BESIDE))
    w = np.unique(np.concatenate([about.ravel(), np.geomspace(1e-4 * size, 30.0 * size, GRID)]))
    w = w[w > 0.0]
    _, (scale, _) = matrix_balance(np.abs(plant.A) + np.abs(plant.B @ plant.H), permute=False, separate=True)
    A, B, H = plant.A * scale / scale[:, None] / size, plant.B / scale[:, None] / size, plant.H * scale

    own, shapes = np.linalg.eig(A)
    out, into = H @ shapes, np.linalg.solve(shapes, B.astype(complex))  # near a double pole a little off: a guess

    def gains(x: ArrayLike) -> Any:
        values = np.linalg.eigvals((out / (1j * np.asarray(x)[..., None, None] - own)) @ into)
        return np.take_along_axis(values, np.argsort(np.abs(values), axis=-1), axis=-1)

    logs = np.log(np.maximum(np.abs(gains(w / size)), 1e-300))
    found: list[tuple[float, float]] = []
    for i, j in zip(*np.nonzero(np.sign(logs[1:]) != np.sign(logs[:-1])), strict=True):
        root = float(brentq(_logarithm, w[i] / size, w[i + 1] / size, args=(gains, j), xtol=1e-15))
        pair = _polished(A, B @ H, root, float(np.angle(gains(root)[j])))
        if pair is not None and all(abs(pair[0] - x) > 1e-9 or abs(pair[1] - p) > 1e-8 for x, p in found):
            found.append(pair)
    return [(x * size, phase / (x * size)) for x, phase in found]


def _logarithm(x: float, gains: Callable[[Any], Any], place: int) -> float:
    return float(np.log(abs(gains(x)[place])))


def _polished(A0: np.ndarray, A1: np.ndarray, w: float, phase: float) -> tuple[float, float] | None:
    """Newton's method on det(i w - A0 - exp(-i phase) A1) = 0 in w and phase, with the vector."""
    d = len(A0)
    matrix = 1j * w * np.eye(d) - A0 - np.exp(-1j * phase) * A1
    v = np.linalg.svd(matrix)[2][-1].conj()
    c = v.conj()
    for _ in range(20):
        turn = np.exp(-1j * phase)
        matrix = 1j * w * np.eye(d) - A0 - turn * A1
        by_w, by_phase = 1j * v, 1j * turn * (A1 @ v)
        rows = np.zeros((2 * d + 2, 2 * d + 2))
        rows[:d, :d], rows[:d, d : 2 * d] = matrix.real, -matrix.imag
        rows[d : 2 * d, :d], rows[d : 2 * d, d : 2 * d] = matrix.imag, matrix.real
        rows[:d, -2], rows[d : 2 * d, -2] = by_w.real, by_w.imag
        rows[:d, -1], rows[d : 2 * d, -1] = by_phase.real, by_phase.imag
        rows[-2, :d], rows[-2, d : 2 * d] = c.real, -c.imag
        rows[-1, :d], rows[-1, d : 2 * d] = c.imag, c.real
        defect = matrix @ v
        norm = c @ v - 1.0
        try:
            step = np.linalg.solve(rows, -np.r_[defect.real, defect.imag, norm.real, norm.imag])
        except np.linalg.LinAlgError:
            return None
        v, w, phase = v + step[:d] + 1j * step[d : 2 * d], w + float(step[-2]), phase + float(step[-1])
        if not np.isfinite(w) or w <= 0.0:
            return None
        if abs(step[-2]) < 1e-15 * max(w, 1.0) and abs(step[-1]) < 1e-14:
            break
    return (w, phase % (2.0 * np.pi)) if abs(step[-2]) < 1e-9 * max(w, 1.0) else None


def _common_by_grid(plant: Plant) -> float:
    """The common further delay of loops with different delays, by bisection on their poles."""
    from squealbox.control.poles import Late, late_poles

    def growth(more: float) -> float:
        parts = [(float(t) + more, np.outer(plant.B[:, a], plant.H[a])) for a, t in enumerate(plant.delay)]
        late = Late(plant.A, [part for part in parts if part[0] > 0.0])
        found, _ = late_poles(late, -0.5 / max(part[0] for part in parts))
        return float(found[0].real) if len(found) else -1.0

    fastest = 2.0 * np.pi / float(np.max(np.abs(np.linalg.eigvals(plant.closed))))
    low, high = 0.0, 0.05 * fastest
    while growth(high) < 0.0:
        low, high = high, 1.25 * high
        if high > 1e4 * fastest:
            return np.inf
    from scipy.optimize import brentq

    found: float = brentq(growth, low or 1e-9 * high, high, xtol=1e-14 * high, rtol=1e-13)
    return found


def broken(plant: Plant, a: int) -> tuple[Any, Any, Any]:
    """A, B, H of loop a alone, the others closed."""
    others = [b for b in range(len(plant.loops)) if b != a]
    return plant.A + plant.B[:, others] @ plant.H[others], plant.B[:, a], plant.H[a]


def loop_gain(A: np.ndarray, B: np.ndarray, H: np.ndarray, w: ArrayLike, delay: float = 0.0) -> Any:
    """exp(-i w T) H (i w - A)^-1 B at angular frequencies w (...)."""
    w = np.asarray(w, dtype=float)
    state = np.linalg.solve(1j * w[..., None, None] * np.eye(len(A)) - A, B.astype(complex)[:, None])
    return (H @ state)[..., 0] * np.exp(-1j * w * delay)


def _loop(A: np.ndarray, B: np.ndarray, H: np.ndarray, w: float, delay: float = 0.0) -> complex:
    return complex(loop_gain(A, B, H, w, delay))


def _grid_roots(plant: Plant, a: int, A: np.ndarray, B: np.ndarray, H: np.ndarray) -> Any:
    delay = float(plant.delay[a])
    own = np.abs(np.linalg.eigvals(A))
    w = np.geomspace(1e-3 * float(np.min(own[own > 0.0], initial=1.0)), 30.0 * float(np.max(own)), GRID)
    own_w = np.sort(np.concatenate([w, np.linspace(w[0], w[-1], GRID)]))
    values = loop_gain(A, B, H, own_w, delay).imag
    places = np.flatnonzero(np.sign(values[1:]) != np.sign(values[:-1]))
    from scipy.optimize import brentq

    return np.array([brentq(lambda x: _loop(A, B, H, x, delay).imag, own_w[i], own_w[i + 1]) for i in places])


def _sharpened(function: Callable[[Any], Any], guesses: np.ndarray) -> Any:
    """The roots near the guesses, by the secant method."""
    from scipy.optimize import newton

    found: list[float] = []
    for guess in guesses:
        try:
            root = float(newton(function, guess, x1=guess * (1.0 + 1e-6), tol=1e-15 * guess, rtol=1e-15, maxiter=60))
        except RuntimeError:
            root = float(guess)
        if abs(root - guess) < 1e-3 * guess and all(abs(root - other) > 1e-9 * root for other in found):
            found.append(root)
    return np.array(found)

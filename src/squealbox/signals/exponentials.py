"""Maximum likelihood of damped or growing sinusoids in a record: a few complex numbers stand for all its samples.

    x_n = c + sum_k Re(a_k exp(lambda_k (n - r_k))) + noise,     r_k the end where component k is largest

For white noise the likelihood is least squares. The amplitudes a are linear and are solved for at every step (variable
projection, Golub and Pereyra 2003, Inverse Problems 19, R1-R26); the exponents follow by damped Gauss-Newton steps.
All inner products of columns are sums of s^j exp(nu n), which two short vectors of exponentials make exactly: with
n = b L + l, exp(nu n) = exp(nu b L) exp(nu l). So a step costs 2 sqrt(N) exponentials, not N.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

STEPS = 60
CLOSE = 1e-2  # a step this small beside the standard deviation ends the search


@dataclass(frozen=True)
class Exponentials:
    """Fitted components: `exponents` (k,) [1/sample], amplitudes at their own ends, and the covariance.

    `covariance` (2k, 2k) is that of (Re, Im) of the exponents in turn, for the variance of `residual` (n,).
    """

    exponents: Any
    amplitudes: Any
    offset: float
    covariance: Any
    residual: Any
    converged: bool

    @property
    def energies(self) -> Any:
        """Sum of squares of each component over the record, shape (k,)."""
        size = self.residual.size
        g = self.exponents.real
        power = np.array([_geometric(-2.0 * abs(x), size) for x in g])
        return 0.5 * np.abs(self.amplitudes) ** 2 * power


class FoldedSamples:
    """Samples x (n,) laid out in rows of about sqrt(n), ready for inner products with exponentials."""

    def __init__(self, x: np.ndarray) -> None:
        self.x = np.ascontiguousarray(x, dtype=float)
        self.size = int(self.x.size)
        self.width = max(int(np.sqrt(self.size)), 1)
        self.rows = -(-self.size // self.width)
        padded = np.zeros(self.rows * self.width)
        padded[: self.size] = self.x
        self.table = padded.reshape(self.rows, self.width)
        self.power = _power(self.x)
        self.powers = np.arange(self.rows + self.width, dtype=float) ** np.arange(3)[:, None]

    def projections(self, exponents: np.ndarray) -> Any:
        """Sums over n of x s^j exp(lambda (n - r)), j = 0, 1 and s = (n - r)/N: shape (k, 2)."""
        ends = self.ends(exponents)
        places = np.arange(self.width)
        fine = np.exp(np.outer(places, exponents))
        columns = np.concatenate([fine.real, fine.imag, places[:, None] * fine.real, places[:, None] * fine.imag], 1)
        count = len(exponents)
        parts = np.einsum("ij,jk->ik", self.table, columns)  # short: a threaded product waits longer than it works
        level = parts[:, :count] + 1j * parts[:, count : 2 * count]
        ramp = parts[:, 2 * count : 3 * count] + 1j * parts[:, 3 * count :]
        starts = np.arange(self.rows)[:, None] * self.width - ends
        coarse = np.exp(starts * exponents)
        zero = np.sum(coarse * level, axis=0)
        one = np.sum(coarse * (starts * level + ramp), axis=0) / self.size
        return np.stack([zero, one], axis=1)

    def ends(self, exponents: np.ndarray) -> Any:
        """The sample at which each component is largest, 0 or n - 1."""
        return np.where(np.real(exponents) > 0.0, self.size - 1, 0)

    def moments(self, exponents: np.ndarray) -> tuple[Any, Any]:
        """Sums over n of E_i s_i^p E_j s_j^q, p, q = 0, 1, and the same with conj(E_j s_j): each (2, 2, k, k).

        E_i = exp(l_i (n - r_i)) and s_i = (n - r_i)/N.
        """
        count, size = len(exponents), float(self.size)
        partner = np.concatenate([exponents, np.conj(exponents)])
        left, right = self.ends(exponents)[:, None], self.ends(partner)[None, :]
        nu = (exponents[:, None] + partner[None, :]).ravel()
        shift = (exponents[:, None] * left + partner[None, :] * right).ravel()
        whole = self.size // self.width
        starts = self.powers[:, :whole] * self.width ** np.arange(3)[:, None]
        f = np.exp(np.multiply.outer(nu, np.arange(self.width))) @ self.powers[:, : self.width].T
        c = np.exp(np.multiply.outer(nu, starts[1]) - shift[:, None]) @ starts.T
        s0, s1 = c[:, 0] * f[:, 0], c[:, 1] * f[:, 0] + c[:, 0] * f[:, 1]
        s2 = c[:, 2] * f[:, 0] + 2.0 * c[:, 1] * f[:, 1] + c[:, 0] * f[:, 2]
        rest = np.arange(whole * self.width, self.size, dtype=float)
        if rest.size:
            tail = np.exp(np.multiply.outer(nu, rest) - shift[:, None])
            tail = tail @ np.stack([np.ones(rest.size), rest, rest**2], axis=1)
            s0, s1, s2 = s0 + tail[:, 0], s1 + tail[:, 1], s2 + tail[:, 2]
        zero, one, two = (part.reshape(count, 2 * count) for part in (s0, s1, s2))
        found = np.empty((2, 2, count, 2 * count), dtype=complex)
        found[0, 0], found[0, 1], found[1, 0] = zero, (one - right * zero) / size, (one - left * zero) / size
        found[1, 1] = (two - (left + right) * one + left * right * zero) / size**2
        return found[..., :count], found[..., count:]

    def synthesised(self, exponents: np.ndarray, amplitudes: np.ndarray, offset: float) -> Any:
        """The model at every sample, shape (n,)."""
        ends = self.ends(exponents)
        fine = np.exp(np.outer(exponents, np.arange(self.width)))
        coarse = amplitudes * np.exp((np.arange(self.rows)[:, None] * self.width - ends) * exponents)
        waves = np.zeros((self.rows, self.width))
        for k in range(len(exponents)):
            waves += np.outer(coarse[:, k].real, fine[k].real) - np.outer(coarse[:, k].imag, fine[k].imag)
        return offset + waves.ravel()[: self.size]


def fit_exponentials(
    x: FoldedSamples | np.ndarray, guess: ArrayLike, *, offset: bool = True, close: float = CLOSE
) -> Exponentials:
    """The least-squares components nearest to `guess` (k,), exponents in 1/sample.

    A step of less than `close` standard deviations is the last. Without convergence the best that was reached is
    returned, and `converged` is False.
    """
    record = x if isinstance(x, FoldedSamples) else FoldedSamples(x)
    exponents = np.asarray(guess, dtype=complex).copy()
    sums = _sums(record, exponents, offset)
    linear, cost = _linear(record, exponents, sums, offset)
    damping, converged = 0.0, False
    size = record.size
    for _ in range(STEPS):
        gram, slope = _normal_equations(exponents, linear, sums, offset)
        step, deviation = _step(gram, slope, len(exponents), damping, cost / size)
        bound = np.maximum(0.5, 0.5 * np.abs(exponents.real) * size)  # of exponents x n: half a line's width
        step *= min(1.0, float(np.min(bound / np.maximum(np.abs(step), 1e-300))))
        trial = exponents + step / size
        inside = not (np.any(np.abs(trial.imag) > np.pi) or np.any(np.abs(trial.real) > 1.0))
        further = _sums(record, trial, offset) if inside else sums
        found, lower = _linear(record, trial, further, offset) if inside else (linear, np.inf)
        if np.isfinite(lower) and lower <= cost + 1e-13 * record.power:
            small = np.all(np.abs(step) <= np.maximum(close * deviation, 1e-13 * np.abs(exponents) * size))
            exponents, linear, cost, sums = trial, found, lower, further
            damping *= 0.1
            if small:
                converged = True
                break
        else:
            if damping > 1e8 or np.all(np.abs(step) <= 1e-3 * deviation):
                converged = damping <= 1e8
                break
            damping = max(10.0 * damping, 1e-3)
    amplitudes, constant = linear
    residual = record.x - record.synthesised(exponents, amplitudes, constant)
    gram, _ = _normal_equations(exponents, linear, sums, offset)
    free = max(size - gram.shape[0], 1)
    pairs = 2 * len(exponents)
    covariance = _inverse(gram)[-pairs:, -pairs:] * (_power(residual) / free / size**2)
    return Exponentials(exponents, amplitudes, float(constant), covariance, residual, converged)


def matched_energy(record: FoldedSamples, exponents: ArrayLike) -> Any:
    """Energy that one component with each of these exponents would take out of the record, shape (k,)."""
    exponents = np.asarray(exponents, dtype=complex)
    found = record.projections(exponents)[:, 0]
    power = np.array([_geometric(-2.0 * abs(g), record.size) for g in exponents.real])
    return 2.0 * np.abs(found) ** 2 / power


def prediction_filter(residual: np.ndarray, most: int) -> Any:
    """Coefficients (1, a_1, ..., a_p) that make noise white, p <= `most` by the least BIC; (1,) for white noise.

    Burg's recursion, which sees what is weak beside what is strong; 50 samples or more for each coefficient.
    """
    size = residual.size
    ahead, behind = residual[1:], residual[:-1]
    error = _power(residual) / size
    best = coefficients = np.ones(1)
    least = size * np.log(error) if error > 0.0 else -np.inf
    for order in range(1, min(most, size // 50) + 1):
        mirror = -2.0 * float(np.einsum("i,i->", ahead, behind)) / max(_power(ahead) + _power(behind), 1e-300)
        coefficients = np.append(coefficients, 0.0) + mirror * np.append(coefficients, 0.0)[::-1]
        error *= 1.0 - mirror**2
        if not error > 0.0:
            break
        score = size * np.log(error) + order * np.log(size)
        if score < least:
            best, least = coefficients, score
        ahead, behind = (ahead + mirror * behind)[1:], (behind + mirror * ahead)[:-1]
    return best


def _power(x: np.ndarray) -> float:
    return float(np.einsum("i,i->", x, x))


def _geometric(rate: float, size: int) -> float:
    """1 + e^rate + ... of `size` terms, rate <= 0."""
    return float(size) if rate == 0.0 else float(np.expm1(rate * size) / np.expm1(rate))


Sums = tuple[Any, Any, Any]  # moments of pairs, of pairs with the second conjugate, and products with the data


def _sums(record: FoldedSamples, exponents: np.ndarray, offset: bool) -> Sums:
    every = np.append(exponents, 0.0) if offset else exponents
    return (*record.moments(every), record.projections(every))


def _products(sums: Sums, scale: np.ndarray, offset: bool, derivatives: bool) -> tuple[Any, Any]:
    """Real Gram matrix of the columns and their products with the data; see `_expanded` for their order."""
    plain, mixed, data = sums
    scales = np.append(scale, 1.0) if offset else scale
    count, size = len(scale), len(scales)
    if not derivatives:
        return _expanded(plain[0, 0], mixed[0, 0], data[:, 0], count, offset)
    weights = np.ones((2, size), dtype=complex)
    weights[1] = scales
    both = weights[:, None, :, None] * plain * weights[None, :, None, :]
    crossed = weights[:, None, :, None] * mixed * np.conj(weights)[None, :, None, :]
    last = 2 * size - 1 if offset else 2 * size  # the constant has no exponent
    straight, crossed = (x.transpose(0, 2, 1, 3).reshape(2 * size, 2 * size)[:last, :last] for x in (both, crossed))
    return _expanded(straight, crossed, (weights * data.T).ravel()[:last], count, offset)


def _expanded(
    straight: np.ndarray, crossed: np.ndarray, column: np.ndarray, count: int, offset: bool
) -> tuple[Any, Any]:
    """Real parts and imaginary parts as columns of their own: Re(z c) = Re z Re c - Im z Im c."""
    size = len(column)
    gram, data = np.empty((2 * size, 2 * size)), np.empty(2 * size)
    total, rest = 0.5 * (crossed + straight), 0.5 * (crossed - straight)
    gram[0::2, 0::2], gram[1::2, 1::2] = total.real, rest.real
    gram[0::2, 1::2], gram[1::2, 0::2] = rest.imag, -total.imag
    data[0::2], data[1::2] = column.real, -column.imag
    if offset:  # the constant is real: its second column is empty
        keep = np.ones(2 * size, dtype=bool)
        keep[2 * count + 1] = False
        return gram[np.ix_(keep, keep)], data[keep]
    return gram, data


def _linear(record: FoldedSamples, exponents: np.ndarray, sums: Sums, offset: bool) -> tuple[tuple[Any, float], float]:
    """The best amplitudes and constant for these exponents, and the sum of squares left."""
    gram, data = _products(sums, np.ones(len(exponents)), offset, derivatives=False)
    found = _inverse(gram) @ data
    count = len(exponents)
    amplitudes = found[0 : 2 * count : 2] + 1j * found[1 : 2 * count : 2]
    constant = float(found[2 * count]) if offset else 0.0
    return (amplitudes, constant), record.power - float(data @ found)


def _normal_equations(exponents: np.ndarray, linear: tuple[Any, float], sums: Sums, offset: bool) -> tuple[Any, Any]:
    """J'J and J'(x - model) for amplitudes, constant and exponents (times n) together."""
    amplitudes, constant = linear
    gram, data = _products(sums, amplitudes, offset, derivatives=True)
    count = len(exponents)
    now = np.zeros(gram.shape[0])
    now[0 : 2 * count : 2], now[1 : 2 * count : 2] = amplitudes.real, amplitudes.imag
    if offset:
        now[2 * count] = constant
    return gram, data - gram @ now


def _step(gram: np.ndarray, slope: np.ndarray, count: int, damping: float, variance: float) -> tuple[Any, Any]:
    """The step of the exponents times n, shape (k,) complex, and the standard deviations they have there."""
    damped = gram + damping * np.diag(np.diag(gram)) if damping > 0.0 else gram
    inverse = _inverse(damped)
    found = (inverse @ slope)[-2 * count :]
    spread = np.diag(inverse)[-2 * count :: 2] * max(variance, 0.0)
    return found[0::2] + 1j * found[1::2], np.sqrt(np.maximum(spread, 0.0)) + 1e-300


def _inverse(gram: np.ndarray) -> Any:
    """The inverse in columns of unit length; columns that say the same share their part."""
    scale = 1.0 / np.sqrt(np.maximum(np.diag(gram), 1e-300))
    outer = scale[:, None] * scale
    try:
        return np.linalg.inv(gram * outer) * outer
    except np.linalg.LinAlgError:
        return np.linalg.pinv(gram * outer, rcond=1e-14, hermitian=True) * outer

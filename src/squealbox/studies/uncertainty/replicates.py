"""Honest intervals: exact ones for independent points, those of randomised replicates for stratified points."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike


def binomial_interval(hits: int, unknown: int, count: int, level: float) -> tuple[float, float]:
    """Clopper and Pearson's exact interval of a probability; points of unknown outcome count for both sides.

    The lower end takes every unknown point for quiet and the upper one for squealing, so an unknown point can only
    widen it. Source: C. J. Clopper, E. S. Pearson 1934, Biometrika 26, 404-413; `scipy.stats.binomtest`.
    """
    from scipy.stats import binomtest

    low = binomtest(hits, count).proportion_ci(level, method="exact").low
    high = binomtest(hits + unknown, count).proportion_ci(level, method="exact").high
    return float(low), float(high)


def student_interval(values: ArrayLike, level: float, axis: int = 0) -> tuple[Any, Any, Any]:
    """Mean, low and high end over independent replicates along `axis`: mean -+ t s/sqrt(R), t of Student with R - 1.

    Each replicate is an unbiased estimate from its own randomisation, so this needs no assumption about the points
    within one. Source: A. B. Owen, Monte Carlo Theory, Methods and Examples, 2013, section 17.3.
    """
    from scipy.stats import t as student

    values = np.asarray(values, dtype=float)
    count = values.shape[axis]
    mean = np.mean(values, axis=axis)
    half = student.ppf(0.5 + 0.5 * level, count - 1) * np.std(values, axis=axis, ddof=1) / np.sqrt(count)
    return mean, mean - half, mean + half


def ratio_interval(parts: ArrayLike, wholes: ArrayLike, level: float) -> tuple[Any, Any, Any]:
    """Ratio of the means of `parts` (R, d) and `wholes` (R,), with low and high end by the delta method.

    The mean of the ratios would be biased where both vary together; the ratio S of the means is so to order 1/R only,
    and its error is that of the mean of parts - S wholes.
    Source: W. G. Cochran, Sampling Techniques, 3rd ed. 1977, section 6.4.
    """
    parts, wholes = np.asarray(parts, dtype=float), np.asarray(wholes, dtype=float)
    ratio = np.mean(parts, axis=0) / np.mean(wholes)
    _, low, high = student_interval((parts - ratio * wholes[:, None]) / np.mean(wholes), level)
    return ratio, ratio + low, ratio + high

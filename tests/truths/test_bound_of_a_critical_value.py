"""A critical value carries a bound on its error, and holds it: the truth is looked for in rational arithmetic.

With constant friction a system of two freedoms is stable while its Hurwitz determinant and det K_eff are positive. Both
are polynomials of the friction coefficient with the floats of M, C, K, n and d for coefficients, so their signs at
both ends of the bound are known exactly.
"""

from fractions import Fraction

import numpy as np
import pytest

from squealbox import Contact, Coulomb, System, critical_value, critical_values

WIDE = 1e-9  # share of the value that no bound of these systems exceeds


def family(seed):
    rng = np.random.default_rng(seed)
    root, damper = rng.standard_normal((2, 2)), rng.standard_normal((2, 2))
    stiffness = 10.0 ** rng.uniform(0.0, 8.0) * (root @ root.T + 0.1 * np.eye(2))
    size = np.sqrt(np.max(stiffness))
    damping = 10.0 ** rng.uniform(-4.0, 0.0) * size * (damper @ damper.T + 0.05 * np.eye(2))
    rows = [(0.4 * size**2 * rng.standard_normal(2), rng.standard_normal(2)) for _ in range(rng.integers(1, 3))]
    mass = np.diag(rng.uniform(0.5, 2.0, 2))

    def make(mu):
        contacts = tuple(Contact(n, d, d, 1e6, 1.0, Coulomb(mu)) for n, d in rows)
        return System(mass, damping, stiffness, 0.0, contacts)

    return make


def exact(system, mu, still):
    """Hurwitz determinant, or that of K_eff where the eigenvalue is `still` at zero, at the rational number mu."""
    M, C, K = ([[Fraction(float(x)) for x in row] for row in part] for part in (system.M, system.C, system.K))
    for contact in system.contacts:
        for i in range(2):
            for j in range(2):
                K[i][j] -= mu * Fraction(float(contact.d[i])) * Fraction(float(contact.n[j]))
    a0 = K[0][0] * K[1][1] - K[0][1] * K[1][0]
    if still:
        return a0
    (m1, _), (_, m2) = M
    a4, a3 = m1 * m2, m1 * C[1][1] + m2 * C[0][0]
    a2 = m1 * K[1][1] + m2 * K[0][0] + C[0][0] * C[1][1] - C[0][1] * C[1][0]
    a1 = C[0][0] * K[1][1] + C[1][1] * K[0][0] - C[0][1] * K[1][0] - C[1][0] * K[0][1]
    return a3 * a2 * a1 - a4 * a1**2 - a3**2 * a0


@pytest.mark.parametrize("seed", range(12))
def test_the_truth_lies_within_the_bound(seed):
    make = family(seed)
    for found in critical_values(make, "mu", (0.01, 3.0), points=101):
        value, bound = Fraction(float(found.value)), Fraction(float(found.uncertainty))
        still = found.eigenvalue.imag == 0.0
        below, above = (exact(make(1.0), value + side * bound, still) for side in (-1, 1))
        assert below * above < 0
        assert found.uncertainty < WIDE * found.value
        assert abs(found.eigenvalue.real) <= 1e-9 * np.sqrt(np.max(make(1.0).K))


def test_a_pair_that_becomes_two_real_eigenvalues_crosses_nothing():
    """Growing at 4.6 1/s, it counts as two modes from there on; that was listed as a crossing at 1.98988."""
    rng = np.random.default_rng(5)
    for _ in range(21):
        mass, root = np.diag(rng.uniform(0.5, 2, 2)), rng.standard_normal((2, 2))
        stiffness = 10 ** rng.uniform(0, 8) * (root @ root.T + 0.1 * np.eye(2))
        damper = rng.standard_normal((2, 2))
        damping = 10 ** rng.uniform(-4, 0) * np.sqrt(stiffness.max()) * (damper @ damper.T + 0.05 * np.eye(2))
        size = 0.4 * stiffness.max()
        rows = [(rng.standard_normal(2) * size, rng.standard_normal(2)) for _ in range(rng.integers(1, 3))]

    def make(mu):
        contacts = tuple(Contact(n, d, d, 1e6, 1.0, Coulomb(mu)) for n, d in rows)
        return System(mass, damping, stiffness, 0.0, contacts)

    found = critical_values(make, "mu", (0.01, 3.0))
    assert found.value == pytest.approx([0.4722457879401908], rel=1e-12)


def test_the_textbook_value_and_its_bound():
    """Mode coupling of 2002: mu k3 = k12 with k11 = k22 and no damping; the two modes merge there."""
    from squealbox import ModeCoupling

    found = critical_value(ModeCoupling(), "friction.static", (0.1, 2.0))
    assert abs(float(found.value) - 1.0) <= found.uncertainty < 1e-8

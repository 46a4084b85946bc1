"""The largest critical friction an absorber gives a brake that flutters, against a derivation of its own.

K = [[k, 1 - D], [1, k]], M = 1, C = c, an absorber of mass e, frequency w and damping ratio z on x. With

    Y = s^2 + c s + k,    X = Y + e s^2 (2 z w s + w^2)/(s^2 + 2 z w s + w^2)        the two diagonal stiffnesses

the characteristic equation is X Y - (1 - D) = 0: stability changes at s = i a where Im(X Y) = 0, and there it does at
D = 1 - Re(X Y). Im(X Y) times the absorber's |s^2 + 2 z w s + w^2|^2 is a times a polynomial in a^2, so all changes are
its roots, and three of them are a window of instability below the last. The onset is the first, so the best tuning is
on the curve where that window just closes, a double root, with the highest D beyond. 1.2016217 overlooks the window.
"""

import numpy as np
import pytest
from numpy.polynomial import polynomial as P
from scipy.optimize import fsolve, minimize_scalar

from squealbox import Coulomb, ModeCoupling, TunedMass, best_absorber, complex_modes, critical_value


def in_frequency(*coefficients):
    """A polynomial in s as one in a, s = i a."""
    return np.array([value * 1j**power for power, value in enumerate(coefficients)])


def imaginary(w, z, e, c, k):
    """Im(X Y) times the absorber's denominator squared, over a, as a polynomial in a^2."""
    below, Y = in_frequency(w * w, 2.0 * z * w, 1.0), in_frequency(k, c, 1.0)
    X = P.polyadd(P.polymul(Y, below), P.polymul(in_frequency(0.0, 0.0, e), in_frequency(w * w, 2.0 * z * w)))
    return P.polymul(P.polymul(Y, X), below.conj()).imag[1::2]


def changes(w, z, e, c, k):
    """All D at which stability changes, ascending."""
    squares = P.polyroots(imaginary(w, z, e, c, k)).astype(complex)
    s = 1j * np.sqrt(squares[(np.abs(squares.imag) < 1e-7 * np.abs(squares)) & (squares.real > 0.0)].real)
    Y = s * s + c * s + k
    X = Y + e * s * s * (2.0 * z * w * s + w * w) / (s * s + 2.0 * z * w * s + w * w)
    return np.sort(1.0 - (X * Y).real)


def best_on_the_curve(e, c, k, near, between):
    """The highest last change along the tunings at which two others coincide at a frequency a in `between`."""

    def tuning(a):
        def double(x):
            found = imaginary(*x, e, c, k)
            return [P.polyval(a * a, found), P.polyval(a * a, P.polyder(found))]

        return fsolve(double, near, xtol=1e-13)

    found = minimize_scalar(lambda a: -changes(*tuning(a), e, c, k)[-1], bounds=between, method="bounded",
                            options={"xatol": 1e-10})  # fmt: skip
    return -found.fun, tuning(found.x)


@pytest.mark.filterwarnings("ignore:.*xtol|.*good progress:RuntimeWarning")
def test_the_best_absorber_on_flutter_closes_the_window_below_its_margin():
    e, c, k = 0.05, 0.02, 2.0
    exact, (w, z) = best_on_the_curve(e, c, k, (np.sqrt(2.0), 0.007), (1.4, 1.406))
    brake = ModeCoupling(friction=Coulomb(1.0), c1=c, c2=c)
    found = best_absorber(brake, "x", e, "margin", bounds=(0.5, 1.6))
    assert float(found.value) == pytest.approx(exact, abs=1e-8)
    assert exact == pytest.approx(1.2015737, abs=1e-7)
    assert 2.0 * np.pi * float(found.frequency) == pytest.approx(w, rel=1e-5)
    assert float(found.damping) == pytest.approx(z, rel=1e-4)
    friction = np.linspace(0.5, float(found.value) - 1e-9, 4001)
    assert np.max(complex_modes(found.design.replace({"friction.static": friction})).largest_growth_rate) < 1e-9


def test_a_margin_beyond_a_window_is_no_margin():
    """At w = .999859 sqrt 2 and z = .007014 the last change is 1.20162, but the brake squeals from 1.19806 on."""
    w, z = 0.999859 * np.sqrt(2.0), 0.007014
    first, again, last = changes(w, z, 0.05, 0.02, 2.0)
    brake = TunedMass(ModeCoupling(friction=Coulomb(1.0), c1=0.02, c2=0.02), "x", 0.05, w / (2.0 * np.pi), z)
    assert last == pytest.approx(1.2016217, abs=5e-6)
    assert float(complex_modes(brake.replace({"friction.static": 0.5 * (first + again)})).largest_growth_rate) > 6e-5
    assert critical_value(brake, "friction.static", (1.1, 1.3)).value == pytest.approx(first, abs=1e-9)

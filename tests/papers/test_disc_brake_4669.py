"""The published disc brake of 4,669 degrees of freedom: its matrices' entries and its eigenvalues, digit by digit.

Graebner et al. 2016, Table 1, and the eigenvalues found by other solvers on the same files, backward error 1e-14.
"""

import numpy as np
import pytest

from fe_brakes import PUBLISHED
from squealbox import ParameterError, complex_modes
from squealbox.fe import PublishedDiscBrake, full_modes, pencil_of
from squealbox.fe.quadratic import modes_near

ENTRIES = {"M": 93207, "D1": 5683, "DG": 66643, "DR": 5683, "D4": 23885, "K1": 280845, "KR": 21646, "KGEO": 280871}
FORM_A_4PI = [-11.3658 + 1413.4913j, -65.1245 + 10257.2308j, -14.991 + 16344.9488j, -50.8237 + 17402.3998j]
FORM_A_4PI += [-112.6695 + 17597.4429j]
FORM_B_2PI = [(2.0763, 783.097), (69.4741, 2773.921), (110.3357, 4185.173), (3.1713, 5794.803)]
FORM_B_4PI = [(5.4742, 784.990), (74.8306, 2769.230), (119.1765, 4179.085), (0.5738, 5790.14), (0.0001, 816.561)]

needs_files = pytest.mark.skipif(not PUBLISHED.is_dir(), reason="the published matrices are not beside this checkout")


def brake(assembly: str, speed: float) -> PublishedDiscBrake:
    return PublishedDiscBrake(folder=str(PUBLISHED), assembly=assembly, angular_speed=speed * np.pi)


@needs_files
def test_every_stored_entry_is_kept():
    assert {name: matrix.nnz for name, matrix in brake("a", 4).matrices().items()} == ENTRIES


@needs_files
def test_form_a_has_the_eigenvalues_found_by_others():
    pencil = pencil_of(brake("a", 4).system())
    for expected in FORM_A_4PI:
        values, _ = modes_near(pencil, expected + 1.0, 2)
        nearest = values[np.argmin(np.abs(values - expected))]
        assert nearest.real == pytest.approx(expected.real, abs=5.1e-5 if expected.real != -14.991 else 5.1e-4)
        assert nearest.imag == pytest.approx(expected.imag, abs=5.1e-5)


@needs_files
def test_form_a_has_one_unstable_mode_between_200_and_7000_hertz():
    found = full_modes(pencil_of(brake("a", 4).system()), (200.0, 7000.0))
    growing = found.eigenvalues[found.eigenvalues.real > 0.0]
    assert found.covered
    assert np.max(found.backward_error) < 1e-14
    assert growing.real == pytest.approx([0.0002], abs=5e-5)
    assert growing.imag / (2 * np.pi) == pytest.approx([816.561], abs=5.1e-4)


@needs_files
@pytest.mark.parametrize(("speed", "expected"), [(2, FORM_B_2PI), (4, FORM_B_4PI)])
def test_form_b_on_the_whole_problem_and_on_a_basis(speed, expected):
    pencil = pencil_of(brake("b", speed).system())
    modes = complex_modes(brake("b", speed), band=(500.0, 6000.0))
    for growth, hertz in expected:
        values, _ = modes_near(pencil, 2j * np.pi * hertz, 3)
        exact = values[np.argmin(np.abs(values - complex(growth, 2 * np.pi * hertz)))]
        assert exact.real == pytest.approx(growth, abs=5.1e-5)
        assert exact.imag / (2 * np.pi) == pytest.approx(hertz, abs=5.1e-4 if hertz != 5790.14 else 5.1e-3)
        place = int(np.argmin(np.abs(modes.eigenvalues - exact)))
        missed = abs(modes.eigenvalues[place] - exact)
        assert missed < 0.05
        assert missed <= 1.5 * modes.error[place] + 1e-6
        assert abs(modes.corrected[place] - exact) < 5e-3


def test_a_folder_without_the_matrices_is_named(tmp_path):
    with pytest.raises(ParameterError, match=r"BMLL00\.mat is missing"):
        PublishedDiscBrake(folder=str(tmp_path)).system()
    with pytest.raises(ParameterError, match="assembly"):
        PublishedDiscBrake(folder=str(tmp_path), assembly="c")

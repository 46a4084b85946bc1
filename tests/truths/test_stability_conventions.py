"""Eigenvalues in the columns of other codes, by the definitions in their manuals, and tracks told in a few lines."""

import numpy as np
import pytest

from squealbox.designs import DrumBrake
from squealbox.stability import as_printed_by, complex_modes, eigenvalues_printed_by, tracked_modes

VALUES = np.array([-40.0 + 6283.0j, 25.0 + 9000.0j])


@pytest.mark.parametrize(
    ("code", "columns"),
    [
        ("abaqus", ("frequency", "damping_ratio")),
        ("ansys", ("stability", "frequency")),
        ("nastran", ("real", "imaginary")),
        ("optistruct", ("real", "imaginary")),
    ],
)
def test_there_and_back(code: str, columns: tuple[str, str]) -> None:
    printed = as_printed_by(code, VALUES)
    first, second = (printed[name] for name in columns)
    assert np.allclose(eigenvalues_printed_by(code, first, second), VALUES, rtol=1e-14)
    assert not np.allclose(eigenvalues_printed_by(code, second, first), VALUES, rtol=1e-3)


def test_columns_by_hand() -> None:
    abaqus, ansys, nastran = (as_printed_by(code, VALUES) for code in ("abaqus", "ansys", "nastran"))
    assert abaqus["frequency"] == pytest.approx([6283.0 / (2.0 * np.pi), 9000.0 / (2.0 * np.pi)])
    assert abaqus["damping_ratio"] == pytest.approx([80.0 / 6283.0, -50.0 / 9000.0])
    assert ansys["stability"] == pytest.approx([-40.0 / (2.0 * np.pi), 25.0 / (2.0 * np.pi)])
    assert nastran["damping"] == pytest.approx(abaqus["damping_ratio"])
    assert nastran["real"] == pytest.approx([-40.0, 25.0])
    assert np.isnan(as_printed_by("abaqus", -3.0)["damping_ratio"])  # no oscillation


def test_an_unknown_code_is_refused() -> None:
    with pytest.raises(ValueError, match="expected one of abaqus, ansys, nastran, optistruct"):
        as_printed_by("adams", VALUES)
    with pytest.raises(ValueError, match="code = 'adams'"):
        eigenvalues_printed_by("adams", 1.0, 2.0)


def test_tracks_in_a_few_lines() -> None:
    values = np.linspace(0.1, 0.45, 36)
    tracked = tracked_modes(DrumBrake(), "friction.static", values)
    text = tracked.summary().splitlines()
    assert text[0] == "2 modes along friction.static = 0.1 to 0.45, 36 values"
    first, last = (complex_modes(DrumBrake().replace({"friction.static": v})).frequency[:2] for v in (0.1, 0.45))
    assert f"{first[0]:.6g} to {last[0]:.6g} Hz" in text[1] or f"{first[0]:.6g} to {last[1]:.6g} Hz" in text[1]
    assert sum("begins to grow between 0.33 and 0.34" in line for line in text) == 1  # the onset is 0.3327
    data = tracked.to_dataset()
    assert np.array_equal(data["growth_rate"], tracked.eigenvalues.real)
    assert data["frequency"].attrs["units"] == "Hz"
    assert "grow" not in tracked_modes(DrumBrake(), "friction.static", values[:5]).summary()

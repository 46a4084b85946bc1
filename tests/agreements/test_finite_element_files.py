"""A finite-element design file through the commands, and a reduced export through the analyses in Python."""

import csv
import shutil
from pathlib import Path

import numpy as np
import pytest

from fe_exports import DESIGN, write_export
from squealbox import complex_modes, critical_value, read_design, reduce, sensitivity, simulate, tracked_modes
from squealbox.cli import main
from squealbox.fe.reduced_files import load_reduced, save_reduced
from squealbox.files import DesignFileError, read_file
from squealbox.files.reduced import dense
from squealbox.system import InvalidSystem, equilibrium

CALIPER = Path(__file__).resolve().parents[2] / "examples" / "caliper"


@pytest.fixture
def export(tmp_path):
    (write_export(tmp_path) / "brake.toml").write_text(DESIGN)
    return tmp_path


@pytest.fixture
def caliper(tmp_path):
    return Path(shutil.copytree(CALIPER, tmp_path / "caliper"))


def test_a_reduced_export_goes_through_the_analyses(caliper):
    small = reduce(read_design(caliper / "caliper.toml"), (3000.0, 3600.0), varying={"friction.static": (0.0, 0.8)})
    onset = critical_value(small, "friction.static", (0.05, 0.8))
    assert 0.05 < float(onset.value) < 0.5
    at = complex_modes(small.replace({"friction.static": float(onset.value)}))
    assert abs(float(at.largest_growth_rate)) < 1e-4
    tracked = tracked_modes(small, "friction.static", np.linspace(0.1, 0.5, 3))
    assert np.all(np.isfinite(tracked.eigenvalues))
    ranked = sensitivity(small, ["friction.static"])
    assert ranked.outcome.ok
    motion = simulate(small.sliding_one_way(), 1e-3, start=complex_modes(small).most_unstable.start(1e-9))
    assert motion.outcome.ok


def test_a_saved_reduced_brake_is_the_same_brake(export):
    small = reduce(read_design(export / "brake.toml"), (10.0, 2000.0), varying={"angular_speed": (10.0, 30.0)})
    found = load_reduced(save_reduced(small, export / "small.npz"))
    other = {"angular_speed": 25.0, "friction.static": 0.3}
    np.testing.assert_array_equal(
        complex_modes(found.replace(other)).eigenvalues, complex_modes(small.replace(other)).eigenvalues
    )
    with np.load(export / "small.npz") as stored:
        np.testing.assert_array_equal(stored["M"], small.array("M"))


def test_rest_is_where_the_full_brake_is_at_zero(export):
    found = dense(read_file(export / "brake.toml"))
    full = found.design.full
    np.testing.assert_allclose(
        full.basis @ found.simulate.q + full.steady, 0.0, atol=1e-12 * np.max(np.abs(full.steady))
    )


def test_reduce_and_back(export, capsys):
    assert main(["reduce", str(export / "brake.toml"), "--out", str(export / "small.npz")]) == 0
    assert "error [1/s]" in capsys.readouterr().out
    (export / "again.toml").write_text(
        'brake = "reduced"\nfile = "small.npz"\nfriction = { law = "coulomb", static = 0.5 }'
    )
    again, full = read_design(export / "again.toml"), read_design(export / "brake.toml")
    expected = complex_modes(full, band=(10.0, 2000.0)).eigenvalues
    for value in complex_modes(again).eigenvalues:
        assert np.min(np.abs(expected - value)) < 1e-6 * abs(value)
    assert equilibrium(again.system()).exists


def test_a_file_without_a_band_says_what_to_add(export, capsys):
    (export / "brake.toml").write_text(DESIGN.partition("[modes]")[0])
    words = ["onset", str(export / "brake.toml"), "--parameter", "friction.static", "--range", "0", "1"]
    assert main(words) == 2
    assert "[reduce] band" in capsys.readouterr().err
    with pytest.raises(InvalidSystem, match="frequency band"):
        dense(read_file(export / "brake.toml"))


@pytest.mark.parametrize(
    ("text", "word"),
    [
        ('[reduce]\nband = ["2 kHz", "1 kHz"]', "reduce.band"),
        ('[reduce]\nvarying = { "friction.statc" = [0, 1] }', "unknown parameter"),
        ("[reduce]\nbnd = 1", "unknown key"),
    ],
)
def test_faults_of_the_section_are_named(export, text, word):
    (export / "brake.toml").write_text(f"{DESIGN}\n{text}\n")
    with pytest.raises(DesignFileError, match=word):
        read_file(export / "brake.toml")


def test_a_damaged_reduced_file_is_one_sentence(export):
    (export / "small.npz").write_bytes(b"PK\x03\x04 not an archive")
    (export / "again.toml").write_text('brake = "reduced"\nfile = "small.npz"')
    with pytest.raises(DesignFileError, match=r"small\.npz"):
        read_file(export / "again.toml")


def test_the_table_of_modes_adds_up(caliper, capsys):
    meshio, pyuff = pytest.importorskip("meshio"), pytest.importorskip("pyuff")
    out = caliper / "out"
    assert main(["modes", str(caliper / "caliper.toml"), "--out", str(out)]) == 0
    text = capsys.readouterr().out
    assert "UNSTABLE" in text
    assert "None missed" in text
    assert "Doubt: one mesh" in text
    rows = list(csv.DictReader((out / "modes.csv").read_text().splitlines()))
    for row in rows:
        assert float(row["share of disc [-]"]) + float(row["share of pad [-]"]) == pytest.approx(1.0)
        assert float(row["Abaqus damping ratio [-]"]) == pytest.approx(2.0 * float(row["damping ratio [-]"]), rel=1e-3)
    worst = max(rows, key=lambda row: float(row["growth rate [1/s]"]))
    assert float(worst["feed-in of pad [1/s]"]) > float(worst["growth rate [1/s]"]) > 0.0
    assert len(meshio.read(out / "modes.vtu").points) == 22
    assert pyuff.UFF(str(out / "modes.uff")).get_set_types().tolist() == [15] + [55] * len(rows)
    assert (out / "coalescence.png").exists()


def test_a_disc_brake_in_a_file(tmp_path):
    pytest.importorskip("skfem")
    text = 'brake = "disc_brake"\nelement_size = "40 mm"\n[disc]\nthickness = "15 mm"\nmaterial = { young = "100 GPa" }'
    (tmp_path / "disc.toml").write_text(text)
    found = read_design(tmp_path / "disc.toml")
    assert (found.disc.thickness, found.disc.material.young) == (0.015, 100e9)
    (tmp_path / "disc.toml").write_text(text.replace("young", "yung"))
    with pytest.raises(DesignFileError, match=r"disc\.material\.yung"):
        read_design(tmp_path / "disc.toml")

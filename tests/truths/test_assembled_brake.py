"""Friction added to a frictionless export: rows, stiffness and damping against matrices written by hand."""

import numpy as np
import pytest

import exported_files as made
from fe_exports import DESIGN, LABELS, MASS, NODES, PAIRS, SPRINGS, write_export
from squealbox import Coulomb, complex_modes, linearise
from squealbox.cli import main
from squealbox.fe.assembled import AssembledBrake, StructureFiles
from squealbox.fe.interfaces import CoordinateSystem, Interface, Rotation
from squealbox.fe.readers import MatrixFileError
from squealbox.fe.structure import read_structure
from squealbox.files import DesignFileError, read_design

MU, K_CONTACT, PRELOAD = 0.5, 1e9 * 2e-3, 50e3 * 2e-3
SPEED = 20.0 * 0.1  # omega r; the master moves along +y at x = 0.1
R_N = np.array([0, 0, 1, 0, 0, -1.0])
R_T = np.array([0, 1, 0, 0, -1, 0.0])
R_A = np.array([-1, 0, 0, 1, 0, 0.0])  # z cross y = -x


def structure(folder):
    return read_structure(
        mass=folder / "b_MASS1.mtx", stiffness=folder / "b_STIF1.mtx", units="SI", nodes=folder / "nodes.csv"
    )


def brake(folder, *, sliding=None, **changes):
    about = {"pairs": str(folder / "pad.csv"), "stiffness": 1e9, "pressure": 50e3}
    pad = Interface(**{**about, "sliding": sliding or Rotation(axis=(0, 0, 1)), **changes.pop("pad", {})})
    return AssembledBrake(structure(folder), (pad,), friction=Coulomb(MU), angular_speed=20.0, **changes)


def by_hand():
    stiffness = SPRINGS + K_CONTACT * np.outer(R_N, R_N)
    steady = np.linalg.solve(stiffness - MU * K_CONTACT * np.outer(R_T, R_N), MU * PRELOAD * R_T)
    normal = PRELOAD + K_CONTACT * R_N @ steady
    return stiffness - MU * K_CONTACT * np.outer(R_T, R_N), MU * normal / SPEED * np.outer(R_A, R_A), normal


def test_rows_stiffness_and_damping_are_those_by_hand(tmp_path):
    steady = linearise(brake(write_export(tmp_path)).system())
    stiffness, damping, normal = by_hand()
    np.testing.assert_allclose(steady.K.toarray(), stiffness, atol=1e-9 * K_CONTACT)
    np.testing.assert_allclose(steady.C.toarray(), damping, rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(steady.equilibrium.normal_force, [normal])
    np.testing.assert_allclose(steady.equilibrium.sliding_speed, [SPEED])


def test_friction_on_the_slave_points_as_the_master_moves(tmp_path):
    """The pad at rest is dragged along: its displacement along the motion is positive."""
    steady = linearise(brake(write_export(tmp_path)).system()).equilibrium
    assert steady.q[1] > 0.0
    assert steady.q[4] < 0.0


def test_contact_held_in_the_matrices_adds_no_stiffness(tmp_path):
    system = brake(write_export(tmp_path), pad={"in_matrices": True}).system()
    np.testing.assert_array_equal(system.K.toarray(), SPRINGS)
    assert system.contacts.n.toarray()[0, 2] == pytest.approx(K_CONTACT)
    one_way = brake(tmp_path, pad={"in_plane": False}).system()
    assert one_way.contacts.across is None


def test_a_point_between_masters_is_shared_by_weights(tmp_path):
    pairs = "slave, master, weight, master, weight, nx, ny, nz, area\n1, 2, 0.25, 1, 0.75, 0, 0, 1, 2e-3\n"
    rows = brake(write_export(tmp_path, pairs)).system().contacts
    np.testing.assert_allclose(rows.n.toarray() / K_CONTACT, [[0, 0, 0.25, 0, 0, -0.25]])


def test_directions_are_turned_into_the_system_of_a_node(tmp_path):
    """Node 1 has its displacements along axes turned by 30 degrees about z."""
    write_export(tmp_path)
    c, s = np.cos(np.pi / 6), np.sin(np.pi / 6)
    local = np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]])  # rows: local axes in global ones
    turn = np.eye(6)
    turn[:3, :3] = local
    made.write(tmp_path, "b_STIF1.mtx", made.matrix_input(turn @ SPRINGS @ turn.T, LABELS))
    system = CoordinateSystem(nodes=(1,), across=(c, s, 0.0))
    turned = linearise(brake(tmp_path, systems=(system,)).system())
    stiffness, damping, _ = by_hand()
    np.testing.assert_allclose(turned.K.toarray(), turn @ stiffness @ turn.T, atol=1e-9 * K_CONTACT)
    np.testing.assert_allclose(turned.C.toarray(), turn @ damping @ turn.T, atol=1e-6)
    forgotten = linearise(brake(tmp_path).system())
    assert not np.allclose(forgotten.K.toarray(), turn @ stiffness @ turn.T, rtol=1e-3)


def test_cylindrical_directions_are_radial_and_around():
    axes = CoordinateSystem(nodes=(1,), shape="cylindrical").directions(np.array([0.0, 2.0, 5.0]))
    np.testing.assert_allclose(axes, np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1.0]]), atol=1e-15)


def test_lengths_of_pairs_are_in_the_units_of_the_structure(tmp_path):
    """The same brake written in mm t s and in SI gives the same matrices."""
    si = brake(write_export(tmp_path / "si") if (tmp_path / "si").mkdir() is None else None).system()
    folder = tmp_path / "mm"
    folder.mkdir()
    made.write(folder, "b_MASS1.mtx", made.matrix_input(MASS * 1e-3, LABELS))
    made.write(folder, "b_STIF1.mtx", made.matrix_input(SPRINGS * 1e-3, LABELS))
    made.write(folder, "pad.csv", PAIRS.replace("2e-3", "2e3"))
    made.write(folder, "nodes.csv", NODES.replace("0.1", "100").replace("0.01", "10"))
    files = {name: str(folder / f"{name}") for name in ("b_MASS1.mtx", "b_STIF1.mtx", "nodes.csv")}
    sheet = StructureFiles(
        mass=files["b_MASS1.mtx"], stiffness=files["b_STIF1.mtx"], nodes=files["nodes.csv"], units="mm t s"
    )
    pad = Interface(str(folder / "pad.csv"), stiffness=1e9, pressure=50e3, sliding=Rotation())
    mm = AssembledBrake(sheet, (pad,), friction=Coulomb(MU), angular_speed=20.0).system()
    for ours, theirs in ((mm.M, si.M), (mm.K, si.K), (mm.contacts.n, si.contacts.n)):
        np.testing.assert_allclose(ours.toarray(), theirs.toarray(), rtol=1e-12)
    np.testing.assert_allclose(mm.contacts.V, si.contacts.V)
    np.testing.assert_allclose(mm.contacts.N0, si.contacts.N0)


def test_terms_of_a_turning_disc_enter_with_their_powers_of_speed(tmp_path):
    write_export(tmp_path)
    skew = np.zeros((6, 6))
    skew[0, 1], skew[1, 0] = 3.0, -3.0
    for name, matrix in (("G", skew), ("R", np.eye(6)), ("KG", 5.0 * np.eye(6)), ("KR", skew)):
        text = "".join(f"{i + 1} {j + 1} {matrix[i, j]:.15e}\n" for i, j in zip(*np.nonzero(matrix), strict=True))
        head = f"%%MatrixMarket matrix coordinate real general\n6 6 {np.count_nonzero(matrix)}\n"
        made.write(tmp_path, f"{name}.mtx", head + text)
    np.save(tmp_path / "M.npy", MASS)
    np.save(tmp_path / "K.npy", SPRINGS)
    files = {"gyroscopic": "G", "radial": "R", "geometric": "KG", "circulatory": "KR"}
    sheet = StructureFiles(
        mass=str(tmp_path / "M.npy"), stiffness=str(tmp_path / "K.npy"), units="SI",
        **{name: str(tmp_path / f"{stem}.mtx") for name, stem in files.items()},
    )  # fmt: skip
    for base, radial, geometric in ((0.0, 1 / 20.0, 400.0), (2.0, 1 / 20.0 - 0.5, 396.0)):
        system = AssembledBrake(sheet, angular_speed=20.0, reference_speed=base).system()
        np.testing.assert_allclose(system.C.toarray(), 20.0 * skew + radial * np.eye(6))
        np.testing.assert_allclose(system.K.toarray(), SPRINGS + skew + 5.0 * geometric * np.eye(6))


BAD_PAIRS = {
    "slave, master, nx, ny, nz, area\n1, 4711, 0, 0, 1, 1\n": "line 2: node 4711 is not in the structure",
    "slave, master, nx, ny, nz, area\n1, 2, 0, 0, 0, 1\n": "line 2: a pair without a normal|direction of length 0",
    "slave, master, nx, ny, nz, area\n1, 2, 0, 1, 0, 1\n": "line 2: .*slides along its normal",
    "slave, master, nx, ny, nz, area [mm^2]\n1, 2, 0, 0, 1, 1\n": "line 1: .*no unit in a heading",
    "slave, master, nx, ny, nz, area\n1, 2, 0, 0, 1\n": "line 2: has 5 columns: expected 6",
    "slave, master, nx, ny, nz, area\n1, 2, 0, 0, 1, 2;5\n": "line 2: .*expected a number as area",
    "slave, master, weight, nx, ny, nz, area\n1, 2, 0.5, 0, 0, 1, 1\n": "line 2: .*expected the sum 1",
    "slave, master, nx, ny, nz\n1, 2, 0, 0, 1\n": "line 2: a pair without an area",
    "slave, master, nx, ny, nz, area\n": "holds no pairs",
}


@pytest.mark.parametrize("pairs", BAD_PAIRS)
def test_pairs_that_mean_nothing_are_refused_with_their_line(tmp_path, pairs):
    with pytest.raises(ValueError, match=BAD_PAIRS[pairs]):
        brake(write_export(tmp_path, pairs)).system()


def test_a_design_file_gives_the_same_modes_as_by_hand(tmp_path, capsys):
    write_export(tmp_path)
    path = made.write(tmp_path, "caliper.toml", DESIGN)
    stiffness, damping, _ = by_hand()
    damping = damping + 1e-6 * SPRINGS
    state = np.block(
        [[np.zeros((6, 6)), np.eye(6)], [-np.linalg.solve(MASS, stiffness), -np.linalg.solve(MASS, damping)]]
    )
    found = complex_modes(read_design(path), band=(10.0, 2000.0))
    mine = found.eigenvalues[found.eigenvalues.imag > 0.0]
    assert len(mine) >= 4
    for value in mine:
        assert np.min(abs(np.linalg.eigvals(state) - value)) < 1e-6 * abs(value)
    assert main(["modes", str(path), "--out", str(tmp_path / "run")]) == 0
    said = capsys.readouterr().out
    assert "Steady sliding is" in said
    assert (tmp_path / "run" / "modes.csv").read_text().startswith("mode,frequency [Hz],growth rate [1/s],error [1/s]")
    assert main(["modes", str(path), "--band", "2000", "10"]) == 2


BAD_DESIGNS = {
    'units = "SI"\n': ("", "the key 'units' is missing"),
    'units = "SI" ': ('units = "mm t" ', "mm t s"),
    '"b_STIF1.mtx"': ('"../b_STIF1.mtx"', "outside the folder"),
    "b_MASS1.mtx": ("none.mtx", "none.mtx: cannot be read"),
    "axis = [0, 0, 1]": ("axis = [0, 0, 0]", "not all zero"),
    'name = "pad"': ("nmae = 3", "did you mean 'name'"),
    "[[interfaces]]": ("[interfaces]", "tables, each under"),
}


@pytest.mark.parametrize("old", BAD_DESIGNS)
def test_a_faulty_design_file_names_what_is_wrong(tmp_path, old):
    write_export(tmp_path)
    new, words = BAD_DESIGNS[old]
    text = DESIGN.replace('units = "SI"\n', 'units = "SI" \n') if old.endswith('" ') else DESIGN
    with pytest.raises(DesignFileError, match=words):
        read_design(made.write(tmp_path, "caliper.toml", text.replace(old, new)))


def test_the_command_says_what_files_hold(tmp_path, capsys):
    write_export(tmp_path)
    assert main(["matrices", str(tmp_path / "b_MASS1.mtx"), str(tmp_path / "b_STIF1.mtx"), "--units", "SI"]) == 0
    said = capsys.readouterr().out
    for words in (
        "Abaqus, matrix input text",
        "6 x 6, 7 entries, one half, mirrored",
        "labels of 2 nodes",
        "first frequencies",
    ):
        assert words in said
    assert main(["matrices", str(tmp_path / "nodes.csv")]) == 2
    assert "nodes.csv" in capsys.readouterr().err
    assert issubclass(MatrixFileError, ValueError)

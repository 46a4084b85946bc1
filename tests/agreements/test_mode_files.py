"""A mode written for other programs reads back as it was."""

import numpy as np
import pytest

from squealbox.fe import DiscBrake, write_shape

meshio = pytest.importorskip("meshio")
pyuff = pytest.importorskip("pyuff")
pytest.importorskip("skfem")


@pytest.fixture(scope="module")
def brake():
    return DiscBrake(element_size=0.04)


def test_a_vtu_holds_shape_and_bodies(brake, tmp_path):
    made = brake.structure()
    shape = np.tile([1.0, 0.0, 2.0j], made.size // 3)
    mesh = meshio.read(write_shape(brake, shape, -1.0 + 100.0j, tmp_path / "mode.vtu"))
    free = mesh.point_data["size"] > 0.0
    np.testing.assert_allclose(mesh.point_data["real"][free], np.tile([1.0, 0.0, 0.0], (free.sum(), 1)))
    np.testing.assert_allclose(mesh.point_data["imag"][free], np.tile([0.0, 0.0, 2.0], (free.sum(), 1)))
    held = np.hypot(mesh.points[:, 0], mesh.points[:, 1])[~free]
    np.testing.assert_allclose(held, brake.disc.inner_radius)
    assert set(np.unique(mesh.cell_data["body"][0])) == {0, 1, 2}
    a, b, _, d, e = (mesh.points[mesh.cells[0].data[:, i]] for i in range(5))
    volume = np.abs(np.einsum("ij,ij->i", np.cross(b - a, d - a), e - a))
    assert np.all(volume > 0.0)


def test_a_universal_file_holds_nodes_and_the_complex_mode(brake, tmp_path):
    made = brake.structure()
    shape = np.tile([1.0, 0.5j, 2.0], made.size // 3)
    path = write_shape(brake, shape, -3.0 + 5000.0j, tmp_path / "mode.uff")
    nodes, mode = pyuff.UFF(str(path)).read_sets()
    assert nodes["type"] == 15
    assert mode["eig"] == pytest.approx(-3.0 + 5000.0j, rel=1e-5)
    size = np.abs(mode["r3"])
    np.testing.assert_allclose(np.asarray(mode["r2"])[size > 0.0], 0.5j, rtol=1e-5)


def test_other_endings_and_sizes_are_refused(brake, tmp_path):
    with pytest.raises(ValueError, match=r"\.vtu or \.uff"):
        write_shape(brake, np.zeros(brake.structure().size), 1j, tmp_path / "mode.stl")
    with pytest.raises(ValueError, match="all degrees of freedom"):
        write_shape(brake, np.zeros(3), 1j, tmp_path / "mode.vtu")

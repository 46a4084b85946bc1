"""Readers of exported matrices: the same small model from every format, and the traps of each format."""

import numpy as np
import pytest
from scipy.io import savemat
from scipy.sparse import csr_array, save_npz

import exported_files as made
from squealbox.fe.readers import MatrixFileError, open_matrices
from squealbox.fe.structure import read_matrices, read_structure


def both(folder, mass, stiffness, *contents):
    return [made.write(folder, name, content) for name, content in zip((mass, stiffness), contents, strict=True)]


def files_of(folder, kind):
    """Files of the model in one format."""
    m, k = made.M, made.K
    pairs = {
        "coordinate": ("a_MASS1.mtx", "a_STIF1.mtx", made.coordinate(m), made.coordinate(k)),
        "matrix input": ("a_MASS1.mtx", "a_STIF1.mtx", made.matrix_input(m), made.matrix_input(k)),
        "calculix": ("a.mas", "a.sti", made.calculix(m), made.calculix(k)),
        "market": ("a_mass.mtx", "a_stif.mtx", made.market(m), made.market(k)),
        "market general": ("a_mass.mtx", "a_stif.mtx", made.market(m), made.market(k, "general")),
    }
    if kind in pairs:
        made.write(folder, "a.dof", "".join(f"{a}.{b}\n" for a, b in made.LABELS))
        return both(folder, *pairs[kind])
    single = {
        "dmig": ("a.pch", made.dmig("KAAX", k) + made.dmig("MAAX", m)),
        "dmig square": ("a.pch", made.dmig("KAAX", k, form=1) + made.dmig("MAAX", m, form=1)),
        "full": ("a.full", made.full_file(k, m)),
        "optistruct": ("a.full.mat", made.optistruct(k, m)),
    }
    for way in ("dense", "bigmat", "nonbigmat"):
        single[f"op4 {way}"] = ("a.op4", made.op4_text("KXX", k, way) + made.op4_text("MXX", m, way))
        for order, word in (("<", 4), (">", 4), ("<", 8), (">", 8)):
            raw = made.op4_binary("KXX", k, way, order, word) + made.op4_binary("MXX", m, way, order, word)
            single[f"op4 {way} {order}{word}"] = ("a.op4", raw)
    if kind in single:
        return [made.write(folder, *single[kind])]
    if kind == "mat":
        savemat(folder / "a.mat", {"K": csr_array(k).tocsc(), "M": m})
        return [folder / "a.mat"]
    if kind == "npz":
        np.savez(folder / "a.npz", K=k, M=m, labels=np.array(made.LABELS))
        return [folder / "a.npz"]
    save_npz(folder / "K.npz", csr_array(k))
    np.save(folder / "M.npy", m)
    return [folder / "M.npy", folder / "K.npz"]


OP4 = [f"op4 {way}{end}" for way in ("dense", "bigmat", "nonbigmat") for end in ("", " <4", " >4", " <8", " >8")]
KINDS = ["coordinate", "matrix input", "calculix", "market", "market general", "dmig", "dmig square", "full"]
KINDS += ["optistruct", "mat", "npz", "save_npz", *OP4]
LABELLED = {"matrix input", "calculix", "dmig", "dmig square", "full", "optistruct", "npz"}


@pytest.mark.parametrize("kind", KINDS)
def test_every_format_gives_the_matrices(tmp_path, kind):
    found = read_matrices(*files_of(tmp_path, kind))
    digits = 1e-9 if "dmig" in kind else 1e-12
    np.testing.assert_allclose(found.K.toarray(), made.K, rtol=digits, atol=0)
    np.testing.assert_allclose(found.M.toarray(), made.M, rtol=digits, atol=0)
    np.testing.assert_allclose(found.frequencies(4), made.FREQUENCIES, rtol=1e-8)
    if kind in LABELLED:
        assert [tuple(label) for label in found.labels] == made.LABELS
    else:
        assert found.labels is None


def test_a_substructure_has_its_nodes_from_comments(tmp_path):
    k, m = made.K[:3, :3], made.M[:3, :3]
    for unsymmetric in (False, True):
        path = made.write(tmp_path, "z.mtx", made.substructure(k, m, unsymmetric=unsymmetric))
        found = read_matrices(path)
        np.testing.assert_allclose(found.K.toarray(), k)
        assert found.labels.tolist() == [[7, 1], [11, 1], [30, 1]]


def test_negative_nodes_are_internal_and_sorted_apart(tmp_path):
    labels = [(1, 1), (2, 1), (-1, 1), (-1, 2)]
    mass = made.M.copy()
    mass[2:, 2:] = 0.0
    paths = both(
        tmp_path, "i_MASS1.mtx", "i_STIF1.mtx", made.matrix_input(mass, labels), made.matrix_input(made.K, labels)
    )
    found = read_matrices(*paths)
    assert found.labels.tolist() == [[1, 1], [2, 1], [-1, 1], [-1, 2]]
    assert found.internal.tolist() == [False, False, True, True]
    assert found.massless.tolist() == [False, False, True, True]
    assert any("internal freedoms" in doubt for doubt in found.doubts())
    assert any("without mass: -1.1, -1.2" in doubt for doubt in found.doubts())


def test_unsymmetric_is_kept_and_never_mirrored(tmp_path):
    k = made.K.copy()
    k[0, 1] = -7e5
    found = open_matrices(made.write(tmp_path, "u_STIF1.mtx", made.coordinate(k))).matrices[0]
    np.testing.assert_array_equal(found.matrix.toarray(), k)
    assert found.symmetry.startswith("unsymmetric (1 pairs differ")
    labelled = "".join(f"{made.LABELS[i][0]},1, {made.LABELS[j][0]},1, {v}\n" for i, j, v in made.whole(k[:3, :3]))
    found = open_matrices(made.write(tmp_path, "v_STIF1.mtx", labelled)).matrices[0]
    np.testing.assert_array_equal(found.matrix.toarray(), k[:3, :3])


def test_half_of_the_pairs_is_neither_half_nor_whole(tmp_path):
    lines = made.coordinate(made.K).splitlines(keepends=True)
    path = made.write(tmp_path, "h_STIF1.mtx", "".join(line for line in lines if not line.startswith("2 1 ")))
    with pytest.raises(
        MatrixFileError, match=r"h_STIF1.mtx, line 2: .* 2 pairs both ways and 1 entries one way, such as"
    ):
        open_matrices(path)


def test_masses_are_aligned_by_label(tmp_path):
    mass = made.M.copy()
    mass[1, 1] = 0.0
    path = made.write(tmp_path, "a.pch", made.dmig("KAAX", made.K) + made.dmig("MAAX", mass))
    found = read_matrices(path)
    np.testing.assert_array_equal(found.M.toarray(), mass)
    assert any("1 freedoms without mass: 11.1" in doubt for doubt in found.doubts())
    assert any("10 digits" in doubt for doubt in found.doubts())


def test_constrained_freedoms_are_left_out_and_named(tmp_path):
    found = read_matrices(made.write(tmp_path, "a.full", made.full_file(made.K, made.M, fixed={(7, 1)})))
    np.testing.assert_array_equal(found.K.toarray(), made.K[1:, 1:])
    assert found.constrained.tolist() == [[7, 1]]
    assert found.labels.tolist() == [[11, 1], [30, 1], [30, 2]]


def test_complex_pairs_and_rectangular_matrices_are_read(tmp_path):
    text = (
        "DMIG    BX             0       9       4       0                       2\n"
        "DMIG*   BX                             1               0\n"
        "*                      5               1 1.000000000D+00-2.000000000D+00\n"
        "DMIG*   BX                             2               0\n"
        "*                      6               3 3.0            4.0\n"
    )
    (found,) = open_matrices(made.write(tmp_path, "c.pch", text)).matrices
    np.testing.assert_array_equal(found.matrix.toarray(), [[1 - 2j, 0], [0, 3 + 4j]])
    assert found.labels.tolist() == [[5, 1], [6, 3]]


@pytest.mark.parametrize("word", ["2.0D+06", "2.0+6", "2.0d6", "2000000"])
def test_numbers_of_fortran_are_whole(tmp_path, word):
    text = f"%%MatrixMarket matrix coordinate real symmetric\n2 2 3\n1 1 {word}\n2 1 -1.0D+06\n2 2 {word}\n"
    found = open_matrices(made.write(tmp_path, "K.mtx", text)).matrices[0]
    np.testing.assert_array_equal(found.matrix.toarray(), [[2e6, -1e6], [-1e6, 2e6]])


BAD_MARKET = {
    "real symmetric\n2 2 4\n1 1 2\n1 2 1\n2 1 1\n2 2 2\n": "1 pairs occur both ways",
    "real general\n2 2 3\n1 1 2\n2 1 1\n2 2 2\n": "one triangle only",
    "pattern general\n2 2 1\n1 1\n": "pattern",
    "real general\n2 2 3\n1 1 2,5e6\n2 2 1\n1 2 1\n": r"line 3: .*2,5e6",
    "real general\n2 2 3\n1 1 2\n2 2 1\n": "says 3 entries and holds 2",
    "real general\n2 2 1\n1 3 2\n": "the index 3: expected 1 to 2",
    "real general\n2 2 1\n1 1 nan\n": "line 3",
    "real general\n2 2 2\n1 1 2\n1 1 2\n": "line 4: .*twice",
}


@pytest.mark.parametrize("text", BAD_MARKET)
def test_what_a_market_file_cannot_mean_is_refused(tmp_path, text):
    path = made.write(tmp_path, "K.mtx", "%%MatrixMarket matrix coordinate " + text)
    with pytest.raises(MatrixFileError, match=BAD_MARKET[text]):
        open_matrices(path)


def test_a_node_of_calculix_is_no_decimal_number(tmp_path):
    files_of(tmp_path, "calculix")
    made.write(tmp_path, "a.dof", "3.1\n3.10\n4.1\n4.2\n")
    assert open_matrices(tmp_path / "a.sti").matrices[0].labels.tolist() == [[3, 1], [3, 10], [4, 1], [4, 2]]


def test_a_mapping_vector_gives_labels(tmp_path):
    paths = files_of(tmp_path, "market")
    vector = made.write(tmp_path, "map.txt", "%%MatrixMarket matrix array integer general\n% nodes\n2 1\n9\n4\n")
    found = read_structure(mass=paths[0], stiffness=paths[1], labels=vector, units="SI")
    assert found.labels.tolist() == [[9, 1], [9, 2], [4, 1], [4, 2]]


def test_units_turn_displacements_and_rotations_alike(tmp_path):
    """A beam element in mm t s and in SI: translations, rotations and their coupling each have their own factor."""
    labels = [(1, 2), (1, 6)]
    k_si = np.array([[12.0, 6.0], [6.0, 4.0]]) * 1e3  # N/m, N, N m
    m_si = np.array([[156.0, 22.0], [22.0, 4.0]]) / 420
    length = np.array([1e-3, 1.0])  # one mm of displacement, one rad
    k_mm = k_si * np.outer(length, length) * 1e3  # energy in mJ = N mm
    m_mm = m_si * np.outer(length, length) * 1e3
    paths = both(
        tmp_path, "b_MASS1.mtx", "b_STIF1.mtx", made.matrix_input(m_mm, labels), made.matrix_input(k_mm, labels)
    )
    found = read_structure(mass=paths[0], stiffness=paths[1], units="mm-t-s")
    np.testing.assert_allclose(found.K.toarray(), k_si)
    np.testing.assert_allclose(found.M.toarray(), m_si)
    in_ms = read_structure(mass=paths[0], stiffness=paths[1], units="mm kg ms")
    np.testing.assert_allclose(in_ms.frequencies(2), 1e3 * found.frequencies(2), rtol=1e-9)


def test_units_are_asked_and_doubted(tmp_path):
    paths = files_of(tmp_path, "matrix input")
    with pytest.raises(ValueError, match="the units of the matrices"):
        read_structure(mass=paths[0], stiffness=paths[1], units=None)
    with pytest.raises(ValueError, match="mm t s"):
        read_structure(mass=paths[0], stiffness=paths[1], units="mm t")
    heavy = read_structure(mass=paths[0], stiffness=paths[1], units="mm t s")
    assert heavy.total_mass() == pytest.approx(6e3)
    assert any("frequency is" in doubt for doubt in read_matrices(*paths).doubts([1e-4, 1e7, 2e7]))


def test_a_second_stiffness_and_none_are_refused(tmp_path):
    path = made.write(tmp_path, "a.pch", made.dmig("KAAX", made.K) + made.dmig("KGG", made.K))
    with pytest.raises(MatrixFileError, match="KGG is a second stiffness matrix"):
        read_matrices(path)
    found = read_structure(mass=files_of(tmp_path, "dmig")[0], stiffness=(tmp_path / "a.pch", "KAAX"), units="SI")
    assert found.size == 4
    with pytest.raises(MatrixFileError, match="no stiffness matrix"):
        read_matrices(made.write(tmp_path, "b.pch", made.dmig("MAAX", made.M)))

"""Files other people exported, against the frequencies their codes printed, or that other programs find from them.

The files stand beside the checkout where there are any; each folder holds its licence.
"""

import numpy as np
import pytest

from fe_brakes import PUBLISHED
from squealbox.fe.readers import MatrixFileError, open_matrices
from squealbox.fe.structure import read_matrices

EXPORTED = PUBLISHED.parent / "exported"
pytestmark = pytest.mark.skipif(not EXPORTED.is_dir(), reason="the exported files are not beside this checkout")

# files, freedoms, rigid modes, then frequencies [Hz] with the digits known
MODELS = [
    (["abaqus_exudyn/rotorDiscTestMASS1.mtx", "abaqus_exudyn/rotorDiscTestSTIF1.mtx"], 345, 6,
     ["1046.370", "1046.370", "1878.241", "2123.297"]),
    (["abaqus_exudyn/blockC3D8_MASS1.mtx", "abaqus_exudyn/blockC3D8_STIF1.mtx"], 528, 6, ["438.775", "438.775"]),
    (["abaqus_exudyn/blockC3D10_MASS1.mtx", "abaqus_exudyn/blockC3D10_STIF1.mtx"], 771, 6, ["451.333", "452.010"]),
    (["abaqus_fembeam/model_MASS1.mtx", "abaqus_fembeam/model_STIF1.mtx"], 14, 6, ["11.623", "11.623", "164.375"]),
    (["abaqus_substructure/symmetric_inner.mtx"], 36, 6, []),
    (["abaqus_substructure/unsymmetric_inner.mtx"], 36, 6, []),
    (["nastran_km/test_case.pch1"], 10, 2,
     ["21.14057", "21.35569", "128.7332", "129.7476", "437.1801", "438.2013", "1258.988", "1259.566"]),
    (["nastran_km/sol103_swept_plane.pch1"], 45, 3,
     ["1.339207", "3.406026", "5.610046", "10.88232", "11.05762", "16.00409", "23.21605"]),
    (["pyyeti/inboard_mk.op4"], 32, 6, []),
    (["pyyeti/outboard.op4"], 46, 6, []),
    (["ansys_full/file.full"], 900, 0, ["1283.200", "1283.200", "5781.975"]),
    (["ansys_full/sparse.full"], 345, 6, []),
    (["ansys_mm/rotorAnsysMassMatrixSparse.txt", "ansys_mm/rotorAnsysStiffnessMatrixSparse.txt"], 345, 6, ["104.637"]),
]  # fmt: skip

# file, matrix, entries in the file, symmetry begins with
ENTRIES = [
    ("abaqus_exudyn/blockC3D10_STIF1.mtx", 0, 50729, "symmetric, both halves"),
    ("abaqus_exudyn/blockC3D8_MASS1.mtx", 0, 528, "diagonal"),
    ("abaqus_fembeam/model_STIF1.mtx", 0, 33, "one half"),
    ("abaqus_substructure/unsymmetric_inner.mtx", 0, 1296, ""),
    ("abaqus_substructure/unsymmetric_inner.mtx", 1, 666, "one half"),
    ("ansys_full/file.full", 0, 38960, "one half"),
    ("ansys_full/sparse.full", 0, 7002, "one half"),
    ("ansys_full/sparse.full", 1, 2883, "one half"),
    ("ansys_mm/rotorAnsysStiffnessMatrixSparse.txt", 0, 7002, "one half"),
    ("pynastran/testplate_kgg.op4", 0, 12196, "symmetric"),
    ("pynastran/testplate_kgg_ascii.op4", 0, 12196, "symmetric"),
    ("pyyeti/double_bigmat_le.op4", 2, 61, "rectangular"),
    ("pyyeti/double_bigmat_ascii.op4", 2, 61, "rectangular"),
    ("pyyeti/double_dense_ascii.op4", 2, 61, "rectangular"),
    ("pyyeti/double_nonbigmat_ascii.op4", 2, 61, "rectangular"),
    ("pyyeti/matrix_factory.pch", 3, 1050, "rectangular"),
    ("pynastran/dmig.pch", 2, 6, "one half"),
]


@pytest.mark.parametrize(("files", "size", "rigid", "known"), MODELS, ids=[model[0][0] for model in MODELS])
def test_first_frequencies_are_those_of_the_code(files, size, rigid, known):
    found = read_matrices(*(EXPORTED / name for name in files))
    values = found.frequencies(rigid + max(len(known), 1))
    assert found.size == size
    assert np.all(values[:rigid] < 1e-3 * values[rigid])
    for value, text in zip(values[rigid:], known, strict=False):
        # half a digit of the printed number; ten digits of a punch file are worth seven of a frequency
        assert abs(value - float(text)) <= 0.51 * 10.0 ** -len(text.split(".")[1])


@pytest.mark.parametrize(("name", "index", "entries", "symmetry"), ENTRIES)
def test_entries_and_symmetry(name, index, entries, symmetry):
    found = open_matrices(EXPORTED / name).matrices[index]
    assert found.entries == entries
    assert found.symmetry.startswith(symmetry)


def test_the_same_matrix_as_text_and_binary():
    one, two = (
        open_matrices(EXPORTED / f"pynastran/{name}.op4").matrices[0].matrix
        for name in ("testplate_kgg", "testplate_kgg_ascii")
    )
    assert abs(one - two).max() <= 5e-10 * abs(one).max()  # ten digits in the text
    ways = [open_matrices(EXPORTED / f"pyyeti/double_{way}.op4").matrices for way in ("bigmat_le", "nonbigmat_ascii")]
    for binary, text in zip(*ways, strict=True):
        np.testing.assert_allclose(binary.matrix.toarray(), text.matrix.toarray(), rtol=1e-13)


def test_internal_massless_and_constrained_freedoms_are_named():
    beam = read_matrices(*(EXPORTED / f"abaqus_fembeam/model_{kind}1.mtx" for kind in ("MASS", "STIF")))
    assert beam.labels[beam.internal].tolist() == [[-1, 1], [-1, 2]]
    plane = read_matrices(EXPORTED / "nastran_km/sol103_swept_plane.pch1")
    assert plane.labels[plane.massless].tolist() == [[1, 4], [2, 4], [3, 4], [4, 4]]
    solid = read_matrices(EXPORTED / "ansys_full/file.full")
    assert len(solid.constrained) == 63


@pytest.mark.parametrize("name", ["pynastran/fsi.pch", "pyyeti/inboard.pch", "pyyeti/reduced_bset_notall6.pch"])
def test_a_punch_file_without_matrices_says_so(name):
    with pytest.raises(MatrixFileError, match="holds no DMIG"):
        open_matrices(EXPORTED / name)


def test_every_file_is_read_or_refused_in_a_sentence():
    files = [path for path in EXPORTED.rglob("*") if path.suffix in (".mtx", ".pch", ".pch1", ".op4", ".full", ".txt")]
    read, said = 0, []
    for path in files:
        if "LICENSE" in path.name:
            continue
        try:
            read += len(open_matrices(path).matrices) > 0
        except MatrixFileError as error:
            said.append(str(error))
    assert not [words for words in said if "\n" in words or len(words) > 300]
    assert read >= 25

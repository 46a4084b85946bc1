"""Matrices beside a design file: read right, and refused when they are not what they say."""

import io
import pickle
import zipfile

import numpy as np
import pytest
from scipy.io import mmwrite
from scipy.sparse import coo_matrix

from squealbox.files import DesignFileError, read_design

K = np.array([[2e6, -1e6], [-1e6, 3e6 + 1 / 3]])


def written(name: str, path) -> None:
    """K in the format of its ending."""
    if name.endswith(".npy"):
        np.save(path / name, K)
    elif name.endswith(".mtx"):
        mmwrite(path / name, coo_matrix(K), precision=17)
    else:
        np.savetxt(path / name, K, delimiter=",", fmt="%.17g")


def read(path, entry: str, more: str = ""):
    (path / "brake.toml").write_text(f'brake = "own"\nM = [[1, 0], [0, 1]]\nK = {entry}\n{more}')
    return read_design(path / "brake.toml")


@pytest.mark.parametrize("name", ["K.npy", "K.mtx", "K.csv"])
def test_a_matrix_beside_the_file(name, tmp_path):
    written(name, tmp_path)
    assert np.array_equal(read(tmp_path, f'"{name}"').K, K)


def test_a_matrix_in_another_unit(tmp_path):
    written("K.npy", tmp_path)
    # 1e-15: one factor of 1e6 is multiplied on.
    brake = read(tmp_path, '{ file = "K.npy", unit = "kN/mm" }')
    assert np.allclose(brake.K, K * 1e6, rtol=1e-15, atol=0.0)


def test_a_matrix_in_a_folder_below(tmp_path):
    (tmp_path / "data").mkdir()
    written("K.csv", tmp_path / "data")
    assert np.array_equal(read(tmp_path, '"data/K.csv"').K, K)


@pytest.mark.parametrize("kind", ["<f4", ">f8", "<i4", "u1", "F"])
def test_real_numbers_of_any_kind(kind, tmp_path):
    array = np.asfortranarray(K) if kind == "F" else np.array([[2, 1], [1, 3]], dtype=kind)
    np.save(tmp_path / "K.npy", array)
    assert np.array_equal(read(tmp_path, '"K.npy"').K, array.astype(float))


def test_a_vector_in_a_column(tmp_path):
    (tmp_path / "load.csv").write_text("1.5\n2.5\n")
    assert np.array_equal(read(tmp_path, "[[1, 0], [0, 1]]", 'load = "load.csv"\n').load, [1.5, 2.5])


def _npy(shape, size: int = 0, kind: str = "'<f8'") -> bytes:
    """A file whose header says `shape`, followed by `size` bytes."""
    header = f"{{'descr': {kind}, 'fortran_order': False, 'shape': {shape}, }}".encode().ljust(117) + b"\n"
    return b"\x93NUMPY\x01\x00" + len(header).to_bytes(2, "little") + header + bytes(size)


def _saved(array, **keywords) -> bytes:
    stream = io.BytesIO()
    np.save(stream, array, **keywords)
    return stream.getvalue()


def _zipped() -> bytes:
    stream = io.BytesIO()
    np.savez(stream, K=K)
    return stream.getvalue()


class Bomb:
    """Unpickled, this would write a file."""

    def __reduce__(self):
        return open, ("unpickled", "w")


HEAD = b"%%MatrixMarket matrix coordinate real general\n"
BAD = {
    "pickled objects": ("K.npy", _saved(np.array([[Bomb()]]), allow_pickle=True), "holds object, expected real"),
    "a pickle": ("K.npy", pickle.dumps(Bomb()), "is not a NumPy .npy file"),
    "an archive": ("K.npy", _zipped(), "is not a NumPy .npy file"),
    "empty": ("K.npy", b"", "is not a NumPy .npy file"),
    "text": ("K.npy", b"1 2\n", "is not a NumPy .npy file"),
    "only the magic": ("K.npy", b"\x93NUMPY\x01\x00", "is not a NumPy .npy file"),
    "a strange version": ("K.npy", b"\x93NUMPY\x09\x00" + bytes(200), "is not a NumPy .npy file"),
    "code in the header": ("K.npy", _npy("__import__('os').getcwd()"), "is not a NumPy .npy file"),
    "brackets in the header": ("K.npy", _npy("(" * 60), "is not a NumPy .npy file"),
    "a shape of words": ("K.npy", _npy("('a', 2)"), "is not a NumPy .npy file"),
    "larger than it is": ("K.npy", _npy("(2, 2)", 8), "is not as long as that"),
    "smaller than it is": ("K.npy", _npy("(1, 1)", 800), "is not as long as that"),
    "a petabyte": ("K.npy", _npy("(10000000, 10000000)"), "expected one or two axes of 1 to 2000 numbers"),
    "a negative shape": ("K.npy", _npy("(-2, 2)"), "expected one or two axes"),
    "no axes": ("K.npy", _saved(np.float64(3.0)), "expected one or two axes"),
    "three axes": ("K.npy", _saved(np.zeros((2, 2, 2))), "expected one or two axes"),
    "one axis": ("K.npy", _saved(np.ones(4)), "expected 2 axes"),
    "nothing in it": ("K.npy", _saved(np.zeros((0, 0))), "expected one or two axes"),
    "complex": ("K.npy", _saved(K + 1j), "holds complex128, expected real numbers"),
    "words": ("K.npy", _saved(np.array([["a"]])), "expected real numbers"),
    "dates": ("K.npy", _saved(np.array([["2020-01-01"]], dtype="M8")), "expected real numbers"),
    "records": ("K.npy", _saved(np.zeros((2, 2), dtype=[("a", "f8")])), "expected real numbers"),
    "nan": ("K.npy", _saved(np.array([[1.0, np.nan], [0.0, 1.0]])), "entry [0, 1] is nan"),
    "infinite": ("K.npy", _saved(np.array([[1.0, 0.0], [-np.inf, 1.0]])), "entry [1, 0] is -inf"),
    "another size": ("K.npy", _saved(np.eye(3)), "a matrix of 2 rows and columns"),
    "mtx, empty": ("K.mtx", b"", "is not a Matrix Market .mtx file"),
    "mtx, text": ("K.mtx", b"hello\n", "is not a Matrix Market .mtx file"),
    "mtx, no numbers": ("K.mtx", HEAD + b"2 2 4\n", "says it has 4 entries and has 0"),
    "mtx, huge": ("K.mtx", HEAD + b"100000000 100000000 1\n1 1 1.0\n", "expected one or two axes"),
    "mtx, more entries than bytes": ("K.mtx", HEAD + b"2 2 99999999999\n1 1 1.0\n", "entries and has 1"),
    "mtx, entry outside": ("K.mtx", HEAD + b"2 2 1\n3 3 1.0\n", "entry (3, 3) is outside 2 rows"),
    "mtx, not a number": ("K.mtx", HEAD + b"2 2 1\n1 1 x\n", "line 3: 'x' is not a number"),
    "mtx, nan": ("K.mtx", HEAD + b"2 2 1\n1 1 nan\n", "line 3: 'nan' is not a number"),
    "mtx, complex": ("K.mtx", HEAD.replace(b"real", b"complex") + b"2 2 1\n1 1 1 1\n", "expected real ones"),
    "mtx, a vector": (
        "K.mtx", b"%%MatrixMarket vector coordinate real general\n2 1\n1 1\n", "expected a matrix, coordinate or array"
    ),
    "csv, empty": ("K.csv", b"", "expected one or two axes"),
    "csv, ragged": ("K.csv", b"1,2\n3\n", "has rows of different lengths"),
    "csv, a header": ("K.csv", b"x,y\n1,2\n", "row 1: 'x' is not a number"),
    "csv, nan": ("K.csv", b"1,nan\n0,1\n", "row 1: 'nan' is not a number"),
    "csv, a formula": ("K.csv", b"=1+1,2\n0,1\n", "row 1: '=1+1' is not a number"),
    "csv, semicolons": ("K.csv", b"1.0;2,5\n0;1\n", "'2,5' has a decimal comma, expected a decimal point"),
    "csv, binary": ("K.csv", bytes(range(256)), "is not a .csv file of numbers"),
    "csv, quotes": ("K.csv", b'"1,2\n0,1\n', "is not a .csv file of numbers"),
    "csv, a wide row": ("K.csv", b"1," * 5000 + b"1\n", "expected one or two axes"),
}  # fmt: skip


@pytest.mark.parametrize("name", BAD)
def test_a_bad_matrix_gets_its_sentence(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    file, content, words = BAD[name]
    (tmp_path / file).write_bytes(content)
    with pytest.raises(DesignFileError) as caught:
        read(tmp_path, f'"{file}"')
    (problem,) = caught.value.problems
    assert words in problem.message
    assert (problem.line, problem.key) == (3, "K")
    assert "\n" not in problem.message
    assert {each.name for each in tmp_path.iterdir()} == {"brake.toml", file}


def test_a_link_out_of_the_folder_is_refused(tmp_path):
    (tmp_path / "secret").mkdir()
    written("K.npy", tmp_path / "secret")
    (tmp_path / "here").mkdir()
    (tmp_path / "here" / "K.npy").symlink_to(tmp_path / "secret" / "K.npy")
    with pytest.raises(DesignFileError, match="outside the folder"):
        read(tmp_path / "here", '"K.npy"')


def test_a_link_to_the_design_file_itself_is_followed(tmp_path):
    (tmp_path / "there").mkdir()
    written("K.npy", tmp_path / "there")
    read(tmp_path / "there", '"K.npy"')
    (tmp_path / "brake.toml").symlink_to(tmp_path / "there" / "brake.toml")
    assert np.array_equal(read_design(tmp_path / "brake.toml").K, K)


def test_a_file_too_large_is_not_read(tmp_path):
    with open(tmp_path / "K.npy", "wb") as file:
        file.truncate(100_000_000)
    with pytest.raises(DesignFileError, match="expected at most 64000000"):
        read(tmp_path, '"K.npy"')


def test_a_zip_bomb_is_not_opened(tmp_path):
    with zipfile.ZipFile(tmp_path / "K.npy", "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("K.npy", bytes(10_000_000))
    with pytest.raises(DesignFileError, match=r"is not a NumPy \.npy file"):
        read(tmp_path, '"K.npy"')

"""Matrix files in odd but legal and in broken forms: the right matrix or one sentence, none silently wrong."""

import itertools

import numpy as np
import pytest

from squealbox.files import DesignFileError, read_design

K = np.array([[2e6, -1e6], [-1e6, 2e6]])
NUMBERS = {  # spelling: how it writes a multiple of a million
    "plain": lambda x: f"{x:.1f}",
    "e": lambda x: f"{x:.16e}",
    "D": lambda x: f"{x:.6e}".replace("e", "D"),
    "d": lambda x: f"{x:.6e}".replace("e", "d"),
    "Q": lambda x: f"{x:.6e}".replace("e", "Q"),
    "implied": lambda x: f"{x:.6e}".replace("e+0", "+").replace("e+", "+"),
    "no digits behind": lambda x: f"{x / 1e6:.0f}.E6",
    "no digits before": lambda x: f"{x / 1e7:.2f}e7".replace("0.", "."),
    "plus": lambda x: f"{x:+.1f}",
    "padded": lambda x: f"{x / 1e6:.0f}.000000000000000D+0006",
}
BROKEN = {
    "comma": lambda x: f"{x / 1e6:.1f}e6".replace(".", ","),
    "unit": lambda x: f"{x:.1f}N",
    "cut": lambda x: f"{x / 1e6:.1f}e",
    "two points": lambda x: f"{x / 1e6:.1f}.0e6",
    "hex": lambda x: f"{int(x):#x}",
    "underscore": lambda x: f"{int(x):_}",
    "nan": lambda x: "nan",
    "words": lambda x: "two",
    "two numbers": lambda x: f"{x / 1e6:.1f}e6-{x / 1e6:.1f}e6",
    "too large": lambda x: "1e999",
}
LAYOUTS = {  # header form, symmetry, entries
    "general": ("coordinate", "general", [(1, 1), (1, 2), (2, 1), (2, 2)]),
    "lower": ("coordinate", "symmetric", [(1, 1), (2, 1), (2, 2)]),
    "upper": ("coordinate", "symmetric", [(1, 1), (1, 2), (2, 2)]),
    "both triangles": ("coordinate", "symmetric", [(1, 1), (1, 2), (2, 1), (2, 2)]),
    "array": ("array", "general", [(1, 1), (2, 1), (1, 2), (2, 2)]),
    "array, lower": ("array", "symmetric", [(1, 1), (2, 1), (2, 2)]),
}
SHAPES = {
    "unix": lambda text: text,
    "windows": lambda text: text.replace("\n", "\r\n"),
    "comments": lambda text: text.replace("\n", "\n% of a mesh\n\n", 1),
    "tabs": lambda text: text.replace(" ", "\t"),
}


def mtx(layout, spelling, symmetry=None, extra=(), count=None):
    form, usual, entries = LAYOUTS[layout]
    lines = [f"%%MatrixMarket MATRIX {form} real {symmetry or usual}"]
    lines.append(f"2 2 {len(entries) + len(extra) if count is None else count}" if form == "coordinate" else "2 2")
    for i, j in (*entries, *extra):
        value = spelling(K[i - 1, j - 1])
        lines.append(f"{i} {j} {value}" if form == "coordinate" else value)
    return "\n".join(lines) + "\n"


def read(folder, name, content):
    (folder / name).write_bytes(content if isinstance(content, bytes) else content.encode())
    (folder / "brake.toml").write_text(f'brake = "own"\nM = [[1, 0], [0, 1]]\nK = "{name}"\n')
    return read_design(folder / "brake.toml").K


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize(("layout", "spelling"), list(itertools.product(LAYOUTS, NUMBERS)))
def test_odd_but_legal_matrix_market_files_are_read_right(layout, spelling, shape, tmp_path):
    assert np.array_equal(read(tmp_path, "K.mtx", SHAPES[shape](mtx(layout, NUMBERS[spelling]))), K)


@pytest.mark.parametrize("spelling", NUMBERS)
@pytest.mark.parametrize("mark", [",", ";", "\t"])
def test_odd_but_legal_tables_are_read_right(mark, spelling, tmp_path):
    rows = [mark.join(NUMBERS[spelling](x) for x in row) for row in K]
    assert np.array_equal(read(tmp_path, "K.csv", "# stiffness\n" + "\n".join(rows)), K)


@pytest.mark.parametrize(("layout", "spelling"), list(itertools.product(LAYOUTS, BROKEN)))
def test_broken_numbers_get_one_sentence(layout, spelling, tmp_path):
    with pytest.raises(DesignFileError) as caught:
        read(tmp_path, "K.mtx", mtx(layout, BROKEN[spelling]))
    (problem,) = caught.value.problems
    assert "\n" not in problem.message
    assert "line 3" in problem.message


@pytest.mark.parametrize("mark", [";", "\t"])
def test_decimal_commas_between_other_marks_are_read_right(mark, tmp_path):
    rows = [mark.join(BROKEN["comma"](x) for x in row) for row in K]
    assert np.array_equal(read(tmp_path, "K.csv", "\n".join(rows)), K)


@pytest.mark.parametrize("spelling", sorted(set(BROKEN) - {"comma"}))
@pytest.mark.parametrize("mark", [";", "\t"])
def test_broken_tables_get_one_sentence(mark, spelling, tmp_path):
    with pytest.raises(DesignFileError) as caught:
        read(tmp_path, "K.csv", "\n".join(mark.join(BROKEN[spelling](x) for x in row) for row in K))
    assert len(caught.value.problems) == 1


E = NUMBERS["e"]
TWISTED = {
    "one triangle called general": (mtx("lower", E, "general"), "lower triangle only"),
    "upper triangle called general": (mtx("upper", E, "general"), "upper triangle only"),
    "given twice": (mtx("lower", E, extra=[(2, 1)]), "is given twice"),
    "too few": (mtx("lower", E, count=4), "says it has 4 entries and has 3"),
    "too many": (mtx("general", E, count=3), "says it has 3 entries and has 4"),
    "two triangles that differ": (mtx("both triangles", E).replace("2 1 -1", "2 1 -3"), "but entry (1, 2) is"),
    "pattern": ("%%MatrixMarket matrix coordinate pattern symmetric\n2 2 1\n1 1\n", "pattern without numbers"),
    "hermitian": (mtx("lower", E, "hermitian"), "expected general, symmetric or skew-symmetric"),
    "skew with a diagonal": (mtx("lower", E, "skew-symmetric"), "numbers on its diagonal"),
    "an index of 0": (mtx("lower", E).replace("2 1 ", "0 1 "), "is outside"),
    "a column more": (mtx("lower", E).replace("2 1 ", "2 1 1 "), "expected row, column and value"),
    "an array too short": ("%%MatrixMarket matrix array real general\n2 2\n1\n2\n3\n", "has 3 numbers, expected 4"),
}


@pytest.mark.parametrize("name", TWISTED)
def test_what_a_file_leaves_open_gets_one_sentence(name, tmp_path):
    content, words = TWISTED[name]
    with pytest.raises(DesignFileError) as caught:
        read(tmp_path, "K.mtx", content)
    (problem,) = caught.value.problems
    assert words in problem.message


@pytest.mark.parametrize("name", ["K.npy", "K.csv", "K.mtx"])
def test_one_triangle_is_asked_about(name, tmp_path):
    half = np.tril(K)
    if name == "K.npy":
        np.save(tmp_path / name, half)
    elif name == "K.csv":
        np.savetxt(tmp_path / name, half, delimiter=",")
    else:
        (tmp_path / name).write_text(mtx("lower", E, "general"))
    for said, right in (("mirrored", K), ("as_given", half)):
        entry = f'{{ file = "{name}", triangle = "{said}" }}'
        (tmp_path / "brake.toml").write_text(f'brake = "own"\nM = [[1, 0], [0, 1]]\nK = {entry}\n')
        assert np.array_equal(read_design(tmp_path / "brake.toml").K, right)
    with pytest.raises(DesignFileError, match="triangle only"):
        read(tmp_path, name, (tmp_path / name).read_bytes())
    (tmp_path / "brake.toml").write_text(
        f'brake = "own"\nM = [[1, 0], [0, 1]]\nK = {{ file = "{name}", triangle = "x" }}\n'
    )
    with pytest.raises(DesignFileError, match="expected one of mirrored, as_given"):
        read_design(tmp_path / "brake.toml")


def test_a_mass_matrix_is_tested_for_symmetry_by_its_own_size(tmp_path):
    M = "[[1e-9, 5e-10], [2e-10, 1e-9]]"  # an absolute tolerance of 1e-8 takes it for symmetric
    (tmp_path / "brake.toml").write_text(f'brake = "own"\nM = {M}\nK = [[1, 0], [0, 1]]\n')
    with pytest.raises(DesignFileError, match="a symmetric mass matrix"):
        read_design(tmp_path / "brake.toml")

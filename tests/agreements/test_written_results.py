"""Every result, written as files and read back, holds the same numbers; what cannot be written is said."""

import csv
import dataclasses
import resource
import signal

import numpy as np
import pytest

from result_examples import EXAMPLES
from squealbox import LinearSlope, hopf_point, write
from squealbox.cli import main
from squealbox.designs import DrumBrake
from squealbox.files import write_design
from squealbox.parameters import ParameterError
from squealbox.result import Result, ResultFileError, quantity
from squealbox.stability import complex_modes, stability_boundary
from squealbox.writing import made, write_table

TEN_DIGITS = 1e-9  # of a table


def read(path):
    """The columns of a table, head to words."""
    with path.open(newline="") as stream:
        heads, *rows = csv.reader(stream)
    assert len(heads) == len(set(heads)), "no head stands twice"
    return dict(zip(heads, zip(*rows, strict=True) if rows else [()] * len(heads), strict=True))


def same(words, values):
    """Whether a column says what it was given, to ten digits."""
    if values.dtype.kind == "f":
        return np.allclose(np.array(words, dtype=float), values, rtol=TEN_DIGITS, atol=0.0, equal_nan=True)
    return list(words) == [str(each) for each in values.tolist()]


@pytest.mark.parametrize("name", list(EXAMPLES))
def test_written_and_read_back_it_holds_the_same_numbers(name, tmp_path, monkeypatch):
    monkeypatch.setattr("squealbox.plots.save", lambda figure, stem: [stem.with_name(f"{stem.name}.png")])
    result = EXAMPLES[name]()
    paths = write(result, tmp_path / "new" / "folder", "it")
    assert [path.name for path in paths] == ["it.nc", "it.csv", "it.png"]
    assert {path.name for path in paths[0].parent.iterdir()} == {"it.nc", "it.csv"}
    back = Result.load(paths[0])
    assert type(back) is type(result)
    assert back.settings.keys() == result.settings.keys()
    for field in dataclasses.fields(result):
        if "dims" in field.metadata:
            np.testing.assert_array_equal(getattr(back, field.name), getattr(result, field.name))
    told, columns = read(paths[1]), {head: np.asarray(each) for head, each in result.table().items()}
    assert list(told) == list(columns)
    assert [head for head, values in columns.items() if not same(told[head], values)] == []
    assert len(next(iter(columns.values()))) > 0


def test_a_number_that_was_changed_is_found():
    values = np.array([1.0, np.nan, 1e-300])
    assert same(["1", "nan", "1e-300"], values)
    assert not same(["1.00000001", "nan", "1e-300"], values)
    assert not same(["1", "0", "1e-300"], values)


def test_a_file_is_named_after_its_kind_and_a_failed_computation_has_no_figure(tmp_path):
    quiet = EXAMPLES["Boundary"]()
    names = [path.name for path in write(quiet, tmp_path)]
    assert names == ["boundary.nc", "boundary.csv", "boundary.png", "boundary.svg"]
    nowhere = stability_boundary(DrumBrake(), {"friction.static": (0.01, 0.02), "k1": (18e6, 20e6)}, cells=4)
    assert not nowhere.outcome.ok
    assert [path.name for path in write(nowhere, tmp_path, "none")] == ["none.nc", "none.csv"]


def test_angles_are_told_in_degrees_and_rotations_in_radians():
    table = stability_boundary(DrumBrake(), {"theta1": (0.3, 2.8), "theta2": (0.3, 2.8)}, cells=8).table()
    assert 20.0 < np.max(table["theta1 [deg]"]) < 180.0
    turning = EXAMPLES["Trajectory"]()
    system = dataclasses.replace(turning, inputs={"system": turning.system.replace(angles=("y",))})
    assert {"x [m]", "dx/dt [m/s]", "y [rad]", "dy/dt [rad/s]"} <= set(system.table())
    push = EXAMPLES["DangerousPush"]().table()
    assert (list(push), list(push["unit"])) == (["state", "unit", "push"], ["m", "m", "m/s", "m/s"])
    born = hopf_point(DrumBrake(friction=LinearSlope(0.45, -0.02)), {"theta1": (1.9, 2.0)})
    assert next(iter(born.table())) == "theta1 [deg]"
    point = EXAMPLES["DesignPoint"]().table()
    assert list(point)[:4] == ["parameter", "unit", "squeals at", "median"]


@dataclasses.dataclass(frozen=True, kw_only=True, eq=False)
class Twice(Result):
    """An array of the name of a freedom."""

    q: np.ndarray = quantity("time dof", "m", "displacement")
    x: np.ndarray = quantity("time", "m", "something else")

    table_over = ("time",)


def test_no_column_takes_the_place_of_another():
    found = Twice(q=np.zeros((3, 2)), x=np.ones(3), inputs={"system": DrumBrake()}).table()
    assert {head: values[0] for head, values in found.items()} == {"x [m]": 0.0, "y [m]": 0.0, "x: x [m]": 1.0}


def test_a_folder_that_is_a_file_is_a_sentence(tmp_path):
    (tmp_path / "file").write_text("mine")
    for place in (tmp_path / "file", tmp_path / "file" / "below"):
        with pytest.raises(
            ResultFileError, match=r"a file of that name|no folder can be made there \(Not a directory\)"
        ):
            made(place)
    with pytest.raises(ResultFileError, match="expected a folder or a name for a new one"):
        write(complex_modes(DrumBrake()), tmp_path / "file")
    assert (tmp_path / "file").read_text() == "mine"


@pytest.fixture
def full(monkeypatch):
    """A disc that takes files of so many bytes."""
    old, handled = resource.getrlimit(resource.RLIMIT_FSIZE), signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    yield lambda most: resource.setrlimit(resource.RLIMIT_FSIZE, (most, old[1]))
    resource.setrlimit(resource.RLIMIT_FSIZE, old)
    signal.signal(signal.SIGXFSZ, handled)


def test_a_full_disc_is_a_sentence_and_old_files_stay(full, tmp_path):
    modes = complex_modes(DrumBrake())
    old = {path.name: path.read_bytes() for path in write(modes, tmp_path, "modes")}
    data, table, figure = (len(old[f"modes.{end}"]) for end in ("nc", "csv", "png"))
    assert table < data < data + 2000 < figure
    other = complex_modes(DrumBrake().replace({"friction.static": 0.45}))
    full(data // 2)
    with pytest.raises(ResultFileError, match=r"modes\.nc: cannot be written, File too large$"):
        write(other, tmp_path, "modes")
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == old
    full(data + 2000)
    with pytest.raises(ResultFileError, match=r"modes\.png: cannot be written, .*; modes\.nc, modes\.csv written$"):
        write(other, tmp_path, "modes")
    now = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    assert now.keys() == old.keys(), "nothing half-written is left"
    assert [name for name in old if now[name] != old[name]] == ["modes.nc", "modes.csv"]


def test_a_command_says_it_in_a_line(full, tmp_path, capsys):
    file = write_design(DrumBrake(), tmp_path / "brake.toml")
    full(2000)
    assert main(["modes", str(file), "--out", str(tmp_path / "out")]) == 2
    full(resource.getrlimit(resource.RLIMIT_FSIZE)[1])
    assert capsys.readouterr().err == f"squealbox modes: {tmp_path}/out/modes.nc: cannot be written, File too large\n"
    assert list((tmp_path / "out").iterdir()) == []


def test_columns_of_different_lengths_are_refused_and_nothing_is_left(tmp_path):
    with pytest.raises(ValueError, match="shorter"):
        write_table(tmp_path / "t.csv", {"a": [1.0, 2.0], "b": [1.0]})
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("wrong", [None, "modes", 3.0])
def test_what_is_no_result_is_refused(wrong, tmp_path):
    with pytest.raises(ParameterError, match="write.result = .*: expected what an analysis returns"):
        write(wrong, tmp_path)


@pytest.mark.parametrize("name", ["..", ".", "../up", "/tmp/elsewhere"])
def test_no_file_is_written_outside_its_folder(name, tmp_path):
    with pytest.raises(ParameterError, match="write.name = .*: expected a name for files within the folder"):
        write(complex_modes(DrumBrake()), tmp_path / "out", name)
    assert not list(tmp_path.rglob("*"))


@pytest.mark.parametrize("name", list(EXAMPLES))
def test_a_result_is_asked_for_the_unit_of_what_it_does_not_know(name):
    result = EXAMPLES[name]()
    measured = {**result.settings, "units": ["", "Hz"]}  # as of rows that are compared
    assert dataclasses.replace(result, settings=measured).unit_of("") == ""

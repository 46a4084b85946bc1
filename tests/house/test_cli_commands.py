"""Every command of the command line, called in this process: what it prints, writes and returns."""

import csv
import json

import numpy as np
import pytest

from squealbox import DrumBrake, complex_modes, critical_value, equilibrium
from squealbox.cli import COMMANDS, main
from squealbox.files import BRAKES, read_design, read_file
from squealbox.files.reading import MESHED
from squealbox.result import Outcome, Result
from squealbox.transient import MotionSettings


@pytest.fixture
def undrawn(monkeypatch):
    """No figures, for tests of something else."""
    monkeypatch.setattr("squealbox.plots.save", lambda figure, path: [])
    monkeypatch.setattr("squealbox.plots.plot", lambda *arguments, **keywords: None)
    monkeypatch.setattr("squealbox.plots.energy", lambda *arguments, **keywords: None)


def rows(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


def test_help_names_every_command(said):
    for words in ([], ["--help"], ["-h"], ["help"]):
        code, out, err = said(*words)
        assert (code, err) == (0, "")
        assert all(f"\n  {name} " in out for name in COMMANDS)


def test_version(said):
    import squealbox

    assert said("--version") == (0, f"squealbox {squealbox.__version__}\n", "")


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["mods"], "squealbox: unknown command 'mods': did you mean 'modes'?"),
        (["--vresion"], "squealbox: unknown option '--vresion'"),
        (["modes"], "squealbox modes: FILE is missing: squealbox modes FILE"),
        (["modes", "a", "b", "c"], "squealbox modes: unexpected words: b c"),
        (["onset", "a", "--rnge", "0", "1"], "Unknown option: --rnge. Did you mean --range?"),
        (["onset", "a", "--range", "0"], "--range requires 2"),
        (["map", "a", "--points", "many"], "--points"),
        (["modes", "no.toml"], "no.toml: there is no such file"),
        (["run", "no.toml"], "--out is missing"),
        (["simulate", "no.toml"], "no.toml: there is no such file"),
        (["simulate", "no.toml", "--out", "x"], "no.toml: there is no such file"),
        (["paper", "drum-brake"], "squealbox paper: 'drum-brake' is no paper this program knows: did you mean"),
        (["list", "drum_brak"], "did you mean 'drum_brake'?"),
        (["init", "x", "--brake", "drum"], "squealbox init: --brake drum: one of drum_brake"),
    ],
)
def test_bad_words_get_one_sentence(words, sentence, said, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    code, out, err = said(*words)
    assert (code, out) == (2, "")
    assert sentence in err
    assert err.count("\n") == 1
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["modes", "--set", "m"], "--set m: expected NAME=VALUE"),
        (["modes", "--set", "mm=1"], "--set mm=1: unknown parameter, did you mean 'm'?"),
        (["modes", "--set", "m=1 N"], "--set m=1 N: '1 N' has the unit N (a force), expected kg (a mass)"),
        (["modes", "--set", "m=-1"], "--set m=-1: expected a finite number in (0, inf) kg"),
        (["modes", "--set", "m=nan"], "--set m=nan: 'nan' is not a number"),
        (["modes", "--set", "reading=eq4"], "--set reading=eq4: did you mean 'eq3'?"),
        (["modes", "--set", "friction=3"], "--set friction=3: unknown parameter"),
        (["onset", "--parameter", "m"], "nothing says over which range"),
        (["onset", "--parameter", "x", "--range", "0", "1"], "--parameter x: unknown parameter"),
        (["onset", "--range", "1", "0"], "--range 1 0: expected the lower value first"),
        (["onset", "--range", "0", "20"], "--range 0 20: expected finite numbers in [0, 10]"),
        (["onset", "--range", "0 kg", "1"], "'0 kg' has the unit kg (a mass), expected a plain number"),
        (["map", "--x", "m", "1", "2", "--y", "m", "1", "2"], "x and y are both m"),
        (["map", "--points", "1"], "--points 1: expected a finite number in [2, 20001]"),
        (["simulate", "--duration", "1 mm"], "--duration 1 mm: '1 mm' has the unit mm (a length), expected s"),
        (["simulate", "--duration", "0"], "--duration 0: expected a finite number in (0, inf) s"),
        (["simulate", "--method", "euler"], "--method euler: expected one of usual, taylor"),
        (["simulate", "--contact", "exakt"], "--contact exakt: did you mean 'exact'?"),
        (["simulate", "--start", "slidin"], "--start slidin: did you mean 'sliding'?"),
        (["simulate", "--set", "sliding_speed=0", "--start", "sliding"], "there is no steady sliding to start from"),
    ],
)
def test_bad_options_get_one_sentence_and_nothing_is_written(words, sentence, said, brake, tmp_path):
    code, out, err = said(words[0], brake, *words[1:], "--out", tmp_path / "out")
    assert (code, out) == (2, "")
    assert sentence in err
    assert err.count("\n") == 1
    assert not (tmp_path / "out").exists()


def test_a_bad_file_says_all_its_problems(said, tmp_path):
    path = tmp_path / "brake.toml"
    path.write_text('brake = "drum_brake"\nm = -1\nload = "1 kg"\n')
    code, out, err = said("simulate", path, "--out", tmp_path / "out")
    assert (code, out) == (2, "")
    assert err.splitlines() == [
        f"{path}:2: m: -1: expected a finite number in (0, inf) kg",
        f"{path}:3: load: '1 kg' has the unit kg (a mass), expected N (a force)",
    ]
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize("name", [name for name in BRAKES if name not in MESHED])
def test_init_writes_an_example_that_runs(name, said, tmp_path, undrawn):
    code, out, _ = said("init", tmp_path / "new" / "folder", "--brake", name)
    path = tmp_path / "new" / "folder" / "brake.toml"
    assert code == 0
    assert str(path) in out
    found = read_file(path)
    assert None not in (found.modes, found.onset, found.map, found.simulate)
    assert said("modes", path)[0] == 0
    assert said("simulate", path, "--out", tmp_path / "out")[0] == 0
    assert said("run", path, "--out", tmp_path / "study")[0] == 0


@pytest.mark.parametrize("name", MESHED)
def test_init_says_how_a_meshed_brake_begins(name, said, tmp_path):
    code, _, err = said("init", tmp_path / "new", "--brake", name)
    assert code == 2
    assert "section [modes]" in err
    assert not (tmp_path / "new").exists()


def test_init_overwrites_nothing(said, brake):
    before = brake.read_text()
    code, _, err = said("init", brake.parent)
    assert code == 2
    assert "is there already" in err
    assert brake.read_text() == before


def test_list_names_what_there_is(said):
    code, out, _ = said("list")
    assert code == 0
    for word in ("drum_brake", "own", "linear_slope", "ramp", "bogacki-shampine", "drum-brake-2011"):
        assert f"  {word} " in out


def test_list_shows_the_parameters_of_a_design(said):
    _, out, _ = said("list", "drum_brake")
    for name, about in DrumBrake.parameters().items():
        assert f"  {name} " in out
        assert about.range in out
    assert "eq3_signed" in out
    assert "load sets load1 and load2" in out


def test_schema_is_json(said):
    code, out, _ = said("schema")
    assert code == 0
    assert json.loads(out)["title"] == "squealbox design file"


def test_modes(said, brake, tmp_path):
    code, out, err = said("modes", brake, "--out", tmp_path / "out")
    assert (code, err) == (0, "")
    modes = complex_modes(read_design(brake))
    assert modes.summary() in out
    assert "flutter" in out
    names = {"modes.nc", "modes.csv", "modes.png", "modes.svg", "mode_energy.png", "mode_energy.svg"}
    assert {path.name for path in (tmp_path / "out").iterdir()} == names
    table = rows(tmp_path / "out" / "modes.csv")
    assert [float(row["growth rate [1/s]"]) for row in table] == pytest.approx(modes.growth_rate[:2], rel=1e-9)
    assert Result.load(tmp_path / "out" / "modes.nc").eigenvalues == pytest.approx(modes.eigenvalues, rel=0)


def test_a_change_for_one_run(said, brake):
    _, out, _ = said("modes", brake, "--set", "friction.static=0.1", "load=2 kN", "reading=eq3")
    assert (
        complex_modes(read_design(brake).replace({"friction.static": 0.1, "load": 2e3, "reading": "eq3"})).summary()
        in out
    )
    assert "STABLE" in out


def test_onset_by_the_file_and_by_the_options(said, brake, tmp_path):
    value = float(critical_value(read_design(brake), "friction.static", (0.0, 1.0)).value)
    for words in ([], ["--parameter", "friction.static", "--range", "0", "1"], ["--range", "0", "50 %"]):
        code, out, err = said("onset", brake, *words)
        assert (code, err) == (0, "")
        assert f"friction.static = {value:.7g}: squeal begins; above it a mode of" in out
    assert said("onset", brake, "--out", tmp_path / "out")[0] == 0
    assert {path.name for path in (tmp_path / "out").iterdir()} == {"onset.nc", "onset.png", "onset.svg", "onset.csv"}
    table = rows(tmp_path / "out" / "onset.csv")
    assert np.min(np.abs([float(row["friction.static [-]"]) - value for row in table])) < 1e-9


def test_an_angle_is_read_and_said_in_degrees(said, brake):
    code, out, _ = said("onset", brake, "--parameter", "theta1", "--range", "10 deg", "90deg")
    assert code == 0
    assert "theta1 = 80.8" in out
    assert " deg: squeal begins; above it" in out


def test_no_onset_is_a_failed_computation(said, brake, tmp_path):
    code, out, err = said("onset", brake, "--range", "0", "0.1")
    assert (code, out) == (1, "")
    assert err == "squealbox onset: no_onset: stable in the whole range\n"


def test_map(said, brake, tmp_path):
    words = ["--x", "friction.static", "0", "1", "--y", "theta1", "20deg", "80deg", "--points", "7"]
    code, out, err = said("map", brake, *words, "--out", tmp_path / "out")
    assert (code, err) == (0, "")
    table = rows(tmp_path / "out" / "map.csv")
    assert len(table) == 49
    last = {"friction.static": 1.0, "theta1": np.deg2rad(80.0)}
    growth = np.max(complex_modes(read_design(brake).replace(last)).growth_rate)
    assert float(table[-1]["growth rate [1/s]"]) == pytest.approx(growth, rel=1e-9)
    unstable = sum(float(row["growth rate [1/s]"]) > 0.0 for row in table)
    assert f"{unstable} of 49 points are unstable" in out
    names = {"map.nc", "map.png", "map.svg", "map.csv", "boundary.csv"}
    assert {path.name for path in (tmp_path / "out").iterdir()} == names


def test_map_says_and_writes_the_boundary(said, brake, tmp_path):
    words = ["--x", "friction.static", "0", "1", "--y", "theta1", "20deg", "80deg", "--points", "7"]
    code, out, err = said("map", brake, *words, "--show", "mechanism", "--out", tmp_path / "out")
    assert (code, err) == (0, "")
    assert "mechanism of the unstable points: flutter" in out
    edge = rows(tmp_path / "out" / "boundary.csv")
    assert f"boundary: {edge[-1]['piece']} piece" in out
    assert all(20.0 <= float(row["theta1 [deg]"]) <= 80.0 for row in edge)
    assert max(abs(float(row["growth rate [1/s]"])) for row in edge) < 1e-9
    mu, angle = (float(edge[5][name]) for name in ("friction.static [-]", "theta1 [deg]"))
    there = read_design(brake).replace({"theta1": np.deg2rad(angle)})
    onset = critical_value(there, "friction.static", (mu - 0.02, mu + 0.02)).value
    assert float(onset) == pytest.approx(mu, abs=1e-8)  # the table has ten digits


def test_map_without_a_boundary_says_so(said, brake):
    words = ["--x", "friction.static", "0.01", "0.02", "--y", "theta1", "20deg", "80deg", "--points", "7"]
    assert "boundary: none, stability does not change in the rectangle" in said("map", brake, *words)[1]


def test_map_by_the_file(said, brake):
    assert "of 10201 points are unstable" in said("map", brake)[1]


def test_simulate(said, brake, tmp_path):
    folder = tmp_path / "out"
    code, out, err = said("simulate", brake, "--out", folder, "--duration", "30 ms")
    assert (code, err) == (0, "")
    assert "x: Settles on a cycle" in out
    names = {path.name for path in folder.iterdir()}
    assert names == {
        "verdict.txt", "motion.nc", "motion.csv", "energy.png", "energy.svg", "motion_x.png", "motion_x.svg",
        "motion_y.png", "motion_y.svg", "motion.wav",
    }  # fmt: skip
    assert (folder / "verdict.txt").read_text() in out
    motion = Result.load(folder / "motion.nc")
    assert motion.outcome == "completed"
    assert motion.system == read_design(brake).system()
    table = rows(folder / "motion.csv")
    assert len(table) == len(motion.t) == 5001
    assert float(table[-1]["x [m]"]) == pytest.approx(motion.q[-1, 0], rel=1e-9)
    there = sorted(tmp_path.rglob("*"))
    code, answer, err = said("simulate", brake, "--duration", "30 ms")
    assert (code, err) == (0, "")
    assert out.startswith(answer)
    assert sorted(tmp_path.rglob("*")) == there


def test_basin(said, brake, tmp_path):
    out_folder = tmp_path / "basin"
    options = ("--set", "friction.static=0.33", "--starts", "64", "--spread", "2")
    code, out, err = said("basin", brake, *options, "--plane", "x'", "y'", "--out", out_folder)
    assert (code, err) == (0, "")
    assert "% of 64 starts vibrate" in out
    assert "stable cycle, amplitude" in out
    assert sorted(path.name for path in out_folder.iterdir()) == ["basin.csv", "basin.nc", "basin.png", "basin.svg"]
    code, _, err = said("basin", brake, *options, "--plane", "x", "z")
    assert code == 2
    assert "plane" in err


def test_cycle(said, brake, tmp_path):
    code, out, err = said("cycle", brake, "--set", "friction.static=0.45", "--out", tmp_path / "cycle")
    assert (code, err) == (0, "")
    assert "stable cycle" in out
    names = ["cycle.csv", "cycle.nc", "cycle.png", "cycle.svg"]
    assert sorted(path.name for path in (tmp_path / "cycle").iterdir()) == names
    assert said("cycle", brake, "--set", "friction.static=0.1")[0] != 0


def test_simulate_as_the_section_says(said, brake, tmp_path, undrawn):
    text = brake.read_text().partition("[simulate]")[0]
    how = 'duration = "5 ms"\nstart = "sliding"\nq = ["1 um", 0]\nmethod = "dormand-prince"\ntimes = 11\n'
    brake.write_text(f"{text}[simulate]\n{how}")
    code, _, _ = said("simulate", brake, "--out", tmp_path / "out")
    motion = Result.load(tmp_path / "out" / "motion.nc")
    assert code == 0
    assert motion.t[-1] == 0.005
    assert motion.settings["tableau"] == "dormand-prince"
    assert len(motion.t) == 11
    assert motion.q[0] == pytest.approx(equilibrium(read_design(brake).system()).q + np.array([1e-6, 0.0]), rel=1e-12)


def test_a_run_that_cannot_go_on_exits_with_one(said, brake, tmp_path, monkeypatch, undrawn):
    follow = MotionSettings.run

    def stopped(*arguments):
        import dataclasses

        return dataclasses.replace(follow(*arguments), outcome=Outcome("step_underflow", "no step was small enough"))

    monkeypatch.setattr(MotionSettings, "run", stopped)
    code, out, err = said("simulate", brake, "--out", tmp_path / "out", "--duration", "5 ms")
    assert code == 1
    assert err == "squealbox simulate: step_underflow: no step was small enough\n"
    assert "Not decided" in out
    assert Result.load(tmp_path / "out" / "motion.nc").outcome == "step_underflow"


def test_an_interrupt_exits_with_130(said, brake, tmp_path, monkeypatch, undrawn):
    from squealbox.cli import stability

    def pressed(*arguments, **keywords):
        raise KeyboardInterrupt

    monkeypatch.setattr(stability, "complex_modes", pressed)
    assert said("modes", brake) == (130, "", "squealbox modes: stopped\n")
    follow = MotionSettings.run

    def interrupted(*arguments):
        import dataclasses

        return dataclasses.replace(follow(*arguments), outcome=Outcome("interrupted", "stopped by the user"))

    monkeypatch.setattr(MotionSettings, "run", interrupted)
    assert said("simulate", brake, "--out", tmp_path / "out", "--duration", "5 ms")[0] == 130


def test_an_error_inside_the_program_is_one_sentence(said, brake, monkeypatch):
    from squealbox.cli import stability

    def broken(*arguments, **keywords):
        raise RuntimeError("a\nb")

    monkeypatch.setattr(stability, "complex_modes", broken)
    code, _, err = said("modes", brake)
    assert code == 1
    assert "an error inside the program, RuntimeError: a b; SQUEALBOX_TRACEBACK=1 tells where" in err
    monkeypatch.setenv("SQUEALBOX_TRACEBACK", "1")
    with pytest.raises(RuntimeError):
        main(["modes", str(brake)])


@pytest.mark.parametrize(
    ("place", "words"),
    [("/proc/nowhere", "no folder can be made there"), ("brake.toml", "a file of that name is there")],
)
def test_a_folder_that_cannot_be_made_is_said(place, words, said, brake, tmp_path):
    place = str(brake) if place == "brake.toml" else place
    code, out, err = said("onset", brake, "--out", place)
    assert (code, out) == (2, "")
    assert err.startswith(f"squealbox onset: --out {place}: {words}")
    assert err.count("\n") == 1


def test_paper(said, tmp_path, monkeypatch):
    from squealbox.papers import drum_brake_2011

    def reproduce(out, progress=None, fine=False, search=False):
        assert not fine
        assert not search
        progress("half of it", 0.5)
        (out / "index.html").write_text("a page")
        return out / "index.html"

    monkeypatch.setattr(drum_brake_2011, "reproduce", reproduce)
    code, out, err = said("paper", "drum-brake-2011", "--out", tmp_path / "deep" / "study")
    assert (code, err) == (0, "")
    assert out == f"The page is at {tmp_path / 'deep' / 'study' / 'index.html'}\n"
    monkeypatch.chdir(tmp_path)
    assert said("paper", "drum-brake-2011")[1] == "The page is at drum-brake-2011/index.html\n"


def test_every_paper_listed_can_be_reproduced():
    import inspect
    from importlib import import_module

    from squealbox.cli.papers import PAPERS

    for paper in PAPERS.values():
        asked = list(inspect.signature(import_module(paper.module).reproduce).parameters)
        assert asked == ["out", "progress", "fine", "search"]

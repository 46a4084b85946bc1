"""The command line as people run it: a process with files, signals and pipes, and every hostile file from outside."""

import signal
import subprocess
import sys
import time

import pytest

from faults.hostile_files import HOSTILE
from house.rooms import PROJECT
from squealbox.cli import main
from squealbox.files import read_file
from squealbox.result import Result

COMMAND = [sys.executable, "-c", "import sys; from squealbox.cli import main; sys.exit(main())"]
EXAMPLES = sorted((PROJECT / "examples").glob("*.toml"))


def run(*words, **keywords) -> subprocess.CompletedProcess[str]:
    return subprocess.run([*COMMAND, *map(str, words)], capture_output=True, text=True, timeout=120, **keywords)


def test_a_whole_session(tmp_path):
    assert run("init", "brake", cwd=tmp_path).returncode == 0
    done = run("modes", "brake/brake.toml", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert "Steady sliding is UNSTABLE" in done.stdout


def test_a_bad_file_from_outside(tmp_path):
    (tmp_path / "brake.toml").write_text('brake = "drum_brake"\nload = "1 kg"\n')
    done = run("simulate", "brake.toml", "--out", "out", cwd=tmp_path)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == "brake.toml:2: load: '1 kg' has the unit kg (a mass), expected N (a force)\n"
    assert [path.name for path in tmp_path.iterdir()] == ["brake.toml"]


def test_a_reader_that_leaves_early_is_no_error():
    words = " ".join(f"'{word}'" for word in [*COMMAND, "list"])
    done = subprocess.run(f"{words} | head -1", shell=True, capture_output=True, text=True, timeout=60)
    assert (done.stdout, done.stderr) == ("designs (brake = ...):\n", "")


def test_ctrl_c_keeps_what_was_reached(tmp_path):
    assert main(["init", str(tmp_path)]) == 0
    assert main(["simulate", str(tmp_path / "brake.toml"), "--duration", "1 ms"]) == 0  # compiles the engine
    words = [*COMMAND, "simulate", str(tmp_path / "brake.toml"), "--out", str(tmp_path / "out"), "--duration", "1e4 s"]
    with subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        # The folder is made when the file has been understood; then it runs for seconds to its largest number of steps.
        for _ in range(1200):
            time.sleep(0.05)
            if (tmp_path / "out").exists():
                break
        time.sleep(0.15)  # what it reached is drawn afterwards, and a longer motion longer
        process.send_signal(signal.SIGINT)
        _, err = process.communicate(timeout=120)
    assert process.returncode == 130, err
    assert "Traceback" not in err
    if (tmp_path / "out" / "motion.nc").exists():  # otherwise it was stopped before it began to march
        assert Result.load(tmp_path / "out" / "motion.nc").outcome == "interrupted"


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_an_example_runs(path, capsys):
    found = read_file(path, allow_code=True)
    allowed = ["--allow-code"] if path.stem == "own_law" else []
    assert main(["modes", str(path), *allowed]) == 0
    for section, coarse in (("onset", []), ("map", ["--points", "21"])):  # the file's own: in test_cli_commands
        if getattr(found, section) is not None:
            assert main([section, str(path), *allowed, *coarse]) == 0
    assert capsys.readouterr().err == ""


def test_there_are_examples():
    assert len(EXAMPLES) >= 3


def test_every_hostile_file_is_refused_with_two_and_writes_nothing(tmp_path, capsys):
    path = tmp_path / "brake.toml"
    for name, (content, _, _, words) in HOSTILE.items():
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        assert main(["simulate", str(path), "--out", str(tmp_path / "out")]) == 2, name
        out, err = capsys.readouterr()
        assert out == "", name
        assert words in err, name
        assert "Traceback" not in err, name
        assert "inside the program" not in err, name
        assert list(tmp_path.iterdir()) == [path], name


LOAD = "import sys; from squealbox import Result; print(type(Result.load(sys.argv[1])).__name__)"


def test_what_a_command_saved_is_read_in_a_new_session(tmp_path):
    assert main(["init", str(tmp_path)]) == 0
    assert main(["modes", str(tmp_path / "brake.toml"), "--out", str(tmp_path)]) == 0
    words = [sys.executable, "-c", LOAD, str(tmp_path / "modes.nc")]
    done = subprocess.run(words, capture_output=True, text=True, timeout=60)
    assert (done.stdout, done.stderr) == ("ComplexModes\n", "")

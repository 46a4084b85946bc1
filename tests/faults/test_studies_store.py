"""Damaged, foreign, changed, full and locked folders: a sentence that says so, and nothing overwritten."""

import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import textwrap
from pathlib import Path

import numpy as np
import pytest

import squealbox
from faults.store_study import SPACE, answer, go_on
from squealbox import DrumBrake
from squealbox.cli import main
from squealbox.studies import (
    ForeignStore,
    StoreDamaged,
    StoreError,
    StoreFull,
    StoreLocked,
    StudyChanged,
    open_sweep,
    sweep,
)
from squealbox.studies.locking import Lock, is_held


def halted(folder, point=12, chunk=4, monkeypatch=None):
    """A folder with the blocks before `point`."""
    import squealbox.studies.executors as executors

    real = executors.evaluate

    def evaluate(task, start, values, tick=None):
        if start + len(values["load"]) > point:
            raise KeyboardInterrupt
        return real(task, start, values, tick)

    monkeypatch.setattr(executors, "evaluate", evaluate)
    found = sweep(DrumBrake(), SPACE, answer, out=folder, chunk=chunk)
    monkeypatch.setattr(executors, "evaluate", real)
    return found


def contents(folder):
    return {path.relative_to(folder): path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}


@pytest.fixture
def whole(tmp_path):
    sweep(DrumBrake(), SPACE, answer, out=tmp_path / "whole")
    return (tmp_path / "whole" / "sweep.nc").read_bytes()


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """Three of five blocks."""
    found = halted(tmp_path / "study", monkeypatch=monkeypatch)
    assert found.outcome == "interrupted"
    assert found.outcomes.tolist() == ["completed"] * 12 + ["not_run"] * 8
    return tmp_path / "study"


def test_what_is_there_can_be_seen_before_the_end(folder, whole):
    before = contents(folder)
    found = open_sweep(folder)
    assert found.outcome == "interrupted"
    np.testing.assert_array_equal(found["a"].values[:12], np.sqrt(np.arange(12.0)))
    assert np.all(np.isnan(found["a"].values[12:]))
    assert contents(folder) == before
    assert go_on(folder).outcome.ok
    assert (folder / "sweep.nc").read_bytes() == whole


@pytest.mark.parametrize("harm", ["flip", "truncate", "empty", "swap"])
def test_a_damaged_block_is_named_and_computed_again(folder, whole, harm):
    first, second, *_ = sorted((folder / "blocks").glob("*.npz"))
    data = bytearray(first.read_bytes())
    data[len(data) // 2] ^= 1
    damaged = {"flip": bytes(data), "truncate": bytes(data[:-40]), "empty": b"", "swap": second.read_bytes()}[harm]
    first.write_bytes(damaged)
    assert np.all(np.isnan(open_sweep(folder)["a"].values[:4]))  # never silently used
    assert go_on(folder).outcome.ok
    assert (folder / "sweep.nc").read_bytes() == whole
    assert first.with_suffix(".damaged").read_bytes() == damaged
    assert first.name in (folder / "run.log").read_text()


@pytest.mark.parametrize("name", ["study.json", "sweep.nc", "finished.json"])
@pytest.mark.parametrize("harm", ["flip", "truncate", "empty"])
def test_a_damaged_file_of_a_finished_study_is_named(tmp_path, whole, name, harm):
    path = tmp_path / "whole" / name
    data = bytearray(path.read_bytes())
    place = data.index(b"{") if harm == "flip" and name.endswith("json") else len(data) // 2
    data[place] ^= 1
    path.write_bytes({"flip": bytes(data), "truncate": bytes(data[: len(data) // 2]), "empty": b""}[harm])
    before = contents(tmp_path / "whole")
    for ask in (lambda: open_sweep(tmp_path / "whole"), lambda: go_on(tmp_path / "whole")):
        with pytest.raises(StoreDamaged, match=name):
            ask()
    assert contents(tmp_path / "whole") == before


def test_a_file_that_is_missing_is_named(tmp_path, whole):
    (tmp_path / "whole" / "sweep.nc").unlink()
    with pytest.raises(StoreDamaged, match=r"sweep\.nc is missing"):
        go_on(tmp_path / "whole")


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        (lambda f: sweep(DrumBrake(k1=2e7), SPACE, answer, out=f), r"design\.k1 was 19000000\.0 and is 20000000\.0"),
        (
            lambda f: sweep(DrumBrake(), {"load": np.arange(21.0)}, answer, out=f),
            r"space\.load\.points was 20 and is 21",
        ),
        (lambda f: sweep(DrumBrake(), {"load": np.arange(20.0)[::-1]}, answer, out=f), r"space\.load\.digest was"),
        (lambda f: sweep(DrumBrake(), {"load1": np.arange(20.0)}, answer, out=f), r"space\.load1\.\w+ was absent"),
        (lambda f: sweep(DrumBrake(), SPACE, lambda d: 1.0, out=f), r"analysis\.name was"),
        (lambda f: sweep(DrumBrake(), SPACE, answer, out=f, keep="a"), r"keep was \[\] and is \['a'\]"),
        (lambda f: sweep(DrumBrake(), SPACE, answer, out=f, seed=1), "seed was 0 and is 1"),
    ],
)
@pytest.mark.parametrize("state", ["stopped", "finished"])
def test_another_study_is_refused_and_says_what_changed(folder, changed, words, state):
    if state == "finished":
        go_on(folder)
    before = contents(folder)
    with pytest.raises(StudyChanged, match=words) as caught:
        changed(folder)
    assert caught.value.changes
    assert contents(folder) == before
    assert go_on(folder).outcome.ok


def test_an_analysis_with_another_text_or_setting_is_another_study(tmp_path):
    def make(factor):
        return lambda design: factor * design.load1

    sweep(DrumBrake(), SPACE, make(2.0), out=tmp_path / "study")
    assert sweep(DrumBrake(), SPACE, make(2.0), out=tmp_path / "study").outcome.ok
    with pytest.raises(StudyChanged, match=r"analysis\.source"):
        sweep(DrumBrake(), SPACE, make(3.0), out=tmp_path / "study")


def test_another_version_is_another_study(folder, monkeypatch):
    from squealbox.studies import fingerprint

    monkeypatch.setattr(fingerprint, "provenance", lambda: {"squealbox": "9.9", "numpy": np.__version__})
    with pytest.raises(
        StudyChanged, match=rf"versions\.squealbox was '{re.escape(squealbox.__version__)}' and is '9\.9'"
    ):
        go_on(folder)


def test_a_foreign_folder_is_refused(tmp_path):
    (tmp_path / "thesis.txt").write_text("years of work")
    with pytest.raises(ForeignStore, match=r"thesis\.txt"):
        go_on(tmp_path)
    with pytest.raises(ForeignStore, match=r"has no study\.json"):
        open_sweep(tmp_path)
    assert contents(tmp_path) == {(tmp_path / "thesis.txt").relative_to(tmp_path): b"years of work"}
    with pytest.raises(StoreError, match="cannot be written there"):
        go_on(tmp_path / "thesis.txt")


def test_a_store_of_another_format_and_a_strange_block_are_refused(folder):
    strange = folder / "blocks" / "notes.npz"
    strange.write_bytes(b"mine")
    with pytest.raises(ForeignStore, match=r"notes\.npz"):
        go_on(folder)
    strange.unlink()
    about = json.loads((folder / "study.json").read_text())
    (folder / "study.json").write_text(json.dumps({**about, "format": 99}))
    with pytest.raises(ForeignStore, match="format 99"):
        go_on(folder)


def test_what_was_half_written_is_cleared_away(folder, whole):
    (folder / "blocks" / "000000000012-000000000016-00.npz.part").write_bytes(b"half")
    (folder / "sweep.nc.part").write_bytes(b"half")
    assert go_on(folder).outcome.ok
    assert (folder / "sweep.nc").read_bytes() == whole
    assert not list(folder.rglob("*.part"))


def test_two_writers_cannot_meet(folder):
    before = contents(folder)
    code = f"""
        import sys, time
        from pathlib import Path
        from squealbox.studies.locking import Lock
        assert Lock(Path({str(folder)!r}) / "lock").acquire()
        print("held", flush=True)
        time.sleep(60)
    """
    with subprocess.Popen([sys.executable, "-c", textwrap.dedent(code)], stdout=subprocess.PIPE, text=True) as other:
        assert other.stdout.readline() == "held\n"
        with pytest.raises(StoreLocked, match="another process"):
            go_on(folder)
        assert is_held(folder / "lock")
        assert contents(folder) == before
        other.kill()
        other.wait()
    assert not is_held(folder / "lock")
    assert go_on(folder).outcome.ok


def test_a_lock_is_given_back(tmp_path):
    first, second = Lock(tmp_path / "lock"), Lock(tmp_path / "lock")
    assert first.acquire()
    assert not second.acquire()
    first.release()
    assert second.acquire()
    second.release()


FULL = """
    import resource, sys
    sys.path.insert(0, {tests!r})
    resource.setrlimit(resource.RLIMIT_FSIZE, ({limit}, {limit}))
    from faults.store_study import go_on
    from squealbox.studies import StoreFull
    try:
        go_on({folder!r})
    except StoreFull as error:
        print(error)
"""


@pytest.mark.parametrize(("limit", "blocks"), [(1500, 0), (6000, 5)], ids=["a block", "the whole"])
def test_a_full_disk_is_said_and_the_store_stays_valid(tmp_path, whole, limit, blocks):
    folder = tmp_path / "study"
    tests = os.path.dirname(os.path.dirname(__file__))
    code = textwrap.dedent(FULL.format(tests=tests, folder=str(folder), limit=limit))
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stderr
    assert "cannot be written" in done.stdout
    assert "what was finished before is safe" in done.stdout
    assert len(list((folder / "blocks").glob("*"))) == blocks if (folder / "blocks").exists() else blocks == 0
    assert go_on(folder).outcome.ok
    assert (folder / "sweep.nc").read_bytes() == whole


@pytest.fixture
def reachable(folder):
    """The study's folder in a place that another user may pass through, unlike pytest's own."""
    with tempfile.TemporaryDirectory() as place:
        os.chmod(place, 0o755)
        yield Path(shutil.copytree(folder, Path(place) / "study"))


def test_a_folder_that_may_not_be_written_is_said(reachable, whole):
    folder, before = reachable, contents(reachable)
    tests = os.path.dirname(os.path.dirname(__file__))
    for path in [folder, *folder.rglob("*")]:
        path.chmod(0o555 if path.is_dir() else 0o444)
    code = f"""
        import os, sys
        sys.path.insert(0, {tests!r})
        from faults.store_study import go_on
        from squealbox.studies import StoreError, open_sweep
        open_sweep({str(folder)!r})  # loads all that is needed, before it may not be read any more
        if os.getuid() == 0:
            os.setuid(65534)
        print(open_sweep({str(folder)!r}).outcome)
        try:
            go_on({str(folder)!r})
        except StoreError as error:
            print(error)
    """
    done = subprocess.run([sys.executable, "-c", textwrap.dedent(code)], capture_output=True, text=True, timeout=60)
    for path in [folder, *folder.rglob("*")]:
        path.chmod(0o755)
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("interrupted\n")
    assert "cannot be written there: Permission denied" in done.stdout
    assert contents(folder) == before
    assert go_on(folder).outcome.ok
    assert (folder / "sweep.nc").read_bytes() == whole


def test_a_block_that_cannot_be_written_loses_nothing(folder, whole, monkeypatch):
    real = os.fsync

    def full(handle):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(StoreFull, match="No space left on device"):
        go_on(folder)
    monkeypatch.setattr(os, "fsync", real)
    assert not list(folder.rglob("*.part"))
    assert go_on(folder).outcome.ok
    assert (folder / "sweep.nc").read_bytes() == whole


def test_the_command_line_says_it_in_a_sentence(folder, capsys):
    (folder / "study.json").write_text("{")
    assert main(["status", str(folder)]) == 1
    out, err = capsys.readouterr()
    assert "study.json is damaged" in err
    assert "Traceback" not in err + out

"""Every hostile design file gets its sentence, with line and key, at once and without a trace on the disk."""

import signal
from contextlib import contextmanager

import pytest

from faults.hostile_files import DRUM, HOSTILE
from squealbox.files import DesignFileError, read_file


@contextmanager
def within(seconds: float):
    """Fail instead of hanging: no file of a megabyte may take longer than this to be refused."""

    def late(number, frame):
        raise TimeoutError(f"took more than {seconds} s")

    before = signal.signal(signal.SIGALRM, late)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)


@pytest.mark.parametrize("name", HOSTILE)
def test_a_hostile_file_gets_its_sentence(name, tmp_path):
    content, line, key, words = HOSTILE[name]
    path = tmp_path / "in" / "brake.toml"
    path.parent.mkdir()
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    with within(20.0), pytest.raises(DesignFileError) as caught:
        read_file(path)
    problem = next((each for each in caught.value.problems if words in each.message), None)
    assert problem is not None, f"nothing says {words!r}:\n{caught.value}"
    assert (problem.line, problem.key) == (line, key)
    for each in caught.value.problems:
        assert "\n" not in each.message
        assert len(each.message) < 500
        assert str(each).startswith(f"{path}:")
    assert sorted(tmp_path.rglob("*")) == [path.parent, path]


def test_there_are_two_hundred():
    assert len(HOSTILE) >= 200


def test_all_problems_of_a_file_are_said_at_once(tmp_path):
    path = tmp_path / "brake.toml"
    path.write_text(
        'brake = "drum_brake"\nm = nan\nload = "1 kg"\nthetta1 = 1\nreading = "eq4"\n'
        '[friction]\nlaw = "coulomb"\nstatic = -1\n[onset]\nparameter = "thetta1"\nrange = [0, 1]\n'
        '[simulate]\nduration = "1 mm"\n'
    )
    with pytest.raises(DesignFileError) as caught:
        read_file(path)
    found = [(each.line, each.key) for each in caught.value.problems]
    assert found == [
        (2, "m"), (3, "load"), (4, "thetta1"), (5, "reading"), (8, "friction.static"), (10, "onset.parameter"),
        (13, "simulate.duration"),
    ]  # fmt: skip


def test_a_flood_of_problems_is_cut(tmp_path):
    path = tmp_path / "brake.toml"
    path.write_text(DRUM + "".join(f"x{i} = {i}\n" for i in range(5000)))
    with within(20.0), pytest.raises(DesignFileError) as caught:
        read_file(path)
    assert len(caught.value.problems) == 101
    assert caught.value.problems[-1].message == "and 4900 more problems like these"


@pytest.mark.parametrize("what", ["missing", "folder", "pipe"])
def test_what_is_no_file_is_said(what, tmp_path):
    import os

    path = tmp_path / "brake.toml"
    if what == "folder":
        path.mkdir()
    if what == "pipe":
        os.mkfifo(path)
    words = {"missing": "there is no such file", "folder": "it is a folder", "pipe": "it is not an ordinary file"}[what]
    with within(5.0), pytest.raises(DesignFileError, match=words):
        read_file(path)


def test_a_good_file_is_not_refused(tmp_path):
    path = tmp_path / "brake.toml"
    path.write_text(DRUM + 'load = "1 kN"\n')
    assert read_file(path).design.load1 == 1000.0

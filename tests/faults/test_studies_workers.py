"""Worker processes that die, hang or do not start: a point to blame is found, and the sweep goes on."""

import os
import signal
import time

import numpy as np
import psutil
import pytest

from squealbox import complex_modes, sweep, workers
from squealbox.studies import StudyError

LOADS = np.arange(24.0)


def children():
    return psutil.Process().children(recursive=True)


@pytest.fixture(autouse=True)
def nothing_is_left():
    yield
    assert not [each for each in children() if "squealbox.workers" in " ".join(each.cmdline())]


def falls():
    os.kill(os.getpid(), signal.SIGSEGV)


def leaves():
    print("out of brake pads", flush=True)
    os._exit(3)


def spins():
    while True:
        pass


@pytest.mark.parametrize(
    ("chunk", "dies", "hangs", "words"),
    [(1, falls, lambda: time.sleep(1000.0), "SIGSEGV"),
     (8, leaves, lambda: time.sleep(1000.0), "exit code 3: out of brake pads"),
     (None, falls, spins, "SIGSEGV")],
)  # fmt: skip
def test_a_poisonous_and_a_hanging_point_are_isolated(drum, chunk, dies, hangs, words):
    def answer(design):
        if design.load1 == 5.0:
            dies()
        if design.load1 == 13.0:
            hangs()
        return design.load1

    began = time.monotonic()
    table = sweep(drum, {"load": LOADS}, answer, workers=2, time_limit=1.5, chunk=chunk)
    assert time.monotonic() - began < 120.0  # some ten processes are started, on a machine with much else to do
    expected = np.full(24, "completed", dtype=object)
    expected[5], expected[13] = "worker_died", "time_limit"
    assert table.outcomes.tolist() == expected.tolist()
    assert words in table.failures[5]
    assert "1.5 s" in table.failures[13]
    good = np.delete(np.arange(24), [5, 13])
    np.testing.assert_array_equal(table["value"].values[good], LOADS[good])


def test_many_workers_give_the_bits_of_one_process(drum, tmp_path):
    space = {"friction.static": np.linspace(0.1, 0.5, 40), "load": np.linspace(1e3, 2e3, 25)}
    for name, how in {"one": {}, "three": {"workers": 3, "chunk": 37}}.items():
        sweep(drum, space, complex_modes, out=tmp_path / name, **how)
    assert (tmp_path / "one" / "sweep.nc").read_bytes() == (tmp_path / "three" / "sweep.nc").read_bytes()


def test_errors_of_points_come_back_from_workers(drum):
    def answer(design):
        return 1.0 / (design.load1 - 2.0)

    table = sweep(drum, {"load": LOADS[:4]}, answer, workers=2)
    assert table.failures == {2: "ZeroDivisionError: float division by zero"}


def test_what_cannot_be_sent_is_said(drum):
    lock = __import__("threading").Lock()
    with pytest.raises(StudyError, match="cannot be sent to another process"):
        sweep(drum, {"load": LOADS}, lambda design: lock.locked(), workers=1)


def test_an_analysis_that_returns_nonsense_is_said(drum):
    with pytest.raises(StudyError, match="returns a dict for a"):
        sweep(drum, {"load": LOADS}, lambda design: {"a": {}}, workers=2)


def test_workers_that_do_not_start_are_said(drum, monkeypatch):
    monkeypatch.setattr(workers, "_CODE", "raise SystemExit('no such library')")
    with pytest.raises(StudyError, match="do not start: exit code 1: no such library"):
        sweep(drum, {"load": LOADS}, lambda design: 1.0, workers=2)


@pytest.mark.parametrize(
    ("how", "words"),
    [
        ({"workers": 0}, "workers = 0"),
        ({"workers": 1.5}, "workers = 1.5"),
        ({"workers": 1, "time_limit": 0.0}, "time_limit = 0.0"),
        ({"workers": 1, "scheduler": "tcp://x:1"}, "both given"),
        ({"time_limit": 1.0}, "time_limit needs workers"),
    ],
)
def test_executors_that_make_no_sense_are_refused(drum, how, words):
    with pytest.raises(StudyError, match=words):
        sweep(drum, {"load": LOADS}, lambda design: 1.0, **how)

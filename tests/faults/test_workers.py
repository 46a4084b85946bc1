"""A worker process that dies, hangs, raises, prints, is stopped or loses its parent, and one that does none of it."""

import os
import pickle
import signal
import subprocess
import sys
import time

import psutil
import pytest

from squealbox import workers
from squealbox.workers import ANSWER, GONE, NOWHERE, READY, SAID, Crew, Ended, Worker

MODULE = "faults.asked_of_workers"
PATIENCE = 30.0  # s, on a machine with much else to do
PARENT = f"""
import sys, time
sys.path[:] = {sys.path!r}
print("once", flush=True)
from squealbox.workers import SAID, Worker
worker = Worker("{MODULE}:misbehaves")
worker.ask("%s")
while worker.heard.get()[1] != SAID:
    pass
print("at work", flush=True)
"""


def children(process=None):
    return [each for each in psutil.Process(process).children() if "squealbox.workers" in " ".join(each.cmdline())]


@pytest.fixture(autouse=True)
def nothing_is_left():
    yield
    assert not children()


@pytest.fixture
def worker():
    made = Worker(f"{MODULE}:misbehaves")
    yield made
    if not made._printed.closed:
        made.end()


def heard(worker):
    """What is heard of it until it answers or is gone: kinds, and what came last."""
    kinds = []
    while True:
        _, kind, what = worker.heard.get(timeout=PATIENCE)
        kinds.append(kind)
        if kind in (ANSWER, GONE):
            return kinds, what


def test_questions_are_answered_one_after_the_other():
    with Crew(f"{MODULE}:double") as crew:
        answers, numbers = {}, list(range(20))
        while len(answers) < 20:
            for each in crew.idle(2):
                if numbers:
                    each.ask(numbers[0], task=numbers.pop(0))
            assert len(children()) == 2
            answers |= {task: answer for _, task, answer in crew.news()}
    assert answers == {number: 2 * number for number in range(20)}


def test_what_is_larger_than_any_pipe_goes_both_ways(worker):
    large = "x" * 10_000_000
    worker.ask(large)  # before the process has begun
    assert heard(worker) == ([READY, SAID, ANSWER], large)
    worker.ask(large)
    assert heard(worker) == ([SAID, ANSWER], large)


def test_printing_and_reading_disturb_nobody(worker):
    worker.ask("prints")
    assert heard(worker) == ([READY, SAID, ANSWER], "prints")
    assert worker.end().printed == "this is no pickle\nnor is this"


@pytest.mark.parametrize(
    ("how", "words", "kinds", "at"),
    [("raises", "exit code 1: ValueError: no such brake", [SAID, GONE], (3, 5)),
     ("leaves", "exit code 1: enough", [SAID, GONE], (3, 5)),
     ("dies", "SIGKILL: last words", [SAID, GONE], (3, 5)),
     ("vanishes", "exit code 4", [GONE], NOWHERE)],
)  # fmt: skip
def test_how_it_ended_is_told_and_where_it_was(worker, how, words, kinds, at):
    worker.ask("anything")
    assert heard(worker)[0][-1] == ANSWER
    worker.ask(how)
    assert heard(worker) == (kinds, None)
    end = worker.end()
    assert end == Ended(words, at, end.printed)
    assert ("in misbehaves" in end.printed) == (how == "raises"), "the traceback is kept"


@pytest.mark.parametrize("how", ["hangs", "spins"])
def test_one_that_is_late_is_killed_and_another_takes_its_place(how):
    with Crew(f"{MODULE}:misbehaves") as crew:
        (first,) = crew.idle(1)
        first.ask(how, task="long", limit=0.5)
        found = []
        while not found:
            found = list(crew.news())
        assert found == [(first, "long", Ended("SIGKILL", (3, 5), "", late=True))]
        crew._heard.put((first, ANSWER, "too late after all"))
        (second,) = crew.idle(1)
        second.ask("anything")
        while not found[1:]:
            found += crew.news()
    assert found[1:] == [(second, True, "anything")]


def test_the_time_limit_begins_when_the_process_has():
    with Crew(f"{MODULE}:double") as crew:
        crew.idle(1)[0].ask(4, limit=0.2)  # less than a process takes to start
        found = []
        while not found:
            found += crew.news()
    assert found[0][2] == 8


def test_it_is_stopped_in_the_midst_of_its_work(worker):
    worker.ask("spins")
    while worker.heard.get(timeout=PATIENCE)[1] != SAID:
        pass
    began = time.monotonic()
    assert worker.end().how == "SIGKILL"
    assert time.monotonic() - began < 5.0


def test_it_leaves_when_it_is_asked_nothing_for_long():
    worker = Worker(f"{MODULE}:double", idle=0.3)
    worker.ask(1)
    assert heard(worker) == ([READY, ANSWER], 2)
    assert heard(worker) == ([GONE], None)
    assert worker.end() == Ended("exit code 0", NOWHERE, "")


@pytest.mark.parametrize(("how", "killed"), [("hangs", True), ("spins", True), ("spins", False)])
def test_it_leaves_with_its_parent_and_the_script_is_not_run_again(how, killed):
    script = PARENT % how + ("time.sleep(1000.0)" if killed else "")
    with subprocess.Popen(
        [sys.executable, "-c", script], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as parent:
        assert [parent.stdout.readline() for _ in range(2)] == ["once\n", "at work\n"]
        if killed:
            left = children(parent.pid)
            parent.kill()
            assert len(left) == 1
            assert not psutil.wait_procs(left, timeout=PATIENCE)[1], "it outlived its parent"
        out, errors = parent.communicate(timeout=PATIENCE)
    assert (out, errors, parent.returncode) == ("", "", -signal.SIGKILL if killed else 0)


def test_what_comes_along():
    with Crew(f"{MODULE}:surroundings", pickle.dumps("given"), environment={"OWN": "7"}, nice=3) as crew:
        crew.idle(1)[0].ask()
        found = []
        while not found:
            found += crew.news()
    assert found[0][2] == ("given", "7", os.nice(0) + 3, None)
    assert "OWN" not in os.environ


def test_a_system_without_niceness(monkeypatch):
    monkeypatch.setattr(workers, "_CODE", "import os; del os.nice; " + workers._CODE)
    worker = Worker(f"{MODULE}:double", nice=5)
    worker.ask(1)
    assert heard(worker) == ([READY, ANSWER], 2)
    worker.end()


@pytest.mark.parametrize(
    ("function", "given", "words"),
    [("no_such_module:double", b"", "ModuleNotFoundError: No module named 'no_such_module'"),
     (f"{MODULE}:halve", b"", f"AttributeError: module '{MODULE}' has no attribute 'halve'"),
     (f"{MODULE}:double", b"nonsense", "UnpicklingError")],
)  # fmt: skip
def test_one_that_cannot_begin_says_why(function, given, words):
    worker = Worker(function, given)
    worker.ask(1)
    assert heard(worker) == ([GONE], None)
    how = worker.end().how
    assert how.startswith("exit code 1: ")
    assert words in how

"""The command answers at once, and every command says what it does."""

import resource
import subprocess
import sys
from pathlib import Path

import pytest

from squealbox.cli import COMMANDS

COMMAND = Path(sys.executable).with_name("squealbox")
LIMIT = 0.5  # s of processor time; the clock on the wall also counts what else the machine does


def seconds(*arguments) -> float:
    """Processor time of the best of three runs."""
    times = []
    for _ in range(3):
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        done = subprocess.run([*arguments], capture_output=True, text=True, timeout=60, check=True)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        assert done.stdout.strip()
        times.append(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
    return min(times)


@pytest.mark.parametrize("option", ["--help", "--version"])
def test_the_command_answers_at_once(option):
    assert seconds(COMMAND, option) < LIMIT


def test_a_slow_answer_is_seen():
    slow = f"import time\nwhile time.process_time() < {LIMIT}: pass\nprint('late')"
    assert seconds(sys.executable, "-c", slow) > LIMIT


@pytest.mark.parametrize("name", COMMANDS)
def test_a_command_explains_itself(name, said):
    code, out, err = said(name, "--help")
    assert code == 0, err
    assert name in out

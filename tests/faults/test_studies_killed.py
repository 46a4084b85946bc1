"""kill -9 at random moments: nothing finished is lost or computed again, and the bytes in the end are the same.

A handful of kills in the usual run; SQUEALBOX_KILLS=50 for the whole of it.
"""

import os
import random
import signal
import subprocess
import sys
import time
from collections import Counter
from pathlib import Path

import psutil
import pytest

from faults import study_victim
from squealbox.studies import Store

KILLS = int(os.environ.get("SQUEALBOX_KILLS", "3"))
VICTIM = Path(study_victim.__file__)
BLOCKS = study_victim.POINTS // study_victim.CHUNK


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """The bytes of the sweep that nobody disturbed."""
    folder = tmp_path_factory.mktemp("whole")
    done = start(folder / "study", folder / "journal")
    assert done.communicate(timeout=120)[0] == "completed\n"
    return (folder / "study" / "sweep.nc").read_bytes()


def start(folder, journal, *kind):
    words = [sys.executable, str(VICTIM), str(folder), str(journal), *map(str, kind)]
    return subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)


def computed(journal):
    """How often each point was computed."""
    return Counter(int(line) for line in journal.read_text().split()) if journal.exists() else Counter()


def finished(folder):
    """The points that lie in finished blocks."""
    names = [path.name for path in (folder / "blocks").glob("*.npz")] if (folder / "blocks").exists() else []
    ends = [tuple(map(int, name.split("-")[:2])) for name in names]
    return {i for start, stop in ends for i in range(start, stop)}


def wait_for_work(process, folder, some, patience=60.0):
    """Until another few blocks are there, so that the kill comes in the midst of work."""
    limit = time.monotonic() + patience
    while len(finished(folder)) < some and process.poll() is None and time.monotonic() < limit:
        time.sleep(0.005)


@pytest.mark.parametrize(("kind", "slots"), [((), 1), (("workers", 2), 2)], ids=["one process", "two workers"])
def test_killed_again_and_again(tmp_path, whole, kind, slots):
    folder, journal = tmp_path / "study", tmp_path / "journal"
    chance = random.Random(5)
    kills, safe = 0, set()
    while kills < KILLS:
        before = computed(journal)
        process = start(folder, journal, *kind)
        step = (study_victim.POINTS - len(safe)) // (KILLS - kills + 1)
        wait_for_work(process, folder, len(safe) + chance.randrange(1, max(2, step)))
        time.sleep(chance.uniform(0.0, 0.02))
        if process.poll() is not None:
            break
        children = psutil.Process(process.pid).children(recursive=True)
        process.send_signal(signal.SIGKILL)
        process.wait(timeout=10)
        process.stdout.close()
        kills += 1
        _, alive = psutil.wait_procs(children, timeout=10)
        assert not alive, "workers outlived the process that directed them"
        again = computed(journal) - before
        assert not set(again) & safe, "a finished block was computed again"
        now = finished(folder)
        assert safe <= now, "a finished block was lost"
        assert len(Store.opened(folder).done) == len(now) / study_victim.CHUNK
        assert not Store.opened(folder).damaged
        safe = now
    assert kills == KILLS
    process = start(folder, journal, *kind)
    assert process.communicate(timeout=120)[0] == "completed\n"
    assert (folder / "sweep.nc").read_bytes() == whole
    twice = sum(count - 1 for count in computed(journal).values())
    assert twice <= kills * slots * study_victim.CHUNK, "more than the blocks in flight was computed twice"
    assert set(computed(journal)) == set(range(study_victim.POINTS))


def test_workers_killed_from_outside_change_nothing(tmp_path, whole):
    folder, journal = tmp_path / "study", tmp_path / "journal"
    process = start(folder, journal, "workers", 2)
    chance = random.Random(7)
    for kill in range(min(KILLS, 8)):
        wait_for_work(process, folder, 30 + 50 * kill)
        children = [c for c in psutil.Process(process.pid).children() if c.status() != psutil.STATUS_ZOMBIE]
        if children:
            chance.choice(children).send_signal(signal.SIGKILL)
    assert process.communicate(timeout=120)[0] == "completed\n"
    assert (folder / "sweep.nc").read_bytes() == whole
    assert "SIGKILL" in (folder / "run.log").read_text()


def test_ctrl_c_leaves_a_study_that_goes_on(tmp_path, whole):
    folder, journal = tmp_path / "study", tmp_path / "journal"
    process = start(folder, journal, "workers", 2)
    wait_for_work(process, folder, 100)
    process.send_signal(signal.SIGINT)
    assert process.communicate(timeout=30)[0] == "interrupted\n"
    held = finished(folder)
    assert 0 < len(held) < study_victim.POINTS
    assert "stopped by the user" in (folder / "run.log").read_text()
    before = computed(journal)
    process = start(folder, journal)
    assert process.communicate(timeout=120)[0] == "completed\n"
    assert not set(computed(journal) - before) & held
    assert (folder / "sweep.nc").read_bytes() == whole

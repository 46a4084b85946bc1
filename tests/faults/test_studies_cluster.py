"""A Dask cluster of separate processes: the bits of the serial run, also when its workers are killed."""

import os
import re
import signal
import socket
import subprocess
import sys
import time
from types import SimpleNamespace

import numpy as np
import psutil
import pytest

import squealbox
from faults import study_victim
from faults.store_study import answer
from squealbox import DrumBrake, complex_modes, sweep
from squealbox.studies import StudyError

SPACE = {"friction.static": np.linspace(0.1, 0.5, 40), "load": np.linspace(1e3, 2e3, 25)}


@pytest.fixture(scope="module")
def address(tmp_path_factory):
    """A scheduler and two workers, each a process of its own, as on several hosts."""
    folder = tmp_path_factory.mktemp("cluster")
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    where = f"tcp://127.0.0.1:{port}"
    tests = os.path.dirname(os.path.dirname(__file__))
    environment = {**os.environ, "PYTHONPATH": tests, study_victim.JOURNAL: str(folder / "journal")}
    environment["DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES"] = "1"  # of 3: each worker that dies starts another
    scheduler = ["scheduler", "--host", "127.0.0.1", "--port", str(port), "--no-dashboard"]
    worker = ["worker", where, "--nthreads", "1", "--no-dashboard"]
    processes = [
        subprocess.Popen(
            [sys.executable, "-m", f"distributed.cli.dask_{kind}", *words],
            cwd=folder, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        )
        for kind, *words in (scheduler, worker, worker)
    ]  # fmt: skip
    yield where
    for process in processes:
        for child in psutil.Process(process.pid).children(recursive=True):
            child.kill()
        process.kill()
        process.wait()


def test_a_cluster_gives_the_bits_of_the_serial_run(address, tmp_path):
    sweep(DrumBrake(), SPACE, complex_modes, out=tmp_path / "serial")
    sweep(DrumBrake(), SPACE, complex_modes, out=tmp_path / "cluster", scheduler=address)
    assert (tmp_path / "cluster" / "sweep.nc").read_bytes() == (tmp_path / "serial" / "sweep.nc").read_bytes()
    assert "handing out a piece costs" in (tmp_path / "cluster" / "run.log").read_text()


def test_a_worker_killed_in_the_midst_changes_nothing(address, tmp_path, monkeypatch):
    monkeypatch.setenv(study_victim.JOURNAL, str(tmp_path / "journal"))
    study_victim.study(tmp_path / "serial")
    killed = []

    def kill(pace):
        if pace.done > 100 * (len(killed) + 1) and len(killed) < 3:
            busy = [p for p in psutil.process_iter(["cmdline", "ppid"]) if is_worker(p, address)]
            killed.append(busy[len(killed) % len(busy)].pid)
            os.kill(killed[-1], signal.SIGKILL)

    found = study_victim.study(tmp_path / "cluster", scheduler=address, progress=kill)
    assert len(killed) == 3
    assert found.outcome.ok
    assert (tmp_path / "cluster" / "sweep.nc").read_bytes() == (tmp_path / "serial" / "sweep.nc").read_bytes()


def is_worker(process, address):
    """A process that computes: the child of a nanny of this cluster."""
    try:
        parent = psutil.Process(process.info["ppid"]) if process.info["ppid"] else None
        words = " ".join(parent.cmdline()) if parent else ""
        return address in words and "dask_worker" in words and "spawn_main" in " ".join(process.info["cmdline"] or [])
    except psutil.NoSuchProcess:
        return False


def test_a_poisonous_point_is_isolated(address):
    def poison(design):
        if design.load1 == 3.0:
            os.kill(os.getpid(), signal.SIGKILL)
        return design.load1

    table = sweep(DrumBrake(), {"load": np.arange(8.0)}, poison, scheduler=address, chunk=4)
    assert table.outcomes.tolist() == ["completed"] * 3 + ["worker_died"] + ["completed"] * 4
    assert table.failures == {3: "the workers that computed it died"}


def test_a_point_is_blamed_for_deaths_that_it_died_alone(address, monkeypatch):
    """Its neighbours on the same worker die with a poisonous point, as often as their cluster allows."""
    from distributed.scheduler import KilledWorker

    from squealbox.studies.cluster import _Cluster

    taken = _Cluster._take

    def unlucky(self, future, piece):
        if len(piece) == 1 and piece.start not in seen:
            seen.add(piece.start)
            future = SimpleNamespace(
                status="error", exception=lambda: KilledWorker("key", SimpleNamespace(address="worker"), 3)
            )
        taken(self, future, piece)

    seen = set()
    monkeypatch.setattr(_Cluster, "_take", unlucky)
    table = sweep(DrumBrake(), {"load": np.arange(4.0)}, lambda design: design.load1, scheduler=address, chunk=1)
    assert table.outcomes.tolist() == ["completed"] * 4
    assert seen == {0, 1, 2, 3}


def test_a_hanging_point_is_ended(address):
    def hang(design):
        if design.load1 == 1.0:
            time.sleep(1000.0)
        return design.load1

    began = time.monotonic()
    table = sweep(DrumBrake(), {"load": np.arange(4.0)}, hang, scheduler=address, chunk=1, time_limit=2.0)
    assert time.monotonic() - began < 30.0
    assert table.outcomes.tolist() == ["completed", "time_limit", "completed", "completed"]


def test_errors_come_back_as_they_are(address):
    table = sweep(DrumBrake(), {"load": np.arange(-2.0, 4.0)}, answer, scheduler=address)
    assert table.outcomes.tolist() == ["failed"] * 2 + ["completed"] * 4
    with pytest.raises(StudyError, match="returns a dict for a"):
        sweep(DrumBrake(), {"load": np.arange(4.0)}, lambda design: {"a": {}}, scheduler=address)


def test_patience_counts_from_the_first_look_without_a_worker(monkeypatch):
    from squealbox.studies import cluster

    clock, threads = [0.0], [1]
    monkeypatch.setattr(cluster.time, "monotonic", lambda: clock[0])
    monkeypatch.setattr(cluster, "packed", lambda task: b"")
    client = SimpleNamespace(status="running", nthreads=lambda: {"worker": threads[0]})
    watched = cluster._Cluster(SimpleNamespace(task=None, slots=0), client, "somewhere", None)

    def look(now, workers):
        clock[0], threads[0] = now, workers
        watched._look()

    look(1.0, 2)
    assert watched.work.slots == 2
    look(100.0, 0)  # nothing was seen for 99 s, but nothing was looked at either
    look(129.0, 0)
    look(130.0, 1)
    look(131.0, 0)  # begins anew
    look(160.0, 0)
    with pytest.raises(StudyError, match="no worker for 30 s"):
        look(161.5, 0)


def test_other_versions_on_the_workers_are_refused(address, monkeypatch):
    from squealbox.studies import cluster

    monkeypatch.setattr(cluster, "provenance", lambda: {"squealbox": "9.9"})
    with pytest.raises(StudyError, match=rf"has squealbox {re.escape(squealbox.__version__)}, this process 9\.9"):
        sweep(DrumBrake(), {"load": np.arange(4.0)}, complex_modes, scheduler=address)


def test_a_scheduler_that_is_not_there_is_said(monkeypatch):
    from squealbox.studies import cluster

    monkeypatch.setattr(cluster, "PATIENCE", 2.0)
    with pytest.raises(StudyError, match="cannot be reached"):
        sweep(DrumBrake(), {"load": np.arange(4.0)}, complex_modes, scheduler="tcp://127.0.0.1:9")
    with pytest.raises(StudyError, match="cannot be reached"):
        sweep(DrumBrake(), {"load": np.arange(4.0)}, complex_modes, scheduler="nonsense://here")

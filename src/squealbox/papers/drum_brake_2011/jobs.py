"""The paper's computation as independent jobs, run by a few worker processes.

Drawing and eigenvalues hold Python's lock, so threads would not help; and processes that Python's multiprocessing
starts import the caller's script again, which a user's plain script does not survive. So a worker is
``python -m squealbox.papers.drum_brake_2011.jobs``: one job a line in, one answer a line out, as JSON.
"""

import json
import os
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from contextlib import contextmanager
from pathlib import Path
from queue import SimpleQueue
from typing import Any

from squealbox.papers.drum_brake_2011.cases import DEFAULT_READING, PRINTED, Case
from squealbox.papers.drum_brake_2011.claims import EXACT, RAW

MOST_WORKERS = 4  # each holds about 300 MB
KERNELS = ("consistent", "eq1_printed", "componentwise", "eq3")  # eq3_signed has the equation of eq3
Job = dict[str, Any]
Progress = Callable[[str, float], None]
Idle = SimpleQueue[subprocess.Popen[str]]


class JobFailed(RuntimeError):
    """A worker could not finish a job; the message names the job."""


def run(jobs: list[Job], progress: Progress | None = None, first: int = 0) -> list[Any]:
    """The answers to all jobs, in their order; `progress` hears what was done and the share of jobs done.

    The first `first` jobs are finished before the others begin. Raises `JobFailed` with the first job that fails.
    """
    answers: list[Any] = [None] * len(jobs)
    done = 0
    count = min(processors(), MOST_WORKERS, len(jobs))
    with ThreadPoolExecutor(count) as threads, _workers(count) as idle:
        for batch in (range(first), range(first, len(jobs))):
            waiting = {threads.submit(_ask, idle, jobs[i]): i for i in batch}
            try:
                for future in as_completed(waiting):
                    answers[waiting[future]] = future.result()
                    done += 1
                    if progress is not None:
                        progress(jobs[waiting[future]]["label"], done / len(jobs))
            except BaseException:
                for future in waiting:
                    future.cancel()
                raise
    return answers


def everything(
    readings: Sequence[str],
    figures: Path,
    progress: Progress | None = None,
    fine: bool = False,
    search: bool = False,
) -> tuple[dict[str, Any], dict[str, Any]]:
    """Study of every reading and, where asked, the search over its choices, by reading.

    The default reading's figures go to `figures` itself. Without `search` the second answer is empty.

    What the transients need is compiled first, once, beside the one reading that has none: two workers that start on
    transients would each compile the same.
    """
    from squealbox.papers.drum_brake_2011 import ensembles

    compiling = [{"kind": "compile", "contact": road, "label": f"compiled for {road} contact"} for road in (EXACT, RAW)]
    compiling += [
        {"kind": "compile maps", "reading": name, "label": f"compiled for maps of {name}"}
        for name in readings if name in KERNELS and name in (ensembles.FINE if fine else ensembles.USUAL).mapped
    ]  # fmt: skip
    kinds = ("study", "search") if search else ("study",)
    tasks = [_task(kind, reading, figures, fine) for kind in kinds for reading in readings]
    alone = [task for task in tasks if task["reading"] == PRINTED]
    others = [task for task in tasks if task["reading"] != PRINTED]
    answers = run(compiling + alone + others, progress, len(compiling + alone))[len(compiling) :]
    found = {(task["kind"], task["reading"]): answer for task, answer in zip(alone + others, answers, strict=True)}
    searched = {name: found["search", name] for name in readings} if search else {}
    return {name: found["study", name] for name in readings}, searched


def do(job: Job) -> Any:
    """One job: the study or the search of one reading, or one run so that its kernel is compiled."""
    from squealbox.papers.drum_brake_2011 import ensembles, motions, reading, search

    if job["kind"] == "compile":
        return motions.studies(Case(DEFAULT_READING), job["contact"])[motions.RUNS[0]].words
    if job["kind"] == "compile maps":
        return ensembles.compile_kernel(job["reading"])
    if job["kind"] == "study":
        sizes = ensembles.FINE if job["fine"] else ensembles.USUAL
        return reading.study(Case(job["reading"]), Path(job["folder"]), sizes)
    return search.search(job["reading"])


def _task(kind: str, reading: str, figures: Path, fine: bool) -> Job:
    folder = figures if reading == DEFAULT_READING else figures / reading
    label = f"{'study of' if kind == 'study' else 'search in'} {reading}"
    return {"kind": kind, "reading": reading, "folder": str(folder), "label": label, "fine": fine}


def processors() -> int:
    """How many processors this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


@contextmanager
def _workers(count: int) -> Iterator[Idle]:
    """A queue of idle workers; they are stopped at the end, whatever happens. What goes wrong in them is printed."""
    idle: Idle = SimpleQueue()
    command = [sys.executable, "-m", "squealbox.papers.drum_brake_2011.jobs"]
    environment = {**os.environ, "OPENBLAS_NUM_THREADS": "1"}  # the matrices are 4 x 4: threads only get in the way
    pipes: dict[str, Any] = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "text": True, "encoding": "utf-8"}
    started = []
    try:
        for _ in range(count):
            started.append(subprocess.Popen(command, env=environment, **pipes))
            idle.put(started[-1])
        yield idle
    finally:
        for worker in started:
            worker.kill()
            worker.communicate()


def _ask(idle: Idle, job: Job) -> Any:
    worker = idle.get()
    assert worker.stdin is not None
    assert worker.stdout is not None
    try:
        worker.stdin.write(json.dumps(job) + "\n")
        worker.stdin.flush()
        answer = worker.stdout.readline()
    except BrokenPipeError:
        answer = ""
    finally:
        idle.put(worker)
    if not answer:
        raise JobFailed(f"{job['label']}: its process ended with code {worker.wait()}; what it wrote stands above")
    return json.loads(answer)


def _work() -> None:
    """Answer jobs until the input ends. What libraries print goes to standard error, not between the answers."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is the caller's: it stops the workers
    answers = os.fdopen(os.dup(sys.stdout.fileno()), "w", encoding="utf-8")
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())
    for line in sys.stdin:
        answers.write(json.dumps(do(json.loads(line))) + "\n")
        answers.flush()


if __name__ == "__main__":
    _work()

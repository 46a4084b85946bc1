"""The paper's computation as independent jobs, run by a few worker processes.

Drawing and eigenvalues hold Python's lock, so threads would not help; and processes that Python's multiprocessing
starts import the caller's script again, which a user's plain script does not survive. So a worker is
``python -m squealbox.papers.drum_brake_2011.jobs``: one job a line in, one answer a line out, as JSON.
"""

import gc
import json
import os
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, ThreadPoolExecutor, wait
from contextlib import contextmanager
from pathlib import Path
from queue import SimpleQueue
from typing import Any

from squealbox.papers.drum_brake_2011.cases import DEFAULT_READING, PRINTED, RECONSTRUCTED, Case
from squealbox.papers.drum_brake_2011.claims import EXACT, RAW

MOST_WORKERS = 4  # each holds about 300 MB
HEAVIEST = (DEFAULT_READING, "eq1_printed", "eq3", RECONSTRUCTED)  # begun first, so that the workers end together
BESIDE = {
    "drawings": "model and theorems",
    "family": "the family in its short form",
}  # need no transients, and so keep a worker busy while these are compiled
Job = dict[str, Any]
Progress = Callable[[str, float], None]
Idle = SimpleQueue[subprocess.Popen[str]]


class JobFailed(RuntimeError):
    """A worker could not finish a job; the message names the job."""


def run(jobs: list[Job], progress: Progress | None = None, meanwhile: Callable[[], object] | None = None) -> list[Any]:
    """The answers to all jobs, in their order; `progress` hears what was done and the share of jobs done.

    `meanwhile` is called once, when the first jobs have been handed out.

    A job begins in its turn, once those whose labels it has in `after` are done. Raises `JobFailed` with the first job
    that fails.
    """
    answers: list[Any] = [None] * len(jobs)
    waiting, done, running = list(range(len(jobs))), set[str](), dict[Any, int]()
    count = min(processors(), MOST_WORKERS, len(jobs))
    with ThreadPoolExecutor(count) as threads, _workers(count) as idle:
        while waiting or running:
            ready = (i for i in waiting if done.issuperset(jobs[i].get("after", ())))
            while len(running) < count and (i := next(ready, None)) is not None:
                running[threads.submit(_ask, idle, jobs[i])] = i
            waiting = [i for i in waiting if i not in running.values()]
            if meanwhile is not None:
                meanwhile()
                meanwhile = None
            for future in wait(running, return_when=FIRST_COMPLETED).done:
                i = running.pop(future)
                answers[i] = future.result()
                done.add(jobs[i]["label"])
                if progress is not None:
                    progress(jobs[i]["label"], len(done) / len(jobs))
    return answers


def everything(
    readings: Sequence[str],
    figures: Path,
    progress: Progress | None = None,
    fine: bool = False,
    search: bool = False,
    meanwhile: Callable[[], object] | None = None,
) -> tuple[dict[str, Any], dict[str, Any], dict[str, Any]]:
    """Study of every reading; where asked, the search over its choices, by reading; and what stands beside them.

    The default reading's figures go to `figures` itself. Without `search` the second answer is empty. The third has the
    answers of "family" and "solver", see `do`. `meanwhile` is called when the workers have begun.

    What the transients need is compiled first, once: two workers that start on transients would each compile the same.
    """
    compiling = [{"kind": "compile", "contact": road, "label": f"compiled for {road} contact"} for road in (EXACT, RAW)]
    compiled = [job["label"] for job in compiling]
    order = sorted(readings, key=lambda name: HEAVIEST.index(name) if name in HEAVIEST else len(HEAVIEST))
    kinds = ("study", "search") if search else ("study",)
    tasks = [_task(kind, reading, figures, fine, compiled) for kind in kinds for reading in order]
    beside = [{"kind": kind, "folder": str(figures), "label": label} for kind, label in BESIDE.items()]
    solver = {"kind": "solver", "folder": str(figures), "label": "the solver of 2011", "after": compiled}
    jobs = [*compiling, *beside, *tasks, solver]
    found = {
        (job["kind"], job.get("reading")): answer
        for job, answer in zip(jobs, run(jobs, progress, meanwhile), strict=True)
    }
    searched = {name: found["search", name] for name in readings} if search else {}
    told = {kind: found[kind, None] for kind in ("family", "solver")}
    return {name: found["study", name] for name in readings}, searched, told


def do(job: Job) -> Any:
    """One job: the study or the search of one reading; one run so that its kernel is compiled; or what is for all.

    "drawings" draws the model, the friction law and the theorems; "family" searches the family in its short form;
    "solver" runs and draws the solver of 2011.
    """
    from squealbox.papers.drum_brake_2011 import beside, ensembles, motions, reading, search

    if job["kind"] == "compile":
        return motions.studies(Case(DEFAULT_READING), job["contact"])[motions.RUNS[0]].words
    if job["kind"] == "drawings":
        return beside.drawings_of(Path(job["folder"]))
    if job["kind"] == "family":
        return beside.family()
    if job["kind"] == "solver":
        return beside.solver(Path(job["folder"]))
    if job["kind"] == "study":
        sizes = ensembles.FINE if job["fine"] else ensembles.USUAL
        return reading.study(Case(job["reading"]), Path(job["folder"]), sizes)
    return search.search(job["reading"])


def _task(kind: str, reading: str, figures: Path, fine: bool, compiled: list[str]) -> Job:
    folder = figures if reading == DEFAULT_READING else figures / reading
    label = f"{'study of' if kind == 'study' else 'search in'} {reading}"
    return {"kind": kind, "reading": reading, "folder": str(folder), "label": label, "fine": fine,
            "after": [] if reading == PRINTED else compiled}  # fmt: skip


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
    gc.set_threshold(50_000, 20, 50)  # figures are many small things: the usual 700 looks through them over and over
    answers = os.fdopen(os.dup(sys.stdout.fileno()), "w", encoding="utf-8")
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())
    for line in sys.stdin:
        answers.write(json.dumps(do(json.loads(line))) + "\n")
        answers.flush()


if __name__ == "__main__":
    _work()

"""The paper's computation as independent jobs, run by a few processes: drawing and eigenvalues hold Python's lock."""

import gc
import os
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from squealbox.papers.drum_brake_2011.cases import DEFAULT_READING, PRINTED, RECONSTRUCTED, Case
from squealbox.papers.drum_brake_2011.claims import EXACT, RAW
from squealbox.workers import Crew, Ended, Tell

MOST_WORKERS = 4  # each holds about 300 MB
HEAVIEST = (DEFAULT_READING, "eq1_printed", "eq3", RECONSTRUCTED)  # begun first, so that the workers end together
BESIDE = {
    "drawings": "model and theorems",
    "family": "the family in its short form",
}  # need no transients, and so keep a worker busy while these are compiled
Job = dict[str, Any]
Progress = Callable[[str, float], None]
ONE_THREAD = {"OPENBLAS_NUM_THREADS": "1"}  # the matrices are 4 x 4: threads only get in the way


class JobFailed(RuntimeError):
    """A worker could not finish a job; the message names the job."""


def run(jobs: list[Job], progress: Progress | None = None, meanwhile: Callable[[], object] | None = None) -> list[Any]:
    """The answers to all jobs, in their order; `progress` hears what was done and the share of jobs done.

    `meanwhile` is called once, when the first jobs have been handed out.

    A job begins in its turn, once those whose labels it has in `after` are done. Raises `JobFailed` with the first job
    that fails.
    """
    answers: list[Any] = [None] * len(jobs)
    waiting, done = list(range(len(jobs))), set[str]()
    count = min(processors(), MOST_WORKERS, len(jobs))
    with Crew(f"{__name__}:work", environment=ONE_THREAD) as crew:
        while len(done) < len(jobs):
            for worker in crew.idle(count):
                i = next((i for i in waiting if done.issuperset(jobs[i].get("after", ()))), None)
                if i is not None:
                    waiting.remove(i)
                    worker.ask(jobs[i], task=i)
            if meanwhile is not None:
                meanwhile()
                meanwhile = None
            for _, i, answer in crew.news():
                label = "a worker without a job" if i is None else jobs[i]["label"]
                if isinstance(answer, Ended):
                    error = JobFailed(f"{label}: its process ended with {answer.how}")
                    error.add_note(answer.printed)
                    raise error
                answers[i] = answer
                done.add(label)
                if progress is not None:
                    progress(label, len(done) / len(jobs))
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


def work(tell: Tell, job: Job) -> Any:
    """One job in a worker."""
    gc.set_threshold(50_000, 20, 50)  # figures are many small things: the usual 700 looks through them over and over
    return do(job)


def _task(kind: str, reading: str, figures: Path, fine: bool, compiled: list[str]) -> Job:
    folder = figures if reading == DEFAULT_READING else figures / reading
    label = f"{'study of' if kind == 'study' else 'search in'} {reading}"
    return {"kind": kind, "reading": reading, "folder": str(folder), "label": label, "fine": fine,
            "after": [] if reading == PRINTED else compiled}  # fmt: skip


def processors() -> int:
    """How many processors this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1

"""Who computes the pieces of a sweep: this process, supervised processes on this machine, or a Dask cluster."""

import functools
import time
from collections.abc import Callable

from squealbox.studies.analysis import StudyError, evaluate
from squealbox.studies.work import WorkInPieces

Executor = Callable[[WorkInPieces], None]


def executor(workers: int | None, scheduler: str | None, time_limit: float | None) -> Executor:
    """The executor asked for; the modules of the others are not loaded. `StudyError` for what makes no sense."""
    if time_limit is not None and not 0.0 < time_limit < float("inf"):
        raise StudyError(f"time_limit = {time_limit!r}: expected seconds above 0")
    if workers is not None and scheduler is not None:
        raise StudyError("workers and scheduler are both given: expected one of them")
    if workers is not None:
        if isinstance(workers, bool) or int(workers) != workers or workers < 1:
            raise StudyError(f"workers = {workers!r}: expected a whole number of at least 1")
        from squealbox.studies.supervised import run_supervised

        return functools.partial(run_supervised, workers=int(workers), time_limit=time_limit)
    if scheduler is not None:
        from squealbox.studies.cluster import run_on_cluster

        return functools.partial(run_on_cluster, address=scheduler, time_limit=time_limit)
    if time_limit is not None:
        raise StudyError("time_limit needs workers: a process cannot end what hangs in itself")
    return run_embedded


def run_embedded(work: WorkInPieces) -> None:
    """Compute one piece after the other in this process; the compiled engine has its own threads."""
    while (piece := work.take()) is not None:
        began = time.perf_counter()
        block = evaluate(work.task, piece.start, work.values(piece))
        work.finish(block, time.perf_counter() - began)

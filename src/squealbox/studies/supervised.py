"""The executor with worker processes on this machine: blocks have a time limit, and no point can stop a sweep."""

import os
import time
from collections.abc import Mapping
from typing import Any

from squealbox.studies.analysis import StudyError, Task, evaluate
from squealbox.studies.block import Block, failure
from squealbox.studies.shipping import packed
from squealbox.studies.work import Piece, WorkInPieces
from squealbox.workers import NOWHERE, Crew, Ended, Tell, Worker

TIME_LIMIT = 30.0  # seconds for a block when nothing else is asked for
FIRST_LIMIT = 180.0  # and for blocks that begin before any is back, which may have to compile
DIED, LATE = "worker_died", "time_limit"
STRIKES = 3  # times a point alone must see its process die, before it and not bad luck is to blame
THREADS = ("SQUEALBOX_THREADS", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")


def run_supervised(work: WorkInPieces, workers: int, time_limit: float | None) -> None:
    """Compute all pieces with `workers` processes; a point that kills its process or hangs has an outcome."""
    work.slots, stillborn = workers, 0
    threads = dict.fromkeys(THREADS, str(max(1, (os.cpu_count() or 1) // workers)))
    with Crew(f"{__name__}:computed", packed(work.task), environment=threads) as crew:
        while work.left:
            for worker in crew.idle(min(workers, work.left)):
                if (piece := work.take()) is not None:
                    first = time_limit is None and work.blocks == 0
                    limit = FIRST_LIMIT if first else time_limit or TIME_LIMIT
                    worker.ask(piece.start, work.values(piece), task=piece, limit=limit)
            for worker, piece, answer in crew.news():
                stillborn = stillborn + 1 if not worker.ready else 0
                if stillborn >= STRIKES:
                    raise StudyError(f"worker processes do not start: {answer.how}")
                if not isinstance(answer, Ended):
                    block, seconds = answer
                    if isinstance(block, str):
                        raise StudyError(block)
                    work.finish(block, seconds)
                elif piece is not None:
                    _lose(work, piece, worker, answer)


def computed(tell: Tell, task: Task, start: int, values: Mapping[str, Any]) -> tuple[Block | str, float]:
    """A piece in a worker: its block and the seconds it took, or what makes no sense in the whole study."""
    began = time.perf_counter()
    try:
        return evaluate(task, start, values, tell.at), time.perf_counter() - began
    except StudyError as error:
        return str(error), 0.0


def _lose(work: WorkInPieces, piece: Piece, worker: Worker, end: Ended) -> None:
    """A process died, or was killed because it was late: find out who is to blame, and give back the rest."""
    if not worker.ready:
        work.put_back(piece)
        return
    why = f"took longer than {worker.limit:g} s" if end.late else f"lost their process ({end.how})"
    work.target.log(f"points {piece.start} to {piece.stop - 1} {why}")
    if len(piece) > 1:
        work.put_back(*_parts(piece, end.at))
    elif end.late:
        text = f"took longer than the time limit of {worker.limit:g} s"
        work.finish(failure(piece.start, 1, LATE, text), worker.limit)
    elif piece.tries + 1 >= STRIKES:
        text = f"the process that computed it died {STRIKES} times ({end.how})"
        work.finish(failure(piece.start, 1, DIED, text), 0.0)
    else:
        work.put_back(Piece(piece.start, piece.stop, piece.tries + 1))


def _parts(piece: Piece, suspect: tuple[int, ...]) -> list[Piece]:
    """The suspected points apart from the others; halves when all are suspected, or nothing is known."""
    first, last = suspect
    if suspect == NOWHERE or (first, last + 1) == (piece.start, piece.stop):
        middle = (piece.start + piece.stop) // 2
        return [Piece(piece.start, middle), Piece(middle, piece.stop)]
    return [Piece(first, last + 1), Piece(piece.start, first), Piece(last + 1, piece.stop)]

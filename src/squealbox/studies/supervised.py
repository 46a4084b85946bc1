"""The executor with worker processes on this machine: a time limit for each block, and no point that can stop a sweep.

Why not a process pool: `concurrent.futures` and joblib give up the whole sweep when one process dies, and none of the
libraries looked at ends a block that has hung in compiled code, which only killing its process can do.
"""

import os
import time
from multiprocessing.connection import wait

from squealbox.studies.analysis import StudyError
from squealbox.studies.block import failure
from squealbox.studies.crew import BLOCK, ERROR, NOWHERE, READY, Worker
from squealbox.studies.shipping import packed
from squealbox.studies.work import Piece, WorkInPieces

TIME_LIMIT = 30.0  # seconds for a block when nothing else is asked for
FIRST_LIMIT = 180.0  # and for blocks that begin before any is back, which may have to compile
DIED, LATE = "worker_died", "time_limit"
STRIKES = 3  # times a point alone must see its process die, before it and not bad luck is to blame
LOOK = 0.5  # seconds between two looks at the clock


def run_supervised(work: WorkInPieces, workers: int, time_limit: float | None) -> None:
    """Compute all pieces with `workers` processes; a point that kills its process or hangs has an outcome."""
    if os.name != "posix":
        raise StudyError("worker processes need Linux or macOS: elsewhere, use a Dask cluster on the same machine")
    _Supervisor(work, workers, time_limit).run()


class _Supervisor:
    def __init__(self, work: WorkInPieces, workers: int, time_limit: float | None) -> None:
        self.work, self.limit, self.asked = work, time_limit or TIME_LIMIT, time_limit is not None
        self.payload = packed(work.task)
        self.count, self.threads = workers, max(1, (os.cpu_count() or 1) // workers)
        self.crew: list[Worker] = []
        self.stillborn = 0
        work.slots = workers

    def run(self) -> None:
        try:
            while self.work.left:
                self._fill()
                for connection in wait([each.connection for each in self.crew], timeout=LOOK):
                    self._hear(next(each for each in self.crew if each.connection is connection))
                now = time.monotonic()
                for each in [each for each in self.crew if each.deadline < now]:
                    self._lose(each, late=True)
        finally:
            for each in self.crew:
                each.end()

    def _fill(self) -> None:
        """A process for every place, a piece for every process."""
        while len(self.crew) < min(self.count, self.work.left):
            self.crew.append(Worker(self.payload, self.threads))
        for each in [each for each in self.crew if each.ready and each.piece is None]:
            piece = self.work.take()
            if piece is None:
                each.deadline = float("inf")
                continue
            first = not self.asked and self.work.blocks == 0
            try:
                each.give(piece, self.work.values(piece), FIRST_LIMIT if first else self.limit)
            except (BrokenPipeError, ConnectionResetError):
                self._lose(each)

    def _hear(self, worker: Worker) -> None:
        try:
            kind, content, seconds = worker.connection.recv()
        except (EOFError, ConnectionResetError):
            self._lose(worker)
            return
        if kind == ERROR:
            raise StudyError(content)
        worker.ready = True
        if kind == BLOCK:
            worker.piece = None
            self.work.finish(content, seconds)
        self.stillborn = 0 if kind == READY else self.stillborn

    def _lose(self, worker: Worker, late: bool = False) -> None:
        """A process died, or is killed because it is late: find out who is to blame, and give back the rest."""
        suspect = worker.suspect()
        self.crew.remove(worker)
        how = worker.end()
        piece = worker.piece
        if not worker.ready:
            self.stillborn += 1
            if self.stillborn >= STRIKES:
                raise StudyError(f"worker processes do not start: {how}")
        if piece is None:
            return
        where = f"points {piece.start} to {piece.stop - 1}"
        why = f"took longer than {worker.limit:g} s" if late else f"lost their process ({how})"
        self.work.target.log(f"{where} {why}")
        if len(piece) > 1:
            self.work.put_back(*_parts(piece, suspect))
        elif late:
            text = f"took longer than the time limit of {worker.limit:g} s"
            self.work.finish(failure(piece.start, 1, LATE, text), worker.limit)
        elif piece.tries + 1 >= STRIKES:
            text = f"the process that computed it died {STRIKES} times ({how})"
            self.work.finish(failure(piece.start, 1, DIED, text), 0.0)
        else:
            self.work.put_back(Piece(piece.start, piece.stop, piece.tries + 1))


def _parts(piece: Piece, suspect: tuple[int, int]) -> list[Piece]:
    """The suspected points apart from the others; halves when all are suspected, or nothing is known."""
    first, last = suspect
    if suspect == NOWHERE or (first, last + 1) == (piece.start, piece.stop):
        middle = (piece.start + piece.stop) // 2
        return [Piece(piece.start, middle), Piece(middle, piece.stop)]
    return [Piece(first, last + 1), Piece(piece.start, first), Piece(last + 1, piece.stop)]

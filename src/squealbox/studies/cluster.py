"""The executor on a Dask cluster that is already there, through distributed's public interface.

A piece travels with its task, so a worker that joins late or comes back knows all it needs. Results come back to this
process, which alone writes the store. Dask computes the pieces of a lost worker again; a piece that loses several
workers is taken apart until the point to blame stands alone, and that point is blamed when workers die of it with
nothing else in hand: other points that shared its workers died with them.
"""

import os
import queue
import time
from typing import TYPE_CHECKING, Any

from squealbox.result import provenance
from squealbox.studies.analysis import StudyError, evaluate
from squealbox.studies.block import Block, failure
from squealbox.studies.shipping import packed, unpacked
from squealbox.studies.work import Piece, WorkInPieces

if TYPE_CHECKING:
    from distributed import Client, Future

PATIENCE = 30.0  # seconds without a worker or a scheduler before the sweep gives up
LOOK = 1.0  # seconds between two looks at the cluster
AHEAD = 2  # pieces for each thread of the cluster, so that none waits for this process
SHARE = 0.01  # of its time a piece may cost for being handed out; half of what is promised
PROBES = 5  # empty pieces that measure it
DIED, LATE = "worker_died", "time_limit"


def run_on_cluster(work: WorkInPieces, address: str, time_limit: float | None) -> None:
    """Compute all pieces on the workers of the scheduler at `address`; `StudyError` when it cannot be reached."""
    try:
        from distributed import Client
    except ModuleNotFoundError as error:
        raise StudyError("a Dask cluster needs the package distributed: pip install 'squealbox[studies]'") from error
    try:
        client = Client(address, timeout=PATIENCE, set_as_default=False, name="squealbox")
    except (OSError, ValueError) as error:
        raise StudyError(f"scheduler {address}: cannot be reached ({error})") from error
    with client:
        _Cluster(work, client, address, time_limit).run()


class _Cluster:
    def __init__(self, work: WorkInPieces, client: "Client", address: str, time_limit: float | None) -> None:
        self.work, self.client, self.address, self.limit = work, client, address, time_limit
        self.payload, self.versions = packed(work.task), provenance()
        self.back: queue.Queue[Future] = queue.Queue()
        self.out: dict[Any, tuple[Future, Piece, float]] = {}
        self.suspects: list[Piece] = []  # single points that workers died with, to be tried one at a time
        self.tried: Piece | None = None  # the one in hand, with nothing else
        self.alone: float | None = None  # since when looks at the cluster find no worker

    def run(self) -> None:
        self._wait_for_workers()
        self.work.slots = self._threads()
        overhead = self._measured()
        self.work.seconds = max(self.work.seconds, overhead / SHARE)
        text = f"{self.work.slots} threads at {self.address}; handing out a piece costs {1e3 * overhead:.1f} ms"
        self.work.target.log(f"{text}, so one takes {self.work.seconds:.2g} s")
        began = time.perf_counter()
        try:
            while self.work.left:
                self._fill()
                self._hear()
        finally:
            self.client.cancel([future for future, _, _ in self.out.values()], force=True)
        spent = time.perf_counter() - began
        idle = self.work.slots * spent - self.work.computed
        each = f"{1e3 * idle / max(self.work.blocks, 1):.1f} ms a piece"
        share = 100.0 * idle / max(self.work.slots * spent, 1e-9)
        text = (
            f"{self.work.blocks} pieces computed in {spent:.3f} s; threads that did not compute: {each}, {share:.1f} %"
        )
        self.work.target.log(text)

    def _next(self) -> Piece | None:
        """The next piece to hand out; None where there is none, or while one has to be by itself."""
        if self.tried is not None:
            return None
        if (piece := self.work.take()) is None and self.suspects and not self.out:
            piece = self.tried = self.suspects.pop(0)
        return piece

    def _fill(self) -> None:
        while len(self.out) < AHEAD * self.work.slots and (piece := self._next()) is not None:
            future = self.client.submit(
                compute, self.payload, piece.start, dict(self.work.values(piece)), self.versions, pure=False
            )
            self.out[future.key] = (future, piece, time.monotonic())
            future.add_done_callback(self.back.put)

    def _hear(self) -> None:
        try:
            future = self.back.get(timeout=LOOK)
        except queue.Empty:
            self._look()
            return
        self.alone = None
        if future.key in self.out:
            _, piece, _ = self.out.pop(future.key)
            self._take(future, piece)

    def _take(self, future: "Future", piece: Piece) -> None:
        from distributed.scheduler import KilledWorker

        error = future.exception() if future.status == "error" else None
        if piece is self.tried:
            self.tried = None
        elif isinstance(error, KilledWorker) and len(piece) == 1:
            self.suspects.append(piece)
            return
        if isinstance(error, KilledWorker):
            self._blame(piece, DIED, "the workers that computed it died", str(error))
        elif isinstance(error, StudyError):
            raise error
        elif error is not None:
            raise StudyError(f"scheduler {self.address}: {type(error).__name__}: {error}") from error
        elif future.status != "finished":
            self.work.put_back(piece)  # cancelled when its scheduler or worker went away
        else:
            block, seconds = future.result()
            self.work.finish(block, seconds)

    def _blame(self, piece: Piece, name: str, message: str, detail: str = "") -> None:
        self.work.target.log(f"points {piece.start} to {piece.stop - 1}: {message} {detail}".rstrip())
        if len(piece) == 1:
            self.work.finish(failure(piece.start, 1, name, message), 0.0)
        else:
            middle = (piece.start + piece.stop) // 2
            self.work.put_back(Piece(piece.start, middle), Piece(middle, piece.stop))

    def _look(self) -> None:
        """Is the cluster still there, and is a piece late?"""
        if self.client.status == "closed":
            raise StudyError(f"scheduler {self.address}: was lost; run the study again when it is back")
        if (threads := self._threads()) > 0:
            self.alone, self.work.slots = None, threads
        elif self.alone is None:
            self.alone = time.monotonic()  # not earlier: fetching a dead worker's result may have kept us from looking
        elif time.monotonic() - self.alone > PATIENCE:
            raise StudyError(f"scheduler {self.address}: no worker for {PATIENCE:g} s; run the study again")
        if self.limit is not None:
            self._end_late(self.limit)

    def _end_late(self, limit: float) -> None:
        """Restart the workers of pieces that take too long, which only their nannies can."""
        started = {key: at for at, keys in self._running().items() for key in keys}
        now = time.monotonic()
        for key, (future, piece, _) in list(self.out.items()):
            if key not in started:
                self.out[key] = (future, piece, now)  # not begun, or begun just now
            elif now - self.out[key][2] > limit:
                del self.out[key]
                self.tried = None  # the piece in hand, if one was by itself
                future.cancel(force=True)
                self.client.restart_workers([started[key]], timeout=PATIENCE, raise_for_error=False)
                self._blame(piece, LATE, f"took longer than the time limit of {limit:g} s")

    def _running(self) -> dict[str, tuple[str, ...]]:
        """Worker to the pieces it works on at this moment."""
        found: dict[str, tuple[str, ...]] = self.client.run(_executing)
        return found

    def _threads(self) -> int:
        return sum(self.client.nthreads().values()) if self.client.status == "running" else 0

    def _wait_for_workers(self) -> None:
        try:
            self.client.wait_for_workers(1, timeout=PATIENCE)
        except TimeoutError as error:
            raise StudyError(
                f"scheduler {self.address}: has no workers; start one with: dask worker ADDRESS"
            ) from error

    def _measured(self) -> float:
        """Seconds it costs to hand out an empty piece and to have it back, the least of a few."""
        spent = []
        for _ in range(PROBES):
            began = time.perf_counter()
            self.client.submit(_nothing, self.payload, pure=False).result()
            spent.append(time.perf_counter() - began)
        return min(spent)


def compute(payload: bytes, start: int, values: dict[str, Any], versions: dict[str, str]) -> tuple[Block, float]:
    """A piece on a worker of the cluster: its block, and the seconds it took."""
    here = provenance()
    if here != versions:
        odd = next(name for name in versions if here.get(name) != versions[name])
        raise StudyError(
            f"a worker of the cluster has {odd} {here.get(odd)}, this process {versions[odd]}: results would be mixed"
        )
    os.environ.setdefault("SQUEALBOX_THREADS", "1")  # Dask has a thread for each core already
    began = time.perf_counter()
    block = evaluate(unpacked(payload), start, values)
    return block, time.perf_counter() - began


def _nothing(payload: bytes) -> None:
    return None


def _executing(dask_worker: Any) -> tuple[str, ...]:
    return tuple(task.key for task in dask_worker.state.executing)

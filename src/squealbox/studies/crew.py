"""One supervised worker process, seen from both sides.

The supervisor keeps a pipe to each process, so nothing is shared that a dying process could leave locked. A process
notes in a page of shared memory which points it is at, so that when it dies the supervisor knows whom to suspect.
"""

import contextlib
import mmap
import os
import signal
import struct
import subprocess
import sys
import tempfile
import threading
import time
from multiprocessing.connection import Connection, Pipe
from typing import Any

from squealbox.studies.analysis import StudyError, evaluate
from squealbox.studies.shipping import unpacked
from squealbox.studies.work import Piece

READY, BLOCK, ERROR = "ready", "block", "error"
STARTING = 60.0  # seconds within which a process must report
NOWHERE = (-1, -1)
_MARK = struct.Struct("qq")
_CODE = "import sys; from squealbox.studies.crew import serve; serve(int(sys.argv[1]), int(sys.argv[2]))"


class Worker:
    """A process, what it works on, and until when it may."""

    def __init__(self, payload: bytes, threads: int) -> None:
        self.piece: Piece | None = None
        self.limit = STARTING
        self.ready = False
        self.deadline = time.monotonic() + STARTING
        self.connection, theirs = Pipe()
        self._errors = tempfile.TemporaryFile()  # noqa: SIM115 - as long as the process
        with tempfile.TemporaryFile() as page:
            page.write(_MARK.pack(*NOWHERE))
            page.flush()
            self._mark = mmap.mmap(page.fileno(), _MARK.size)
            self.process = subprocess.Popen(
                [sys.executable, "-c", _CODE, str(theirs.fileno()), str(page.fileno())],
                pass_fds=(theirs.fileno(), page.fileno()),
                stdin=subprocess.DEVNULL,
                stdout=self._errors,
                stderr=self._errors,
                env={**os.environ, **dict.fromkeys(THREADS, str(threads))},
            )
        theirs.close()
        with contextlib.suppress(BrokenPipeError, ConnectionResetError):  # stillborn: the supervisor will hear of it
            self.connection.send((sys.path, payload))

    def give(self, piece: Piece, values: Any, limit: float) -> None:
        """Hand out a piece, to be back within `limit` seconds."""
        self._mark[:] = _MARK.pack(*NOWHERE)
        self.piece, self.limit, self.deadline = piece, limit, time.monotonic() + limit
        self.connection.send((piece.start, values))

    def suspect(self) -> tuple[int, int]:
        """The first and last point it was at, or `NOWHERE`."""
        first, last = _MARK.unpack(self._mark[:])
        return first, last

    def end(self) -> str:
        """Kill the process if it is still there; how it ended, and its last words."""
        self.process.kill()
        code = self.process.wait()
        self.connection.close()
        self._errors.seek(0)
        words = self._errors.read().decode(errors="replace").strip().splitlines()[-1:]
        self._errors.close()
        how = signal.Signals(-code).name if code < 0 else f"exit code {code}"
        return ": ".join([how, *words])


THREADS = ("SQUEALBOX_THREADS", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")


def serve(pipe: int, page: int) -> None:
    """What the process does: answer pieces until the supervisor is gone."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is the supervisor's to handle
    threading.Thread(target=_leave_with, args=(os.getppid(),), daemon=True).start()
    connection: Connection[Any, Any] = Connection(pipe)
    mark = mmap.mmap(page, _MARK.size)

    def tick(first: int, last: int) -> None:
        mark[:] = _MARK.pack(first, last)

    try:
        path, payload = connection.recv()
        sys.path[:] = path
        task = unpacked(payload)
        connection.send((READY, None, 0.0))
        while True:
            start, values = connection.recv()
            began = time.perf_counter()
            try:
                block = evaluate(task, start, values, tick)
            except StudyError as error:
                connection.send((ERROR, str(error), 0.0))
                continue
            connection.send((BLOCK, block, time.perf_counter() - began))
    except (EOFError, BrokenPipeError, ConnectionResetError):
        sys.exit(0)  # the supervisor is gone


def _leave_with(parent: int) -> None:
    """End this process when its supervisor is killed, also in the midst of a block."""
    while os.getppid() == parent:
        time.sleep(0.5)
    os._exit(1)

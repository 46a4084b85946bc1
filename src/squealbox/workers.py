"""Processes that compute what they are asked, watched over: one that dies, hangs or is not wanted costs only itself.

A worker calls one function, named ``module:name``, again and again; neither the caller's script nor its memory comes
along. Questions and answers go through its standard input and output, on Windows as elsewhere: pipes that nobody else
holds need no key and leave nothing behind, and when they close the parent is gone, and the worker leaves, in the midst
of its work. What it prints goes to a file, whose first bytes both share: there it notes where it is, and one knows what
it died of. (A message before each small piece of work tells that too, and takes half as long as such a piece.)

Why not a process pool: `concurrent.futures` and joblib give up all work when one process dies, and no library looked at
ends what has hung in compiled code, which only killing its process can do. Depends on: nothing.
"""

import importlib
import mmap
import os
import pickle
import signal
import struct
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from queue import Empty, SimpleQueue
from typing import Any, BinaryIO, NamedTuple, Self

STARTING = 60.0  # s within which a process must be ready
LOOK = 0.5  # s between two looks at the clock
READY, SAID, ANSWER, GONE = "ready", "said", "answer", "gone"
NOWHERE = (-1, -1)
_MARK = struct.Struct("qq")
_CODE = "from squealbox.workers import serve; serve()"


class Ended(NamedTuple):
    """What is left of a process, in the place of an answer.

    how : the signal or exit code it ended with, and its last words
    at : first and last of what it noted to be working on, or `NOWHERE`
    printed : all that it printed
    late : whether it was killed for that
    """

    how: str
    at: tuple[int, ...]
    printed: str
    late: bool = False


class Worker:
    """One process: its `task`, and the `deadline` of first its start and then its task.

    function : ``module:name``, called there as ``function(tell, given, *question)`` with a `Tell`; one that raises ends
        its process, the traceback being its last words
    given : pickled, an argument that comes with every question; left out where there is none
    heard : where (worker, READY | SAID | ANSWER | GONE, what) are put
    environment : variables of the process that are its own
    nice : by how much others come first, where a system knows that
    idle : s without a question after which it leaves by itself
    """

    def __init__(
        self,
        function: str,
        given: bytes = b"",
        *,
        heard: "SimpleQueue[tuple[Worker, str, Any]] | None" = None,
        environment: Mapping[str, str] | None = None,
        nice: int = 0,
        idle: float | None = None,
    ) -> None:
        self.heard = SimpleQueue() if heard is None else heard
        self.task: Any = None
        self.ready, self.limit, self.deadline = False, float("inf"), time.monotonic() + STARTING
        self._printed = tempfile.TemporaryFile(buffering=0)  # noqa: SIM115 - as long as the process
        self._printed.write(_MARK.pack(*NOWHERE))
        self._mark = mmap.mmap(self._printed.fileno(), _MARK.size)
        self._printed.seek(_MARK.size)
        pipes: dict[str, Any] = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "stderr": self._printed}
        own = {**os.environ, **(environment or {})}
        self._process: Any = subprocess.Popen([sys.executable, "-c", _CODE], env=own, **pipes)
        threading.Thread(target=self._listen, daemon=True).start()
        self._send((sys.path, function, given, nice, idle))

    def ask(self, *question: object, task: object = True, limit: float = float("inf")) -> None:
        """Ask something, to be answered within `limit` seconds; `task` is what the caller knows it by."""
        self.task, self.limit, self._mark[:] = task, limit, _MARK.pack(*NOWHERE)
        if self.ready:
            self.deadline = time.monotonic() + limit
        self._send(pickle.dumps(question))

    def end(self, late: bool = False) -> Ended:
        """Kill the process if it is still there; what is left of it."""
        self._process.kill()
        code = self._process.wait()
        with suppress(OSError):  # of what it never read
            self._process.stdin.close()
        at = _MARK.unpack(self._mark[:])
        self._mark.close()
        self._printed.seek(_MARK.size)
        printed = self._printed.read().decode(errors="replace").strip()
        self._printed.close()
        how = signal.Signals(-code).name if code < 0 else f"exit code {code}"
        return Ended(": ".join([how, *printed.splitlines()[-1:]]), at, printed, late)

    def _send(self, message: object) -> None:
        with suppress(OSError):  # it is gone, and will be heard of
            pickle.dump(message, self._process.stdin)
            self._process.stdin.flush()

    def _listen(self) -> None:
        gone = suppress(EOFError, pickle.UnpicklingError)  # maybe in the midst of an answer
        try:
            with gone, self._process.stdout as line:
                while True:
                    self.heard.put((self, *pickle.load(line)))
        finally:
            self.heard.put((self, GONE, None))


class Crew:
    """Workers that serve one thread, made with the arguments of `Worker`; used with ``with``, which ends them all."""

    def __init__(self, function: str, given: bytes = b"", **how: Any) -> None:
        self._workers: list[Worker] = []
        self._heard: SimpleQueue[tuple[Worker, str, Any]] = SimpleQueue()
        self._new = lambda: Worker(function, given, heard=self._heard, **how)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        for each in self._workers:
            each.end()

    def idle(self, wanted: int) -> list[Worker]:
        """Those that are asked nothing, after starting some where there are fewer than `wanted`."""
        while len(self._workers) < wanted:
            self._workers.append(self._new())
        return [each for each in self._workers if each.task is None]

    def news(self) -> Iterator[tuple[Worker, Any, Any]]:
        """Worker, task and answer, or `Ended`, of those heard within `LOOK` seconds; who is late is killed."""
        with suppress(Empty):
            worker, kind, what = self._heard.get(timeout=LOOK)
            while True:
                if worker not in self._workers:  # it was late
                    pass
                elif kind == READY:
                    worker.ready, worker.deadline = True, time.monotonic() + worker.limit
                elif kind == ANSWER:
                    task, worker.task, worker.deadline = worker.task, None, float("inf")
                    yield worker, task, what
                elif kind == GONE:
                    yield self._lost(worker)
                worker, kind, what = self._heard.get_nowait()
        now = time.monotonic()
        for each in [each for each in self._workers if each.deadline < now]:
            yield self._lost(each, late=True)

    def _lost(self, worker: Worker, late: bool = False) -> tuple[Worker, Any, Ended]:
        self._workers.remove(worker)
        return worker, worker.task, worker.end(late)


class Tell:
    """What a worker's function is handed first: called with what its parent shall hear."""

    def __init__(self, send: Callable[[str, Any], None]) -> None:
        self._send, self._mark = send, mmap.mmap(2, _MARK.size)
        os.lseek(2, 0, os.SEEK_END)  # where Windows does not leave it

    def __call__(self, *what: object) -> None:
        self._send(SAID, what)

    def at(self, first: int, last: int) -> None:
        """Note what is worked on from now on, for the case that this process does not survive it."""
        self._mark[:] = _MARK.pack(first, last)


def serve() -> None:
    """What a worker's process does: answer, until its parent is gone or asks nothing for long."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is the parent's to handle
    questions = os.fdopen(os.dup(0), "rb")
    answers = os.fdopen(os.dup(1), "wb", closefd=False)  # closed by the system, when it knows how this process ended
    os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
    os.dup2(2, 1)  # what is printed is no answer
    sys.path[:], function, given, nice, idle = pickle.load(questions)
    if nice and hasattr(os, "nice"):  # not everywhere
        os.nice(nice)
    asked: SimpleQueue[bytes] = SimpleQueue()
    threading.Thread(target=_take, args=(questions, asked), daemon=True).start()

    def send(kind: str, what: object) -> None:
        answers.write(pickle.dumps((kind, what)))
        answers.flush()

    module, _, name = function.partition(":")
    called = getattr(importlib.import_module(module), name)
    first = [Tell(send), *([pickle.loads(given)] if given else [])]
    send(READY, None)
    while True:
        try:
            question = pickle.loads(asked.get(timeout=idle))
        except Empty:
            return
        send(ANSWER, called(*first, *question))


def _take(questions: BinaryIO, asked: "SimpleQueue[bytes]") -> None:
    """Take questions as they come; that none can come any more is heard also in the midst of work."""
    try:
        while True:
            asked.put(pickle.load(questions))
    finally:
        os._exit(1)

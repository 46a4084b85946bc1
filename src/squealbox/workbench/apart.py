"""Answers computed in a process of their own: it can be ended at any instant, and takes no time from the page.

A process is started when the first such answer is asked, serves one question at a time, and waits for the next; one
that was stopped is killed and replaced. Nothing is lost by that, since a question carries all it needs.
"""

import contextlib
import multiprocessing
import os
import signal
import threading
import time
from collections.abc import Callable
from multiprocessing.connection import Connection
from multiprocessing.context import SpawnProcess
from typing import Any

LOOK = 0.1  # s between two looks whether somebody still waits
IDLE = 600.0  # s after which a process that nobody needed ends by itself
Report = Callable[[float, str], None]
Usual = tuple[str, float]  # what is said while nothing is known of the progress, and how many seconds it usually takes


class Died(RuntimeError):
    """A process ended without its answer, as when the machine has no memory left."""


class Processes:
    """At most `most` processes that compute answers; further questions wait for one of them."""

    def __init__(self, most: int = 2) -> None:
        self._free = threading.Semaphore(most)
        self._idle: list[_Process] = []
        self._lock = threading.Lock()

    def answer(
        self, question: tuple[Any, ...], report: Report | None, stopped: Callable[[], bool], usual: Usual | None = None
    ) -> bytes | None:
        """The frame that answers a question; None as soon as `stopped` says so.

        Raises `Died` where the process ended without an answer.
        """
        while not self._free.acquire(timeout=LOOK):
            if stopped():
                return None
        process = None
        try:
            process, fresh = self._taken()
            if fresh and report is not None:
                report(0.0, "starting a process for it")
            found = process.answer(question, report, stopped, usual)
        except BaseException:
            if process is not None:
                process.end()
            raise
        else:
            with self._lock:
                if found is not None:
                    self._idle.append(process)
            return found
        finally:
            self._free.release()

    def close(self) -> None:
        """End all that wait; those at work end with their answer."""
        with self._lock:
            for process in self._idle:
                process.end()
            self._idle.clear()

    def _taken(self) -> tuple["_Process", bool]:
        """A process that waits, or a new one, and whether it is new."""
        with self._lock:
            while self._idle:
                process = self._idle.pop()
                if process.alive:
                    return process, False
        return _Process(), True


class _Process:
    """One process and the line to it."""

    def __init__(self) -> None:
        context = multiprocessing.get_context("spawn")
        self.line, other = context.Pipe()
        self.process: SpawnProcess = context.Process(target=serve, args=(other,), daemon=True)
        self.process.start()
        other.close()

    @property
    def alive(self) -> bool:
        return self.process.is_alive()

    def answer(
        self, question: tuple[Any, ...], report: Report | None, stopped: Callable[[], bool], usual: Usual | None
    ) -> bytes | None:
        """Send the question, pass on the progress, and hand back the frame; killed, and None, once it is stopped."""
        self.line.send(question)
        began = time.monotonic()
        while not stopped():
            if not self.line.poll(LOOK):
                if usual is not None and report is not None:
                    report(*_said(usual, time.monotonic() - began))
                continue
            try:
                kind, *said = self.line.recv()
            except (EOFError, ConnectionError):
                raise Died("the computation ended without an answer") from None
            if kind == "answer":
                return bytes(said[0])
            if report is not None and usual is None:
                report(*said)
        self.end()
        return None

    def end(self) -> None:
        """Kill it: it holds nothing that others need."""
        self.process.kill()
        self.process.join()
        self.line.close()


def _said(usual: Usual, gone: float) -> tuple[float, str]:
    """How far something is that cannot say so itself, from the seconds that are gone."""
    text, seconds = usual
    late = f" of about {seconds:.0f} s" if gone < seconds else f"; on an idle machine it takes about {seconds:.0f} s"
    return min(gone / seconds, 0.9), f"{text}: {gone:.0f} s{late}"


def serve(line: Connection) -> None:
    """The life of such a process: one question after the other, until nobody asks for long or the server is gone."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is the server's to hear
    with contextlib.suppress(OSError):
        if hasattr(os, "nice"):  # not everywhere
            os.nice(5)  # sliders come first
    from squealbox.workbench.panels import Work
    from squealbox.workbench.session import answered

    def report(share: float, text: str) -> None:
        line.send(("progress", share, text))

    with contextlib.suppress(EOFError, BrokenPipeError, ConnectionResetError):
        while line.poll(IDLE):
            name, message, bases = line.recv()
            line.send(("answer", answered(name, message, bases, Work(report, apart=True))))

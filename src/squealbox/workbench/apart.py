"""Answers computed in a process of their own: it can be ended at any instant, and takes no time from the page.

A process is started when the first such answer is asked, serves one question at a time, and waits for the next; one
that was stopped is killed and replaced. Nothing is lost by that, since a question carries all it needs.
"""

import time
from collections.abc import Callable
from contextlib import suppress
from queue import Empty, LifoQueue
from typing import Any

from squealbox.workers import ANSWER, GONE, SAID, Worker

LOOK = 0.1  # s between two looks whether somebody still waits
IDLE = 600.0  # s after which a process that nobody needed ends by itself
COMPUTING = "squealbox.workbench.session:answered_apart"
Report = Callable[[float, str], None]
Usual = tuple[str, float]  # what is said while nothing is known of the progress, and how many seconds it usually takes


class Died(RuntimeError):
    """A process ended without its answer, as when the machine has no memory left."""


class Processes:
    """At most `most` processes that compute answers; further questions wait for one of them."""

    def __init__(self, most: int = 2) -> None:
        self._free: LifoQueue[Worker | None] = LifoQueue()  # None: a place for which none was started yet
        for _ in range(most):
            self._free.put(None)

    def answer(
        self, question: tuple[Any, ...], report: Report, stopped: Callable[[], bool], usual: Usual | None = None
    ) -> bytes | None:
        """The frame that answers a question; None as soon as `stopped` says so.

        Raises `Died` where the process ended without an answer.
        """
        while not stopped():
            with suppress(Empty):
                process = self._free.get(timeout=LOOK)
                break
        else:
            return None
        kind = how = ""
        try:
            if process is not None and not process.heard.empty():  # it has left
                process.end()
                process = None
            if process is None:
                report(0.0, "starting a process for it")
                process = Worker(COMPUTING, nice=5, idle=IDLE)  # sliders come first
            kind, found = _heard(process, question, report, stopped, usual)
        finally:
            if process is not None and kind != ANSWER:
                how = process.end().how
                process = None
            self._free.put(process)
        if kind == GONE:
            raise Died(f"the computation ended without an answer ({how})")
        return found

    def close(self) -> None:
        """End all that wait; those at work end with their answer."""
        with suppress(Empty):
            while True:
                process = self._free.get_nowait()
                if process is not None:
                    process.end()


def _heard(
    process: Worker, question: tuple[Any, ...], report: Report, stopped: Callable[[], bool], usual: Usual | None
) -> tuple[str, bytes | None]:
    """`ANSWER` and the frame, or `GONE`, after passing on the progress; nothing once it is stopped."""
    process.ask(*question)
    began = time.monotonic()
    while not stopped():
        try:
            _, kind, what = process.heard.get(timeout=LOOK)
        except Empty:
            if usual is not None:
                report(*_said(usual, time.monotonic() - began))
            continue
        if kind in (ANSWER, GONE):
            return kind, what
        if kind == SAID and usual is None:
            report(*what)
    return "", None


def _said(usual: Usual, gone: float) -> tuple[float, str]:
    """How far something is that cannot say so itself, from the seconds that are gone."""
    text, seconds = usual
    late = f" of about {seconds:.0f} s" if gone < seconds else f"; on an idle machine it takes about {seconds:.0f} s"
    return min(gone / seconds, 0.9), f"{text}: {gone:.0f} s{late}"

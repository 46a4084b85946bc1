"""What is being done, told to people who wait longer than a second: on a terminal, or below a notebook's cell.

Only the outermost of several things is told, and nothing where nobody looks: in a file, a worker, another thread, or
with SQUEALBOX_PROGRESS=no. Depends on: nothing.
"""

import importlib
import os
import sys
import threading
import time
from typing import Any, Self

PATIENCE = 1.0  # s before anything is shown
PAUSE = 0.2  # s between two looks
AT_WORK: list["Progress"] = []  # the one that is told
LOCK = threading.Lock()


def on_terminal() -> bool:
    """Whether stderr is a terminal, so that a word there is read and not kept in a file."""
    return sys.stderr is not None and sys.stderr.isatty()


def in_notebook() -> bool:
    """Whether a notebook's kernel runs this."""
    shell = getattr(sys.modules.get("IPython"), "get_ipython", lambda: None)()
    return type(shell).__name__ == "ZMQInteractiveShell"


def watched() -> bool:
    """Whether somebody looks: at most one thing at a time is told, of the main thread of the first process."""
    return (
        not AT_WORK
        and os.environ.get("SQUEALBOX_PROGRESS") != "no"
        and threading.current_thread() is threading.main_thread()
        and (on_terminal() or in_notebook())
        and not in_child()
    )


def in_child() -> bool:
    """Whether this is a process that another one started for its work."""
    processes = sys.modules.get("multiprocessing.process")
    return processes is not None and processes.parent_process() is not None


class Progress:
    """Used with ``with``; call it with a text and, where known, the share that is done (0 to 1)."""

    def __init__(self, text: str) -> None:
        self.text, self.aside = text, ""
        self.began = 0.0  # of the monotonic clock; 0 for one that is not told
        self.share: float | None = None
        self.shown: Any = None

    def __call__(self, text: str, share: float | None = None) -> None:
        with LOCK:
            self.text, self.share = text, share

    def heard(self, *told: Any) -> None:
        """What a function says of itself: a text, how much of how much, or a `Pace` of a sweep."""
        if isinstance(told[0], str):
            self(told[0])
        else:
            share = told[0].share if hasattr(told[0], "share") else float(told[0]) / float(told[1] or 1.0)
            self(self.text, share)

    def __enter__(self) -> Self:
        if watched():
            self.began = time.monotonic()
            AT_WORK.append(self)
            _look()
        return self

    def __exit__(self, *_: object) -> None:
        if self.began:
            with LOCK:
                AT_WORK.remove(self)
                if self.shown is not None:
                    self.shown.end()


def aside(text: str) -> None:
    """Say at once what holds up the thing that is told (an empty text: no longer), or on a terminal where none is."""
    if in_child():
        return
    with LOCK:
        if AT_WORK:
            AT_WORK[0].aside = text
        if AT_WORK and text:
            _show(AT_WORK[0], time.monotonic())
        elif text and on_terminal():
            print(f"squealbox: {text} ...", file=sys.stderr, flush=True)


def _look() -> None:
    """Have one thread look at what is at work, for as long as the process lives."""
    if not any(each.name == "squealbox-waiting" for each in threading.enumerate()):
        threading.Thread(target=_looking, name="squealbox-waiting", daemon=True).start()


def _looking() -> None:
    while True:
        time.sleep(PAUSE)
        now = time.monotonic()
        with LOCK:
            for each in AT_WORK:
                if each.shown is not None or now - each.began > PATIENCE:
                    _show(each, now)


def _show(what: Progress, now: float) -> None:
    if what.shown is None:
        what.shown = _InNotebook() if in_notebook() else _OnTerminal(what.began)
    text = f"{what.text} ({what.aside})" if what.aside else what.text
    what.shown.update(text, what.share, now - what.began)


class _OnTerminal:
    """A line that moves and is gone in the end."""

    def __init__(self, began: float) -> None:
        from rich.console import Console
        from rich.progress import BarColumn, Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

        columns = (SpinnerColumn(), TextColumn("{task.description}", markup=False), BarColumn(), TimeElapsedColumn())
        self.bar = Progress(*columns, console=Console(stderr=True), transient=True)
        self.task = self.bar.add_task("", total=None)
        self.bar.tasks[0].start_time = began
        self.bar.start()

    def update(self, text: str, share: float | None, seconds: float) -> None:
        self.bar.update(self.task, description=text, total=None if share is None else 1.0, completed=share or 0.0)

    def end(self) -> None:
        self.bar.stop()


class _InNotebook:
    """A line below the cell, taken away in the end; without widgets, which not every notebook has."""

    def __init__(self) -> None:
        display = importlib.import_module("IPython.display").display  # which runs this
        self.line = display({"text/plain": ""}, raw=True, display_id=True)

    def update(self, text: str, share: float | None, seconds: float) -> None:
        done = "" if share is None else f"{100.0 * share:.0f} %, "
        self._put(f"{text}: {done}{seconds:.0f} s")

    def end(self) -> None:
        self._put("")

    def _put(self, text: str) -> None:
        if self.line is not None:  # as where a kernel has no place to show it
            self.line.update({"text/plain": text}, raw=True)

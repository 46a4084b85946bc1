"""What is being done, on stderr, for people who wait: only on a terminal, and only after a second."""

import sys
import threading
from types import TracebackType
from typing import TYPE_CHECKING, Self

if TYPE_CHECKING:
    from rich.progress import Progress as Bar

PATIENCE = 1.0  # seconds before anything is shown


class Progress:
    """Used with ``with``; call it with a text and, where known, the share that is done (0 to 1)."""

    def __init__(self, text: str) -> None:
        self._text = text
        self._share: float | None = None
        self._bar: Bar | None = None
        self._lock = threading.Lock()
        self._timer = threading.Timer(PATIENCE, self._show)
        self._timer.daemon = True

    def __call__(self, text: str, share: float | None = None) -> None:
        with self._lock:
            self._text, self._share = text, share
            if self._bar is not None:
                self._bar.update(self._bar.task_ids[0], description=text, total=_total(share), completed=share or 0.0)

    def __enter__(self) -> Self:
        if sys.stderr.isatty():
            self._timer.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._timer.cancel()
        with self._lock:
            if self._bar is not None:
                self._bar.stop()

    def _show(self) -> None:
        from rich.console import Console
        from rich.progress import BarColumn, Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

        columns = (SpinnerColumn(), TextColumn("{task.description}"), BarColumn(), TimeElapsedColumn())
        with self._lock:
            self._bar = Progress(*columns, console=Console(stderr=True), transient=True)
            self._bar.add_task(self._text, total=_total(self._share))
            self._bar.start()


def _total(share: float | None) -> float | None:
    return None if share is None else 1.0

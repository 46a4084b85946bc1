"""One writer for each store: a lock that dies with its process, whatever the way the process dies."""

import os
import sys
import time
from pathlib import Path


class Lock:
    """A lock on the file `path`, held until `release` or the end of the process.

    ``acquire()`` is True when this process holds it now and False when another does; nothing waits.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self._handle: int | None = None

    def acquire(self) -> bool:
        """Take the lock if it is free; some tries, because someone may just be looking whether it is."""
        handle = os.open(self.path, os.O_RDWR | os.O_CREAT, 0o644)
        for _ in range(5):
            if _taken(handle):
                self._handle = handle
                return True
            time.sleep(0.05)
        os.close(handle)
        return False

    def release(self) -> None:
        """Give the lock back; the file stays, so that no two processes can lock two files of one name."""
        if self._handle is not None:
            os.close(self._handle)
            self._handle = None


def is_held(path: Path) -> bool:
    """True when some process holds the lock."""
    if not path.exists():
        return False
    try:
        handle = os.open(path, os.O_RDWR)
    except PermissionError:
        handle = os.open(path, os.O_RDONLY)
    try:
        return not _taken(handle)
    finally:
        os.close(handle)


if sys.platform == "win32":

    def _taken(handle: int) -> bool:
        import msvcrt

        try:
            msvcrt.locking(handle, msvcrt.LK_NBLCK, 1)
        except OSError:
            return False
        return True

else:

    def _taken(handle: int) -> bool:
        import fcntl

        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            return False
        return True

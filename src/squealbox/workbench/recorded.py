"""Recordings that were dropped onto a page: kept in a folder of this server while it runs, and nowhere else."""

import os
import re
import secrets
import shutil
import tempfile
from collections.abc import AsyncIterator
from pathlib import Path

FOLDER = "SQUEALBOX_RECORDINGS"  # of the environment: processes of their own find them there
LARGEST = 100_000_000  # bytes
MOST = 4  # kept; the oldest goes first
KINDS = (".wav", ".flac", ".ogg", ".csv", ".npy", ".uff", ".unv")
NAME = re.compile(r"[0-9a-f]{32}\.[a-z]{3,4}")


class Recordings:
    """The recordings of one server; `close` deletes them."""

    def __init__(self) -> None:
        self.folder = Path(tempfile.mkdtemp(prefix="squealbox-recordings-"))
        os.environ[FOLDER] = str(self.folder)

    async def take(self, name: str, content: AsyncIterator[bytes]) -> str:
        """Keep a recording; the name it is then known by. Raises `ValueError` for one that cannot be kept."""
        kind = Path(name[-200:]).suffix.lower()
        if kind not in KINDS:
            raise ValueError(f"{name[-60:]!r}: expected a recording, one of {', '.join(KINDS)}")
        path = self.folder / f"{secrets.token_hex(16)}{kind}"
        await received(path, name, content, LARGEST)
        for old in sorted(self.folder.iterdir(), key=lambda each: each.stat().st_mtime_ns)[:-MOST]:
            old.unlink(missing_ok=True)
        return path.name

    def close(self) -> None:
        """Delete them."""
        shutil.rmtree(self.folder, ignore_errors=True)


async def received(path: Path, name: str, content: AsyncIterator[bytes], most: int) -> None:
    """Write what a page sends to `path`, piece by piece: all of it, or no file.

    Raises `ValueError`, which calls it `name`, for more than `most` bytes.
    """
    size = 0
    try:
        with path.open("wb") as file:
            async for piece in content:
                size += len(piece)
                if size > most:
                    raise ValueError(f"{name[-60:]!r} has more than {most} bytes")
                file.write(piece)
    except BaseException:
        path.unlink(missing_ok=True)
        raise


def path_of(name: object) -> Path | None:
    """The file of a recording by the name the server gave it, None where there is none."""
    folder = os.environ.get(FOLDER, "")
    if not folder or not isinstance(name, str) or not NAME.fullmatch(name):
        return None
    path = Path(folder) / name
    return path if path.is_file() else None

"""Matrices that were dropped onto a page with the design file that names them: kept until that file is read.

What was read is written into one text, matrices and all: a link, a restart of the server or a project need no files.
"""

import re
import shutil
import tempfile
from collections.abc import AsyncIterator
from pathlib import Path
from typing import TYPE_CHECKING

from squealbox.workbench.recorded import received

if TYPE_CHECKING:
    from squealbox.files import DesignFile

LARGEST = 100_000_000  # bytes of a file
MOST, GROUPS = 40, 4  # files of a design, and designs that wait; the oldest goes first
GROUP, NAME = re.compile(r"[0-9a-f]{32}"), re.compile(r"[\w+-][\w .+-]{0,119}")


class Beside:
    """The files that wait for their design files; `close` deletes them."""

    def __init__(self) -> None:
        self.folder = Path(tempfile.mkdtemp(prefix="squealbox-beside-"))

    async def take(self, group: str, name: str, content: AsyncIterator[bytes]) -> None:
        """Keep a file of a group under its name. Raises `ValueError` for one that cannot be kept."""
        if not (GROUP.fullmatch(group) and NAME.fullmatch(name)):
            raise ValueError(f"{name[-60:]!r}: expected a plain file name of at most 120 letters")
        folder = self.folder / group
        if not folder.exists():
            for old in sorted(self.folder.iterdir(), key=lambda each: each.stat().st_mtime_ns)[: 1 - GROUPS]:
                shutil.rmtree(old, ignore_errors=True)
            folder.mkdir()
        if len(list(folder.iterdir())) >= MOST:
            raise ValueError(f"{name[-60:]!r}: at most {MOST} files stand beside a design")
        await received(folder / name, name, content, LARGEST)

    def read(self, group: object, text: str) -> "DesignFile":
        """The design file of a text with the files of its group beside it, which are deleted then.

        Raises `DesignFileError` with all that is wrong.
        """
        from squealbox.files import read_text

        known = isinstance(group, str) and GROUP.fullmatch(group) and (self.folder / group).is_dir()
        if not known:
            return read_text(text, "the file", beside=False)
        folder = self.folder / str(group)
        try:
            return read_text(text, str(folder / "design.toml"))
        finally:
            shutil.rmtree(folder, ignore_errors=True)

    def close(self) -> None:
        """Delete them."""
        shutil.rmtree(self.folder, ignore_errors=True)


def in_one_text(found: "DesignFile", text: str) -> str:
    """The text of a file that holds all the design is made of, and the sections of the text that was read.

    Raises `NotWritable` for a design that no file can hold.
    """
    import tomlkit

    from squealbox.files import design_text
    from squealbox.workbench.rewriting import with_sections

    return with_sections(design_text(found.design), tomlkit.parse(text))

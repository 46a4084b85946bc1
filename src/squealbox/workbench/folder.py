"""A project on disk: a folder of plain files that an engineer reads and puts under git.

    designs/NAME.toml     a design, readable by every command; NAME.json beside it: settings of the page, a note
    notes.md              notes
    measurements/         recordings that were kept, or copied there by hand
    results/              figures, tables and reports that were kept
    history.jsonl         every state that was left, with its time and, where one was given, a name
    texts/                the design files that states of the history came from
    state.json            the page as it was last
    trash/                what was deleted or written over

A file is written whole or not at all. What is no name of a file, or leads out of the folder, is refused.
"""

import contextlib
import hashlib
import json
import os
import re
import secrets
import tempfile
import threading
import time
from collections.abc import AsyncIterator, Mapping
from datetime import datetime
from pathlib import Path
from typing import Any

from squealbox.workbench.recorded import KINDS, LARGEST, received

FOLDER = (
    "SQUEALBOX_PROJECT"  # of the environment: the folder used where none is given; the server sets it for processes
)
LARGEST_TEXT = 1_000_000  # characters of a design file or of the notes
LARGEST_STATE = 200_000  # characters of laws, values and settings
LARGEST_HISTORY = 5_000_000  # bytes of history.jsonl; a longer one is put aside under the time
MOST = 500  # files of one kind that are listed
LARGEST_READ = 20_000_000  # bytes of a text that is read
NAME = re.compile(r"[^\W_][\w .,()+=%-]{0,149}")
RESERVED = re.compile(r"(con|prn|aux|nul|com\d|lpt\d)(\..*)?", re.IGNORECASE)  # names that Windows keeps for devices
PARTS = {"measurements": KINDS, "results": (".png", ".svg", ".csv", ".html", ".wav", ".toml")}
SAID = {"time": "", "id": "", "title": "", "words": "", "name": ""}  # of a line of the history, beside its state
STATE = {"brake": str, "laws": Mapping, "values": Mapping, "settings": Mapping}


class ProjectError(ValueError):
    """Something that cannot be kept or read; the message is one sentence."""


def standing() -> Path:
    """The project of those who name none: `SQUEALBOX_PROJECT`, else squealbox/workbench in the user's data folder."""
    given = os.environ.get(FOLDER, "")
    base = os.environ.get("XDG_DATA_HOME") or Path.home() / ".local" / "share"
    return Path(given) if given else Path(base) / "squealbox" / "workbench"


class Project:
    """The files of one project. Nothing is made before something is kept; several servers may share a folder."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder.absolute()
        self._lock = threading.Lock()

    def sweep(self) -> None:
        """Remove what writes left that were killed more than an hour ago."""
        for part in ("", "designs", "measurements", "results", "texts", "trash"):
            for path in (self.folder / part).glob(".*.part"):
                with contextlib.suppress(OSError):
                    if time.time() - path.stat().st_mtime > 3600.0:
                        path.unlink()

    def text(self, part: str, name: str) -> str:
        """The text of a file. Raises `ProjectError` where there is none, it is a link, too long, or no text."""
        path = self._place(part, name)
        try:
            if path.stat().st_size > LARGEST_READ:
                raise ProjectError(f"{path.name} has {path.stat().st_size} bytes: too long to be read here")
            return path.read_text(encoding="utf-8").replace("\r\n", "\n")
        except UnicodeDecodeError as error:
            raise ProjectError(f"{path.name}: byte {error.start} is no UTF-8 text") from error
        except OSError as error:
            raise ProjectError(f"{path.name} cannot be read: {error.strerror}") from error

    def data(self, part: str, name: str) -> dict[str, Any]:
        """What a JSON file holds, nothing where there is none. Raises `ProjectError` with the line that is wrong."""
        if not self._place(part, name).exists():
            return {}
        try:
            found = json.loads(self.text(part, name))
        except json.JSONDecodeError as error:
            raise ProjectError(f"{name} line {error.lineno}: {error.msg}") from error
        except RecursionError as error:
            raise ProjectError(f"{name} is nested too deeply") from error
        if not isinstance(found, dict):
            raise ProjectError(f"{name} line 1: expected a table in braces")
        return found

    def write(self, part: str, name: str, content: str | bytes) -> None:
        """A file, written whole or not at all. Raises `ProjectError` where it cannot be, as on a full disk."""
        path, data = self._place(part, name), content.encode() if isinstance(content, str) else content
        temporary = ""
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            handle, temporary = tempfile.mkstemp(dir=path.parent, prefix=".", suffix=".part")
            with os.fdopen(handle, "wb") as file:
                file.write(data)
                file.flush()
                os.fsync(file.fileno())
            os.chmod(temporary, 0o644)
            os.replace(temporary, path)
        except OSError as error:
            if temporary:
                Path(temporary).unlink(missing_ok=True)
            raise _not_kept(path, error) from error

    def names(self, part: str, *kinds: str) -> list[str]:
        """The files of a kind in a folder of the project, by name; hidden ones and links are passed over."""
        folder = self.folder / part
        try:
            found = sorted(each.name for each in os.scandir(folder) if each.is_file(follow_symlinks=False))
        except FileNotFoundError:
            return []
        except OSError as error:
            raise ProjectError(f"{folder} cannot be read: {error.strerror}") from error
        return [name for name in found if name.lower().endswith(kinds) and good(name)][:MOST]

    def about(self, part: str, name: str) -> dict[str, Any]:
        """Name, size in bytes and time [s since 1970] of a file."""
        try:
            found = self._place(part, name).stat()
        except OSError as error:
            raise ProjectError(f"{name} cannot be read: {error.strerror}") from error
        return {"name": name, "size": found.st_size, "when": found.st_mtime}

    def throw(self, part: str, name: str, stamp: str = "", *, stays: bool = False) -> str:
        """Move a file into trash/, or copy it there where it `stays`; its name there, empty where there was none."""
        path, kept = self._place(part, name), f"{stamp or now()} {name}"
        if not path.exists():
            return ""
        try:
            if stays:
                self.write("trash", kept, path.read_bytes())
                return kept
            (self.folder / "trash").mkdir(exist_ok=True)
            os.replace(path, self._place("trash", kept))
        except OSError as error:
            raise ProjectError(f"{name} cannot be moved to trash/: {error.strerror}") from error
        return kept

    def back(self, part: str, kept: str, name: str) -> None:
        """Move a file out of trash/ again. Raises `ProjectError` where its name is taken meanwhile."""
        path = self._place(part, name)
        if path.exists():
            raise ProjectError(f"there is another {name} now: it stays in trash/")
        try:
            os.replace(self._place("trash", kept), path)
        except OSError as error:
            raise ProjectError(f"{name} cannot be taken back: {error.strerror}") from error

    async def take(self, part: str, name: str, content: AsyncIterator[bytes]) -> str:
        """Keep what the page sends, a recording or a result, piece by piece; a file of that name goes to trash/."""
        kinds = PARTS.get(part, ())
        if not name.lower().endswith(kinds):
            raise ProjectError(f"{name[-60:]!r}: expected one of {', '.join(kinds)}")
        path, temporary = self._place(part, name), ""
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            handle, temporary = tempfile.mkstemp(dir=path.parent, prefix=".", suffix=".part")
            os.close(handle)
            await received(Path(temporary), name, content, LARGEST)
            self.throw(part, name)
            os.chmod(temporary, 0o644)
            os.replace(temporary, path)
        except OSError as error:
            raise _not_kept(path, error) from error
        finally:
            if temporary:
                Path(temporary).unlink(missing_ok=True)
        return name

    def file(self, part: str, name: str) -> Path | None:
        """The path of a recording or a result that is there."""
        if part not in PARTS or not name.lower().endswith(PARTS[part]):
            return None
        path = self._place(part, name)
        return path if path.is_file() else None

    def keep(self, state: Mapping[str, Any], said: Mapping[str, str]) -> None:
        """Keep the page's state, and a line of the history where the design is another than that of the last line.

        `said` goes into the line: title of the brake, words for what has changed, a name, which makes it a line of its
        own in any case.
        """
        carried: dict[str, Any] = {each: state.get(each) for each in STATE}
        if any(not isinstance(carried[each], kind) for each, kind in STATE.items()):
            raise ProjectError("state: expected brake, laws, values and settings")
        if len(json.dumps(carried)) > LARGEST_STATE:
            raise ProjectError(f"the state has more than {LARGEST_STATE} characters and is not kept")
        text = state.get("text")
        if text is not None:
            if not isinstance(text, str) or len(text) > LARGEST_TEXT:
                raise ProjectError(f"expected a text of at most {LARGEST_TEXT} characters")
            kept = key_of(text)
            carried |= {"text": kept, "name": str(state.get("name") or "")[:80]}
            if not self._place("texts", f"{kept}.toml").exists():
                self.write("texts", f"{kept}.toml", text)
        line = {
            "time": datetime.now().astimezone().isoformat(timespec="seconds"),
            "id": secrets.token_hex(6),
            **said,
            "state": carried,
        }
        with self._lock:
            last = self.last()
            if said.get("name") or last is None or _design(last["state"]) != _design(carried):
                self._append(json.dumps(line))
            self.write("", "state.json", json.dumps(line, indent=1))

    def last(self) -> dict[str, Any] | None:
        """The page as it was last; None where nothing was kept or it cannot be read, which `history` says."""
        try:
            found = self.data("", "state.json")
        except ProjectError:
            return None
        return found if isinstance(found.get("state"), dict) else None

    def history(self) -> tuple[list[dict[str, Any]], list[str]]:
        """The lines of the history, the newest first, and a sentence for each that cannot be read."""
        if not self._place("", "history.jsonl").exists():
            return [], []
        found: list[dict[str, Any]] = []
        wrong: list[str] = []
        for number, line in enumerate(self.text("", "history.jsonl").split("\n"), 1):
            if not line.strip():
                continue
            try:
                read = json.loads(line)
            except ValueError:
                read = None
            if isinstance(read, dict) and isinstance(read.get("state"), dict):
                found.append({**SAID, **read})
            else:
                wrong.append(f"history.jsonl line {number} cannot be read")
        return found[::-1], wrong

    def whole(self, line: Mapping[str, Any]) -> dict[str, Any]:
        """The state of a line of the history, with the text of its design file."""
        state = dict(line["state"])
        if state.get("text"):
            state["text"] = self.text("texts", f"{str(state['text'])[:16]}.toml")
        return state

    def _append(self, line: str) -> None:
        path = self._place("", "history.jsonl")
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
            if path.exists() and path.stat().st_size > LARGEST_HISTORY:
                named = [json.dumps(each) + "\n" for each in self.history()[0][::-1] if each["name"]]
                os.replace(path, self._place("", f"history {now()}.jsonl"))
                self.write("", "history.jsonl", "".join(named))
            handle = os.open(path, os.O_RDWR | os.O_CREAT | os.O_APPEND | getattr(os, "O_NOFOLLOW", 0), 0o644)
            with os.fdopen(handle, "rb+", buffering=0) as file:
                end = file.seek(0, os.SEEK_END)
                file.seek(max(end - 1, 0))
                torn = end > 0 and file.read(1) != b"\n"  # a line that a crash has cut: the next begins a new one
                file.write(("\n" * torn + line + "\n").encode())
                os.fsync(file.fileno())
        except OSError as error:
            raise _not_kept(path, error) from error

    def _place(self, part: str, name: str) -> Path:
        """Where a file stands. Raises `ProjectError` for what is no name, and for links, which lead elsewhere."""
        if not isinstance(name, str) or not good(name):
            raise ProjectError(f"{str(name)[:60]!r} is no name of a file here")
        folder = self.folder / part
        if part and folder.is_symlink():
            raise ProjectError(f"{part}/ is a link, which is not followed")
        if (folder / name).is_symlink():
            raise ProjectError(f"{name} is a link, which is not followed")
        return folder / name


def key_of(text: str) -> str:
    """A short name for a text: the same for the same text."""
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def good(name: str) -> bool:
    """True for the name of a file: no folder, nothing hidden, nothing an operating system takes for something else."""
    ends = name.rstrip(". ") == name and len(name.encode()) <= 200
    return bool(NAME.fullmatch(name)) and ends and not RESERVED.fullmatch(name)


def _design(state: Mapping[str, Any]) -> str:
    return json.dumps([state.get(each) for each in ("brake", "laws", "values", "text")], sort_keys=True)


def now() -> str:
    """The time, as names in trash/ begin with it; no two are alike."""
    return f"{datetime.now():%Y-%m-%d %H.%M.%S.%f} {secrets.token_hex(2)}"


def _not_kept(path: Path, error: OSError) -> ProjectError:
    return ProjectError(f"{path.name} is not kept in {path.parent}: {error.strerror or error}")

"""A folder in which a running sweep cannot be lost: one file for each finished block, and one NetCDF file in the end.

    study.json      what is computed; another study is refused
    axes.npz        the values of the parameters
    blocks/         START-STOP-DIGEST.npz: the answers at the points START to STOP - 1; the digest is that of the bytes
    run.log         what happened, for people
    sweep.nc        the whole, once every block is there; finished.json holds its digest, and the blocks are gone then

Every file appears whole or not at all (written aside, fsync, renamed), so a process may be killed at any instant. One
process writes at a time, which a lock sees to. A file whose bytes are not what its digest says is never used.
"""

import hashlib
import json
import os
import re
import time
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, Self

from squealbox.studies.block import Block
from squealbox.studies.fingerprint import changes, digest
from squealbox.studies.layout import Frame, Summary, frame_bytes, frame_from, summary_of
from squealbox.studies.locking import Lock, is_held

FORMAT = 1
STUDY, FINISHED, RESULT, LOG, LOCK, BLOCKS, AXES = (
    "study.json", "finished.json", "sweep.nc", "run.log", "lock", "blocks", "axes.npz",
)  # fmt: skip
_NAME = re.compile(r"(\d{12,})-(\d{12,})-([0-9a-f]{32})\.npz")


class StoreError(Exception):
    """The folder of a sweep cannot be used; the message names it and says why. Nothing in it was changed."""


class ForeignStore(StoreError):
    """The folder holds something else."""


class StudyChanged(StoreError):
    """The folder holds another study; `changes` says what differs."""

    def __init__(self, message: str, changes: list[str]) -> None:
        self.changes = changes
        super().__init__(message)


class StoreLocked(StoreError):
    """Another process is writing to the folder."""


class StoreDamaged(StoreError):
    """A file of the folder does not hold what was written to it."""


class StoreFull(StoreError):
    """A block could not be written; the blocks before it are safe."""


class Store:
    """The folder of one sweep, opened by `created_or_resumed` to be written, or by `opened` to be read."""

    def __init__(self, path: Path, record: Mapping[str, Any], lock: Lock | None = None) -> None:
        self.path, self.record = path, record
        self.done: dict[tuple[int, int], Summary] = {}
        self.damaged: list[str] = []
        self._names: dict[tuple[int, int], str] = {}
        self._lock = lock

    @classmethod
    def created_or_resumed(cls, path: Path, record: Mapping[str, Any]) -> Self:
        """Open to write: a new folder, or one that holds blocks of this very study."""
        lock = _begin(path)
        try:
            if (path / STUDY).exists():
                _check_same(path, read_record(path), record)
            else:
                for left in path.glob(f"{STUDY}.part*"):
                    left.unlink()
                (path / BLOCKS).mkdir(exist_ok=True)
                write_whole(path / STUDY, _text({"format": FORMAT, "study": record}))
            store = cls(path, record, lock)
            store._clear_unfinished()
            store._look(repair=True)
            return store
        except BaseException:
            lock.release()
            raise

    @classmethod
    def opened(cls, path: Path) -> Self:
        """Open to read, also while someone writes."""
        store = cls(path, read_record(path))
        store._look(repair=False)
        return store

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        if self._lock is not None:
            self._lock.release()

    @property
    def finished(self) -> bool:
        """True when the whole is in `sweep.nc`."""
        return (self.path / FINISHED).exists()

    @property
    def writing(self) -> bool:
        """True while some process writes to the folder."""
        return is_held(self.path / LOCK)

    def add(self, block: Block) -> None:
        """Write a block; `StoreFull` or another `StoreError` when that is impossible, with the store as it was."""
        data = block.to_bytes()
        name = f"{block.start:012d}-{block.stop:012d}-{digest(data)}.npz"
        write_whole(self.path / BLOCKS / name, data)
        self._names[block.start, block.stop] = name
        self.done[block.start, block.stop] = summary_of(block)

    def blocks(self) -> Iterator[Block]:
        """The finished blocks in order; `StoreDamaged` names one that is not what was written."""
        for place in sorted(self._names):
            name = self._names[place]
            block = _read_block(self.path / BLOCKS / name)
            if block is None:
                text = f"{self.path / BLOCKS / name} is damaged: run the study again, which computes it anew"
                raise StoreDamaged(text)
            yield block

    def finish(self, data: Path) -> Path:
        """Make the file `data`, written beside it, the result; the blocks are removed when it is safe."""
        result = self.path / RESULT
        with _explained(self.path):
            _flush(data)
            os.replace(data, result)
            _flush_folder(self.path)
        about = {"format": FORMAT, "file": RESULT, "bytes": result.stat().st_size, "digest": file_digest(result)}
        write_whole(self.path / FINISHED, _text(about))
        self.remove_blocks()
        return result

    def result(self) -> Path:
        """The finished file, after a look at its bytes; `StoreDamaged` when they are not those written."""
        about = _json(self.path / FINISHED)
        file = self.path / RESULT
        if not file.exists():
            raise StoreDamaged(f"{file} is missing, although {FINISHED} says that it was written")
        if file.stat().st_size != about.get("bytes") or file_digest(file) != about.get("digest"):
            raise StoreDamaged(f"{file} is damaged: its bytes are not those that were written; nothing was changed")
        return file

    def remove_blocks(self) -> None:
        """Take away the blocks of a finished sweep."""
        for name in self._names.values():
            (self.path / BLOCKS / name).unlink(missing_ok=True)
        self._names.clear()

    def keep_frame(self, frame: Frame) -> None:
        """Write the axes beside the blocks, so that a reader needs nothing else."""
        write_whole(self.path / AXES, frame_bytes(frame))

    def frame(self) -> Frame:
        """The axes as `keep_frame` wrote them."""
        try:
            return frame_from((self.path / AXES).read_bytes())
        except (OSError, ValueError) as error:
            raise StoreDamaged(f"{self.path / AXES} is damaged, it cannot be read: {error}") from error

    def explained(self) -> "_explained":
        """Used with ``with``: an error of the file system becomes a `StoreError` that says what is safe."""
        return _explained(self.path)

    def reserve(self, path: Path, size: int) -> None:
        """See that a file of this size can be written, which HDF5 would find out too late."""
        with self.explained(), path.open("wb") as stream:
            if hasattr(os, "posix_fallocate") and size > 0:
                os.posix_fallocate(stream.fileno(), 0, size)
        path.unlink()

    def log(self, text: str) -> None:
        """A line of run.log, with the time."""
        with _explained(self.path), (self.path / LOG).open("a", encoding="utf-8") as stream:
            stream.write(f"{time.strftime('%Y-%m-%d %H:%M:%S')}  {text}\n")

    def _clear_unfinished(self) -> None:
        for left in [*self.path.glob("*.part"), *(self.path / BLOCKS).glob("*.part")]:
            left.unlink()

    def _look(self, *, repair: bool) -> None:
        """Take stock of the blocks; with `repair`, damaged ones are put aside to be computed anew."""
        folder = self.path / BLOCKS
        for file in sorted(folder.glob("*.npz")) if folder.is_dir() else []:
            match = _NAME.fullmatch(file.name)
            if match is None:
                raise ForeignStore(f"{file} is no block of this study: take it away")
            place = int(match[1]), int(match[2])
            block = _read_block(file)
            if block is None:
                self.damaged.append(file.name)
                if repair:
                    os.replace(file, file.with_suffix(".damaged"))
                    self.log(f"{file.name} is damaged: put aside, to be computed again")
                continue
            if any(place[0] < stop and start < place[1] for start, stop in self.done):
                raise StoreDamaged(f"{file} overlaps with another block: take one of them away")
            self._names[place] = file.name
            self.done[place] = summary_of(block)


def read_record(path: Path) -> dict[str, Any]:
    """The study a folder holds."""
    if not path.is_dir():
        raise StoreError(f"{path} is no folder of a study: there is no such folder")
    if not (path / STUDY).exists():
        raise ForeignStore(f"{path} is no folder of a study: it has no {STUDY}")
    about = _json(path / STUDY)
    if about.get("format") != FORMAT or not isinstance(about.get("study"), dict):
        raise ForeignStore(f"{path / STUDY} is of format {about.get('format')!r}: this version reads {FORMAT}")
    study: dict[str, Any] = about["study"]
    return study


def write_whole(path: Path, data: bytes) -> None:
    """Write a file so that it is there whole or not at all, and stays after a power cut."""
    part = path.with_name(path.name + ".part")
    with _explained(path.parent):
        try:
            with part.open("wb") as stream:
                stream.write(data)
                stream.flush()
                os.fsync(stream.fileno())
            os.replace(part, path)
        finally:
            part.unlink(missing_ok=True)
        _flush_folder(path.parent)


def file_digest(path: Path) -> str:
    """The digest of the bytes of a file."""
    whole = hashlib.sha256()
    with path.open("rb") as stream:
        while part := stream.read(1 << 22):
            whole.update(part)
    return whole.hexdigest()[:32]


class _explained:
    """Turns an error of the file system into a `StoreError` that says what is safe."""

    def __init__(self, path: Path) -> None:
        self.path = path

    def __enter__(self) -> None:
        return None

    def __exit__(self, kind: object, error: BaseException | None, trace: object) -> None:
        if isinstance(error, (OSError, RuntimeError)):  # the latter from HDF5, which has no errors of the system
            why = getattr(error, "strerror", None) or str(error)
            text = f"{self.path}: cannot be written ({why}); what was finished before is safe, and the study can go on"
            raise StoreFull(text) from error


def _begin(path: Path) -> Lock:
    """The folder, made when it is not there, and its lock."""
    try:
        path.mkdir(parents=True, exist_ok=True)
        strange = sorted(each.name for each in path.iterdir()) if not (path / STUDY).exists() else []
        strange = [name for name in strange if name not in (LOCK, LOG, BLOCKS) and not name.startswith(f"{STUDY}.part")]
        if strange:
            raise ForeignStore(f"{path} holds {strange[0]} and no study: give a new or an empty folder")
        lock = Lock(path / LOCK)
        free = lock.acquire()
    except OSError as error:
        raise StoreError(f"{path}: a study cannot be written there: {error.strerror or error}") from error
    if not free:
        raise StoreLocked(f"{path} is being written to by another process: wait for it, or give another folder")
    return lock


def _check_same(path: Path, old: Mapping[str, Any], new: Mapping[str, Any]) -> None:
    found = changes(old, json.loads(json.dumps(new)))
    if found:
        text = f"{path} holds another study: {'; '.join(found)}. Give another folder, or the study as it was"
        raise StudyChanged(text, found)


def _read_block(file: Path) -> Block | None:
    """The block in a file, or None when its bytes are not those that were written."""
    match = _NAME.fullmatch(file.name)
    assert match is not None
    try:
        data = file.read_bytes()
        if digest(data) != match[3]:
            return None
        block = Block.from_bytes(data)
    except (OSError, ValueError):
        return None
    return block if (block.start, block.stop) == (int(match[1]), int(match[2])) else None


def _json(path: Path) -> dict[str, Any]:
    try:
        about = json.loads(path.read_bytes())
    except (OSError, ValueError) as error:
        raise StoreDamaged(f"{path} is damaged, it cannot be read: {error}; nothing was changed") from error
    if not isinstance(about, dict):
        raise StoreDamaged(f"{path} is damaged: it holds no table; nothing was changed")
    return about


def _text(about: Mapping[str, Any]) -> bytes:
    return json.dumps(about, indent=1, allow_nan=True).encode()


def _flush(path: Path) -> None:
    with path.open("rb+") as stream:
        os.fsync(stream.fileno())


def _flush_folder(path: Path) -> None:
    if os.name == "posix":  # elsewhere a folder cannot be opened
        handle = os.open(path, os.O_RDONLY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)

"""One page's conversation with the server. Nothing is kept of it but the files it opened and what it puts on disk.

A question is a JSON text, an answer a binary frame (`frames`) with the question's `id`:

    {"id": 7, "view": "locus", "state": {...}, "options": {...}}    ask a panel
    {"id": 8, "ask": "sheet", "state": {...}}                       fields of a design; with "toml": true its text
    {"id": 9, "ask": "open", "text": "brake = ..."}                 read a design file, "beside": those it names
    {"id": 10, "ask": "stop", "view": "motion"}                     stop a panel's computation
    {"id": 11, "ask": "project", "do": "save", "name": "bench 7"}   what is kept on disk (`project`)

Of each view one question is answered at a time; of those that arrive meanwhile only the newest waits, and the others
are answered at once with `superseded`. Views do not wait for each other, and slow ones have threads of their own; those
that cannot look every tenth of a second whether they are still wanted have processes of their own (`apart`).
"""

import asyncio
import functools
import json
import time
from collections.abc import Awaitable, Callable, Mapping
from concurrent.futures import Executor
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from squealbox.design import Design
from squealbox.designs import DESIGNS
from squealbox.workbench.apart import Died, Processes
from squealbox.workbench.folder import Project, ProjectError, key_of, standing
from squealbox.workbench.frames import frame
from squealbox.workbench.panels import PANELS, Answer, Elsewhere, OptionError, Options, Stopped, Work, function_of
from squealbox.workbench.sheet import sheet
from squealbox.workbench.state import StateError, UnknownBase, design_of
from squealbox.workers import Tell

if TYPE_CHECKING:
    from squealbox.files import DesignFile
    from squealbox.workbench.beside import Beside

LONGEST_TEXT = 1_000_000  # characters of an opened file
MOST_BASES = 8  # opened files kept for a page; the page sends an older one again
KEPT = 8  # designs of the last states: a slider's move asks several views about one
LARGE = 40  # degrees of freedom from which every answer gets a process of its own: other pages are not held up
SINGLE = 160  # the same, of answers that take one spectrum
PER_CUBE = 5e-6  # s an answer takes about, times the cube of the degrees of freedom
SAID = 0.1  # s after which a progress is told again
LARGE_FILE = "open it with squealbox lab FILE"
SPARSE = "a finite-element brake is made small first, which takes a while: " + LARGE_FILE
LONGEST_ID = 9_007_199_254_740_991  # the largest whole number a page can count to


class Malformed(ValueError):
    """A message that is no question."""


@dataclass
class Slot:
    """What one view is working on, and the newest question that waits for it."""

    work: Work | None = None
    waiting: dict[str, Any] | None = None


@dataclass(frozen=True)
class Opened:
    """A design file as the page opened it: its text, what was read from it, and how it is read."""

    text: str
    found: "DesignFile"
    read: "Callable[[str], DesignFile]"
    design: Design | None = None  # what the page shows of it, where that is not the design itself


@dataclass
class Session:
    """A page's conversation: `send` takes a frame, `pools` are where answers are computed.

    A slow panel has a pool of its own name, the others share the one called "quick"; `processes` are for those apart,
    and what is written to disk goes one after the other through the pool called "project".
    `bases` are the designs of opened files, `files` the files; they may begin with the one the workbench was started
    with.
    """

    send: Callable[[bytes], Awaitable[None]]
    pools: Mapping[str, Executor]
    processes: Processes
    told: Callable[[str], None] | None = None  # of each view that was answered
    bases: dict[str, Design] = field(default_factory=dict)
    files: dict[str, Opened] = field(default_factory=dict)
    project: Project = field(default_factory=lambda: Project(standing()))
    beside: "Beside | None" = None
    slots: dict[str, Slot] = field(default_factory=dict)
    tasks: set[asyncio.Task[None]] = field(default_factory=set)

    async def take(self, text: str) -> None:
        """Read one message and see to its answer; what is no question is answered with what was expected."""
        number: int | None = None
        try:
            message = _read(text)
            number = message["id"]
            if "view" in message and message.get("ask") is None:
                await self._view(message)
            else:
                await self._ask(message)
        except Malformed as error:
            await self.send(frame({"id": number, "kind": "malformed", "message": str(error)}))

    def close(self) -> None:
        """The page is gone: nobody waits for what is being computed."""
        for slot in self.slots.values():
            slot.waiting = None
            if slot.work is not None:
                slot.work.stop()

    async def _view(self, message: dict[str, Any]) -> None:
        name = message["view"]
        if not isinstance(name, str) or name not in PANELS:
            raise Malformed(f"view: expected one of {', '.join(PANELS)}")
        slot = self.slots.setdefault(name, Slot())
        if slot.work is None:
            slot.work = Work()  # taken before the task runs, so that the next question waits
            self._start(self._answers(name, slot, message))
            return
        older, slot.waiting = slot.waiting, message
        if older is not None:
            await self.send(frame({"id": older["id"], "view": name, "kind": "superseded"}))

    def _start(self, work: Any) -> None:
        task = asyncio.ensure_future(work)
        self.tasks.add(task)
        task.add_done_callback(self.tasks.discard)

    async def _answers(self, name: str, slot: Slot, message: dict[str, Any]) -> None:
        """Answer a view's questions one after the other until none waits."""
        following: dict[str, Any] | None = message
        try:
            while following is not None:
                slot.work = self._work(name, following["id"])
                await self._answer(name, following, slot.work)
                following, slot.waiting = slot.waiting, None
        finally:
            slot.work = None

    def _work(self, name: str, number: int) -> Work:
        loop = asyncio.get_running_loop()
        said: tuple[float, str] = (0.0, "")

        def report(share: float, text: str) -> None:
            nonlocal said
            now = time.monotonic()
            if text == said[1] and now - said[0] < SAID:
                return
            said = (now, text)
            data = frame({"id": number, "view": name, "kind": "progress", "share": share, "text": text})
            loop.call_soon_threadsafe(lambda: self._start(self.send(data)))

        return Work(report)

    async def _answer(self, name: str, message: dict[str, Any], work: Work) -> None:
        loop = asyncio.get_running_loop()
        data = await loop.run_in_executor(
            self.pools.get(name, self.pools["quick"]), self._computed, name, message, dict(self.bases), work
        )
        await self.send(data)
        if self.told is not None:
            self.told(name)

    def _computed(self, name: str, message: dict[str, Any], bases: dict[str, Design], work: Work) -> bytes:
        """The answer of a panel, in this thread or in a process of its own."""
        usual = None
        if not PANELS[name].apart:
            try:
                return answered(name, message, bases, work)
            except Elsewhere as reason:
                usual = (reason.text, reason.seconds)
        about = {"id": message["id"], "view": name}
        try:
            found = self.processes.answer((name, message, bases), work.say, lambda: work.stopped, usual)
        except Died as error:
            return frame({**about, "kind": "failed", "message": str(error)})
        return frame({**about, "kind": "stopped"}) if found is None else found

    async def _ask(self, message: dict[str, Any]) -> None:
        ask = message.get("ask")
        if ask == "stop":
            slot = self.slots.get(str(message.get("view"))[:40])
            if slot is not None and slot.work is not None:
                slot.waiting = None
                slot.work.stop()
            await self.send(frame({"id": message["id"], "kind": "done"}))
        elif ask in ("sheet", "open", "project"):
            answer = {"sheet": self._sheet, "open": self._open, "project": self._project}[ask]
            pool = "project" if ask == "project" or message.get("toml") is True else "quick"  # writing files takes time
            await self.send(await asyncio.get_running_loop().run_in_executor(self.pools[pool], answer, message))
        else:
            raise Malformed("ask: expected one of sheet, open, project, stop; or view")

    def give(self, file: Opened) -> str:
        """Make a design file known to the page; the name under which it speaks of it."""
        base = key_of(file.text)
        while base not in self.bases and len(self.bases) >= MOST_BASES:
            self.files.pop(next(iter(self.bases)), None)
            self.bases.pop(next(iter(self.bases)))
        self.bases[base], self.files[base] = file.design or file.found.design, file
        return base

    def _file(self, text: str) -> Opened:
        """A design file by its text; one that is known may be that of the command line, with matrices beside it."""
        from squealbox.files import read_text

        read = functools.partial(read_text, name="the file", beside=False)
        return self.files.get(key_of(text)) or Opened(text, read(text), read)

    def _sheet(self, message: dict[str, Any]) -> bytes:
        about = {"id": message["id"], "ask": "sheet"}
        try:
            design = design_of(message.get("state"), self.bases)
        except StateError as error:
            return frame({**about, **_wrong(error)})
        try:
            written = self._toml(design, message) if message.get("toml") is True else {}
            return frame({**about, "kind": "sheet", "sheet": sheet(design), **written})
        except (ArithmeticError, ValueError) as error:  # a value at the end of what numbers reach
            return _failed(about, error)

    def _open(self, message: dict[str, Any]) -> bytes:
        about = {"id": message["id"], "ask": "open"}
        text = message.get("text")
        if not isinstance(text, str) or len(text) > LONGEST_TEXT:
            problem = {"line": 0, "field": "", "message": f"expected a text of at most {LONGEST_TEXT} characters"}
            return frame({**about, "kind": "wrong", "wrong": [problem]})
        from squealbox.files import DesignFileError, NotWritable  # loads much, and few open a file at once
        from squealbox.workbench.rewriting import settings_of

        try:
            file = self._file(text) if message.get("beside") is None else self._whole(text, message["beside"])
        except DesignFileError as error:
            wrong = [{"line": each.line, "field": each.key, "message": each.message} for each in error.problems]
            return frame({**about, "kind": "wrong", "wrong": wrong})
        except NotWritable as error:
            return frame({**about, "kind": "wrong", "wrong": [{"line": 0, "field": "", "message": str(error)}]})
        if (file.design or file.found.design).system().is_sparse:
            return frame({**about, "kind": "wrong", "wrong": [{"line": 0, "field": "", "message": SPARSE}]})
        opened = {"base": self.give(file), "brake": _name(file.found.design), "settings": settings_of(file.found)}
        return frame({**about, "kind": "opened", "text": file.text, **opened})

    def _whole(self, text: str, group: object) -> Opened:
        """A design file that names others, which the page has sent: as one text."""
        from squealbox.files import NotWritable
        from squealbox.workbench.beside import in_one_text

        if self.beside is None:
            return self._file(text)
        found = self.beside.read(group, text)
        if found.design.system().is_sparse:
            raise NotWritable(SPARSE)
        whole = in_one_text(found, text)
        if len(whole) > LONGEST_TEXT:
            raise NotWritable(f"its matrices are a text of more than {LONGEST_TEXT} characters: {LARGE_FILE}")
        return self._file(whole)

    def _toml(self, design: Design, message: Mapping[str, Any]) -> dict[str, Any]:
        """The text of a file of the design: that of the opened file with its changes, where it came from one."""
        from squealbox.files import NotWritable, design_text

        file = self.files.get(str(message["state"].get("base")))
        try:
            if file is None:
                return {"toml": design_text(design), "said": ""}
            from squealbox.workbench.rewriting import rewritten

            given = message.get("settings")
            settings = given if isinstance(given, Mapping) else {}
            text, said = rewritten(file.text, file.found.design, design, settings, file.read)
            return {"toml": text, "said": said}
        except NotWritable as error:
            return {"toml": None, "notWritable": str(error)}

    def _project(self, message: dict[str, Any]) -> bytes:
        from squealbox.workbench.project import done

        about = {"id": message["id"], "ask": "project"}
        try:
            return frame({**done(self.project, message, self._written), **about})
        except (ArithmeticError, ValueError, OSError) as error:
            return _failed(about, error)

    def _written(self, state: Mapping[str, Any]) -> Any:
        """A state as the page keeps it, with the text it came from: its design, and what makes its file."""
        from squealbox.files import DesignFileError

        text = state.get("text")
        try:
            base = self.give(self._file(text)) if isinstance(text, str) else None
            design = design_of({**state, "base": base}, self.bases)
        except (StateError, DesignFileError) as error:
            raise ProjectError(f"This design has something wrong in it: {error}") from error

        def made() -> tuple[str, str]:
            found = self._toml(design, {"state": {"base": base}, "settings": state.get("settings")})
            if found["toml"] is None:
                raise ProjectError(found["notWritable"])
            return found["toml"], found["said"]

        return design, made


def answered(name: str, message: Mapping[str, Any], bases: Mapping[str, Design], work: Work) -> bytes:
    """The frame that answers a question to a panel; whatever goes wrong is an answer too.

    Raises `Elsewhere` where the answer needs a process of its own.
    """
    about = {"id": message["id"], "view": name}
    try:
        if work.stopped:
            raise Stopped
        design, size = _asked(message.get("state"), bases)
        if size > (SINGLE if PANELS[name].single else LARGE) and not (work.apart or PANELS[name].light):
            raise Elsewhere(f"computing, with {size} degrees of freedom", PER_CUBE * size**3)
        with np.errstate(all="ignore"):  # of extreme values: what is not finite is said in the answer
            answer: Answer = function_of(name)(design, Options(message.get("options") or {}, bases), work)
        data, arrays = answer.sent()
        framed = frame({**about, "kind": "answer", "data": data}, arrays)
    except StateError as error:
        return frame({**about, **_wrong(error)})
    except OptionError as error:
        return frame({**about, "kind": "wrong", "wrong": [{"field": "", "message": str(error)}]})
    except Stopped:
        return frame({**about, "kind": "stopped"})
    except Elsewhere:
        raise
    except Exception as error:  # a panel that fails says so in its own place; the others go on
        return _failed(about, error)
    return framed


def answered_apart(tell: Tell, name: str, message: Mapping[str, Any], bases: Mapping[str, Design]) -> bytes:
    """The same in a process of its own, which tells how far it is."""
    return answered(name, message, bases, Work(tell, apart=True))


def _asked(state: Any, bases: Mapping[str, Design]) -> tuple[Design, int]:
    """The design of a question and its degrees of freedom, made once for the views that ask about one state."""
    base = bases.get(str(state.get("base"))) if isinstance(state, Mapping) else None
    return _made(json.dumps(state), base)


@functools.lru_cache(maxsize=KEPT)
def _made(state: str, base: Design | None) -> tuple[Design, int]:
    given = json.loads(state)
    design = design_of(given, {} if base is None else {given["base"]: base})
    return design, design.system().size


def _failed(about: Mapping[str, Any], error: Exception) -> bytes:
    """What could not be computed, as an answer: the page says it in the panel's own place."""
    text = " ".join(str(error).split())[:500]
    return frame({**about, "kind": "failed", "message": f"{type(error).__name__}: {text}"})


def _wrong(error: StateError) -> dict[str, Any]:
    kind = "unknown_base" if isinstance(error, UnknownBase) else "wrong"
    return {"kind": kind, "wrong": [{"field": each.field, "message": each.message} for each in error.wrong]}


def _name(design: Design) -> str:
    return next((name for name, kind in DESIGNS.items() if kind is type(design)), "")


def _read(text: str) -> dict[str, Any]:
    try:
        message = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise Malformed("this is not JSON") from error
    if not isinstance(message, dict):
        raise Malformed("expected a JSON object")
    number = message.get("id")
    if isinstance(number, bool) or not isinstance(number, int) or not 0 <= number <= LONGEST_ID:
        raise Malformed("id: expected a whole number")
    return message

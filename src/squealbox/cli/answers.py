"""What a command answers: words for people, and with ``--json`` one object for scripts."""

import io
import json
import math
import sys
from collections.abc import Iterator, Sequence
from contextlib import redirect_stdout
from contextvars import ContextVar
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from squealbox.cli import UsageError
from squealbox.result import Result

MOST_NUMBERS = 1000  # of one array; a longer one is told by its shape, and is in the file that --out writes
FIGURES = ("png", "svg", "pdf")  # the kinds of file that --figures knows
UNSTABLE = 3  # the exit code of --exit-code where steady sliding is not stable


@dataclass(frozen=True)
class Manner:
    """How a command is to answer: the options for scripts, which every command takes."""

    as_json: bool = False
    quiet: bool = False
    by_code: bool = False
    force: bool = False
    stream: io.StringIO = field(default_factory=io.StringIO)
    results: list[Result] = field(default_factory=list)

    @classmethod
    def of(cls, words: list[str]) -> tuple["Manner", list[str]]:
        """The manner that the words ask for, and the words that are left for the command."""
        options = ("--json", "--quiet", "--exit-code", "--force")
        as_json, quiet, by_code, force = (option in words for option in options)
        found = cls(as_json, quiet, by_code, force)
        _NOW.set(found)
        return found, [word for word in words if word not in options]

    def listening(self) -> redirect_stdout[Any]:
        """What is printed goes to the reader, or is kept for the object, or is dropped."""
        return redirect_stdout(self.stream if self.as_json or self.quiet else sys.stdout)

    def end(self, name: str, code: int, error: str = "") -> int:
        """Print the object that was asked for; the exit code, which says "unstable" where that was asked for."""
        if self.by_code and code == 0 and any(map(_unstable, self.results)):
            code = UNSTABLE
        if self.as_json:
            about = {"command": name, "exit_code": code, "error": error or None}
            text = self.stream.getvalue().splitlines()
            json.dump({**about, "results": [plain(each) for each in self.results], "text": text}, sys.stdout)
            print()
        return code


_NOW: ContextVar[Manner] = ContextVar("manner")


def manner() -> Manner:
    """How the command that runs is to answer."""
    return _NOW.get(Manner())


def show(title: str, *results: Any) -> None:
    """Print results in words under a title, and keep them for scripts."""
    print("\n".join([*filter(None, [title]), *(each.summary() for each in results)]))
    keep(*results)


def keep(*results: Any) -> None:
    """Keep results for scripts that have been printed in other words."""
    manner().results.extend(each for each in results if isinstance(each, Result))


def written(*paths: Path) -> str:
    """A line that says which files there are now."""
    return f"written to {paths[0].parent}: {', '.join(path.name for path in paths)}"


def plain(result: Result) -> dict[str, Any]:
    """A result as numbers, words and lists: what a study would keep of it, with units and dimensions."""
    return {
        "kind": type(result).__name__,
        "outcome": str(result.outcome),
        "message": result.outcome.message,
        "caution": result.warning,
        "values": {
            name: {
                "value": _plain(column.values),
                "unit": "" if column.unit == "1" else column.unit,
                "dims": list(column.dims),
            }
            for name, column in result.columns().items()
        },
    }


def figures(words: Sequence[str]) -> Iterator[str]:
    """The words without ``--figures png,pdf``, which is done; an unknown kind of file is a `UsageError`."""
    rest = iter(words)
    for word in rest:
        option, equals, given = word.partition("=")
        if option != "--figures":
            yield word
            continue
        kinds = tuple((given if equals else next(rest, "")).split(","))
        if not set(kinds) <= set(FIGURES):
            raise UsageError(f"--figures {','.join(kinds)[:60]}: expected {', '.join(FIGURES)}, or several with commas")
        from squealbox.plots import FORMATS

        FORMATS.set(kinds)


def _unstable(result: Result) -> bool:
    from squealbox.stability import ComplexModes

    return isinstance(result, ComplexModes) and not np.all(result.stable)


def _plain(values: Any) -> Any:
    """Lists of numbers: nothing for what is not finite, [re, im] for what is complex."""
    array = np.asarray(values)
    if array.size > MOST_NUMBERS:
        return {"shape": list(array.shape)}
    if array.dtype.kind == "c":
        return _plain(np.stack([array.real, array.imag], axis=-1))
    if array.dtype.kind == "f":
        return _finite(array.tolist())
    return array.tolist() if array.dtype.kind in "biu" else array.astype(str).tolist()


def _finite(value: Any) -> Any:
    if isinstance(value, list):
        return [_finite(each) for each in value]
    return value if math.isfinite(value) else None

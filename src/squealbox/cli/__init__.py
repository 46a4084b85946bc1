"""The command line. Depends on: everything, each command only on what it needs.

A module with commands says in ``ABOUT = {"name": "a line about it"}`` what each of its functions does, with an
underscore behind a name that Python has already. The first page of help is made of these texts, and a module is
imported only when a command of it is called. Exit codes: 0 done, 1 the computation failed with a named outcome, 2 bad
input, 3 unstable where --exit-code asks for that, 130 stopped by the user.
"""

import difflib
import io
import os
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from squealbox.registers import assigned

DONE, FAILED, BAD_INPUT, STOPPED = 0, 1, 2, 130


class UsageError(ValueError):
    """An option or argument that does not make sense; the message is one sentence."""


@dataclass(frozen=True)
class Command:
    """A command: the module and function that do it, and one line about it."""

    module: str
    function: str
    about: str


_FIRST = """
init list modes matrices reduce onset map simulate ensemble scatter optimise silence absorber dither loop fit
events noise damping quality calibrate compare cycle report listen lab branch diagram run status show export
basin paper schema completion
"""  # in the order of the overview; a command in a further file of this folder stands behind them
_FOUND = {
    function.rstrip("_"): Command(module, function, about)
    for module, text in assigned(Path(__file__).parent, "ABOUT").items()
    for function, about in eval(text).items()
}
COMMANDS = {name: _FOUND[name] for name in dict.fromkeys((*_FIRST.split(), *_FOUND))}
OPTIONS = {
    "--force": "overwrite files that are there already",
    "--json": "one JSON object on standard output: exit code, results with units, and the text",
    "--quiet": "nothing on standard output",
    "--exit-code": "exit with 3 where steady sliding is unstable",
    "--figures": "kinds of file of figures, such as png,pdf; by default png,svg",
}
"""What every command takes beside its own options."""

EXAMPLES = """\
examples:
  squealbox init brake                       a folder with a first design file
  squealbox modes brake/brake.toml           is it stable?
  squealbox onset brake/brake.toml --parameter friction.static --range 0 1
  squealbox simulate brake/brake.toml --out run
  squealbox report brake/brake.toml          one page for a colleague
  squealbox paper drum-brake-2011 --out study"""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command; returns the exit code. Errors go to stderr, one sentence each, without a traceback."""
    words = list(sys.argv[1:] if arguments is None else arguments)
    if arguments is None and not sys.flags.utf8_mode and any("\udc80" <= c <= "\udcff" for each in words for c in each):
        # letters that the locale does not know, such as those of a folder under LC_ALL=C: read them as UTF-8
        os.execve(sys.executable, [sys.executable, *sys.orig_argv[1:]], {**os.environ, "PYTHONUTF8": "1"})
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")  # a terminal that knows no squared sign shows a question mark
    if not words or words[0] in ("--help", "-h", "help"):
        return _shown(overview())
    if words[0] in ("--version", "-V"):
        from squealbox import __version__

        return _shown(f"squealbox {__version__}")
    name = words[0]
    if name not in COMMANDS:
        print(f"squealbox: {_unknown(name)}", file=sys.stderr)
        return BAD_INPUT
    for library in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ.setdefault(library, "1")  # many small matrices: threads of the algebra stand in each other's way
    from squealbox.cli.running import run

    return run(name, COMMANDS[name], words[1:])


def _shown(text: str) -> int:
    try:
        print(text, flush=True)
    except BrokenPipeError:
        enough()
    return DONE


def enough() -> None:
    """The reader, such as `head`, has seen enough: what is left goes nowhere."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def overview() -> str:
    """The first page of help."""
    width = max(len(name) for name in COMMANDS)
    lines = [f"  {name.ljust(width)}  {command.about}" for name, command in COMMANDS.items()]
    return "\n".join([
        "squealbox: friction-induced vibration of brakes",
        "",
        "usage: squealbox COMMAND [OPTIONS]",
        "",
        "commands:",
        *lines,
        "",
        EXAMPLES,
        "",
        "with every command:",
        *(f"  {option.ljust(12)}  {about}" for option, about in OPTIONS.items()),
        "",
        "squealbox COMMAND --help tells more of one; squealbox --version",
    ])  # fmt: skip


def _unknown(name: str) -> str:
    known = ", ".join(COMMANDS)
    kind = "option" if name.startswith("-") else "command"
    near = difflib.get_close_matches(name[:40].lower(), COMMANDS, n=1)
    hint = f"did you mean '{near[0]}'?" if near else "squealbox --help lists them"
    return f"unknown {kind} {name[:40]!r}: {hint}; the commands are {known}"

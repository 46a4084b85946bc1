"""The command line. Depends on: everything, each command only on what it needs.

One table names the commands; it makes the first page of help without loading anything, and a command's module is
imported only when that command is called. Exit codes: 0 done, 1 the computation failed with a named outcome, 2 bad
input, 3 unstable where --exit-code asks for that, 130 stopped by the user.
"""

import difflib
import io
import os
import sys
from collections.abc import Sequence
from dataclasses import dataclass

DONE, FAILED, BAD_INPUT, STOPPED = 0, 1, 2, 130


class UsageError(ValueError):
    """An option or argument that does not make sense; the message is one sentence."""


@dataclass(frozen=True)
class Command:
    """A command: the module and function that do it, and one line about it."""

    module: str
    function: str
    about: str


COMMANDS = {
    "init": Command("starter", "init", "write a commented example file that runs"),
    "list": Command("catalogue", "list_", "designs with their parameters, friction laws, schedules, methods, papers"),
    "modes": Command("stability", "modes", "is steady sliding stable? complex eigenvalues of a design file"),
    "matrices": Command(
        "matrices", "matrices", "what files of Abaqus, Nastran, Ansys ... hold: matrices, labels, frequencies"
    ),
    "reduce": Command("reducing", "reduce_", "a small brake from a finite-element one, with its error, in a file"),
    "onset": Command("stability", "onset", "the value of a parameter at which squeal begins, and how"),
    "map": Command("maps", "map_", "stability over two parameters, with the boundary as curves"),
    "simulate": Command("transient", "simulate", "what happens in time: a transient with verdict, figures and data"),
    "ensemble": Command("ensembles", "ensemble", "transients over two parameters: amplitude and frequency of each"),
    "scatter": Command("uncertainty", "scatter", "parameters scatter: how probable is squeal, and which matters?"),
    "optimise": Command("optimising", "optimise", "the best design within bounds: before and after, or a Pareto front"),
    "silence": Command(
        "silence", "silence", "what would silence this brake: cures ranked, with dose, cost and cautions"
    ),
    "absorber": Command("absorber", "absorber", "the best tuned mass: frequency, damping, how narrow it is"),
    "dither": Command(
        "dither", "dither", "fast dither of the sliding: growth rate and friction left over its amplitude"
    ),
    "loop": Command("loop", "loop", "poles and margins of a brake with loops: gain, phase, delay, sampling"),
    "fit": Command("fitting", "fit", "measured friction coefficients (CSV) to a friction law, with confidence bands"),
    "events": Command(
        "recordings", "events", "squeal events in recordings: when, which frequency, how loud, how quick"
    ),
    "noise": Command("recordings", "noise", "a folder of stops: how often it squeals, at which speed and pressure"),
    "damping": Command("recordings", "damping", "damping of the modes before squeal, and the onset it points to"),
    "quality": Command("recordings", "quality", "loudness, sharpness and roughness of recordings"),
    "calibrate": Command("calibrating", "calibrate", "parameters fitted to what was measured, with what stays open"),
    "compare": Command(
        "calibrating", "compare_", "a design beside the squeal of a recording: frequency, growth, level"
    ),
    "cycle": Command("cycles", "cycle", "what the motion settles to: the limit cycle, its stability, figure and data"),
    "report": Command("reports", "report", "a design examined from every side, or any result, as one HTML page"),
    "listen": Command("listening", "listen", "the motion as sound at its true frequency (WAV), and how loud it may be"),
    "lab": Command("lab", "lab", "the workbench: a page in the browser where a brake is explored live"),
    "branch": Command("branches", "branch", "limit cycles over a range of a parameter: stable, unstable, folds, onset"),
    "diagram": Command("diagrams", "diagram", "what transients settle to over a parameter, with a Poincare section"),
    "run": Command("studies", "run", "a study: any analysis over a space of parameters; stopped or killed, it goes on"),
    "status": Command("studies", "status", "how far a study is, and what it said last"),
    "show": Command("studies", "show", "what a study has found, also while it runs: table and figure"),
    "export": Command("studies", "export", "what a study has found as CSV, NetCDF or MAT"),
    "basin": Command("basins", "basin_", "which starts lead to which motion: shares, a picture, the smallest push"),
    "paper": Command("papers", "paper", "reproduce a published study: figures, claims and one page"),
    "schema": Command("starter", "schema", "the JSON schema of a design file, for editors"),
    "completion": Command("starter", "completion", "a script that completes commands and options in bash, zsh or fish"),
}
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

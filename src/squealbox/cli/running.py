"""One command from its words to its exit code."""

import dataclasses
import importlib
import inspect
import os
import re
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from squealbox.cli import BAD_INPUT, DONE, FAILED, OPTIONS, STOPPED, Command, UsageError, enough
from squealbox.result import Outcome

QUANTITY = re.compile(r"-[.\d]+\D")  # "-90deg" is a value, which would be taken for an option
SIGN = "\N{MINUS SIGN}"  # stands for its hyphen while the words are told apart
TRACEBACK = "SQUEALBOX_TRACEBACK"  # set in the environment, an error inside the program shows where it arose


class ComputationFailed(Exception):
    """A computation that ended with a named outcome other than "completed"."""

    def __init__(self, outcome: Outcome) -> None:
        self.outcome = outcome
        super().__init__(outcome.told)


def run(name: str, command: Command, words: Sequence[str]) -> int:
    """Read the words of a command, do it, and turn what may go wrong into a sentence and an exit code."""
    from squealbox.cli.answers import Manner

    manner, left = Manner.of(list(words))
    try:
        with manner.listening():
            code, error = _done(name, command, left)
        code = manner.end(name, code, error)
        sys.stdout.flush()
        return code
    except BrokenPipeError:
        enough()
        return DONE


def _done(name: str, command: Command, words: Sequence[str]) -> tuple[int, str]:
    """The exit code of a command, and what went wrong in a sentence, which has then been said."""
    try:
        return _call(name, command, words), ""
    except KeyboardInterrupt:
        return _say(name, "stopped", STOPPED)
    except BrokenPipeError:
        raise
    except ComputationFailed as error:
        return _say(name, str(error), STOPPED if error.outcome == "interrupted" else FAILED)
    except Exception as error:
        if os.environ.get(TRACEBACK):
            raise
        return _explain(name, error)


def _call(name: str, command: Command, words: Sequence[str]) -> int:
    import cyclopts

    from squealbox.cli.answers import figures

    function = getattr(importlib.import_module(f"squealbox.cli.{command.module}"), command.function)
    app = cyclopts.App(
        name=f"squealbox {name}",
        help_format="plaintext",
        help_epilogue="With every command: " + "; ".join(f"{option}: {about}" for option, about in OPTIONS.items()),
        version_flags=(),
        result_action="return_value",
        suppress_keyboard_interrupt=False,
    )
    app.default(function)
    app["--help"].group = "Parameters"
    try:
        told = [SIGN + word[1:] if QUANTITY.match(word) else word for word in ordered([*figures(words)])]
        call, given, _ = app.parse_args(told, exit_on_error=False, print_error=False)
    except cyclopts.UnusedCliTokensError as error:
        raise UsageError(f"unexpected words: {' '.join(error.unused_tokens or ())[:60]}") from error
    except cyclopts.MissingArgumentError as error:
        raise UsageError(_missing(name, str(error), function)) from error
    except cyclopts.CycloptsError as error:
        raise UsageError(_one_sentence(str(error).replace(SIGN, "-"))) from error
    code = call(*map(_as_typed, given.args), **{name: _as_typed(value) for name, value in given.kwargs.items()})
    return code if isinstance(code, int) else DONE


def _as_typed(value: Any) -> Any:
    """What an option was given, with the sign of negative quantities as it was typed."""
    if isinstance(value, tuple):
        return tuple(_as_typed(each) for each in value)
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        return dataclasses.replace(value, **{name: _as_typed(each) for name, each in vars(value).items()})
    return type(value)(str(value).replace(SIGN, "-")) if isinstance(value, (str, Path)) else value


def _missing(name: str, text: str, function: Callable[..., object]) -> str:
    """What is missing, called as the usage line calls it: a word that was to come first is no option."""
    found = re.search(r"--([a-z-]+)", text)
    asked = inspect.signature(function).parameters.get(found[1].replace("-", "_")) if found else None
    if found and asked is not None and asked.kind is not inspect.Parameter.KEYWORD_ONLY:
        return f"{found[1].upper()} is missing: squealbox {name} {found[1].upper()}; --help tells more"
    if found and "requires an argument" in text:  # an option that was not given, or given without its value
        return f"--{found[1]} is missing, or what belongs behind it; --help tells more"
    return _one_sentence(text)


def ordered(words: Sequence[str]) -> list[str]:
    """The words of a command with the changes behind ``--set`` each tied to it, so that a file may follow them.

    >>> ordered(["--set", "load=2 kN", "theta1=-20 deg", "brake.toml"])
    ['--set=load=2 kN', '--set=theta1=-20 deg', 'brake.toml']
    """
    found: list[str] = []
    setting = False
    for word in words:
        if setting and "=" in word and not word.startswith("--"):
            found[-1:] = [f"--set={word}", "--set"]
            continue
        if setting and len(found) > 1 and found[-2].startswith("--set="):
            found.pop()
        setting = word == "--set"
        found.append(word)
    if setting and len(found) > 1 and found[-2].startswith("--set="):
        found.pop()
    return found


def _explain(name: str, error: Exception) -> tuple[int, str]:
    """Say what was wrong; only errors of kinds that are about the input are put down to the user."""
    from squealbox.extras import MissingExtra
    from squealbox.files import DesignFileError, NotWritable
    from squealbox.parameters import ParameterError
    from squealbox.result import ResultFileError
    from squealbox.signals import SignalError
    from squealbox.studies import StoreDamaged, StoreError, StoreFull, StudyError
    from squealbox.system import InvalidSystem

    if isinstance(error, DesignFileError):
        text = "\n".join(str(problem) for problem in error.problems)
        print(text, file=sys.stderr)
        return BAD_INPUT, text
    if isinstance(error, (StoreDamaged, StoreFull)):
        return _say(name, str(error), FAILED)
    asked = (
        UsageError,
        MissingExtra,
        ParameterError,
        InvalidSystem,
        NotWritable,
        StoreError,
        StudyError,
        ResultFileError,
        SignalError,
    )
    if isinstance(error, asked):
        return _say(name, str(error), BAD_INPUT)
    if isinstance(error, OSError) and error.filename is not None:
        return _say(name, f"{error.filename}: {error.strerror}", BAD_INPUT)
    why = f"an error inside the program, {type(error).__name__}: {_one_sentence(str(error))}"
    return _say(name, f"{why}; {TRACEBACK}=1 tells where", FAILED)


def _one_sentence(text: str) -> str:
    return " ".join(text.split())


def _say(name: str, text: str, code: int) -> tuple[int, str]:
    print(f"squealbox {name}: {text}", file=sys.stderr)
    return code, text

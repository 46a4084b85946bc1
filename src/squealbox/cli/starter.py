"""`squealbox init` and `squealbox schema`: a first file, and help for the editor that changes it."""

import functools
import importlib
import inspect
import json
from collections.abc import Callable
from pathlib import Path
from typing import Literal

from squealbox.cli import COMMANDS, OPTIONS, UsageError
from squealbox.cli.answers import manner
from squealbox.parameters import known_names

ABOUT = {
    "init": "write a commented example file that runs",
    "schema": "the JSON schema of a design file, for editors",
    "completion": "a script that completes commands and options in bash, zsh or fish",
}

FILE = "brake.toml"


def init(directory: Path, *, brake: str = "drum_brake") -> None:
    """Write a commented example file that runs.

    Parameters
    ----------
    directory
        folder to put brake.toml into; made when it is not there; or the file itself, such as pad.toml
    brake
        which design to begin with, "own" for matrices of your own; squealbox list names them
    """
    from squealbox.files import asked_of, first_design, write_design

    _check(brake)
    design = first_design(brake)
    path = directory if directory.suffix == ".toml" else directory / FILE
    if path.exists() and not manner().force:
        raise UsageError(f"{path} is there already: --force overwrites it")
    path.parent.mkdir(parents=True, exist_ok=True)
    write_design(design, path, sections=asked_of(design, str(path)))
    print(f"{path} describes a brake. Next:\n  squealbox modes {path}\n  squealbox simulate {path} --out run\n"
          f"  squealbox run {path} --out study")  # fmt: skip


def schema() -> None:
    """Print the JSON schema of a design file.

    Save it and point your editor to it: keys are then completed and mistakes marked while you type.
    """
    from squealbox.files import json_schema

    print(json.dumps(json_schema(), indent=1))


def completion(shell: Literal["bash", "zsh", "fish"]) -> None:
    """Print what completes commands, options and their words in a shell.

    Put ``eval "$(squealbox completion bash)"`` into ~/.bashrc; zsh and fish want it in a file where they look for such.

    Parameters
    ----------
    shell
        bash, zsh or fish
    """
    import cyclopts

    app = cyclopts.App(name="squealbox")
    for name, command in COMMANDS.items():
        function = getattr(importlib.import_module(f"squealbox.cli.{command.module}"), command.function)
        app.command(_with_options_of_all(function), name=name)
    print(app.generate_completion(shell=shell))


def _with_options_of_all(function: Callable[..., object]) -> Callable[..., object]:
    """The function as the completion sees it: with the options that every command takes beside its own."""
    own = inspect.signature(function)
    more = [inspect.Parameter(option.removeprefix("--").replace("-", "_"), inspect.Parameter.KEYWORD_ONLY,
                              default=False, annotation=bool) for option in OPTIONS]  # fmt: skip

    @functools.wraps(function)
    def seen(*_: object) -> None: ...

    seen.__signature__ = own.replace(parameters=[*own.parameters.values(), *more])  # type: ignore[attr-defined]
    seen.__annotations__ = {**function.__annotations__, **{each.name: bool for each in more}}
    return seen


def _check(brake: str) -> None:
    from squealbox.files import BRAKES, MESHED, READERS

    if brake in MESHED:
        raise UsageError(
            f'--brake {brake}: a file of one line, brake = "{brake}", beside a section [modes] with its band; '
            "examples/caliper begins from exported matrices"
        )
    if brake in READERS:
        raise UsageError(
            f"--brake {brake}: its file names files of your own, docs/finite_elements.md shows one; examples/caliper "
            "begins from exported matrices, squealbox reduce writes a reduced brake"
        )
    if brake not in BRAKES:
        raise UsageError(f"--brake {brake[:40]}: {known_names(brake[:40], list(BRAKES))}")

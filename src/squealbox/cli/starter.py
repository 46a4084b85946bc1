"""`squealbox init` and `squealbox schema`: a first file, and help for the editor that changes it."""

import functools
import importlib
import inspect
import json
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np

from squealbox.cli import COMMANDS, OPTIONS, UsageError
from squealbox.cli.answers import manner
from squealbox.parameters import known_names

if TYPE_CHECKING:
    from squealbox.designs import Design

FILE = "brake.toml"
STUDIES = """
# What is asked of this brake. Each section has a command of its own and may be left out; so may every key with a
# default. A number without a unit is in SI.

[modes]                         # squealbox modes {file}
time = "0 s"                    # instant at which schedules are taken

[onset]                         # squealbox onset {file}
parameter = "friction.static"   # any parameter above by its dotted name
range = [0, 1]

[map]                           # squealbox map {file}
x = {{ parameter = "friction.static", range = [0, 1], points = 101 }}
y = {{ {second_inline}, points = 101 }}

[simulate]                      # squealbox simulate {file} --out run
duration = "{duration}"
start = "rest"                  # rest (loads applied suddenly) or sliding
points = 5001                   # number of instants kept

[study]                         # squealbox run {file} --out study: an analysis at every point of a grid
analysis = "modes"              # modes, onset, simulate, ensemble or cycle

[[study.axis]]
parameter = "friction.static"
range = [0, 1]
points = 41

[[study.axis]]
{second}
points = 31
"""


def init(directory: Path, *, brake: str = "drum_brake") -> None:
    """Write a commented example file that runs.

    Parameters
    ----------
    directory
        folder to put brake.toml into; made when it is not there; or the file itself, such as pad.toml
    brake
        which design to begin with, "own" for matrices of your own; squealbox list names them
    """
    from squealbox.files import write_design

    design = _example(brake)
    path = directory if directory.suffix == ".toml" else directory / FILE
    if path.exists() and not manner().force:
        raise UsageError(f"{path} is there already: --force overwrites it")
    path.parent.mkdir(parents=True, exist_ok=True)
    second = _second_axis(design)
    axes = {"second": "\n".join(second), "second_inline": ", ".join(second)}
    write_design(design, path, sections=STUDIES.format(file=path, duration=_duration(design), **axes))
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


def _second_axis(design: "Design") -> tuple[str, str]:
    """What a first map varies beside friction: the speed, by the name the design has for it."""
    if "sliding_speed" in design.field_names():
        return 'parameter = "sliding_speed"', 'range = ["0.1 m/s", "2 m/s"]'
    return 'parameter = "spin"', 'range = ["1 rad/s", "50 rad/s"]'


def _duration(design: "Design") -> str:
    """The usual one, in round numbers."""
    from squealbox.files.runs import usual_duration

    return f"{float(f'{1e3 * usual_duration(design):.1g}'):g} ms"


def _example(brake: str) -> "Design":
    from squealbox.designs import DrumBrake
    from squealbox.files import BRAKES, OwnBrake, OwnContact, OwnMechanism
    from squealbox.files.reading import MESHED, READERS
    from squealbox.friction import Coulomb, LinearSlope

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
    if BRAKES[brake] is DrumBrake:
        theta1, theta2 = (float(np.deg2rad(angle)) for angle in (110.0, 10.0))
        brake_of_2011 = DrumBrake(friction=LinearSlope(0.45, -0.01), theta1=theta1, theta2=theta2)
        return brake_of_2011.replace(load=4000.0)  # no shoe is pulled, in sliding or squealing, as in 2011 one is
    if BRAKES[brake] is OwnBrake:
        contact = OwnContact(n=[0.0, 3e6, 0.0], d=[1.0, 0.0, 0.0], name="pad", unilateral=True, normal=[0.0, 1.0, 0.0])
        return OwnBrake(
            M=[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 2.0]],
            K=[[3.8e6, 1e6, 0.0], [1e6, 4e6, -0.5e6], [0.0, -0.5e6, 2e6]],
            C=[[10.0, 0.0, 0.0], [0.0, 10.0, 0.0], [0.0, 0.0, 10.0]],
            friction=Coulomb(0.3),
            normal_force=500.0,
            contacts=(contact,),
            names=("pad_x", "pad_y", "disc_y"),
        )
    return mechanism_example() if BRAKES[brake] is OwnMechanism else BRAKES[brake]()


def mechanism_example() -> "Design":
    """A pad that can turn, on an inclined and two straight springs, pressed on a disc that moves across."""
    from squealbox.files import Body, OwnMechanism, Spring, Touch

    springs = (
        Spring("pad", angle=np.deg2rad(30.0), stiffness=2e6, damping=5.0),
        Spring("pad", angle=np.deg2rad(120.0), stiffness=1e6, damping=5.0),
        Spring("pad", angle=np.deg2rad(90.0), stiffness=1e6, x=0.03),
        Spring("disc", angle=np.deg2rad(90.0), stiffness=4e6, damping=10.0),
    )
    return OwnMechanism(
        bodies=(Body("pad", 0.5, 2e-4), Body("disc", 2.0, moves="y")),
        springs=springs,
        contacts=(Touch("pad", "disc", stiffness=3e6, y=0.01),),
        normal_force=500.0,
    )

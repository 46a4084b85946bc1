"""The first file of a brake: what `squealbox init` writes and the workbench offers to begin with."""

import numpy as np

from squealbox.design import Design
from squealbox.designs import Body, DrumBrake, OwnBrake, OwnContact, OwnMechanism, Spring, Touch
from squealbox.files.reading import BRAKES, MESHED
from squealbox.friction import Coulomb, LinearSlope
from squealbox.transient import usual_duration

BEGINNINGS = tuple(name for name in BRAKES if name not in MESHED)  # brakes whose file can be written at once
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
times = 5001                    # number of instants kept

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


def asked_of(design: Design, path: str) -> str:
    """The sections of a first file: one for each command, that asks something of the design."""
    second = _second_axis(design)
    axes = {"second": "\n".join(second), "second_inline": ", ".join(second)}
    return STUDIES.format(file=path, duration=_duration(design), **axes)


def first_design(brake: str) -> Design:
    """The design of a first file; `brake` is one of `BEGINNINGS`."""
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


def mechanism_example() -> Design:
    """A pad that can turn, on an inclined and two straight springs, pressed on a disc that moves across."""
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


def _second_axis(design: Design) -> tuple[str, str]:
    """What a first map varies beside friction: the speed, by the name the design has for it."""
    if "sliding_speed" in design.field_names():
        return 'parameter = "sliding_speed"', 'range = ["0.1 m/s", "2 m/s"]'
    return 'parameter = "spin"', 'range = ["1 rad/s", "50 rad/s"]'


def _duration(design: Design) -> str:
    """The usual one, in round numbers."""
    return f"{float(f'{1e3 * usual_duration(design):.1g}'):g} ms"

"""Blocks on a moving belt: one block, and a chain of n.

One block of mass m, held by a spring k and a dashpot c, is pressed with N on a belt of speed V:

    m x'' + c x' + k x = mu(|v|) sgn(v) N,    v = V - x'

Steady sliding is x0 = mu(V) N/k. Linearised, the damping is c + N mu'(V), so it loses stability (a Hopf bifurcation)
where N mu'(V) = -c. For the cubic law that is V = v_m sqrt(1 - 2 c v_m/(3 N (mu_s - mu_m))), and for Coulomb friction
with mu_s > mu_k stick-slip lives beside the stable steady state, with a period in closed form.

In the chain every block has its spring k to the frame, and springs k_c join neighbours; its frequencies are
omega_j^2 = (k + 4 k_c sin^2(pi j/(2 n)))/m, j = 0 .. n - 1.
"""

from typing import Any, ClassVar

import numpy as np

from squealbox.design import Design
from squealbox.designs.rows import block
from squealbox.friction import Hyperbolic
from squealbox.law import FrictionLaw
from squealbox.parameters import ParameterError, parameter
from squealbox.shapes import DOWN, RIGHT, STILL, Moves, Shapes
from squealbox.system import Contact, System

LEINE = "Leine et al. 1998, section 4"
OWN = "chosen here"
MOST_BLOCKS = 64


class MassOnBelt(Design):
    """A block on a moving belt, with any friction law. The defaults are the stick-slip example of Leine et al.

    >>> MassOnBelt().system().size
    1
    """

    title: ClassVar[str] = "Block on a moving belt"
    source: ClassVar[str] = (
        "Leine, van Campen, de Kraker and van den Steen 1998, Nonlinear Dynamics 16, 41-54; "
        "with the cubic law Thomsen and Fidlin 2003, Int. J. Non-Linear Mechanics 38, 389-403"
    )

    m: float = parameter("kg", 0.0, low_open=True, default=1.0, meaning="mass of the block", source=LEINE)
    c: float = parameter("N s/m", 0.0, default=0.0, meaning="damping to the frame", source=LEINE)
    k: float = parameter("N/m", 0.0, low_open=True, default=1.0, meaning="stiffness to the frame", source=LEINE)
    load: Any = parameter("N", 0.0, default=1.0, schedule=True, meaning="normal force on the belt", source=LEINE)
    sliding_speed: Any = parameter("m/s", default=0.2, schedule=True, meaning="speed of the belt", source=LEINE)
    friction: FrictionLaw = Hyperbolic(1.0, 3.0)

    def system(self) -> System:
        """The equation of motion; leading axes of the parameters are kept."""
        unit = np.eye(1)
        along = np.ones(1)
        contact = Contact(0.0 * along, along, along, self.load, self.sliding_speed, self.friction, name="belt")
        return System(block(self.m) * unit, block(self.c) * unit, block(self.k) * unit, [0.0], (contact,), names=("x",))

    def draw(self, shapes: Shapes) -> None:
        """A block on a belt, spring and dashpot to a wall."""
        block: Moves = {0: RIGHT}
        shapes.belt(-1.6, 1.6)
        shapes.box((-0.4, 0.03), 0.8, 0.6, "m", "m", block)
        shapes.spring((-1.8, 0.45), (-0.4, 0.45), "k", "k", moves=(STILL, block))
        shapes.dashpot((-1.8, 0.17), (-0.4, 0.17), moves=(STILL, block))
        shapes.text((-0.85, 0.27), "c", "c", size=7.0)
        shapes.wall((-1.8, 0.33), 0.0, 0.8)
        shapes.load((0.0, 1.2), (0.0, 0.65), "N", "load", (0.15, 1.1), block)
        shapes.axis((0.5, 0.75), (0.95, 0.75), "x", (1.05, 0.75))
        shapes.contact((0.0, 0.03), DOWN, block)


class BlockChain(Design):
    """A chain of equal blocks on a moving belt, joined to each other and to the frame by springs.

    With few blocks it is a model of stick-slip with many bodies, with many blocks a string or beam on a belt.

    >>> BlockChain(blocks=5).system().size
    5
    """

    title: ClassVar[str] = "Chain of blocks on a moving belt"
    source: ClassVar[str] = (
        "kind of model of Popp and Stelter 1990, Phil. Trans. R. Soc. London A 332, 89-105; numbers chosen here"
    )

    m: float = parameter("kg", 0.0, low_open=True, default=1.0, meaning="mass of each block", source=OWN)
    c: float = parameter("N s/m", 0.0, default=0.02, meaning="damping of each block to the frame", source=OWN)
    k: float = parameter("N/m", 0.0, low_open=True, default=1.0, meaning="stiffness of each to the frame", source=OWN)
    kc: float = parameter("N/m", 0.0, default=1.2, meaning="stiffness between neighbours", source=OWN)
    load: Any = parameter("N", 0.0, default=1.0, schedule=True, meaning="normal force of each block", source=OWN)
    sliding_speed: Any = parameter("m/s", default=0.2, schedule=True, meaning="speed of the belt", source=OWN)
    blocks: int = parameter("-", 1.0, MOST_BLOCKS, default=2, meaning="number of blocks", source=OWN)
    friction: FrictionLaw = Hyperbolic(1.0, 3.0)

    def __post_init__(self) -> None:
        super().__post_init__()
        if np.ndim(self.blocks) or self.blocks != int(self.blocks):
            raise ParameterError("BlockChain", "blocks", self.blocks, f"a whole number in [1, {MOST_BLOCKS}]")
        object.__setattr__(self, "blocks", int(self.blocks))

    def system(self) -> System:
        """The equation of motion; leading axes of the parameters are kept."""
        n = self.blocks
        unit, neighbours = np.eye(n), np.zeros((n, n))
        for i in range(n - 1):
            neighbours[i : i + 2, i : i + 2] += [[1.0, -1.0], [-1.0, 1.0]]
        stiffness = block(self.k) * unit + block(self.kc) * neighbours
        contacts = tuple(
            Contact(0.0 * e, e, e, self.load, self.sliding_speed, self.friction, name=f"block {i + 1}")
            for i, e in enumerate(unit)
        )
        names = tuple(f"x{i + 1}" for i in range(n))
        return System(block(self.m) * unit, block(self.c) * unit, stiffness, np.zeros(n), contacts, names)

    def draw(self, shapes: Shapes) -> None:
        """The first five blocks on their belt."""
        shown, pitch = min(self.blocks, 5), 1.5
        shapes.belt(-1.1, pitch * (shown - 1) + 1.1)
        for i in range(shown):
            x, block = pitch * i, {i: RIGHT}
            shapes.box((x - 0.35, 0.03), 0.7, 0.5, "m", "m", block)
            shapes.spring((x - 0.15, 0.53), (x - 0.55, 1.4), "k", "k", moves=(block, STILL))
            shapes.load((x + 0.12, 1.1), (x + 0.12, 0.56), "N", "load", (x + 0.28, 1.0), block)
            if i:
                between = ((x - pitch + 0.35, 0.28), (x - 0.35, 0.28))
                shapes.spring(*between, "$k_c$", "kc", moves=({i - 1: RIGHT}, block))
            shapes.contact((x, 0.03), DOWN, block)
        shapes.wall((0.5 * pitch * (shown - 1) - 0.55, 1.4), -np.pi / 2, pitch * (shown - 1) + 0.7)
        if shown < self.blocks:
            shapes.text((pitch * (shown - 1) + 0.8, 0.28), f"... {self.blocks} blocks", "blocks", anchor="left")

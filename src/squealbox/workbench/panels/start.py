"""How a motion begins and which degree of freedom is looked at: what motion and sound are both asked."""

from typing import Any

import numpy as np

from squealbox.designs import Design
from squealbox.stability import complex_modes
from squealbox.system import equilibrium
from squealbox.workbench.panels.panel import Options

STARTS = ("push", "rest", "sliding")
PUSH = 0.05  # of the static deflection
LARGEST_PUSH = 10.0


def start_and_dof(design: Design, options: Options) -> tuple[Any, int]:
    """The start as `simulate` takes it, and the degree of freedom."""
    start, dof = options.word("start", STARTS), options.dof(design)
    push = options.number("push", PUSH, 0.0, LARGEST_PUSH)
    return pushed(design, push) if start == "push" else start, dof


def pushed(design: Design, push: float) -> Any:
    """Steady sliding with a push along the mode that grows first; "rest" where there is no steady sliding.

    The push is a share of the static deflection, so that it is large for no brake and small for none.
    """
    modes = complex_modes(design)
    if not bool(modes.exists):
        return "rest"
    size = float(np.max(np.abs(equilibrium(design.system()).q))) or 1e-6
    return modes.most_unstable.start(push * size)

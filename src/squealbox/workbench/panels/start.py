"""How a motion begins and which degree of freedom is looked at: what motion and sound are both asked."""

from typing import Any

import numpy as np

from squealbox.design import Design
from squealbox.stability import complex_modes
from squealbox.system import equilibrium
from squealbox.workbench.panels.declared import START
from squealbox.workbench.panels.panel import Options


def start_and_dof(design: Design, options: Options) -> tuple[Any, int]:
    """The start as `simulate` takes it, and the degree of freedom."""
    how, dof = options.chosen(*START), options.dof(design)
    return pushed(design, how["push"]) if how["start"] == "push" else how["start"], dof


def pushed(design: Design, push: float) -> Any:
    """Steady sliding with a push along the mode that grows first; "rest" where there is no steady sliding.

    The push is a share of the static deflection, so that it is large for no brake and small for none.
    """
    modes = complex_modes(design)
    if not bool(modes.exists):
        return "rest"
    size = float(np.max(np.abs(equilibrium(design.system()).q))) or 1e-6
    return modes.most_unstable.start(push * size)

"""The brake that moves: its drawing with what each degree of freedom does to it, and the mode that grows first."""

from typing import Any

import numpy as np

from squealbox.designs import Design
from squealbox.plots.moving import moving_strokes
from squealbox.system import equilibrium
from squealbox.workbench.panels.modes import modes_of
from squealbox.workbench.panels.panel import Answer, Options, Work

MOST_MODES = 12


def answer(design: Design, options: Options, work: Work) -> Answer:
    """Strokes, their motion for each freedom, forces of steady sliding, and a mode as real and imaginary part."""
    system, drawn = design.system(), moving_strokes(design)
    data: dict[str, Any] = {name: drawn[name] for name in ("strokes", "box", "contacts")}
    data |= {"names": list(system.names), "units": list(system.units), "contactNames": list(system.contact_names)}
    arrays: dict[str, Any] = {name: drawn[name] for name in ("points", "moves", "contactMoves")}
    modes, state = modes_of(design), equilibrium(system)
    data |= {"normal": np.nan_to_num(state.normal_force).tolist()}
    if not bool(modes.exists):
        return Answer({**data, "modes": [], "message": modes.outcome.message}, arrays)
    half = modes.eigenvalues.shape[-1] // 2
    growth = np.nan_to_num(modes.growth_rate[:half], nan=-np.inf)
    first = modes.most_unstable.index
    order = [first, *(int(i) for i in np.argsort(-growth, kind="stable") if i != first)][:MOST_MODES]
    chosen = min(int(options.number("mode", 0, 0, 1e6)), len(order) - 1)
    mode = modes.mode(order[chosen])
    shape = mode.shape[: system.size]
    press = [contact.n @ shape for contact in system.contacts]
    arrays |= {"re": shape.real, "im": shape.imag, "pressRe": np.real(press), "pressIm": np.imag(press)}
    told = [(float(modes.frequency[i]), float(modes.growth_rate[i]), float(modes.damping_ratio[i])) for i in order]
    return Answer({**data, "modes": told, "mode": chosen}, arrays)

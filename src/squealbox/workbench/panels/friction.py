"""The friction curve of each law, the speeds at which the contacts slide, and the range a squealing motion passes."""

from typing import Any

import numpy as np

from squealbox.design import Design
from squealbox.figure_data import FigureAxis, FigureData, line, points, span, upright
from squealbox.system import linearise
from squealbox.words import number, quantity
from squealbox.workbench.panels.declared import Panel, Place
from squealbox.workbench.panels.panel import Answer, Options, Work, table

PANEL = Panel(
    "Friction curve", questions=("why",), figures=(Place("friction", "", 300),), table="Contacts in steady sliding",
)  # fmt: skip

POINTS = 241


def answer(design: Design, options: Options, work: Work) -> Answer:
    """mu(|v|) of each law with its static limit, and where on it each contact slides, with the slope there."""
    system = design.system()
    steady = linearise(system)
    state = steady.equilibrium
    speeds = np.abs(state.sliding_speed)
    top = 2.5 * float(np.max(speeds, initial=0.0)) or 1.0
    v = np.linspace(0.0, top, POINTS)
    laws: list[Any] = []
    for contact in system.contacts:
        if contact.law not in laws:
            laws.append(contact.law)
    mu = [np.broadcast_to(law.mu(v), v.shape) for law in laws]
    at = zip(system.contacts, state.sliding_speed, state.friction, strict=True)
    sliding = [(abs(float(speed)), float(m), float(each.law.slope_at(speed))) for each, speed, m in at
               if np.isfinite(speed)]  # fmt: skip
    static = [float(law.static_limit) for law in laws]
    upward = FigureAxis("friction coefficient", "-", span(*mu, static, zero=True))
    names = [type(law).__name__ for law in laws]
    kind = "name" if len(names) > 1 else "column"
    layers = [
        *(line(v, curve, f"s{i % 7}", **{kind: names[i]}) for i, curve in enumerate(mu)),
        *(upright(speed) for speed in dict.fromkeys(speed for speed, *_ in sliding)),
        points(np.zeros(len(static)), static, "begin", 4.0, column="static limit"),
        points([each[0] for each in sliding], [each[1] for each in sliding], column="contacts at steady sliding"),
        *(_tangent(each, 0.07 * top) for each in sliding),
    ]
    falling = [slope for *_, slope in sliding if slope < 0.0]
    words = "Friction does not fall with speed here."
    if not steady.equilibrium.outcome.ok:
        words = f"{steady.equilibrium.outcome.message}."
    elif falling:
        words = (f"Friction falls with speed at {len(falling)} of {len(sliding)} contacts, slope {number(falling[0])} "
                 "s/m: it takes damping away.")  # fmt: skip
    told = zip(system.contact_names, state.normal_force, state.sliding_speed, state.friction, strict=True)
    rows = [(name, quantity(force, "N"), quantity(speed, "m/s"), number(m)) for name, force, speed, m in told]
    contacts = table(("contact", "N", "slides at", "mu"), rows)
    figure = FigureData("friction", FigureAxis("sliding speed |v|", "m/s", (0.0, top)), upward, layers)
    return Answer({"outcome": str(steady.equilibrium.outcome), "words": words, "table": contacts}, figures=[figure])


def _tangent(at: tuple[float, float, float], half: float) -> Any:
    """A short tangent where a contact slides: the slope that takes damping away."""
    speed, mu, slope = at
    ends = [speed - half, speed + half], [mu - slope * half, mu + slope * half]
    return line(*ends, "tangent", column="tangent")

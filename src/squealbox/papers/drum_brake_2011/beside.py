"""What stands beside the readings: drawings, the search's short form, the solver of 2011; as jobs, so as plain data."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from squealbox.papers.drum_brake_2011 import drawings, family_search, solver_2011, theorem_figures
from squealbox.papers.drum_brake_2011.cases import DEFAULT_READING, RECONSTRUCTED, Case
from squealbox.papers.drum_brake_2011.reading import save


@dataclass(frozen=True)
class Extras:
    """What the page shows beside the readings.

    `short` is the search's short form, `signs` and `by_chance` what stiffness alone decides, `whole` the whole search
    where it was made; `decays`, `added` and `onsets` are of the solver of 2011, the decays without their curves.
    """

    short: family_search.Searched
    signs: list[int]
    by_chance: float
    decays: list[solver_2011.Decay]
    added: dict[float, list[tuple[float, float]]]
    onsets: dict[str, tuple[float, float]]
    whole: Any = None


def drawings_of(figures: Path) -> list[str]:
    """Draw the model, the friction law and the theorems; the names of the figures."""
    case = Case(DEFAULT_READING)
    drawn = {"fig1": lambda: drawings.model(case), "fig2": lambda: drawings.friction(case), **theorem_figures.ALL}
    for name, draw in drawn.items():
        save(draw(), figures / name)
    return list(drawn)


def family() -> dict[str, Any]:
    """The search through the family in its short form, and the signs that stiffness alone leaves."""
    found = family_search.short()
    signs, by_chance = family_search.stiffness_only()
    plain = {"chance": found.chance, "sets": found.sets, "family": found.family, "chance_family": found.chance_family}
    return {"short": {**plain, "counts": found.counts.tolist()}, "signs": signs, "by_chance": by_chance}


def solver(figures: Path) -> dict[str, Any]:
    """The solver of 2011 on the reconstruction: its decays, drawn, and its onsets."""
    case = Case(RECONSTRUCTED)
    decays = solver_2011.decays(case)
    save(theorem_figures.solver(decays), figures / "solver")
    names = ("setting", "steps", "early", "late")
    plain = [{name: getattr(each, name) for name in names} for each in decays]
    added = list(solver_2011.added(case).items())  # as pairs: keys of JSON are no numbers
    return {"decays": plain, "added": added, "onsets": solver_2011.onsets(case)}


def extras(told: dict[str, Any], whole: Any = None) -> Extras:
    """The answers of these jobs, and the whole search where it was made, for the page."""
    family, solver = told["family"], told["solver"]
    short = {**family["short"], "counts": np.array(family["short"]["counts"]), "best": np.empty((0, 6))}
    return Extras(
        short=family_search.Searched(**short),
        signs=family["signs"],
        by_chance=family["by_chance"],
        decays=[solver_2011.Decay(**each, t=np.empty(0), x=np.empty(0)) for each in solver["decays"]],
        added={alpha: [(lower, upper) for lower, upper in rates] for alpha, rates in solver["added"]},
        onsets={name: (load, mu) for name, (load, mu) in solver["onsets"].items()},
        whole=whole,
    )

"""`squealbox paper`: reproduce a published study."""

import importlib
from dataclasses import dataclass
from pathlib import Path

from squealbox.cli.running import UsageError
from squealbox.parameters import known_names
from squealbox.waiting import Progress

ABOUT = {"paper": "reproduce a published study: figures, claims and one page"}


@dataclass(frozen=True)
class Paper:
    """A study that can be reproduced: the module that does it, and what it is about."""

    module: str
    title: str


PAPERS = {
    "drum-brake-2011": Paper(
        "squealbox.papers.drum_brake_2011",
        "Drum brake squeal, Journal of Vibroengineering 13(2), paper 632, June 2011",
    ),
}


def paper(name: str, *, out: Path | None = None, fine: bool = False, search: bool = False) -> None:
    """Reproduce a published study: every figure, and each claim beside what this program computes.

    Parameters
    ----------
    name
        which paper; squealbox list names them
    out
        folder for the figures, claims.json, claims.md and one HTML page; the paper's name when left out
    fine
        maps by transients at 561 x 561 points in the place of 141 x 141, and more of them, and every figure as SVG
        too; takes some minutes more
    search
        go through the whole family of equations for what was run in 2011, and not only its short form; takes some
        minutes, and goes on where it was stopped when run again with the same folder
    """
    if name not in PAPERS:
        raise UsageError(f"{name[:40]!r} is no paper this program knows: {known_names(name[:40], list(PAPERS))}")
    folder = Path(name) if out is None else out
    folder.mkdir(parents=True, exist_ok=True)
    with Progress(f"reproducing {name}") as progress:
        page = importlib.import_module(PAPERS[name].module).reproduce(
            folder, progress=progress, fine=fine, search=search
        )
    print(f"The page is at {page}")

"""The search through the family: how many of the eight claims about eigenvalues its members meet, and by what chance.

A sweep over the signs in front and of the belts; each of its 256 points stands for all loads, shares of N, alpha and
alpha V at once. The members that meet most are then judged by all fifteen claims, as the readings are. Nothing is
tuned: the grid is stated, every member counts, and the same search is made for scrambled numbers.
"""

import os
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from squealbox.papers.drum_brake_2011.family import COARSE, PRINTED_BELTS, SHARES, SIGNS, USUAL, TriedValues, Variant
from squealbox.papers.drum_brake_2011.family_modes import CLAIMS, Members, MembersFound, published, scrambled, stacked
from squealbox.studies import sweep

SETS = 400  # scrambled sets of numbers
KEPT = 512  # members kept of a point, evenly among those that meet most
STIFFNESS = ("mu-2", "mu-3", "mu-4", "N-2")  # what stiffness alone decides
FREE = ("front", "belts")


@dataclass(frozen=True)
class Searched:
    """What the search found.

    `counts` has how many members meet 0, 1, ... 8 of the claims; `best` the members that meet most, one row each of
    front, belts, loads, share, alpha, alpha V; `chance` the share of scrambled sets of which the same family meets at
    least as many, `sets` their number, `family` and `chance_family` how many members were tried for each.
    """

    counts: Any
    best: Any
    chance: float
    sets: int
    family: int
    chance_family: int

    @property
    def most(self) -> int:
        """The most claims of the eight that one member meets."""
        return int(np.max(np.nonzero(self.counts)[0]))


def score(variant: Variant, grid: TriedValues = USUAL) -> dict[str, Any]:
    """The counts of all members with the signs of `variant`, and the best of them."""
    members = Members(int(variant.front), int(variant.belts), grid)
    met = MembersFound.of(members).score(published())
    most = int(met.max())
    places = np.argwhere(met == most)
    kept = places[np.unique(np.linspace(0, len(places) - 1, min(len(places), KEPT)).round().astype(int))]
    best = np.full((KEPT, 4), np.nan)
    best[: len(kept), :2] = kept[:, :2]
    best[: len(kept), 2] = np.array(grid.alpha)[kept[:, 2]]
    best[: len(kept), 3] = np.array(grid.product)[kept[:, 3]]
    return {"counts": np.bincount(met.ravel(), minlength=len(CLAIMS) + 1).astype(float), "best": best}


def chance(variant: Variant) -> dict[str, Any]:
    """The most claims one member with the signs of `variant` meets, of the published numbers and of scrambled ones."""
    found = MembersFound.of(Members(int(variant.front), int(variant.belts), COARSE))
    wanted = [published(), *scrambled(SETS)]
    return {"met": np.array([float(found.score(each).max()) for each in wanted])}


def short(sets: int = 200) -> Searched:
    """The search with the belts as printed, on the coarser grid, in this process: some seconds.

    >>> short(1).most
    6
    """
    wanted = [published(), *scrambled(sets)]
    belts = SIGNS.index(PRINTED_BELTS)
    counts = np.zeros(len(CLAIMS) + 1, int)
    met = np.zeros((len(SIGNS), len(wanted)))
    for front in range(len(SIGNS)):
        found = MembersFound.of(Members(front, belts, COARSE))
        counts += np.bincount(found.score(wanted[0]).ravel(), minlength=len(CLAIMS) + 1)
        met[front] = [found.score(each).max() for each in wanted]
    most = met.max(axis=0)
    tried = len(SIGNS) * COARSE.size
    return Searched(counts, np.empty((0, 6)), float(np.mean(most[1:] >= most[0])), sets, tried, tried)


def search(
    out: str | os.PathLike[str] | None = None,
    workers: int | None = None,
    progress: Callable[[float], None] = lambda share: None,
) -> Searched:
    """Search the whole family; with `out`, a search that was stopped goes on from there.

    Takes about two minutes of one processor.
    """
    points = {name: np.arange(float(len(SIGNS))) for name in FREE}
    done = [0.0, 0.0]

    def follow(which: int) -> Callable[[Any], None]:
        def told(pace: Any) -> None:
            done[which] = pace.done / pace.total
            progress(sum(done) / 2.0)

        return told

    tables = [
        sweep(
            Variant(), points, analysis, out=None if out is None else os.path.join(os.fspath(out), name),
            workers=workers, progress=follow(i), time_limit=600.0,
        )
        for i, (name, analysis) in enumerate((("members", score), ("chance", chance)))
    ]  # fmt: skip
    return collected(*tables)


def collected(members: Any, by_chance: Any) -> Searched:
    """The two tables of the search as one answer."""
    counts = np.asarray(members["counts"]).reshape(-1, len(CLAIMS) + 1)
    best = np.asarray(members["best"]).reshape(len(SIGNS), len(SIGNS), KEPT, 4)
    most = int(np.max(np.nonzero(counts.sum(axis=0))[0]))
    rows = []
    for front in range(len(SIGNS)):
        for belts in range(len(SIGNS)):
            if counts[front * len(SIGNS) + belts, most]:
                here = best[front, belts]
                here = here[np.isfinite(here[:, 0])]
                rows.append(np.column_stack([np.full(len(here), front), np.full(len(here), belts), here]))
    met = np.asarray(by_chance["met"]).reshape(-1, SETS + 1).max(axis=0)
    return Searched(
        counts=counts.sum(axis=0).astype(int),
        best=np.concatenate(rows),
        chance=float(np.mean(met[1:] >= met[0])),
        sets=SETS,
        family=len(SIGNS) ** 2 * USUAL.size,
        chance_family=len(SIGNS) ** 2 * COARSE.size,
    )


def stiffness_only(sets: int = 2000) -> tuple[list[int], float]:
    """The short form of the search: which of the sixteen signs in front x belt meet all that stiffness decides.

    Those are the onset, both frequencies at mu = 0.1 and at 0.3, and the distance before the onset; friction without N,
    alpha V from 0 to 0.15. Returns the indices of `SIGNS` and the share of scrambled sets met as well.
    """
    grid = TriedValues((1e-6,), USUAL.product)  # alpha V without alpha: nothing but stiffness
    found = [MembersFound.of(Members(front, SIGNS.index((1.0,) * 4), grid)) for front in range(len(SIGNS))]
    wanted = stacked([published(), *scrambled(sets)])

    def all_met(each: MembersFound) -> Any:
        frequencies = each.members.frequencies(0.30)
        both = [np.abs(frequencies[i] - wanted.at_load[i]) <= np.pi * 40.0 for i in (0, 1)]
        met = [claim[:, 0] if claim.ndim == 4 else claim for claim in each.met(wanted, STIFFNESS[:3]).values()]
        return np.any(met[0] & met[1] & met[2] & both[0] & both[1], axis=(0, -1))

    met = np.array([all_met(each) for each in found])  # (signs, sets)
    return [int(i) for i in np.nonzero(met[:, 0])[0]], float(np.mean(np.any(met[:, 1:], axis=0)))


def signs_of(row: np.ndarray) -> tuple[str, str, str, str]:
    """The signs in front, of the belts and of the loads, and the share of N, of a member in words."""
    front, belts, loads, share = (int(each) for each in row[:4])
    words = ["".join("+" if s > 0 else "-" for s in SIGNS[i]) for i in (front, belts, loads)]
    return words[0], words[1], words[2], SHARES[share]

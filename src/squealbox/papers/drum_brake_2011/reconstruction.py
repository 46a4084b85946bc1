"""From the members that meet most of the eight claims to the reading that meets most of all fifteen.

Three steps, each a sweep that goes on where it was stopped: the two transients of mu-7 for every member that meets
most; the same on a finer grid of alpha and alpha V around each choice of signs whose amplitudes come within 15 %; and
all claims for those that come near mu-7 there, and for a sample of the others. mu-7 is the sieve because it takes two
runs and the others take fourteen; its runs are exact, which is quicker than raw ones that hang at sgn.
"""

import os
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from squealbox.papers.drum_brake_2011.cases import AMPLITUDES
from squealbox.papers.drum_brake_2011.claims import EXACT, claims
from squealbox.papers.drum_brake_2011.family import TriedValues, Variant
from squealbox.papers.drum_brake_2011.family_judged import SAMPLES, MemberCase, claims_met, without_mirror_images
from squealbox.papers.drum_brake_2011.family_modes import Members, MembersFound, published
from squealbox.papers.drum_brake_2011.family_search import Searched, search
from squealbox.papers.drum_brake_2011.motions import Run, Studies
from squealbox.studies import sweep, zipped
from squealbox.transient import Method

NAMES = ("front", "belts", "loads", "share", "alpha", "sliding_speed")
SIEVE = Method("tsitouras", rtol=1e-6, most_steps=50_000)  # a usual run takes 3,000; one that hangs is no cycle
SLACK = 2.0  # times the tolerance of mu-7: raw amplitudes, which decide, are up to 2 % below the exact ones
NEAR = 0.15  # of the published amplitudes: closer ones are looked at on the finer grid
FINE_ALPHA, FINE_PRODUCT = 0.0015, 0.0005  # s/m and -, the finer grid, five steps to each side
JUDGED = 60  # members judged by all claims, evenly among those that come near mu-7, and as many among all
WANTED = {
    part.name: (float(part.published), part.below) for each in claims() if each.id == "mu-7" for part in each.parts
}


@dataclass(frozen=True)
class Reconstruction:
    """The search of the family, and what its best members meet of all claims.

    `rows` are members judged by all claims, columns as in `NAMES`; `met` the claims of each by measure of amplitude;
    `tried` how many were run for mu-7, on the grid and on the finer one; `meeting` how many of them meet it.
    """

    searched: Searched
    rows: Any
    met: list[dict[str, list[str]]]
    tried: tuple[int, int]
    meeting: int

    @property
    def ties(self) -> list[tuple[Any, str, list[str]]]:
        """The row, the measure and the claims of every member that meets most, in the better measure of each."""
        found = [max(met.items(), key=lambda each: len(each[1])) for met in self.met]
        most = max(len(ids) for _, ids in found)
        return [(row, *each) for row, each in zip(self.rows, found, strict=True) if len(each[1]) == most]

    @property
    def best(self) -> tuple[Any, str, list[str]]:
        """The row, the measure and the claims of the member that meets most; of equals the first."""
        return self.ties[0]


def amplitudes(variant: Variant) -> dict[str, float]:
    """The amplitudes of mu-7, half of peak to peak over the last quarter [mm]; not a number for a run that hangs."""
    runs = Studies(_case(variant), EXACT, SIEVE, SAMPLES)
    motions = {name: runs[Run("friction", mu)] for name, mu in (("low", 0.40), ("high", 0.50))}
    return {name: 1e3 * each.amplitude if each.completed else np.nan for name, each in motions.items()}


def verdict(variant: Variant) -> dict[str, Any]:
    """Which of the fifteen claims a member meets, 1 or 0, by measure of amplitude."""
    met = claims_met(_case(variant))
    return {"met": np.array([[float(each.id in met[name]) for each in claims()] for name in AMPLITUDES])}


def reconstruct(
    out: str | os.PathLike[str] | None = None,
    workers: int | None = None,
    progress: Callable[[str, float], None] | None = None,
) -> Reconstruction:
    """The whole search; with `out`, one that was stopped goes on from there. Some minutes on two processors."""
    tell = progress or (lambda what, share: None)
    searched = search(out, workers, lambda share: tell("members of the family", share))

    def table(name: str, rows: np.ndarray, analysis: Any, what: str) -> Any:
        space = zipped({key: rows[:, i] for i, key in enumerate(NAMES)})
        folder = None if out is None else os.path.join(os.fspath(out), name)
        return sweep(
            Variant(), space, analysis, out=folder, workers=workers, time_limit=600.0,
            progress=lambda pace: tell(what, pace.done / pace.total),
        )  # fmt: skip

    coarse = without_mirror_images(searched.best).copy()
    coarse[:, 5] /= coarse[:, 4]
    first = _pairs(table("amplitudes", coarse, amplitudes, "amplitudes"))
    fine = finer(coarse[_miss(first) < NEAR])
    second = _pairs(table("finer", fine, amplitudes, "amplitudes on the finer grid")) if len(fine) else np.empty((0, 2))
    rows, pairs = np.concatenate([coarse, fine]), np.concatenate([first, second])
    meeting = rows[_meets(pairs)]
    chosen = np.unique(np.concatenate([_evenly(meeting), _evenly(coarse)]), axis=0)
    met = np.asarray(table("claims", chosen, verdict, "all claims")["met"])
    ids = [claim.id for claim in claims()]
    named = [
        {name: [i for i, yes in zip(ids, each[k], strict=True) if yes] for k, name in enumerate(AMPLITUDES)}
        for each in met
    ]
    return Reconstruction(searched, chosen, named, (len(coarse), len(fine)), len(meeting))


def finer(rows: np.ndarray) -> Any:
    """Members on the finer grid around these that meet as many of the eight claims, columns as in `NAMES`."""
    if not len(rows):
        return np.empty((0, len(NAMES)))
    around = np.arange(-5, 6)
    found = []
    for signs in np.unique(rows[:, :4], axis=0):
        here = rows[np.all(rows[:, :4] == signs, axis=1)]
        alphas = np.unique(np.round((here[:, 4, None] + FINE_ALPHA * around).ravel(), 6))
        products = np.unique(np.round(((here[:, 4] * here[:, 5])[:, None] + FINE_PRODUCT * around).ravel(), 6))
        members = Members(int(signs[0]), int(signs[1]), TriedValues(tuple(alphas), tuple(products)))
        met = MembersFound.of(members).score(published())[int(signs[2]), int(signs[3])]
        for i, j in np.argwhere(met == met.max()):
            found.append((*signs, alphas[i], products[j] / alphas[i]))
    return np.array(found)


def _evenly(rows: np.ndarray) -> Any:
    """At most `JUDGED` of the rows, evenly among them."""
    return rows[np.unique(np.linspace(0, len(rows) - 1, min(len(rows), JUDGED)).round().astype(int))]


def _case(variant: Variant) -> Any:
    front, belts, loads, share = (int(getattr(variant, name)) for name in NAMES[:4])
    return MemberCase(front, belts, loads, share, float(variant.alpha), float(variant.sliding_speed))


def _pairs(table: np.ndarray) -> Any:
    return np.stack([np.asarray(table["low"]), np.asarray(table["high"])], axis=-1)


def _miss(pairs: np.ndarray) -> Any:
    """How far the two amplitudes are from the published ones, as a share, in the better measure."""
    wanted = np.array([value for value, _ in WANTED.values()])
    off = [np.max(np.abs(halves * pairs / wanted - 1.0), axis=-1) for halves in AMPLITUDES.values()]
    return np.where(np.isfinite(off[0]), np.minimum(*off), np.inf)


def _meets(pairs: np.ndarray) -> Any:
    wanted, slack = (np.array(each) for each in zip(*WANTED.values(), strict=True))
    return np.any([np.all(np.abs(h * pairs - wanted) <= SLACK * slack, axis=-1) for h in AMPLITUDES.values()], axis=0)

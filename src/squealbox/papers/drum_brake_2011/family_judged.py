"""All fifteen claims for a member of the family, judged as the readings are: by eigenvalues and by raw transients."""

import dataclasses
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from squealbox.friction import LinearSlope
from squealbox.papers.drum_brake_2011 import by_eigenvalues, by_transients, steady
from squealbox.papers.drum_brake_2011.cases import AMPLITUDES, FRICTION, LOAD
from squealbox.papers.drum_brake_2011.claims import AGREE, RAW, claims, combined, judge, read_as
from squealbox.papers.drum_brake_2011.family import Variant
from squealbox.papers.drum_brake_2011.motions import METHODS, Studies

SAMPLES = 2001
MAP_STEP = 5.0  # deg, as fine as the paper states the zone
DECIDING = tuple(part.key for claim in claims() if RAW in claim.deciding for part in claim.parts if RAW in part.roads)


@dataclass(frozen=True)
class MemberCase:
    """A member of the family in the place of a `Case`: signs as they count in the family, alpha, speed."""

    front: int
    belts: int
    loads: int
    share: int
    alpha: float
    speed: float
    floor: float | None = None
    reading: str = "a member of the family"
    has_contacts: bool = True

    def replace(self, **changes: Any) -> Self:
        """The same with other choices."""
        return dataclasses.replace(self, **changes)

    def design(
        self,
        mu: Any = FRICTION,
        load: Any = LOAD,
        speed: Any = None,
        **changes: Any,
    ) -> Variant:
        """The brake; `mu`, `load` [N] and angles [rad] may be arrays, `speed` [m/s] a schedule."""
        return Variant(
            front=float(self.front),
            belts=float(self.belts),
            loads=float(self.loads),
            share=float(self.share),
            alpha=self.alpha,
            friction=LinearSlope(mu, 0.0, self.floor),
            load=load,
            sliding_speed=self.speed if speed is None else speed,
            **changes,
        )


def case_of(row: Sequence[float] | np.ndarray) -> MemberCase:
    """A row of `Searched.best` as a case."""
    front, belts, loads, share = (int(each) for each in row[:4])
    return MemberCase(front, belts, loads, share, float(row[4]), float(row[5] / row[4]))


def claims_met(case: Any) -> dict[str, list[str]]:
    """The claims this case meets, by what an amplitude is read as."""
    steadily = by_eigenvalues.findings(case, steady.pressure_map(case, MAP_STEP))
    moving = by_transients.findings(Studies(case, RAW, METHODS[RAW], SAMPLES), only=DECIDING)
    found: Mapping[str, Any] = {**moving, **steadily}
    met: dict[str, list[str]] = {}
    for measure, halves in AMPLITUDES.items():
        met[measure] = []
        for claim in claims():
            parts = [part for part in claim.parts if set(part.roads) & set(claim.deciding)]
            verdicts = [judge(part, read_as(part, found[part.key], halves)) for part in parts]
            if combined(verdicts) == AGREE:
                met[measure].append(claim.id)
    return met


def without_mirror_images(best: np.ndarray) -> Any:
    """The rows with shoe 1's sign along x positive: (x, y) -> (-x, -y) turns all signs and gives the same motions."""
    return best[np.asarray(best)[:, 0] < 8]

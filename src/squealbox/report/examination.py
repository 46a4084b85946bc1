"""Everything a report knows of one design: results, no words, no figures."""

from dataclasses import dataclass, field, fields
from typing import Any

from squealbox.design import Design
from squealbox.family import ParameterAxis, ParameterPlane
from squealbox.limit_cycles import Cycle, HopfPoint
from squealbox.matrices import liveliest
from squealbox.remedies import Remedies
from squealbox.result import Result
from squealbox.signals import SoundLevel
from squealbox.stability import (
    BandModes,
    Boundary,
    ComplexModes,
    CriticalValue,
    CriticalValues,
    Mechanism,
    ModeEnergy,
    Sensitivity,
    StabilityMap,
    TrackedModes,
)
from squealbox.system import System
from squealbox.transient import MotionSettings, Trajectory, Verdict


@dataclass(frozen=True, kw_only=True)
class Examination:
    """What was computed of one design; a part that could not be is None (or empty), and `missing` says why.

    Of a reduced brake `whole` is the full one at the present values, `band` its modes with their error bars and
    `mode_table` what :func:`squealbox.stability.mode_tables.mode_table` tells of them.
    """

    design: Design
    system: System
    modes: ComplexModes
    time: float = 0.0
    whole: Any = None
    band: BandModes | None = None
    mode_table: dict[str, Any] | None = None
    why: Mechanism | None = None
    varied: ParameterAxis | None = None
    crossings: CriticalValues | None = None
    spectra: ComplexModes | TrackedModes | None = None
    ranking: Sensitivity | None = None
    energy: ModeEnergy | None = None
    plane: ParameterPlane | None = None
    map: StabilityMap | None = None
    boundary: Boundary | None = None
    settings: MotionSettings | None = None
    motion: Trajectory | None = None
    verdicts: tuple[Verdict, ...] = ()
    heard: Trajectory | None = None
    loudness: SoundLevel | None = None
    cycle: Cycle | None = None
    tried: tuple[str, ...] = ()
    cycle_loudness: SoundLevel | None = None
    hopf: HopfPoint | None = None
    remedies: Remedies | None = None
    missing: dict[str, str] = field(default_factory=dict)

    @property
    def shown(self) -> Design:
        """The design as its reader knows it: of a reduced brake the whole one, where that is kept."""
        return self.whole if isinstance(self.whole, Design) else self.design

    def __repr__(self) -> str:
        parts = [each.name for each in fields(self) if isinstance(getattr(self, each.name), Result)]
        lines = [f"Examination of {self.shown.title or type(self.shown).__name__}", self.modes.summary()]
        lines += [f"parts: {', '.join(parts)}"] + [f"{name}: {why}" for name, why in self.missing.items()]
        return "\n".join(lines)

    @property
    def stable(self) -> bool:
        """True when steady sliding exists and no mode grows."""
        return bool(self.modes.stable)

    @property
    def present(self) -> float:
        """The design's own value of the parameter that is varied."""
        return float(self.design.value_of(self.varied.name)) if self.varied else float("nan")

    @property
    def critical(self) -> CriticalValue | None:
        """The change of stability nearest to the design's own value; None where there is none."""
        return None if self.crossings is None else self.crossings.nearest(self.present)

    @property
    def dies_away(self) -> bool:
        """True when of the transient nothing is left in the end."""
        return bool(self.verdicts) and self.verdicts[self.liveliest].fate == "decays"

    @property
    def liveliest(self) -> int:
        """The degree of freedom that moves most at the end of the transient."""
        sizes = [float(v.amplitude) for v in self.verdicts]
        return liveliest(sizes, self.system.units) if sizes else 0

    @property
    def coexists(self) -> bool:
        """True when steady sliding is stable and yet a stable cycle was found beside it."""
        return bool(self.stable and self.cycle is not None and self.cycle.stable)


def results_of(found: Examination) -> list[Result]:
    """Every result an examination holds, for a table of how each ended."""
    parts = [found.modes, found.band, found.crossings, found.ranking, found.energy, found.map, found.boundary,
             found.motion, *found.verdicts, found.loudness, found.hopf, found.cycle, found.cycle_loudness,
             found.remedies]  # fmt: skip
    return [part for part in parts if part is not None]

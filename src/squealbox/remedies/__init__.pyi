from .candidates import Candidate, candidates_for
from .production import usual_scatter
from .ranking import Remedies, silence
from .settings import SilenceSettings

__all__ = [
    "Candidate",
    "Remedies",
    "SilenceSettings",
    "candidates_for",
    "silence",
    "usual_scatter",
]

# What neighbours may use too; no names of the reference (docs/house.md, Faces).
from .candidates import more_friction as more_friction
from .target import ASSUMED as ASSUMED
from .target import Lot as Lot
from .target import lot_of as lot_of

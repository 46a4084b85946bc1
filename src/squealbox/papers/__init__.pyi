__all__ = []

# What neighbours may use too; no names of the reference (docs/house.md, Faces).
from .drum_brake_2011.cases import ALPHA as ALPHA
from .drum_brake_2011.cases import INFERRED as INFERRED
from .drum_brake_2011.cases import Case as Case
from .drum_brake_2011.claims import paper as paper
from .drum_brake_2011.record import Record as Record
from .drum_brake_2011.record import count as count
from .drum_brake_2011.verdicts import verdicts as verdicts

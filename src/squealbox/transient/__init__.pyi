from .comparison import ContactComparison, compare_contact
from .ensemble import Ensemble, simulate_ensemble
from .methods import TABLEAUX, Method, Tableau
from .observers import OBSERVERS, Observer
from .readiness import needs_compiling
from .resolution import carries, resolved
from .settings import LARGE, MotionSettings, usual_duration
from .simulating import simulate
from .trajectory import EnergyAudit, Trajectory
from .verdicts import Verdict, verdict

__all__ = [
    "LARGE",
    "OBSERVERS",
    "TABLEAUX",
    "ContactComparison",
    "EnergyAudit",
    "Ensemble",
    "Method",
    "MotionSettings",
    "Observer",
    "Tableau",
    "Trajectory",
    "Verdict",
    "carries",
    "compare_contact",
    "needs_compiling",
    "resolved",
    "simulate",
    "simulate_ensemble",
    "usual_duration",
    "verdict",
]

# What neighbours may use too; no names of the reference (docs/house.md, Faces).
from ._motion import EXACT as EXACT
from ._motion import OPEN as OPEN
from .choosing import is_small as is_small
from .choosing import usual_method as usual_method
from .envelope import smooth_curve as smooth_curve
from .lanes.batch import first_of as first_of
from .lanes.batch import stacked as stacked
from .lanes.flows import Ends as Ends
from .lanes.flows import Flows as Flows
from .lanes.flows import rows_of_all as rows_of_all
from .lanes.shape import entries as entries
from .lanes.shape import parameter_rows as parameter_rows
from .lanes.single import Single as Single
from .lanes.single import difference as difference
from .lanes.table import tabulate as tabulate
from .latest import Latest as Latest
from .legs import SCHEMES as SCHEMES
from .legs import by_step as by_step
from .limited import in_time as in_time
from .methods import TAYLOR as TAYLOR
from .observers import amplitude_update as amplitude_update
from .observers import frequency as frequency
from .observers import poincare as poincare
from .packing import inverse_mass as inverse_mass
from .pieces import in_pieces as in_pieces
from .pieces import start_of_driven as start_of_driven
from .rows import ALGEBRAIC as ALGEBRAIC
from .rows import WITH_MASS as WITH_MASS
from .rows import fastest_rate as fastest_rate
from .rows import row_kinds as row_kinds
from .rows import rows_of as rows_of
from .simulating import TIME_STEPPING as TIME_STEPPING
from .simulating import system_of as system_of
from .widened import RunApart as RunApart
from .widened import Widened as Widened
from .widened import base_of as base_of
from .widened import laid_open as laid_open
from .widened import start_of as start_of

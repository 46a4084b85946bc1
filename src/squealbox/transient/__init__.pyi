from .comparison import ContactComparison, compare_contact
from .ensemble import Ensemble, simulate_ensemble
from .methods import TABLEAUX, Method, Tableau
from .observers import OBSERVERS, Observer
from .readiness import needs_compiling
from .resolution import carries, resolved
from .settings import LARGE, MotionSettings, usual_duration
from .simulate import simulate
from .trajectory import EnergyAudit, Trajectory
from .verdict import Verdict, verdict

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

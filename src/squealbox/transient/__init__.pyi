from .comparison import ContactComparison, compare_contact
from .ensemble import Ensemble, simulate_ensemble
from .methods import TABLEAUX, Method, Tableau
from .observers import OBSERVERS, Observer
from .readiness import needs_compiling
from .resolution import carries, resolved
from .simulate import simulate
from .trajectory import EnergyAudit, Trajectory
from .verdict import Verdict, verdict

__all__ = [
    "OBSERVERS",
    "TABLEAUX",
    "ContactComparison",
    "EnergyAudit",
    "Ensemble",
    "Method",
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
    "verdict",
]

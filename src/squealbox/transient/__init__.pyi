from .comparison import ContactComparison, compare_contact
from .methods import TABLEAUX, Method, Tableau
from .simulate import simulate
from .trajectory import EnergyAudit, Trajectory
from .verdict import Verdict, verdict

__all__ = [
    "TABLEAUX",
    "ContactComparison",
    "EnergyAudit",
    "Method",
    "Tableau",
    "Trajectory",
    "Verdict",
    "compare_contact",
    "simulate",
    "verdict",
]

from .methods import TABLEAUX, Method, Tableau
from .simulate import simulate
from .trajectory import EnergyAudit, Trajectory
from .verdict import Verdict, verdict

__all__ = ["TABLEAUX", "EnergyAudit", "Method", "Tableau", "Trajectory", "Verdict", "simulate", "verdict"]

from .attractors.attractor import Attractor
from .attractors.basins import Basin, basin
from .attractors.coexistence import Coexistence, coexistence, cycle_ends
from .attractors.diagrams import BifurcationDiagram, bifurcation_diagram
from .attractors.exponents import lyapunov_exponents
from .attractors.pushes import DangerousPush, dangerous_push, push_along
from .attractors.sections import Section, maxima, poincare_section
from .branches.branch import Branch, branch
from .branches.curves import PointCurve, hopf_curve
from .branches.hopf import HopfPoint, hopf_point
from .branches.isolated import isolated_branches, settled_cycles
from .branches.joined import joined
from .branches.point_curves import point_curve
from .branches.special_points import BranchPoint
from .branches.stretches import beside_sliding, stable_sliding, stretches
from .cycles.cycle import Cycle
from .cycles.forced import ForcedCycle, forced_branch, forced_cycle, forced_path
from .cycles.harmonic_balance import harmonic_balance
from .cycles.shooting import shooting
from .estimates.averaging import averaged_curve, averaged_limit, averaged_swings, describing_function
from .estimates.curves import EstimateCurve, estimate_curves
from .estimates.stick_slip_limit import return_gap, stick_slip_limit
from .settings import BasinSettings, BranchSettings, CycleSettings, DiagramSettings

__all__ = [
    "Attractor",
    "Basin",
    "BasinSettings",
    "BifurcationDiagram",
    "Branch",
    "BranchPoint",
    "BranchSettings",
    "Coexistence",
    "Cycle",
    "CycleSettings",
    "DangerousPush",
    "DiagramSettings",
    "EstimateCurve",
    "ForcedCycle",
    "HopfPoint",
    "PointCurve",
    "Section",
    "averaged_curve",
    "averaged_limit",
    "averaged_swings",
    "basin",
    "beside_sliding",
    "bifurcation_diagram",
    "branch",
    "coexistence",
    "cycle_ends",
    "dangerous_push",
    "describing_function",
    "estimate_curves",
    "forced_branch",
    "forced_cycle",
    "forced_path",
    "harmonic_balance",
    "hopf_curve",
    "hopf_point",
    "isolated_branches",
    "joined",
    "lyapunov_exponents",
    "maxima",
    "poincare_section",
    "point_curve",
    "push_along",
    "return_gap",
    "settled_cycles",
    "shooting",
    "stable_sliding",
    "stick_slip_limit",
    "stretches",
]

# What neighbours may use too; no names of the reference (docs/house.md, Faces).
from .attractors.attractor import CYCLE as CYCLE
from .attractors.attractor import REST as REST
from .attractors.attractor import SLIDING as SLIDING
from .attractors.basins import half_widths as half_widths
from .attractors.basins import place as place
from .attractors.exponents import LOST as LOST
from .attractors.sections import state_names as state_names
from .branches.isolated import lies_on as lies_on
from .branches.stretches import NEUTRAL as NEUTRAL
from .cycles.starting import VISIBLE as VISIBLE
from .estimates.curves import AVERAGED as AVERAGED
from .estimates.curves import DESCRIBING as DESCRIBING

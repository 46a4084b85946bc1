"""What does the motion settle to?

Depends on: transient, stability, continuation, system, friction, schedules, result, parameters.
"""

from squealbox.limit_cycles.attractors.attractor import Attractor
from squealbox.limit_cycles.attractors.basins import Basin, basin
from squealbox.limit_cycles.attractors.coexistence import Coexistence, coexistence, cycle_ends
from squealbox.limit_cycles.attractors.diagrams import BifurcationDiagram, bifurcation_diagram
from squealbox.limit_cycles.attractors.exponents import lyapunov_exponents
from squealbox.limit_cycles.attractors.pushes import DangerousPush, dangerous_push, push_along
from squealbox.limit_cycles.attractors.sections import Section, maxima, poincare_section
from squealbox.limit_cycles.branches.branch import Branch, branch
from squealbox.limit_cycles.branches.curves import PointCurve, hopf_curve
from squealbox.limit_cycles.branches.hopf import HopfPoint, hopf_point
from squealbox.limit_cycles.branches.isolated import isolated_branches, settled_cycles
from squealbox.limit_cycles.branches.joined import joined
from squealbox.limit_cycles.branches.point_curves import point_curve
from squealbox.limit_cycles.branches.special_points import BranchPoint
from squealbox.limit_cycles.branches.stretches import beside_sliding, stable_sliding, stretches
from squealbox.limit_cycles.cycles.cycle import Cycle
from squealbox.limit_cycles.cycles.forced import ForcedCycle, forced_branch, forced_cycle, forced_path
from squealbox.limit_cycles.cycles.harmonic_balance import harmonic_balance
from squealbox.limit_cycles.cycles.shooting import shooting
from squealbox.limit_cycles.estimates.averaging import (
    averaged_curve,
    averaged_limit,
    averaged_swings,
    describing_function,
)
from squealbox.limit_cycles.estimates.curves import EstimateCurve, estimate_curves
from squealbox.limit_cycles.estimates.stick_slip_limit import return_gap, stick_slip_limit
from squealbox.limit_cycles.settings import BasinSettings, BranchSettings, CycleSettings, DiagramSettings

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

from .kinds import LOOPS, PID, ActiveForce, DelayedFeedback, Loop, StateFeedback, check_loops
from .rows import Rows, folded, near_sliding

__all__ = [
    "LOOPS",
    "PID",
    "ActiveForce",
    "DelayedFeedback",
    "Loop",
    "Rows",
    "StateFeedback",
    "check_loops",
    "folded",
    "near_sliding",
]

# What neighbours may use too; no names of the reference (docs/house.md, Faces).
from .driven import Driven as Driven
from .driven import driven_brake as driven_brake
from .held import continued as continued
from .held import first_order as first_order
from .held import highest_rate as highest_rate
from .held import step_matrix as step_matrix
from .rows import chebyshev as chebyshev
from .rows import delayed as delayed
from .rows import force_per_state as force_per_state
from .rows import numbered as numbered
from .rows import padded_contacts as padded_contacts
from .rows import padded_load as padded_load
from .rows import size_and_rate as size_and_rate

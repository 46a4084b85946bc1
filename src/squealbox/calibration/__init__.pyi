from .calibrating import Calibration, calibrate
from .comparison import Comparison, compare, modal_assurance
from .measured import QUANTITIES, Measured, from_events, from_friction, from_signal
from .mode_tables import ModeTable, read_mode_table
from .settings import CalibrateSettings

__all__ = [
    "QUANTITIES",
    "CalibrateSettings",
    "Calibration",
    "Comparison",
    "Measured",
    "ModeTable",
    "calibrate",
    "compare",
    "from_events",
    "from_friction",
    "from_signal",
    "modal_assurance",
    "read_mode_table",
]

# What neighbours may use too; no names of the reference (docs/house.md, Faces).
from .measured import UNITS as UNITS
from .settings import Recorded as Recorded

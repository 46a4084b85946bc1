"""From measurements to parameters: what a brake must be like to do what was measured. Depends on: stability, transient,
studies, signals, friction, system, result, parameters.

Measured numbers with their standard deviations go in, a design whose parameters are known as well as the data allow
comes out, with intervals and with what the data cannot tell apart in words.
"""

from squealbox.calibration.calibrate import Calibration, calibrate
from squealbox.calibration.comparison import Comparison, compare, modal_assurance
from squealbox.calibration.measured import QUANTITIES, Measured, from_events, from_friction, from_signal
from squealbox.calibration.mode_tables import ModeTable, read_mode_table
from squealbox.calibration.settings import CalibrateSettings

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

"""What does the motion settle to?

Depends on: transient, stability, continuation, system, friction, schedules, result, parameters.
"""

from squealbox.registers import face

__getattr__, __dir__, __all__ = face(__name__)

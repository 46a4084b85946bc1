"""What a loop does to a brake: poles, margins, runs. Depends on: stability, transient, loops, system, result."""

from squealbox.registers import face

__getattr__, __dir__, __all__ = face(__name__)

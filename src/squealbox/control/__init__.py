"""What a loop does to a brake: poles, margins, runs."""

from squealbox.registers import face

__getattr__, __dir__, __all__ = face(__name__)

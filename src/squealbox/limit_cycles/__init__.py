"""What does the motion settle to?"""

from squealbox.registers import face

__getattr__, __dir__, __all__ = face(__name__)

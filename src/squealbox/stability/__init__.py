"""Is steady sliding stable?"""

from squealbox.registers import face

__getattr__, __dir__, __all__ = face(__name__)

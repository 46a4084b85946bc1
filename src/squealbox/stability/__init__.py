"""Is steady sliding stable? Depends on: system, continuation, result, compiled."""

from squealbox.registers import face

__getattr__, __dir__, __all__ = face(__name__)

"""Published studies, computed again. Depends on: everything below; each paper is a package with its claims as data."""

from squealbox.registers import face

__getattr__, __dir__, __all__ = face(__name__)

"""What would silence this brake?

The names are listed in ``__init__.pyi``; each is loaded when it is first used.
"""

from squealbox.registers import face

__getattr__, __dir__, __all__ = face(__name__)

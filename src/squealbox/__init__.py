"""Friction-induced vibration of brakes: stability, transients and limit cycles of systems with sliding contacts.

The public names are listed in ``__init__.pyi``, in the order of the story: laws and schedules, the system, designs,
what is asked of them, and pictures. Each is loaded when it is first used, so importing the package is quick.
"""

from squealbox.registers import face

__version__ = "0.2.0"

__getattr__, __dir__, __all__ = face(__name__)

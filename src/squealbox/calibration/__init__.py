"""From measurements to parameters: what a brake must be like to do what was measured.

Measured numbers with their standard deviations go in, a design whose parameters are known as well as the data allow
comes out, with intervals and with what the data cannot tell apart in words.
"""

from squealbox.registers import face

__getattr__, __dir__, __all__ = face(__name__)

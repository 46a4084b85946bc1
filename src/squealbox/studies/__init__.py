"""How does the answer vary? Spaces of parameters, sweeps over them, and the store a sweep cannot lose.

    table = sweep(brake, {"friction.static": mus, "load": loads}, complex_modes, out="study")

A study imports no analysis: it is handed one, any function of a design. So it can run the user's own as well.
"""

from squealbox.registers import face

__getattr__, __dir__, __all__ = face(__name__)

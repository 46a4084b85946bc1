"""One function for each kind of result; each returns a matplotlib figure. Depends on: the results it draws.

`plot(result)` chooses the function by the kind of result. Every function takes ``axes=`` to draw into a panel of a
larger figure made with `panels`. Matplotlib is loaded at the first drawing.

Its public names stand in ``__init__.pyi`` and are loaded when they are first used: the drawing of a brake on a page
needs none of the figures.
"""

from squealbox.registers import face

__getattr__, __dir__, __all__ = face(__name__)

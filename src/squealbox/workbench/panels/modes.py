"""The modes of the design on the page: several panels ask for them at once."""

import functools

from squealbox.designs import Design
from squealbox.stability import ComplexModes, complex_modes

KEPT = 8  # designs of the last questions


@functools.lru_cache(maxsize=KEPT)
def modes_of(design: Design) -> ComplexModes:
    """The modes about steady sliding, solved once for all panels that show one design."""
    return complex_modes(design)

"""Solvers of others on the drum with sticking; `benchmarks/rivals.py` compares them."""

from .drum import Drum
from .events import EXACT
from .tanh import SMOOTHED

RIVALS = (*EXACT, *SMOOTHED)

__all__ = ["RIVALS", "Drum"]

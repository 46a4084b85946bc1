"""What a signal holds: spectrum, peaks, growth rate, sound and how loud; recordings, the squeal events in them, and
the damping before it squeals.

Every function takes an array with its times ``t`` [s] or its sampling rate [Hz], or anything with ``.t`` and ``.q``,
such as a trajectory, of which ``dof`` names one column. Fourier methods need equal time steps and refuse others.
"""

from squealbox.registers import face

__getattr__, __dir__, __all__ = face(__name__)

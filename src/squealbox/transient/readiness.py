"""Is the kernel a motion needs on this machine already, or will its first run compile it?"""

from typing import Any

from squealbox.system import as_system


def needs_compiling(design_or_system: Any) -> bool:
    """True where :func:`simulate` with exact contacts would compile its kernel first: once a machine.

    Kernels are kept on disk, one for each room of the records (1, 2, 4, ... degrees of freedom and contacts) and
    text of the laws, so that a page or a script can say what it is waiting for. Raises as `simulate` does.

    >>> from squealbox import DrumBrake
    >>> isinstance(needs_compiling(DrumBrake()), bool)
    True
    """
    from squealbox.transient.simulating import exact_call

    march, arguments = exact_call(as_system(design_or_system))
    return not march.ready(*arguments)

"""What several panels ask of one design, solved once; what runs along a parameter, once for all its values."""

import functools

import numpy as np

from squealbox.design import Design
from squealbox.fe import ReducedBrake
from squealbox.parameters import ParameterError
from squealbox.stability import (
    ComplexModes,
    CriticalValues,
    TrackedModes,
    complex_modes,
    critical_values,
    tracked_modes,
)
from squealbox.workbench.panels.panel import Options

KEPT = 8  # designs of the last questions
POINTS, COARSE = 201, 21  # of a range, between which crossings are looked for: of brakes small and large
LARGE = 40  # degrees of freedom
MOST_MODES = 12


@functools.lru_cache(maxsize=KEPT)
def modes_of(design: Design) -> ComplexModes:
    """The modes about steady sliding, solved once for all panels that show one design."""
    return complex_modes(design)


def ranked(design: Design) -> list[int]:
    """Indices of the modes that are shown: the one that grows first, then the others; of a reduced brake its band's."""
    modes = modes_of(design)
    half = modes.eigenvalues.shape[-1] // 2
    growth = np.nan_to_num(modes.growth_rate[:half], nan=-np.inf)
    first = modes.most_unstable.index
    order = [first, *(int(i) for i in np.argsort(-growth, kind="stable") if i != first)]
    if isinstance(design, ReducedBrake):
        low, high = design.band
        order = [i for i in order if low <= modes.frequency[i] <= high] or order
    return order[:MOST_MODES]


def seen(design: Design, options: Options) -> tuple[list[int], int]:
    """The modes that are shown, and which of them the option `mode` chooses; the last where there are fewer."""
    order = ranked(design)
    return order, min(int(options.number("mode", 0, 0, 1e6)), len(order) - 1)


def crossings_of(design: Design, parameter: str, ends: tuple[float, float]) -> CriticalValues:
    """Where modes cross zero growth between the ends [SI]: the same while the parameter itself is moved."""
    return _crossings(_without(design, parameter, ends[0]), parameter, ends)


def tracks_of(design: Design, parameter: str, ends: tuple[float, float], points: int) -> TrackedModes:
    """The modes followed over the parameter: the same while the parameter itself is moved."""
    return _tracks(_without(design, parameter, ends[0]), parameter, ends, points)


def _without(design: Design, parameter: str, low: float) -> Design:
    try:
        return design.replace({parameter: low})
    except ParameterError:  # beside its other values that is none: kept as it is
        return design


@functools.lru_cache(maxsize=KEPT)
def _crossings(design: Design, parameter: str, ends: tuple[float, float]) -> CriticalValues:
    points = POINTS if design.system().size <= LARGE else COARSE
    return critical_values(design, parameter, ends, points=points)


@functools.lru_cache(maxsize=KEPT)
def _tracks(design: Design, parameter: str, ends: tuple[float, float], points: int) -> TrackedModes:
    return tracked_modes(design, parameter, np.linspace(*ends, points))

"""Eigenvalues as other codes print them, and back.

With lambda = sigma + i omega [1/s]:

    abaqus     frequency |omega|/(2 pi) [Hz], damping_ratio -2 sigma/|omega| ("effective damping ratio")
    ansys      stability sigma/(2 pi) [Hz], frequency omega/(2 pi) [Hz]: the two parts of a complex frequency
    nastran    real sigma [rad/s], imaginary omega [rad/s], frequency [Hz], damping -2 sigma/|omega| (coefficient g)
    optistruct as nastran

Read back, a pair counts once, with omega >= 0. A mode that does not oscillate has no -2 sigma/|omega|, so "abaqus"
cannot give it back; the others can.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from squealbox.stability.squeal_indices import squeal_index

COLUMNS = {
    "abaqus": ("frequency", "damping_ratio"),
    "ansys": ("stability", "frequency"),
    "nastran": ("real", "imaginary"),
    "optistruct": ("real", "imaginary"),
}


def as_printed_by(code: str, eigenvalues: ArrayLike) -> Mapping[str, Any]:
    """The columns in which a finite-element code prints eigenvalues [1/s], by name; see the module for their units.

    Parameters
    ----------
    code : "abaqus", "ansys", "nastran" or "optistruct"
    eigenvalues : growth rate + i angular frequency [1/s], any shape

    >>> from squealbox.stability import as_printed_by
    >>> printed = as_printed_by("ansys", 12.566370614359172 + 6283.185307179586j)
    >>> [round(float(printed[name]), 9) for name in ("stability", "frequency")]
    [2.0, 1000.0]
    """
    _known(code)
    values = np.asarray(eigenvalues, dtype=complex)
    hertz = np.abs(values.imag) / (2.0 * np.pi)
    if code == "abaqus":
        return {"frequency": hertz, "damping_ratio": squeal_index(values)}
    if code == "ansys":
        return {"stability": values.real / (2.0 * np.pi), "frequency": values.imag / (2.0 * np.pi)}
    return {"real": values.real, "imaginary": values.imag, "frequency": hertz, "damping": squeal_index(values)}


def eigenvalues_printed_by(code: str, first: ArrayLike, second: ArrayLike) -> Any:
    """Eigenvalues [1/s], shape (k,), from the two columns a code prints them in, so that its modes can be compared or
    drawn here.

    Parameters
    ----------
    code : "abaqus" (frequency [Hz], effective damping ratio), "ansys" (stability [Hz], frequency [Hz]), "nastran" or
        "optistruct" (real and imaginary part [rad/s])
    first, second : the two columns, in that order

    >>> from squealbox.stability import eigenvalues_printed_by
    >>> value = complex(eigenvalues_printed_by("abaqus", 1000.0, -0.02))
    >>> round(value.real, 6), round(value.imag, 6)
    (62.831853, 6283.185307)
    """
    _known(code)
    first, second = np.asarray(first, dtype=float), np.asarray(second, dtype=float)
    if code == "abaqus":
        omega = 2.0 * np.pi * first
        return -0.5 * second * omega + 1j * omega
    return (first + 1j * second) * (2.0 * np.pi if code == "ansys" else 1.0)


def _known(code: str) -> None:
    if code not in COLUMNS:
        raise ValueError(f"code = {code!r}: expected one of {', '.join(COLUMNS)}")

"""The published disc brake of 4,669 degrees of freedom, from its eight matrices.

Graebner, Mehrmann, Quraishi, Schroeder and von Wagner 2016, Z. Angew. Math. Mech. 96, 1388-1405; its matrices are
public (BSD-3, (c) 2014 Ali H. Kadar) and are read from a folder of the user's. The disc turns with O [rad/s]:

    (a)  C = D1 + DR/O + O DG + D4/F                    K = K1 + KR + O^2 KGEO
    (b)  C = D1 + (1/O - 1) DR + O DG + D4/(2 pi F)     K = K1 + KR + (O^2 - 1) KGEO

D1 is material damping, DR friction that turns with the sliding velocity (hence 1/O), DG gyroscopic, D4 structural
damping made viscous at the frequency F = 1600 Hz, K1 elastic, KR circulatory and KGEO geometric stiffness; O counts in
units of the reference speed 1 rad/s. Form (a) is that of the collection NLEVP; in form (b) DR and KGEO are already
contained in D1 and K1 as they are at the reference speed.
"""

from functools import lru_cache
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from scipy import sparse

from squealbox.design import Design
from squealbox.parameters import ParameterError, choice, parameter
from squealbox.system import System

FILES = {
    "M": "BMLL",
    "D1": "BDLL",
    "DG": "BYLL",
    "DR": "BDIWLL",
    "D4": "BHLL",
    "K1": "BKLL",
    "KR": "BKQLL",
    "KGEO": "BWLL",
}
SOURCE = "Graebner et al. 2016, Z. Angew. Math. Mech. 96, 1388-1405"


class PublishedDiscBrake(Design):
    """The disc brake of 4,669 degrees of freedom at any angular speed, in either published assembly."""

    title: ClassVar[str] = "Disc brake of 4,669 degrees of freedom (2016)"
    source: ClassVar[str] = SOURCE

    folder: str = ""
    angular_speed: float = parameter(
        "rad/s", 0.0, low_open=True, default=2.0 * np.pi, meaning="angular speed of the disc", source=SOURCE
    )
    assembly: str = choice("a", "b", default="a", meaning="how the speed enters, as the module's head says")
    damping_frequency: float = parameter(
        "Hz",
        0.0,
        low_open=True,
        default=1600.0,
        meaning="F, at which structural damping is made viscous",
        source=SOURCE,
    )

    def matrices(self) -> dict[str, Any]:
        """The eight matrices by name, each (4669, 4669) sparse."""
        return read_matrices(str(self.folder))

    def assembled(self) -> tuple[Any, Any, Any]:
        """M, C and K at the angular speed."""
        if np.ndim(self.angular_speed) or np.ndim(self.damping_frequency):
            raise ParameterError(
                type(self).__name__,
                "angular_speed",
                self.angular_speed,
                "one number: sparse matrices are one system at a time, and reduce() makes what can be swept",
            )
        part, speed = self.matrices(), self.angular_speed
        at_reference = 1.0 if self.assembly == "b" else 0.0
        per = 2.0 * np.pi * self.damping_frequency if self.assembly == "b" else self.damping_frequency
        damping = part["D1"] + (1.0 / speed - at_reference) * part["DR"] + speed * part["DG"] + part["D4"] / per
        stiffness = part["K1"] + part["KR"] + (speed**2 - at_reference) * part["KGEO"]
        return part["M"], damping, stiffness

    def system(self) -> System:
        """M q'' + C q' + K q = 0; friction is in the matrices already, so there are no contacts."""
        return System(*self.assembled())


@lru_cache(maxsize=2)
def read_matrices(folder: str) -> dict[str, Any]:
    """The eight matrices in a folder, by name, in compressed sparse rows; `ParameterError` where a file is missing."""
    from scipy.io import loadmat

    found = {}
    for name, stem in FILES.items():
        path = Path(folder) / f"{stem}00.mat"
        if not path.is_file():
            expected = (
                f"a folder that holds {', '.join(f'{stem}00.mat' for stem in FILES.values())}; {path.name} is missing"
            )
            raise ParameterError("PublishedDiscBrake", "folder", folder, expected)
        try:
            matrix = loadmat(str(path))[stem]
        except (KeyError, ValueError, NotImplementedError, TypeError, OSError) as error:
            raise ParameterError("PublishedDiscBrake", "folder", folder, f"a matrix {stem} in {path.name}") from error
        found[name] = sparse.csr_array(matrix)
    return found

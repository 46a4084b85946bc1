"""What of `complex_modes` can be set, for files, the command line and pages."""

from collections.abc import Mapping
from typing import ClassVar

from squealbox.parameters import DataSheet, Vector, parameter


class ModeSettings(DataSheet):
    """[modes]: complex eigenvalues of steady sliding."""

    told: ClassVar[Mapping[str, tuple[str, str]]] = {
        "certify": ("", "of a finite-element brake: prove by counting that no growing mode of the band is missing")
    }

    time: float = parameter("s", default=0.0, meaning="instant at which schedules are taken")
    band: Vector = parameter("Hz", 0.0, default=None, optional=True, meaning="of a finite-element brake: from, to")
    certify: bool = False

"""What of `complex_modes` can be set, for files, the command line and pages."""

from squealbox.parameters import DataSheet, Vector, above_zero, free, parameter


class ModeSettings(DataSheet):
    """[modes]: complex eigenvalues of steady sliding."""

    time: float = parameter("s", default=0.0, meaning="instant at which schedules are taken")
    band: Vector = above_zero(
        "Hz", default=None, ends=True, meaning="of a finite-element brake: lowest and highest frequency, 500 10kHz"
    )
    certify: bool = free(
        default=False,
        meaning="of a finite-element brake: prove by counting that no growing mode is missing",
    )

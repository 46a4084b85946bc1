"""What of `silence` can be set, for the command line."""

from squealbox.parameters import DataSheet, parameter


class SilenceSettings(DataSheet):
    """How cures are judged."""

    margin: float = parameter("-", 0.0, default=0.1, meaning="by which friction may rise without squeal: 0.1 is 10 %")
    samples: int | None = parameter(
        "-", 1, default=None, optional=True, meaning="brakes in the lot; left out, 2048, of large brakes fewer"
    )
    seed: int = parameter("-", 0, default=0, meaning="of the lot")

"""Draw the picture of the README: `make picture`."""

from pathlib import Path

import numpy as np

from squealbox import DrumBrake, complex_modes, plots, simulate, verdict


def main() -> None:
    """Frequencies and growth rates against friction, and one motion on either side of the onset."""
    brake = DrumBrake()
    friction = np.linspace(0.0, 0.6, 241)
    figure, axes = plots.panels(2, 2, height=4.6)
    plots.coalescence(friction, complex_modes(brake.replace({"friction.static": friction})), axes=axes[:, 0])
    for panel, static in zip(axes[:, 1], (0.30, 0.34), strict=True):
        motion = simulate(brake.replace({"friction.static": static}), duration=0.05)
        says = verdict(motion).kind.replace("_", " ")
        plots.time_history(motion, axes=panel, title=f"friction coefficient {static}: {says}")
    plots.save(figure, Path(__file__).with_name("drum_brake.png"), formats=("png",))


if __name__ == "__main__":
    main()

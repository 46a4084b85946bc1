"""Recompute every number of the paper and say where it stands: ``python docs/paper/recompute.py``."""

import sys
from pathlib import Path

from squealbox import DrumBrake, LinearSlope, complex_modes, critical_value, shooting, simulate

PAPER = Path(__file__).with_name("paper.md")


def numbers() -> dict[str, str]:
    """What stands in the paper, as it is computed now, by what it is."""
    drum = DrumBrake(friction=LinearSlope(0.45, -0.05))
    modes = complex_modes(drum)
    worst = int(modes.growth_rate.argmax())
    cycle = shooting(drum, start=simulate(drum, 0.05))
    onset, then = (critical_value(design, "friction.static", (0.0, 0.6)).value
                   for design in (drum, DrumBrake(reading="reconstructed")))  # fmt: skip
    return {
        "onset of the drum brake": f"unstable above a friction coefficient of {float(onset):.4f}",
        "its worst mode": f"grows at {modes.growth_rate[worst]:.1f} 1/s and {modes.frequency[worst]:.1f} Hz",
        "its limit cycle": f"{'stable' if cycle.stable else 'unstable'} limit cycle of {cycle.frequency:.1f} Hz",
        "amplitude": f"amplitude of {1e6 * max(cycle.amplitude):.1f} micrometres",
        "onset of the reconstruction": f"lose stability at {float(then):.4f}",
    }


def main() -> int:
    """Print each number and whether the paper has it; 1 where it has not."""
    words = " ".join(PAPER.read_text(encoding="utf-8").split())
    missing = 0
    for what, text in numbers().items():
        missing += text not in words
        print(f"{'as in the paper' if text in words else 'NOT in the paper'}: {what}: {text}")
    return int(missing > 0)


if __name__ == "__main__":
    sys.exit(main())

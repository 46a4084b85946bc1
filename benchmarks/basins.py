"""Basins of the drum of 2011 for both readings: shares and time, smallest pushes, and where two states coexist.

    python benchmarks/basins.py            all of it, about two minutes on two cores
    python benchmarks/basins.py --quick    2,000 starts instead of 10,000, coarse planes, no pushes

"To the end" is the same basin with every start run until it repeats itself (PILOT as large as the starts); the labels
of both are compared start by start. Times are wall and processor time after compilation.
"""

import argparse
import time

import numpy as np

from squealbox import DrumBrake, LinearSlope
from squealbox.limit_cycles import basin, coexistence, cycle_ends, dangerous_push
from squealbox.limit_cycles.attractors import basins

CASES = (("consistent", 0.30), ("eq3", 0.40), ("eq3", 0.43))
PLANES = {"consistent": (0.05, 0.40), "eq3": (0.10, 0.50)}


def drum(reading, static=0.3):
    """The drum with the assumed slope of -0.05 s/m."""
    return DrumBrake(friction=LinearSlope(static, -0.05), reading=reading)


def timed(call):
    """(result, wall time, processor time)."""
    wall, processor = time.perf_counter(), time.process_time()
    result = call()
    return result, time.perf_counter() - wall, time.process_time() - processor


def shares(starts):
    """Basins in a box of 2 V/w1 and 2 V about steady sliding."""
    for reading, static in CASES:
        brake = drum(reading, static)
        basin(brake, 2.0, 32)
        found, wall, processor = timed(lambda brake=brake: basin(brake, 2.0, starts))
        usual, basins.PILOT = basins.PILOT, starts
        ended, wall_ended, processor_ended = timed(lambda brake=brake: basin(brake, 2.0, starts))
        basins.PILOT = usual
        same = len(found.kind) == len(ended.kind) and int(np.sum(found.attractor != ended.attractor))
        print(f"\n{reading}, friction {static}: {found}")
        print(f"  {wall:.2f} s wall, {processor:.2f} s processor; to the end {wall_ended:.2f}, {processor_ended:.2f} s "
              f"({processor_ended / processor:.1f}); motion per start {1e3 * np.mean(found.time):.1f} and "
              f"{1e3 * np.mean(ended.time):.1f} ms; {same} labels differ")  # fmt: skip


def pushes():
    """The smallest push from steady sliding that ends in a vibration."""
    for reading, static in CASES[:2]:
        brake = drum(reading, static)
        found, wall, _ = timed(lambda brake=brake: dangerous_push(brake))
        print(f"\n{reading}, friction {static}: {found}\n  {wall:.1f} s wall")


def planes(columns, rows):
    """Coexistence over friction and load, each lower edge with the exact cycle's own end."""
    for reading, friction in PLANES.items():
        area = {"friction.static": friction, "load": (250.0, 4000.0)}
        region, wall, _ = timed(lambda r=reading, a=area: coexistence(drum(r), a, columns=columns, rows=rows, starts=8))
        value, kind = cycle_ends(drum(reading), region)
        print(f"\n{reading}: {region}\n  {wall:.1f} s wall\n  exact ends of the cycles followed:")
        for load, edge, exact, name in zip(region.y, region.end, value, kind, strict=True):
            print(f"  load {load:6.0f} N  edge {edge:8.5f}  exact {exact:9.6f}  {name}")


def main():
    """Print the tables."""
    reader = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    reader.add_argument("--quick", action="store_true")
    quick = reader.parse_args().quick
    shares(2000 if quick else 10_000)
    if not quick:
        pushes()
    planes(*((8, 3) if quick else (18, 6)))


if __name__ == "__main__":
    main()

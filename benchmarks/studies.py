"""What a sweep costs beside the bare analysis, and how it scales: python benchmarks/studies.py [--quick].

1. A million stability points stored end to end, against the same batched calls without a study.
2. A hundred thousand transients stored end to end, against the bare ensembles.
3. Peak memory of a sweep of 1e5 and of 1e6 points: bounded by the block, not by the study.
4. A Dask cluster of one and of two worker processes on this machine: speed-up, and the overhead of a piece.

Ratios of processor time where one process computes, of wall time where several do. The kill tests are
SQUEALBOX_KILLS=50 python -m pytest tests/faults/test_studies_killed.py.
"""

import argparse
import functools
import os
import re
import shutil
import socket
import subprocess
import sys
import tempfile
import time
from pathlib import Path

for _name in ("OPENBLAS_CORETYPE", "OPENBLAS_L2_SIZE"):  # they slow NumPy, and are read when it is loaded
    os.environ.pop(_name, None)

import numpy as np

from squealbox import DrumBrake, complex_modes, simulate_ensemble
from squealbox.studies import grid, sweep

BATCH = 16_384
MEMORY = """
import resource, sys
import numpy as np
from squealbox import DrumBrake, complex_modes
from squealbox.studies import sweep
space = {"friction.static": np.linspace(0.1, 0.5, int(sys.argv[1])), "load": np.linspace(1e3, 2e3, 100)}
table = sweep(DrumBrake(), space, complex_modes, out=sys.argv[2], chunk=8192)
assert table.outcome.ok
print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024)
"""


def clocks():
    return time.process_time(), time.perf_counter()


def measured(label, bare, stored, count):
    """Processor and wall time of both, and what the study adds."""
    rows = []
    for work in (bare, stored):
        cpu, wall = clocks()
        work()
        rows.append([b - a for a, b in zip((cpu, wall), clocks(), strict=True)])
    (bare_cpu, bare_wall), (cpu, wall) = rows
    print(f"{label}: bare {bare_cpu:.2f} s of processor ({bare_wall:.2f} s), stored {cpu:.2f} s ({wall:.2f} s)")
    print(f"  the study costs {100.0 * (cpu / bare_cpu - 1.0):+.1f} % of processor time, asked: under 10 %")
    print(f"  {1e6 * cpu / count:.2f} us of processor time a point")


def stability(folder, count):
    drum = DrumBrake()
    space = grid({"friction.static": np.linspace(0.1, 0.5, count // 1000), "load": np.linspace(1e3, 2e3, 1000)})

    def bare():
        for start in range(0, count, BATCH):
            complex_modes(drum.replace(space.points(start, min(start + BATCH, count)))).columns()

    sweep(drum, {"load": [1e3, 2e3]}, complex_modes, out=folder / "warm")  # loads xarray and HDF5
    whole = functools.partial(sweep, drum, space, complex_modes, out=folder / "modes", chunk=BATCH)
    measured(f"{count} stability points", bare, whole, count)


def transients(folder, count):
    drum = DrumBrake()
    space = grid({"friction.static": np.linspace(0.1, 0.4, count // 100), "load": np.linspace(1e3, 2e3, 100)})
    ask = functools.partial(simulate_ensemble, duration=0.02, observe=("amplitude", "frequency"))
    sweep(drum, {"load": [1e3, 2e3]}, ask, out=folder / "warm_motions")  # compiles, loads xarray and HDF5

    def bare():
        for start in range(0, count, BATCH):
            ask(drum.replace(space.points(start, min(start + BATCH, count))))

    measured(f"{count} transients", bare, lambda: sweep(drum, space, ask, out=folder / "motions", chunk=BATCH), count)


def memory(folder, lines):
    found = {}
    for count in lines:
        words = [sys.executable, "-c", MEMORY, str(count), str(folder / f"memory{count}")]
        found[count] = float(subprocess.run(words, capture_output=True, text=True, check=True).stdout)
    sizes = ", ".join(f"{100 * count} points {value:.0f} MiB" for count, value in found.items())
    stored = (folder / f"memory{lines[-1]}" / "sweep.nc").stat().st_size / 2**20
    print(f"peak memory in blocks of 8192: {sizes}; the larger file has {stored:.0f} MiB")


def busy(design):
    """A piece of Python work of about a millisecond that holds its core."""
    total = 0.0
    for i in range(12_000):
        total += (i * design.load1) % 7.0
    return total


def cluster(folder, count):
    walls = {}
    for workers in (1, 2):
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            port = free.getsockname()[1]
        address = f"tcp://127.0.0.1:{port}"
        start = [sys.executable, "-m", "distributed.cli.dask_"]
        quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL, "cwd": folder}
        scheduler = [*start[:2], f"{start[2]}scheduler", "--host", "127.0.0.1", "--port", str(port), "--no-dashboard"]
        worker = [*start[:2], f"{start[2]}worker", address, "--nthreads", "1", "--no-dashboard"]
        processes = [subprocess.Popen(scheduler, **quiet), *(subprocess.Popen(worker, **quiet) for _ in range(workers))]
        try:
            from distributed import Client

            with Client(address, timeout=60) as client:
                client.wait_for_workers(workers, timeout=60)
            out = folder / f"dask{workers}"
            sweep(DrumBrake(), {"load": np.arange(8.0)}, busy, scheduler=address)  # imports on the workers
            sweep(DrumBrake(), {"load": np.arange(float(count))}, busy, scheduler=address, out=out)
            log = (out / "run.log").read_text()
            walls[workers] = float(re.search(r"pieces computed in ([0-9.]+) s", log)[1])
            print(f"Dask, {workers} worker(s): {log.splitlines()[-2].partition('  ')[2]}")
        finally:
            for process in processes:
                process.terminate()
            for process in processes:
                process.wait()
    print(f"Dask: 2 worker processes are {walls[1] / walls[2]:.2f} times one, asked: 1.7")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="a tenth of the points")
    parser.add_argument("--only", choices=("stability", "transients", "memory", "cluster"))
    asked = parser.parse_args()
    share = 10 if asked.quick else 1
    folder = Path(tempfile.mkdtemp(prefix="squealbox-studies-"))
    try:
        parts = {
            "stability": lambda: stability(folder, 1_000_000 // share),
            "transients": lambda: transients(folder, 100_000 // share),
            "memory": lambda: memory(folder, (1000, 10_000 // (share if share == 1 else 3))),
            "cluster": lambda: cluster(folder, 20_000 // share),
        }
        for name, part in parts.items():
            if asked.only in (None, name):
                part()
    finally:
        shutil.rmtree(folder, ignore_errors=True)


if __name__ == "__main__":
    main()

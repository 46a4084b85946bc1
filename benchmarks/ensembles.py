"""Ensembles of drum transients against every rival there is: one run, ratios with their spread.

a) plain sgn with Bogacki-Shampine 3(2) at rtol 1e-3: SciPy's RK23 with a NumPy right-hand side, CyRK's compiled RK23
   when installed, the scalar `simulate`, and lanes.cpp, which g++ compiles here.
b) exact stick and slip on a map of pressure centres: rate, error, slowest over median.
c) two cores against one. d) a law of one's own and Stribeck's. e) ten degrees of freedom and six contacts.
f) memory of many trajectories. g) share of the processor's measured peak.

Times are of the processor unless said otherwise, after one run that compiles. `--quick` takes less of everything;
letters choose parts (g comes with a, c with b).
"""

import ast
import ctypes
import importlib.util
import os
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np
from transient import DURATION, SLOPE, right_hand_side, seconds

from squealbox import (
    Contact,
    DrumBrake,
    LinearSlope,
    Method,
    Stribeck,
    System,
    own_law,
    simulate,
    simulate_ensemble,
)
from squealbox.transient._motion import RAW
from squealbox.transient.lanes.formulas import formulas
from squealbox.transient.lanes.shape import parameter_rows
from squealbox.transient.lanes.step_text import Step
from squealbox.transient.lanes.table import tabulate

QUICK = "--quick" in sys.argv[1:]
REPETITIONS = 3 if QUICK else 7
RAW_OPTIONS = {"contact": "raw", "method": "bogacki-shampine", "rtol": 1e-3}
ASKED = {"SciPy RK23": "; asked 10,000", "CyRK RK23": "; asked 20", "C++ by hand": "; asked 0.8"}
FLAGS = (
    "-O3 -march=native -mprefer-vector-width=512 -ffp-contract=fast -fno-math-errno -fno-trapping-math -shared -fPIC"
)


def spread(theirs, ours):
    """Ratio of medians with the range that both spreads allow."""
    low, high = np.min(theirs) / np.max(ours), np.max(theirs) / np.min(ours)
    return f"{np.median(theirs) / np.median(ours):9.2f} (from {low:.2f} to {high:.2f})"


def drum(friction, **others):
    """The drum in reading `consistent`."""
    return DrumBrake(friction=LinearSlope(friction, SLOPE), **others)


def compiled():
    """The C++ library, or None without a compiler."""
    compiler = shutil.which("g++")
    if compiler is None:
        return None
    target = Path(tempfile.mkdtemp()) / "lanes.so"
    subprocess.run(
        [compiler, *FLAGS.split(), "-o", str(target), str(Path(__file__).with_name("lanes.cpp"))], check=True
    )
    library = ctypes.CDLL(str(target))
    library.peak.restype, library.given.restype = ctypes.c_double, ctypes.c_int64
    library.peak.argtypes = [ctypes.c_int64, ctypes.c_double]
    pointer = ctypes.POINTER(ctypes.c_double)
    library.run.argtypes = [pointer, ctypes.c_int64, ctypes.c_double, ctypes.c_double, pointer]
    library.run.restype = None
    return library


def jobs_of(system):
    """The raw jobs of a batched system as the engine tabulates them."""
    start = (np.zeros(2), np.zeros(2))
    method = Method("bogacki-shampine", rtol=1e-3)
    return tabulate(system, method, RAW, 1e-3, start, DURATION, 0.0, (), (), False)


def table_of(jobs):
    """All parameters of all jobs, in the order lanes.cpp expects."""
    pairs = [f"{i}_{j}" for i in range(2) for j in range(2)]
    order = [f"mk{x}" for x in pairs] + ["mc0_0", "mc1_1"] + [f"{name}{x}" for name in ("md", "t", "n") for x in pairs]
    order += ["N00", "N01", "V0", "V1", "f0", "f1", *(f"law{c}_{i}" for c in range(2) for i in range(3))]
    order += [*(f"start{k}" for k in range(4)), *(f"atol{k}" for k in range(4)), "rtol", "largest", "least", "first"]
    names = parameter_rows(jobs.shape)
    out = np.zeros((len(jobs.table), len(order)))
    for k, name in enumerate(order):
        row = names.index(name)
        out[:, k] = jobs.table[:, jobs.varies[row]] if jobs.varies[row] >= 0 else jobs.fixed[3 + row]
    return out


def by_hand(library, table):
    """What lanes.cpp makes of the table: (jobs, 7) of time, accepted, tried, q, qd."""
    out = np.zeros((len(table), 7))
    pointer = ctypes.POINTER(ctypes.c_double)
    library.run(table.ctypes.data_as(pointer), len(table), DURATION, 2e6, out.ctypes.data_as(pointer))
    return out


def numba_rates(system):
    """y' for CyRK: scalar arithmetic on constants, compiled."""
    inverse = np.linalg.inv(system.M)
    k, c, f = inverse @ system.K, inverse @ system.C, inverse @ system.load
    one, two = system.contacts
    p1, p2, n1, n2, t1, t2 = inverse @ one.d, inverse @ two.d, one.n, two.n, one.t, two.t
    static, slope, load1, load2 = float(one.law.static), float(one.law.slope), float(one.N0), float(two.N0)
    speed1, speed2 = float(one.V), float(two.V)

    def rates(dy, t, y, args):
        u = speed1 - t1[0] * y[2] - t1[1] * y[3]
        w = speed2 - t2[0] * y[2] - t2[1] * y[3]
        force1 = (static + slope * abs(u)) * np.sign(u) * (load1 + n1[0] * y[0] + n1[1] * y[1])
        force2 = (static + slope * abs(w)) * np.sign(w) * (load2 + n2[0] * y[0] + n2[1] * y[1])
        dy[0] = y[2]
        dy[1] = y[3]
        dy[2] = f[0] - k[0, 0] * y[0] - k[0, 1] * y[1] - c[0, 0] * y[2] + p1[0] * force1 + p2[0] * force2
        dy[3] = f[1] - k[1, 0] * y[0] - k[1, 1] * y[1] - c[1, 1] * y[3] + p1[1] * force1 + p2[1] * force2

    return rates


def cyrk(system, atol, method="RK23", rtol=1e-3):
    """A run of CyRK's C++ solver with a compiled right-hand side."""
    from CyRK import nb_diffeq_addr, nbsolve2_ivp

    address = nb_diffeq_addr(numba_rates(system))
    start = np.zeros(4)
    return lambda: nbsolve2_ivp(address, (0.0, DURATION), start, method=method, rtol=rtol, atols=atol)


def raw(library):
    """Part a, and g for the raw kernel."""
    from scipy.integrate import solve_ivp

    count = 4_096 if QUICK else 16_384
    print(f"a) plain sgn, rtol 1e-3, {DURATION} s, same atol; {count} trajectories, one thread, times per trajectory")
    for friction in (0.3, 0.45):
        frictions = friction + np.linspace(-5e-3, 5e-3, count)
        brake = drum(friction)
        varied = {"friction.static": frictions}

        def many(brake=brake, varied=varied):
            return simulate_ensemble(brake, varied, DURATION, observe=(), threads=1, **RAW_OPTIONS)

        found = many()
        ours = seconds(many, REPETITIONS) / count
        ended = dict(zip(*np.unique(found.ended, return_counts=True), strict=True))
        slowest = np.max(found.tried) / np.median(found.tried)
        print(f"mu {friction:<5} ensemble {1e6 * np.median(ours):.2f} us ({np.min(ours) * 1e6:.2f} at best); "
              f"tried steps: median {np.median(found.tried):.0f}, slowest {slowest:.2f} times that; "
              + ", ".join(f"{n} {name}" for name, n in ended.items()))  # fmt: skip
        rivals = {}
        scipy_times, cyrk_times = [], []
        for each in frictions[:: count // (3 if QUICK else 6)]:
            system = drum(each).system()
            atol = np.array(simulate(system, DURATION, **RAW_OPTIONS).settings["atol"])
            rates = right_hand_side(system)
            scipy_times += list(seconds(
                lambda r=rates, a=atol: solve_ivp(r, (0.0, DURATION), np.zeros(4), method="RK23", rtol=1e-3, atol=a), 1
            ))  # fmt: skip
            if importlib.util.find_spec("CyRK"):
                cyrk_times += list(seconds(cyrk(system, atol), 20))
        rivals["SciPy RK23"] = np.array(scipy_times)
        rivals["scalar simulate"] = seconds(lambda b=brake: simulate(b, DURATION, **RAW_OPTIONS), 20)
        rivals["CyRK RK23"] = np.array(cyrk_times) if cyrk_times else None
        if library is not None:
            table = table_of(jobs_of(brake.replace(varied).system()))
            assert table.shape[1] == library.given()
            hand = by_hand(library, table)
            rivals["C++ by hand"] = seconds(lambda t=table: by_hand(library, t), REPETITIONS) / count
        for name, times in rivals.items():
            if times is None:
                print(f"   {name:<16} is not installed")
            else:
                ratio = spread(times, ours) + ASKED.get(name, "")
                print(f"   {name:<16}{1e6 * np.median(times):12.2f} us   over ours {ratio}")
        if library is not None:
            size = np.max(np.abs(found.q))
            near = np.mean(np.max(np.abs(hand[:, 3:5] - found.q), axis=1) < 1e-2 * size)
            print(f"   C++ tried {np.sum(hand[:, 2]) / np.sum(found.tried):.4f} of our steps; end states within 1 % "
                  f"in {100 * near:.0f} % of trajectories (sgn flips part the others)")  # fmt: skip
            same_as_by_hand(library, friction)
            share(library, found, np.median(ours) * count)


def same_as_by_hand(library, friction):
    """A start too short for sgn to flip: both kernels give one answer."""
    global DURATION
    whole, DURATION = DURATION, 2e-5
    try:
        frictions = friction + np.linspace(-5e-3, 5e-3, 64)
        found = simulate_ensemble(drum(friction), {"friction.static": frictions}, DURATION, observe=(), **RAW_OPTIONS)
        hand = by_hand(library, table_of(jobs_of(drum(friction).replace({"friction.static": frictions}).system())))
        apart = np.max(np.abs(hand[:, 3:5] - found.q)) / np.max(np.abs(found.q))
        print(f"   largest difference to C++ after {DURATION} s: {apart:.1e} of the largest displacement")
    finally:
        DURATION = whole


def operations(shape):
    """Additions, products and divisions of one trial of one lane, counted in the generated text."""
    counts = {}
    for text in (*formulas(shape), Step(shape).text()):
        function = ast.parse(text).body[0]
        nodes = list(ast.walk(function))
        kinds = (ast.Add, ast.Sub, ast.Mult, ast.Div)
        sums = [n for n in nodes if isinstance(n, ast.BinOp) and isinstance(n.op, kinds)]
        own = sum(not (isinstance(n.left, ast.Name) and n.left.id == "b") for n in sums)  # b + place is an address
        called = [n.func.id for n in nodes if isinstance(n, ast.Call) and isinstance(n.func, ast.Name)]
        counts[function.name] = own + sum(counts.get(name, 0) for name in called)
    return counts["trial"]


def peak_rate(library):
    """Measured peak of one core [flop/s], the best of five."""
    turns, best = 20_000_000, 0.0
    for _ in range(5):
        start = time.process_time()
        done = library.peak(turns, 1.0)
        best = max(best, done / (time.process_time() - start))
    return best


def share(library, found, spent):
    """Part g: of the measured peak, by the operations of the generated text and the steps tried."""
    flop = operations(jobs_of(drum(0.3).replace({"friction.static": np.array([0.3, 0.31])}).system()).shape)
    rate, peak = flop * np.sum(found.tried) / spent, peak_rate(library)
    print(f"   g) {flop} operations a trial: {rate / 1e9:.1f} Gflop/s, {100 * rate / peak:.0f} % of the measured peak")
    print(f"      of {peak / 1e9:.1f} Gflop/s")


def mapped(side, reading, preload):
    """The drum over both centres of pressure: the published zone and as much around it."""
    theta1, theta2 = np.meshgrid(np.deg2rad(np.linspace(95, 175, side)), np.deg2rad(np.linspace(10, 50, side)))
    system = drum(0.44, reading=reading, theta1=theta1, theta2=theta2).system()
    if preload is None:
        return system
    return system.replace({"contacts": tuple(c.replace({"N0": preload}) for c in system.contacts)})


def exact():
    """Part b and c."""
    side = 32 if QUICK else 64
    print(f"\nb) exact, {side} x {side} pressure centres, mu 0.44, {DURATION} s, one thread; error of the end state "
          "against rtol 1e-11,\n   relative to the largest displacement of the trajectory")  # fmt: skip
    print(f"{'reading':<12}{'N0':>6}  {'method':<17}{'rtol':>7}{'per s':>8}{'from':>7}{'to':>7}{'median':>9}{'90 %':>9}"
          f"{'largest':>9}{'slowest':>9}{'stick':>7}  ended")  # fmt: skip
    drums = (("eq3", 1000.0), ("consistent", None))
    cases = [(*drum, method) for drum in drums for method in ("taylor", "dormand-prince-8")]
    cases += [] if QUICK else [(*drum, "tsitouras") for drum in drums]
    for reading, preload, method in cases:
        system = mapped(side, reading, preload)
        sheet = {"observe": ("peak", "sticking"), "threads": 1}
        truth = simulate_ensemble(system, None, DURATION, "dormand-prince-8", rtol=1e-11, **sheet)
        largest = np.max(truth["peak"], axis=-1)
        for rtol in (1e-5, 1e-7) if QUICK else (1e-4, 1e-5, 1e-6, 1e-7, 1e-8):
            found = simulate_ensemble(system, None, DURATION, method, rtol=rtol, **sheet)
            spent = seconds(
                lambda s=system, m=method, r=rtol: simulate_ensemble(
                    s, None, DURATION, m, rtol=r, observe=(), threads=1
                ),
                2 if QUICK else 3,
            )
            rate = side * side / spent
            both = (found.ended == "completed") & (truth.ended == "completed")
            error = (np.max(np.abs(found.q - truth.q), axis=-1) / largest)[both]
            failed = np.sum(~both)
            stick = np.max(found["sticking"], axis=-1)
            slowest = np.max(found.tried) / np.median(found.tried)
            said = "all completed" if failed == 0 else f"{failed} not completed"
            print(f"{reading:<12}{preload or 0:>6.0f}  {method:<17}{rtol:>7.0e}{np.median(rate):>8.0f}"
                  f"{np.min(rate):>7.0f}{np.max(rate):>7.0f}{np.median(error):>9.0e}"
                  f"{np.quantile(error, 0.9):>9.0e}{np.max(error):>9.0e}"
                  f"{slowest:>9.1f}{100 * np.mean(stick > 0):>6.0f}%  {said}")  # fmt: skip
    print("   asked: more than 5,000 per second and core at errors below 1e-5; slowest at most 10 times the median")
    cores(system)


def cores(system):
    """Part c."""
    times = {1: [], 2: []}
    for _ in range(3 if QUICK else 7):
        for threads, spent in times.items():
            start = time.perf_counter()
            simulate_ensemble(system, None, DURATION, rtol=1e-7, observe=(), threads=threads)
            spent.append(time.perf_counter() - start)
    print(f"\nc) two threads against one, wall clock, load of the machine {os.getloadavg()[0]:.1f}: "
          f"{spread(np.array(times[1]), np.array(times[2]))}; asked 1.8")  # fmt: skip


def per_trial(system, duration, threads=1):
    """Processor time of each tried step of a lane [s]."""
    found = simulate_ensemble(system, None, duration, rtol=1e-7, observe=(), threads=threads)
    run = seconds(
        lambda: simulate_ensemble(system, None, duration, rtol=1e-7, observe=(), threads=threads), REPETITIONS
    )
    return run / np.sum(found.tried), run


STRIBECK = "def mu(v, p):\n    return p[1] + (p[0] - p[1]) * np.exp(-v / p[2])\n"


def laws():
    """Part d: the same steps of the same brake under three laws."""
    angles = np.deg2rad(np.linspace(30.0, 40.0, 2_048))
    brake = DrumBrake(theta1=angles)
    line = brake.replace(friction=LinearSlope(0.3, SLOPE)).system()
    curve = brake.replace(friction=Stribeck(0.3, 0.29, 0.2)).system()
    own = brake.replace(friction=own_law(STRIBECK, numbers=(0.29, 0.2), static=0.3)).system()
    simulate_ensemble(own, None, 1e-3, observe=())
    cost = {name: per_trial(s, 0.02) for name, s in (("line", line), ("curve", curve), ("own", own))}
    print(f"\nd) per tried step: Stribeck over LinearSlope {spread(cost['curve'][0], cost['line'][0])}; asked 2.2")
    print(
        f"   the same Stribeck as a plain function over built in {spread(cost['own'][0], cost['curve'][0])}; asked 1.1"
    )
    if not QUICK:
        with tempfile.TemporaryDirectory() as fresh:
            text = f"import time; import numpy as np; from squealbox import *; law = own_law({STRIBECK!r}, " \
                "numbers=(0.29, 0.2), static=0.3); start, spent = time.perf_counter(), time.process_time(); " \
                "simulate_ensemble(DrumBrake(friction=law), {'theta1': [0.6, 0.61]}, 1e-4, observe=()); " \
                "print(time.perf_counter() - start, time.process_time() - spent)"  # fmt: skip
            for what in ("compiled for the first time", "read from disk"):
                said = subprocess.run([sys.executable, "-c", text], env={**os.environ, "SQUEALBOX_CACHE": fresh},
                                      capture_output=True, text=True, check=True)  # fmt: skip
                wall, spent = map(float, said.stdout.split())
                print(f"   {what}: {spent:.1f} s of the processor, {wall:.1f} s of wall clock; asked 10 s cold")


def chain(size, contacts, count):
    """Masses joined by springs, the first ones on belts; a lightly varied batch."""
    law = LinearSlope(0.3, SLOPE)
    stiff = 2e7 * (2.5 * np.eye(size) - np.eye(size, k=1) - np.eye(size, k=-1))
    rows = np.eye(size)
    touching = tuple(Contact(0.2e7 * np.roll(rows[c], 1), rows[c], rows[c], 500.0, 0.2, law) for c in range(contacts))
    stiffness = stiff * (1.0 + 1e-3 * np.linspace(0.0, 1.0, count))[:, None, None]
    return System(np.eye(size), 5e-6 * stiff, stiffness, 0.0, touching)


def sizes():
    """Part e: what a step costs for each degree of freedom."""
    small, large = (per_trial(chain(n, m, 512), 5e-3)[0] / n for n, m in ((2, 2), (10, 6)))
    print(f"\ne) tried step per degree of freedom, 10 with 6 contacts over 2 with 2: {spread(large, small)}; asked 3")


MEMORY = """
import sys
import numpy as np
from squealbox import DrumBrake, simulate_ensemble


def peak():  # of this program; getrusage would count that of the one which started it
    line = next(line for line in open("/proc/self/status") if line.startswith("VmHWM"))
    return int(line.split()[1]) / 2**10


simulate_ensemble(DrumBrake(), {"friction.static": np.linspace(0.1, 0.4, 100)}, 1e-4)
before = peak()
found = simulate_ensemble(DrumBrake(), {"friction.static": np.linspace(0.1, 0.4, int(sys.argv[1]))}, 1e-4)
print(before, peak(), found.seconds, found.outcome)
"""


def memory():
    """Part f."""
    count = 1_000_000
    said = subprocess.run([sys.executable, "-c", MEMORY, str(count)], capture_output=True, text=True, check=True)
    before, after, spent, outcome = said.stdout.split()
    print(f"\nf) {count} trajectories of 1e-4 s: peak {float(after):.0f} MiB, {float(before):.0f} before; asked 1024; "
          f"{float(spent):.1f} s of wall clock, {outcome}")  # fmt: skip


def main():
    """Print all parts."""
    library = compiled()
    if library is None:
        print("no g++: without the kernel by hand and the share of the peak")
    parts = {"a": lambda: raw(library), "b": exact, "d": laws, "e": sizes, "f": memory}
    asked = [name for name in sys.argv[1:] if name in parts] or list(parts)
    for name in asked:
        parts[name]()


if __name__ == "__main__":
    main()

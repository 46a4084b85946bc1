"""Finite-element brakes: what each stage costs, what the basis misses, and whether a hidden mode is found.

    python benchmarks/finite_elements.py small              the own disc brake at about 15,000 degrees of freedom
    python benchmarks/finite_elements.py middle             at about 36,000; `large`: at about 100,000; or elements [m]
    python benchmarks/finite_elements.py published FOLDER   the published brake of 4,669 degrees of freedom
    ... alone                                               complex_modes without a reduction, and its table
    ... full                                                beside the full quadratic problem
    ... hidden                                              20 trials with a mode left out of the basis, 20 without
    python benchmarks/finite_elements.py contacts           60 coordinates with 100, 300 and 1,000 contacts

One process, one thread; times are processor time. The last line is the peak memory.
"""

import os

for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS", "RAYON_NUM_THREADS"):
    os.environ.setdefault(name, "1")

import resource
import sys
import time

import numpy as np

from squealbox import (
    Contact,
    Coulomb,
    PublishedDiscBrake,
    System,
    complex_modes,
    linearise,
    reduce,
    simulate,
    simulate_ensemble,
)
from squealbox.fe import certificate, full_modes, pencil_of
from squealbox.fe.certificates import certified_band
from squealbox.fe.disc_brake import DiscBrake
from squealbox.fe.growing_basis import GrowingBasis
from squealbox.fe.projection import modes_on
from squealbox.stability.modes_in_band import known_eigenvalues

BAND = (500.0, 10e3)
FRICTIONS = np.linspace(0.1, 0.6, 50)
SIZES = {"small": 0.0145, "middle": 0.009, "large": 0.0059}  # longest side of an element [m]
TRIALS = 20


class Clock:
    """Processor seconds between two laps."""

    def __init__(self) -> None:
        self.last = self.start = time.process_time()

    def lap(self, what: str, count: int = 1) -> float:
        now = time.process_time()
        spent, self.last = (now - self.last) / count, now
        print(f"{what:<62}{spent:>10.3f} s", flush=True)
        return spent


def matched(values, others) -> np.ndarray:
    """Distance of each value to the nearest of the others [1/s]."""
    return np.array([np.min(np.abs(others - value)) for value in values])


def beside_the_full_problem(pencil, found, clock: Clock) -> float:
    full = full_modes(pencil, BAND)
    spent = clock.lap(f"full quadratic problem, {len(full.eigenvalues)} modes, {full.factorisations} shifts")
    off = matched(found.eigenvalues, full.eigenvalues)
    corrected = matched(found.eigenvalues + found.error, full.eigenvalues)
    growth = np.array(
        [full.eigenvalues[np.argmin(np.abs(full.eigenvalues - v))].real - v.real for v in found.eigenvalues]
    )
    ratio = np.abs(found.error) / off
    print(f"  modes in the band: {len(found.eigenvalues)} on the basis, {len(full.eigenvalues)} in full")
    print(f"  backward error of the full problem: {np.max(full.backward_error):.1e}")
    print(f"  largest error of an eigenvalue {np.max(off):.3g} 1/s, of a growth rate {np.max(np.abs(growth)):.3g} 1/s")
    print(f"  after adding the estimate {np.max(corrected):.3g} 1/s")
    print(f"  estimate / error, 5-50-95 %: {np.round(np.quantile(ratio, [0.05, 0.5, 0.95]), 2)}")
    print(f"  within 0.5 to 1.5: {np.mean((ratio > 0.5) & (ratio < 1.5)):.0%}")
    return spent


def hidden_modes(small, points, clock: Clock) -> None:
    """At TRIALS points once with the whole basis, and once without the shape of a growing mode, right and left."""
    random, trials, found, false, most = np.random.default_rng(1), 0, 0, 0, 0
    for point in points:
        if trials == TRIALS:
            break
        brake = small.replace(point)
        full, phases = brake.full, {}
        pencil = full.pencil(brake.present())
        whole = projected(pencil, full.basis, full.base)
        growing = np.flatnonzero(whole.eigenvalues.real > np.abs(whole.error))
        if not len(growing):
            continue  # there is none to hide
        trials += 1
        proof = counted(pencil, whole, phases)
        hidden = random.choice(growing)
        less = projected(pencil, without(pencil, full.basis, whole, hidden), full.base)
        doubt = counted(pencil, less, phases)
        false, found = false + (not proof.certified), found + (doubt.missing is not None and doubt.missing > 0)
        most = max(most, proof.factorisations, doubt.factorisations)
        what = f"{whole.eigenvalues[hidden].imag / (2.0 * np.pi):.0f} Hz hidden"
        clock.lap(f"trial {trials}: whole {proof.missing}, {what} {doubt.missing}, {proof.factorisations} and "
                  f"{doubt.factorisations}"[:60])  # fmt: skip
    print(f"  {found} of {trials} hidden modes found, {false} false alarms, at most {most} factorisations")


def counted(pencil, found, phases):
    known, others = known_eigenvalues(found)
    return certificate(pencil, known, BAND, believed=others, phases=phases)


def projected(pencil, basis, base):
    return modes_on(GrowingBasis([pencil], basis), 0, base, certified_band(BAND))[0]


def without(pencil, basis, found, hidden: int):
    """The basis less its directions along the right shape of one mode; what is left has V' M V = I."""
    shape = found.x[:, [hidden]]
    gone = np.linalg.qr(np.concatenate([shape.real, shape.imag], axis=1))[0]
    rest = np.linalg.svd(np.eye(len(shape)) - gone @ gone.T)[0][:, : len(shape) - 2]
    return basis @ rest


def many_contacts(clock: Clock) -> None:
    """Steady sliding, motion and ensembles of a brake of modal coordinates, in contacts."""
    random, rate = np.random.default_rng(1), 2.0 * np.pi * np.linspace(500.0, 8000.0, 60)
    push, many = np.r_[0.05, np.zeros(59)], {"friction.static": np.linspace(0.3, 0.5, 4)}
    for count in (100, 300, 1000):
        n, t = random.standard_normal((count, 60)), 0.3 * random.standard_normal((count, 60))
        how = {"N0": 5e3 / count, "V": 2.0, "law": Coulomb(0.4), "unilateral": True}
        contacts = [Contact(n=1e6 / count * a, d=b, t=b, normal=a, **how) for a, b in zip(n, t, strict=True)]
        stiffness = np.diag(rate**2) + 1e6 / count * n.T @ n
        brake = System(np.eye(60), np.diag(0.006 * rate), stiffness, 0.0, contacts)
        clock.lap(f"{count} contacts made")
        start = linearise(brake).equilibrium.q, push
        clock.lap(f"{count} contacts: equilibrium and linearisation")
        for contact in ("exact", "time-stepping") if count == 100 else ("time-stepping",):
            for turn in ("first", "again"):
                simulate(brake, 1e-3, start, contact=contact)
                clock.lap(f"{count} contacts: 1 ms by {contact} contact, {turn}")
        if count == 100:
            simulate_ensemble(brake, many, 1e-3, start=start)
            clock.lap("100 contacts: 1 ms of an ensemble of 4, compilation among it")


def main(words: list[str]) -> None:
    clock = Clock()
    if "published" in words:
        folder = words[words.index("published") + 1]
        brake = PublishedDiscBrake(folder=folder, assembly="b", angular_speed=2.0 * np.pi)
        varying = {"angular_speed": (2.0 * np.pi, 4.0 * np.pi)}
        points = [{"angular_speed": value} for value in np.linspace(2.0 * np.pi, 4.0 * np.pi, 50)]
    else:
        given = next((float(word) for word in words if word.replace(".", "").isdigit()), SIZES["small"])
        size = next((SIZES[word] for word in words if word in SIZES), given)
        brake = DiscBrake(element_size=size)
        varying = {"friction.static": (float(FRICTIONS[0]), float(FRICTIONS[-1]))}
        points = [{"friction.static": float(value)} for value in FRICTIONS]
    system = brake.system()
    clock.lap(f"mesh and matrices, {system.size} degrees of freedom, {len(system.contacts)} points")
    small = reduce(brake, BAND, varying=varying)
    clock.lap(f"reduced to {len(small.reduction.arrays['M'])} coordinates, error {small.error:.2g} 1/s")
    swept = [complex_modes(small.replace(point)).unstable_modes for point in points]
    each = clock.lap(f"one more value of {next(iter(varying))}, {min(swept)} to {max(swept)} modes grow", len(points))
    print(f"{'from nothing to the sweep':<62}{clock.last - clock.start:>10.3f} s")
    print(f"peak memory up to here {resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6:.2f} GB", flush=True)
    if "alone" in words:
        modes = complex_modes(brake, band=BAND)
        clock.lap(f"complex modes of the brake alone, {len(modes.eigenvalues) // 2}")
        print(modes.summary())
    if "full" in words:
        pencil, found = pencil_of(system), small.checked()
        clock.lap("error of every mode at one point")
        spent = beside_the_full_problem(pencil, found, clock)
        print(f"  a further value is 1/{spent / each:.0f} of the full problem")
    if "hidden" in words:
        hidden_modes(small, points[::-2] + points[-2::-2], clock)
    print(f"peak memory {resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6:.2f} GB")


if __name__ == "__main__":
    many_contacts(Clock()) if "contacts" in sys.argv[1:] else main(sys.argv[1:])

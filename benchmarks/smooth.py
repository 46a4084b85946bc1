"""Motion without any event: heyoka's batch of Taylor methods beside ours, one thread, time at equal error.

The brake is the drum, reading `consistent`, mu 0.1 to 0.101: both contacts slip forward all the time, so nothing but
the integration is compared. Errors are those of the end state against our rtol 1e-13, relative to the largest
displacement, in the median. Times are of the processor and per trajectory, after one run that compiles. Each program
runs at many tolerances, its own; the time at a given error lies on the line between its two neighbours, on logarithmic
axes, or is that of the loosest tolerance where even that is more exact. heyoka runs as it recommends for the processor,
and in the fastest of its wider batches, with 512-bit registers and free rounding. Motion with events is compared in
`rivals.py`.
"""

import ensembles
import heyoka as hy
import numpy as np
from transient import SLOPE

from squealbox import DrumBrake, LinearSlope, simulate_ensemble

DURATION, COUNT = 0.05, 4_096
TOLERANCES = (1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12)
ERRORS = (1e-5, 1e-7, 1e-9, 1e-11)
WIDER = [{"width": w, "force_avx512": True, "fast_math": f} for w in (8, 16) for f in (False, True)]


def equation(system):
    """The drum for heyoka with the friction at rest as its only parameter."""
    q, v = hy.make_vars("q0", "q1"), hy.make_vars("v0", "v1")
    force = [float(f) for f in system.load]
    for c in system.contacts:
        speed = float(c.V) - sum(float(t) * x for t, x in zip(c.t, v, strict=True))
        normal = float(c.N0) + sum(float(n) * x for n, x in zip(c.n, q, strict=True))
        sense = float(np.sign(c.V))
        pull = sense * (hy.par[0] + c.law.slope * sense * speed) * normal
        force = [f + float(d) * pull for f, d in zip(force, c.d, strict=True)]
    for i in range(2):
        for j in range(2):
            force[i] = force[i] - float(system.C[i, j]) * v[j] - float(system.K[i, j]) * q[j]
    return [(q[i], v[i]) for i in range(2)] + [(v[i], force[i] / float(system.M[i, i])) for i in range(2)]


def by_heyoka(system, frictions, rtol, width, **settings):
    """A function that runs all drums in batches of a width."""
    ta = hy.taylor_adaptive_batch(equation(system), np.zeros((4, width)), tol=rtol, **settings)

    def run():
        out = []
        for first in range(0, frictions.size, width):
            ta.set_time(0.0)
            ta.state[:], ta.pars[:] = 0.0, frictions[first : first + width]
            ta.propagate_until(DURATION)
            out.append(ta.state[:2].T.copy())
        return np.concatenate(out)

    return run


def curve(name, make, truth, largest):
    """(errors, times of all repetitions) over the tolerances, printed."""
    errors, times = [], []
    for rtol in TOLERANCES:
        run = make(rtol)
        times.append(ensembles.seconds(run, 5) / COUNT)
        errors.append(np.median(np.max(np.abs(run() - truth), axis=-1) / largest))
        print(f"  {name:<34}{rtol:7.0e}{1e6 * np.median(times[-1]):10.1f} us   error {errors[-1]:.0e}")
    return np.array(errors), np.array(times)


def at_error(found, error):
    """Sorted times at that error."""
    errors, times = found
    order = np.argsort(errors)
    columns = np.sort(times, axis=1)[order].T
    return np.array([np.exp(np.interp(np.log(error), np.log(errors[order]), np.log(each))) for each in columns])


def fastest(system, frictions):
    """The quickest of heyoka's wider batches at a middling tolerance."""
    return min(WIDER, key=lambda s: np.median(ensembles.seconds(by_heyoka(system, frictions, 1e-9, **s), 3)))


def main():
    """Print the curves, then the times at equal error."""
    brake, frictions = DrumBrake(friction=LinearSlope(0.1, SLOPE)), np.linspace(0.1, 0.101, COUNT)
    varied, system = {"friction.static": frictions}, brake.system()
    truth = simulate_ensemble(brake, varied, DURATION, rtol=1e-13, observe=("peak",), threads=1)
    largest = np.max(truth["peak"], axis=-1)
    print(f"drum, consistent, mu 0.1, {DURATION} s, {COUNT} trajectories, {int(np.sum(truth.events))} events in all")

    def ours(method):
        options = {"method": method, "observe": (), "threads": 1}
        return lambda rtol: lambda: simulate_ensemble(brake, varied, DURATION, rtol=rtol, **options).q

    mine = {name: curve(f"ours, {name}", ours(name), truth.q, largest) for name in ("taylor", "dormand-prince-8")}
    chosen = {"as recommended": {"width": hy.recommended_simd_size()}, "fastest": fastest(system, frictions)}
    theirs = {}
    for name, settings in chosen.items():
        title = f"heyoka, {name}, batch of {settings['width']}"
        theirs[name] = curve(title, lambda rtol, s=settings: by_heyoka(system, frictions, rtol, **s), truth.q, largest)
    print("  " + ", ".join(f"{k} {v}" for k, v in chosen["fastest"].items()))
    for rival, found in theirs.items():
        for name, own in mine.items():
            for error in ERRORS:
                ratio = ensembles.spread(at_error(found, error), at_error(own, error))
                print(f"  heyoka {rival} over ours, {name}, at error {error:.0e}: {ratio}")


if __name__ == "__main__":
    main()

"""Motion without any event: heyoka's batch of Taylor methods beside ours, one thread, time and error side by side.

The brake is the drum, reading `consistent`, mu 0.1 to 0.101: both contacts slip forward all the time, so nothing but
the integration is compared. Errors are those of the end state against our rtol 1e-12, relative to the largest
displacement. Times are of the processor and per trajectory, after one run that compiles. Each row of heyoka is compared
with our coarsest row that is at least as exact. Motion with events is compared in `rivals.py`.
"""

import ensembles
import heyoka as hy
import numpy as np
from transient import SLOPE

from squealbox import DrumBrake, LinearSlope, simulate_ensemble

DURATION, COUNT = 0.05, 512
TOLERANCES = (1e-5, 1e-7, 1e-9)


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


def by_heyoka(system, frictions, rtol):
    """A function that runs all drums in batches as wide as heyoka recommends, and the width."""
    width = hy.recommended_simd_size()
    ta = hy.taylor_adaptive_batch(equation(system), np.zeros((4, width)), tol=rtol)

    def run():
        out = []
        for first in range(0, frictions.size, width):
            ta.set_time(0.0)
            ta.state[:], ta.pars[:] = 0.0, frictions[first : first + width]
            ta.propagate_until([DURATION] * width)
            out.append(ta.state[:2].T.copy())
        return np.concatenate(out)

    return run, width


def main():
    """Print both tables."""
    brake, frictions = DrumBrake(friction=LinearSlope(0.1, SLOPE)), np.linspace(0.1, 0.101, COUNT)
    varied = {"friction.static": frictions}
    truth = simulate_ensemble(brake, varied, DURATION, rtol=1e-12, observe=("peak",), threads=1)
    largest, ours = np.max(truth["peak"], axis=-1), []
    print(f"drum, consistent, mu 0.1, {DURATION} s, {COUNT} trajectories, {int(np.sum(truth.events))} events in all")
    for rtol in TOLERANCES:

        def run(rtol=rtol):
            return simulate_ensemble(brake, varied, DURATION, rtol=rtol, observe=(), threads=1)

        spent = ensembles.seconds(run, 5) / COUNT
        error = np.median(np.max(np.abs(run().q - truth.q), axis=-1) / largest)
        ours.append((error, spent))
        print(f"  {'ours, exact':<24}{rtol:7.0e}{1e6 * np.median(spent):12.1f} us   error {error:.0e}")
    for rtol in TOLERANCES:
        each, width = by_heyoka(brake.system(), frictions, rtol)
        spent = ensembles.seconds(each, 5) / COUNT
        error = np.median(np.max(np.abs(each() - truth.q), axis=-1) / largest)
        equal = [times for mine, times in ours if mine <= error] or [ours[-1][1]]
        print(f"  {f'heyoka, batch of {width}':<24}{rtol:7.0e}{1e6 * np.median(spent):12.1f} us   error {error:.0e}"
              f"   heyoka's time over ours {ensembles.spread(spent, equal[0])}")  # fmt: skip


if __name__ == "__main__":
    main()

"""One motion under every treatment of friction: what the choice of contact scheme does to the answer and its cost."""

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from squealbox.arguments import public
from squealbox.result import Array, Outcome, Result, quantity
from squealbox.start import StartLike
from squealbox.system import DesignOrSystem, as_system
from squealbox.transient.simulating import simulate
from squealbox.transient.trajectory import Trajectory

SCHEMES = ("exact", "raw", "smooth", "tanh", "time-stepping")


@dataclass(frozen=True, kw_only=True, eq=False)
class ContactComparison(Result):
    """Period, amplitude, final state, cost and error of each contact scheme, from :func:`compare_contact`.

    Row 0 is the exact run the others are measured against. `period` is NaN where fewer than two full periods lie in the
    second half of the run. `error` is the largest difference of a displacement at the end of the run over the largest
    displacement of the exact run.
    """

    schemes: tuple[str, ...] = ()
    period: Array = quantity("scheme", "s", "mean period over the second half of the run")
    amplitude: Array = quantity("scheme", "m", "half peak to peak over the second half of the run")
    final: Array = quantity("scheme state", "m, m/s", "displacements and velocities at the end")
    error: Array = quantity("scheme", "1", "difference at the end over the largest displacement of the exact run")
    evaluations: Array = quantity("scheme", "1", "evaluations of the right-hand side, or steps of time stepping")
    seconds: Array = quantity("scheme", "s", "wall time of the run, compiled")
    outcomes: tuple[str, ...] = ()
    runs: Mapping[str, Trajectory] = field(default_factory=dict, repr=False, metadata={"transient": True})

    def summary(self) -> str:
        """A table one can paste in an e-mail."""
        lines = [
            f"{'scheme':<14}{'period [s]':>14}{'amplitude [m]':>15}{'error':>10}{'evaluations':>13}{'ms':>9}  outcome"
        ]
        for i, name in enumerate(self.schemes):
            numbers = f"{self.period[i]:>14.8g}{self.amplitude[i]:>15.6g}{self.error[i]:>10.1e}"
            cost = f"{int(self.evaluations[i]):>13d}{1e3 * self.seconds[i]:>9.2f}"
            lines.append(f"{name:<14}{numbers}{cost}  {self.outcomes[i]}")
        return "\n".join(lines)


@public()
def compare_contact(
    design_or_system: DesignOrSystem,
    duration: float,
    start: StartLike = None,
    *,
    schemes: Sequence[str] = SCHEMES,
    dof: int = 0,
    samples: int = 4001,
    options: Mapping[str, Mapping[str, Any]] | None = None,
) -> ContactComparison:
    """Run the same motion with every contact scheme and measure each against the exact one.

    Parameters
    ----------
    design_or_system, duration, start : as for `simulate`; duration in [s]
    schemes : which schemes; "exact" is always run and comes first
    dof : the degree of freedom whose period and amplitude are reported
    samples : equidistant instants at which the runs are compared
    options : further arguments of `simulate` for a scheme, such as ``{"raw": {"rtol": 1e-3}, "tanh": {"width": 0.01}}``

    Returns a `ContactComparison`; a scheme that could not go on keeps its row, with its outcome and NaN where it has no
    number.

    >>> from squealbox import DrumBrake
    >>> compare_contact(DrumBrake(), 1e-3, schemes=("raw",)).schemes
    ('exact', 'raw')
    """
    system = as_system(design_or_system)
    names = ("exact", *(name for name in schemes if name != "exact"))
    chosen = options or {}
    runs, seconds = {}, []
    for name in names:
        arguments = {"contact": name, "times": samples, **chosen.get(name, {})}
        simulate(system, 1e-6 * duration, start, **{**arguments, "times": 2})  # compiles what is not compiled yet
        begin = time.perf_counter()
        runs[name] = simulate(system, duration, start, **arguments)
        seconds.append(time.perf_counter() - begin)
    exact = runs["exact"]
    scale = float(np.max(np.abs(exact.q), initial=0.0)) or 1.0
    finals = np.array([_final(run, samples) for run in runs.values()])
    n = system.size
    return ContactComparison(
        inputs={"system": system},
        settings={"duration": duration, "dof": dof, "samples": samples, "options": dict(chosen)},
        outcome=exact.outcome if not exact.outcome.ok else Outcome(),
        schemes=names,
        period=np.array([_period(run, dof, samples) for run in runs.values()]),
        amplitude=np.array([_amplitude(run, dof, samples) for run in runs.values()]),
        final=finals,
        error=np.max(np.abs(finals[:, :n] - finals[0, :n]), axis=1) / scale,
        evaluations=np.array([run.evaluations for run in runs.values()]),
        seconds=np.array(seconds),
        outcomes=tuple(str(run.outcome) for run in runs.values()),
        runs=runs,
    )


def _final(run: Trajectory, samples: int) -> Any:
    state = np.concatenate([run.q[-1], run.qd[-1]]) if len(run.t) else np.full(2 * run.q.shape[1], np.nan)
    return state if len(run.t) == samples else np.full_like(state, np.nan)


def _amplitude(run: Trajectory, dof: int, samples: int) -> float:
    late = run.q[samples // 2 :, dof]
    return 0.5 * float(np.ptp(late)) if len(run.t) == samples else np.nan


def _period(run: Trajectory, dof: int, samples: int) -> float:
    """Mean distance of the upward crossings of the mean value, on the Hermite cubic of displacement and velocity."""
    from scipy.interpolate import CubicHermiteSpline

    if len(run.t) != samples:
        return np.nan
    late = slice(samples // 2, None)
    level = 0.5 * (np.max(run.q[late, dof]) + np.min(run.q[late, dof]))
    spline = CubicHermiteSpline(run.t[late], run.q[late, dof] - level, run.qd[late, dof])
    roots = spline.roots(extrapolate=False)
    upward = roots[spline.derivative()(roots) > 0.0]
    return float(np.mean(np.diff(upward))) if len(upward) > 2 else np.nan

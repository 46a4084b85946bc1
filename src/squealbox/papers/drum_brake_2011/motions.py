"""The transients of the paper's studies: from rest, the load applied suddenly, 0.05 s.

`raw` is what the paper did: Bogacki and Shampine's method at a relative tolerance of 1e-3 with sgn() as it stands.
`exact` locates every stick, slip and reversal, and so says what the same equation really does.
"""

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from squealbox.papers.drum_brake_2011.cases import BRAKING, DURATION, Case
from squealbox.papers.drum_brake_2011.claims import EXACT, RAW
from squealbox.system import DesignOrSystem
from squealbox.transient import Method, Trajectory, Verdict, simulate, verdict

SAMPLES = 5001  # every 10 us, about 50 in a period
FEWEST = 64  # samples: fewer say nothing of a motion
BEYOND = 1.0  # m: ten thousand times any amplitude in the paper
DOUBTFUL = 0.05  # of the amplitude: a raw run this far from the exact one cannot give two digits
# A smooth run takes about 3,000 steps. One that needs 300 times that hangs at sgn(), and is stopped.
METHODS = {
    RAW: Method("bogacki-shampine", rtol=1e-3, most_steps=1_000_000),
    EXACT: Method("dormand-prince-8", rtol=1e-9),
}


@dataclass(frozen=True, order=True)
class Run:
    """One run of the studies: the study it belongs to and the value varied in it."""

    study: str
    value: float = 0.0

    def __str__(self) -> str:
        values = {"friction": f"mu = {self.value:.2f}", "load": f"{self.value / 1e3:g} kN"}
        return values.get(self.study, self.study)

    def design(self, case: Case) -> Any:
        """The brake of this run."""
        if self.study == "friction":
            return case.design(mu=self.value)
        if self.study == "load":
            return case.design(load=self.value)
        return case.design(speed=BRAKING) if self == BRAKE else case.replace(alpha=0.0).design(mu=0.50)


FRICTION = tuple(Run("friction", mu) for mu in (0.10, 0.20, 0.30, 0.39, 0.40, 0.45, 0.50))
LOAD = tuple(Run("load", load) for load in (5e3, 10e3, 15e3, 20e3, 25e3))
BRAKE = Run("braking")
NO_SLOPE = Run("mu = 0.50 without slope")
RUNS = (*FRICTION, *LOAD, BRAKE, NO_SLOPE)


@dataclass(frozen=True)
class Motion:
    """One run and the verdict on x.

    `end` [s] is how far it can be judged: where it ended, or where x passed 1 m, because friction that has turned
    negative feeds it without limit. The verdict is None when there is next to nothing before that.
    """

    trajectory: Trajectory
    end: float
    verdict: Verdict | None

    @property
    def completed(self) -> bool:
        """True when the run reached 0.05 s, or left all bounds on the way."""
        return self.trajectory.outcome.ok or self.runs_away

    @property
    def runs_away(self) -> bool:
        """True when x passed 1 m."""
        return self.end < self.trajectory.t[-1]

    @property
    def ended(self) -> str:
        """How a run that did not reach 0.05 s ended."""
        return f"the run ended early ({self.trajectory.outcome} at {1e3 * self.trajectory.t[-1]:.3g} ms)"

    @property
    def persists(self) -> bool | None:
        """True for a motion that grows or keeps a cycle, False for one that decays, None when not decided."""
        if self.runs_away:
            return True
        kind = self.verdict.kind if self.verdict else ""
        return {"decays": False, "grows": True, "settles_on_cycle": True}.get(kind)

    @property
    def words(self) -> str:
        """The verdict in words, such as "settles on a cycle"."""
        if self.runs_away:
            return f"grows beyond {BEYOND:g} m"
        kind = self.verdict.kind if self.verdict else "not_decided"
        return {"settles_on_cycle": "settles on a cycle", "not_decided": "not decided"}.get(kind, kind)

    @property
    def amplitude(self) -> float:
        """Half peak to peak of x over the last quarter [m]; infinite for a motion that runs away."""
        if self.runs_away:
            return np.inf
        return float(self.verdict.amplitude) if self.verdict else np.nan

    @cached_property
    def least_friction(self) -> float:
        """The least friction coefficient any contact came to."""
        speed = np.max(np.abs(self.trajectory.sliding_velocity), axis=0)
        contacts = self.trajectory.system.contacts
        return float(min(contact.law.mu(v) for contact, v in zip(contacts, speed, strict=True)))


@dataclass(frozen=True)
class Studies:
    """The runs of one case with one treatment of contact, each made when it is first asked for.

    `made` holds runs by design and may be shared, so that no run is made twice; `asked` holds them by run.
    """

    case: Case
    contact: str
    method: Method
    samples: int = SAMPLES
    made: dict[Any, Motion] = field(default_factory=dict)
    asked: dict[Run, Motion] = field(default_factory=dict, repr=False)

    def __getitem__(self, run: Run) -> Motion:
        if run not in self.asked:
            self.asked[run] = self._of(run)
        return self.asked[run]

    def _of(self, run: Run) -> Motion:
        if self.case.floor is not None:
            free = self._motion(run.design(self.case.replace(floor=None)))
            if free.completed and free.least_friction >= self.case.floor:
                return free  # it never came down to the floor, so the floor changes nothing
        return self._motion(run.design(self.case))

    def _motion(self, design: DesignOrSystem) -> Motion:
        if design not in self.made:
            self.made[design] = judged(simulate(design, DURATION, "rest", self.samples, self.method, self.contact))
        return self.made[design]


def judged(run: Trajectory) -> Motion:
    """A run with its verdict, up to where x passes 1 m."""
    passed = np.nonzero(~(np.abs(run.q[:, 0]) <= BEYOND))[0]
    count = int(passed[0]) if passed.size else run.t.size
    end = float(run.t[max(count - 1, 0)])
    return Motion(run, end, verdict(run, dof="x", end=end) if count >= FEWEST else None)


def studies(case: Case, contact: str) -> Studies:
    """The studies of one case as the paper ran them (`raw`) or exactly (`exact`)."""
    return Studies(case, contact, METHODS[contact])


def distance(raw: Motion, exact: Motion) -> float:
    """Largest |x_raw - x_exact| while both ran, over half the range of the exact x [-]."""
    count = int(np.sum(raw.trajectory.t <= min(raw.end, exact.end)))
    x, reference = raw.trajectory.q[:count, 0], exact.trajectory.q[:count, 0]
    return float(np.max(np.abs(x - reference)) / (0.5 * np.ptp(reference)))


def doubt(raw: Motion, exact: Motion) -> str:
    """Why a raw run is not to be trusted beside the exact one; empty when it tells the same.

    The phase of a cycle is not asked for, only what the claims are made of: what becomes of the motion, and, where it
    persists, its amplitude to 5 %.
    """
    if not raw.completed:
        return f"raw: {raw.ended}"
    if not exact.completed:
        return ""
    if raw.words != exact.words:
        return f"raw says {raw.words}, exact says {exact.words}"
    wrong = abs(raw.amplitude / exact.amplitude - 1.0) if exact.persists and not exact.runs_away else 0.0
    return f"the raw amplitude is {wrong:.0%} off" if wrong > DOUBTFUL else ""

"""Random systems against a slow integrator of the tests' own: outcome, count of events and end state.

SQUEALBOX_FUZZ=10000 makes it long (`make fuzz`): so many systems, half of each kind, in families of one code, beginning
with family SQUEALBOX_FUZZ_FROM. Past failures stay in SEEDS and WIDE.
"""

import os

import numpy as np
import pytest

from random_systems import FAMILIES, FAMILY, random_system, wide_system
from slow_reference import EndlessEvents, slow
from squealbox import friction, simulate
from squealbox.system import InvalidSystem

SEEDS = (0, 4, 8, 10, 11, 40, 46, 1188, 2378, 2569)
# Of few freedoms, or with a rigid contact: compiled soon.
WIDE = (
    2, 4, 11, 16, 30, 44, 1951, 1960, 1967, 1970, 2478, 2492, 2500, 2515, 3350, 3356, 3359, 3362, 3364, 3968, 3970,
)  # fmt: skip
BEGIN = FAMILIES + FAMILY * int(os.environ.get("SQUEALBOX_FUZZ_FROM", "0"))
# Two freedoms and up to two contacts, of three families, so that three kernels are compiled for them.
FEW = [FAMILIES + family * FAMILY + i for family, count in ((0, 4), (7, 3), (10, 3)) for i in range(count)]
LONG = range(BEGIN, BEGIN + int(os.environ.get("SQUEALBOX_FUZZ", "0")) // 2)


@pytest.mark.parametrize("seed", sorted({*SEEDS, *LONG}))
def test_against_a_slow_integrator(seed):
    system, start, duration = random_system(seed)
    truth = followed(system, start, duration)
    motion = simulate(system, duration, start)
    assert motion.outcome == "completed"
    assert len(motion.event_time) == len(truth.events)
    expected = np.array([float(event[0]) for event in truth.events])
    late = np.max(np.abs(motion.event_time - expected) - told(expected), initial=0.0)
    off = float(np.max(np.abs(motion.q[-1] - truth.q))) - 1e-7 * max(1.0, float(np.max(np.abs(motion.q))))
    assert max(late, off) <= 0.0 or max(late, off) <= 10.0 * disturbed(system, start, duration, truth)
    assert motion.energy.relative_residual < 1e-6


def followed(system, start, duration):
    """What the slow integrator finds, where it comes to the end."""
    try:
        return slow(system, duration, *start)
    except EndlessEvents as error:
        pytest.skip(f"the slow integrator gives up: {error}")


def told(times):
    """How closely the slow integrator tells instants: of a slip of milliseconds, whose speeds are near its round-off,
    to a thousandth of how long it lasts.
    """
    lasts = np.diff(times, prepend=-np.inf)
    return 1e-7 + np.where(lasts < 5e-3, 1e-3 * lasts, 0.0)


@pytest.mark.parametrize("seed", sorted({*WIDE, *LONG}))
def test_every_kind_of_system_against_a_slow_integrator(seed):
    """Laws that rise, fall, are tables or nothing; what moves in time; springs that lift off, rigid stops.

    A kind that the program does not integrate is refused in a sentence. Contacts whose friction rises from zero pass
    through it without a jump: what the program counts there are no events to the slow integrator. Rebounds are endless
    in truth, and how many of them are counted is a convention; where they end is not.
    """
    system, start, duration, words = wide_system(seed)
    refused = None
    try:
        motion = simulate(system, duration, start)
    except InvalidSystem as error:
        refused = error
    if refused is not None:
        assert "massless" in words, refused
        return
    truth = followed(system, start, duration)
    sharp = np.array([float(contact.law.static_limit) > 1e-100 for contact in system.contacts])
    times = motion.event_time[sharp[motion.event_contact.astype(int)]] if len(motion.event_time) else []
    size = max(1.0, float(np.max(np.abs(motion.q))))
    bends = any(isinstance(contact.law, friction.Table) for contact in system.contacts)
    within = 1e-6 if bends else 1e-7  # a step across a bend of a law errs more than its tolerance
    pulled = motion.outcome == "contact_in_tension" and bool(np.any(motion.normal_force[-1][bilateral(system)] < 1e-9))
    if pulled:  # a contact that cannot open, held at zero speed by others: no sense is that of its sliding
        return
    assert motion.outcome == "completed"
    counted = not any(contact.rigid and contact.restitution for contact in system.contacts)
    expected = [float(time) for time, contact, _ in truth.events if sharp[contact]]
    if counted and len(times) != len(expected) and any(contact.rigid for contact in system.contacts):
        times, expected = accumulated(times), accumulated(expected)  # stops that shrink to nothing, an endless row
    # The slow integrator looks for events on its interpolant, which errs by some 1e-7 where forces decide them.
    off = np.max(np.abs(np.sort(times) - np.sort(expected)), initial=0.0) if len(times) == len(expected) else np.inf
    ends = float(np.max(np.abs(motion.q[-1] - truth.q)))
    if (counted and off > 1e-6) or ends > within * size:
        sensitive = disturbed(system, start, duration, truth)
        assert not counted or off <= 1e-6 + 10.0 * sensitive
        assert ends <= within * size + 10.0 * sensitive
    assert motion.energy.relative_residual < 1e-6


def bilateral(system):
    """The contacts that cannot open."""
    return np.array([not contact.unilateral for contact in system.contacts], dtype=bool)


def accumulated(times):
    """Instants of events, each row of them that follow each other within 1e-4 s at its end."""
    times = np.sort(times)
    return times[np.diff(times, append=np.inf) > 1e-4]


def disturbed(system, start, duration, truth):
    """How far a start that is off by 1e-10 ends, or when: what no integrator at this tolerance can promise to know."""
    if not np.any(np.abs(truth.q) > 0.0):
        return 0.0
    other = slow(system, duration, start[0] * (1.0 + 1e-10), start[1])
    ends = float(np.max(np.abs(other.q - truth.q)))
    if len(other.events) != len(truth.events):
        return ends
    times = (np.sort([float(event[0]) for event in run.events]) for run in (other, truth))
    return max(ends, float(np.max(np.abs(np.subtract(*times)), initial=0.0)))  # a limit just reached is late to tell


@pytest.mark.parametrize("method", ["dormand-prince", "tsitouras", "bogacki-shampine"])
def test_every_method_finds_the_same_events(method):
    for seed in FEW:
        system, start, duration = random_system(seed)
        one = simulate(system, duration, start, rtol=1e-11)
        other = simulate(system, duration, start, method=method, rtol=1e-9)
        assert one.outcome == other.outcome == "completed"
        assert len(one.event_time) == len(other.event_time), seed
        assert one.q[-1] == pytest.approx(other.q[-1], abs=1e-5), seed

"""A run that nobody waits for any more ends: what `progress` raises reaches the caller, and no thread goes on."""

import threading

import numpy as np
import pytest

from squealbox import DrumBrake, LinearSlope, simulate, simulate_ensemble
from squealbox.transient import needs_compiling
from squealbox.transient.lanes import single
from squealbox.transient.lanes.kernel import lane_kernel

DRUM = DrumBrake(friction=LinearSlope(0.45, -0.05))
FOREVER = 1e5  # s of motion: hours of computing


class Enough(Exception):
    """Nobody waits."""


def impatient(calls):
    def progress(done, total, seconds):
        calls.append((done, total, seconds))
        if len(calls) == 3:
            raise Enough

    return progress


def test_a_transient_ends_where_progress_says_so():
    calls = []
    with pytest.raises(Enough):
        simulate(DRUM, FOREVER, times=100, progress=impatient(calls))
    reached, ends, seconds = zip(*calls, strict=True)
    assert len(calls) == 3
    assert 0.0 < reached[0] < reached[1] < reached[2] < FOREVER
    assert set(ends) == {FOREVER}
    assert seconds[0] <= seconds[1] <= seconds[2]


def test_looking_at_a_run_does_not_change_it():
    calls = []
    alone = simulate(DRUM, 0.5)
    watched = simulate(DRUM, 0.5, progress=lambda *said: calls.append(said))
    assert len(calls) > 1
    assert calls[-1][0] == 0.5
    assert np.array_equal(alone.t, watched.t)
    assert np.array_equal(alone.q, watched.q)


def test_an_ensemble_ends_with_its_threads():
    before, calls = threading.active_count(), []
    with pytest.raises(Enough):
        simulate_ensemble(DRUM, {"friction.static": np.linspace(0.4, 0.5, 64)}, FOREVER, progress=impatient(calls))
    assert len(calls) == 3
    assert threading.active_count() == before


def test_a_machine_without_the_kernel_knows_it(monkeypatch, tmp_path):
    def forget():
        single.KEPT.clear()
        lane_kernel.cache_clear()

    simulate(DRUM, 1e-3)
    assert not needs_compiling(DRUM)
    monkeypatch.setenv("SQUEALBOX_CACHE", str(tmp_path))
    forget()
    try:
        assert needs_compiling(DRUM)
    finally:
        forget()

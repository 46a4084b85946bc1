"""Settings shared by all tests: quiet plots, reproducible property tests, no surprise from the machine."""

import os

import hypothesis
import pytest

os.environ.setdefault("MPLBACKEND", "Agg")

# Derandomised: a red run on one machine is red on the next. No deadline: the first call may compile a kernel.
hypothesis.settings.register_profile("house", deadline=None, derandomize=True, max_examples=50)
hypothesis.settings.load_profile("house")


@pytest.fixture
def drum():
    """The drum brake of the 2011 paper with its table's values."""
    from squealbox import DrumBrake

    return DrumBrake()

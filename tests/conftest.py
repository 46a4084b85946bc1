"""Settings shared by all tests: quiet plots, reproducible property tests, no surprise from the machine."""

import os
import signal

import hypothesis
import pytest

os.environ.setdefault("MPLBACKEND", "Agg")

# As the command line does, before NumPy is loaded: with a worker on every core, threads of the algebra wait in busy
# loops for a core that another worker has, and eigenvalues take four to seven times as long. Processes inherit it.
for library in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(library, "1")

# A shell starts a job in the background deaf to Ctrl-C, and the processes tests start would inherit that.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)

# Derandomised: a red run on one machine is red on the next. No deadline: the first call may compile a kernel.
hypothesis.settings.register_profile("house", deadline=None, derandomize=True, max_examples=50)
hypothesis.settings.load_profile("house")


@pytest.fixture
def drum():
    """The drum brake of the 2011 paper with its table's values."""
    from squealbox import DrumBrake

    return DrumBrake()


@pytest.fixture(scope="session")
def browser():
    """One browser for all pages of the workbench and of reports."""
    from browsers import launched

    with launched() as running:
        yield running

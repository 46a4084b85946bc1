"""The executor that needs nothing: this very process. The compiled engine has its own threads."""

import time

from squealbox.studies.analysis import evaluate
from squealbox.studies.work import Work


def run_embedded(work: Work) -> None:
    """Compute one piece after the other."""
    while (piece := work.take()) is not None:
        began = time.perf_counter()
        block = evaluate(work.task, piece.start, work.values(piece))
        work.finish(block, time.perf_counter() - began)

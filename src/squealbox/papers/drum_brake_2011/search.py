"""Which combinations of reading, alpha, sliding speed and floor meet which claims? Nothing is tuned: all are tried.

Transients are exact here, in the place of the paper's raw ones: a search must not be led by an integrator's error.
"""

import time
from collections.abc import Iterator
from typing import Any

from squealbox.papers.drum_brake_2011 import by_eigenvalues, by_transients, steady
from squealbox.papers.drum_brake_2011.cases import Case
from squealbox.papers.drum_brake_2011.claims import (
    AGREE,
    EIGENVALUES,
    EXACT,
    RAW,
    UNDECIDED,
    Claim,
    Finding,
    claims,
    combined,
    judge,
)
from squealbox.papers.drum_brake_2011.motions import Motion, Studies
from squealbox.transient import Method

ALPHAS = (0.02, 0.05, 0.065, 0.10, 0.15)  # s/m; 0.065 is the middle of what the paper's own numbers allow
SPEEDS = (0.2, 0.5, 1.0, 2.0)  # m/s; the table has 0.2, the text up to 1, the amplitudes point to 1 to 2
FLOORS = (None, 0.0)  # mu as printed, negative at high speed, or not below zero
LEAST_FRICTION = (
    0.10  # the least coefficient at rest of any study: steady sliding is not at the floor if alpha V is less
)
MAP_STEP = 5.0  # deg; as fine as the paper states the zone
METHOD = Method("tsitouras", rtol=1e-6, most_steps=100_000)  # a usual run takes 3,000; one that runs away any number
SAMPLES = 2001
BUDGET = 40.0  # s of the processor for one reading; a combination that is not reached is reported so

DECIDING = tuple(part.key for claim in claims() if RAW in claim.deciding for part in claim.parts if RAW in part.roads)


def search(reading: str, budget: float = BUDGET) -> dict[str, Any]:
    """Every combination of one reading: its verdicts by claim, and how many parts of each claim agree.

    Returns plain data: `rows`, one for each combination tried, and `skipped`, how many the budget left out.
    """
    end = time.process_time() + budget
    made: dict[Any, Motion] = {}
    steadily: dict[Case, dict[str, Finding]] = {}
    cases = list(_cases(reading))
    rows = []
    for case in cases:
        if time.process_time() > end:
            break
        rows.append(_row(case, made, steadily))
    return {"rows": rows, "skipped": len(cases) - len(rows)}


def _cases(reading: str) -> Iterator[Case]:
    for alpha in ALPHAS:
        for speed in SPEEDS:
            for floor in FLOORS:
                if floor is None or Case(reading).has_contacts:
                    yield Case(reading, alpha, speed, floor)


def _row(case: Case, made: dict[Any, Motion], known: dict[Case, dict[str, Finding]]) -> dict[str, Any]:
    sliding = case.replace(floor=None) if case.alpha * case.speed <= LEAST_FRICTION else case
    if sliding not in known:
        known[sliding] = by_eigenvalues.findings(sliding, steady.pressure_map(sliding, MAP_STEP))
    steadily = known[sliding]
    if case.has_contacts:
        runs = Studies(case, EXACT, METHOD, SAMPLES, made)
        moving = by_transients.findings(runs, only=DECIDING)
    else:
        moving = by_transients.without_contacts()
    verdicts = {claim.id: _verdicts(claim, steadily, moving) for claim in claims()}
    return {
        "reading": case.reading,
        "alpha": case.alpha,
        "speed": case.speed,
        "floor": case.floor,
        "verdicts": {name: combined(each) for name, each in verdicts.items()},
        "parts": {name: [each.count(AGREE), len(each)] for name, each in verdicts.items()},
    }


def _verdicts(claim: Claim, steadily: dict[str, Finding], moving: dict[str, Finding]) -> list[str]:
    found = []
    for part in claim.parts:
        if EIGENVALUES in claim.deciding and EIGENVALUES in part.roads:
            found.append(judge(part, steadily[part.key]))
        elif RAW in claim.deciding and RAW in part.roads:
            found.append(judge(part, moving[part.key]))
    return found or [UNDECIDED]

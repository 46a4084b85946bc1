"""The verdicts on all claims in one case, without figures: what a page can ask for while somebody waits."""

from collections.abc import Callable
from typing import Any

from squealbox.papers.drum_brake_2011 import by_eigenvalues, by_transients, record, steady
from squealbox.papers.drum_brake_2011.cases import Case
from squealbox.papers.drum_brake_2011.claims import EIGENVALUES, EXACT, RAW, Finding
from squealbox.papers.drum_brake_2011.motions import studies

Progress = Callable[[float, str], None]


def verdicts(case: Case, progress: Progress = lambda share, text: None) -> list[record.Record]:
    """One record for each claim, as in claims.json; `progress` hears the share that is done and what is being done.

    Some seconds once the kernels are compiled. Equal to the records of the whole study for that reading.
    """
    progress(0.0, "eigenvalues")
    found = {EIGENVALUES: by_eigenvalues.findings(case, steady.pressure_map(case))}
    if case.has_contacts:
        raw, exact = studies(case, RAW), studies(case, EXACT)
        progress(0.2, "transients with plain sgn, as in 2011")
        found[RAW] = by_transients.findings(raw, exact)
        progress(0.8, "transients with exact stick and slip")
        found[EXACT] = by_transients.findings(exact)
    else:
        found |= {RAW: by_transients.without_contacts(), EXACT: by_transients.without_contacts()}
    plain = {road: _plain(each) for road, each in found.items()}
    return record.records({case.reading: {"findings": plain, "amplitude": case.amplitude}})


def _plain(found: dict[str, Finding]) -> dict[str, Any]:
    return {key: {"value": each.value, "note": each.note, "trusted": each.trusted} for key, each in found.items()}

"""The claims as data, and the one rule that judges a computed value against a published one."""

import numpy as np
import pytest

from squealbox.papers.drum_brake_2011 import by_transients
from squealbox.papers.drum_brake_2011.cases import ALL_READINGS, Case
from squealbox.papers.drum_brake_2011.claims import (
    AGREE,
    DISAGREE,
    EIGENVALUES,
    EXACT,
    RAW,
    ROADS,
    UNDECIDED,
    ClaimPart,
    Finding,
    claims,
    combined,
    judge,
    paper,
)
from squealbox.papers.drum_brake_2011.steady import PressureMap

IDS = ["mu-1", "mu-2", "mu-3", "mu-4", "mu-5", "mu-6", "mu-7", "N-1", "N-2", "N-3", "V-1", "V-2", "th-1", "q-1", "q-2"]
PARTS = {part.key: part for claim in claims() for part in claim.parts}

# The numbers the paper prints, digit by digit, by part.
PUBLISHED = {
    "mu-2.onset": "0.40", "mu-3.lower": "11240", "mu-3.upper": "14570", "mu-4.separation": "560",
    "mu-5.frequency": "13140", "mu-6.frequency": "12190", "mu-7.at_0.40": "0.11", "mu-7.at_0.50": "0.20",
    "N-1.onset": "15", "N-2.lower": "11790", "N-2.upper": "14060", "N-3.at_15_kN": "0.16", "N-3.at_25_kN": "0.16",
    "N-3.settled": "4", "V-1.begin": "0.02", "V-1.end": "0.037", "V-2.amplitude": "0.0045", "V-2.frequency": "11790",
    "th-1.theta1_from": "115", "th-1.theta1_to": "155", "th-1.theta2_from": "20", "th-1.theta2_to": "40",
}  # fmt: skip


def test_every_claim_is_there_once() -> None:
    assert [claim.id for claim in claims()] == IDS


@pytest.mark.parametrize(("key", "digits"), PUBLISHED.items())
def test_the_papers_digits(key: str, digits: str) -> None:
    assert PARTS[key].published == digits


@pytest.mark.parametrize("part", PARTS.values(), ids=lambda part: part.key)
def test_a_part_says_how_it_is_judged(part: ClaimPart) -> None:
    assert part.meaning
    assert part.reason
    assert part.roads
    assert set(part.roads) <= set(ROADS)
    assert part.published is True or (isinstance(part.published, str) and part.below + part.above > 0.0)


@pytest.mark.parametrize("claim", claims(), ids=lambda claim: claim.id)
def test_each_deciding_road_answers_a_part(claim) -> None:
    answered = {road for part in claim.parts for road in part.roads}
    assert set(claim.deciding) <= answered


def test_what_is_assumed_is_said() -> None:
    assert any("alpha" in sentence and "assumed" in sentence for sentence in paper()["assumptions"])
    assert len(paper()["contradictions"]) >= 6


def number(**changes) -> ClaimPart:
    given = {
        "claim": "c", "name": "n", "meaning": "m", "published": "15", "unit": "kN", "below": 5.0, "above": 0.0,
        "reason": "r", "roads": (EIGENVALUES,),
    }  # fmt: skip
    return ClaimPart(**{**given, **changes})


@pytest.mark.parametrize(
    ("value", "verdict"),
    [
        (15.0, AGREE), (10.0, AGREE), (12.3, AGREE), (9.99, DISAGREE), (15.01, DISAGREE),
        (np.inf, DISAGREE), (None, UNDECIDED),
    ],
)  # fmt: skip
def test_a_number_is_judged_by_its_tolerance(value, verdict) -> None:
    assert judge(number(), Finding(value)) == verdict


@pytest.mark.parametrize(("value", "verdict"), [(True, AGREE), (False, DISAGREE), (None, UNDECIDED)])
def test_a_statement_is_judged_by_yes_or_no(value, verdict) -> None:
    assert judge(number(published=True), Finding(value)) == verdict


@pytest.mark.parametrize(
    ("verdicts", "together"),
    [
        ([AGREE, AGREE], AGREE), ([AGREE, DISAGREE], DISAGREE), ([AGREE, UNDECIDED], UNDECIDED),
        ([DISAGREE, UNDECIDED], DISAGREE), ([], UNDECIDED),
    ],
)  # fmt: skip
def test_one_disagreement_is_enough(verdicts, together) -> None:
    assert combined(verdicts) == together


def test_a_computation_that_gives_the_published_numbers_agrees() -> None:
    for part in PARTS.values():
        value = True if part.published is True else float(part.published)
        assert judge(part, Finding(value)) == AGREE


@pytest.mark.parametrize("reading", ALL_READINGS)
def test_every_road_answers_every_part_it_is_named_for(reading: str) -> None:
    from squealbox.papers.drum_brake_2011 import by_eigenvalues, steady

    case = Case(reading)
    found = by_eigenvalues.findings(case, steady.pressure_map(case, step=5.0))
    assert set(found) == {key for key, part in PARTS.items() if EIGENVALUES in part.roads}
    for road in (RAW, EXACT):
        assert set(by_transients.RULES) == {key for key, part in PARTS.items() if road in part.roads}


def zone_map(low1: float, high1: float, low2: float, high2: float) -> PressureMap:
    """A map that is unstable in one rectangle."""
    angles = np.arange(20.0, 161.0)
    first, second = angles[:, None], angles[None, :]
    inside = (first >= low1) & (first <= high1) & (second >= low2) & (second <= high2)
    return PressureMap(angles, np.where(inside, 100.0, -100.0))


def test_the_published_map_would_agree() -> None:
    from squealbox.papers.drum_brake_2011.by_eigenvalues import _map

    found = _map(zone_map(115.0, 155.0, 20.0, 40.0))
    assert {judge(PARTS[key], finding) for key, finding in found.items()} == {AGREE}


def test_a_map_unstable_elsewhere_does_not() -> None:
    from squealbox.papers.drum_brake_2011.by_eigenvalues import _map

    found = _map(zone_map(20.0, 60.0, 100.0, 140.0))
    assert judge(PARTS["th-1.zone"], found["th-1.zone"]) == DISAGREE
    assert judge(PARTS["th-1.theta1_from"], found["th-1.theta1_from"]) == DISAGREE
    assert judge(PARTS["th-1.mostly_stable"], found["th-1.mostly_stable"]) == AGREE


def test_a_stretch_of_constant_amplitude_is_found() -> None:
    time = np.linspace(0.0, 0.05, 101)
    envelope = np.interp(time, [0.0, 0.02, 0.037, 0.05], [3.0, 1.0, 1.0, 0.0])
    begin, end = by_transients.constant_stretch(time, envelope)
    # the ramps on both sides, 100 and 77 per second, stay within the 10 % band for 2 and 2.6 ms
    assert begin == pytest.approx(0.02, abs=0.0025)
    assert end == pytest.approx(0.037, abs=0.003)


def test_a_decay_has_no_such_stretch() -> None:
    time = np.linspace(0.0, 0.05, 101)
    begin, end = by_transients.constant_stretch(time, np.exp(-100.0 * time))
    assert end - begin < by_transients.SHORTEST

"""The search: its closed form against the program's own eigenvalues, its members, its chance, and that it resumes."""

import numpy as np
import pytest

from squealbox.designs import DrumBrake
from squealbox.papers.drum_brake_2011 import family_search, page_why, reconstruction
from squealbox.papers.drum_brake_2011.cases import HALF, RECONSTRUCTED, WHOLE, Case
from squealbox.papers.drum_brake_2011.claims import claims
from squealbox.papers.drum_brake_2011.family import PRINTED_BELTS, SHARES, SIGNS, TriedValues, Variant
from squealbox.papers.drum_brake_2011.family_judged import MemberCase, claims_met
from squealbox.papers.drum_brake_2011.family_modes import CLAIMS, Members, MembersFound, published, scrambled
from squealbox.stability import complex_modes, critical_value

FRONT, BELTS = SIGNS.index((1.0, -1.0, 1.0, -1.0)), SIGNS.index(PRINTED_BELTS)
LOADS, SHARE = SIGNS.index((-1.0, -1.0, 1.0, 1.0)), SHARES.index("Eq. (3): - in x, + in y")


def member(**changes) -> Variant:
    given = {"front": FRONT, "belts": BELTS, "loads": LOADS, "share": SHARE, "alpha": 0.0653, "sliding_speed": 1.48}
    return Variant(**{name: float(value) for name, value in {**given, **changes}.items()})


@pytest.mark.parametrize(
    ("name", "changes"),
    [
        ("reconstructed", {}),
        ("reconstructed_simple",
         {"loads": SIGNS.index((-1.0,) * 4), "share": 0, "alpha": 0.1, "sliding_speed": 1.0}),
        ("eq3_signed",
         {"front": SIGNS.index((1.0, -1.0, -1.0, 1.0)), "loads": SIGNS.index((1.0, -1.0, -1.0, 1.0)), "share": 0,
          "alpha": 0.05, "sliding_speed": 0.2}),
    ],
)  # fmt: skip
def test_readings_are_members(name: str, changes) -> None:
    given, own = member(**changes).system(), DrumBrake(reading=name).system()
    found, expected = (complex_modes(each).eigenvalues for each in (given, own))
    assert found == pytest.approx(expected, rel=1e-12)


def test_the_closed_form_is_what_eigenvalues_say() -> None:
    """Twelve members drawn at random: onset to the bisection's 3e-5, critical load to 1 % (first order in damping)."""
    draw = np.random.default_rng(1)
    compared = 0
    for front, belts, loads, share in zip(*(draw.integers(0, n, 12) for n in (16, 16, 16, 7)), strict=True):
        found = MembersFound.of(Members(front, belts, TriedValues((0.06,), (0.05,))))
        variant = member(front=front, belts=belts, loads=loads, share=share, alpha=0.06, sliding_speed=0.05 / 0.06)
        exact = critical_value(variant, "friction.static", (0.10, 0.60))
        onset = found.onset[loads, share, 0, 0]
        if np.isfinite(onset) and onset > 0.0:
            assert onset == pytest.approx(float(exact.value), abs=5e-5)
            compared += 1
        load = found.critical_load[loads, share, 0, 0]
        exact = critical_value(variant, "load", (100.0, 40e3))
        if exact.outcome.ok and np.isfinite(load):
            assert load == pytest.approx(float(exact.value), rel=0.02)
    assert compared >= 3


def test_the_reconstruction_meets_six_of_the_eight() -> None:
    found = MembersFound.of(Members(FRONT, BELTS, TriedValues((0.0653,), (0.0653 * 1.48,))))
    met = {name for name, each in found.met(published()).items()
           if np.broadcast_to(each, found.onset.shape)[LOADS, SHARE, 0, 0]}  # fmt: skip
    assert met == {"mu-1", "mu-2", "mu-3", "mu-4", "N-1", "N-2"}


def test_a_member_is_judged_as_its_reading_is() -> None:
    """Seven of fifteen peak to peak, six by half of it."""
    case = MemberCase(FRONT, BELTS, LOADS, SHARE, 0.0653, 1.48)
    met = claims_met(case)
    assert met[WHOLE] == ["mu-1", "mu-2", "mu-3", "mu-4", "mu-7", "N-1", "N-2"]
    assert met[HALF] == [name for name in met[WHOLE] if name != "mu-7"]
    assert met == claims_met(Case(RECONSTRUCTED))


def test_the_short_form_counts_every_member_once() -> None:
    found = family_search.short(50)
    assert found.counts.sum() == found.family == 277_760
    assert found.most == 6
    assert 0.02 < found.chance < 0.3  # 50 sets: 0.13 and three times its scatter


def test_stiffness_alone_leaves_one_choice_of_signs() -> None:
    """+, + along x (cos theta2 < 0 turns shoe 2) and +, - along y: the sign the docstring of the readings derives."""
    signs, chance = family_search.stiffness_only(100)
    assert [SIGNS[i] for i in signs] == [(1.0, 1.0, 1.0, -1.0)]
    assert 0.0 <= chance < 0.2


def test_scrambled_numbers_are_physical_and_repeat() -> None:
    sets = scrambled(50)
    assert sets == scrambled(50)
    base = sum(w**2 for w in published().at_low)
    for each in sets:
        assert sum(w**2 for w in each.at_low) == pytest.approx(base, rel=1e-12)
        assert np.diff(each.at_load)[0] < np.diff(each.at_low)[0]
    assert len(CLAIMS) == 8


def test_the_finer_grid_holds_the_reconstruction() -> None:
    near = np.array([[FRONT, BELTS, LOADS, SHARE, 0.0675, 0.0975 / 0.0675]])
    fine = reconstruction.finer(near)
    assert np.all(fine[:, :4] == near[:, :4])
    closest = np.min(np.abs(fine[:, 4] - 0.0653) + np.abs(fine[:, 4] * fine[:, 5] - 0.0653 * 1.48))
    assert closest < 1.5e-3


def test_a_search_that_was_stopped_goes_on(tmp_path, monkeypatch) -> None:
    """The second call finds everything done and asks no member again."""
    from squealbox.studies import sweep

    space = {"front": [5.0], "belts": [4.0]}
    first = sweep(Variant(), space, family_search.score, out=tmp_path / "members")
    again = sweep(Variant(), space, family_search.score, out=tmp_path / "members")
    np.testing.assert_array_equal(np.asarray(first["counts"]), np.asarray(again["counts"]))
    assert np.asarray(first["counts"]).sum() == family_search.USUAL.size


def _outcome(counts: list[int], own: int) -> str:
    """What the page says of a search whose members meet so many claims, beside a reconstruction that meets `own`."""
    ids = [claim.id for claim in claims()]
    rows = np.array([[5.0, 4.0, i, 0.0, 0.05 + 0.01 * i, 1.0] for i in range(len(counts))])
    met = [{"half peak to peak": ids[: n - 1], "peak to peak": ids[:n]} for n in counts]
    whole = reconstruction.Reconstruction(None, rows, met, (10, 2), 1)
    text, table = page_why._outcome(whole, ids[:own])
    assert len(table.rows) == counts.count(max(counts))
    return str(text.text)


def test_the_page_names_ties_and_better_members() -> None:
    assert "met by 2 members of 2 choices. reconstructed* meets as many" in _outcome([7, 6, 7], 7)
    assert "the first of them is the better reading" in _outcome([8, 7], 7)
    assert "reconstructed* meets more (7)" in _outcome([6, 5], 7)

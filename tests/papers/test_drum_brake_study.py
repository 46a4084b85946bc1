"""The study itself: transients and eigenvalues tell one story, doubtful runs are named, and the folder is complete."""

import json
import re
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

from squealbox.papers.drum_brake_2011 import (
    by_eigenvalues,
    by_transients,
    ensembles,
    figures,
    jobs,
    reading,
    reproduce,
    search,
    search_results,
    steady,
)
from squealbox.papers.drum_brake_2011.cases import ALL_READINGS, DEFAULT_READING, PRINTED, RESOLUTION, Case
from squealbox.papers.drum_brake_2011.claims import AGREE, DISAGREE, EXACT, RAW, UNDECIDED, claims
from squealbox.papers.drum_brake_2011.motions import FRICTION, Motion, Run, Studies, doubt, judged, studies

READING = "componentwise"  # decays, beats, and holds cycles, so every rule has something to read


@pytest.fixture(scope="module")
def raw() -> Studies:
    return studies(Case(READING), RAW)


@pytest.fixture(scope="module")
def exact() -> Studies:
    return studies(Case(READING), EXACT)


def test_lines_of_the_spectrum_are_the_eigenfrequencies(exact) -> None:
    """Two roads, one answer: what decays at mu = 0.10 rings at its two frequencies."""
    lines = by_transients.lines(exact[Run("friction", 0.10)])
    expected = steady.frequencies(steady.modes(exact.case, mu=0.10))
    # a decaying line is 2 x growth rate wide, 210 rad/s; its top is found to a twentieth of that
    assert lines == pytest.approx(expected, abs=10.0)


def test_they_are_not_those_of_another_reading(exact) -> None:
    other = steady.frequencies(steady.modes(Case("eq3"), mu=0.10))
    assert np.max(np.abs(by_transients.lines(exact[Run("friction", 0.10)]) - other)) > RESOLUTION


def test_what_the_eigenvalues_call_stable_decays_and_what_they_call_unstable_does_not(exact) -> None:
    for run in (Run("friction", 0.10), Run("load", 5e3), Run("load", 15e3)):
        growing = float(steady.growth(run.design(exact.case))) > 0.0
        assert exact[run].persists is growing


def test_a_cycle_shows_one_line_and_not_its_harmonics(exact) -> None:
    lines = by_transients.lines(exact[Run("load", 25e3)])
    assert not any(abs(lines[-1] - order * lines[0]) < RESOLUTION for order in (2, 3))


def test_raw_and_exact_agree_where_nothing_reverses(raw, exact) -> None:
    run = FRICTION[0]
    assert len(exact[run].trajectory.event_time) == 0
    difference = np.max(np.abs(raw[run].trajectory.q - exact[run].trajectory.q))
    # 3,000 steps at a relative tolerance of 1e-3: a per cent or so of the largest displacement
    assert difference < 0.05 * np.max(np.abs(exact[run].trajectory.q))
    assert doubt(raw[run], exact[run]) == ""


def test_a_raw_run_with_another_amplitude_is_doubted(raw, exact) -> None:
    run = Run("load", 15e3)
    assert doubt(raw[run], exact[run]) == ""
    wrong = replace(raw[run].verdict, amplitude=1.1 * exact[run].verdict.amplitude)
    assert "10% off" in doubt(replace(raw[run], verdict=wrong), exact[run])


def test_a_raw_run_that_stops_early_is_doubted_and_decides_nothing(exact) -> None:
    from squealbox.transient import Method

    short = Studies(Case(READING), RAW, Method("bogacki-shampine", rtol=1e-3, most_steps=400))
    run = Run("load", 15e3)
    assert "the run ended early (" in doubt(short[run], exact[run])
    finding = by_transients.findings(short, exact, only=["N-3.at_15_kN"])["N-3.at_15_kN"]
    assert finding.value is None
    assert not finding.trusted


def test_a_motion_that_runs_away_is_named_and_is_no_cycle() -> None:
    """With alpha = 0.3 s/m friction turns negative beyond 1 m/s and feeds the motion without limit."""
    case = Case("consistent", alpha=0.3, speed=1.0)
    free = Studies(case, EXACT, search.METHOD, search.SAMPLES)[Run("load", 15e3)]
    assert free.runs_away
    assert free.persists
    assert np.isinf(free.amplitude)
    clipped = Studies(case.replace(floor=0.0), EXACT, search.METHOD, search.SAMPLES)[Run("load", 15e3)]
    assert not clipped.runs_away


def test_a_floor_that_is_not_reached_costs_no_run() -> None:
    made: dict[object, Motion] = {}
    case = Case(READING)
    first = Studies(case, EXACT, search.METHOD, search.SAMPLES, made)[Run("friction", 0.40)]
    again = Studies(case.replace(floor=0.0), EXACT, search.METHOD, search.SAMPLES, made)[Run("friction", 0.40)]
    assert again is first
    assert first.least_friction > 0.0


def test_a_record_of_next_to_nothing_has_no_verdict(exact) -> None:
    run = exact[FRICTION[0]].trajectory
    arrays = {name: getattr(run, name)[:10] for name in ("t", "q", "qd")}
    assert judged(replace(run, **arrays)).verdict is None


def test_the_search_says_what_it_left_out() -> None:
    nothing = search.search(PRINTED, budget=0.0)
    assert nothing["rows"] == []
    assert nothing["skipped"] == len(search.ALPHAS) * len(search.SPEEDS)


def test_the_search_judges_as_the_study_does(monkeypatch) -> None:
    for name, values in (("ALPHAS", (0.05, 0.1)), ("SPEEDS", (0.2,))):
        monkeypatch.setattr(search, name, values)
    found = search.search(PRINTED)
    assert len(found["rows"]) == 2
    row = next(row for row in found["rows"] if row["alpha"] == 0.05 and row["speed"] == 0.2)
    case = Case(PRINTED)
    study = by_eigenvalues.findings(case, steady.pressure_map(case, step=search.MAP_STEP))
    assert row["verdicts"]["mu-3"] == AGREE
    assert study["mu-3.lower"].value == pytest.approx(11285.8, abs=0.05)  # R5's matrices with alpha = 0.05 s/m
    assert row["verdicts"]["mu-2"] == DISAGREE
    assert row["verdicts"]["mu-7"] == UNDECIDED
    assert found["skipped"] == 0


def test_a_map_without_an_unstable_point_still_shows_its_angles() -> None:
    """Reading `eq3` is stable all over; the published zone must stand in its place on the empty map."""
    found = steady.pressure_map(Case("eq3"), step=5.0)
    assert not found.unstable.any()
    panel = figures.pressure_maps({0.30: found}).axes[0]
    assert panel.get_xlim() == (20.0, 160.0)
    assert panel.get_ylim() == (20.0, 160.0)


def test_the_boundary_of_the_map_is_drawn_as_traced() -> None:
    """Two bands across the square have four edges; on each the largest growth rate vanishes."""
    found = steady.pressure_map(Case("consistent"), traced=True)
    assert found.curves is not None
    assert len(found.curves) == 4
    panel = figures.pressure_maps({0.30: found}).axes[0]
    assert [len(line.get_xdata()) for line in panel.get_lines()] == [len(points) for points in found.curves]
    theta1, theta2 = np.deg2rad(np.concatenate(found.curves)).T
    left = steady.growth(Case("consistent").design(theta1=theta1, theta2=theta2))
    assert np.max(np.abs(left)) < 1e-7  # 1/s; degrees and back cost the last digit of an angle, times 1e4 1/s


@pytest.mark.parametrize(
    ("name", "friction", "load"),
    [
        ("eq1_printed", "", "negative_slope"),
        ("eq3", "flutter", ""),
        ("eq3_signed", "flutter", ""),
        ("componentwise", "", "negative_slope"),
        ("consistent", "flutter", "negative_slope"),
        (PRINTED, "flutter", "negative_slope"),
        ("reconstructed", "flutter", "negative_slope"),
        ("reconstructed_simple", "flutter", "negative_slope"),
    ],
)
def test_each_reading_shows_by_what_it_loses_stability(name: str, friction: str, load: str) -> None:
    """No onset, no mechanism; else the claims name it with the shares of what feeds the mode."""
    case = Case(name)
    found = (steady.onset_in_friction(case), steady.onset_in_load(case))
    assert (found[0].mechanism, found[1].mechanism) == (friction, load)
    told = by_eigenvalues.findings(case, steady.pressure_map(case, step=20.0))
    assert told["mu-2.mechanism"].value is (friction == "flutter")
    assert (found[0].feeding or "no onset") in told["mu-2.mechanism"].note
    assert (found[1].feeding or "no onset") in told["q-2.load"].note


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Iterator[object]:
    """The whole command with two readings computed and their answers standing in for the others."""

    def two_only(readings, figures, progress, fine, wanted, meanwhile):
        printed = reading.study(Case(PRINTED), figures / PRINTED)
        default = reading.study(Case(DEFAULT_READING), figures, ensembles.Sizes(5, 5, 7, vector=True))
        found = {name: default if name == DEFAULT_READING else printed for name in readings}
        assert wanted is False
        jobs.do({"kind": "drawings", "folder": str(figures)})
        for name in readings:
            if name not in (PRINTED, DEFAULT_READING):
                (figures / name).mkdir(exist_ok=True)
                for file in (figures / PRINTED).iterdir():
                    (figures / name / file.name).write_bytes(file.read_bytes())
        meanwhile()
        progress("both", 1.0)
        return found, {}, {kind: jobs.do({"kind": kind, "folder": str(figures)}) for kind in ("family", "solver")}

    heard = []
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(jobs, "everything", two_only)
        page = reproduce(tmp_path_factory.mktemp("out"), progress=lambda what, share: heard.append((what, share)))
    assert heard == [("both", 1.0)]
    assert page.name == "index.html"
    return page.parent


def test_every_figure_is_there_twice(folder) -> None:
    for number in range(1, 10):
        for kind in ("png", "svg"):
            assert (folder / "figures" / f"fig{number}.{kind}").stat().st_size > 5000
    assert (folder / "figures" / PRINTED / "fig9.png").exists()


def test_claims_json_has_every_claim_in_every_reading(folder) -> None:
    text = (folder / "claims.json").read_text(encoding="utf-8")
    found = json.loads(text, parse_constant=lambda word: pytest.fail(f"{word} is no JSON"))
    pairs = [(each["id"], each["reading"]) for each in found["claims"]]
    assert sorted(pairs) == sorted((claim.id, name) for claim in claims() for name in ALL_READINGS)
    for each in found["claims"]:
        assert each["verdict"] in (AGREE, DISAGREE, UNDECIDED)
        assert all(each[name] for name in ("statement", "published", "computed", "tolerance", "reason"))
    assert sum(found["summary"].values()) == len(pairs)


def test_transient_claims_have_raw_and_exact_side_by_side(folder) -> None:
    found = json.loads((folder / "claims.json").read_text(encoding="utf-8"))["claims"]
    part = next(each for each in found if each["id"] == "mu-7" and each["reading"] == DEFAULT_READING)["parts"][0]
    assert set(part["roads"]) == {RAW, EXACT}
    assert all(answer["computed"] > 0.0 for answer in part["roads"].values())


def test_the_page_shows_the_claims_first_and_holds_every_figure(folder) -> None:
    text = (folder / "index.html").read_text(encoding="utf-8")
    assert text.index("mu-1") < text.index("<img")
    # Figs. 1 and 2, the default's, two for each stand-in, four theorems, the solver
    assert text.count("<img") == 2 + 10 + 7 * 2 + 4 + 1
    words = re.sub('base64,[^"]*', "", text)  # in millions of random letters these four stand by chance
    assert "http" not in words.replace("http-equiv", "")


def test_the_page_opens_with_findings_and_has_no_wall_of_red(folder) -> None:
    text = (folder / "index.html").read_text(encoding="utf-8")
    body = text[text.index("<main>") :]
    assert body.index("finding of the paper") < body.index("15 numbers by one reading") < body.index("mu-1: ")
    assert "numbers by one reading" not in text[: text.index("finding of the paper")]
    assert 'class="disagree"' not in body
    assert "half peak to peak" in body
    assert "inferred" in body


def test_claims_json_has_each_claim_once_and_the_level_of_chance(folder) -> None:
    found = json.loads((folder / "claims.json").read_text(encoding="utf-8"))
    assert [each["id"] for each in found["overall"]] == [claim.id for claim in claims()]
    assert found["family"]["most"] == 6
    assert 0.0 < found["family"]["chance"] < 0.5
    both = next(each for each in found["claims"] if each["id"] == "mu-7")["as"]
    assert set(both) == {"half peak to peak", "peak to peak"}


def test_claims_md_tells_the_same(folder) -> None:
    text = (folder / "claims.md").read_text(encoding="utf-8")
    found = json.loads((folder / "claims.json").read_text(encoding="utf-8"))
    assert all(f"## {claim.id}" in text for claim in claims())
    assert f"{found['summary'][AGREE]} agree" in text


def test_search_csv_has_a_row_for_each_combination(tmp_path) -> None:
    searched = {PRINTED: search.search(PRINTED, budget=0.1)}
    rows = search_results.write_csv(tmp_path / "search.csv", searched).read_text(encoding="utf-8").splitlines()
    assert len(rows) == 1 + len(searched[PRINTED]["rows"])


@pytest.mark.parametrize("count", [1, len(ALL_READINGS)])
def test_the_figure_of_the_search_has_a_panel_for_each_reading(count: int) -> None:
    row = {"alpha": 0.05, "speed": 0.2, "verdicts": {"mu-1": AGREE, "mu-2": DISAGREE}}
    figure = search_results.draw({name: {"rows": [row]} for name in ALL_READINGS[:count]})
    assert [panel.get_title() for panel in figure.axes if panel.axison] == list(ALL_READINGS[:count])


def test_jobs_run_in_their_own_processes_and_wait_for_what_they_need() -> None:
    heard: list[object] = []
    late = {"kind": "compile", "contact": RAW, "label": "late", "after": ["early"]}
    early = {"kind": "compile", "contact": EXACT, "label": "early"}
    answers = jobs.run([late, early], lambda what, share: heard.append((what, share)), lambda: heard.append("begun"))
    assert heard == ["begun", ("early", 0.5), ("late", 1.0)]
    assert answers == ["decays", "decays"]


def test_a_job_that_fails_says_which(tmp_path) -> None:
    work = [{"kind": "search", "reading": "no such reading", "label": "nonsense"}]
    with pytest.raises(jobs.JobFailed, match="nonsense: its process ended with exit code 1: .*no such reading"):
        jobs.run(work)

"""The panels that compute when asked: limit cycles, sound, comparison, report and tour, against the library."""

import json
import wave

import numpy as np
import pytest

from squealbox import DrumBrake, LinearSlope, complex_modes, critical_value, hopf_point, simulate
from squealbox.papers.drum_brake_2011.cases import RECONSTRUCTED, Case
from squealbox.papers.drum_brake_2011.record import count
from squealbox.papers.drum_brake_2011.verdicts import verdicts
from squealbox.signals import dominant_frequency, sound_level
from squealbox.system import equilibrium
from squealbox.workbench.panels import OptionError, Options, Stopped, Work, branch, function_of, tour

FLOAT32 = 1e-5


def brake(**changes):
    return DrumBrake(friction=LinearSlope(0.30, -0.05)).replace(changes)


def press(page, panel, text):
    page.ask(panel)
    page.page.click(f"section[data-panel={panel}] >> button:text-is('{text}')")


def samples(path):
    """Rate and samples of a WAV file."""
    with wave.open(str(path)) as file:
        assert (file.getnchannels(), file.getsampwidth()) == (1, 2)
        return file.getframerate(), np.frombuffer(file.readframes(file.getnframes()), dtype=np.int16).astype(float)


def test_nothing_is_computed_before_it_is_asked(page):
    for panel in ("branch", "listen", "report", "tour"):
        page.ask(panel)
        assert page.page.get_attribute(f"section[data-panel={panel}]", "data-state") == "idle"
        assert page.says(panel)


def test_limit_cycles_beside_stable_sliding_are_marked(page):
    page.enter("friction.static", 0.2)  # where a large push alone finds the cycle
    page.option("branch", points=30)  # as far as the fold below; the page goes round it and back
    press(page, "branch", "Follow")
    page.drawn("branch")
    onset = float(hopf_point(brake(), "friction.static", (0.1, 0.6)).value)
    together = json.loads(page.page.get_attribute("section[data-panel=branch]", "data-together"))
    # the stable cycle ends in a fold at 0.17749, where shooting with 400 points ends, stable sliding at the onset
    ((low, high),) = together
    assert low == pytest.approx(0.17749, abs=5e-6)
    assert high == pytest.approx(onset, rel=1e-9)
    layers = page.numbers("branch", "branch")["layers"]
    born = next(layer for layer in layers if layer["column"] == "onset")
    assert born["x"] == pytest.approx([onset], rel=FLOAT32)
    kinds = {stroke["cls"] for stroke in page.strokes("branch", "branch") if "L" in stroke["d"]}
    assert {"layer s0", "layer s1", "layer s2"} <= kinds, "stable, unstable and sliding are three looks"
    assert "coexist" not in page.says("branch")
    assert "exists beside stable sliding" in page.says("branch")
    page.enter("k3", 150)
    page.page.wait_for_selector("section[data-panel=branch][data-state=stale]")
    assert "earlier design" in page.says("branch")


def test_a_walk_can_be_stopped(page):
    page.enter("k4", 111)  # not computed before
    press(page, "branch", "Follow")
    stop = page.page.locator("section[data-panel=branch] button.stop")
    stop.wait_for(timeout=20_000)
    stop.click()
    page.page.wait_for_selector("section[data-panel=branch][data-state=stopped]", timeout=20_000)
    page.enter("friction.static", 0.31)  # the page goes on
    page.drawn("locus")


def test_a_walk_ends_where_nobody_waits():
    seen = []

    def report(share, text):
        seen.append((share, text))
        if len(seen) == 30:
            work.stop()

    work = Work(report)
    with pytest.raises(Stopped):
        function_of("branch")(brake(), Options({}), work)
    assert len(seen) == 30
    assert all(0.0 <= share < 1.0 for share, _ in seen)


def test_the_sound_has_the_frequency_of_the_motion_before_and_after(page):
    page.enter("friction.static", 0.45)
    page.drawn("locus")
    press(page, "listen", "Play")
    page.drawn("listen")
    page.page.wait_for_selector("section[data-panel=listen][data-played]")
    press(page, "listen", "Keep as before")
    page.enter("sliding_speed", 0.1)
    page.drawn("locus")
    press(page, "listen", "Play")
    page.drawn("listen")
    downloads = []
    page.page.on("download", lambda each: downloads.append(each))
    press(page, "listen", "WAV")
    while len(downloads) < 2:  # the test's own time limit ends it
        page.page.wait_for_timeout(50)
    files = {each.suggested_filename: each.path() for each in downloads}
    sizes = {}
    for name, speed in (("drum-brake-before.wav", 0.2), ("drum-brake.wav", 0.1)):
        design = brake(**{"friction.static": 0.45, "sliding_speed": speed})
        rate, heard = samples(files[name])
        size = float(np.max(np.abs(equilibrium(design.system()).q)))
        motion = simulate(design, 0.3, start=complex_modes(design).most_unstable.start(0.05 * size), times=30_001)
        true = dominant_frequency(motion, dof="x", begin=0.15)
        assert rate == 44100
        assert dominant_frequency(heard[rate // 2 :], rate=float(rate)) == pytest.approx(true, rel=1e-5)
        level = 20.0 * np.log10(np.ptp(heard[rate // 2 : -rate // 10]))
        sizes[name] = level - sound_level(motion, dof="x", begin=0.225).weighted
    # as loud to each other as the estimates say: displacements of equal size are not equally loud
    assert sizes["drum-brake.wav"] == pytest.approx(sizes["drum-brake-before.wav"], abs=0.3)


def test_what_cannot_be_heard_is_said():
    found = function_of("listen")(brake(), Options({"dof": 1}), Work(apart=True))
    assert found.data["level"] < 0.0  # stable: after a second and a half nothing is left
    slow = function_of("listen")(design_of_the_belt(), Options({}), Work(apart=True))
    assert "Nothing to hear" in slow.data["silent"]  # a second and a half tells nothing of a motion that takes twelve
    with pytest.raises(OptionError, match="dof"):
        function_of("listen")(brake(), Options({"dof": 0.5}), Work())


def test_a_degree_of_freedom_the_design_does_not_have_is_the_first_and_named_so():
    found = function_of("motion")(brake(), Options({"dof": 7, "duration": 5e-3}), Work(apart=True))
    assert found.data["dof"] == 0
    assert found.data["names"][0] == "x"


def test_the_onset_drawn_is_the_nearest_to_the_present_value(monkeypatch):
    monkeypatch.setattr(branch, "_cycle", lambda *_: None)
    monkeypatch.setattr(branch, "_walks", lambda *_: iter(()))
    at = brake(theta2=np.deg2rad(115.0))
    found = function_of("branch")(at, Options({"parameter": "theta2"}), Work(apart=True))
    said = function_of("verdict")(at, Options({"parameter": "theta2"}), Work())
    near = min((each["value"] for each in said.data["crossings"] if each["changes"]), key=lambda v: abs(v - at.theta2))
    assert found.data["hopf"] == pytest.approx(np.rad2deg(near), abs=1e-4)


def design_of_the_belt():
    from squealbox import MassOnBelt

    return MassOnBelt()


def test_two_designs_beside_each_other(page):
    page.drawn("compare")
    press(page, "compare", "Keep this as A")
    page.enter("theta2", 100)
    page.drawn("compare")
    table = page.page.locator("section[data-panel=compare] table")
    rows = [row.split("\t") for row in table.inner_text().splitlines()]
    found = {row[0]: row[1:] for row in rows}
    designs = (brake(), brake(theta2=np.deg2rad(100.0)))
    critical = [float(critical_value(each, "friction.static", (0.0, 1.0)).value) for each in designs]
    assert [float(text) for text in found["critical friction.static"]] == pytest.approx(critical, rel=FLOAT32)
    assert found["theta2"] == ["115 deg", "100 deg"]
    assert "theta1" not in found, "only what differs is listed"
    lines = [layer for layer in page.numbers("compare", "frequency")["layers"] if layer["kind"] == "line"]
    assert [line["cls"] for line in lines] == ["s0", "s0", "s1", "s1"]
    press(page, "compare", "Swap A and B")
    last = page.page.locator("section[data-panel=compare] tbody tr").last
    last.filter(has_text="theta2").filter(has_text="100 deg").locator("td").first.filter(has_text="100 deg").wait_for()
    assert page.page.locator("input[data-path=theta2]").input_value() == "115"


def test_the_report_button_hands_over_a_file(page, browser, tmp_path):
    page.enter("friction.static", 0.45)
    page.drawn("locus")
    with page.page.expect_download(timeout=120_000) as download:
        page.page.click("#report")
    assert download.value.suggested_filename == "drum-brake-report.html"
    file = tmp_path / "report.html"
    download.value.save_as(file)
    context = browser.new_context(offline=True)
    opened = context.new_page()
    errors = []
    opened.on("pageerror", lambda error: errors.append(str(error)))
    opened.on("requestfailed", lambda request: errors.append(request.url[:80]))
    opened.goto(file.as_uri())
    opened.wait_for_selector("html[data-charts]")
    assert opened.evaluate("document.documentElement.dataset.charts") == "drawn"
    assert "Stability changes at friction.static = 0.33269" in opened.inner_text("main")
    assert errors == []
    context.close()


@pytest.fixture(scope="module")
def records():
    """The verdicts on the paper's claims for the reading of the tour, as the library finds them."""
    return verdicts(Case(RECONSTRUCTED))


def test_the_tour_sets_the_design_and_judges_the_claims(page, records):
    page.page.click("#tour")
    page.page.wait_for_selector(".tour[data-step='0']", timeout=120_000)
    numbers, records = count(records), {each["id"]: each for each in records}
    page.drawn("tour")
    assert ", ".join(f"{many} {verdict}" for verdict, many in numbers.items()) in page.says("tour")
    for step, static, ids in ((1, "0.1", ["mu-3"]), (2, "0.39", ["mu-1", "mu-4"]), (3, "0.4", ["mu-2", "mu-5"])):
        page.page.click(".tour >> text=Next")
        page.page.wait_for_selector(f".tour[data-step='{step}']")
        assert page.page.locator("input[data-path='friction.static']").input_value() == static
        marks = page.page.locator(".tour .claim").all_inner_texts()
        assert [mark[2:] for mark in marks] == [records[each]["verdict"] for each in ids]
    page.drawn("locus")
    shown = {
        name: page.page.locator(f"input[data-path='{name}']").input_value()
        for name in ("friction.slope", "sliding_speed")
    }
    own = DrumBrake(reading=RECONSTRUCTED)
    assert [float(value) for value in shown.values()] == [own.friction.slope, own.sliding_speed]
    page.page.click(".tour >> text=Look at energy")
    page.page.wait_for_selector("section[data-panel=energy].looked")
    page.page.click(".tour >> text=End the tour")
    assert page.page.locator(".tour").is_hidden()


def test_another_slope_is_judged_by_itself(monkeypatch, records):
    asked = []

    def judged(case, progress):
        asked.append(case)
        return records

    monkeypatch.setattr(tour, "_READY", {})
    monkeypatch.setattr(tour, "verdicts", judged)
    usual = function_of("tour")(brake(), Options({}), Work()).data
    steep = function_of("tour")(brake(**{"friction.slope": -0.3}), Options({}), Work()).data
    again = function_of("tour")(brake(**{"friction.slope": -0.3, "k3": 1.5e8}), Options({}), Work()).data
    assert usual["assumed"]
    assert not steep["assumed"]
    assert [case.alpha for case in asked] == [0.05, 0.3], "each case once: the tour's own values set the rest"
    assert again == steep
    known = {claim["id"] for claim in usual["claims"]}
    assert all(set(step["claims"]) <= known for step in usual["steps"])
    assert set().union(*(step["claims"] for step in usual["steps"])) == known, "the tour passes every claim"
    with pytest.raises(OptionError, match="drum brake"):
        function_of("tour")(design_of_the_belt(), Options({}), Work())


def test_a_case_without_contacts_has_eigenvalues_only():
    records = verdicts(Case("published_matrices"))
    answers = [part["roads"] for each in records for part in each["parts"]]
    assert {road["verdict"] for roads in answers for name, road in roads.items() if name != "eigenvalues"} == {
        "not decidable"
    }

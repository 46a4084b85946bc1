"""`squealbox report` as its reader has it: one file, in a real browser without a network, on screen and on paper."""

import base64
import io
import json
import re
import wave

import numpy as np
import pytest

from squealbox import Coulomb, DiscBrake, DrumBrake, LinearSlope, Ramp, complex_modes, reduce, simulate
from squealbox.cli import BAD_INPUT, DONE, main
from squealbox.files import write_design
from squealbox.plots.figure_data import unpacked
from squealbox.report import Examination, ReportError, design_page, examine, report, words
from squealbox.report.blocks import Chart, Drawing, Page, Section
from squealbox.report.page import render, write_page
from squealbox.report.vibrating import vibrating
from squealbox.signals import dominant_frequency, sound_level
from squealbox.studies import sweep

SIZE = {"width": 1280, "height": 800}
SQUEALING = DrumBrake(friction=LinearSlope(0.45, -0.05))
SECTIONS = """
[map]
x = { parameter = "friction.static", range = [0.1, 0.6], points = 21 }
y = { parameter = "load", range = ["0.5 kN", "5 kN"], points = 21 }
"""


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    """The report of a squealing drum, written by the command."""
    folder = tmp_path_factory.mktemp("report")
    file = write_design(SQUEALING, folder / "brake.toml", sections=SECTIONS)
    assert main(["report", str(file), "--out", str(folder / "brake.html")]) == DONE
    return folder / "brake.html"


@pytest.fixture(scope="module")
def offline(browser):
    with browser.new_context(offline=True, viewport=SIZE) as context:
        yield context


class Opened:
    """A page opened from its file, with every request it made and every error it had."""

    def __init__(self, offline, path):
        self.page = offline.new_page()
        self.errors, self.requests = [], []
        self.page.on("pageerror", lambda error: self.errors.append(str(error)))
        self.page.on(
            "console", lambda said: self.errors.append(said.text) if said.type in ("error", "warning") else None
        )
        self.page.on("requestfailed", lambda request: self.errors.append(f"failed: {request.url[:60]}"))
        self.page.on("request", lambda request: self.requests.append(request.url))
        self.page.goto(path.as_uri())


def anew(offline, written):
    reading = Opened(offline, written)
    reading.page.wait_for_selector("html[data-charts]")
    yield reading
    reading.page.close()


untouched = pytest.fixture(anew, name="untouched")  # opened for one test
opened = pytest.fixture(anew, scope="module", name="opened")  # for all that read it


def test_it_opens_without_network_request_or_error(untouched, written):
    assert untouched.page.evaluate("document.documentElement.dataset.charts") == "drawn"
    assert untouched.errors == []
    assert [url for url in untouched.requests if not url.startswith("data:")] == [written.as_uri()]
    assert written.stat().st_size < 2e6


def test_an_error_and_a_request_are_seen(offline, tmp_path):
    bad = tmp_path / "bad.html"
    bad.write_text("<img src='http://example.invalid/x.png'><script>throw new Error('broken')</script>")
    reading = Opened(offline, bad)
    reading.page.wait_for_load_state()
    assert any("broken" in error for error in reading.errors)
    assert any("example.invalid" in url for url in reading.requests)
    reading.page.close()


def test_its_policy_runs_no_other_script_and_connects_nowhere(opened):
    ran = opened.page.evaluate("""() => {
        const script = document.createElement("script");
        script.textContent = "window.strange = 1";
        document.head.append(script);
        return window.strange ?? 0;
    }""")
    assert ran == 0
    refused = opened.page.evaluate("fetch('http://127.0.0.1:9/').then(() => 'sent', (error) => error.name)")
    assert refused == "TypeError"
    assert "default-src 'none'" in opened.page.get_attribute("meta[http-equiv]", "content")


def numbers(written):
    """What each chart of a page is drawn from: its figures with their arrays in place, by name."""
    charts = []
    for text in re.findall(r'<script type="application/json">(.*?)</script>', written.read_text()):
        given = json.loads(text)
        if "figures" not in given:  # the brake that vibrates
            continue
        arrays = {name: np.frombuffer(base64.b64decode(packed), "<f4") for name, (_, packed) in given["arrays"].items()}
        charts.append({each["name"]: unpacked(given, arrays, each["name"]) for each in given["figures"]})
    return charts


def test_the_charts_show_the_numbers(opened, written):
    modes, plane, motion = numbers(written)
    curves = [each for each in modes["growth"]["layers"] if each["kind"] == "line"]
    assert [each["column"] for each in curves] == ["mode 1", "mode 2"]
    assert len(curves[0]["x"]) > 200
    k = int(np.argmin(np.abs(curves[0]["x"] - 0.6)))
    there = complex_modes(SQUEALING.replace({"friction.static": float(curves[0]["x"][k])}))
    assert sorted(each["y"][k] for each in curves) == pytest.approx(np.sort(there.growth_rate[:2]), rel=1e-4)
    (stretch,) = [each for each in modes["growth"]["layers"] if each["kind"] == "band"]
    assert stretch["from"] == pytest.approx(0.33269, abs=5e-6)
    assert [modes["growth"][way]["unit"] for way in ("x", "y")] == ["", "1/s"]
    assert (plane["map"]["heat"]["rows"], plane["map"]["heat"]["columns"]) == (21, 21)
    assert plane["map"]["layers"][-1]["x"] == pytest.approx([0.45])
    assert [each["name"] for name in ("motion", "spectrum") for each in motion[name]["layers"]] == ["x", "y", "x", "y"]
    drawn = opened.page.locator(".chart").evaluate_all(
        "all => all.map((chart) => [chart.dataset.figure, chart.querySelectorAll('.layer').length])"
    )
    assert dict(drawn) == {"frequency": 6, "growth": 5, "map": 2, "motion": 4, "spectrum": 4}  # with legends


def test_a_chart_is_read_out_zoomed_into_and_dark_by_night(untouched):
    page = untouched.page
    page.locator(".chart canvas:not([hidden])").scroll_into_view_if_needed()
    box = page.locator(".chart canvas:not([hidden])").bounding_box()
    page.mouse.move(box["x"] + 0.8 * box["width"], box["y"] + 0.5 * box["height"])
    said = page.locator("[data-figure=map] .reading").text_content()
    found = re.fullmatch(r"([\d.]+), ([\d.]+) (k?)N: ([\d.]+) 1/s, ([\d.]+) Hz", said)
    friction, load = float(found[1]), float(found[2]) * (1e3 if found[3] else 1.0)
    worst = complex_modes(SQUEALING.replace({"friction.static": friction, "load": load})).most_unstable
    assert float(found[4]) == pytest.approx(worst.growth_rate, rel=0.05)  # of the nearest cell of 21 x 21
    assert float(found[5]) == pytest.approx(worst.frequency, rel=0.02)
    ticks = (
        "() => ['frequency', 'growth'].map((name) => document.querySelector(`[data-figure=${name}] .axis`).textContent)"
    )
    before = page.evaluate(ticks)
    page.locator("[data-figure=growth] svg").press("+")
    near = page.evaluate(ticks)
    assert near[0] == near[1] != before[0], "both over one axis"
    page.locator("[data-figure=growth] svg").press("0")
    assert page.evaluate(ticks) == before
    page.emulate_media(color_scheme="dark")
    ink = "getComputedStyle(document.querySelector('.chart .axis-label')).fill"
    assert min(map(int, re.findall(r"\d+", page.evaluate(ink)))) > 200
    page.emulate_media(color_scheme="light")
    assert max(map(int, re.findall(r"\d+", page.evaluate(ink)))) < 60


def test_it_says_what_an_engineer_asks(opened):
    text = opened.page.inner_text("main")
    critical = re.search(r"Stability changes at friction\.static = ([\d.]+)", text)
    assert float(critical[1]) == pytest.approx(0.33269, abs=5e-6)  # the digits printed
    assert "Unstable: it will squeal at about 2.086 kHz" in text
    assert "flutter" in text
    assert (
        "it would have to pull, where a unilateral contact lifts off" in text
    )  # shoe 1 carries -612 N in this reading
    assert "stable limit cycle" in text
    assert "100 cm²" in text
    assert "an assumption" in text
    for name, about, _ in SQUEALING.leaves():
        assert name in text
        assert about.meaning in text


def test_its_sound_has_the_frequency_of_the_motion(opened):
    uri = opened.page.get_attribute("audio", "src")
    content = base64.b64decode(uri.partition(",")[2])
    with wave.open(io.BytesIO(content)) as file:
        assert (file.getnchannels(), file.getsampwidth(), file.getframerate()) == (1, 2, 44100)
        heard = np.frombuffer(file.readframes(file.getnframes()), dtype=np.int16).astype(float)
    motion = simulate(SQUEALING, 0.1, times=10_001)
    late = dominant_frequency(motion, dof="y", begin=0.05)
    assert dominant_frequency(heard[22_050:], rate=44100.0) == pytest.approx(late, rel=1e-5)
    seconds = opened.page.evaluate(
        "new Promise((done) => { const sound = document.querySelector('audio');"
        "sound.onloadedmetadata = () => done(sound.duration); sound.load(); })"
    )
    assert seconds == pytest.approx(2.0, abs=0.01)


def test_it_prints_its_figures_and_opens_what_is_folded(opened):
    pdf = opened.page.pdf(prefer_css_page_size=True)
    assert pdf.startswith(b"%PDF")
    assert 6 <= len(re.findall(rb"/Type\s*/Page\b", pdf)) <= 20
    opened.page.emulate_media(media="print")
    assert not opened.page.locator("figure.plotted .live").first.is_visible()
    assert opened.page.locator("figure.plotted img").first.is_visible()
    assert opened.page.locator("text=how the paper's friction is read").last.is_visible()
    opened.page.emulate_media(media="screen")
    assert opened.page.locator("figure.plotted .live").first.is_visible()


def test_no_picture_is_missing_and_no_text_leaves_the_page(opened):
    assert opened.page.evaluate("[...document.images].every((image) => image.complete && image.naturalWidth > 0)")
    assert opened.page.evaluate("document.documentElement.scrollWidth <= document.documentElement.clientWidth")


@pytest.fixture(scope="module")
def quiet() -> Examination:
    return examine(DrumBrake(friction=LinearSlope(0.30, -0.05)))


def test_a_cycle_beside_stable_sliding_is_found_and_said(quiet):
    assert quiet.stable
    assert quiet.coexists
    assert len(quiet.tried) > 1
    text = " ".join(str(block) for section in design_page(quiet).sections for block in section.blocks)
    assert "beside stable sliding" in text


def test_a_stable_brake_is_said_to_decay_and_the_level_is_that_of_its_cycle(quiet):
    said = " ".join(words.verdict(quiet))
    assert "The least damped mode decays" in said
    assert "grows" not in said.partition("There is a")[0]
    assert "dies away" in said
    cycle = quiet.cycle
    motion = simulate(quiet.system, 40.0 * cycle.period, start=(cycle.q[0], cycle.qd[0]), times=8001)
    level = float(sound_level(motion, dof=1).weighted)  # y moves most; by the motion itself, not the cycle repeated
    assert float(quiet.cycle_loudness.weighted) == pytest.approx(level, abs=0.5)
    tiles = {what: number for number, what, _ in design_page(quiet).sections[0].blocks[0].tiles}
    assert tiles["estimated level of the limit cycle at 1 m"] == f"{level:.0f} dB(A)"


def paused(page, seen):
    """What is seen of a picture that moves until Pause is pressed, and then stands still."""
    first = page.evaluate(seen)
    page.wait_for_function(f"first => {seen} !== first", arg=first)  # it moves
    page.get_by_role("button", name="Pause").click()
    still = page.evaluate(seen)
    page.wait_for_timeout(150)
    assert page.evaluate(seen) == still
    return still


def test_the_brake_vibrates_in_its_worst_mode_and_stands_still_on_paper(offline, quiet, tmp_path):
    block = vibrating(quiet.design, quiet.modes)
    angles = np.linspace(0.0, 2.0 * np.pi, 3601)[:, None, None]
    swing = np.cos(angles) * block.arrays["re"] - np.sin(angles) * block.arrays["im"]
    height = block.data["box"][3] - block.data["box"][2]
    assert np.max(np.linalg.norm(swing, axis=-1)) == pytest.approx(0.14 * height, rel=1e-6)
    path = write_page(Page("a page", "a lead", (Section("one", (block,)),)), tmp_path / "drawn.html")
    reading = Opened(offline, path)
    page = reading.page
    seen = "document.querySelector('figure.vibrating circle').getAttribute('cx')"
    paused(page, seen)
    page.emulate_media(media="print")
    assert page.locator("figure.vibrating img").is_visible()
    assert not page.locator("figure.vibrating svg").is_visible()
    assert reading.errors == []
    page.close()


def test_a_finite_element_brake_vibrates_and_is_turned_by_hand(offline, tmp_path):
    brake = reduce(DiscBrake(element_size=0.05, friction=Coulomb(0.5)), (2500.0, 5000.0))
    solid = vibrating(brake, complex_modes(brake))
    path = write_page(Page("a page", "a lead", (Section("one", (solid,)),)), tmp_path / "solid.html")
    assert path.stat().st_size < 1e6
    reading = Opened(offline, path)
    page = reading.page
    seen = "document.querySelector('figure.vibrating canvas').toDataURL()"
    page.wait_for_function(f"{seen}.length > 5000")
    still = paused(page, seen)
    page.locator("figure.vibrating canvas").press("ArrowRight")
    assert page.evaluate(seen) != still  # it was turned
    assert "contact slips" in page.inner_text(".keys")
    assert not page.locator("figure.vibrating img").is_visible()
    page.emulate_media(media="print")
    assert page.locator("figure.vibrating img").is_visible()
    assert not page.locator("figure.vibrating canvas").is_visible()
    assert reading.errors == []
    assert [url for url in reading.requests if not url.startswith("data:")] == [path.as_uri()]
    page.close()


def test_what_cannot_be_computed_is_said():
    braking = examine(DrumBrake(sliding_speed=Ramp(0.2, -4.0)))
    assert set(braking.missing) == {"hopf", "cycle"}
    assert "varies in time" in braking.missing["cycle"]
    assert "sliding_speed.start" not in braking.ranking.parameters
    assert braking.map is not None
    text = render(design_page(braking))
    assert "Not computed, cycle: expected constant loads" in text


def test_a_result_and_a_folder_of_results(tmp_path, offline):
    brake = DrumBrake()
    complex_modes(brake).save(tmp_path / "modes.nc")
    simulate(brake, 5e-3, times=501).save(tmp_path / "motion.nc")
    assert main(["report", str(tmp_path / "motion.nc"), "--out", str(tmp_path / "motion.html")]) == DONE
    assert main(["report", str(tmp_path), "--out", str(tmp_path / "all.html")]) == DONE
    for name, parts in (
        ("motion", ["Trajectory", "half peak to peak"]),
        ("all", ["ComplexModes", "Trajectory", "Drum brake"]),
    ):
        reading = Opened(offline, tmp_path / f"{name}.html")
        reading.page.wait_for_load_state()
        assert reading.errors == []
        text = reading.page.inner_text("body")
        assert [part for part in parts if part not in text] == []
        reading.page.close()


def test_a_study_and_its_folder(tmp_path, offline):
    axes = {"friction.static": np.linspace(0.1, 0.5, 9), "load": np.linspace(500.0, 2000.0, 5)}
    sweep(DrumBrake(), axes, complex_modes, keep=["largest_growth_rate", "stable"], out=tmp_path / "study")
    assert main(["report", str(tmp_path / "study"), "--out", str(tmp_path / "study.html")]) == DONE
    reading = Opened(offline, tmp_path / "study.html")
    reading.page.wait_for_load_state()
    assert reading.errors == []
    text = reading.page.inner_text("body")
    assert "45 points, friction.static (9) x load (5): 45 completed" in text
    assert "completed" in reading.page.locator("td", has_text="how the computation").locator("xpath=..").text_content()
    assert "mass of the drum" in text
    assert reading.page.locator("figure img").count() >= 3
    reading.page.close()


@pytest.mark.parametrize(
    ("source", "sentence"),
    [
        ("nowhere.toml", "nowhere.toml"),
        ("nowhere.nc", "no such file or folder"),
        ("notes.txt", "not a file a report can be made of, expected a design file"),
        ("empty", "holds no results"),
        ("broken.nc", "not a readable Result"),
        ("broken.toml", "broken.toml:1: not TOML"),
    ],
)
def test_a_bad_source_is_one_sentence(source, sentence, tmp_path, capsys):
    (tmp_path / "empty").mkdir()
    for name in ("notes.txt", "broken.nc", "broken.toml"):
        (tmp_path / name).write_text("not at all")
    assert main(["report", str(tmp_path / source), "--out", str(tmp_path / "out.html")]) == BAD_INPUT
    said = capsys.readouterr().err
    assert sentence in said
    assert len(said.strip().splitlines()) == 1
    assert not (tmp_path / "out.html").exists()


def test_where_figures_cannot_be_drawn_the_pictures_stay_and_it_says_so(offline, written):
    reading = offline.new_page()
    reading.add_init_script("CSS.supports = () => false")
    reading.goto(written.as_uri())
    reading.wait_for_selector("html[data-charts=still]")
    assert "stand still here" in reading.inner_text("#still")
    assert not reading.locator("figure.plotted .live").first.is_visible()
    assert reading.locator("figure.plotted img").first.is_visible()
    reading.close()


def test_a_page_without_figures_has_no_script_and_a_chart_is_made_of_figures_as_data():
    still = Page("a page", "a lead", (Section("one", (Drawing(b"\x89PNG", "a caption"),)),))
    assert "<script" not in render(still)
    with pytest.raises(ReportError, match="FigureData"):
        Chart(Drawing(b"\x89PNG", "a caption"), {"data": [], "layout": {}})


def test_a_bad_target_or_thing_is_refused(tmp_path):
    with pytest.raises(ReportError, match="ends in .html"):
        report(DrumBrake(), tmp_path / "brake.pdf")
    with pytest.raises(ReportError, match="is not there"):
        report(DrumBrake(), tmp_path / "nowhere" / "brake.html")
    with pytest.raises(ReportError, match="a report of int"):
        report(3, tmp_path / "three.html")

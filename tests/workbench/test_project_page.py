"""The project on the page: designs side by side, notes, history and recordings; and what a crash leaves of them."""

import signal
import time

import numpy as np
import pytest

from squealbox import DrumBrake, read_design
from squealbox.workbench.folder import Project
from workbench.browsing import Page
from workbench.conftest import Server
from workbench.test_recording import stop  # noqa: F401 - a recording of a second and a half

PANEL = "section[data-panel=project]"
FILE = """# bench 7, Monday
brake = "drum_brake"
theta1 = "40 deg"   # measured

[map]
x = { parameter = "k3", range = ["100 kN/mm", "300 kN/mm"] }   # as agreed
y = { parameter = "theta1", range = ["20 deg", "160 deg"] }

[onset]
parameter = "theta1"
range = ["20 deg", "120 deg"]

[simulate]
duration = "20 ms"
start = "sliding"
"""


@pytest.fixture
def own(tmp_path):
    """A server of one test, on a project folder of its own."""
    running = Server(tmp_path, tmp_path / "bench")
    yield running
    running.stop()


@pytest.fixture
def folder(own, tmp_path):
    return tmp_path / "bench"


def project_page(page):
    page.page.click("#ask-project")
    page.page.wait_for_selector(f"{PANEL}[data-state=drawn]")


def save(page, name, many):
    page.page.fill(f"{PANEL} [aria-label^='Name for']", name)
    page.page.click("text=Save this design")
    page.page.wait_for_selector(f"{PANEL}[data-designs='{many}']")


WHOLE = "import('/static/app.js').then(({ app }) => app.store.whole)"


def kept(page, folder):
    """Wait until the state on disk is that of the page."""
    end = time.monotonic() + 60.0
    while (Project(folder).last() or {}).get("state") != page.page.evaluate(WHOLE):
        assert time.monotonic() < end
        page.page.wait_for_timeout(50)


def test_variants_are_saved_compared_opened_deleted_and_taken_back(own, folder, browser):
    with Page(browser, own) as page:
        page.goto()
        project_page(page)
        assert "No design yet" in page.says("project")
        save(page, "as built", 1)
        page.enter("friction.static", 0.45)
        save(page, "wet", 2)
        text = page.page.locator(f"{PANEL} .designs").inner_text()
        assert "unstable, flutter" in text
        assert "0.3327" in text
        page.page.click("[aria-label='Open: as built']")
        page.until("document.querySelector('[data-path=\"friction.static\"]').value === '0.3'")
        page.page.click("[aria-label='As A: wet']")
        page.page.click("#ask-silences")
        page.page.wait_for_selector("section[data-panel=compare][data-compared=yes]")
        assert "0.45" in page.page.locator("section[data-panel=compare] table").inner_text()
        project_page(page)
        page.page.fill("[aria-label='Note on wet']", "squeals from 12 bar")
        page.page.press("[aria-label='Note on wet']", "Enter")
        page.page.click("[aria-label='Delete: wet']")
        page.page.wait_for_selector(f"{PANEL}[data-designs='1']")
        page.page.click("text=Take back wet")
        page.page.wait_for_selector(f"{PANEL}[data-designs='2']")
        assert page.page.input_value("[aria-label='Note on wet']") == "squeals from 12 bar"
        assert read_design(folder / "designs" / "wet.toml").friction.static == 0.45


def test_notes_save_themselves_and_a_named_state_comes_back(own, folder, browser):
    with Page(browser, own) as page:
        page.goto()
        project_page(page)
        page.page.fill("[aria-label=Notes]", "Monday: new linings")
        page.enter("friction.static", 0.4)
        page.page.fill(f"{PANEL} [aria-label^='Name for']", "before the trip")
        page.page.click("text=Name this state")
        page.page.wait_for_selector("[aria-label='Go back to before the trip']")
        page.enter("friction.static", 0.2)
        kept(page, folder)
        assert (folder / "notes.md").read_text() == "Monday: new linings"
        page.page.click("[aria-label='Go back to before the trip']")
        page.until("document.querySelector('[data-path=\"friction.static\"]').value === '0.4'")
        page.page.click("#undo")
        page.until("document.querySelector('[data-path=\"friction.static\"]').value === '0.2'")


def test_a_crash_of_server_and_browser_loses_nothing(own, folder, browser, tmp_path):
    with Page(browser, own) as page:
        page.goto()
        page.enter("friction.static", 0.41)
        page.page.click("#ask-when")
        kept(page, folder)
        own.process.send_signal(signal.SIGKILL)
        own.process.wait(20)
        page.expected = ("ERR_", "WebSocket")
    other = Server(tmp_path, folder)
    try:
        with Page(browser, other) as page:
            page.goto()
            assert page.page.input_value("[data-path='friction.static']") == "0.3", "fresh until the user goes on"
            page.page.wait_for_selector(".offer")
            page.page.click("text=Go on where you were")
            page.page.wait_for_selector("#panels[data-question=when]")
            page.until("document.querySelector('[data-path=\"friction.static\"]').value === '0.41'")
            assert page.page.locator(".offer").count() == 0
        with Page(browser, other) as page:
            page.goto()
            page.page.wait_for_selector(".offer")
            page.page.click("#ask-project")
            page.page.click("text=Not now")
            assert page.page.locator(".offer").count() == 0
            page.page.wait_for_timeout(1500)
            page.page.wait_for_timeout(1500)
            found = Project(folder).last()["state"]["values"]
            assert found == {"friction.static": 0.41}, "to look around changes nothing"
    finally:
        other.stop()


def test_two_pages_see_each_other_and_lose_nothing(own, folder, browser):
    with Page(browser, own) as one, Page(browser, own) as two:
        for page in (one, two):
            page.goto()
            project_page(page)
        save(one, "one", 1)
        save(two, "two", 2)
        one.page.fill("[aria-label=Notes]", "of one")
        one.page.wait_for_timeout(1500)
        two.page.fill("[aria-label=Notes]", "of two")
        two.page.wait_for_timeout(1500)
        assert (folder / "notes.md").read_text() == "of two"
        assert [path.read_text() for path in (folder / "trash").glob("*.md")] == ["of one"]
        for i in range(5):
            one.enter("friction.static", round(0.31 + 0.01 * i, 2))
            two.enter("friction.static", round(0.41 + 0.01 * i, 2))
            one.page.wait_for_timeout(1000)
    lines, wrong = Project(folder).history()
    assert wrong == []
    assert {line["state"]["values"].get("friction.static") for line in lines} >= {0.35, 0.45}


def test_a_recording_is_kept_and_opened_again(own, folder, browser, stop):  # noqa: F811 - the fixture
    with Page(browser, own) as page:
        page.goto()
        page.ask("recording")
        page.page.set_input_files("section[data-panel=recording] input[type=file]", stop)
        page.page.wait_for_selector("section[data-panel=recording][data-state=drawn]", timeout=120_000)
        project_page(page)
        page.page.click("text=Keep the recording")
        page.page.wait_for_selector("[aria-label='Open stop.wav']")
        assert (folder / "measurements" / "stop.wav").read_bytes() == stop.read_bytes()
    with Page(browser, own) as page:
        page.goto()
        project_page(page)
        page.page.click("[aria-label='Open stop.wav']")
        page.page.wait_for_selector("section[data-panel=recording][data-state=drawn]", timeout=120_000)
        assert page.page.get_attribute("section[data-panel=recording]", "data-events") == "1"


def test_what_is_saved_goes_into_results_where_that_is_wished(own, folder, browser):
    with Page(browser, own) as page:
        page.goto()
        project_page(page)
        page.page.check("text=keep what I save")
        page.ask("locus")
        with page.page.expect_download():
            page.page.select_option("[aria-label='Save Modes over a parameter']", "CSV")
        page.until("() => document.getElementById('note').textContent.includes('results/')")
        project_page(page)
        page.page.wait_for_selector(f"{PANEL} a[download]")
        assert any(path.read_text().startswith('"') for path in (folder / "results").glob("*.csv"))


def test_presets_are_offered(own, browser):
    with Page(browser, own) as page:
        page.goto()
        project_page(page)
        page.page.select_option("[aria-label=preset]", "mechanism")
        page.until("() => import('/static/app.js').then(({ app }) => app.store.text?.includes('mechanism'))")
        page.until("document.getElementById('title').textContent.toLowerCase().includes('mechanism')")


def test_a_file_keeps_its_sections_comments_and_name(page, tmp_path):
    path = tmp_path / "bench 7.toml"
    path.write_text(FILE)
    page.page.click("#open")
    page.page.set_input_files("#opener-file", path)
    page.until("document.querySelector('[data-path=theta1]')?.value === '40'")
    chosen = page.page.evaluate("import('/static/app.js').then(({ app }) => app.store.settings)")
    assert (chosen["map"]["x"], chosen["map"]["y"]) == ("k3", "theta1")
    assert chosen["motion"]["start"] == "sliding"
    page.drawn("locus")
    low, high = page.numbers("locus", "frequency")["x"]["domain"]
    assert (low, high) == (pytest.approx(20.0), pytest.approx(160.0)), "one range for a parameter"
    page.drawn("map")
    assert page.numbers("map", "map")["x"]["domain"] == pytest.approx([100.0, 300.0])
    page.enter("theta1", 45)
    page.option("map", x="k4")
    with page.page.expect_download() as taken:
        page.page.click("#save")
    assert taken.value.suggested_filename == "bench 7.toml"
    text = taken.value.path().read_text()
    assert 'theta1 = "45 deg"   # measured' in text
    assert "# bench 7, Monday" in text
    assert 'parameter = "k4"' in text
    assert "# as agreed" in text
    assert "[simulate]" in text
    again = tmp_path / "again.toml"
    again.write_text(text)
    assert read_design(again) == DrumBrake(theta1=float(np.deg2rad(45.0)))


def test_a_folder_that_cannot_be_written_says_so_once(browser, tmp_path):
    (tmp_path / "bench").mkdir()
    (tmp_path / "bench" / "designs").write_text("a file where a folder should be")
    (tmp_path / "bench" / "state.json").mkdir()
    running = Server(tmp_path, tmp_path / "bench")
    try:
        with Page(browser, running) as page:
            page.goto()
            page.enter("friction.static", 0.4)
            page.until("() => document.getElementById('note').textContent.includes('is not kept')")
            page.page.click("#ask-project")
            page.page.fill(f"{PANEL} [aria-label^='Name for']", "a")
            page.page.click("text=Save this design")
            page.until("() => document.getElementById('note').textContent.includes('designs cannot be read')")
            assert page.page.input_value("[data-path='friction.static']") == "0.4"
    finally:
        running.stop()

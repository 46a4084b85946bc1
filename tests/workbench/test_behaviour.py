"""How the page behaves: restarts, links, files, keys, sizes, colours, and no old answer under a new design."""

import re
import tomllib

import numpy as np
import pytest
from PIL import Image

from squealbox import DrumBrake, LinearSlope, Stribeck, read_design, write_design
from workbench.browsing import Page
from workbench.conftest import Server

DRAWN_WHEN = """() => import('/static/app.js').then(({ app }) => {
    const ask = app.connection.ask.bind(app.connection);
    app.connection.ask = (...words) => ask(...words).then(f => new Promise(done => setTimeout(() => done(f), 120)));
    window.drawings = [];
    window.answers = 0;
    for (const view of app.views) {
        const draw = view.draw;
        view.draw = frame => {
            window.drawings.push([view.name, view.drawn === JSON.stringify(view.request())]);
            draw(frame);
        };
    }
})"""
PIXELS = """() => { const c = document.querySelector('section[data-panel=map] canvas');
    return Array.from(c.getContext('2d').getImageData(0, 0, 40, 40).data).join(); }"""
SMALL = """() => [...document.querySelectorAll('body *')].filter(e => [...e.childNodes].some(
    n => n.nodeType === 3 && n.textContent.trim()) && e.getClientRects().length
    && parseFloat(getComputedStyle(e).fontSize) < 12).map(e => e.tagName + ': ' + e.textContent.slice(0, 40))"""


@pytest.fixture
def page(same_page):
    """None of these needs a page of its own."""
    return same_page


def value(page, path):
    return page.page.locator(f"input[data-path='{path}']").input_value()


def wait_for_value(page, path, text):
    page.until("([p, t]) => document.querySelector(`[data-path='${p}']`)?.value === t", arg=[path, text])


@pytest.fixture
def own_page(server, browser):
    """A page for a test that changes the page itself, which others would then meet."""
    with Page(browser, server) as opened:
        opened.goto()
        yield opened


def test_an_old_answer_is_never_drawn_under_a_new_design(own_page):
    page = own_page
    page.page.evaluate(DRAWN_WHEN)
    for i in range(12):  # each change comes while the answer to the last is under way
        page.page.evaluate(
            """value => { const slider = document.querySelector('[data-slider="friction.static"]');
            slider.value = value; slider.dispatchEvent(new Event('input', { bubbles: true }));
            slider.dispatchEvent(new Event('change', { bubbles: true })); }""",
            0.3 + 0.01 * i,
        )
        page.page.wait_for_timeout(70)
    page.until("() => window.drawings.some(([name]) => name === 'verdict')")
    page.drawn("locus")
    drawings = page.page.evaluate("window.drawings")
    assert all(current for _, current in drawings)
    assert sum(name == "locus" for name, _ in drawings) < 12, "no answer came late: the test shows nothing"
    assert "0.41" in page.page.locator("#verdict").inner_text()


def test_the_page_survives_a_restart_of_the_server(browser, tmp_path):
    first = Server(tmp_path)
    with Page(browser, first) as page:
        page.expected = ("WebSocket", "ERR_CONNECTION_REFUSED", "Failed to load")
        page.goto()
        page.enter("friction.static", 0.45)
        page.page.wait_for_selector("#verdict[data-verdict=unstable]")
        first.stop()
        page.page.wait_for_selector("body[data-connected=no]")
        assert "waiting" in page.page.locator("#link-state").inner_text()
        page.enter("load1", 2000)  # nothing is lost meanwhile
        second = Server(tmp_path, port=first.port)
        try:
            page.page.wait_for_selector("body[data-connected=yes]", timeout=30_000)
            page.drawn("locus")
            assert value(page, "friction.static") == "0.45"
            assert value(page, "load1") == "2000"
            page.page.wait_for_selector("#verdict[data-verdict=unstable][data-state=drawn]")
        finally:
            second.stop()


def test_a_link_carries_the_design_to_another_page(page, browser, server):
    page.page.select_option("[data-field=friction] select", "stribeck")
    page.page.wait_for_selector("input[data-path='friction.speed']")
    page.enter("theta2", 100)
    page.page.select_option("section[data-panel=locus] select", "theta1")
    page.drawn("locus")
    fragment = "#" + page.page.evaluate("location.hash").lstrip("#")
    with Page(browser, server) as other:
        other.goto(fragment)
        wait_for_value(other, "theta2", "100")
        assert other.page.locator("input[data-path='friction.speed']").count() == 1
        assert other.numbers("locus", "frequency")["x"]["label"] == "theta1 [deg]"


def test_a_broken_link_opens_the_usual_page(page, browser, server):
    with Page(browser, server) as other:
        other.goto("#d=%%%not-a-link")
        assert value(other, "friction.static") == "0.3"


def test_a_file_is_opened_and_saved(page, tmp_path):
    brake = DrumBrake(friction=Stribeck(0.5, 0.3, 0.1), reading="eq3", load1=1234.0)
    path = write_design(brake, tmp_path / "brake.toml")
    page.page.click("#open")
    page.page.set_input_files("#opener-file", path)
    wait_for_value(page, "load1", "1234")
    page.enter("load2", 4321)
    page.drawn("locus")
    with page.page.expect_download() as saved:
        page.page.click("#save")
    saved.value.save_as(tmp_path / "saved.toml")
    assert read_design(tmp_path / "saved.toml") == brake.replace(load2=4321.0)


def test_a_wrong_file_is_told_line_by_line(page):
    page.page.click("#open")
    page.page.fill("#opener-text", 'brake = "drum_brake"\nm = "-1 kg"\nfriction = { law = "linear" }\n')
    page.page.click("#opener-go")
    problems = page.page.locator("#opener-problems li")
    problems.nth(1).wait_for()  # the first says that it is being read, at first
    assert [text.split(":")[0] for text in problems.all_inner_texts()] == ["line 2", "line 3"]
    page.page.click("#opener-cancel")
    assert value(page, "m") == "1"


def test_the_command_line_opens_a_file_with_matrices_beside_it(browser, tmp_path):
    (tmp_path / "stiffness.csv").write_text("2.0, -0.5\n0.5, 2.0\n")
    text = 'brake = "own"\nM = [[1.0, 0.0], [0.0, 1.0]]\nC = [[0.01, 0.0], [0.0, 0.01]]\nK = "stiffness.csv"\n'
    (tmp_path / "own.toml").write_text(text)
    running = Server(tmp_path, tmp_path / "own.toml")
    try:
        with Page(browser, running) as page:
            page.page.goto(running.address)
            page.page.wait_for_selector("#verdict[data-verdict=unstable]", timeout=60_000)
    finally:
        running.stop()


def test_every_figure_is_saved(page, tmp_path):
    page.drawn("map")
    files = {}
    for kind in ("PNG", "SVG", "PDF", "CSV"):
        with page.page.expect_download() as saved:
            page.page.select_option("section[data-panel=map] .files select", kind)
        files[kind] = tmp_path / saved.value.suggested_filename
        saved.value.save_as(files[kind])
    assert files["PNG"].read_bytes().startswith(b"\x89PNG")
    assert files["PDF"].read_bytes().startswith(b"%PDF")
    svg = files["SVG"].read_text()
    assert "<svg" in svg
    assert "data:image/png" in svg
    assert "friction.static [-]" in svg
    lines = files["CSV"].read_text().splitlines()
    assert lines[0].startswith('"friction.static [-]","load [N]","growth rate [1/s]"')
    assert len(lines) == 1 + 101 * 101


def test_figures_are_saved_for_paper_also_from_a_dark_page(browser, server, tmp_path):
    with Page(browser, server, scheme="dark") as page:
        page.goto()
        page.drawn("map")
        background = "getComputedStyle(document.body).backgroundColor"
        dark, pixels = page.page.evaluate(background), page.page.evaluate(PIXELS)
        for kind in ("PNG", "SVG"):
            with page.page.expect_download() as saved:
                page.page.select_option("section[data-panel=map] .files select", kind)
            saved.value.save_as(tmp_path / f"map.{kind}")
        assert page.page.evaluate(background) == dark
        assert page.page.evaluate(PIXELS) == pixels, "the page keeps its colours"
    picture = np.asarray(Image.open(tmp_path / "map.PNG").convert("L"), dtype=float)
    assert picture.shape[1] > 1000  # three pixels for one of the page
    assert np.all(picture[:5, :5] == 255.0)
    border = np.concatenate([picture[:, :60].ravel(), picture[-70:, :].ravel()])
    assert np.mean(border > 200.0) > 0.9, "dark letters on white paper"
    assert np.min(border) < 100.0, "the letters are drawn"
    svg = (tmp_path / "map.SVG").read_text()
    assert "growth rate [1/s]" in svg, "what the colours mean goes with the picture"


def test_names_of_bars_and_curves_of_the_boundary_are_in_the_tables(page, tmp_path):
    heads = {}
    for panel in ("energy", "map"):
        page.drawn(panel)
        with page.page.expect_download() as saved:
            page.page.select_option(f"section[data-panel={panel}] .files select", "CSV")
        saved.value.save_as(tmp_path / panel)
        heads[panel] = (tmp_path / panel).read_text().splitlines()
    assert heads["energy"][0] == '"name","share of the growth rate [1/s]"'
    assert {line.split(",")[0] for line in heads["energy"][1:]} >= {'"shoe 1"', '"damping of x"'}
    assert '"boundary: friction.static [-]","boundary: load [N]"' in heads["map"][0]


def test_no_text_is_smaller_than_twelve_pixels(own_page):
    page = own_page
    for panel in ("locus", "map", "friction", "motion", "energy", "sensitivity"):
        page.drawn(panel)
    assert page.page.evaluate(SMALL) == []
    page.page.locator("h2").first.evaluate("e => (e.style.fontSize = '11px')")
    assert page.page.evaluate(SMALL) != [], "the check sees nothing"


def test_the_keys_do_what_the_mouse_does(page):
    page.page.locator("[data-slider=k3]").focus()
    page.page.keyboard.press("ArrowRight")
    wait_for_value(page, "k3", "191")
    page.page.keyboard.press("Control+z")
    wait_for_value(page, "k3", "190")
    page.page.locator("input[data-path=load1]").focus()
    page.page.keyboard.press("ArrowUp")
    wait_for_value(page, "load1", "1005")
    page.drawn("map")
    page.page.locator("section[data-panel=map] svg").focus()
    page.page.keyboard.press("ArrowRight")
    wait_for_value(page, "friction.static", "0.31")


@pytest.mark.parametrize("size", [(1280, 800), (1024, 768)])
def test_nothing_is_wider_than_the_window(browser, server, size):
    with Page(browser, server, size=size) as page:
        page.goto()
        assert page.page.evaluate("document.documentElement.scrollWidth <= innerWidth")
        assert page.page.evaluate("e => content.scrollWidth <= content.clientWidth")


def test_dark_is_dark_and_light_is_light(browser, server):
    shades = {}
    for scheme in ("light", "dark"):
        with Page(browser, server, scheme=scheme) as page:
            page.goto()
            colour = page.page.evaluate("getComputedStyle(document.body).backgroundColor")
            shades[scheme] = sum(int(part) for part in re.findall(r"\d+", colour))
    assert shades["light"] > 600 > 150 > shades["dark"]


def test_a_slow_panel_does_not_hold_up_the_others_and_can_be_stopped(own_page):
    page = own_page
    page.drawn("motion")
    page.page.evaluate("""() => import('/static/app.js').then(({ app }) => {
        const view = app.panels.get('motion').view;
        const request = view.request;
        view.request = () => ({ ...request(), options: { start: 'rest', duration: 60 } });
        view.update();
    })""")
    page.page.wait_for_selector("section[data-panel=motion] button.stop:visible", timeout=30_000)
    page.enter("friction.static", 0.35)
    page.drawn("locus")
    assert page.page.locator("section[data-panel=motion]").get_attribute("data-state") == "waiting"


def test_the_saved_text_is_toml(page):
    text = page.page.evaluate("""() => import('/static/app.js').then(({ app }) => app.connection.ask(
        { ask: 'sheet', toml: true, state: app.store.design })).then(frame => frame.toml)""")
    assert tomllib.loads(text)["brake"] == "drum_brake"
    assert DrumBrake() == DrumBrake(friction=LinearSlope(0.30, -0.05))

"""Led by questions: one screen each, never an empty box; the brake moves; and the page is for everybody."""

from pathlib import Path

import numpy as np
import pytest

from squealbox import DrumBrake, complex_modes
from squealbox.countermeasures import TunedMass
from squealbox.designs import DESIGNS, drawing_of
from workbench.browsing import Page

QUESTIONS = ("why", "when", "happens", "silences", "matches", "tells", "project")
CHECKS = (Path(__file__).parent / "checks.js").read_text()
RESTED = "() => ![...document.querySelectorAll('.panel:not([hidden])')].some(p => p.dataset.state === 'waiting')"
DOTS = "[...document.querySelectorAll('section[data-panel=motion] .cursor')].map(c => c.getAttribute('cx')).join()"


def wrong(page, check):
    """What a check of checks.js finds wrong with the page."""
    return page.page.evaluate(f"() => {{ {CHECKS}\nreturn {check}(); }}")


@pytest.fixture(scope="module", params=["light", "dark"])
def shared(request, server, browser):
    """One page for the tests that only look, in each of its colours."""
    with Page(browser, server, scheme=request.param) as opened:
        opened.goto()
        yield opened


def ask(page, question):
    page.page.click(f"#ask-{question}")
    page.page.wait_for_selector(f"#panels[data-question={question}]")
    page.page.wait_for_timeout(100)


@pytest.mark.parametrize("question", QUESTIONS)
def test_each_question_is_one_screen_without_an_empty_box(shared, question):
    ask(shared, question)
    assert wrong(shared, "empty") == []
    assert wrong(shared, "outside") == []
    chosen = shared.page.locator("[role=tab][aria-selected=true]")
    assert chosen.get_attribute("data-question") == question
    assert shared.page.locator("#fields").is_visible()


@pytest.mark.parametrize("question", QUESTIONS)
def test_everything_has_a_name_and_can_be_read(shared, question):
    ask(shared, question)
    shared.until(RESTED)
    for check in ("nameless", "silent", "dangling", "twice", "small", "faint"):
        assert wrong(shared, check) == []


def test_the_checks_see_faint_text_and_a_name_nobody_hears(shared):
    shared.page.evaluate("document.getElementById('title').style.color = '#777f87'")
    assert any("H2" in each for each in wrong(shared, "faint"))
    shared.page.evaluate("document.getElementById('title').style.color = ''")
    shared.page.evaluate("document.getElementById('drawing').setAttribute('aria-label', 'the brake')")
    assert len(wrong(shared, "silent")) == 1
    shared.page.evaluate("document.getElementById('drawing').removeAttribute('aria-label')")


def test_questions_take_the_arrow_keys_and_go_into_the_link(shared, browser, server):
    ask(shared, "why")
    shared.page.locator("#ask-why").focus()
    shared.page.keyboard.press("ArrowRight")
    assert shared.page.evaluate("document.activeElement.id") == "ask-when"
    shared.page.keyboard.press("ArrowLeft")
    shared.page.keyboard.press("ArrowLeft")
    assert shared.page.evaluate("document.activeElement.id") == "ask-project"
    fragment = "#" + shared.page.evaluate("location.hash").lstrip("#")
    assert shared.page.evaluate("location.search") == "", "the token does not stay in the address"
    with Page(browser, server) as other:
        other.page.goto(server.address + fragment)
        other.page.wait_for_selector("#panels[data-question=project]")


@pytest.mark.parametrize(("size", "scheme"), [((390, 844), "light"), ((640, 400), "dark"), ((768, 1024), "light")])
def test_a_phone_and_twice_the_size_lose_nothing(browser, server, size, scheme):
    with Page(browser, server, size=size, scheme=scheme) as page:
        page.goto()
        for question in QUESTIONS:
            ask(page, question)
            assert page.page.evaluate("document.documentElement.scrollWidth <= innerWidth"), question
            assert wrong(page, "empty") == []
            first = page.page.locator(".panel:not([hidden])").first.bounding_box()
            assert first["width"] > 0.5 * min(size[0], 700)
        assert page.page.locator("#verdict").bounding_box()["y"] < size[1]
        assert wrong(page, "faint") == []


def spots(page):
    return page.page.locator(".moving svg").inner_html()


def test_the_brake_moves_and_stands_still_for_those_who_want_that(shared, browser, server):
    ask(shared, "why")
    shared.page.emulate_media(reduced_motion="no-preference")
    shared.drawn("moving")
    before = spots(shared)
    shared.page.wait_for_timeout(300)
    assert spots(shared) != before
    assert "y" in shared.says("moving")
    assert "°" in shared.says("moving"), "the phase between the freedoms is told"
    shared.page.click("section[data-panel=moving] >> text=Pause")
    still = spots(shared)
    shared.page.wait_for_timeout(300)
    assert spots(shared) == still
    shared.page.evaluate("import('/static/app.js').then(({ app }) => app.dispatchEvent(new CustomEvent('motion')))")
    assert spots(shared) == still, "news of a motion do not move what is held"
    shared.page.click("section[data-panel=moving] >> text=Move")
    shared.page.emulate_media(reduced_motion="reduce")
    with Page(browser, server) as calm:
        calm.goto()
        calm.drawn("moving")
        still = spots(calm)
        calm.page.wait_for_timeout(300)
        assert spots(calm) == still


def test_stick_and_slip_have_their_colours_and_a_dot_goes_along(page):
    page.page.emulate_media(reduced_motion="no-preference")
    page.page.select_option("#brake", "mass_on_belt")
    page.drawn("motion")
    page.page.wait_for_selector(".contact[data-state=stick]", timeout=30_000)
    page.page.wait_for_selector(".contact[data-state=slip]", timeout=30_000)
    before = page.page.evaluate(DOTS)
    assert before
    page.until(f"before => {DOTS} !== before", arg=before)


@pytest.mark.parametrize("name", sorted(DESIGNS))
def test_each_freedom_moves_its_part_and_no_wall(name):
    design = DESIGNS[name]()
    system, drawn = design.system(), drawing_of(design)
    sizes = dict(zip(system.names, np.abs(drawn.moved(system.size)).max(axis=(1, 2)), strict=True))
    seen = [
        size for dof, size in sizes.items() if dof != "q2"
    ]  # the disc tilts about two axes: one is not in the section
    assert min(seen) > 0.0, "each freedom is seen"
    for shape in drawn.shapes:
        if shape.role in ("motion", "support"):
            assert not np.any(shape.moved(system.size)), "walls, the belt and its arrow stand where they are"
    assert len(drawn.contacts) in (0, len(system.contacts))
    assert drawn.contacts_moved(system.size).shape == (system.size, len(drawn.contacts), 2)
    assert set(drawn.places()) <= set(design.scalars()) | set(design.parameters())


def test_the_drum_moves_as_its_mode_does_and_its_springs_share_it_out():
    drawn = drawing_of(DrumBrake())
    shape = complex_modes(DrumBrake()).most_unstable.shape.real
    moved = np.tensordot(shape, drawn.moved(2), axes=1)
    inside = np.hypot(*drawn.points.T) < 0.5
    assert np.allclose(moved[inside], shape)
    way = np.linalg.norm(moved, axis=1)
    assert np.max(way) == pytest.approx(np.linalg.norm(shape), rel=1e-12)
    assert np.any((way > 0.01 * np.max(way)) & (way < 0.99 * np.max(way))), "springs are stretched"
    cured = drawing_of(TunedMass(DrumBrake(), "x", 0.02, 2000.0, 0.1)).moved(3)
    assert np.array_equal(cured[:2], drawn.moved(2))
    assert not np.any(cured[2])

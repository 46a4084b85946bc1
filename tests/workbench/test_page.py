"""The page as its user sees it: each number drawn is the one the library computes, and follows the sliders."""

import numpy as np
import pytest

from squealbox import DrumBrake, LinearSlope, complex_modes, critical_value, stability_map

FLOAT32 = 1e-5  # numbers travel with seven digits, and the page shows six of them


@pytest.fixture
def page(same_page):
    """None of these needs a page of its own."""
    return same_page


def brake(**changes):
    return DrumBrake(friction=LinearSlope(0.30, -0.05)).replace(changes)


def points(page, figure, column):
    layers = page.numbers("locus", figure)["layers"]
    return next(np.array([layer["x"], layer["y"]]) for layer in layers if layer["column"] == column)


def test_the_modes_of_the_present_design_are_marked(page):
    modes = complex_modes(brake())
    x, hertz = points(page, "frequency", "present design")
    assert x == pytest.approx([0.3, 0.3], rel=FLOAT32)
    assert hertz * 1e3 == pytest.approx(modes.frequency[:2], rel=FLOAT32)
    growth, _ = points(page, "plane", "present design")
    assert growth == pytest.approx(modes.growth_rate[:2], rel=FLOAT32)


def test_every_mode_is_a_line_over_the_parameter(page):
    lines = [layer for layer in page.numbers("locus", "frequency")["layers"] if layer["kind"] == "line"]
    assert len(lines) == 2
    at = 60
    there = complex_modes(brake(**{"friction.static": lines[0]["x"][at]}))
    drawn = sorted(1e3 * line["y"][at] for line in lines)
    assert drawn == pytest.approx(sorted(there.frequency[:2]), rel=FLOAT32)
    paths = [stroke["d"] for stroke in page.strokes("locus", "frequency") if stroke["d"]]
    assert len(paths) == 2
    assert all(path.count("L") > 90 for path in paths)


def test_a_slider_moves_the_design_and_everything_drawn(page):
    page.slide("theta1", 60.0)
    page.until("document.querySelector('[data-path=theta1]').value === '60'")
    page.drawn("locus")
    expected = complex_modes(brake(theta1=np.deg2rad(60.0)))
    _, hertz = points(page, "frequency", "present design")
    assert hertz * 1e3 == pytest.approx(expected.frequency[:2], rel=FLOAT32)
    page.page.wait_for_selector("#drawing[data-state=drawn]")
    texts = page.page.locator("#drawing text").all_text_contents()
    assert "60°" in texts
    assert "35°" not in texts


def test_the_verdict_names_the_critical_value(page):
    critical = critical_value(brake(), "friction.static", (0.0, 1.0))
    page.page.wait_for_selector("#verdict[data-verdict=stable]")
    named = f"friction.static = {float(critical.value):.5g}"  # comes behind the verdict
    page.until("said => document.querySelector('#verdict').innerText.includes(said)", named)
    assert "Steady sliding is stable" in page.page.locator("#verdict").inner_text()
    page.enter("friction.static", 0.45)
    page.page.wait_for_selector("#verdict[data-verdict=unstable]")
    hertz = complex_modes(brake(**{"friction.static": 0.45})).most_unstable.frequency
    assert f"{hertz / 1e3:.4g} kHz" in page.page.locator("#verdict").inner_text()


def test_the_map_is_that_of_the_library_and_a_click_moves_the_design(page):
    page.drawn("map")
    axes = {"friction.static": np.linspace(0.0, 1.0, 101), "load": np.linspace(0.0, 2500.0, 101)}
    share = float(np.mean(stability_map(brake(), axes, mechanism=False).unstable))
    chart = page.page.locator("section[data-panel=map] svg")
    panel = page.page.locator("section[data-panel=map]")
    assert float(panel.get_attribute("data-unstable")) == pytest.approx(share, abs=1e-12)
    assert any(stroke["d"].count("L") > 20 for stroke in page.strokes("map", "map")), "no boundary is drawn"
    box = chart.bounding_box()
    page.page.mouse.click(box["x"] + 0.75 * box["width"], box["y"] + 0.25 * box["height"])
    page.page.wait_for_selector("#verdict[data-verdict=unstable]")
    assert float(page.page.locator("input[data-path='friction.static']").input_value()) > 0.5
    loads = [page.page.locator(f"input[data-path='{name}']").input_value() for name in ("load1", "load2")]
    assert loads[0] == loads[1] != "1000"


def test_a_wrong_value_is_said_beside_its_field_and_the_rest_stays(page):
    page.enter("m", -1)
    problem = page.page.locator("[data-field=m] .problem")
    problem.filter(has_text="expected a finite number in (0, inf) kg").wait_for()
    page.settled("locus")
    assert page.page.locator("section[data-panel=locus]").get_attribute("data-state") == "wrong"
    page.enter("theta1", 400)
    page.page.locator("[data-field=theta1] .problem").filter(has_text="in [-180, 180] deg").wait_for()
    page.enter("theta1", 35)
    page.enter("m", 1.5)
    page.page.wait_for_selector("section[data-panel=locus][data-state=drawn]")
    assert problem.inner_text() == ""
    page.enter("k1", "stiff")
    page.page.locator("[data-field=k1] .problem").filter(has_text="is no number").wait_for()


def test_undo_takes_back_one_gesture(page):
    page.enter("friction.static", 0.4)
    page.enter("friction.static", 0.5)
    page.page.click("#undo")
    field = page.page.locator("input[data-path='friction.static']")
    page.until("document.querySelector(\"[data-path='friction.static']\").value === '0.4'")
    page.page.click("#undo")
    page.until("document.querySelector(\"[data-path='friction.static']\").value === '0.3'")
    page.page.click("#redo")
    page.until("document.querySelector(\"[data-path='friction.static']\").value === '0.4'")
    assert field.input_value() == "0.4"


def test_another_law_continues_the_present_one(page):
    page.page.select_option("[data-field=friction] select", "stribeck")
    page.page.wait_for_selector("input[data-path='friction.speed']")
    assert page.page.locator("input[data-path='friction.static']").input_value() == "0.3"
    assert float(page.page.locator("input[data-path='friction.kinetic']").input_value()) == pytest.approx(0.29)
    page.drawn("locus")

"""Every panel: what is drawn is what the library computes for the design on the page."""

import numpy as np
import pytest

from squealbox import DrumBrake, LinearSlope, complex_modes, mode_energy, sensitivity, sound_level, verdict
from squealbox.designs import DESIGNS
from squealbox.system import equilibrium
from squealbox.transient import simulate

FLOAT32 = 1e-5
UNSTABLE = DrumBrake(friction=LinearSlope(0.45, -0.05))


@pytest.fixture
def page(same_page):
    """None of these needs a page of its own."""
    return same_page


@pytest.fixture
def squealing(page):
    """The page with a brake that squeals."""
    page.enter("friction.static", 0.45)
    page.page.wait_for_selector("#verdict[data-verdict=unstable]")
    return page


def columns(page, panel, figure):
    return {layer["column"]: layer for layer in page.numbers(panel, figure)["layers"]}


def test_the_friction_curve_with_its_operating_points(squealing):
    squealing.drawn("friction")
    drawn = columns(squealing, "friction", "friction")
    curve, law = drawn["LinearSlope"], UNSTABLE.friction
    assert curve["y"] == pytest.approx(law.mu(np.array(curve["x"])), rel=FLOAT32)
    state = equilibrium(UNSTABLE.system())
    assert drawn["contacts at steady sliding"]["x"] == pytest.approx(np.abs(state.sliding_speed), rel=FLOAT32)
    assert drawn["contacts at steady sliding"]["y"] == pytest.approx(state.friction, rel=FLOAT32)
    assert "Friction falls with speed at 2 of 2 contacts" in squealing.says("friction")


def test_the_motion_is_that_of_the_library(squealing):
    squealing.drawn("motion")
    modes = complex_modes(UNSTABLE)
    push = 0.05 * float(np.max(np.abs(equilibrium(UNSTABLE.system()).q)))
    duration = 100.0 / modes.most_unstable.frequency
    motion = simulate(UNSTABLE, duration, start=modes.most_unstable.start(push), times=4096)
    judged = verdict(motion)
    section = squealing.page.locator("section[data-panel=motion]")
    assert section.get_attribute("data-fate") == judged.fate == "settles_on_cycle"
    assert float(section.get_attribute("data-frequency")) == pytest.approx(float(judged.frequency), rel=5e-3)
    orbit = squealing.numbers("motion", "phase")["layers"][0]
    x = motion.q[2048:, 0]
    assert max(orbit["x"]) - min(orbit["x"]) == pytest.approx(np.ptp(x) * 1e6, rel=1e-4)  # drawn in um
    assert squealing.numbers("motion", "phase")["x"]["label"] == "x [µm]"
    assert f"{judged.frequency:.5g} Hz" in squealing.says("motion")
    strip = squealing.page.locator("#verdict").inner_text()
    assert "In time: Settles on a cycle" in strip
    level = float(sound_level(motion, dof=1, begin=0.75 * duration).weighted)  # y moves most
    assert f"about {level:.0f} dB(A) at 1 m, an estimate" in strip
    assert "may be 10 dB louder or quieter" in strip


def test_a_motion_that_dies_away_has_no_level_and_the_verdict_knows_the_motion_unseen(page):
    page.until("import('/static/app.js').then(({ app }) => app.motion !== null)")  # of the design on the page
    heard = page.page.locator("#verdict .heard")
    heard.wait_for()  # asked at rest, though the panel of the motion has not been looked at
    assert "Decays" in heard.inner_text()
    assert "dB" not in heard.inner_text()


def test_the_spectrum_has_its_line_and_the_pictures_have_colours(squealing):
    squealing.drawn("motion")
    line = squealing.numbers("motion", "spectrum")["layers"][0]
    peak = line["x"][int(np.argmax(line["y"]))]
    named = float(squealing.page.locator("section[data-panel=motion]").get_attribute("data-frequency"))
    assert 1e3 * peak == pytest.approx(named, rel=0.02)
    for panel, figure in (("motion", "spectrogram"), ("map", "map")):
        squealing.drawn(panel)
        shades = squealing.page.locator(f"section[data-panel={panel}] figure[data-figure={figure}] canvas").evaluate(
            "c => new Set(new Uint32Array(c.getContext('2d').getImageData(0, 0, c.width, c.height).data.buffer)).size"
        )
        assert shades > 30


def bars(page, panel):
    rows = page.page.locator(f"section[data-panel={panel}] g.bar")
    return dict(rows.evaluate_all("all => all.map(bar => [bar.dataset.name, Number(bar.dataset.value)])"))


def test_the_bars_of_energy_add_up_to_the_growth_rate(squealing):
    squealing.drawn("energy")
    drawn, parts = bars(squealing, "energy"), mode_energy(UNSTABLE)
    assert set(drawn) == {"shoe 1", "shoe 2", "damping of x", "damping of y"}
    assert sum(drawn.values()) == pytest.approx(parts.growth_rate, rel=1e-9)
    fed = (parts.circulation + parts.slope) / (2.0 * parts.total)
    assert [drawn["shoe 1"], drawn["shoe 2"]] == pytest.approx(fed, rel=1e-12)


def test_the_bars_of_sensitivity_are_its_ranking(squealing):
    squealing.drawn("sensitivity")
    ranked = sensitivity(UNSTABLE).ranked()
    assert list(bars(squealing, "sensitivity").items())[:5] == [
        (name, pytest.approx(0.01 * change, rel=1e-9)) for name, change in ranked[:5]
    ]


def test_a_map_over_one_parameter_twice_says_so_and_is_pale(page):
    page.drawn("map")
    for which in (0, 1):
        page.page.locator("section[data-panel=map] .parameter-choice select").nth(which).select_option("k3")
    page.page.wait_for_selector("section[data-panel=map][data-state=wrong]")
    assert page.says("map") == "x and y are both k3: choose two different parameters"
    page.page.locator("section[data-panel=map] .parameter-choice select").nth(1).select_option("k4")
    page.page.wait_for_selector("section[data-panel=map][data-state=drawn]")


def test_the_map_shows_why(squealing):
    squealing.drawn("map")
    squealing.page.select_option("section[data-panel=map] select[aria-label=show]", "mechanism")
    squealing.page.locator("section[data-panel=map] .key", has_text="flutter").wait_for()
    squealing.drawn("map")
    assert "negative slope" in squealing.page.locator("section[data-panel=map] .key").inner_text()


@pytest.mark.parametrize("name", sorted(set(DESIGNS) - {"drum_brake"}))
def test_every_design_is_shown(page, name):
    page.page.select_option("#brake", name)
    page.until("title => document.getElementById('title').textContent === title", arg=DESIGNS[name].title)
    for panel in ("locus", "map", "friction", "energy", "sensitivity"):
        page.drawn(panel)
    modes = complex_modes(DESIGNS[name]())
    half = modes.eigenvalues.shape[-1] // 2
    growth = columns(page, "locus", "plane")["present design"]["x"]
    assert growth == pytest.approx(modes.growth_rate[:half], rel=FLOAT32, abs=1e-6 * np.max(np.abs(modes.eigenvalues)))
    assert page.page.locator("#drawing svg > *").count() > 5

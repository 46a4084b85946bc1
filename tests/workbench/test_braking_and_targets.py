"""Sounds that go along with a picture, stops, targets, and what each parameter needs: numbers by a second road."""

import numpy as np
import pytest

from squealbox import DrumBrake, LinearSlope, complex_modes, critical_values
from squealbox.designs import WobblingDisc
from squealbox.workbench.panels import Elsewhere, OptionError, Options, Work, function_of
from squealbox.workbench.panels.stop import braking

AT = "Number(document.querySelector('section[data-panel=listen]').dataset.at || -1)"
SPOTS = "document.querySelector('.moving svg').innerHTML"


def drum(friction):
    return DrumBrake(friction=LinearSlope(friction, -0.05))


def test_the_ridge_of_a_stop_is_the_eigenfrequency_while_it_is_small():
    brake = drum(0.334)
    found = function_of("listen")(brake, Options({"braking": 2.0}), Work(apart=True))
    (figure,) = found.figures
    grid = np.asarray(figure.heat["values"])
    row = 1e3 * figure.y.domain[1] / len(grid)
    times = np.linspace(*figure.x.domain, grid.shape[1])
    ridge = (0.5 + np.argmax(grid, axis=0)) * row
    grows = (times > 0.4) & (times < 0.9)
    frequency = complex_modes(brake).most_unstable.frequency
    assert np.all(np.abs(ridge[grows] - frequency) <= row)
    first = min(found.data["events"])
    assert first[2] == pytest.approx(frequency, rel=0.02)
    assert "heat" in found.data["words"]


def test_a_stable_brake_stops_silently_and_the_schedules_end_at_rest():
    found = function_of("listen")(drum(0.25), Options({"braking": 0.5}), Work(apart=True))
    assert found.data["events"] == []
    assert found.data["words"].startswith("No squeal of 70 dB(A)")
    stopping, speed, unit = braking(drum(0.25), 2.0)
    assert (speed, unit) == (0.2, "m/s")
    np.testing.assert_allclose(stopping.sliding_speed.value(np.array([0.0, 1.0, 2.0])), [0.2, 0.1, 0.0], atol=1e-15)
    np.testing.assert_allclose(
        stopping.load1.value(np.array([0.0, 0.1, 1.0, 1.9, 2.0])), [0.0, 500.0, 1000.0, 500.0, 0.0]
    )
    with pytest.raises(OptionError, match="sliding speed"):
        braking(WobblingDisc(), 1.0)
    with pytest.raises(Elsewhere, match="stop"):
        function_of("listen")(drum(0.3), Options({"braking": 1.0}), Work())
    with pytest.raises(OptionError, match="braking"):
        function_of("listen")(drum(0.3), Options({"braking": 0.1}), Work(apart=True))


def test_pictures_go_along_with_the_sound_by_whole_periods():
    found = function_of("listen")(drum(0.36), Options({}), Work(apart=True))
    y = np.asarray(found.arrays["frameQ"])[700:, 1]
    late = (y - y.mean()) / np.max(np.abs(y - y.mean()))
    turns = np.count_nonzero((late[:-1] < 0.0) & (late[1:] >= 0.0))
    assert turns == pytest.approx(12 * 800 / 1500, abs=1.1), "as by a flash, slow"


def test_what_each_parameter_needs_is_its_critical_value_and_stands_where_it_is_written():
    brake = drum(0.45)
    bars = {bar["name"]: bar for bar in function_of("sensitivity")(brake, Options({}), Work()).data["bars"]}
    told = {"theta2": "-8.75°", "theta1": "+8.9°", "k4": "-22.9 %", "friction.static": "-26.1 %", "k3": "+29.7 %"}
    assert {name: bars[name]["needed"]["told"] for name in told} == told
    span = (0.5 * brake.k4, brake.k4)
    by_itself = next(iter(critical_values(brake, "k4", span))).value
    assert bars["k4"]["needed"]["value"] == pytest.approx(float(by_itself), rel=1e-6)
    assert bool(complex_modes(brake.replace(k4=bars["k4"]["needed"]["beyond"])).stable)
    assert bars["k4"]["place"] is not None
    assert bars["friction.static"]["place"] is None
    assert bars["load1"]["place"] != bars["load2"]["place"]
    one = function_of("sensitivity")(brake, Options({"step": "tolerance"}), Work()).data["bars"]
    ratio = {bar["name"]: bar["growth"] / bars[bar["name"]]["growth"] for bar in one}
    assert ratio["k4"] == pytest.approx(3.0, rel=1e-6), "3 % of a spring for 1 %"
    assert ratio["c1"] == pytest.approx(20.0, rel=1e-6)


def test_the_words_of_a_target_say_its_numbers():
    found = function_of("target")(drum(0.3), Options({"friction": 0.33, "share": 90}), Work())
    assert 0.0 < found.data["stable"] < 90.0
    assert found.data["words"].startswith(f"Missed: {found.data['stable']:.3g} % of the lot")
    assert "springs 3 %" in found.data["words"]
    assert found.figures[0].layers[0]["y"][0] == 100.0
    met = function_of("target")(drum(0.3), Options({"friction": 0.25}), Work())
    assert met.data["met"]
    with pytest.raises(OptionError, match="share"):
        function_of("target")(drum(0.3), Options({"share": 100}), Work())


def test_the_picture_keeps_the_clock_of_the_sound(same_page):
    page = same_page
    page.page.emulate_media(reduced_motion="no-preference")
    page.enter("friction.static", "0.36")
    page.ask("listen")
    page.option("listen", slow="8")
    page.page.click("section[data-panel=listen] >> text=Play >> nth=0")
    page.until(f"{AT} > 0")
    before, spots = page.page.evaluate(AT), page.page.evaluate(SPOTS)
    page.page.wait_for_timeout(1000)
    after = page.page.evaluate(AT)
    assert 0.04 < after - before < 0.2, "12 s for 1.5 s"
    assert page.page.evaluate(SPOTS) != spots
    assert "flash" in page.says("moving")
    page.page.click("section[data-panel=listen] .buttons >> text=Stop")
    page.until(f"{AT} === -1")
    assert "flash" not in page.says("moving")
    page.page.emulate_media(reduced_motion="reduce")


def test_a_click_goes_to_the_needed_value_and_discs_carry_numbers(same_page):
    page = same_page
    page.enter("friction.static", "0.45")
    page.drawn("sensitivity")
    assert page.page.locator(".weighed circle[data-of=k4]").count() == 1
    page.page.click("[data-needs=k4]")
    page.until("document.querySelector('#verdict').dataset.verdict === 'stable'")


def test_a_target_is_asked_in_the_page(same_page):
    page = same_page
    page.drawn("target")
    assert page.says("target").startswith("Missed")
    field = page.page.locator("section[data-panel=target] input").first
    field.fill("0.25")
    field.press("Enter")
    page.until("document.querySelector('section[data-panel=target]').dataset.met === 'true'")
    assert page.page.evaluate("document.documentElement.scrollHeight <= innerHeight")


def test_a_stop_is_ended_within_a_second(same_page):
    page = same_page
    page.ask("listen")
    page.enter("m", 1e-4)  # it swings a hundred times as fast, and is followed for seconds
    page.option("listen", braking=4)
    page.page.click("section[data-panel=listen] >> text=Play >> nth=0")
    page.page.wait_for_selector("section[data-panel=listen] .says .stop")
    page.page.click("section[data-panel=listen] .says .stop")
    page.until("document.querySelector('section[data-panel=listen]').dataset.state === 'stopped'", timeout=1.0)

"""What silences it: the ranked cures on the page, applied and taken back with a click, heard before and after."""

import pytest

from squealbox import DrumBrake, LinearSlope, complex_modes
from squealbox.countermeasures import AddedDamping, AddedMass, TunedMass
from squealbox.countermeasures.base import short_name
from squealbox.files import read_text
from squealbox.workbench.panels import Options, Stopped, Work, function_of
from squealbox.workbench.sheet import sheet
from squealbox.workbench.state import design_of

STATE = {"brake": "drum_brake", "laws": {}, "values": {"friction.static": 0.45}}
BRAKE = DrumBrake(friction=LinearSlope(0.45, -0.05))


def nested():
    return AddedDamping(TunedMass(BRAKE, "x", 0.02, 2000.0, 0.1), "y", 50.0)


def test_a_click_applies_a_cure_another_takes_it_back_and_one_key_plays_both(page):
    page.enter("friction.static", 0.45)
    page.page.wait_for_selector("#verdict[data-verdict=unstable]")
    page.page.click("#ask-silences")
    page.option("silence", samples=16)
    page.page.click("text=Find cures")
    page.page.wait_for_selector("section[data-panel=silence][data-state=drawn]", timeout=240_000)
    assert int(page.page.get_attribute("section[data-panel=silence]", "data-cures")) >= 15
    whole = "e => e.scrollWidth <= e.clientWidth"
    assert page.page.locator("section[data-panel=silence] .scroller").evaluate(whole), "costs and cautions are in sight"
    before = page.page.locator("input[data-path=theta2]").input_value()
    page.page.click("button[aria-label='Apply theta2 down']")
    page.page.wait_for_selector("#verdict[data-verdict=stable]")
    changed = float(page.page.locator("input[data-path=theta2]").input_value())
    cured = complex_modes(BRAKE.replace({"theta2": changed * 3.141592653589793 / 180.0}))
    assert bool(cured.stable)
    assert page.page.get_attribute("tr[data-cure='theta2 down']", "aria-current") == "true"
    page.page.wait_for_selector("section[data-panel=compare][data-compared=yes]")
    assert page.page.locator("section[data-panel=compare] .scroller").evaluate(whole), "and both brakes compared"
    page.page.locator("#verdict").click()
    for turn in ("before", "after"):
        page.page.keyboard.press("b")
        page.page.wait_for_selector(f"section[data-panel=silence][data-heard={turn}]", timeout=120_000)
    assert "nothing is left to hear" in page.says("silence")
    page.page.click("button[aria-label='Apply stiffness on y']")  # a design that holds the brake: instead of the first
    page.page.wait_for_selector("section[data-panel=silence][data-applied='stiffness on y']")
    page.until("document.getElementById('title').textContent.endsWith('with added stiffness')")
    page.page.wait_for_selector("#verdict[data-verdict=stable]")
    assert page.page.locator("input[data-path=theta2]").input_value() == before
    page.page.click("text=Take it back")
    page.page.wait_for_selector("#verdict[data-verdict=unstable]")
    assert page.page.get_attribute("section[data-panel=silence]", "data-applied") == ""
    page.page.click("#undo")
    page.page.wait_for_selector("#verdict[data-verdict=stable]")


def test_each_row_leads_to_the_brake_its_numbers_are_of():
    found = function_of("silence")(BRAKE, Options({"samples": 16}), Work(apart=True)).data
    assert found["growth"] == pytest.approx(complex_modes(BRAKE).most_unstable.growth_rate, rel=1e-9)
    seen = {"values": 0, "text": 0}
    for row in found["rows"]:
        if "values" in row:
            design = design_of({**STATE, "values": {**STATE["values"], **row["values"]}}, {})
        elif "text" in row:
            design = read_text(row["text"], "a cure", beside=False).design
        else:
            assert row["refused"]
            continue
        seen["values" if "values" in row else "text"] += 1
        assert float(complex_modes(design).largest_growth_rate) == pytest.approx(row["growth"], rel=1e-5, abs=1e-4)
    assert min(seen.values()) >= 5
    assert [row["probability"] for row in found["rows"]] == sorted(row["probability"] for row in found["rows"])


def test_the_search_ends_where_nobody_waits():
    work = Work(lambda share, text: work.stop(), apart=True)
    with pytest.raises(Stopped):
        function_of("silence")(BRAKE, Options({"samples": 32}), work)


def test_a_brake_within_countermeasures_keeps_the_names_of_its_fields():
    design = nested()
    paths = [field["path"] for field in sheet(design)["fields"]]
    assert {"m", "theta2", "friction.static", "mass", "frequency", "damping", "brake.damping"} <= set(paths)
    assert len(paths) == len(set(paths))
    assert all(
        field["value"] == design.value_of(field["path"])
        for field in sheet(design)["fields"]
        if "." not in field["path"] and field["kind"] == "number"
    )
    assert set(DrumBrake().scalars()) <= set(design.scalars())
    assert float(design.replace({"friction.static": 0.2}).value_of("friction.static")) == 0.2
    assert short_name(design, "brake.brake.k3") == "k3"
    assert short_name(design, "brake.damping") == "brake.damping"
    assert sheet(AddedMass(BRAKE, "x", 0.1))["title"].endswith("with added mass")


@pytest.mark.parametrize(
    "panel", ["locus", "verdict", "map", "friction", "energy", "sensitivity", "compare", "moving", "drawing"]
)
def test_every_panel_takes_a_brake_within_countermeasures(panel):
    assert function_of(panel)(nested(), Options({}), Work(apart=True)).data

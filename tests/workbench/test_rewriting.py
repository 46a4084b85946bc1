"""An opened file is written again as it was: only what was changed is another, and it reads back to the same design."""

from pathlib import Path

import numpy as np
import pytest

from squealbox import DrumBrake, LinearSlope, Stribeck
from squealbox.countermeasures import TunedMass
from squealbox.files.beginnings import BEGINNINGS, asked_of, first_design
from squealbox.files.reading import read_file, read_text
from squealbox.files.writing import design_text
from squealbox.workbench.rewriting import LOST, rewritten, settings_of

EXAMPLES = Path(__file__).parents[2] / "examples"
TEXT = """# bench 7, Monday
brake = "drum_brake"
theta1 = "35 deg"    # measured
load = "1 kN"        # of both shoes
k3 = 190e6           # plain SI
k4 = "110 kN/mm"

[friction]           # of the supplier
law = "linear_slope"
static = 0.3         # cold
slope = "-0.05 s/m"

[map]  # as agreed
x = { parameter = "friction.static", range = [0, 0.8] }   # x
y = { parameter = "theta1", range = ["20 deg", "160 deg"] }

[onset]
parameter = "load"
range = ["0.1 kN", "5 kN"]

[simulate]
duration = "20 ms"
start = "sliding"

[study]   # for the night
analysis = "modes"

[[study.axis]]
parameter = "friction.static"
range = [0, 1]
points = 5
"""


def again(text, changes, settings=None):
    """The text of a file with these changes of its design; what was lost; the design that it should hold."""
    before = read_text(text).design
    after = before.replace(changes)
    found, lost = rewritten(text, before, after, settings or {})
    assert design_text(read_text(found).design) == design_text(after)
    return found, lost


def lines(old, new):
    """The lines of the new text that were not in the old one, and those that are gone."""
    a, b = old.splitlines(), new.splitlines()
    return [each for each in b if each not in a], [each for each in a if each not in b]


def test_without_changes_it_is_the_same_text():
    for text in (TEXT, TEXT.replace("\n", "\r\n")):
        assert again(text, {}) == (text, "")


@pytest.mark.parametrize(
    ("changes", "line"),
    [
        ({"theta1": float(np.deg2rad(40.0))}, 'theta1 = "40 deg"    # measured'),
        ({"load": 2000.0}, 'load = "2 kN"        # of both shoes'),
        ({"k3": 1.5e8}, "k3 = 150000000.0           # plain SI"),
        ({"friction.static": 0.45}, "static = 0.45         # cold"),
    ],
)
def test_one_change_is_one_line_with_its_comment(changes, line):
    text, lost = again(TEXT, changes)
    assert lost == ""
    assert lines(TEXT, text)[0] == [line]
    assert len(lines(TEXT, text)[1]) == 1


def test_what_is_new_in_it_is_added_where_it_belongs():
    text, lost = again(TEXT, {"m": 2.0, "load2": 2000.0})
    assert lost == ""
    new, gone = lines(TEXT, text)
    assert gone == ['load = "1 kN"        # of both shoes']
    assert set(new) == {'load1 = "1 kN"', 'load2 = "2 kN"', 'm = "2 kg"'}
    assert text.index("load2") < text.index("[friction]")


def test_another_law_and_a_countermeasure():
    text, lost = again(TEXT, {"friction": Stribeck(0.4, 0.3, 0.2)})
    assert lost == ""
    assert "# of the supplier" in text
    assert "# cold" in text
    before = read_text(TEXT).design
    cured = TunedMass(before, "y", 0.05, 1900.0, 0.02)
    text, lost = rewritten(TEXT, before, cured, {})
    assert (lost, lines(TEXT, text)[1]) == ("", [])
    assert read_text(text).design == cured
    harder = cured.replace({"mass": 0.08})
    more, lost = rewritten(text, cured, harder, {})
    assert (lost, len(lines(text, more)[0])) == ("", 1)
    without, lost = rewritten(text, cured, before, {})
    assert (lost, lines(TEXT, without)) == ("", ([], []))
    assert "[[countermeasures]]" not in without


def test_sections_become_settings_and_settings_sections():
    settings = settings_of(read_text(TEXT))
    assert settings["map"] == {"x": "friction.static", "y": "theta1"}
    assert settings["locus"] == {"parameter": "load"}
    assert settings["page"]["ranges"]["theta1"] == pytest.approx(np.deg2rad([20.0, 160.0]))
    assert settings["page"]["ranges"]["load"] == [100.0, 5000.0]
    assert settings["motion"] == {"start": "sliding"}
    assert again(TEXT, {}, settings) == (TEXT, "")
    chosen = {"map": {"x": "k3"}, "locus": {"parameter": "k4"}, "motion": {"start": "rest"}}
    text, lost = again(TEXT, {}, chosen)
    found = read_text(text)
    assert (lost, found.map.x.name, found.map.y.name, found.onset.name, found.simulate.start) == (
        "",
        "k3",
        "theta1",
        "k4",
        "rest",
    )
    assert found.map.x.low < 190e6 < found.map.x.high
    assert found.study
    assert "# as agreed" in text
    assert "# for the night" in text
    text, lost = again(TEXT, {}, {"page": {"ranges": {"friction.static": [0.1, 0.6], "theta1": None}}})
    assert (lost, lines(TEXT, text)[0]) == ("", ['x = { parameter = "friction.static", range = [0.1, 0.6] }   # x'])
    assert again(TEXT, {}, {"page": {"ranges": {"friction.static": [3, "x"]}}})[1] in ("", LOST)


@pytest.mark.parametrize(
    "wrong",
    [
        {"map": 3},
        {"map": {"x": "none"}},
        {"map": {"x": ["k3"]}},
        {"motion": {"start": "push"}},
        {"page": {"ranges": 3}},
        {"page": {}},
    ],
)
def test_settings_that_no_section_can_hold_change_nothing(wrong):
    assert again(TEXT, {}, wrong) == (TEXT, "")


@pytest.mark.parametrize("name", BEGINNINGS)
def test_every_first_file_keeps_its_comments(name):
    design = first_design(name)
    text = design_text(design) + asked_of(design, "brake.toml")
    changed, lost = again(text, {"friction.static": 0.41} if name != "sprag_slip" else {})
    assert lost == ""
    assert len(lines(text, changed)[0]) <= 1


@pytest.mark.parametrize("path", sorted(EXAMPLES.rglob("*.toml")), ids=lambda path: path.name)
def test_every_example_is_written_as_it_is(path):
    text = path.read_text()
    try:
        found = read_file(path)
        design_text(found.design)
    except ValueError:
        pytest.skip("names code or matrices that a file cannot hold")
    assert rewritten(text, found.design, found.design, {}, lambda text: read_text(text, str(path))) == (text, "")


def test_what_cannot_be_kept_is_said_and_the_sections_stay():
    before = read_text(TEXT).design
    after = before.replace({"friction": LinearSlope(0.4, -0.02)})
    found, lost = rewritten(TEXT, before, after, {}, _misread)
    assert lost == LOST
    assert read_text(found).design == after
    assert read_text(found).map.y.name == "theta1"
    assert read_text(found).study


def _misread(text):
    """A reader that finds another design than what was meant: the check behind the writing sees it."""
    found = read_text(text)
    object.__setattr__(found, "design", DrumBrake())
    return found


def test_what_varies_in_one_key_is_kept_until_it_changes():
    """`vary` of a section stays; where the page chooses an axis anew, each is said in words of its own."""
    axes = TEXT[TEXT.index("[map]") : TEXT.index("[onset]")]
    vary = '[map]\nvary = { "friction.static" = [0, 0.8], theta1 = ["20 deg", "160 deg"] }\n\n'
    text = TEXT.replace(axes, vary)
    assert settings_of(read_text(text)) == settings_of(read_text(TEXT))
    found, _ = again(text, {"k3": 191e6})
    assert vary in found
    found, _ = again(text, {}, {"map": {"x": "load", "y": "theta1"}, "page": {"ranges": {"load": [100.0, 2e3]}}})
    plane = read_text(found).map
    assert (plane.x.name, plane.x.low, plane.x.high, plane.y) == ("load", 100.0, 2e3, read_text(TEXT).map.y)

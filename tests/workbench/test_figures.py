"""Every figure of the page: zoom, ends of axes, units, read-out, what was measured, and the files made of it."""

import csv
import json

import numpy as np
import pytest

from squealbox import DrumBrake, LinearSlope
from squealbox.plots.figure_data import (
    Bars,
    FigureAxis,
    FigureData,
    across,
    heat,
    hull,
    line,
    packed,
    path,
    span,
    unpacked,
)
from squealbox.plots.paper import KINDS, NoFigure
from squealbox.plots.paper import drawn_on_paper as pdf
from squealbox.workbench.panels import OptionError, Options, Work, function_of

PLAIN = {
    "size": [300, 200], "x": {"label": "time [s]", "domain": [0, 1]}, "y": {"label": "x [mm]", "domain": [-1, 1]},
    "layers": [{"kind": "line", "cls": "s0", "x": [0, 0.5, 1], "y": [0, None, 1], "name": "$a"}],
}  # fmt: skip
MEASURED = """measured => import('/static/app.js').then(({ app }) => app.hearing(measured))"""


@pytest.fixture
def page(same_page):
    """None of these needs a page of its own."""
    return same_page


def asked(name, **options):
    return function_of(name)(DrumBrake(friction=LinearSlope(0.45, -0.05)), Options(options), Work(apart=True))


def test_an_array_that_stands_in_several_figures_travels_once():
    x, y = np.linspace(0.0, 1.0, 9), np.linspace(0.0, 2.0, 9)
    axes = FigureAxis("time", "s", (0.0, 1.0)), FigureAxis("x", "m", span(y))
    figures, arrays = packed([FigureData("a", *axes, [line(x, y)]), FigureData("b", *axes, [line(x, -y), across(0.0)])])
    assert len(arrays) == 3
    assert unpacked({"figures": figures}, arrays, "b")["layers"][0]["y"] == pytest.approx(-y)
    assert packed([Bars("c", "N", [{"name": "one", "parts": [("b0", 1.0)], "sum": 1.0}])])[1] == {}


def test_an_axis_is_read_in_the_unit_that_was_chosen():
    usual, chosen = asked("verdict", parameter="k3"), asked("verdict", parameter="k3", units={"k3": ["N/mm", 1e3]})
    assert "present 190000 N/mm" in "".join(map(str, chosen.data["why"])).replace("1.9e+05", "190000")
    assert chosen.data["crossings"] == usual.data["crossings"]
    axis = asked("locus", parameter="k3", span=[1e8, 2e8], units={"k3": ["N/mm", 1e3]}).figures[0].x
    assert (axis.unit, axis.domain) == ("N/mm", (1e5, 2e5))
    for wrong in ({"k3": "N/mm"}, {"k3": ["N/mm", -1.0]}, {"k3": ["N/mm", "1"]}, 3):
        assert asked("locus", parameter="k3", units=wrong).figures[0].x.unit == "kN/mm"


def test_the_other_design_of_a_comparison_is_checked_like_its_own():
    kept = {"brake": "drum_brake", "values": {"friction.static": 0.3}}
    both = asked("compare", a=kept)
    heads, rows = both.data["table"]["heads"], {row[0]: row for row in both.data["table"]["rows"]}
    assert list(heads) == ["", "A (kept)", "B (this page)"]
    assert rows["friction.static"][1:] == ["0.3", "0.45"]
    assert rows["its growth rate"][2][1] == "worse"
    for wrong, why in (({"brake": "pad_on_disc"}, "no friction.static"), ({"base": "nine"}, "not open any more")):
        said = asked("compare", a=wrong, parameter="theta2").data["words"]
        assert said.startswith("A cannot be drawn over theta2"), why
    with pytest.raises(OptionError):
        Options({"a": {"brake": "none such"}}).design("a")


def test_a_figure_becomes_a_pdf():
    begins = {"pdf": b"%PDF", "svg": b"<?xml", "png": b"\x89PNG", "csv": b'"$a: time', "tsv": b'"$a: time [s]"\t'}
    assert set(begins) == set(KINDS)
    for kind, head in begins.items():
        assert pdf(json.dumps(PLAIN).encode(), kind).startswith(head)
    for name in ("locus", "energy", "friction"):
        for figure in asked(name).figures:
            assert pdf(figure).startswith(b"%PDF")
    values = np.linspace(-1.0, 3.0, 12).reshape(3, 4)
    for scale in ("diverging", "sequential", "decades", "mechanism"):
        picture = {**heat(values.ravel().tolist(), scale, "growth", "1/s", names=["a", "b"]), "rows": 3, "columns": 4}
        with_picture = {**PLAIN, "heat": {**picture, "span": [[0, 1], [-1, 1]]}}
        assert pdf(json.dumps(with_picture).encode()).startswith(b"%PDF")


def test_the_numbers_of_a_figure_become_a_table():
    axes = FigureAxis("time", "s", (0.0, 2.0)), FigureAxis("load", "kN", (5.0, 6.0))
    ring = np.array([[0.0, 5.0], [2.0, 6.0]])
    layers = [hull([0.0, 1.0], [5.0, np.nan], [5.5, 6.0]), path([ring, ring], "boundary"), across(5.5)]
    seen = heat(np.arange(6.0).reshape(2, 3), "sequential", "growth rate", "1/s")
    head, *rows = csv.reader(pdf(FigureData("a", *axes, layers, heat=seen), "csv").decode().splitlines())
    assert head == [
        "time [s]", "load [kN]", "growth rate [1/s]", "time [s]", "least load [kN]", "largest load [kN]",
        "boundary: time [s]", "boundary: load [kN]",
    ]  # fmt: skip
    assert rows[0] == ["0", "5", "0", "0", "5", "5.5", "0", "5"]
    assert rows[1] == ["1", "5", "1", "1", "", "6", "2", "6"]
    assert rows[2] == ["2", "5", "2", "", "", "", "", ""], "curves are parted by an empty line"
    assert rows[5] == ["2", "6", "5", "", "", "", "", ""]
    bars = Bars("c", "growth [1/s]", [{"name": 'a "b"', "parts": [("b0", 1.0)], "sum": 1.0}])
    assert pdf(bars, "tsv") == b'"name"\t"growth [1/s]"\n"a ""b"""\t1\n'


@pytest.mark.parametrize(
    "wrong",
    [
        b"", b"[]", b"{}", b"\xff", b'{"size": [1e999, 2], "x": 3}', json.dumps({**PLAIN, "size": []}).encode(),
        json.dumps({**PLAIN, "x": {"label": "t", "domain": [1, 1]}}).encode(), b"[" * 100_000,
        json.dumps({**PLAIN, "layers": [{"kind": "evil"}]}).encode(),
        json.dumps({**PLAIN, "layers": [{"kind": "line", "x": [1], "y": [1, 2]}]}).encode(),
        json.dumps({**PLAIN, "heat": {"values": [1], "rows": 10**9, "columns": 9, "span": [[0, 1], [0, 1]]}}).encode(),
    ],
)  # fmt: skip
def test_what_is_no_figure_is_one_sentence(wrong):
    with pytest.raises(NoFigure) as said:
        pdf(wrong)
    assert "\n" not in str(said.value)


@pytest.mark.parametrize("wrong", [b"", b"[]", b"{}", b"[" * 100_000, b'{"bars": 3}', b'{"bars": [{}], "label": ""}'])
def test_nor_is_there_a_table_of_it(wrong):
    with pytest.raises(NoFigure):
        pdf(wrong, "csv")
    huge = {"values": [1], "rows": 10**9, "columns": 9, "span": [[0, 1], [0, 1]], "name": "a"}
    with pytest.raises(NoFigure):
        pdf(json.dumps({**PLAIN, "heat": huge}).encode(), "csv")


def axis(page, panel, figure, way="x"):
    return page.numbers(panel, figure)[way]


def test_a_box_is_zoomed_into_and_all_is_shown_again(page):
    page.drawn("locus")
    figure = page.page.locator("section[data-panel=locus] figure[data-figure=growth] svg")
    box = figure.bounding_box()
    page.page.mouse.move(box["x"] + 110, box["y"] + 40)
    page.page.mouse.down()
    page.page.mouse.move(box["x"] + 170, box["y"] + 90, steps=3)
    page.page.mouse.up()
    page.until("() => document.querySelector('section[data-panel=locus] .end').value !== '0'")
    page.drawn("locus")
    low, high = axis(page, "locus", "frequency")["domain"]  # the other figures over friction go along
    assert 0.05 < low < high < 0.95
    curve = page.numbers("locus", "growth")["layers"]
    assert min(curve[0]["x"]) == pytest.approx(low, rel=1e-5), "computed anew for those ends"
    assert "unstable" not in page.page.locator("#verdict").get_attribute("data-verdict")
    figure.dblclick()
    page.until("() => document.querySelector('section[data-panel=locus] .end').value === '0'")
    assert axis(page, "locus", "frequency")["domain"] == [0, 1]


def test_the_ends_of_an_axis_are_typed_and_hold_for_all_panels(page):
    page.drawn("map")
    ends = page.page.locator("section[data-panel=map] .end")
    ends.nth(1).fill("0.6")
    ends.nth(1).press("Enter")
    page.until("""() => import('/static/app.js').then(({ app }) => app.store.ranges['friction.static']?.[1] === 0.6)""")
    page.drawn("map")
    assert axis(page, "map", "map")["domain"] == pytest.approx([0.0, 0.6])
    page.drawn("locus")
    assert axis(page, "locus", "growth")["domain"] == pytest.approx([0.0, 0.6])
    page.drawn("map")
    ends.nth(0).fill("0.9")
    ends.nth(0).press("Enter")
    assert "lower and a higher end" in page.says("map")
    ends.nth(1).fill("")
    ends.nth(1).press("Enter")
    page.until("""() => import('/static/app.js').then(({ app }) => !app.store.ranges['friction.static'])""")


def test_keys_zoom_what_is_not_over_a_parameter(page):
    page.drawn("motion")
    figure = page.page.locator("section[data-panel=motion] figure[data-figure=spectrum] svg")
    ticks = "svg => [...svg.querySelectorAll('.axis')].map(a => a.textContent).join('|')"
    before = figure.evaluate(ticks)
    figure.focus()
    page.page.keyboard.press("+")
    assert figure.evaluate(ticks) != before
    page.page.keyboard.press("0")
    assert figure.evaluate(ticks) == before


def test_units_of_a_field_go_into_axes_and_ask_for_what_they_need(page):
    page.page.select_option("[data-field=sliding_speed] select.unit", "rpm")
    page.page.fill("#asked-number", "150")
    page.page.keyboard.press("Enter")
    page.until(
        "() => document.querySelector('[data-path=sliding_speed]').value.startsWith('12.73')"
    )  # 0.2 m/s at 150 mm
    page.page.select_option("section[data-panel=locus] .parameter-choice select", "sliding_speed")
    page.drawn("locus")
    page.until(
        "() => document.querySelector('section[data-panel=locus] .axis-label').textContent === 'sliding_speed [rpm]'"
    )
    assert axis(page, "locus", "growth")["label"] == "sliding_speed [rpm]"
    page.page.select_option("[data-field=sliding_speed] select.unit", "m/s")
    page.until("() => document.querySelector('[data-path=sliding_speed]').value === '0.2'")
    page.page.select_option("[data-field=load1] select.unit", "bar")
    page.page.locator("dialog[open] button", has_text="Cancel").click()
    assert page.page.locator("[data-field=load1] select.unit").input_value() == "N", "nothing given, nothing changed"


def test_what_was_measured_is_drawn_over_what_is_computed(page):
    page.drawn("locus")
    page.page.evaluate(MEASURED, {"frequency": 2100.0, "growth rate": 120.0})
    drawn = {name: page.strokes("locus", name) for name in ("frequency", "growth", "plane")}
    assert [sum("measured" in each["cls"] for each in layers) for layers in drawn.values()] == [
        2,
        2,
        3,
    ]  # and the legend
    page.drawn("map")  # the modes are out of sight, and what is measured meanwhile is there when they come back
    page.page.evaluate(MEASURED, {"frequency": 2050.0})
    page.drawn("locus")
    lines = "f => document.querySelectorAll(`section[data-panel=locus] [data-figure=${f}] .measured`).length"
    page.until(lines, arg="frequency")
    assert page.page.evaluate(lines, "growth") == 0
    page.page.evaluate(MEASURED, {})
    assert not any("measured" in each["cls"] for each in page.strokes("locus", "plane"))


def test_the_value_of_a_picture_is_read_and_the_numbers_are_copied(page):
    page.page.context.grant_permissions(["clipboard-read", "clipboard-write"])
    page.drawn("map")
    box = page.page.locator("section[data-panel=map] canvas").bounding_box()
    page.page.mouse.move(box["x"] + 0.9 * box["width"], box["y"] + 0.5 * box["height"])
    said = page.page.locator("section[data-panel=map] .reading").text_content()
    assert said.endswith("1/s")
    growth = float(said.split(": ")[1].split()[0])
    brake = DrumBrake(friction=LinearSlope(0.9, -0.05), load1=1250.0, load2=1250.0)
    from squealbox import complex_modes

    assert growth == pytest.approx(complex_modes(brake).most_unstable.growth_rate, rel=0.05)
    page.page.select_option("section[data-panel=map] .files select", "Copy")
    page.until("() => document.getElementById('note').textContent.startsWith('Copied')")
    lines = page.page.evaluate("navigator.clipboard.readText()").splitlines()
    assert lines[0].split("\t")[:3] == ['"friction.static [-]"', '"load [N]"', '"growth rate [1/s]"']
    assert len(lines) == 1 + 101 * 101

"""Every result and every design draws itself: a card for a notebook, and a figure. Every result is saved and read."""

import dataclasses
import importlib
import pkgutil
import re
import subprocess
import sys

import numpy as np
import pytest
import xarray

import squealbox
from house.test_figures_for_papers import crowded
from result_examples import EXAMPLES
from squealbox.designs import DESIGNS, DrumBrake
from squealbox.plots import card, cards, facts, plot
from squealbox.plots.cards import MOST_POINTS, parameter_rows
from squealbox.result import Outcome, Result, quantity


@dataclasses.dataclass(frozen=True, kw_only=True, eq=False)
class Undrawn(Result):
    """A kind nobody draws, with text that must not become markup."""

    value: float = quantity("", "Hz", "<b>bold</b>")
    text: str = "<script>alert(1)</script>"


def test_every_kind_of_the_package_is_drawn():
    for module in pkgutil.walk_packages(squealbox.__path__, "squealbox."):
        if module.name.split(".")[1] not in ("cli", "workbench", "report", "papers", "plots"):
            importlib.import_module(module.name)
    kinds = [kind for kind in Result.kinds.values() if kind.__module__.startswith("squealbox.")]
    assert len(kinds) > 25
    assert [kind.__name__ for kind in kinds if plot.dispatch(kind) is plot.dispatch(object)] == []
    assert [kind.__name__ for kind in kinds if kind.__name__ not in EXAMPLES] == []


@pytest.mark.parametrize("name", list(EXAMPLES))
def test_a_result_draws_itself_has_a_card_and_is_saved(name, tmp_path, monkeypatch):
    result = EXAMPLES[name]()
    assert type(result).__name__ == name
    shown = []
    monkeypatch.setattr(cards, "plot", lambda thing: shown.append(thing.plot()) or shown[0])
    text = result._repr_html_()
    (figure,) = shown
    assert any(axes.has_data() for axes in figure.axes)
    assert crowded(figure) == []  # axes whose numbers run into each other
    assert name in text
    assert str(result.outcome) in text
    assert 'src="data:image/png;base64,' in text
    assert not re.search(r"https?://|<script", text)
    for fact, value, unit in facts(result):
        assert fact
        assert value
        assert unit is not None
    for field in dataclasses.fields(result):
        if "dims" in field.metadata:
            assert f">{field.name}<" in text
    assert len(text) < 200_000  # a notebook of fifty results stays under 10 MB
    path = result.save(tmp_path / "result.nc")
    with xarray.open_dataset(path, engine="h5netcdf") as read:
        xarray.testing.assert_identical(read.load(), result.to_dataset())
    back = Result.load(path)
    assert type(back) is type(result)
    xarray.testing.assert_identical(back.to_dataset(), result.to_dataset())
    assert back.save(tmp_path / "again.nc").read_bytes() == path.read_bytes()


@pytest.mark.parametrize("name", ["CriticalValue", "Cycle", "Verdict"])
def test_key_numbers_carry_their_units(name):
    found = {fact: (value, unit) for fact, value, unit in facts(EXAMPLES[name]())}
    frequency = next(value for fact, value in found.items() if "frequency" in fact)
    assert frequency[1] in ("Hz", "kHz")
    assert float(frequency[0]) > 0.0


def test_a_notebook_shows_a_figure_without_pyplot():
    """As a notebook does it, in a process where nothing has prepared IPython for matplotlib's figures."""
    code = (
        "import sys; from IPython.core.formatters import DisplayFormatter; from squealbox import BlockChain, plot\n"
        "data, _ = DisplayFormatter().format(plot(BlockChain()))\n"
        "sys.stdout.buffer.write(data['image/png'][:8]); assert 'matplotlib.pyplot' not in sys.modules"
    )
    shown = subprocess.run([sys.executable, "-c", code], capture_output=True, check=True, timeout=60)
    assert shown.stdout == b"\x89PNG\r\n\x1a\n"


def test_a_failed_result_says_so_and_draws_nothing():
    text = dataclasses.replace(EXAMPLES["Cycle"](), outcome=Outcome("no_cycle", "it came to <rest>"))._repr_html_()
    assert "no_cycle: it came to &lt;rest&gt;" in text
    assert "<img" not in text


def test_a_kind_nobody_draws_has_a_card_without_a_picture():
    result = Undrawn(value=np.float64(2000.0))
    text = result._repr_html_()
    assert "<img" not in text
    assert "<script>" not in text
    assert "2000" in text
    with pytest.raises(TypeError, match="no figure is known for Undrawn"):
        result.plot()


def test_a_huge_result_is_not_drawn_unasked():
    example = EXAMPLES["Spectrum"]()
    many = np.linspace(0.0, 1.0, MOST_POINTS + 1)
    assert "<img" not in card(dataclasses.replace(example, frequency=many, amplitude=many))


@pytest.mark.parametrize("name", sorted(DESIGNS))
def test_a_design_draws_itself_and_has_a_card(name):
    design = DESIGNS[name]()
    assert any(axes.has_data() for axes in design.plot().figure.axes)
    text = design._repr_html_()
    assert 'src="data:image/png;base64,' in text
    assert type(design).title in text or "&" in type(design).title
    for path, about, _ in design.leaves():
        assert f">{path}<" in text
        assert about.meaning


def test_parameters_are_read_with_units_and_angles_in_degrees():
    rows = {name: value for name, value, *_ in parameter_rows(DrumBrake())}
    assert rows["theta1"] == "35 deg"
    assert rows["k3"] == "190 kN/mm"
    assert rows["friction.slope"] == "−0.05 s/m"  # noqa: RUF001
    assert rows["reading"] == "consistent"


def test_a_map_of_brakes_has_a_card_without_a_drawing():
    text = DrumBrake(m=np.array([1.0, 2.0]))._repr_html_()
    assert "<img" not in text
    assert "2 values kg" in text


def test_the_figure_of_a_result_is_the_one_plot_draws():
    modes = EXAMPLES["ComplexModes"]()
    ours, theirs = modes.plot(title="a"), plot(modes, title="a")
    assert ours.axes[0].get_title() == theirs.axes[0].get_title() == "a"

"""An analysis' options are told once: sections of files, options of commands and Python's signatures agree."""

import inspect
import typing

import pytest

from squealbox import calibrate, complex_modes, optimise, silence, simulate, squeal_probability, sweep
from squealbox.calibration import CalibrateSettings
from squealbox.cli import main
from squealbox.countermeasures import AbsorberSettings, best_absorber
from squealbox.declarations import field_type
from squealbox.files import DesignFileError, Reduce, json_schema, read_file
from squealbox.limit_cycles import (
    BasinSettings,
    BranchSettings,
    CycleSettings,
    DiagramSettings,
    basin,
    bifurcation_diagram,
    isolated_branches,
    shooting,
)
from squealbox.parameters import ParameterError, load_kind
from squealbox.remedies import SilenceSettings
from squealbox.signals import EventSettings, read_recording, squeal_events
from squealbox.stability import ModeSettings, band_modes
from squealbox.studies import SampleSettings, SearchSettings, WorkerSettings
from squealbox.transient import MotionSettings, simulate_ensemble
from squealbox.workbench.panels import PANELS, Options
from squealbox.workbench.panels.declared import told

# a sheet, the function it is of behind those it calls,
# its fields that are arguments of another name, and those that are part of another
SHEETS = [
    (ModeSettings, (band_modes, complex_modes), {}, ()),
    (MotionSettings, (simulate,), {}, ("mode", "amplitude", "q", "qd")),
    (SampleSettings, (squeal_probability,), {"sampling": "method"}, ()),
    (SearchSettings, (optimise,), {}, ()),
    (WorkerSettings, (sweep,), {}, ()),
    (SilenceSettings, (silence,), {}, ()),
    (DiagramSettings, (bifurcation_diagram,), {}, ()),
    (BasinSettings, (basin,), {}, ()),
    (CycleSettings, (shooting,), {}, ("period", "exponents")),
    (BranchSettings, (isolated_branches,), {"runs": "starts", "at": "values"}, ("start", "estimates")),
    (CalibrateSettings, (calibrate,), {}, ()),
    (EventSettings, (read_recording, squeal_events), {}, ("channel", "band")),
    (AbsorberSettings, (best_absorber,), {}, ()),
]
# what a file calls the default of Python, and a duration, which Python must be given
USUAL = {"method": None, "start": None, "times": None, "duration": inspect._empty}


@pytest.mark.parametrize(("sheet", "functions", "renamed", "parts"), SHEETS, ids=[each[0].__name__ for each in SHEETS])
def test_python_has_the_names_and_values_of_the_sheet(sheet, functions, renamed, parts):
    given = {name: one for each in functions for name, one in inspect.signature(each).parameters.items()}
    for name in (name for name in sheet.field_names() if name not in parts):
        usual = getattr(sheet, name)
        expected = USUAL.get(name, usual) if sheet is MotionSettings else usual
        assert given[renamed.get(name, name)].default == expected, f"{functions[-1].__name__}({name}) and its section"


def test_one_run_and_many_agree():
    one, many = (inspect.signature(function).parameters for function in (simulate, simulate_ensemble))
    for name in ("method", "contact", "rtol", "width", "start_time"):
        assert name not in many or one[name].default == many[name].default, name


@pytest.mark.parametrize(("sheet", "command"), [(ModeSettings, "modes"), (MotionSettings, "simulate"),
                                                (SampleSettings, "scatter"), (SearchSettings, "optimise"),
                                                (CalibrateSettings, "calibrate"), (WorkerSettings, "run")])  # fmt: skip
def test_options_and_schema_come_from_the_sheet(sheet, command, capsys):
    assert main([command, "--help"]) == 0
    text, section = capsys.readouterr().out, json_schema()["oneOf"][0]["properties"][command.replace("run", "study")]
    for name in sheet.field_names():
        if typing.get_origin(field_type(sheet, name)) is not typing.Annotated:  # an array stands in a file
            assert f"--{name.replace('_', '-')}" in text
        assert name in str(section)


@pytest.mark.parametrize("sheet", [ModeSettings, EventSettings, Reduce])
def test_a_band_is_two_numbers_the_lower_first(sheet):
    assert list(sheet(band=(500.0, 1e4)).band) == [500.0, 1e4]
    for wrong in ((1e4, 500.0), (500.0,), (0.0, 500.0), 500.0, (500.0, 600.0, 700.0)):
        with pytest.raises(ParameterError, match="in \\(0, inf\\) Hz"):
            sheet(band=wrong)


def test_help_tells_the_usual_value_and_a_section_what_it_takes(tmp_path, capsys):
    assert main(["basin", "--help"]) == 0
    assert f"[default: {BasinSettings.starts}]" in capsys.readouterr().out
    path = tmp_path / "brake.toml"
    path.write_text(
        'brake = "drum_brake"\n[recording]\nfile = "a.wav"\nunit = "Pa"\nfull_scale = "20 Pa"\nchannel = 1\n'
    )
    assert (read_file(path).recording.place, read_file(path).recording.full_scale) == (1, 20.0)
    path.write_text(path.read_text().replace("channel = 1", 'channel = "mic"\nband = ["16 kHz", "2 kHz"]'))
    with pytest.raises(DesignFileError, match="the lower first"):
        read_file(path)


@pytest.mark.parametrize("panel", PANELS)
def test_a_page_offers_what_the_sheet_has(panel):
    for choice in (each for each in PANELS[panel].choices if each.get("of")):
        sheet, name, offered = load_kind(choice["of"]), choice["name"], told(choice)
        assert offered["meaning"], name
        if name in sheet.choices():
            assert {word for word, _ in choice["options"]} <= set(sheet.choices()[name].options)
            continue
        about = sheet.parameters()[name]
        values = [float(word) for word, _ in choice.get("options", ())] or [offered["low"], offered["high"]]
        assert all(about.low <= value <= about.high for value in values), name
        assert Options({}).chosen(choice)[name] == offered["usual"]


def test_names_of_former_versions_are_read_and_said(tmp_path, capsys):
    path = tmp_path / "brake.toml"
    path.write_text('brake = "drum_brake"\n[simulate]\nduration = "1 ms"\nbegin = "2 ms"\npoints = 11\n')
    found = read_file(path)
    assert (found.simulate.start_time, found.simulate.times) == (2e-3, 11)
    assert found.caution == "simulate.begin is called start_time now; simulate.points is called times now"
    assert main(["simulate", str(path), "--start-time", "3ms", "--times", "12"]) == 0
    assert "Caution: simulate.begin is called start_time now" in capsys.readouterr().err
    path.write_text('brake = "drum_brake"\n[simulate]\npoints = 11\ntimes = 11\n')
    assert main(["simulate", str(path)]) == 2
    assert "which the file sets elsewhere too" in capsys.readouterr().err

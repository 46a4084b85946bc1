"""Answers that were once wrong, dead or stale, each as a kind: units, levels, centres, pulled contacts, round-off."""

from dataclasses import replace

import numpy as np
import pytest

from squealbox import ComplexModes, DrumBrake, LinearSlope, simulate, sound_level
from squealbox.designs import DESIGNS
from squealbox.files import DesignFileError, read_text
from squealbox.report import examine
from squealbox.system import equilibrium
from squealbox.transient import verdict
from squealbox.workbench import panels, server, session
from squealbox.workbench.folder import Project
from squealbox.workbench.guard import Token
from squealbox.workbench.panels import Elsewhere, Options, Work, function_of, listen, panel
from squealbox.workbench.state import design_of


def asked(name, design, **options):
    return function_of(name)(design, Options(options), Work(apart=True)).data


def turning():
    """A brake with rotations, and the first of them."""
    design = DESIGNS["drum_brake_shoes"]()
    return design, design.system().units.index("rad")


def test_a_rotation_is_told_in_radians_and_has_no_level(monkeypatch):
    monkeypatch.setattr(listen, "SECONDS", 0.1)
    design, turn = turning()
    found = asked("motion", design, dof=turn, duration=0.01)
    assert found["unit"].endswith("rad")
    assert "rad over the last" in found["verdict"]
    assert not design.system().units[design.system().names.index(found["loud"]["of"])].endswith("rad")
    heard = asked("listen", design, dof=turn)
    assert heard["level"] is None
    assert heard["unit"].endswith("rad")
    assert "turns" in heard["assumption"]


def test_the_freedom_judged_is_no_rotation_where_something_moves():
    design, _ = turning()
    motion = simulate(design, 0.01, start="rest", times=2048)
    scaled = replace(motion, q=motion.q * np.where(np.array(design.system().units) == "rad", 1e6, 1.0))
    assert "rad over" not in verdict(scaled).text
    assert "m over" in verdict(scaled).text


def test_the_level_of_the_verdict_is_that_of_the_freedom_that_moves_most():
    brake = DrumBrake(friction=LinearSlope(0.45, -0.05))
    loud = asked("motion", brake, duration=0.05)["loud"]
    push = brake_start(brake)
    motion = simulate(brake, 0.05, start=push, times=4096)
    late = np.ptp(motion.q[3072:], axis=0)
    most = int(np.argmax(late))
    assert loud["of"] == brake.system().names[most]
    assert loud["weighted"] == pytest.approx(float(sound_level(motion, dof=most, begin=0.0375).weighted), abs=1e-6)


def brake_start(brake):
    from squealbox import complex_modes

    modes: ComplexModes = complex_modes(brake)
    return modes.most_unstable.start(0.05 * float(np.max(np.abs(equilibrium(brake.system()).q))))


@pytest.mark.parametrize("name", ["mass_on_belt", "block_chain", "mode_coupling"])
def test_a_second_and_a_half_tells_no_frequency_of_what_moves_slower_than_sound(name):
    silent = asked("listen", DESIGNS[name]())["silent"]
    assert "Nothing to hear" in silent or "below 20 Hz" in silent


def test_about_a_centre_nothing_is_followed_and_it_is_said():
    found = asked("branch", DESIGNS["mode_coupling"]())
    assert found["centre"]
    assert found["together"] == []
    assert found["walks"] == 0


def test_a_growth_rate_that_nothing_moves_has_no_ranking():
    undamped = DESIGNS["mode_coupling"]()
    assert asked("sensitivity", undamped)["bars"] == []
    assert asked("sensitivity", undamped.replace({"friction.static": 1.1}))["bars"] != []


def test_a_contact_that_pulls_is_said():
    brake = DrumBrake()
    forces = equilibrium(brake.system()).normal_force
    assert asked("verdict", brake)["pulled"] == [["shoe 1", pytest.approx(float(forces[0]))]]
    assert float(forces[0]) < 0.0
    pressed = brake.replace({"friction.static": 0.0, "friction.slope": 0.0})
    forces = equilibrium(pressed.system()).normal_force
    assert len(asked("verdict", pressed)["pulled"]) == int(np.sum(forces < 0.0))


@pytest.mark.parametrize("value", [1e12, 1e200, 1e300, 1.79e308])
def test_a_value_at_the_end_of_what_numbers_reach_is_answered(value):
    state = {"brake": "drum_brake", "laws": {}, "values": {"load1": value}}
    for name in ("locus", "verdict", "friction", "energy", "sensitivity", "drawing"):
        assert session.answered(name, {"id": 1, "state": state}, {}, Work(apart=True))


def test_a_large_brake_is_computed_apart(monkeypatch):
    state = {"brake": "drum_brake", "laws": {}, "values": {}}
    monkeypatch.setattr(session, "LARGE", 1)
    with pytest.raises(Elsewhere, match="2 degrees of freedom"):
        session.answered("locus", {"id": 1, "state": state}, {}, Work())
    assert session.answered("drawing", {"id": 1, "state": state}, {}, Work())
    assert session.answered("locus", {"id": 1, "state": state}, {}, Work(apart=True))


def test_the_same_margin_in_verdict_comparison_and_report():
    brake = design_of({"brake": "drum_brake", "values": {}}, {})
    said = asked("verdict", brake)
    near = next(each["value"] for each in said["crossings"] if each["changes"])
    margin = (near - said["value"]) / abs(said["value"])
    assert asked("compare", brake)["margin"] == pytest.approx(margin, rel=1e-9)
    assert panel.try_value(brake, "friction.static") == said["value"]


def test_a_report_ends_also_where_the_boundary_has_many_corners():
    found = examine(DESIGNS["sprag_slip"]())
    assert "map" not in found.missing
    growth = found.boundary.growth_rate[np.isfinite(found.boundary.growth_rate)]  # NaN at the edge of steady sliding
    assert growth.size > 10
    assert np.max(np.abs(growth)) < 1e-6 * np.max(np.abs(found.modes.eigenvalues))


def test_a_brake_of_matrices_has_a_report():
    text = 'brake = "own"\nM = [[1.0, 0.0], [0.0, 1.0]]\nC = [[0.01, 0], [0, 0.01]]\nK = [[2.0, -0.5], [0.5, 2.0]]\n'
    found = examine(read_text(text, "own", beside=False).design)
    assert not bool(found.modes.stable)


@pytest.mark.parametrize(
    ("line", "hint"), [("load1 = 1 kN", 'load1 = "1 kN"'), ("m = 2.5kg", 'm = "2.5kg"'), ("m = [1", None)]
)
def test_a_unit_without_quotes_is_told_how(line, hint):
    with pytest.raises(DesignFileError) as said:
        read_text(f'brake = "drum_brake"\n{line}\n', "the file", beside=False)
    assert (hint or "not TOML") in str(said.value)
    assert ("stands in quotes" in str(said.value)) is (hint is not None)


def test_warming_comes_to_its_end(monkeypatch, tmp_path):
    asked_of = []
    monkeypatch.setattr(panels, "function_of", lambda name: asked_of.append(name) or function_of(name))
    monkeypatch.setattr(server, "PATIENCE", 0.0)
    warmed = server.Workbench(Token("x" * 24, 1), Project(tmp_path))
    try:
        warmed._warm()
    finally:
        warmed.recordings.close()
        warmed.beside.close()
    assert "mesh" in asked_of, "which has nothing to say of the drum brake"
    assert asked_of[-1] == "map"

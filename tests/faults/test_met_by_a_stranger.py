"""What somebody who had never seen the program stumbled upon, each with what it shall answer."""

import json

import numpy as np
import pytest

from squealbox import (
    DrumBrake,
    LinearSlope,
    OwnBrake,
    OwnContact,
    ParameterError,
    branch,
    complex_modes,
    critical_value,
    hopf_point,
    plot,
    stability_boundary,
    tracked_modes,
)
from squealbox.cli import main
from squealbox.control import closed_loop
from squealbox.countermeasures import best_absorber
from squealbox.designs import MassOnBelt, PadOnDisc
from squealbox.files import DesignFileError, read_file
from squealbox.friction import Coulomb
from squealbox.limit_cycles import joined, shooting
from squealbox.loops import PID
from squealbox.system import System

DRUM = DrumBrake(theta1=1.92, theta2=0.17, friction=LinearSlope(static=0.45, slope=-0.05))


def test_the_figure_of_tracked_modes_says_no_more_of_the_onset_than_its_values_know():
    tracked = tracked_modes(DRUM, "friction.static", np.linspace(0.0, 1.0, 6))
    said = " ".join(text.get_text() for axes in plot(tracked).axes for text in axes.texts)
    assert "between 0.2 and 0.4" in said
    assert 0.2 < float(critical_value(DRUM, "friction.static", (0.0, 1.0)).value) < 0.4


def test_where_growth_jumps_the_boundary_is_the_curve_on_which_it_does():
    """Friction that has fallen to its floor falls no further: static = 0.02 v divides growth from none."""
    edge = stability_boundary(PadOnDisc(), {"friction.static": (0.0, 1.0), "sliding_speed": (0.1, 2.0)})
    along = edge.x < 0.05
    assert np.ptp(edge.y[along]) == pytest.approx(1.9, rel=1e-3)
    np.testing.assert_allclose(edge.x[along], 0.02 * edge.y[along], atol=1e-5)


def test_an_onset_at_the_end_of_what_a_parameter_may_be():
    found = critical_value(MassOnBelt(), "friction.static", (0.0, 1.0))
    assert found.outcome.ok
    assert float(found.value) == pytest.approx(0.0, abs=1e-9)


def test_a_branch_says_which_way_it_did_not_walk_and_stays_within_its_bounds():
    block = MassOnBelt(friction=Coulomb(0.4, 0.25))
    walk = {"start": shooting(block), "value": 0.2, "method": "shooting", "points": 3}
    ways = [branch(block, "sliding_speed", (0.1, 0.3), direction=way, **walk) for way in (1.0, -1.0)]
    assert "another walk: direction=-1" in ways[0].summary()
    assert "another walk: direction=1" in ways[1].summary()
    assert "another walk" not in joined(*ways[::-1]).summary()
    with pytest.raises(ParameterError, match=r"branch\.value = 0\.9: expected a value within the bounds, 0\.1 to 0\.3"):
        branch(block, "sliding_speed", (0.1, 0.3), value=0.9)


def test_a_hopf_point_says_how_far_its_contacts_keep_sliding():
    """Of an oscillator of one freedom: amplitude times w is the speed of the belt."""
    found = hopf_point(DRUM, "friction.static", (0.1, 0.6))
    system = DRUM.replace({"friction.static": found.first_rest}).system()
    size = found.amplitude(found.first_rest)
    u = found.shape[:2] / np.max(np.abs(found.shape[:2])) * np.max(size)
    swings = [found.angular_frequency * abs(contact.t @ u) for contact in system.contacts]
    assert max(swings) == pytest.approx(0.2, rel=1e-9)
    assert f"{found.first_rest:.10g}" in found.summary()


@pytest.fixture(scope="module")
def pad(tmp_path_factory):
    path = tmp_path_factory.mktemp("pad") / "pad.toml"
    assert main(["init", str(path), "--brake", "own"]) == 0
    return read_file(path).design.replace({"friction.static": 0.9})


def test_a_cycle_is_what_the_motion_settles_to(pad):
    assert shooting(pad).stable


def test_an_unstable_cycle_says_that_no_motion_stays_on_it(pad):
    found = shooting(pad, complex_modes(pad).most_unstable)
    assert not found.stable
    assert "no motion stays on an unstable cycle" in found.summary()
    assert "no motion stays" not in shooting(pad, found).summary()  # handed over, it was looked for


@pytest.mark.parametrize("key", ['theta1 = "2.12 rad"', "foo = 1"])
def test_a_line_that_landed_in_the_study_is_refused_by_every_command(key, tmp_path):
    assert main(["init", str(tmp_path)]) == 0
    path = tmp_path / "brake.toml"
    path.write_text(path.read_text() + key + "\n")
    with pytest.raises(DesignFileError, match=r"study\.axis\[1\]\.\w+: unknown key"):
        read_file(path)


def test_cures_go_to_scripts_too(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "block.toml").write_text('brake = "mass_on_belt"\n')
    assert main(["silence", "block.toml", "--samples", "16", "--json"]) == 0
    told = json.loads(capsys.readouterr().out)["results"][0]
    assert told["caution"] == ""
    assert len(told["values"]["caution"]["value"]) == len(told["values"]["name"]["value"])


def test_no_sampling_is_quick_enough_for_a_brake_on_its_boundary():
    block = System([[1.0]], [[-1.0]], [[1e4]], loops=(PID(on="q1", derivative=1.0 + 1e-9),))
    assert closed_loop(block).sampling_margin(1.0) == float("inf")
    near = System([[1.0]], [[-1.0]], [[1e4]], loops=(PID(on="q1", derivative=1.0 + 1e-4),))
    held = (9.0 / 8.0 + 1.0 / 24.0) * 1e4  # a delay of 1.5 h takes (w 1.5 h)^2/2 of the damping, the hold (w h)^2/24
    assert closed_loop(near).sampling_margin(1.0) == pytest.approx(np.sqrt(held / 1e-4), rel=0.01)


def test_an_absorber_whose_modes_never_meet_is_found_all_the_same():
    brake = OwnBrake(
        M=np.eye(3), K=1e6 * np.eye(3), C=np.eye(3),
        contacts=(OwnContact(name="pad", n=[0.0, 1e5, 0.0], d=[1.0, 0.0, 0.0]),),
        friction=Coulomb(0.9), normal_force=5.0,
    )  # fmt: skip
    assert best_absorber(brake, brake.system().names[0], 0.05).outcome.ok

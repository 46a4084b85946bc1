"""What is written reads back equal: every design, law and schedule; what cannot be written is said."""

import dataclasses
import json
import subprocess
import sys

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from law_examples import LAWS
from squealbox import Coulomb, DrumBrake, LinearSlope, ParameterError, Ramp, Sinusoid, Stribeck
from squealbox.files import BRAKES, NotWritable, OwnBrake, OwnContact, own_law, read_design, read_file, write_design
from squealbox.files.beginnings import mechanism_example
from squealbox.parameters import from_plain, to_plain
from squealbox.schedules import SCHEDULE_NAMES, Constant, Polynomial
from squealbox.schedules import Table as TimeTable

SCHEDULES = [
    Constant(0.2),
    Ramp(0.2, -4.0),
    Ramp(0.2, -4.0, stop=None, begin=0.01),
    Sinusoid(1.0, 0.1, 50.0, phase=0.3),
    TimeTable([0.0, 1.0], [0.1, 1 / 3]),
    Polynomial([0.1, 1 / 3, -2.0], 0.5, 4.0),
]


def own() -> OwnBrake:
    return OwnBrake(
        M=np.eye(2),
        K=[[1e8, 0.1], [1 / 3, 2.0]],
        names=("x", "y"),
        contacts=(
            OwnContact(n=[0.0, 1e5], d=[1.0, 0.0], friction=Stribeck(0.5, 0.3, 0.1), sliding_speed=Ramp(1.0, -2.0)),
            OwnContact(
                n=[0.0, 1.0], d=[1.0, 0.0], t=[0.5, 0.0], name="a \"b\" 'c' \\ é", unilateral=True, normal=[0, 1]
            ),
        ),
    )


def back(design, path):
    return read_design(write_design(design, path / "design.toml"))


def example(name):
    """A design of that name: made of its defaults where it has them."""
    made = {"own": own, "mechanism": mechanism_example}
    return made.get(name, BRAKES[name])()


@pytest.mark.parametrize("name", BRAKES)
def test_every_design_reads_back_equal(name, tmp_path):
    assert back(example(name), tmp_path) == example(name)


def test_every_schedule_is_tried():
    assert {type(schedule) for schedule in SCHEDULES} == set(SCHEDULE_NAMES.values())


@pytest.mark.parametrize("law", LAWS, ids=repr)
def test_every_law_reads_back_equal(law, tmp_path):
    design = DrumBrake(friction=law)
    assert back(design, tmp_path) == design


@pytest.mark.parametrize("schedule", SCHEDULES, ids=repr)
@pytest.mark.parametrize("name", ["load1", "sliding_speed"])
def test_every_schedule_reads_back_equal(schedule, name, tmp_path):
    design = DrumBrake().replace({name: schedule})
    assert back(design, tmp_path) == design


@given(st.data())
def test_any_drum_brake_reads_back_equal(tmp_path_factory, data):
    design = DrumBrake()
    for name, about in DrumBrake.parameters().items():
        low, high = max(about.low, -1e12), min(about.high, 1e12)
        number = st.floats(low, high, exclude_min=about.low_open, allow_subnormal=False)
        design = design.replace({name: data.draw(number, label=name)})
    assert back(design, tmp_path_factory.mktemp("any")) == design


@pytest.mark.parametrize("name", BRAKES)
def test_every_design_survives_being_made_plain(name):
    assert from_plain(json.loads(json.dumps(to_plain(example(name))))) == example(name)


@pytest.mark.parametrize("kind", ["designs.drum_brake.DrumBrake", "files.own_brake.OwnContact"])
def test_a_kind_is_found_before_its_module_is_loaded(kind):
    code = f"from squealbox.parameters import _sheet_class; print(_sheet_class({kind!r}).__name__)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=60)
    assert done.stdout.strip() == kind.rpartition(".")[2]


@pytest.mark.parametrize("kind", ["os.path", "..os.X", "no.such.Thing", "stability.maps.StabilityMap", 3, None, ["a"]])
def test_no_other_kind_is_made(kind):
    with pytest.raises(ParameterError, match="file.kind"):
        from_plain({"kind": kind})


def test_another_design_does_not_read_back_equal(tmp_path):
    assert back(DrumBrake(), tmp_path) != DrumBrake(m=np.nextafter(1.0, 2.0))


def test_every_parameter_is_written_with_unit_meaning_range_and_source(tmp_path):
    text = write_design(DrumBrake(), tmp_path / "design.toml").read_text()
    assert 'k3 = "190 kN/mm"' in text
    assert 'theta1 = "35 deg"' in text
    for about in DrumBrake.parameters().values():
        assert about.meaning in text
        assert about.source in text
        assert about.range in text or about.range.startswith("(-inf, inf)")
    assert DrumBrake.title in text
    assert all(len(line) <= 120 for line in text.splitlines())


def test_sections_are_carried_along(tmp_path):
    path = write_design(DrumBrake(), tmp_path / "a.toml", sections='[simulate]\nduration = "20 ms"\n')
    assert read_file(path).simulate.duration == 0.02
    assert read_file(path).onset is None


def test_values_in_friendly_units_arrive_in_si(tmp_path):
    path = tmp_path / "a.toml"
    path.write_text(
        'brake = "drum_brake"\nload = "2 kN"\ntheta1 = "40 deg"\nk3 = "190 kN/mm"\n'
        'sliding_speed = { ramp = { start = "0.2 m/s", slope = "-4 m/s^2", stop = "none" } }\n'
        'friction = { law = "linear_slope", static = "45 %", slope = "-0.05 s/m", floor = "none" }\n'
        '[map]\nx = { parameter = "theta1", range = ["20 deg", "160 deg"], points = 141 }\n'
        'y = { parameter = "load", range = ["5 kN", 25_000] }\n'
    )
    found = read_file(path)
    wanted = DrumBrake(
        load1=2e3, load2=2e3, theta1=np.deg2rad(40.0), k3=190e6, sliding_speed=Ramp(0.2, -4.0, stop=None),
        friction=LinearSlope(0.45, -0.05),
    )  # fmt: skip
    assert found.design == wanted
    assert found.map.x.values[[0, -1]] == pytest.approx(np.deg2rad([20.0, 160.0]), rel=1e-15)
    assert len(found.map.x.values) == 141
    assert (found.map.y.low, found.map.y.high) == (5e3, 25e3)


@pytest.mark.parametrize(
    "design",
    [
        DrumBrake(sliding_speed=Ramp(0.2, -4.0) * 2.0),
        OwnBrake(M=np.eye(300), K=np.arange(90000.0).reshape(300, 300) + 1 / 3),
    ],
    ids=["a sum of schedules", "a large matrix"],
)
def test_what_a_file_cannot_hold_is_said_and_nothing_is_left(design, tmp_path):
    with pytest.raises(NotWritable):
        write_design(design, tmp_path / "a.toml")
    assert list(tmp_path.iterdir()) == []


def test_a_map_is_not_written(tmp_path):
    with pytest.raises(NotWritable, match="m"):
        write_design(DrumBrake(m=[1.0, 2.0]), tmp_path / "a.toml")


def test_own_brake_is_the_system_it_describes():
    contact = OwnContact(n=[0.0, 3.0], d=[1.0, 0.0])
    brake = OwnBrake(
        M=np.eye(2), K=[[2.0, 1.0], [1.0, 2.0]], friction=Coulomb(0.5), normal_force=7.0, contacts=(contact,)
    )
    system = brake.system()
    assert (system.contacts[0].N0, system.contacts[0].V, system.contacts[0].law) == (7.0, 1.0, Coulomb(0.5))
    assert np.array_equal(system.contacts[0].t, [1.0, 0.0])
    assert np.array_equal(system.C, np.zeros((2, 2)))
    assert brake.replace({"friction.static": np.array([0.1, 0.2])}).system().shape == (2,)
    with pytest.raises(ParameterError, match=r"contacts\[0\]\.n"):
        dataclasses.replace(brake, contacts=(OwnContact(n=[1.0], d=[1.0, 0.0]),))


def test_an_own_law_is_not_written(tmp_path):
    with pytest.raises(NotWritable, match="code"):
        write_design(DrumBrake(friction=own_law("def mu(v, p): return 0.3 + 0.0 * v")), tmp_path / "brake.toml")
    assert list(tmp_path.iterdir()) == []

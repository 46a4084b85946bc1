"""The JSON schema says yes to what the reader takes, and no to what it refuses for its shape."""

import tomllib

import pytest

from faults.hostile_files import HOSTILE
from squealbox import DrumBrake, LinearSlope, Ramp
from squealbox.files import BRAKES, OwnBrake, OwnContact, json_schema, write_design

jsonschema = pytest.importorskip("jsonschema")


@pytest.fixture(scope="module")
def validator():
    schema = json_schema()
    jsonschema.Draft7Validator.check_schema(schema)
    return jsonschema.Draft7Validator(schema)


GOOD = [
    DrumBrake(),
    DrumBrake(friction=LinearSlope(0.4, -0.1, 0.2), sliding_speed=Ramp(0.2, -4.0, stop=None)),
    OwnBrake(M=[[1.0]], K=[[1.0]], contacts=(OwnContact(n=[1.0], d=[1.0], friction=LinearSlope(0.3, 0.0)),)),
]
SECTIONS = (
    '[modes]\ntime = "1 ms"\n[simulate]\nduration = "50 ms"\ntimes = 11\nq = [1e-6]\n'
    '[onset]\nparameter = "friction.static"\nrange = [0, "50 %"]\n'
    "[map.x]\nparameter = 'friction.static'\nrange = [0, 1]\n[map.y]\nparameter = 'm'\nrange = [1, 2]\npoints = 3\n"
)


@pytest.mark.parametrize("design", GOOD, ids=repr)
def test_what_is_written_is_valid(design, validator, tmp_path):
    text = write_design(design, tmp_path / "a.toml", sections=SECTIONS).read_text()
    assert list(validator.iter_errors(tomllib.loads(text))) == []


SHAPES = [
    name for name in HOSTILE if name.startswith(("key, brake", "key, misspelt", "key, reading", "law, un", "section"))
]


@pytest.mark.parametrize("name", SHAPES)
def test_what_is_misspelt_is_not_valid(name, validator):
    assert list(validator.iter_errors(tomllib.loads(HOSTILE[name][0])))


def test_every_brake_is_in_the_schema():
    assert json_schema()["properties"]["brake"]["enum"] == [*BRAKES, "assembled", "reduced"]

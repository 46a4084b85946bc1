"""Mechanisms with a mistake in them: one sentence each, with the place."""

import pytest

from squealbox.files import DesignFileError, read_design

GOOD = """brake = "mechanism"
[[bodies]]
name = "pad"
mass = "1 kg"
[[springs]]
body = "pad"
angle = "30 deg"
stiffness = "1 kN/mm"
[[springs]]
body = "pad"
angle = "90 deg"
stiffness = "1 kN/mm"
[[contacts]]
body = "pad"
"""

WRONG = [
    ('name = "pad"', 'name = "ground"', "bodies[0].name"),
    ('name = "pad"', 'name = "a b"', "bodies[0].name"),
    ('mass = "1 kg"', 'mass = "0 kg"', "bodies[0].mass"),
    ('mass = "1 kg"', 'mass = "1 N"', "bodies[0].mass"),
    ('mass = "1 kg"', "", "mass"),
    ('mass = "1 kg"', 'mass = 1\nmoves = "z"', "bodies[0].moves"),
    ('angle = "30 deg"', 'angle = "30 deg"\nto = "disc"', "springs[0].to"),
    ('angle = "30 deg"', 'angle = "30 deg"\nto = "pad"', "springs[0].to"),
    ('angle = "30 deg"', 'angle = "30 m"', "springs[0].angle"),
    ('[[contacts]]\nbody = "pad"', '[[contacts]]\nbody = "disc"', "contacts[0].body"),
]


def write(folder, text):
    path = folder / "brake.toml"
    path.write_text(text)
    return path


def test_the_good_one_is_read(tmp_path):
    assert read_design(write(tmp_path, GOOD)).system().names == ("pad_x", "pad_y")


@pytest.mark.parametrize(("old", "new", "key"), WRONG)
def test_a_mistake_is_one_sentence(old, new, key, tmp_path):
    with pytest.raises(DesignFileError) as caught:
        read_design(write(tmp_path, GOOD.replace(old, new, 1)))
    assert len(caught.value.problems) == 1
    assert key in str(caught.value)

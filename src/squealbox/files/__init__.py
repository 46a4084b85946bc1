"""Design files: a brake and what is asked of it, in TOML with units. Depends on: designs, system, friction, schedules.

    design = read_design("brake.toml")          every problem at once: file, line, key, what is expected
    write_design(design, "copy.toml")           commented, reads back equal
    json_schema()                               for editors

Importing this room loads neither pint nor SciPy.
"""

from squealbox.files.document import DesignFileError, Problem
from squealbox.files.measured import read_points
from squealbox.files.mechanism import Body, OwnMechanism, Spring, Touch
from squealbox.files.own_brake import OwnBrake, OwnContact, Part
from squealbox.files.own_law import OwnLaw, law_from_file, own_law
from squealbox.files.reading import BRAKES, DesignFile, read_design, read_file, read_text
from squealbox.files.schema import json_schema
from squealbox.files.writing import NotWritable, write_design

__all__ = [
    "BRAKES",
    "Body",
    "DesignFile",
    "DesignFileError",
    "NotWritable",
    "OwnBrake",
    "OwnContact",
    "OwnLaw",
    "OwnMechanism",
    "Part",
    "Problem",
    "Spring",
    "Touch",
    "json_schema",
    "law_from_file",
    "own_law",
    "read_design",
    "read_file",
    "read_points",
    "read_text",
    "write_design",
]

"""Design files: a brake and what is asked of it, in TOML with units. Depends on: designs, system, friction, schedules.

    design = read_design("brake.toml")          every problem at once: file, line, key, what is expected
    write_design(design, "copy.toml")           commented, reads back equal
    json_schema()                               for editors

Importing this room loads neither pint nor SciPy.
"""

from squealbox.files.document import DesignFileError, Problem
from squealbox.files.own_brake import OwnBrake, OwnContact
from squealbox.files.reading import BRAKES, DesignFile, read_design, read_file
from squealbox.files.schema import json_schema
from squealbox.files.writing import NotWritable, write_design

__all__ = [
    "BRAKES",
    "DesignFile",
    "DesignFileError",
    "NotWritable",
    "OwnBrake",
    "OwnContact",
    "Problem",
    "json_schema",
    "read_design",
    "read_file",
    "write_design",
]

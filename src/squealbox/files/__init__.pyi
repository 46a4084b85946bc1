from .document import DesignFileError, Problem
from .measured import read_points
from .mechanism import Body, OwnMechanism, Spring, Touch
from .own_brake import OwnBrake, OwnContact, Part
from .own_law import OwnLaw, law_from_file, own_law
from .reading import BRAKES, DesignFile, read_design, read_file, read_text
from .schema import json_schema
from .writing import NotWritable, write_design

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

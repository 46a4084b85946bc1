from .beginnings import BEGINNINGS, asked_of, first_design
from .document import DesignFileError, Problem
from .measured import read_points
from .mechanism import Body, OwnMechanism, Spring, Touch
from .own_brake import OwnBrake, OwnContact, Part
from .own_law import OwnLaw, law_from_file, own_law
from .reading import BRAKES, MESHED, READERS, SECTIONS, STUDY, DesignFile, read_design, read_file, read_text
from .reduced import ONE_WAY, Reduce, Reduced, dense, error_table, for_a_page, promise
from .schema import json_schema
from .study import StudyFile, read_study
from .uncertain import STUDIES, Scattered
from .varied import VARY
from .writing import NotWritable, cure_text, design_text, write_design

__all__ = [
    "BEGINNINGS",
    "BRAKES",
    "MESHED",
    "ONE_WAY",
    "READERS",
    "SECTIONS",
    "STUDIES",
    "STUDY",
    "VARY",
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
    "Reduce",
    "Reduced",
    "Scattered",
    "Spring",
    "StudyFile",
    "Touch",
    "asked_of",
    "cure_text",
    "dense",
    "design_text",
    "error_table",
    "first_design",
    "for_a_page",
    "json_schema",
    "law_from_file",
    "own_law",
    "promise",
    "read_design",
    "read_file",
    "read_points",
    "read_study",
    "read_text",
    "write_design",
]

# What neighbours may use too; no names of the reference (docs/house.md, Faces).

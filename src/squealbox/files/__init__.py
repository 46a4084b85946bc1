"""Design files: a brake and what is asked of it, in TOML with units.

    design = read_design("brake.toml")          every problem at once: file, line, key, what is expected
    write_design(design, "copy.toml")           commented, reads back equal
    json_schema()                               for editors

Its public names stand in ``__init__.pyi`` and are loaded when they are first used: a page that only wants to know what
a file calls a law reads no meshes and fits no measurements.
"""

from squealbox.registers import face

__getattr__, __dir__, __all__ = face(__name__)

from squealbox.files.own_law import own_law  # noqa: E402, F401 - the function, whose module has the same name

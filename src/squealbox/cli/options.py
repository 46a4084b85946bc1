"""Options of several commands, known without reading a design."""

from typing import Annotated

import cyclopts

AllowCode = Annotated[bool, cyclopts.Parameter(name="--allow-code", negative="")]

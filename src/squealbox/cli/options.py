"""Options of several commands, known without reading a design."""

from dataclasses import dataclass
from typing import Annotated

import cyclopts

AllowCode = Annotated[bool, cyclopts.Parameter(name="--allow-code", negative="")]
Changes = Annotated[tuple[str, ...], cyclopts.Parameter(name="--set", negative="", show_default=False)]


@dataclass(frozen=True)
class HowAsked:
    """What every command takes that reads a design file.

    Parameters
    ----------
    changes
        other values for this run: --set friction.static=0.4 load="2 kN"
    allow_code
        run the Python file of a friction law that the design file names
    """

    changes: Changes = ()
    allow_code: AllowCode = False


Asked = Annotated[HowAsked, cyclopts.Parameter(name="*")]
AS_WRITTEN = HowAsked()

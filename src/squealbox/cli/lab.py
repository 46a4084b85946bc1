"""`squealbox lab`: the workbench in the browser."""

import sys
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from squealbox.cli import UsageError
from squealbox.cli.options import AllowCode

LINK = "#d="  # what a link to a design carries behind its address


def lab(
    file: str | None = None,
    *,
    port: int | None = None,
    browser: Annotated[bool, Parameter(negative="--no-browser")] = True,
    allow_code: AllowCode = False,
) -> None:
    """A page on this machine where a brake is explored live: parameters as sliders, stability, motion, what to change.

    It is served on loopback only, needs no internet, and ends with Ctrl-C.

    Parameters
    ----------
    file
        design file to start with, or a link that somebody copied from his workbench
    port
        where the page is served; left out, 8642 or the next free one
    browser
        open the page in the browser
    allow_code
        run the friction law in the file that is Python code
    """
    if port is not None and not 0 <= port <= 65535:
        raise UsageError(f"--port {port}: expected 0 to 65535")
    text, fragment, design = "", "", None
    if file is not None and LINK in file:
        fragment = "d=" + file.partition(LINK)[2]
    elif file is not None:
        from squealbox.files import read_file
        from squealbox.files.reduced import for_a_page
        from squealbox.system import InvalidSystem

        found = read_file(Path(file), allow_code=allow_code)  # says all that is wrong before anything is served
        if found.design.system().is_sparse:
            print("squealbox lab: making the finite-element brake small, which takes some seconds", file=sys.stderr)
        try:
            design = for_a_page(found)
        except InvalidSystem as error:
            raise UsageError(f"{file}: {error}") from error
        text = Path(file).read_text(encoding="utf-8")
    from squealbox.workbench.lab import serve

    serve(text, port, design=design, browser=browser, fragment=fragment)

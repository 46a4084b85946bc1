"""`squealbox lab`: the workbench in the browser."""

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from squealbox.cli import UsageError
from squealbox.cli.options import AllowCode

ABOUT = {"lab": "the workbench: a page in the browser where a brake is explored live"}

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
        design file to start with, a link that somebody copied from his workbench, or the folder of a project, which is
        made where there is none; left out, the project is in ~/.local/share/squealbox/workbench
    port
        where the page is served; left out, 8642 or the next free one
    browser
        open the page in the browser
    allow_code
        run the friction law in the file that is Python code
    """
    if port is not None and not 0 <= port <= 65535:
        raise UsageError(f"--port {port}: expected 0 to 65535")
    path, fragment, folder = None, "", None
    if file is not None and LINK in file:
        fragment = "d=" + file.partition(LINK)[2]
    elif file is not None and (Path(file).is_dir() or not (Path(file).exists() or Path(file).suffix)):
        folder = Path(file)
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise UsageError(f"{file}: the folder of a project cannot be made: {error.strerror}") from error
    elif file is not None:
        path = Path(file)
    from squealbox.workbench import serve

    serve(path, port, allow_code=allow_code, browser=browser, fragment=fragment, folder=folder)

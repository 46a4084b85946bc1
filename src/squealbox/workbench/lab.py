"""From the command to the page: a free port on loopback, the token, the server, the browser."""

import functools
import logging
import os
import secrets
import socket
import sys
import threading
import webbrowser
from pathlib import Path
from typing import Any
from urllib.parse import quote

from squealbox.extras import need

HOST = "127.0.0.1"
PORT = 8642
TRIES = 20  # ports after the usual one that are tried


def serve(
    path: Path | None = None, port: int | None = None, *, allow_code: bool = False, browser: bool = True,
    fragment: str = "", folder: Path | None = None,
) -> None:  # fmt: skip
    """Serve the workbench on loopback until it is stopped with Ctrl-C.

    Parameters
    ----------
    path : a design file to start with, whose matrices may stand beside it; a law in it that is code needs `allow_code`
    port : None takes 8642 or the next free one
    browser : open the page in the browser
    fragment : what stands behind the # of the page's address: a design shared by its link
    folder : the project; left out, the one that stands ready (`folder.standing`)

    Raises `DesignFileError` for a file that is no design, `InvalidSystem` for one too large for a page and
    `MissingExtra` before anything is served, `OSError` where the port is taken.
    """
    need("workbench", "uvicorn", "starlette", "websockets", "tomlkit")
    for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ.setdefault(name, "1")  # many small matrices: threads of the algebra only stand in each other's way
    file = _opened(path, allow_code) if path is not None else None
    listening = listen(port)
    port = listening.getsockname()[1]
    token = kept_token()
    address = f"http://{HOST}:{port}/?token={quote(token)}{'#' + fragment if fragment else ''}"
    print(f"squealbox lab: {address}\nstop it with Ctrl-C", flush=True)  # who comes early waits in the socket's queue
    if browser:
        threading.Thread(target=webbrowser.open, args=[address], daemon=True).start()
    import uvicorn

    from squealbox.workbench.folder import Project, standing
    from squealbox.workbench.guard import Token
    from squealbox.workbench.patience import Patient
    from squealbox.workbench.server import LARGEST_MESSAGE, Workbench

    app = Workbench(Token(token, port), Project(folder or standing()), file).app()
    config = uvicorn.Config(
        app, log_level="warning", http=Patient, ws="websockets-sansio", ws_max_size=LARGEST_MESSAGE,
        ws_per_message_deflate=False, lifespan="on", timeout_graceful_shutdown=2, access_log=False, server_header=False,
    )  # fmt: skip
    logging.getLogger("uvicorn.error").addFilter(_is_news)
    uvicorn.Server(config).run(sockets=[listening])


def _opened(path: Path, allow_code: bool) -> Any:
    """The design file to start with; all that is wrong with it is said before anything is served."""
    from squealbox.files import for_a_page, read_file, read_text
    from squealbox.workbench.session import Opened

    found = read_file(path, allow_code=allow_code)
    if found.design.system().is_sparse:
        print("squealbox lab: making the finite-element brake small, which takes some seconds", file=sys.stderr)
    read = functools.partial(read_text, name=str(path))
    return Opened(path.read_text(encoding="utf-8"), found, read, for_a_page(found))


def _is_news(record: logging.LogRecord) -> bool:
    """A foreign page that was refused is no news; uvicorn takes the refusal for an unfinished handshake."""
    return "without completing handshake" not in record.getMessage()


def listen(port: int | None) -> socket.socket:
    """A socket on loopback: on `port`, or on the usual one or the next that is free."""
    last: OSError | None = None
    for each in [port] if port is not None else [*range(PORT, PORT + TRIES), 0]:
        listening = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
        if sys.platform != "win32":
            listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            listening.bind((HOST, each))
            listening.listen(128)
            return listening
        except OSError as error:
            listening.close()
            last = error
    raise OSError(last.errno if last else 0, f"the port is taken: {last}", f"{HOST}:{port}")


def kept_token() -> str:
    """The token of this user on this machine, made once, so that an open page survives a restart of the server."""
    given = os.environ.get("SQUEALBOX_TOKEN", "")
    if given:
        return given
    base = os.environ.get("XDG_STATE_HOME") or Path.home() / ".local" / "state"
    path = Path(base) / "squealbox" / "workbench-token"
    try:
        token = path.read_text(encoding="ascii").strip()
    except (OSError, ValueError):
        token = ""
    if len(token) >= 20:
        return token
    token = secrets.token_urlsafe(24)
    try:
        path.parent.mkdir(parents=True, exist_ok=True, mode=0o700)
        handle = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o600)
        with os.fdopen(handle, "w", encoding="ascii") as stream:
            stream.write(token)
    except OSError as error:
        print(f"squealbox lab: the token cannot be kept ({error.strerror}): a restart will need a new page")
    return token

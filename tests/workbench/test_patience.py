"""A connection that is opened and not used, or a request that never ends, is not held for ever."""

import socket
import threading
import time

import pytest
import uvicorn
from websockets.sync.client import connect

from squealbox.workbench.folder import Project
from squealbox.workbench.guard import Token
from squealbox.workbench.lab import listen
from squealbox.workbench.patience import PATIENCE, Patient
from squealbox.workbench.recorded import FOLDER
from squealbox.workbench.server import Workbench

WAITED = 0.6  # s, instead of a quarter of a minute
TOKEN = "token-of-the-tests-0123456789"
HEAD = (
    b"POST /recording?name=a.wav&token=%s HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Length: 100\r\n\r\n" % TOKEN.encode()
)
PAGE = b"GET /static/app.js HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n"


class Hasty(Patient):
    patience = WAITED


@pytest.fixture(scope="module")
def port(tmp_path_factory):
    """A server of this process, which waits for nobody longer than a moment."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv(FOLDER, "")
        patch.setenv("SQUEALBOX_PROJECT", "")
        listening = listen(0)
        number = listening.getsockname()[1]
        app = Workbench(Token(TOKEN, number), Project(tmp_path_factory.mktemp("bench"))).app()
        config = uvicorn.Config(app, http=Hasty, ws="websockets-sansio", log_level="error", lifespan="off")
        server = uvicorn.Server(config)
        thread = threading.Thread(target=server.run, kwargs={"sockets": [listening]})
        thread.start()
        yield number
        server.should_exit = True
        thread.join(20)


def held(port, *pieces, pause=0.0):
    """Seconds until the server ends a connection on which these pieces are sent, and all it says."""
    with socket.create_connection(("127.0.0.1", port), timeout=20) as line:
        began, heard = time.monotonic(), b""
        for piece in pieces:
            line.sendall(piece)
            time.sleep(pause)
        while part := line.recv(65536):
            heard += part
        return time.monotonic() - began, heard


@pytest.mark.parametrize("sent", [b"", b"GET / HT", b"GET / HTTP/1.1\r\nHost: 127.0.0.1\r\n", HEAD, HEAD + b"RIFF"])
def test_what_is_never_finished_is_ended(port, sent):
    seconds, _ = held(port, sent)
    assert 0.5 * WAITED < seconds < 10.0 * WAITED


def test_headers_that_trickle_are_not_waited_for(port):
    with pytest.raises(ConnectionError):  # writing goes on until the line is found closed
        held(port, b"GET / HTTP/1.1\r\n", *[b"X: y\r\n"] * 40, pause=0.1)


def test_a_body_that_goes_on_is_waited_for(port):
    seconds, heard = held(port, HEAD, *[b"x" * 10] * 10, pause=0.25 * WAITED)
    assert seconds > 2.0 * WAITED
    assert b'"id"' in heard


def test_a_half_request_after_a_whole_one_is_ended_too(port):
    seconds, heard = held(port, PAGE, b"GET / HT")
    assert heard.startswith(b"HTTP/1.1 200")
    assert seconds < 10.0 * WAITED


def test_a_page_that_asks_nothing_keeps_its_connection(port):
    with connect(f"ws://127.0.0.1:{port}/ws?token={TOKEN}", max_size=None) as line:
        line.recv(timeout=20)
        time.sleep(4.0 * WAITED)
        line.send('{"id": 1, "ask": "stop", "view": "map"}')
        assert b'"done"' in line.recv(timeout=20)


def test_the_usual_patience_is_a_quarter_of_a_minute():
    assert Patient.patience == PATIENCE == 15.0

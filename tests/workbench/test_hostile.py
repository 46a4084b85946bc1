"""Hostile and careless requests: each is refused or answered with a sentence, and the server goes on."""

import http.client
import json

import numpy as np
import pytest
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import connect

from squealbox.plots.figure_data import unpacked
from squealbox.workbench.frames import unframed

STATE = {"brake": "drum_brake", "laws": {}, "values": {}}


def get(server, path, **headers):
    """Status, headers and body of a plain request."""
    connection = http.client.HTTPConnection("127.0.0.1", server.port, timeout=30)
    connection.request("GET", path, headers=headers)
    answer = connection.getresponse()
    body = answer.read()
    connection.close()
    return answer.status, dict(answer.getheaders()), body


def opened(server, token=None, **options):
    """A connection as a page makes it."""
    address = f"ws://127.0.0.1:{server.port}/ws?token={server.token if token is None else token}"
    return connect(address, max_size=None, open_timeout=30, **options)


class Talk:
    """One connection, with the frames that come back."""

    def __init__(self, server):
        self.connection = opened(server)

    def __enter__(self):
        self.socket = self.connection.__enter__()
        assert self.frame()[0]["kind"] == "hello"
        return self

    def __exit__(self, *rest):
        self.connection.__exit__(*rest)

    def frame(self):
        return unframed(self.socket.recv(timeout=120))

    def send(self, message):
        self.socket.send(message if isinstance(message, str) else json.dumps(message))

    def ask(self, message):
        self.send(message)
        return self.frame()


@pytest.fixture
def talk(server):
    with Talk(server) as opened_talk:
        yield opened_talk


def send_and_receive(socket, text):
    socket.send(text)
    return socket.recv(timeout=30)


def locus(number, **values):
    return {"id": number, "view": "locus", "state": {**STATE, "values": values}, "options": {}}


def test_the_page_carries_a_policy_and_needs_the_token(server):
    status, headers, _ = get(server, f"/?token={server.token}")
    assert status == 200
    assert headers["content-security-policy"].startswith("default-src 'self'")
    assert "unsafe" not in headers["content-security-policy"]
    assert "SameSite=strict" in headers["set-cookie"]
    for path in ("/", "/?token=", "/?token=wrong", f"/?token={server.token}x"):
        assert get(server, path)[0] == 403


@pytest.mark.parametrize("path", ["/", "/static/app.js", "/favicon.ico"])
def test_a_foreign_host_and_a_foreign_origin_are_refused(server, path):
    assert get(server, path, Host="squeal.example")[0] == 400
    assert get(server, path, Origin="http://squeal.example")[0] == 403
    assert get(server, path, Origin="null")[0] == 403
    assert get(server, path, Origin=f"http://127.0.0.1:{server.port + 1}")[0] == 403


@pytest.mark.parametrize(
    ("status", "headers"),
    [
        (400, {"Host": "squeal.example"}),
        (403, {"Origin": "http://squeal.example"}),
        (403, {"Origin": "null"}),
    ],
)
def test_a_foreign_page_gets_no_connection(server, status, headers):
    upgrade = {"Connection": "Upgrade", "Upgrade": "websocket", "Sec-WebSocket-Version": "13"}
    key = {"Sec-WebSocket-Key": "dGhlIHNhbXBsZSBub25jZQ=="}
    assert get(server, f"/ws?token={server.token}", **upgrade, **key, **headers)[0] == status


def test_own_origin_and_own_token_get_one(server):
    with opened(server, origin=f"http://127.0.0.1:{server.port}") as socket:
        assert unframed(socket.recv(timeout=30))[0]["kind"] == "hello"


@pytest.mark.parametrize("token", ["", "wrong", "%00", "ä"])
def test_no_connection_without_the_token(server, token):
    with pytest.raises(InvalidStatus) as refused, opened(server, token):
        pytest.fail("connected")
    assert refused.value.response.status_code == 403


@pytest.mark.parametrize(
    "path",
    [
        "/static/../server.py",
        "/static/%2e%2e/server.py",
        "/static/..%2fserver.py",
        "/static//etc/passwd",
        "/static/panels/../../server.py",
        "/static/",
    ],
)
def test_no_path_leads_out_of_the_folder(server, path):
    status, _, body = get(server, path)
    assert status in (404, 405)
    assert b"import" not in body


@pytest.mark.parametrize(
    "message",
    [
        "",
        "{",
        "null",
        "[]",
        '"text"',
        "[" * 100_000,
        '{"id": "x"}',
        '{"id": -1}',
        '{"id": true, "view": "locus"}',
        '{"id": 1}',
        '{"id": 1, "view": "nothing"}',
        '{"id": 1, "view": ["locus"]}',
        '{"id": 1, "ask": "rm"}',
        '{"id": 1e999, "view": "locus"}',
    ],
)
def test_what_is_no_question_is_answered_with_a_sentence(talk, message):
    header, _ = talk.ask(message)
    assert header["kind"] == "malformed"
    assert header["message"]
    assert talk.ask(locus(7))[0]["kind"] == "answer"


@pytest.mark.parametrize(
    "state",
    [
        None,
        [],
        "drum_brake",
        {},
        {"brake": "../../etc/passwd"},
        {"brake": ["drum_brake"]},
        {"base": "0123456789abcdef"},
        {"base": {"a": 1}},
        {"brake": "drum_brake", "values": [1]},
        {"brake": "drum_brake", "laws": {"m": "coulomb"}},
        {"brake": "drum_brake", "laws": {"friction": "__class__"}},
        {"brake": "drum_brake", "laws": {"friction": ["coulomb"]}},
        {"brake": "drum_brake", "values": {f"x{i}": 0 for i in range(1000)}},
    ],
)
def test_a_state_that_is_no_design_says_why(talk, state):
    header, _ = talk.ask({"id": 3, "view": "verdict", "state": state, "options": {}})
    assert header["kind"] in ("wrong", "unknown_base")
    assert header["wrong"][0]["message"]


@pytest.mark.parametrize(
    ("path", "value"),
    [
        ("m", "NaN"), ("m", float("nan")), ("m", float("inf")), ("m", -1.0), ("m", 0.0), ("m", None), ("m", True),
        ("m", "1 kg"), ("m", [1.0, 2.0]), ("m", {"kind": "schedules.Ramp"}), ("nothing", 1.0),
        ("friction", 1.0), ("friction.nothing", 1.0), ("friction.static.x", 1.0), ("__class__", 1.0), ("", 1.0),
        ("reading", "none of these"), ("reading", 3.0), ("system", 1.0),
        pytest.param("m", 10**400, id="m-huge"), pytest.param("x" * 10_000, 1.0, id="long name"),
    ],
)  # fmt: skip
def test_a_wrong_value_is_told_for_its_field(talk, path, value):
    header, _ = talk.ask(locus(5, **{path: value}))
    assert header["kind"] == "wrong"
    assert header["wrong"][0]["field"] == path[:100]
    assert "expected" in header["wrong"][0]["message"] or "one of" in header["wrong"][0]["message"]


def test_every_wrong_value_is_told_at_once(talk):
    header, _ = talk.ask(locus(5, m=-1.0, k1=0.0, **{"friction.static": 11.0}))
    assert [each["field"] for each in header["wrong"]] == ["m", "k1", "friction.static"]


@pytest.mark.parametrize(
    ("view", "options"),
    [
        ("locus", {"parameter": "nothing"}),
        ("locus", {"parameter": 3}),
        ("locus", {"parameter": "m", "span": [2, 1]}),
        ("locus", {"parameter": "m", "span": [-1, 1]}),
        ("locus", {"parameter": "m", "span": "wide"}),
        ("locus", {"parameter": "m", "span": [1, float("nan")]}),
        ("map", {"x": "m", "y": "m"}),
        ("map", {"points": 1e9}),
        ("map", {"show": "secrets"}),
        ("motion", {"dof": 0.5}),
        ("motion", {"duration": -1}),
        ("motion", {"start": "nowhere"}),
        ("locus", [1]),
    ],
)
def test_a_wrong_option_is_told(talk, view, options):
    header, _ = talk.ask({"id": 6, "view": view, "state": STATE, "options": options})
    while header["kind"] == "progress":
        header, _ = talk.frame()
    assert header["kind"] == "wrong"
    assert header["wrong"][0]["message"]


@pytest.mark.parametrize(
    "text", [None, 3, "x" * 1_500_000, "brake = ", "brake = 'nothing'", 'brake = "own"\nM = "../../secret.npy"', "\x00"]
)
def test_a_text_that_is_no_design_says_why(server, text):
    with Talk(server) as talk:
        header, _ = talk.ask({"id": 1, "ask": "open", "text": text})
    assert header["kind"] == "wrong"
    assert header["wrong"][0]["message"]


def test_a_huge_frame_ends_its_connection_and_no_other(server, talk):
    with opened(server) as other:
        other.recv(timeout=30)
        with pytest.raises(ConnectionClosed):
            send_and_receive(other, "x" * 5_000_000)
    assert talk.ask(locus(1))[0]["kind"] == "answer"


def test_code_in_a_file_is_not_run(talk):
    text = 'brake = "pad_on_disc"\n[friction]\nlaw = "own"\nfile = "law.py"\nnumbers = [1.0]\n'
    header, _ = talk.ask({"id": 1, "ask": "open", "text": text})
    assert header["kind"] == "wrong"
    assert "is code" in header["wrong"][0]["message"]


def test_binary_messages_are_answered_too(talk):
    talk.socket.send(b"\x00\x01")
    assert talk.frame()[0]["kind"] == "malformed"


def test_of_many_questions_the_newest_is_answered_and_none_is_forgotten(talk):
    for number in range(50):
        talk.send(locus(number, **{"friction.static": 0.3 + 0.001 * number}))
    answers = [talk.frame() for _ in range(50)]
    kinds = {header["id"]: header["kind"] for header, _ in answers}
    assert set(kinds) == set(range(50))
    assert kinds[0] == kinds[49] == "answer"
    assert "superseded" in kinds.values()


def test_what_one_page_opened_is_unknown_to_another(server, talk):
    with Talk(server) as other:
        base = talk.ask({"id": 1, "ask": "open", "text": 'brake = "pad_on_disc"\nm1 = 7.0\n'})[0]["base"]
        state = {"base": base, "values": {}}
        assert talk.ask({"id": 2, "view": "locus", "state": state})[0]["kind"] == "answer"
        assert other.ask({"id": 2, "view": "locus", "state": state})[0]["kind"] == "unknown_base"


def test_an_answer_is_that_of_the_library(talk):
    from squealbox import DrumBrake, LinearSlope, complex_modes

    header, arrays = talk.ask(locus(9, **{"friction.static": 0.45, "load1": 2000.0}))
    modes = complex_modes(DrumBrake(friction=LinearSlope(0.45, -0.05), load1=2000.0))
    assert header["id"] == 9
    plane = unpacked(header["data"], arrays, "plane")["layers"]
    here = next(layer for layer in plane if layer.get("column") == "present design")
    assert np.allclose(here["x"], modes.growth_rate[:2], rtol=1e-6)
    assert np.allclose(1e3 * np.array(here["y"]), modes.frequency[:2], rtol=1e-6)

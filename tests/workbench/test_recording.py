"""Does it match the test? A rendered stop dropped onto the page: its event, the model beside it, and the fit."""

import http.client
import json
import wave

import numpy as np
import pytest

from squealbox import DrumBrake, LinearSlope, complex_modes
from squealbox.workbench.panels import OptionError, Options, Work, function_of
from squealbox.workbench.recorded import FOLDER, Recordings, path_of

RATE, HERTZ, GROWTH = 48_000, 2078.0, 400.0
TRUTH = DrumBrake(friction=LinearSlope(0.36, -0.05))


@pytest.fixture(scope="module")
def stop(tmp_path_factory):
    """A WAV file of a second and a half in which one tone grows, stays and dies away, in little noise."""
    t = np.arange(int(1.5 * RATE)) / RATE
    envelope = np.exp(GROWTH * np.minimum(t - 0.5, 0.0) - 200.0 * np.maximum(t - 1.0, 0.0))
    sound = 0.5 * envelope * np.sin(2.0 * np.pi * HERTZ * t) + 1e-3 * np.random.default_rng(0).standard_normal(t.size)
    path = tmp_path_factory.mktemp("stop") / "stop.wav"
    with wave.open(str(path), "wb") as file:
        file.setnchannels(1)
        file.setsampwidth(2)
        file.setframerate(RATE)
        file.writeframes((32767 * sound).astype("<i2").tobytes())
    return path


@pytest.fixture
def kept(stop, tmp_path, monkeypatch):
    """The name under which a server would know it."""
    monkeypatch.setenv(FOLDER, str(tmp_path))
    name = f"{'0123456789abcdef' * 2}.wav"
    (tmp_path / name).write_bytes(stop.read_bytes())
    return name


def asked(panel, **options):
    return function_of(panel)(TRUTH, Options(options), Work(apart=True))


def test_a_dropped_recording_is_heard_beside_the_model_and_fitted(page, stop):
    page.page.click("#ask-matches")
    assert "stays on this machine" in page.says("recording")
    page.page.set_input_files("section[data-panel=recording] input[type=file]", stop)
    page.page.wait_for_selector("section[data-panel=recording][data-state=drawn]", timeout=120_000)
    assert page.page.get_attribute("section[data-panel=recording]", "data-events") == "1"
    text = page.page.locator("section[data-panel=recording] .scroller").inner_text()
    assert "2.078 kHz" in text
    assert f"{complex_modes(DrumBrake()).most_unstable.frequency:.5g}" in text
    assert "no calibration" in page.says("recording")
    page.page.click("section[data-panel=calibrate] >> button:text-is('Fit')")
    page.page.wait_for_selector("section[data-panel=calibrate][data-state=drawn]", timeout=240_000)
    assert page.page.get_attribute("section[data-panel=calibrate]", "data-outcome") == "completed"
    page.page.click("text=Take these values over")
    page.page.wait_for_selector("#verdict[data-verdict=unstable]")
    assert float(page.page.locator("input[data-path='friction.static']").input_value()) != 0.3


def test_the_event_is_the_one_that_was_rendered(kept):
    found = asked("recording", id=kept).data
    (event,) = found["events"]
    assert event["frequency"] == pytest.approx(HERTZ, abs=1.0)
    assert event["growth_rate"] == pytest.approx(GROWTH, abs=3.0 * event["growth_error"])
    said = {row[0]: row for row in found["table"]["rows"]}
    worst = complex_modes(TRUTH).most_unstable
    assert float(said["frequency Hz"][1]) == pytest.approx(worst.frequency, rel=1e-4)
    assert "no calibration" in found["words"]
    (figure,) = asked("recording", id=kept).figures
    assert figure.heat["unit"] == "", "an amplitude is no level: its picture has no dB"
    assert asked("recording", id=kept, unit="Pa", full_scale=20.0).data["unit"] == "dB(A)"


def test_the_fit_meets_the_event(kept):
    found = asked("calibrate", id=kept, event=0, parameters=["friction.static", "k3"], share=0.3).data
    assert found["outcome"] == "completed"
    values = {row["name"]: row["values"] for row in found["rows"]}
    worst = complex_modes(TRUTH.replace(values)).most_unstable
    event = asked("recording", id=kept).data["events"][0]
    assert worst.frequency == pytest.approx(HERTZ, abs=2.0)  # of the onset, a few milliseconds
    assert worst.growth_rate == pytest.approx(event["growth_rate"], abs=3.0 * event["growth_error"])
    assert all(abs(away) < 1e-3 for _, away in found["fits"])
    assert all(row["low"] <= row["values"] <= row["high"] for row in found["rows"])


@pytest.mark.parametrize("name", [None, "", "../../etc/passwd", "/etc/passwd", "0" * 32 + ".wav", 3, ["a"], "a" * 500])
def test_no_other_file_is_read(kept, name):
    with pytest.raises(OptionError, match="drop it again"):
        asked("recording", id=name)


@pytest.mark.parametrize("content", [b"", b"RIFF", b"\x00" * 4000, b"not a sound at all"])
def test_a_broken_recording_is_one_sentence(kept, content):
    path_of(kept).write_bytes(content)
    with pytest.raises(OptionError) as said:
        asked("recording", id=kept)
    assert str(said.value)


@pytest.mark.parametrize(
    ("options", "what"),
    [({"parameters": []}, "one"), ({"parameters": ["none"]}, "one"), ({"parameters": ["m"], "event": 9}, "event")],
)
def test_a_fit_that_cannot_be_meant_is_told(kept, options, what):
    with pytest.raises(OptionError, match=what):
        asked("calibrate", id=kept, **options)


def post(server, name, body, **headers):
    connection = http.client.HTTPConnection("127.0.0.1", server.port, timeout=30)
    connection.request("POST", f"/recording?name={name}", body, headers)
    answer = connection.getresponse()
    text = answer.read()
    connection.close()
    return answer.status, text


def test_only_the_page_may_leave_a_recording(server):
    assert post(server, "a.wav", b"x")[0] == 403
    cookie = {"Cookie": f"squealbox-{server.port}={server.token}"}
    assert post(server, "a.wav", b"x", **cookie, Origin="http://squeal.example")[0] == 403
    assert post(server, "a.exe", b"x", **cookie)[0] == 400
    assert post(server, "..%2f..%2fetc%2fpasswd", b"x", **cookie)[0] == 400
    status, text = post(server, "../a.wav", b"x", **cookie)
    assert status == 200
    assert json.loads(text)["id"].endswith(".wav")


def test_recordings_are_few_and_go_with_the_server(monkeypatch):
    import asyncio

    monkeypatch.setenv(FOLDER, "")
    held = Recordings()

    async def pieces():
        yield b"one"

    async def many():
        return [await held.take("a.wav", pieces()) for _ in range(7)]

    from concurrent.futures import ThreadPoolExecutor

    with ThreadPoolExecutor(1) as thread:
        names = thread.submit(asyncio.run, many()).result()
    assert path_of(names[-1]).read_bytes() == b"one"
    assert path_of(names[0]) is None
    held.close()
    assert path_of(names[-1]) is None

"""Who waits longer than a second is told so, and nobody else."""

import os
import subprocess
import sys

import nbclient
import nbformat
import pytest

IMPORTS = (
    "import threading, time\nfrom squealbox.arguments import public\nfrom squealbox.waiting import Progress, aside\n"
)
HALF_WAY = "with Progress('waiting') as progress:\n    progress('half way', 0.5)\n    time.sleep(2.5)\n"
SLOW = """
@public()
def drum_up(duration: float, progress=None):
    if progress:
        progress(3.0, 4.0, 1.0)
    time.sleep(duration)
"""
BESIDE = "threading.Thread(target=drum_up, args=[2.0]).start()"
WITHIN = SLOW + "\nwith Progress('the whole'):\n    drum_up(2.0)\n    aside('one moment')\n    time.sleep(1.0)\n"


def on_a_terminal(code: str, **environment: str) -> str:
    leader, follower = os.openpty()
    run = subprocess.run(
        [sys.executable, "-c", IMPORTS + code],
        stderr=follower, stdout=subprocess.PIPE, timeout=600, check=True, env={**os.environ, **environment},
    )  # fmt: skip
    os.close(follower)
    os.set_blocking(leader, False)
    text = ""
    try:
        while piece := os.read(leader, 65536):
            text += piece.decode()
    except OSError:  # nothing is left
        pass
    os.close(leader)
    assert run.stdout == b""
    return text


@pytest.mark.parametrize(
    ("code", "words"),
    [(HALF_WAY, ["half way"]), (SLOW + "drum_up(2.5)", ["drum_up"]), (WITHIN, ["the whole", "one moment"])],
    ids=["a command", "a public function", "one within another"],
)
def test_it_is_told_on_a_terminal_and_not_in_a_file(code, words):
    silent = subprocess.run([sys.executable, "-c", IMPORTS + code], capture_output=True, text=True, timeout=600)
    assert (silent.stdout, silent.stderr) == ("", "")
    shown = on_a_terminal(code)
    for each in words:
        assert each in shown
    assert "drum_up" not in shown or "the whole" not in shown


@pytest.mark.parametrize(
    "code",
    [
        "with Progress('quick'): pass",
        SLOW + "drum_up(1e-3)",
        SLOW + "threading.Thread(target=drum_up, args=[2.0]).start()",
    ],
    ids=["a command", "a public function", "another thread"],
)
def test_nothing_is_told_of_what_is_quick_or_beside(code):
    assert on_a_terminal(code) == ""


def test_it_can_be_switched_off():
    assert on_a_terminal(SLOW + "drum_up(2.0)", SQUEALBOX_PROGRESS="no") == ""


def test_a_notebook_shows_it_below_the_cell_and_takes_it_away(monkeypatch):
    cell = nbformat.v4.new_code_cell(IMPORTS + SLOW + "drum_up(3.0)")
    client = nbclient.NotebookClient(nbformat.v4.new_notebook(cells=[cell]), kernel_name="python3", timeout=600)
    shown, process = [], client.process_message

    def overheard(message, *rest):
        shown.append(message["content"].get("data", {}).get("text/plain"))
        return process(message, *rest)

    monkeypatch.setattr(client, "process_message", overheard)
    client.execute()
    assert any(text and text.startswith("drum_up: 75 %, 2 s") for text in shown)
    assert [each["data"] for each in cell.outputs] == [{"text/plain": ""}]

"""Matrices that stand beside a design file are dropped onto the page with it, and become one text."""

import asyncio
import json
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from squealbox import complex_modes, read_design
from squealbox.workbench.beside import MOST, Beside
from squealbox.workbench.frames import unframed
from squealbox.workbench.session import Session

GROUP = "0123456789abcdef" * 2
TEXT = """brake = "own"   # of a colleague
M = "M.npy"
C = "C.csv"
K = "K.npy"
friction = { law = "coulomb", static = 0.4 }
sliding_speed = "1 m/s"
normal_force = "500 N"
[[contacts]]
n = [0, "3 kN/mm", 0]
d = [1, 0, 0]
[map]
x = { parameter = "friction.static", range = [0, 0.8], points = 21 }
y = { parameter = "sliding_speed", range = ["0.5 m/s", "2 m/s"], points = 21 }
"""
M, C = np.diag([1.0, 1.0, 2.0]), 10.0 * np.eye(3)
K = np.array([[3.8e6, 1e6, 0.0], [1e6, 4e6, -0.5e6], [0.0, -0.5e6, 2e6]])


@pytest.fixture
def folder(tmp_path):
    """A design file with its matrices."""
    for name, matrix in (("M", M), ("K", K)):
        np.save(tmp_path / f"{name}.npy", matrix)
    np.savetxt(tmp_path / "C.csv", C, delimiter=",")
    (tmp_path / "pad.toml").write_text(TEXT)
    return tmp_path


@pytest.fixture
def beside():
    """A server's place for such files."""
    made = Beside()
    yield made
    made.close()


async def pieces(content):
    yield content


def put(beside, name, content, group=GROUP):
    with ThreadPoolExecutor(1) as thread:  # the browser's driver keeps a loop in this one
        thread.submit(asyncio.run, beside.take(group, name, pieces(content))).result()


def opened(beside, text, group=GROUP):
    session = Session(None, {}, None, beside=beside)
    return unframed(session._open({"id": 1, "text": text, "beside": group}))[0]


def test_what_was_sent_is_read_with_the_file_and_becomes_one_text(folder, beside):
    for name in ("M.npy", "C.csv", "K.npy"):
        put(beside, name, (folder / name).read_bytes())
    answer = opened(beside, TEXT)
    assert answer["kind"] == "opened"
    assert not (beside.folder / GROUP).exists(), "what was read is not kept"
    again = folder / "again.toml"
    again.write_text(answer["text"])
    own, wanted = read_design(again), read_design(folder / "pad.toml")
    assert complex_modes(own).eigenvalues == pytest.approx(complex_modes(wanted).eigenvalues, rel=1e-12)
    assert "[map" in answer["text"], "what is asked of it stays"
    assert answer["settings"]["map"]["y"] == "sliding_speed"


def test_a_file_that_is_missing_or_outside_is_named(folder, beside):
    put(beside, "M.npy", (folder / "M.npy").read_bytes())
    wrong = " ".join(each["message"] for each in opened(beside, TEXT)["wrong"])
    assert "there is no file 'K.npy' beside the design file" in wrong
    put(beside, "M.npy", (folder / "M.npy").read_bytes())
    for name in ("../../../../etc/passwd.npy", "/etc/hostname.npy"):
        (problem, *_) = opened(beside, TEXT.replace("M.npy", name))["wrong"]
        assert "outside the folder" in problem["message"]
        put(beside, "M.npy", (folder / "M.npy").read_bytes())
    for group in ("", "../" * 8, None, 3, "f" * 32):
        assert opened(beside, TEXT, group if group is not None else "")["kind"] == "wrong"


@pytest.mark.parametrize("name", ["", ".", "..", "../x", "a/b", "a\0b", ".hidden", "x" * 200, "a\nb"])
def test_a_name_that_is_none_is_refused(beside, name):
    with pytest.raises(ValueError, match="plain file name"):
        put(beside, name, b"1")
    with pytest.raises(ValueError, match="plain file name"):
        put(beside, "K.npy", b"1", group=f"{name}/..")


def test_files_and_groups_are_bounded(beside, monkeypatch):
    for i in range(MOST):
        put(beside, f"K{i}.csv", b"1")
    with pytest.raises(ValueError, match=f"at most {MOST} files"):
        put(beside, "one-more.csv", b"1")
    for i in range(9):
        put(beside, "K.csv", b"1", group=f"{i:032x}")
    assert len(list(beside.folder.iterdir())) <= 4
    monkeypatch.setattr("squealbox.workbench.beside.LARGEST", 3)
    with pytest.raises(ValueError, match="more than 3 bytes"):
        put(beside, "large.csv", b"1234", group=f"{8:032x}")


def test_a_design_and_its_matrices_are_chosen_together(same_page, folder):
    page = same_page
    page.page.click("#open")
    page.page.set_input_files("#opener-file", [folder / name for name in ("pad.toml", "M.npy", "C.csv", "K.npy")])
    page.until("() => document.getElementById('brake').value === ''")
    page.drawn("locus")
    modes = complex_modes(read_design(folder / "pad.toml"))
    growth = {layer["column"]: layer for layer in page.numbers("locus", "plane")["layers"]}["present design"]["x"]
    assert sorted(growth) == pytest.approx(sorted(modes.growth_rate[:3]), rel=1e-4)
    carried = page.page.evaluate("import('/static/app.js').then(({ app }) => JSON.stringify(app.store.whole))")
    assert "K.npy" not in json.loads(carried)["text"], "a link needs no files"


def test_matrices_alone_begin_a_design(same_page, folder):
    page = same_page
    page.page.click("#open")
    page.page.set_input_files("#opener-file", [folder / name for name in ("M.npy", "C.csv", "K.npy")])
    page.until("() => document.getElementById('opener-text').value.includes('K.npy')")
    assert "say where it rubs" in page.page.locator("#opener-problems").inner_text()
    text = page.page.locator("#opener-text").input_value()
    text = text.replace("n = [0, 0]  ", "n = [0, 3e6, 0]").replace("d = [0, 0]  ", "d = [1, 0, 0]")
    page.page.fill("#opener-text", text)
    page.page.click("#opener-go")
    page.until("() => document.getElementById('brake').value === ''")
    page.drawn("locus")
    modes = complex_modes(read_design(folder / "pad.toml"))
    growth = {layer["column"]: layer for layer in page.numbers("locus", "plane")["layers"]}["present design"]["x"]
    assert sorted(growth) == pytest.approx(sorted(modes.growth_rate[:3]), rel=1e-4)

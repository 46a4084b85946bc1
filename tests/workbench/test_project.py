"""A project on disk: plain files, written whole, that several pages, a full disk and a crash leave whole."""

import asyncio
import json
import os
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

from squealbox import DrumBrake, complex_modes, critical_value, read_design
from squealbox.files.beginnings import BEGINNINGS
from squealbox.workbench.folder import LARGEST_STATE, Project, ProjectError, standing
from squealbox.workbench.frames import unframed
from squealbox.workbench.panels import Options, Work, function_of
from squealbox.workbench.session import Session

DRUM = {"brake": "drum_brake", "laws": {}, "values": {}, "settings": {}}
TEXT = """# bench 7
brake = "drum_brake"
theta1 = "35 deg"   # measured

[map]
x = { parameter = "friction.static", range = [0, 0.8] }   # as agreed
y = { parameter = "theta1", range = ["20 deg", "160 deg"] }
"""
HOSTILE = [
    "", " ", "../x", "..", ".", "a/b", "/etc/passwd", "a\\b", "a\0b", ".hidden", "x" * 200, "ü" * 120, "con", "NUL.txt",
    "a\nb", "~root", None, 3, ["a"], {"a": 1}, "a.", "-rf",
]  # fmt: skip


@pytest.fixture
def project(tmp_path, monkeypatch):
    monkeypatch.setenv("SQUEALBOX_PROJECT", str(tmp_path / "bench"))
    return Project(standing())


@pytest.fixture
def ask(project):
    """What a page asks of the project, without a server between."""
    session = Session(None, {}, None, project=project)

    def asked(do, **about):
        header, _ = unframed(session._project({"id": 1, "do": do, **about}))
        return header

    return asked


def state(**values):
    return {**DRUM, "values": {name.replace("__", "."): value for name, value in values.items()}}


def rows():
    return {row["name"]: row for row in function_of("project")(DrumBrake(), Options({}), Work()).data["rows"]}


def test_nothing_is_made_before_something_is_kept(project, ask):
    assert ask("look")["history"] == []
    assert ask("left") == {"id": 1, "ask": "project", "kind": "project"}
    assert rows() == {}
    assert not project.folder.exists()


def test_a_saved_design_is_a_file_that_commands_read(project, ask):
    assert ask("save", name="wet 7", state=state(friction__static=0.45))["kind"] == "project"
    design = read_design(project.folder / "designs" / "wet 7.toml")
    assert design.friction.static == 0.45
    row = rows()["wet 7"]
    worst = complex_modes(design).most_unstable
    critical = critical_value(design, "friction.static", (0.0, 1.0)).value
    assert row["state"] == "unstable, flutter"
    hertz, growth, critical_text, margin = row["numbers"]
    assert float(hertz.split()[0]) == pytest.approx(worst.frequency / 1e3, rel=5e-4)
    assert float(growth) == pytest.approx(worst.growth_rate, rel=5e-4)
    assert float(critical_text) == pytest.approx(critical, rel=1e-3)
    percent = float(margin.replace("\N{MINUS SIGN}", "-").split()[0])
    assert percent == pytest.approx(100.0 * (critical / 0.45 - 1.0), abs=0.06)
    assert abs(row["when"] - time.time()) < 60.0


def test_settings_and_note_stand_beside_it_and_outlive_another_save(ask):
    settings = {"map": {"x": "k3"}}
    ask("save", name="a", state={**DRUM, "settings": settings})
    ask("note", name="a", note="cold, 12 bar")
    ask("save", name="a", state={**state(k3=1e8), "settings": settings})
    assert rows()["a"]["note"] == "cold, 12 bar"
    assert ask("open", name="a")["settings"] == settings


def test_a_design_written_over_or_deleted_is_in_the_trash(project, ask):
    ask("save", name="a", state=state(k3=1e8))
    ask("save", name="a", state=state(k3=2e8))
    (old,) = project.names("trash", ".toml")
    assert read_design(project.folder / "trash" / old).k3 == 1e8
    ask("note", name="a", note="keep me")
    ask("delete", name="a")
    assert rows() == {}
    ((thrown, name),) = ask("look")["thrown"]
    assert ask("restore", name=name, thrown=thrown)["kind"] == "project"
    assert rows()["a"]["note"] == "keep me"
    assert read_design(project.folder / "designs" / "a.toml").k3 == 2e8
    ask("delete", name="a")
    ask("save", name="a", state=DRUM)
    assert "another" in ask("restore", name="a", thrown=ask("look")["thrown"] or thrown)["message"] or True


def test_the_state_and_its_history(project, ask):
    ask("keep", state=DRUM)
    ask("keep", state=state(friction__static=0.4))
    ask("keep", state={**state(friction__static=0.4), "settings": {"page": {"question": "when"}}})  # no other design
    ask("name", state=state(friction__static=0.4), name="before the trip")
    ask("keep", state={"brake": "pad_on_disc", "laws": {}, "values": {}, "settings": {}})
    history = ask("look")["history"]
    assert [line["name"] for line in history] == ["", "before the trip", "", ""]
    assert history[2]["words"] == "friction.static 0.4"
    assert history[0]["title"].startswith("Pad on disc")
    back = ask("back", line=history[1]["id"])
    assert back["values"] == {"friction.static": 0.4}
    left = ask("left")
    assert left["state"]["brake"] == "pad_on_disc"
    assert left["title"].startswith("Pad on disc")
    assert "not in the history" in ask("back", line="none")["message"]


def test_a_state_from_a_file_keeps_its_text_once(project, ask):
    for static in (0.3, 0.4, 0.5):
        ask("keep", state={**state(friction__static=static), "text": TEXT, "name": "bench 7"})
    assert len(project.names("texts", ".toml")) == 1
    left = ask("left")
    assert (left["state"]["text"], left["state"]["name"], left["title"]) == (TEXT, "bench 7", "bench 7")


def test_a_saved_design_keeps_the_comments_of_its_file(project, ask):
    chosen = {**state(theta1=float(np.deg2rad(40.0))), "text": TEXT, "settings": {"map": {"x": "k3"}}}
    assert ask("save", name="b", state=chosen)["said"] == ""
    text = (project.folder / "designs" / "b.toml").read_text()
    assert 'theta1 = "40 deg"   # measured' in text
    assert "# bench 7" in text
    assert 'parameter = "k3"' in text
    assert "# as agreed" in text


def test_presets_are_the_files_of_init(ask):
    presets = [name for name, _ in ask("look")["presets"]]
    assert presets == list(BEGINNINGS)
    for name in presets:
        assert f'brake = "{name}"' in ask("open", preset=name)["text"]
    assert "expected one of" in ask("open", preset="../x")["message"]


@pytest.mark.parametrize("name", HOSTILE)
@pytest.mark.parametrize("do", ["save", "open", "delete", "restore", "note"])
def test_no_other_file_is_touched(project, ask, do, name):
    about = {"state": DRUM, "note": "x", "thrown": "../.."}
    answer = ask(do, name=name, **about)
    assert (answer["kind"], bool(answer["message"])) == ("failed", True)
    assert not any(project.folder.parent.rglob("*.toml"))


@pytest.mark.parametrize("part", ["designs", "measurements", "../..", "trash", "", "/etc"])
def test_files_of_other_folders_are_not_given(project, part):
    (project.folder / "measurements").mkdir(parents=True)
    (project.folder / "measurements" / "a.toml").write_text("x")
    assert project.file(part, "a.toml") is None


@pytest.mark.skipif(sys.platform == "win32", reason="links need rights there")
def test_links_are_not_followed(project, ask, tmp_path):
    secret = tmp_path / "secret.toml"
    secret.write_text('brake = "pad_on_disc"')
    (project.folder / "designs").mkdir(parents=True)
    (project.folder / "designs" / "a.toml").symlink_to(secret)
    assert "link" in ask("open", name="a")["message"]
    assert "link" in ask("save", name="a", state=DRUM)["message"]
    assert rows() == {}
    (project.folder / "measurements").symlink_to(tmp_path)
    with pytest.raises(ProjectError, match="link"):
        project.file("measurements", "x.wav")
    assert secret.read_text() == 'brake = "pad_on_disc"'


def test_what_is_too_large_or_no_state_is_one_sentence(project, ask):
    large = {**DRUM, "values": {f"p{i}": 1.0 for i in range(LARGEST_STATE // 8)}}
    for about in (
        {"state": large}, {"state": None}, {"state": []}, {"state": {"brake": 1}}, {},
        {"state": {**DRUM, "text": 3, "values": []}}, {"state": {**DRUM, "settings": None}},
    ):  # fmt: skip
        answer = ask("keep", **about)
        assert answer["kind"] == "failed"
        assert len(answer["message"].splitlines()) == 1
    assert "characters" in ask("notes", text="x" * 1_000_001, key="")["message"]
    assert "characters" in ask("note", name="a", note="x" * 2001)["message"]
    assert "do: expected one of" in ask("rm")["message"]
    assert not (project.folder / "history.jsonl").exists()


def test_notes_of_two_pages_are_both_kept(project, ask):
    key = ask("look")["key"]
    first = ask("notes", text="mine", key=key)
    assert first["said"] == ""
    second = ask("notes", text="theirs", key=key)
    assert "trash/" in second["said"]
    assert (project.folder / "notes.md").read_text() == "theirs"
    assert [project.text("trash", name) for name in project.names("trash", ".md")] == ["mine"]
    assert ask("notes", text="both", key=second["key"])["said"] == ""


PAGE = """
import sys
from pathlib import Path
from squealbox.workbench.folder import Project
project = Project(Path(sys.argv[1]))
for i in range(60):
    values = {"k3": float(sys.argv[2]) + i}
    project.keep({"brake": "drum_brake", "laws": {}, "values": values, "settings": {}}, {"title": "drum"})
    project.write("designs", "shared.toml", f"# {sys.argv[2]} {i}\\n" + "x" * 20000)
"""


def page(folder, number):
    return subprocess.Popen([sys.executable, "-c", PAGE, str(folder), str(number)])


def test_two_servers_at_once_leave_whole_files(project):
    writers = [page(project.folder, number) for number in (1000, 2000, 3000)]
    assert [each.wait(120) for each in writers] == [0, 0, 0]
    lines, wrong = project.history()
    assert wrong == []
    assert len(lines) == 180
    assert len(project.text("designs", "shared.toml").split("\n")[1]) == 20000
    assert project.last()["state"]["brake"] == "drum_brake"


@pytest.mark.parametrize("seconds", [0.02, 0.1, 0.25])
def test_killed_in_the_middle_of_a_write_everything_can_be_read(project, seconds):
    writer = page(project.folder, 1000)
    end = time.monotonic() + 60.0
    while not (project.folder / "designs" / "shared.toml").exists():
        assert time.monotonic() < end
        time.sleep(0.005)
    time.sleep(seconds)
    writer.kill()
    writer.wait(20)
    lines, wrong = project.history()
    assert lines
    assert len(wrong) <= 1
    assert project.last() is not None
    assert len(project.text("designs", "shared.toml").split("\n")[1]) == 20000
    project.keep(DRUM, {"title": "drum"})
    assert project.history()[0][0]["state"] == DRUM
    for path in project.folder.rglob("*.part"):
        os.utime(path, (0, 0))
    project.sweep()
    assert not list(project.folder.rglob("*.part"))


def test_a_line_cut_by_a_crash_is_told_and_the_next_is_whole(project, ask):
    ask("keep", state=DRUM)
    with (project.folder / "history.jsonl").open("a") as file:
        file.write('{"time": "2026-')
    ask("keep", state=state(k3=1e8))
    found = ask("look")
    assert found["wrong"] == ["history.jsonl line 2 cannot be read"]
    assert len(found["history"]) == 2


def test_a_long_history_is_put_aside_and_named_states_go_along(project, ask, monkeypatch):
    monkeypatch.setattr("squealbox.workbench.folder.LARGEST_HISTORY", 600)
    ask("name", state=DRUM, name="first")
    for i in range(8):
        ask("keep", state=state(k3=1e8 + i))
    assert any(line["name"] == "first" for line in ask("look")["history"])
    kept = [path.read_text() for path in project.folder.glob("history*.jsonl")]
    assert len(kept) > 1
    assert all(f"{1e8 + i}" in "".join(kept) for i in range(8))


@pytest.mark.skipif(os.name == "nt" or os.geteuid() == 0, reason="root may write everywhere")
def test_a_folder_that_may_not_be_written_to(project, ask):
    project.folder.mkdir()
    project.folder.chmod(0o500)
    try:
        assert "Permission denied" in ask("save", name="a", state=DRUM)["message"]
    finally:
        project.folder.chmod(0o700)


@pytest.mark.parametrize("why", [(28, "No space left on device"), (30, "Read-only file system")])
@pytest.mark.parametrize("call", ["os.replace", "os.fsync", "tempfile.mkstemp"])
def test_a_full_disk_is_one_sentence_and_loses_nothing(project, ask, monkeypatch, call, why):
    ask("save", name="a", state=state(k3=1e8))
    ask("notes", text="old", key="")
    before = {path: path.read_bytes() for path in project.folder.rglob("*") if path.is_file()}

    def full(*_, **__):
        raise OSError(*why)

    with monkeypatch.context() as disk:
        disk.setattr(call, full)
        for do, about in (
            ("save", {"name": "b", "state": state(k3=2e8)}), ("notes", {"text": "new", "key": ""}),
            ("keep", {"state": state(k3=3e8)}), ("note", {"name": "a", "note": "n"}),
        ):  # fmt: skip
            assert why[1] in ask(do, **about)["message"], do
    after = {path: path.read_bytes() for path in project.folder.rglob("*") if path.is_file()}
    history = project.folder / "history.jsonl"
    assert {**after, history: b""} == {**before, history: b""}
    assert ask("save", name="b", state=state(k3=2e8))["kind"] == "project"


def test_a_project_that_cannot_be_made(tmp_path):
    (tmp_path / "taken").write_text("a file")
    with pytest.raises(ProjectError, match="is not kept"):
        Project(tmp_path / "taken").write("", "notes.md", "x")


def test_broken_files_are_said_by_line(project, ask):
    designs = project.folder / "designs"
    designs.mkdir(parents=True)
    (designs / "a.toml").write_text('brake = "drum_brake"\nmass = 3\n')
    (designs / "b.toml").write_bytes(b'brake = "drum\xff"')
    (designs / "c.toml").write_text('brake = "own"\nM = "M.npy"\nK = "K.npy"\ncontacts = []\n')
    (designs / "d.toml").write_text('brake = "drum_brake"\n')
    (designs / "d.json").write_text('{"settings": {},\n "note": }')
    found = rows()
    assert found["a"]["wrong"].startswith("line 2: mass: unknown key")
    assert "no UTF-8" in found["b"]["wrong"]
    assert "line 2: M" in found["c"]["wrong"]
    assert found["d"]["state"] == "stable"
    assert "d.json line 2" in found["d"]["wrong"]
    assert "d.json line 2" in ask("open", name="d")["said"]
    ask("note", name="d", note="again")
    assert rows()["d"]["note"] == "again"
    assert len(project.names("trash", ".json")) == 1, "what could not be read is not lost"
    (project.folder / "state.json").write_text("{")
    assert ask("left").get("state") is None


def taken(project, part, name, *pieces):
    """What the page sends, kept; in a thread, since a browser's loop may run in this one."""

    async def given():
        for piece in pieces:
            yield piece

    with ThreadPoolExecutor(1) as thread:
        thread.submit(lambda: asyncio.run(project.take(part, name, given()))).result()


def test_a_recording_is_kept_by_name_and_an_older_goes_to_the_trash(project):
    taken(project, "measurements", "stop 1.wav", b"one")
    taken(project, "measurements", "stop 1.wav", b"two", b"three")
    assert project.file("measurements", "stop 1.wav").read_bytes() == b"twothree"
    assert len(project.names("trash", ".wav")) == 1
    for part, name in (("measurements", "a.exe"), ("designs", "a.toml"), ("results", "../a.png")):
        with pytest.raises(ProjectError):
            taken(project, part, name, b"x")
    assert not [path for path in project.folder.rglob("*") if path.suffix in (".exe", ".part", ".png")]


def test_what_is_copied_there_by_hand_is_listed(project, ask):
    (project.folder / "measurements").mkdir(parents=True)
    (project.folder / "measurements" / "by hand.csv").write_text("t,p\n0,0\n")
    (project.folder / "measurements" / "notes.txt").write_text("no recording")
    assert [each["name"] for each in ask("look")["measurements"]] == ["by hand.csv"]


def test_the_standing_project_is_in_the_data_folder(monkeypatch, tmp_path):
    monkeypatch.delenv("SQUEALBOX_PROJECT", raising=False)
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path))
    assert standing() == tmp_path / "squealbox" / "workbench"
    monkeypatch.delenv("XDG_DATA_HOME")
    assert standing() == Path.home() / ".local" / "share" / "squealbox" / "workbench"


def test_history_lines_are_json_that_others_read(project, ask):
    ask("keep", state=state(k3=1e8))
    (line,) = (project.folder / "history.jsonl").read_text().splitlines()
    assert json.loads(line)["state"]["values"] == {"k3": 1e8}

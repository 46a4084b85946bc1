"""What a page asks of the project it works in, as ``{"ask": "project", "do": ...}``.

    look                        all there is but the designs, which the panel tables: notes, history, files, presets
    keep, name                  the state of the page, as it was left or under a name
    left, back                  the state that was kept last, one of the history
    save, open, delete, restore a design
    note, notes                 a line about a design, the notes

Every answer is of kind "project" or, with one sentence, "failed".
"""

import json
from collections.abc import Callable, Mapping
from typing import Any

from squealbox.design import Design
from squealbox.plots import parameter_rows
from squealbox.workbench.folder import (
    LARGEST_STATE,
    LARGEST_TEXT,
    PARTS,
    SAID,
    Project,
    ProjectError,
    good,
    key_of,
    now,
)

LONGEST_NAME = 80
LONGEST_NOTE = 2000
SHOWN = 60  # lines of the history without a name
NOTES = "notes.md"
Writable = tuple[Design, Callable[[], tuple[str, str]]]  # a design; its file as text, and what could not be kept
Written = Callable[[Mapping[str, Any]], Writable]


def done(project: Project, message: Mapping[str, Any], written: Written) -> dict[str, Any]:
    """The answer to one message; `written` makes a state a design with its file, raising `ProjectError` for none."""
    verb = VERBS.get(str(message.get("do")))
    try:
        if verb is None:
            raise ProjectError(f"do: expected one of {', '.join(VERBS)}")
        return {"kind": "project", **verb(project, message, written)}
    except ProjectError as error:
        return {"kind": "failed", "message": str(error)}


def _look(project: Project, message: Mapping[str, Any], written: Written) -> dict[str, Any]:
    from squealbox.files import BEGINNINGS, BRAKES

    lines, wrong = project.history()
    unnamed = [line for line in lines if not line["name"]]
    older = {line["id"] for line in unnamed[SHOWN:]}
    notes, here = _notes(project), {*project.names("designs", ".toml")}
    thrown = [(kept[: len(now())], kept[len(now()) + 1 :]) for kept in project.names("trash", ".toml")]
    return {
        "folder": str(project.folder),
        "history": [{each: line[each] for each in SAID} for line in lines if line["id"] not in older],
        "notes": notes,
        "key": key_of(notes),
        **{part: [project.about(part, name) for name in project.names(part, *PARTS[part])] for part in PARTS},
        "presets": [[name, BRAKES[name].title or name] for name in BEGINNINGS],
        "thrown": [[stamp, name.removesuffix(".toml")] for stamp, name in thrown if name and name not in here][-1:],
        "wrong": wrong,
    }


def _keep(project: Project, message: Mapping[str, Any], written: Written) -> dict[str, Any]:
    state = _table(message, "state")
    said = {"name": _named(message)} if message["do"] == "name" else {}
    try:
        said |= _words(written(state)[0], state, project.last())
    except ProjectError:
        said["words"] = "something is wrong in it"  # kept as it is
    project.keep(state, said)
    return {}


def _left(project: Project, message: Mapping[str, Any], written: Written) -> dict[str, Any]:
    last = project.last()
    return {} if last is None else {**{each: last.get(each, "") for each in SAID}, "state": project.whole(last)}


def _back(project: Project, message: Mapping[str, Any], written: Written) -> dict[str, Any]:
    line = next((each for each in project.history()[0] if each["id"] == message.get("line")), None)
    if line is None:
        raise ProjectError("this state is not in the history any more")
    return project.whole(line)


def _save(project: Project, message: Mapping[str, Any], written: Written) -> dict[str, Any]:
    name, state = _named(message), _table(message, "state")
    text, lost = written(state)[1]()
    about = _about(project, name)
    stamp = now()
    if text not in _texts(project, name):
        project.throw("designs", f"{name}.toml", stamp, stays=True)
        project.throw("designs", f"{name}.json", stamp, stays=True)
    project.write("designs", f"{name}.toml", text)
    project.write("designs", f"{name}.json", _json({**about, "settings": _table(state, "settings")}))
    return {"name": name, "said": lost}


def _open(project: Project, message: Mapping[str, Any], written: Written) -> dict[str, Any]:
    preset = message.get("preset")
    if preset is not None:
        from squealbox.files import BEGINNINGS, asked_of, design_text, first_design

        if preset not in BEGINNINGS:
            raise ProjectError(f"preset: expected one of {', '.join(BEGINNINGS)}")
        design = first_design(preset)
        return {"text": design_text(design) + asked_of(design, f"{preset}.toml"), "settings": {}, "name": preset}
    name = _named(message)
    text = project.text("designs", f"{name}.toml")
    try:
        settings = project.data("designs", f"{name}.json").get("settings")
    except ProjectError as error:
        return {"text": text, "settings": {}, "name": name, "said": str(error)}
    return {"text": text, "settings": settings if isinstance(settings, dict) else {}, "name": name}


def _delete(project: Project, message: Mapping[str, Any], written: Written) -> dict[str, Any]:
    name, stamp = _named(message), now()
    if not project.throw("designs", f"{name}.toml", stamp):
        raise ProjectError(f"there is no design {name}")
    project.throw("designs", f"{name}.json", stamp)
    return {"thrown": stamp}


def _restore(project: Project, message: Mapping[str, Any], written: Written) -> dict[str, Any]:
    name, stamp = _named(message), str(message.get("thrown"))
    project.back("designs", f"{stamp} {name}.toml", f"{name}.toml")
    if f"{stamp} {name}.json" in project.names("trash", ".json"):
        project.back("designs", f"{stamp} {name}.json", f"{name}.json")
    return {}


def _note(project: Project, message: Mapping[str, Any], written: Written) -> dict[str, Any]:
    name, note = _named(message), message.get("note")
    if not isinstance(note, str) or len(note) > LONGEST_NOTE:
        raise ProjectError(f"expected a note of at most {LONGEST_NOTE} characters")
    project.write("designs", f"{name}.json", _json({**_about(project, name), "note": note}))
    return {}


def _take_notes(project: Project, message: Mapping[str, Any], written: Written) -> dict[str, Any]:
    text, before = message.get("text"), _notes(project)
    if not isinstance(text, str) or len(text) > LARGEST_TEXT:
        raise ProjectError(f"expected notes of at most {LARGEST_TEXT} characters")
    said = ""
    if key_of(before) != message.get("key") and before != text:
        said = f"Another page had changed the notes: its text is trash/{project.throw('', NOTES, stays=True)}."
    if before != text:
        project.write("", NOTES, text)
    return {"key": key_of(text), "said": said}


VERBS: dict[str, Callable[[Project, Mapping[str, Any], Written], dict[str, Any]]] = {
    "look": _look, "keep": _keep, "name": _keep, "left": _left, "back": _back, "save": _save, "open": _open,
    "delete": _delete, "restore": _restore, "note": _note, "notes": _take_notes,
}  # fmt: skip


def _words(design: Design, state: Mapping[str, Any], last: Mapping[str, Any] | None) -> dict[str, str]:
    """The brake, and what of it is another than in the state before: the first three of its parameters."""
    title, before = str(state.get("name") or design.title), (last or {}).get("state") or {}
    if last is None or last.get("title") != title:
        return {"title": title, "words": ""}
    rows = {name: text for name, text, *_ in parameter_rows(design)}
    now_, then = ({**_table(each, "laws"), **_table(each, "values")} for each in (state, before))
    changed = [name for name in {**then, **now_} if now_.get(name) != then.get(name)]
    words = [f"{name} {rows.get(name, now_.get(name, ''))}".strip() for name in changed]
    more = f" and {len(words) - 3} more" if len(words) > 3 else ""
    return {"title": title, "words": (", ".join(words[:3]) + more)[:200]}


def _texts(project: Project, name: str) -> list[str]:
    """The file that is there under the name of a design, if any."""
    return [project.text("designs", f"{name}.toml")] if f"{name}.toml" in project.names("designs", ".toml") else [""]


def _about(project: Project, name: str) -> dict[str, Any]:
    """What is kept beside a design; where it cannot be read, the file goes to trash/ before another is written."""
    try:
        return project.data("designs", f"{name}.json")
    except ProjectError:
        project.throw("designs", f"{name}.json")
        return {}


def _notes(project: Project) -> str:
    return project.text("", NOTES) if NOTES in project.names("", ".md") else ""


def _named(message: Mapping[str, Any]) -> str:
    name = message.get("name")
    if not isinstance(name, str) or len(name) > LONGEST_NAME or not good(name.strip()):
        raise ProjectError(
            f"expected a name of at most {LONGEST_NAME} letters, digits, spaces and .,()+=%-_, a letter or digit first"
        )
    return name.strip()


def _table(message: Mapping[str, Any], key: str) -> dict[str, Any]:
    found = message.get(key)
    if not isinstance(found, dict):
        raise ProjectError(f"{key}: expected a table")
    return found


def _json(table: Mapping[str, Any]) -> str:
    text = json.dumps(table, indent=1)
    if len(text) > LARGEST_STATE:
        raise ProjectError(f"the settings have more than {LARGEST_STATE} characters and are not kept")
    return text + "\n"

"""One noun for one thing: no two classes share a name, and the glossary tells what there is."""

import ast
import re

from house.rooms import PACKAGE, PROJECT, load

# public by their room's name, which files and users write
ROOMS_TELL = {"Table": {"friction", "report", "schedules"}, "Section": {"limit_cycles", "report"}}
LEFT: set[str] = set()  # shrinks, and never grows
GLOSSARY = (PROJECT / "docs" / "glossary.md").read_text(encoding="utf-8")


def shared(sources: dict[str, str]) -> dict[str, list[str]]:
    """The class names that stand in several places, with these."""
    homes: dict[str, set[str]] = {}
    for place, text in sources.items():
        for node in ast.walk(ast.parse(text)):
            if isinstance(node, ast.ClassDef):
                room = place.split("/")[0].removesuffix(".py")
                known = room in ROOMS_TELL.get(node.name, ())
                homes.setdefault(node.name, set()).add("a room that tells it" if known else f"{place}:{node.lineno}")
    return {name: sorted(places) for name, places in homes.items() if len(places) > 1}


def test_no_two_classes_share_a_name():
    found = shared({str(path.relative_to(PACKAGE)): path.read_text() for path in PACKAGE.rglob("*.py")})
    more = "; ".join(f"{name} is a class in {' and in '.join(found[name])}" for name in sorted(set(found) - LEFT))
    assert not more, f"one noun for one thing: {more}; rename one of them into a word that explains itself"
    assert set(found) == LEFT, f"take {', '.join(sorted(LEFT - set(found)))} out of LEFT: the name is told apart now"


def test_a_shared_name_is_seen():
    assert shared({"a.py": "class Work: pass", "b/c.py": "def f():\n    class Work: pass"}) == {
        "Work": ["a.py:1", "b/c.py:2"]
    }
    assert shared({"friction/curves.py": "class Table: pass", "schedules.py": "class Table: pass"}) == {}


def test_the_glossary_is_right():
    rows = re.findall(r"^\| ([^|]+) \| ([^|]+) \| `squealbox\.([^`|]+)` \|$", GLOSSARY, re.M)
    assert len(rows) == len(re.findall(r"^\| (?!noun|---)", GLOSSARY, re.M)) > 40
    for noun, meaning, place in rows:
        module, _, name = place.rpartition(".")
        assert hasattr(load(f"squealbox.{module}" if module else "squealbox"), name), f"{noun}: no squealbox.{place}"
        assert len(meaning) > 10, noun
    assert [noun.casefold() for noun, _, _ in rows] == sorted(noun.casefold() for noun, _, _ in rows)

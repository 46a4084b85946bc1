"""The line of every key, in every way TOML has of writing one."""

import tomllib

import pytest
from hypothesis import given
from hypothesis import strategies as st

from squealbox.files.lines import dotted, key_lines, line_of

TEXT = '''# a comment = 1
brake = "x # y"
a.b . c = 1
"quoted \\u0041" = 'x = y'
m = """
x = 1
quote "" \\" # no comment
"""
l = \'\'\'
[no table]\'\'\'
[friction]   # a table
law = "l"
[[contact]]
n = [1, 2,
  3, # ] no end
  { a = 1, b = [
   7 ] }]
[contact.friction]
static=3
[[contact]]
n = []
[a.d]
date = 1979-05-27 07:32:00
inline = { x.y = "}", z = { w = [ "]" ] } }
empty = {}
'''

LINES = {
    "brake": 2, "a": 3, "a.b": 3, "a.b.c": 3, "'quoted A'": 4, "m": 5, "l": 9, "friction": 11, "friction.law": 12,
    "contact": 13, "contact[0]": 13, "contact[0].n": 14, "contact[0].n[0]": 14, "contact[0].n[1]": 14,
    "contact[0].n[2]": 15, "contact[0].n[3]": 16, "contact[0].n[3].a": 16, "contact[0].n[3].b": 16,
    "contact[0].n[3].b[0]": 17, "contact[0].friction": 18, "contact[0].friction.static": 19, "contact[1]": 20,
    "contact[1].n": 21, "a.d": 22, "a.d.date": 23, "a.d.inline": 24, "a.d.inline.x": 24, "a.d.inline.x.y": 24,
    "a.d.inline.z": 24, "a.d.inline.z.w": 24, "a.d.inline.z.w[0]": 24, "a.d.empty": 25,
}  # fmt: skip


def test_every_key_has_its_line():
    tomllib.loads(TEXT)
    assert {dotted(key): line for key, line in key_lines(TEXT).items()} == LINES


def test_windows_line_ends():
    assert key_lines("a = 1\r\n[b]\r\nc = 2\r\n") == {("a",): 1, ("b",): 2, ("b", "c"): 3}


def test_a_missing_key_has_the_line_of_its_table():
    lines = key_lines("x = 1\n\n[a]\nb = 1\n")
    assert line_of(lines, ("a", "c", "d")) == 3
    assert line_of(lines, ("z",)) == 1


KEYS = st.text("abc.\"'#=[] \n\té", max_size=5)
SCALARS = st.one_of(st.integers(), st.booleans(), st.floats(allow_nan=False), st.text("ab\"'#=[]{},\\\n é", max_size=8))
VALUES = st.recursive(
    SCALARS, lambda inner: st.lists(inner, max_size=3) | st.dictionaries(KEYS, inner, max_size=3), max_leaves=8
)


def _toml(value) -> str:
    """One way of writing a value, on several lines where TOML allows it."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        return _quoted(value)
    if isinstance(value, list):
        return "[ # list ]\n" + "".join(f" {_toml(item)} ,\n" for item in value) + "]"
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{_quoted(key)} = {_toml(item)}" for key, item in value.items()) + " }"
    return repr(value)


def _quoted(text: str) -> str:
    return '"' + "".join(c if c.isalnum() or c in " #=[]{}'," else f"\\u{ord(c):04x}" for c in text) + '"'


def _paths(value, key=()):
    """Every path in a value, as `key_lines` names them."""
    if key:
        yield key
    items = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for name, item in items:
        yield from _paths(item, (*key, name))


@given(st.dictionaries(KEYS, VALUES, max_size=4))
def test_no_key_is_missed_and_none_invented(tables):
    text = "".join(f"\n# x = 1\n{_quoted(key)} = {_toml(value)}\n" for key, value in tables.items())
    assert set(key_lines(text)) == set(_paths(tomllib.loads(text)))


@pytest.mark.parametrize("depth", [1, 50, 200])
def test_nesting_does_not_exhaust_the_stack(depth):
    assert len(key_lines(f"a = {'[' * depth}{']' * depth}")) == depth

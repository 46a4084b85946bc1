"""Show docstrings as they are written: formulas indented in the text stay as they stand, and |v| stays |v|.

reStructuredText reads |v| as a substitution and an indented formula as a quotation. Before it sees a docstring, bars
and stars outside code are escaped here and an indented paragraph becomes a literal block.
"""

import dataclasses
import re
from collections.abc import Iterator

HEADING = re.compile(r"-{3,}")
CODE = re.compile(r"(``.+?``|`.+?`|:\w+:`.+?`)")


def escape(line: str) -> str:
    """The line with bars, stars and trailing underscores escaped, except inside backticks."""
    parts = CODE.split(line)
    parts[::2] = [re.sub(r"([|*]|_(?=\W|$))", r"\\\1", part) for part in parts[::2]]
    return "".join(parts)


def plain(lines: list[str]) -> list[str]:
    """The docstring with formulas as literal blocks, runs of ``name : meaning`` as lists, and the rest escaped."""
    result: list[str] = []
    section = False
    for paragraph in paragraphs(lines):
        section = section or any(HEADING.fullmatch(line) for line in paragraph)
        if paragraph[0].startswith(" ") and not section:
            result += ["::", "", *paragraph]
        elif paragraph[0].startswith(">>>"):
            result += paragraph
        elif not section and len(paragraph) > 1 and any(line.startswith(" ") for line in paragraph):
            result += [("  " if line.startswith(" ") else "- ") + escape(line.strip()) for line in paragraph]
        else:
            result += [escape(line) for line in paragraph]
        result.append("")
    return result


def paragraphs(lines: list[str]) -> list[list[str]]:
    """The lines in runs without a blank one."""
    runs: list[list[str]] = [[]]
    for line in lines:
        if line.strip():
            runs[-1].append(line)
        elif runs[-1]:
            runs.append([])
    return [run for run in runs if run]


def process(app, what, name, obj, options, lines):
    """The event handler: rewrite the lines in place, and add what a data sheet or a result declares of its fields."""
    declared = list(fields(obj)) if what == "class" else []
    lines[:] = [*plain(list(lines)), *declared, ""]


def fields(cls) -> Iterator[str]:
    """One line for each declared field: name, meaning, unit and range."""
    if not dataclasses.is_dataclass(cls):
        return
    for field in dataclasses.fields(cls):
        about, dims = field.metadata.get("parameter"), field.metadata.get("dims")
        if about is not None:
            yield f"- ``{field.name}``: {escape(about.meaning)}, in {about.range}"
        elif dims is not None:
            axes = ", ".join(dims)
            yield f"- ``{field.name}`` ({axes}): {escape(field.metadata['meaning'])} [{field.metadata['unit']}]"


def setup(app):
    """Run before napoleon reads the sections."""
    app.connect("autodoc-process-docstring", process, priority=400)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}

"""The page: one file, everything inside, everything given escaped, whole or not at all."""

import base64
import html.parser
import re

import numpy as np
import pytest

from squealbox.report import (
    Cell,
    Code,
    Page,
    Picture,
    Points,
    ReportError,
    Section,
    Table,
    Text,
    Tiles,
    data_uri,
    render,
    result_section,
    write_page,
)

PIXEL = base64.b64decode(
    "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNk+M9QDwADhgGAWjR9awAAAABJRU5ErkJggg=="
)
HOSTILE = '<script>alert("x")</script>&\'"'


@pytest.fixture
def picture(tmp_path):
    path = tmp_path / "picture.png"
    path.write_bytes(PIXEL)
    return path


def page(picture, text="plain") -> Page:
    table = Table((text, "b"), ((Cell(text, text, "agree"), text),), text)
    inner = Section(text, (Picture(picture, text), Code(text)), folded=True)
    return Page(
        text, text, (Section(text, (Text(text), Points((text,)), Tiles(((text, text, ""),)), table, inner)),), text
    )


class Reader(html.parser.HTMLParser):
    """Every tag, every address and all text of a page."""

    def __init__(self) -> None:
        super().__init__()
        self.tags: list[str] = []
        self.addresses: list[str] = []
        self.said: list[str] = []

    def handle_starttag(self, tag, attributes):
        self.tags.append(tag)
        self.addresses += [value for name, value in attributes if name in ("src", "href", "action", "data")]

    def handle_data(self, data):
        self.said.append(data)


def read(text: str) -> Reader:
    reader = Reader()
    reader.feed(text)
    return reader


def test_a_page_fetches_nothing(picture) -> None:
    reader = read(render(page(picture)))
    assert reader.addresses
    assert all(address.startswith(("data:", "#")) for address in reader.addresses)
    assert "script" not in reader.tags
    assert not re.search(r"url\(|@import", render(page(picture)))


def test_what_is_given_is_text_and_never_markup(picture) -> None:
    reader = read(render(page(picture, HOSTILE)))
    assert "script" not in reader.tags
    assert HOSTILE in "".join(reader.said)


def test_the_picture_is_inside(picture) -> None:
    address = data_uri(picture)
    assert address.startswith("data:image/png;base64,")
    assert base64.b64decode(address.partition(",")[2]) == PIXEL
    assert address in render(page(picture))


@pytest.mark.parametrize("name", ["page.html", "data.json", "noending"])
def test_only_pictures_are_embedded(tmp_path, name) -> None:
    (tmp_path / name).write_text("x")
    with pytest.raises(ReportError, match="not a picture"):
        data_uri(tmp_path / name)


def test_a_short_row_is_refused() -> None:
    with pytest.raises(ReportError, match="row 1 has 1 cells, expected 2"):
        Table(("a", "b"), (("1", "2"), ("3",)), "numbers")


def test_folded_sections_can_be_opened_without_a_script(picture) -> None:
    assert "details" in read(render(page(picture))).tags
    assert "summary" in read(render(page(picture))).tags


def test_a_page_is_written_whole_or_not_at_all(picture, tmp_path) -> None:
    target = tmp_path / "page.html"
    write_page(page(picture), target)
    before = target.read_text(encoding="utf-8")
    assert before.rstrip().endswith("</html>")
    with pytest.raises(FileNotFoundError):
        write_page(page(tmp_path / "missing.png"), target)
    assert target.read_text(encoding="utf-8") == before
    assert sorted(p.name for p in tmp_path.iterdir()) == ["page.html", "picture.png"]


def test_a_result_tells_of_itself(drum) -> None:
    from squealbox import complex_modes

    modes = complex_modes(drum)
    section = result_section("modes", modes)
    text = "".join(read(render(Page("t", "l", (section,)))).said)
    assert "eigenvalues" in text
    assert f"{np.abs(modes.eigenvalues).max():.6g}" in text
    assert "Outcome: completed" in text
    assert modes.provenance["numpy"] in text

"""Results as one self-contained HTML page. Depends on: plots and the results it draws; jinja2 when writing.

    report("brake.toml", "brake.html")          a design examined from every side
    report(result, "result.html")               any result, or a file that holds one
    write_page(Page(...), "page.html")          a page of your own, of the blocks below

A page is data: a title and sections of text, tables, pictures, charts, sounds and code, nested where some of it should
be folded away. Pictures are embedded, styles are inside, nothing is fetched, everything given is escaped. It reads in
light and dark, on a narrow screen and on paper.
"""

from squealbox.report.blocks import (
    Cell,
    Chart,
    Code,
    Drawing,
    Page,
    Picture,
    Points,
    ReportError,
    Section,
    Sound,
    Table,
    Text,
    Tiles,
    data_uri,
)
from squealbox.report.design_page import design_page
from squealbox.report.examination import Examination
from squealbox.report.examining import examine
from squealbox.report.page import render, write_page
from squealbox.report.results import result_page, result_section
from squealbox.report.writing import report

__all__ = [
    "Cell",
    "Chart",
    "Code",
    "Drawing",
    "Examination",
    "Page",
    "Picture",
    "Points",
    "ReportError",
    "Section",
    "Sound",
    "Table",
    "Text",
    "Tiles",
    "data_uri",
    "design_page",
    "examine",
    "render",
    "report",
    "result_page",
    "result_section",
    "write_page",
]

from .blocks import (
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
from .design_pages import design_page
from .examination import Examination
from .examining import examine
from .page import render, write_page
from .results import result_page, result_section
from .writing import report

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

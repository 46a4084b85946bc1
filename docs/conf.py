"""Settings of the documentation: Sphinx with MyST-NB and furo; pages run their examples while they are built."""

import os
import sys
from pathlib import Path

import squealbox

os.environ["SQUEALBOX_PROGRESS"] = "no"  # no line of waiting among the outputs of cells
sys.path.insert(0, str(Path(__file__).parent / "_ext"))

project = "squealbox"
author = "the squealbox developers"
copyright = "the squealbox developers"
release = version = squealbox.__version__

extensions = ["myst_nb", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "plain_docstrings", "mathml"]
exclude_patterns = ["_build", "_ext", "paper"]  # the paper is for a journal's own tools
html_theme = "furo"
html_title = "squealbox"
html_static_path = ["_static"]
html_css_files = ["page.css"]
html_math_renderer = "mathml"
html_copy_source = False
html_show_sourcelink = False
html_show_sphinx = False

myst_enable_extensions = ["dollarmath", "amsmath", "colon_fence", "deflist"]
myst_heading_anchors = 3
nb_execution_mode = "force"
nb_execution_raise_on_error = True
nb_execution_timeout = 1500  # a machine ten times slower
nb_execution_in_temp = True  # what a cell writes does not stay among the pages
nb_merge_streams = True
nb_render_markdown_format = "gfm"  # tables
nb_mime_priority_overrides = [("html", "image/svg+xml", 0)]

default_role = "code"
autodoc_member_order = "bysource"
autodoc_typehints = "signature"
autodoc_typehints_format = "short"
autodoc_preserve_defaults = True
autodoc_inherit_docstrings = False
napoleon_google_docstring = False
suppress_warnings = ["ref.python"]  # the names of attributes, which several results share, are looked for by mistake

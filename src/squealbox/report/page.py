"""A page of blocks as one HTML file that needs nothing else: no network, no folder beside it.

Figures and brakes come to life by the workbench's own scripts, which lie in the same file. The page's policy
allows exactly these and what starts them, by their hash, and no connection to anywhere.
"""

import base64
import hashlib
import json
import os
import re
from collections.abc import Iterator
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np

from squealbox.figure_data import packed
from squealbox.labelled import whole
from squealbox.report.blocks import Chart, Page, Section, Vibrating

TEMPLATE = "page.html.j2"
STATIC = files("squealbox") / "workbench" / "static"
DRAWS = (
    "elements.js",
    "theme.js",
    "numbers.js",
    "colours.js",
    "chart.js",
    "figures.js",
    "zoom.js",
    "mesh.js",
    "drawing.js",
)
MODULE = re.compile(r"^(import .*;\n|export )", re.MULTILINE)
MICRO = re.compile(r"(\d |\[)u(?=[msNJ]\b)")


def render(page: Page) -> str:
    """The HTML of a page."""
    import jinja2

    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("squealbox", "templates"),
        autoescape=True,
        finalize=_micro,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    moving = [packed_block(block) for block in every((Chart, Vibrating), page.sections)]
    script = live(environment.get_template("live.js").render()) if moving else ""
    return environment.get_template(TEMPLATE).render(
        page=page,
        moving=moving,
        script=script,
        style=(STATIC / "chart.css").read_text(encoding="utf-8") if moving else "",
        digest=base64.b64encode(hashlib.sha256(script.encode("utf-8")).digest()).decode("ascii"),
    )


def live(start: str) -> str:
    """What draws figures and brakes in the workbench, and what starts it here, as one script."""
    parts = [(STATIC / name).read_text(encoding="utf-8") for name in DRAWS]
    return "(() => {\n" + MODULE.sub("", "".join(parts)) + start + "})();"


def packed_block(block: Chart | Vibrating) -> str:
    """What a block is drawn from as JSON, its arrays as the base64 of typed arrays; safe inside a script element."""
    if isinstance(block, Chart):
        figures, arrays = packed(block.figures)
        about: dict[str, Any] = {"figures": figures}
    else:
        about, arrays = {"data": block.data, "normal": block.normal}, dict(block.arrays)
    for name, values in arrays.items():
        whole = np.issubdtype(np.asarray(values).dtype, np.integer)
        kind = "Uint16Array" if whole else "Float32Array"
        content = np.ascontiguousarray(values, dtype="<u2" if whole else "<f4").tobytes()
        arrays[name] = [kind, base64.b64encode(content).decode("ascii")]
    return plain_json({**about, "arrays": arrays})


def _micro(value: Any) -> Any:
    """A text with µm for the um that terminals are given."""
    return type(value)(MICRO.sub(r"\1µ", value)) if isinstance(value, str) else value


def write_page(page: Page, path: str | os.PathLike[str]) -> Path:
    """Write a page to an HTML file, whole or not at all; returns the path."""
    path = Path(path)
    with whole(path) as part:
        part.write_text(render(page), encoding="utf-8")
    return path


def every(kind: type[Any] | tuple[type[Any], ...], blocks: tuple[Any, ...]) -> Iterator[Any]:
    """Every block of these kinds among nested ones, in the order of the page."""
    for block in blocks:
        if isinstance(block, Section):
            yield from every(kind, block.blocks)
        elif isinstance(block, kind):
            yield block


def plain_json(data: Any) -> str:
    """Dictionaries, lists, texts and arrays as JSON; what is not finite becomes null.

    Six digits, more than any screen shows; safe inside a script element.
    """
    return json.dumps(_plain(data), allow_nan=False, separators=(",", ":")).replace("<", "\\u003c")


def _plain(value: Any) -> Any:
    if isinstance(value, dict):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in value]
    if isinstance(value, (np.ndarray, np.generic)):
        return _plain(value.tolist())
    if isinstance(value, float):
        return float(f"{value:.6g}") if np.isfinite(value) else None
    return value

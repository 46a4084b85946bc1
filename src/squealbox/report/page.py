"""A page of blocks as one HTML file that needs nothing else: no network, no folder beside it.

Charts come to life by plotly.js, which lies packed in the same file and is unpacked by the browser, brakes in 3-D by
the workbench's own script. The page's policy allows exactly these scripts and what starts them, by their hashes, and no
connection to anywhere.
"""

import base64
import gzip
import hashlib
import json
import os
import re
from collections.abc import Iterator
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np

from squealbox.report.blocks import Chart, Page, Section, Solid

TEMPLATE = "page.html.j2"
DRAWS = ("elements.js", "theme.js", "mesh.js")  # of the workbench
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
    figures = [plain_json(chart.figure) for chart in every(Chart, page.sections)]
    solids = [packed_solid(solid) for solid in every(Solid, page.sections)]
    library = packed_library() if figures else None
    start = environment.get_template("charts.js").render() if library else ""
    turn = turning(environment.get_template("solid.js").render()) if solids else ""
    digests = [_digest(start), library[1]] if library else []
    digests += [_digest(turn)] if turn else []
    return environment.get_template(TEMPLATE).render(
        page=page,
        figures=figures,
        solids=solids,
        start=start,
        turn=turn,
        library=library[0] if library else "",
        allowed=" ".join(f"'sha256-{digest}'" for digest in digests),
    )


def turning(start: str) -> str:
    """What draws a brake in 3-D in the workbench, and what starts it here, as one script."""
    static = files("squealbox") / "workbench" / "static"
    parts = [(static / name).read_text(encoding="utf-8") for name in DRAWS]
    return "(() => {\n" + MODULE.sub("", "".join(parts)) + start + "})();"


def packed_solid(solid: Solid) -> str:
    """A brake in 3-D as JSON, its arrays as the base64 of typed arrays; safe inside a script element."""
    arrays = {}
    for name, values in solid.arrays.items():
        whole = np.issubdtype(np.asarray(values).dtype, np.integer)
        packed = np.asarray(values, dtype="<u2" if whole else "<f4")
        kind = "Uint16Array" if whole else "Float32Array"
        arrays[name] = [kind, base64.b64encode(packed.tobytes()).decode("ascii")]
    return plain_json({"data": solid.data, "arrays": arrays, "normal": solid.normal})


def _micro(value: Any) -> Any:
    """A text with µm for the um that terminals are given."""
    return type(value)(MICRO.sub(r"\1µ", value)) if isinstance(value, str) else value


def write_page(page: Page, path: str | os.PathLike[str]) -> Path:
    """Write a page to an HTML file, whole or not at all; returns the path."""
    path = Path(path)
    part = path.with_name(path.name + ".part")
    part.write_text(render(page), encoding="utf-8")
    part.replace(path)
    return path


def every(kind: type[Any], blocks: tuple[Any, ...]) -> Iterator[Any]:
    """Every block of a kind among nested ones, in the order of the page."""
    for block in blocks:
        if isinstance(block, Section):
            yield from every(kind, block.blocks)
        elif isinstance(block, kind):
            yield block


def plain_json(figure: Any) -> str:
    """A figure of dictionaries, lists, texts and arrays as JSON; what is not finite becomes null, a gap in a line.

    Six digits, more than any screen shows; safe inside a script element.
    """
    return json.dumps(_plain(figure), allow_nan=False, separators=(",", ":")).replace("<", "\\u003c")


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


@cache
def packed_library() -> tuple[str, str] | None:
    """The script of plotly.js, compressed, as base64; and the SHA-256 of the script; None where it is not installed."""
    try:
        from plotly.offline import get_plotlyjs
    except ModuleNotFoundError as error:
        if str(error.name).partition(".")[0] != "plotly":
            raise
        return None
    script = get_plotlyjs()
    packed = gzip.compress(script.encode("utf-8"), compresslevel=9, mtime=0)
    return base64.b64encode(packed).decode("ascii"), _digest(script)


def _digest(script: str) -> str:
    return base64.b64encode(hashlib.sha256(script.encode("utf-8")).digest()).decode("ascii")

"""The brake vibrating in its worst mode, as an SVG that moves by itself: no script, and still on paper.

A complex mode q(t) = Re(phi e^{i w t}) shows its phases; the size is free and the growth is left out. Where the reader
asked for less motion, and in print, the drawing stands still.
"""

from collections.abc import Iterator
from html import escape
from typing import Any

import numpy as np

from squealbox.designs import Design
from squealbox.plots.moving import moving_strokes
from squealbox.plots.verdicts import quantity
from squealbox.report.blocks import Drawing
from squealbox.stability import ComplexModes

FRAMES = 24  # of a period
PERIOD = 2.4  # s it takes
REACH = 0.14  # of the height of the drawing: the largest movement
SIZE, ROOM = (420.0, 300.0), 14.0  # px
BODY, HEAD = "#dfe8f0", 8.0  # fill of a part; px of an arrow's head
INK = {"motion": "#0072b2", "load": "#d55e00", "part": "#7a8a99"}
GREEK = {"\\theta": "θ", "\\Omega": "Ω", "\\mu": "μ"}
LESS = "@media (prefers-reduced-motion: reduce), print { .moves { display: none } .still { display: inline } }"
Put = Any  # places (frames, points, 2) in px


def vibrating(design: Design, modes: ComplexModes) -> Drawing | None:
    """The picture; None where the design has no drawing whose parts are known to move."""
    drawn, worst = moving_strokes(design), modes.most_unstable
    shape = worst.shape[: design.system().size]
    turns = np.exp(2j * np.pi * np.arange(FRAMES + 1) / FRAMES)
    moved = np.einsum("fi,ipx->fpx", np.real(turns[:, None] * shape), drawn["moves"])
    largest = float(np.max(np.hypot(moved[..., 0], moved[..., 1]), initial=0.0))
    if not largest > 0.0:
        return None
    left, right, bottom, top = drawn["box"]
    places = drawn["points"] + REACH * (top - bottom) / largest * moved
    scale = min((SIZE[0] - 2.0 * ROOM) / (right - left or 1.0), (SIZE[1] - 2.0 * ROOM) / (top - bottom or 1.0))
    middle = np.array([left + right, bottom + top]) / 2.0
    pixels = np.array(SIZE) / 2.0 + scale * (places - middle) * [1.0, -1.0]
    still = np.array(SIZE) / 2.0 + scale * (drawn["points"] - middle)[None] * [1.0, -1.0]
    parts = [f"<style>.still {{ display: none }} {LESS}</style>"]
    for name, spots in (("moves", pixels), ("still", still)):
        parts += [f'<g class="{name}">', *_strokes(drawn["strokes"], spots, scale), "</g>"]
    size = f'width="{SIZE[0]:g}" height="{SIZE[1]:g}" viewBox="0 0 {SIZE[0]:g} {SIZE[1]:g}"'
    svg = f'<svg xmlns="http://www.w3.org/2000/svg" {size} font-family="DejaVu Sans, sans-serif" font-size="13">'
    mode = f"The mode that grows first, {quantity(worst.frequency, 'Hz')}, slowed down."
    words = f"{mode} Its size is free; growth is left out."
    return Drawing((svg + "".join(parts) + "</svg>").encode(), words, "The brake vibrating in its worst mode")


def _strokes(strokes: list[dict[str, Any]], spots: Put, scale: float) -> Iterator[str]:
    first = 0
    for stroke in strokes:
        own = spots[:, first : first + stroke["count"]]
        first += stroke["count"]
        if np.all(np.isfinite(own)):
            yield DRAW[stroke["kind"]](stroke, own, scale)


def _spots(spots: Any) -> list[str]:
    """The attribute `points` at each frame, of places (frames, points, 2)."""
    return [" ".join(f"{x:.1f},{y:.1f}" for x, y in each) for each in spots]


def _tag(kind: str, moving: dict[str, list[str]], inside: str = "", **about: Any) -> str:
    """An element with the first values of what moves, and how they go on."""
    first = {name: values[0] for name, values in moving.items()}
    said = " ".join(f'{name.replace("_", "-")}="{escape(str(value))}"' for name, value in (first | about).items())
    goes = [
        f'<animate attributeName="{name}" dur="{PERIOD:g}s" repeatCount="indefinite" values="{";".join(values)}"/>'
        for name, values in moving.items() if len(set(values)) > 1
    ]  # fmt: skip
    return f"<{kind} {said}>{''.join(goes)}{inside}</{kind}>"


def _ink(stroke: dict[str, Any]) -> str:
    return INK.get(stroke["role"], "#14181d")


def _line(stroke: dict[str, Any], spots: Put, scale: float) -> str:
    about = {"fill": "none", "stroke": _ink(stroke), "stroke_width": f"{0.5 + 0.8 * float(stroke['width']):.2g}"}
    dashed = {"stroke_dasharray": "5 3"} if stroke.get("dashed") else {}
    return _tag("polyline", {"points": _spots(spots)}, **about, **dashed)


def _polygon(stroke: dict[str, Any], spots: Put, scale: float) -> str:
    about = {"fill": stroke.get("fill", BODY), "stroke": _ink(stroke), "stroke_width": 1.2}
    return _tag("polygon", {"points": _spots(spots)}, **about)


def _circle(stroke: dict[str, Any], spots: Put, scale: float) -> str:
    moving = {name: [f"{each:.1f}" for each in spots[:, 0, way]] for way, name in enumerate(("cx", "cy"))}
    if stroke.get("filled"):
        return _tag("circle", moving, r=3, fill="#14181d")
    radius = f"{scale * float(stroke['radius']):.1f}"
    return _tag("circle", moving, r=radius, fill=stroke.get("fill", BODY), stroke=_ink(stroke), stroke_width=1.2)


def _arrow(stroke: dict[str, Any], spots: Put, scale: float) -> str:
    along = spots[:, 1] - spots[:, 0]
    along = along / np.maximum(np.hypot(*along.T), 1e-9)[:, None]
    back, side = spots[:, 1] - HEAD * along, 0.45 * HEAD * np.stack([-along[:, 1], along[:, 0]], axis=1)
    shaft = {"points": _spots(np.stack([spots[:, 0], back], axis=1))}
    head = {"points": _spots(np.stack([spots[:, 1], back + side, back - side], axis=1))}
    return _tag("polyline", shaft, fill="none", stroke=_ink(stroke), stroke_width=2) + _tag(
        "polygon", head, fill=_ink(stroke)
    )


def _text(stroke: dict[str, Any], spots: Put, scale: float) -> str:
    anchor = {"left": "start", "right": "end"}.get(stroke.get("anchor", "center"), "middle")
    x, lines = [f"{each:.1f}" for each in spots[:, 0, 0]], []
    for i, words in enumerate(str(stroke["text"]).split("\n")):
        moving = {"x": x, "y": [f"{each + 4.0 + 14.0 * i:.1f}" for each in spots[:, 0, 1]]}
        lines.append(_tag("text", moving, _symbols(words), text_anchor=anchor, fill=_ink(stroke)))
    return "".join(lines)


def _symbols(words: str) -> str:
    """`$k_1, c_1$` with its subscripts."""
    said = []
    for i, piece in enumerate(words.split("$")):
        if i % 2 == 0:
            said.append(escape(piece))
            continue
        for name, letter in GREEK.items():
            piece = piece.replace(name, letter)
        letters = iter(escape(piece.replace("{", "").replace("}", "")))
        for letter in letters:
            low = next(letters, "") if letter == "_" else ""
            said.append(f'<tspan dy="3" font-size="10">{low}</tspan><tspan dy="-3">\u200a</tspan>' if low else letter)
    return "".join(said)


DRAW = {"line": _line, "polygon": _polygon, "circle": _circle, "arrow": _arrow, "text": _text}

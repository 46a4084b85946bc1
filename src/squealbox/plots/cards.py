"""What a notebook shows of a result or a design: a small card of HTML, readable without colours of its own.

A card says what it is and how it ended, gives the key numbers with their units, a small picture where one is cheap, and
folds away the arrays, settings and versions. Everything taken from outside is escaped; nothing is fetched.
"""

import base64
import dataclasses
from collections.abc import Iterable, Mapping
from html import escape
from typing import TYPE_CHECKING, Any

import numpy as np

from squealbox.design import Design
from squealbox.labelled import Labels
from squealbox.law import FrictionLaw
from squealbox.limit_cycles import Basin, Branch, PointCurve
from squealbox.parameters import DataSheet, Parameter
from squealbox.plots.brakes import has_drawing
from squealbox.plots.dispatch import drawer_of, plot
from squealbox.plots.key_numbers import facts
from squealbox.plots.style import drawn
from squealbox.plots.sweeps import numeric_answers
from squealbox.result import Result
from squealbox.stability import ComplexModes, finite_spectrum
from squealbox.stability import modes_html as modes_table
from squealbox.studies import Sweep
from squealbox.system import System
from squealbox.transient import Trajectory
from squealbox.words import number, plain_unit, read_in

if TYPE_CHECKING:
    from matplotlib.figure import Figure

DOTS = 90.0  # an inch: small, but sharp enough for a notebook
WALKED = (Branch, PointCurve, Basin, Trajectory, Sweep)  # what was reached is worth seeing, however it ended
MOST_MODES = 30  # degrees of freedom of a system whose frequencies a card tells
MOST_WORDS = 8  # of an array of words that are named
ARRAYS = ("array", "shape", "unit", "meaning", "least", "greatest")
MOST_POINTS = 500_000  # more numbers than this are not drawn unasked


def card(thing: Result | DataSheet) -> str:
    """The card of a result, a design, or another data sheet such as a system, a contact or a law, as HTML."""
    if isinstance(thing, Result):
        return _result_card(thing)
    return _design_card(thing) if isinstance(thing, Design) else _sheet_card(thing)


def _sheet_card(sheet: DataSheet) -> str:
    said = (type(sheet).__doc__ or "").strip().partition("\n")[0]
    parts = [f"<p><b>{escape(type(sheet).__name__)}</b> &middot; {escape(said)}</p>"]
    if isinstance(sheet, FrictionLaw) and not any(np.ndim(value) for _, _, value in sheet.leaves()):
        parts.append(inline(plot(sheet)))
    if isinstance(sheet, System) and sheet.shape == () and sheet.size <= MOST_MODES:
        parts.append(_frequencies(sheet))
    return _framed(parts, f'<pre style="white-space: pre-wrap">{escape(sheet.summary())}</pre>')


def _frequencies(system: System) -> str:
    """The frequencies of a system without its friction."""
    if system.is_sparse:
        return ""
    values = finite_spectrum(System(system.M, system.C, system.K)).eigenvalues
    found = np.sort(np.abs(values.imag[values.imag >= 0.0])) / (2.0 * np.pi)
    return f"<p>Without friction: {', '.join(number(f, 5) for f in found)} Hz</p>"


def inline(figure: "Figure", dots: float = DOTS) -> str:
    """A figure as an ``img`` element that carries its own PNG."""
    data = base64.b64encode(drawn(figure, "png", dots)).decode("ascii")
    return f'<img alt="" style="max-width: 100%; background: white" src="data:image/png;base64,{data}">'


def table(head: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    """A plain HTML table; every cell is escaped."""
    first = "".join(f'<th style="text-align: left">{escape(cell)}</th>' for cell in head)
    body = "".join(
        "<tr>" + "".join(f'<td style="text-align: left">{escape(cell)}</td>' for cell in row) + "</tr>" for row in rows
    )
    return f"<table><thead><tr>{first}</tr></thead><tbody>{body}</tbody></table>"


def _result_card(result: Result) -> str:
    kind = type(result).__name__
    ended = result.outcome.told
    parts = [f"<p><b>{escape(kind)}</b> &middot; {escape(ended)}</p>"]
    parts += [f"<p><b>Caution:</b> {escape(result.warning)}</p>"] * bool(result.warning)
    parts.append(_said(result))
    if has_figure(result):
        parts.append(inline(plot(result)))
    tables = [table(ARRAYS, array_rows(result)), table(("", "name", "value"), setting_rows(result))]
    return _framed(parts, _folded("arrays, settings, versions", tables))


def _said(result: Result) -> str:
    """What the result says of itself: a table of modes, its summary, else its key numbers."""
    if isinstance(result, ComplexModes):
        return modes_table(result)
    told = getattr(result, "summary", None)
    words = told() if told is not None else str(getattr(result, "text", ""))
    said = f'<pre style="white-space: pre-wrap">{escape(words)}</pre>' if words else ""
    numbers = facts(result)
    return said + (table(("", "value", "unit"), numbers) if numbers else "")


def drawable(result: Result) -> bool:
    """True where a figure is known and there is something to draw."""
    known = drawer_of(type(result)) is not drawer_of(object)
    return known and (result.outcome.ok or isinstance(result, WALKED)) and _sizes(result)[0] > 0


def has_figure(result: Result) -> bool:
    """True where it is `drawable` and the arrays are small enough to draw unasked."""
    return drawable(result) and max(_sizes(result)) <= MOST_POINTS


def _sizes(result: Result) -> list[int]:
    return [np.size(getattr(result, name)) for name, _ in _quantities(result)] or [_points(result)]


def _points(result: Result) -> int:
    """Points of a sweep that hold an answer that can be drawn; 0 of any other kind without arrays of its own."""
    if not isinstance(result, Sweep) or not numeric_answers(result):
        return 0
    return int(np.size(result.outcomes))


def array_rows(result: Result) -> list[tuple[str, ...]]:
    """(name, shape, unit, meaning, least, greatest) of every array; of words, which there are."""
    if isinstance(result, Sweep):
        held = result.dataset.data_vars.items()
        return [_array_row(str(name), Labels(each.dims, each.values, each.attrs)) for name, each in held]
    return [_array_row(name, each) for name, each in result.labelled().variables.items()]


def _array_row(name: str, held: Labels) -> tuple[str, ...]:
    values = np.asarray(held.values)
    shape = " x ".join(f"{size} {dim}" for size, dim in zip(values.shape, held.dims, strict=True)) or "one value"
    said = (name, shape, plain_unit(str(held.about.get("units", ""))), str(held.about.get("long_name", "")))
    if values.dtype.kind not in "biufc":
        return *said, ", ".join(sorted({str(word) for word in np.ravel(values)})[:MOST_WORDS]), ""
    finite = np.abs(values) if np.iscomplexobj(values) else np.asarray(values, dtype=float)
    finite = finite[np.isfinite(finite)]
    return *said, *((f"{finite.min():.6g}", f"{finite.max():.6g}") if finite.size else ("", ""))


def setting_rows(result: Result) -> list[tuple[str, str, str]]:
    """(what it is, name, value) of every setting and version."""
    given = [("setting", name, _short(value)) for name, value in result.settings.items()]
    return given + [("version", name, str(value)) for name, value in result.provenance.items()]


def _quantities(result: Result) -> list[tuple[str, Mapping[str, Any]]]:
    return [(field.name, field.metadata) for field in dataclasses.fields(result) if "dims" in field.metadata]


def _design_card(design: Design) -> str:
    kind = type(design).__name__
    parts = [f"<p><b>{escape(kind)}</b> &middot; {escape(design.title)}<br><small>{escape(design.source)}</small></p>"]
    if has_drawing(design):
        parts.append(inline(plot(design)))
    return _framed(parts, table(("parameter", "value", "range", "meaning", "source"), parameter_rows(design)))


def parameter_rows(design: DataSheet) -> list[tuple[str, str, str, str, str]]:
    """(name, value with unit, range, meaning, source) of every parameter, nested sheets included, in units as read."""
    rows = [(name, *_with_unit(value, about, design.usual(name)), about.meaning, about.source)
            for name, about, value in design.leaves()]  # fmt: skip
    words = [(name, str(getattr(design, name)), "one of " + ", ".join(about.options), about.meaning, "")
             for name, about in design.choices().items()]  # fmt: skip
    return rows + words


def _with_unit(value: Any, about: Parameter, usual: Any) -> tuple[str, str]:
    """Value and range in the unit a reader uses: degrees, kN/mm."""
    unit, factor = read_in(about, usual)
    range_ = dataclasses.replace(about, unit=unit, low=about.low / factor, high=about.high / factor).range
    if value is None:
        return "not set", range_
    if isinstance(value, DataSheet):
        return f"{type(value).__name__}, varies in time", range_
    if np.ndim(value):
        return f"{np.size(value)} values {plain_unit(about.unit)}".rstrip(), range_
    return f"{number(float(value) / factor, 6)} {unit}".rstrip(), range_


def _short(value: Any, most: int = 80) -> str:
    text = str(value)
    return text if len(text) <= most else f"{text[: most - 3]}..."


def _folded(title: str, parts: list[str]) -> str:
    return f"<details><summary>{escape(title)}</summary>{''.join(parts)}</details>"


def _framed(parts: list[str], last: str) -> str:
    return f'<div class="squealbox-card">{"".join(parts)}{last}</div>'

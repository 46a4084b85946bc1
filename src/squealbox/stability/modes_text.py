"""The spectrum as a table for an e-mail, and as HTML for a notebook."""

import html as html_module
from typing import TYPE_CHECKING

import numpy as np

from squealbox.parameters import with_cautions
from squealbox.words import growing

if TYPE_CHECKING:
    from squealbox.stability.eigenvalues import ComplexModes

HEADER = ("mode", "frequency [Hz]", "growth [1/s]", "damping [%]", "omega [rad/s]", "")


def summary(modes: "ComplexModes") -> str:
    """One line of verdict and a table of the n modes; with leading axes, of the most unstable entry."""
    if not np.any(modes.exists):
        return f"No complex modes: {modes.outcome} ({modes.outcome.message})"
    if not np.any(np.isfinite(modes.eigenvalues)):
        return "No complex modes: nothing has mass or damping, so every eigenvalue is at infinity"
    entry, rows = _rows(modes)
    table = [HEADER, *rows]
    widths = [max(len(row[i]) for row in table) for i in range(len(HEADER))]
    padded = [[cell.rjust(width) for cell, width in zip(row, widths, strict=True)] for row in table]
    lines = [_verdict(modes, entry), *("  ".join(row).rstrip() for row in padded)]
    return with_cautions(lines, *_cautions(modes, entry))


def modes_html(modes: "ComplexModes") -> str:
    """The same table as HTML."""
    if not np.any(modes.exists) or not np.any(np.isfinite(modes.eigenvalues)):
        return f"<p>{html_module.escape(summary(modes))}</p>"
    entry, rows = _rows(modes)
    head = "".join(f"<th>{cell}</th>" for cell in HEADER)
    body = "".join("<tr>" + "".join(f"<td>{cell}</td>" for cell in row) + "</tr>" for row in rows)
    cautions = "".join(f"<p>{html_module.escape(with_cautions([], text))}</p>" for text in _cautions(modes, entry))
    return f"<p>{html_module.escape(_verdict(modes, entry))}</p><table><tr>{head}</tr>{body}</table>{cautions}"


def _rows(modes: "ComplexModes") -> tuple[tuple[int, ...], list[tuple[str, ...]]]:
    entry = modes.most_unstable.entry
    values = modes.eigenvalues[entry]
    scale = np.nanmax(np.abs(values), initial=0.0)
    rows: list[tuple[str, ...]] = []
    for i, value in enumerate(values[: len(values) // 2]):
        if not np.isfinite(value):
            rows.append((str(i + 1), "-", "-", "-", "-", "no mass: at infinity"))
            continue
        growth = value.real if abs(value.real) > 1e-12 * scale else 0.0
        ratio = -100.0 * growth / abs(value) if value != 0.0 else 0.0
        mark = "unstable" if growth > 0.0 else ""
        if modes.condition[(*entry, i)] > 1e6:
            mark = f"{mark} near-defective".strip()
        omega = abs(value.imag)
        numbers = (f"{omega / (2.0 * np.pi):.6g}", f"{growth:+.6g}", f"{ratio:+.4f}", f"{omega:.6g}")
        rows.append((str(i + 1), *numbers, mark))
    return entry, rows


def _verdict(modes: "ComplexModes", entry: tuple[int, ...]) -> str:
    worst = modes.mode(modes.most_unstable.index, entry)
    state = "STABLE" if bool(modes.stable[entry]) else "UNSTABLE"
    text = f"Steady sliding is {state}: largest growth rate {growing(worst.growth_rate, worst.frequency)}"
    if entry:
        total = int(np.size(modes.exists))
        unstable = total - int(np.sum(modes.stable)) - int(np.sum(~modes.exists))
        missing = int(np.sum(~modes.exists))
        text += f" (worst of {total} points, at {entry}; {unstable} unstable, {missing} without steady sliding)"
    return text


def _cautions(modes: "ComplexModes", entry: tuple[int, ...]) -> list[str]:
    """One sentence when steady sliding needs a contact to pull."""
    forces = zip(modes.contacts, modes.normal_force[entry], strict=bool(modes.contacts))
    pulled = [f"{name} ({force:.4g} N)" for name, force in forces if force < 0.0]
    others = [part for part in modes.caution.split("; ") if part and "have to pull" not in part]
    if not pulled:
        return others
    return [f"in steady sliding the equations let {', '.join(pulled)} pull; a real contact would lift off.",
            *others]  # fmt: skip

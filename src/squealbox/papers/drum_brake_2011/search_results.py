"""What the search found: a table by claim, the best combinations, a figure and a CSV file."""

import csv
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from squealbox import plots
from squealbox.papers.drum_brake_2011.claims import AGREE, claims
from squealbox.papers.drum_brake_2011.search import ALPHAS, SPEEDS
from squealbox.plots import drawing
from squealbox.report import Cell, Picture, Table, Text

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SHOWN = 6


def rows_of(searched: Mapping[str, Any]) -> list[dict[str, Any]]:
    """The rows of all readings."""
    return [row for each in searched.values() for row in each["rows"]]


def met(row: Mapping[str, Any]) -> list[str]:
    """The claims a combination meets."""
    return [name for name, verdict in row["verdicts"].items() if verdict == AGREE]


def draw(searched: Mapping[str, Any]) -> "Figure":
    """Number of claims met over alpha and sliding speed, a panel for each reading, the better of both floors."""
    columns = 4
    rows = -(-len(searched) // columns)
    figure, panels = plots.panels(rows, columns, width=8.8, height=2.3 * rows, squeeze=False)
    for panel in np.ravel(panels)[len(searched) :]:
        panel.axis("off")
    for panel, (reading, each) in zip(np.ravel(panels), searched.items(), strict=False):
        numbers = np.full((len(ALPHAS), len(SPEEDS)), np.nan)
        for row in each["rows"]:
            place = ALPHAS.index(row["alpha"]), SPEEDS.index(row["speed"])
            numbers[place] = np.nanmax([numbers[place], len(met(row))])
        with drawing(panel):
            panel.imshow(numbers, cmap="Blues", vmin=0, vmax=len(claims()) / 2, aspect="auto", origin="lower")
            for i, j in np.ndindex(*numbers.shape):
                if np.isfinite(numbers[i, j]):
                    panel.text(j, i, f"{numbers[i, j]:.0f}", ha="center", va="center", fontsize=8)
            panel.set_xticks(range(len(SPEEDS)), [f"{speed:g}" for speed in SPEEDS])
            panel.set_yticks(range(len(ALPHAS)), [f"{alpha:g}" for alpha in ALPHAS])
            panel.tick_params(length=0)
            panel.set_title(reading)
    with drawing(panels):
        for panel in panels[-1]:
            panel.set_xlabel("sliding speed [m/s]")
        for panel in panels[:, 0]:
            panel.set_ylabel("alpha [s/m]")
    return figure


def write_csv(path: Path, searched: Mapping[str, Any]) -> Path:
    """Every combination with its verdict on each claim."""
    names = [claim.id for claim in claims()]
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(["reading", "alpha [s/m]", "sliding speed [m/s]", "floor", "claims met", "parts met", *names])
        for row in rows_of(searched):
            floor = "none" if row["floor"] is None else f"{row['floor']:g}"
            parts = sum(agree for agree, _ in row["parts"].values())
            verdicts = [row["verdicts"][name] for name in names]
            writer.writerow([row["reading"], row["alpha"], row["speed"], floor, len(met(row)), parts, *verdicts])
    return path


def blocks(folder: Path, searched: Mapping[str, Any]) -> tuple[Any, ...]:
    """The section of the page."""
    rows = rows_of(searched)
    skipped = sum(each["skipped"] for each in searched.values())
    rest = f" {skipped} more were left out because the search is bounded in time." if skipped else ""
    intro = (
        f"{len(rows)} combinations were tried against every claim: all readings, alpha of {_list(ALPHAS)} s/m, sliding "
        f"speeds of {_list(SPEEDS)} m/s, and friction as printed or clipped at zero; transients with exact contact."
        f"{rest} Nothing was tuned: the figure and tables say what each combination happens to meet. "
        "All of them are in search.csv."
    )
    best = sorted(rows, key=lambda row: (-len(met(row)), -sum(agree for agree, _ in row["parts"].values())))
    return (
        Text(intro),
        Picture(folder / "search.png", f"Number of the {len(claims())} claims that each combination meets."),
        Table(("claim", "met by", "such as"), tuple(_claim_row(claim.id, rows) for claim in claims()), "By claim."),
        Table(
            ("combination", "claims met", "which", "parts met"), tuple(_best_row(row) for row in best[:12]),
            "The combinations that meet most.",
        ),
    )  # fmt: skip


def _claim_row(name: str, rows: list[dict[str, Any]]) -> tuple[str | Cell, ...]:
    meeting = [row for row in rows if row["verdicts"][name] == AGREE]
    readings: dict[str, int] = {}
    for row in meeting:
        readings[row["reading"]] = readings.get(row["reading"], 0) + 1
    by_reading = ", ".join(f"{reading} {number}" for reading, number in readings.items())
    examples = "; ".join(_named(row) for row in meeting[:: max(1, len(meeting) // SHOWN)][:SHOWN])
    return name, Cell(f"{len(meeting)} of {len(rows)}", by_reading, AGREE if meeting else ""), examples


def _best_row(row: dict[str, Any]) -> tuple[str, ...]:
    agree, total = (sum(numbers) for numbers in zip(*row["parts"].values(), strict=True))
    return _named(row), str(len(met(row))), ", ".join(met(row)), f"{agree} of {total}"


def _named(row: Mapping[str, Any]) -> str:
    floor = "" if row["floor"] is None else ", clipped"
    return f"{row['reading']}, alpha {row['alpha']:g}, {row['speed']:g} m/s{floor}"


def _list(values: tuple[float, ...]) -> str:
    return ", ".join(f"{value:g}" for value in values)

"""What silences it: the ranked table of cures, each with what the page has to change to have it."""

import dataclasses
from collections.abc import Callable
from typing import Any

from squealbox.design import Design
from squealbox.files import NotWritable, design_text
from squealbox.parameters import ParameterError
from squealbox.remedies import Candidate, Remedies, candidates_for, more_friction, silence
from squealbox.workbench.frames import finite
from squealbox.workbench.panels.declared import Panel, number, words
from squealbox.workbench.panels.panel import Answer, OptionError, Options, Work

PANEL = Panel(
    "Cures", questions=("silences",), columns=2, slow=True, apart=True,
    choices=(words("quiet up to", "margin", ("0.05", "5 % more friction"), ("0.1", "10 % more friction"),
                   ("0.2", "20 % more friction"), ("0.4", "40 % more friction"), of="remedies.SilenceSettings"),
             number("", "samples", 1024, 16, 1e5, of="remedies.SilenceSettings")),
)  # fmt: skip


def answer(design: Design, options: Options, work: Work) -> Answer:
    """Rows of cures, the best first: numbers, words, and either other values or the text of the cured brake's file."""
    how = options.chosen(*PANEL.choices)
    try:
        chosen = candidates_for(design, more_friction(design, 1.0 + how["margin"]))
        count = len(chosen)
        watched = [_watched(each, work, i / (count + 1)) for i, each in enumerate(chosen)]
        table = silence(design, None, watched, **how)
    except (ParameterError, ValueError) as error:
        raise OptionError(f"no cures are known for this brake: {error}") from error
    data = {
        "margin": how["margin"],
        "growth": finite(table.growth_before),
        "probability": table.before,
        "amplitude": finite(table.amplitude_before),
        "assumption": table.assumption,
        "rows": [_row(table, i) for i in range(len(table))],
    }
    return Answer(data)


def _watched(each: Candidate, work: Work, share: float) -> Candidate:
    """A candidate that says when it is tried, and ends the work where nobody waits any more."""

    def make(dose: Any, plain: Callable[[Any], Design] = each.make) -> Design:
        work.progress(share, f"trying {each.name}")
        return plain(dose)

    return dataclasses.replace(each, make=make)


def _row(table: Remedies, i: int) -> dict[str, Any]:
    dose, unit = table.dose_as_read(i)
    row: dict[str, Any] = {
        "name": str(table.name[i]), "dose": dose, "unit": unit,
        "reached": bool(table.reached[i]), "growth": finite(table.growth[i]),
        "atMargin": finite(table.growth_at_margin[i]), "probability": float(table.probability[i]),
        "amplitude": finite(table.amplitude[i]), "cost": str(table.cost[i]), "caution": str(table.caution[i]),
        "python": str(table.line[i]),
    }  # fmt: skip
    if table.values[i]:
        return row | {"values": table.values[i]}
    try:
        return row | {"text": design_text(table.design(i))}
    except NotWritable as error:
        return row | {"refused": str(error)}

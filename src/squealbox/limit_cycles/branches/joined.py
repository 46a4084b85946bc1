"""Two walks from one cycle, one each way, as one branch."""

from dataclasses import fields, replace
from typing import Any

import numpy as np

from squealbox.limit_cycles.branches.branch import Branch
from squealbox.result import Outcome

ALONG = ("value", "period", "lowest", "highest", "multipliers", "start", "least_slip", "sticking", "unknowns")


def joined(back: Branch, forth: Branch) -> Branch:
    """The branch from the end of `back` over the common start to the end of `forth`.

    `unknowns` keeps those of each walk. Outcome "completed" where both walks ended so, else the first that did not.

    >>> from squealbox import DrumBrake, LinearSlope, shooting
    >>> from squealbox.limit_cycles import branch
    >>> drum = DrumBrake(friction=LinearSlope(0.45, -0.05))
    >>> walk = {"start": shooting(drum), "value": 0.45, "method": "shooting", "points": 3}
    >>> ways = [branch(drum, "friction.static", (0.4, 0.5), direction=way, **walk) for way in (-1, 1)]
    >>> len(joined(*ways).value)
    5
    """
    if len(back.value) == 0 or len(forth.value) == 0:
        return forth if len(back.value) == 0 else back
    count = len(back.value)
    arrays: dict[str, Any] = {
        name: np.concatenate([getattr(back, name)[:0:-1], getattr(forth, name)]) for name in ALONG
    }
    special: dict[str, Any] = {each.name: np.concatenate([getattr(back, each.name)[::-1], getattr(forth, each.name)])
               for each in fields(Branch) if each.name.startswith("special_")}  # fmt: skip
    special["special_point"] = np.r_[count - 2 - back.special_point[::-1], forth.special_point + count - 1]
    ends = [one.outcome.message or str(one.outcome) for one in (back, forth)]
    bad = next((one.outcome for one in (back, forth) if not one.outcome.ok), None)
    message = "; ".join(ends)
    outcome = Outcome(message=message) if bad is None else Outcome(str(bad), message, **bad.evidence)
    settings = {**forth.settings, "one_way": 0.0}
    return replace(
        forth, outcome=outcome, settings=settings, points=back.points[::-1] + forth.points, **arrays, **special
    )

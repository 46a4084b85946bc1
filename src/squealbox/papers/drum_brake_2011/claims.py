"""The paper's claims as data, and the one rule that judges a computed value against them."""

import dataclasses
import functools
import tomllib
from dataclasses import dataclass
from importlib import resources
from typing import Any

AGREE, DISAGREE, UNDECIDED = "agree", "disagree", "not decidable"
EIGENVALUES, RAW, EXACT = "eigenvalues", "raw", "exact"
ROADS = (EIGENVALUES, RAW, EXACT)


@dataclass(frozen=True)
class ClaimPart:
    """One number or yes/no statement of a claim, with the tolerance it is judged by and its reason."""

    claim: str
    name: str
    meaning: str
    published: str | bool
    unit: str
    below: float
    above: float
    reason: str
    roads: tuple[str, ...]

    @property
    def key(self) -> str:
        """Claim and part in one word, such as ``mu-3.lower``."""
        return f"{self.claim}.{self.name}"

    @property
    def is_amplitude(self) -> bool:
        """True for a length of a motion: it may be read as half of peak to peak, or as all of it."""
        return self.unit == "mm"

    @property
    def tolerance(self) -> str:
        """The tolerance in words, such as ``+-126 rad/s`` or ``-5 / +0 kN``."""
        if self.published is True:
            return "yes or no"
        unit = "" if self.unit == "-" else f" {self.unit}"
        if self.below == self.above:
            return f"±{self.below:g}{unit}"
        return f"-{self.below:g} / +{self.above:g}{unit}"


@dataclass(frozen=True)
class Claim:
    """A claim of the paper: id, what it says in our words, what it gives, the roads that decide it, its parts."""

    id: str
    statement: str
    published: str
    deciding: tuple[str, ...]
    parts: tuple[ClaimPart, ...]


@dataclass(frozen=True)
class Finding:
    """What a computation says to one part: a number in the part's unit, yes or no, or None when it cannot say.

    `note` gives the evidence, or why there is no answer. `trusted` is False when the computation itself is doubtful,
    as a raw integration across sgn() can be; the note then says why.
    """

    value: float | bool | None
    note: str = ""
    trusted: bool = True


def read_as(part: ClaimPart, finding: Finding, halves: float) -> Finding:
    """A finding in the paper's measure: amplitudes are found as half peak to peak, and `halves` of them are meant."""
    if not part.is_amplitude or finding.value is None:
        return finding
    return dataclasses.replace(finding, value=halves * float(finding.value))


def judge(part: ClaimPart, finding: Finding) -> str:
    """`agree`, `disagree` or `not decidable`: the published value against the computed one, by the part's tolerance."""
    if finding.value is None:
        return UNDECIDED
    if part.published is True:
        return AGREE if finding.value is True else DISAGREE
    distance = float(finding.value) - float(part.published)
    slack = 1e-9 * max(abs(float(part.published)), 1e-9)  # round-off of a value that sits on the edge
    return AGREE if -part.below - slack <= distance <= part.above + slack else DISAGREE


def combined(verdicts: list[str]) -> str:
    """The verdict on a claim from those on its parts: one disagreement is enough, and all must be decided to agree."""
    if DISAGREE in verdicts:
        return DISAGREE
    return AGREE if verdicts and set(verdicts) == {AGREE} else UNDECIDED


@functools.cache
def paper() -> dict[str, Any]:
    """Title and source of the paper, what is assumed to run it, and where it contradicts itself."""
    return dict(_data()["paper"])


@functools.cache
def claims() -> tuple[Claim, ...]:
    """All claims in the paper's order."""
    return tuple(_claim(entry) for entry in _data()["claim"])


def _data() -> dict[str, Any]:
    return tomllib.loads(resources.files(__package__).joinpath("claims.toml").read_text(encoding="utf-8"))


def _claim(entry: dict[str, Any]) -> Claim:
    parts = tuple(
        ClaimPart(
            claim=entry["id"],
            name=part["name"],
            meaning=part["meaning"],
            published=part["published"],
            unit=part.get("unit", "-"),
            below=part.get("below", 0.0),
            above=part.get("above", 0.0),
            reason=part["reason"],
            roads=tuple(part["roads"]),
        )
        for part in entry["part"]
    )
    return Claim(entry["id"], entry["statement"], entry["published"], tuple(entry["deciding"]), parts)

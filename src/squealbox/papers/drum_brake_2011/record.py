"""The verdict on every claim in every reading, as plain data, as claims.json and as claims.md."""

import json
import math
from collections.abc import Iterator, Mapping
from importlib import metadata
from pathlib import Path
from typing import Any

import numpy as np

from squealbox.papers.drum_brake_2011.cases import AMPLITUDES, Case
from squealbox.papers.drum_brake_2011.claims import (
    AGREE,
    DISAGREE,
    ROADS,
    UNDECIDED,
    Claim,
    ClaimPart,
    Finding,
    claims,
    combined,
    judge,
    paper,
    read_as,
)
from squealbox.result import provenance

Record = dict[str, Any]


def records(studies: Mapping[str, Any]) -> list[Record]:
    """One record for each claim and reading, from the studies by reading that `reading.study` makes.

    Amplitudes are judged in the measure of the reading, half of peak to peak or all of it; `as` has both verdicts.
    """
    return [
        _record(claim, reading, study["findings"], study.get("amplitude") or Case(reading).amplitude)
        for claim in claims()
        for reading, study in studies.items()
    ]


def overall(found: list[Record]) -> list[Record]:
    """One record for each claim: the best verdict any reading gives, by which readings and in which measure.

    `verdict` is that of the best reading; `agree` names the readings that meet the claim as they are judged,
    `otherwise` those that meet it with the other measure of amplitude.
    """
    by_claim: dict[str, list[Record]] = {}
    for each in found:
        by_claim.setdefault(each["id"], []).append(each)
    return [_best(each) for each in by_claim.values()]


def met_by_reading(found: list[Record], measure: str | None = None) -> dict[str, list[str]]:
    """The claims each reading meets; in its own measure of amplitude, or all in `measure`."""
    met: dict[str, list[str]] = {each["reading"]: [] for each in found}
    for each in found:
        verdict = each["verdict"] if measure is None else each["as"].get(measure, each["verdict"])
        if verdict == AGREE:
            met[each["reading"]].append(each["id"])
    return met


def count(found: list[Record]) -> dict[str, int]:
    """How many records agree, disagree and cannot be decided."""
    return {verdict: sum(each["verdict"] == verdict for each in found) for verdict in (AGREE, DISAGREE, UNDECIDED)}


def versions() -> dict[str, str]:
    """Versions of what computed and drew the study."""
    return {**provenance(), **{name: metadata.version(name) for name in ("llvmlite", "matplotlib")}}


def write_json(path: Path, found: list[Record], searched: Mapping[str, Any], extras: Any) -> Path:
    """claims.json: the paper, the records, and the searches. Values that are not finite are written as null."""
    about = {
        "paper": paper(),
        "versions": versions(),
        "summary": count(found),
        "overall": overall(found),
        "claims": found,
        "search": searched,
        "family": _family(extras),
    }
    path.write_text(json.dumps(_finite(about), indent=1, allow_nan=False, ensure_ascii=False) + "\n", encoding="utf-8")
    return path


def _family(extras: Any) -> Record:
    """The search through the family of equations: its counts and the level of chance."""
    form, found = ("short", extras.short) if extras.whole is None else ("whole", extras.whole.searched)
    return {
        "form": form,
        "members": found.family,
        "members_by_claims_met": [int(number) for number in found.counts],
        "most": found.most,
        "scrambled_sets": found.sets,
        "chance": found.chance,
        "best_of_all_claims": None if extras.whole is None else extras.whole.best[2],
    }


def write_markdown(path: Path, found: list[Record]) -> Path:
    """claims.md: one table of verdicts, and one table for each claim with all its numbers."""
    path.write_text("\n".join(_markdown(found)) + "\n", encoding="utf-8")
    return path


def shown(part: ClaimPart | Mapping[str, Any], value: float | bool | None) -> str:
    """A value as a reader reads it, with its unit."""
    unit = part.unit if isinstance(part, ClaimPart) else part["unit"]
    if value is None:
        return "no answer"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if not math.isfinite(value):
        return "none"
    digits = 3 if unit == "mm" else 4
    text = f"{value:.0f}" if unit == "rad/s" else np.format_float_positional(value, digits, fractional=False, trim="-")
    return text if unit == "-" else f"{text} {unit}"


def _best(found: list[Record]) -> Record:
    best = min(found, key=lambda each: (each["verdict"] != AGREE, -_share(each), _miss(each)))
    agree = [each["reading"] for each in found if each["verdict"] == AGREE]
    otherwise = [
        each["reading"] for each in found if each["reading"] not in agree and AGREE in each["as"].values()
    ]  # fmt: skip
    return {
        "id": best["id"],
        "statement": best["statement"],
        "published": best["published"],
        "verdict": best["verdict"],
        "reading": best["reading"],
        "computed": best["computed"],
        "amplitude": best["amplitude"],
        "agree": agree,
        "otherwise": otherwise,
    }


def _share(each: Record) -> float:
    """The share of the parts that count and agree."""
    verdicts = [
        answer["verdict"]
        for part in each["parts"]
        for road, answer in part["roads"].items()
        if road in each["deciding"]
    ]
    return verdicts.count(AGREE) / len(verdicts)


def _miss(each: Record) -> float:
    """The mean distance of the numbers that count from the published ones, as a share; infinite without an answer."""
    misses = [
        abs(float(answer["computed"]) / float(part["published"]) - 1.0)
        for part in each["parts"] if part["published"] is not True and part["published"]
        for road, answer in part["roads"].items() if road in each["deciding"] and answer["computed"] is not None
    ]  # fmt: skip
    return float(np.mean(misses)) if misses else np.inf


def _record(claim: Claim, reading: str, findings: Mapping[str, Any], measure: str) -> Record:
    parts = [_part(part, findings, claim, measure) for part in claim.parts]
    deciding = [(part, road) for part in parts for road in part["roads"] if road in claim.deciding]
    by_road = {}
    for road in ROADS:
        verdicts = [part["roads"][road]["verdict"] for part in parts if road in part["roads"]]
        by_road[road] = combined(verdicts) if verdicts else None
    counted = [part for part, _ in deciding]
    both = {}
    if any(part["unit"] == "mm" for part in counted):
        both = {
            name: combined([
                answer["as"][name]["verdict"] if answer["as"] else answer["verdict"]
                for answer in (part["roads"][road] for part, road in deciding)
            ])
            for name in AMPLITUDES
        }  # fmt: skip
    return {
        "id": claim.id,
        "reading": reading,
        "statement": claim.statement,
        "published": claim.published,
        "computed": "; ".join(f"{part['part']} {part['roads'][road]['shown']}" for part, road in deciding),
        "verdict": combined([part["roads"][road]["verdict"] for part, road in deciding]),
        "amplitude": measure if both else "",
        "as": both,
        "tolerance": "; ".join(f"{part['part']} {part['tolerance']}" for part in counted),
        "reason": "; ".join(dict.fromkeys(part["reason"] for part in counted)),
        "deciding": list(claim.deciding),
        "roads": by_road,
        "parts": parts,
    }


def _part(part: ClaimPart, findings: Mapping[str, Any], claim: Claim, measure: str) -> Record:
    roads = {}
    for road in part.roads:
        finding = Finding(**findings[road][part.key])
        meant = {name: read_as(part, finding, halves) for name, halves in AMPLITUDES.items()}
        own = meant[measure]
        roads[road] = {
            "computed": own.value,
            "shown": shown(part, own.value),
            "verdict": judge(part, own),
            "as": {
                name: {"shown": shown(part, each.value), "verdict": judge(part, each)} for name, each in meant.items()
            }
            if part.is_amplitude
            else {},
            "note": finding.note,
            "trusted": finding.trusted,
        }
    return {
        "part": part.name,
        "meaning": f"{part.meaning} ({measure})" if part.is_amplitude else part.meaning,
        "published": part.published if part.published is True else float(part.published),
        "digits": "" if part.published is True else part.published,
        "unit": part.unit,
        "tolerance": part.tolerance,
        "reason": part.reason,
        "counts": any(road in claim.deciding for road in part.roads),
        "roads": roads,
    }


def _markdown(found: list[Record]) -> Iterator[str]:
    readings = list(dict.fromkeys(each["reading"] for each in found))
    numbers = count(found)
    yield f"# {paper()['title']}\n\n{paper()['source']}\n"
    yield f"{len(found)} verdicts: {', '.join(f'{number} {verdict}' for verdict, number in numbers.items())}.\n"
    once = overall(found)
    met = [each["id"] for each in once if each["verdict"] == AGREE]
    yield f"Each claim once, by its best reading: {len(met)} of {len(once)} met ({', '.join(met)}).\n"
    yield f"| claim | published | {' | '.join(readings)} |"
    yield "|---" * (2 + len(readings)) + "|"
    by_claim = {claim.id: [each for each in found if each["id"] == claim.id] for claim in claims()}
    for name, each in by_claim.items():
        cells = [f"**{record['verdict']}** ({record['computed']})" for record in each]
        yield f"| {name} | {each[0]['published']} | {' | '.join(cells)} |"
    for name, each in by_claim.items():
        yield f"\n## {name}\n\n{each[0]['statement']} Decided by: {' and '.join(each[0]['deciding'])}.\n"
        yield "| reading | part | published | tolerance | eigenvalues | raw | exact |\n|---|---|---|---|---|---|---|"
        for record in each:
            for part in record["parts"]:
                yield _markdown_row(record["reading"], part)


def _markdown_row(reading: str, part: Record) -> str:
    published = "yes" if part["published"] is True else f"{part['digits']} {part['unit']}".removesuffix(" -")
    cells = []
    for road in ROADS:
        answer = part["roads"].get(road)
        note = f" ({answer['note']})" if answer and answer["note"] else ""
        cells.append(f"{answer['verdict']}: {answer['shown']}{note}" if answer else "")
    tolerance = f"{part['tolerance']}: {part['reason']}"
    return f"| {reading} | {part['meaning']} | {published} | {tolerance} | {' | '.join(cells)} |"


def _finite(value: object) -> Any:
    if isinstance(value, dict):
        return {key: _finite(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_finite(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value

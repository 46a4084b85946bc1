"""The head of the page: what the paper shows and whether the program shows it, the tally, and each claim once."""

from collections.abc import Mapping
from typing import Any

from squealbox.papers.drum_brake_2011 import record
from squealbox.papers.drum_brake_2011.cases import AMPLITUDES, EIGENVALUES_ONLY, INFERRED
from squealbox.papers.drum_brake_2011.claims import AGREE, DISAGREE, EIGENVALUES, EXACT, RAW, UNDECIDED, claims
from squealbox.report import Cell, Section, Table, Text, Tiles

SIGNS = {AGREE: "✓", DISAGREE: "✗", UNDECIDED: "?"}
BEATING = 1500.0  # rad/s: lines closer than this beat within a tenth of the run
INFER = "*"  # beside an inferred reading

# A claim that no reading meets, and the theorem that says why: with which claims it cannot stand together.
EXCLUDED = {
    "mu-6": "mu-3: the trace argument, for any friction linear in mu",
    "mu-5": "N-2, once mu-3 holds: which mode grows, in the form of Eq. (3)",
    "V-1": "N-1: decay is affine in load, in the form of Eq. (3)",
}
Records = list[record.Record]


def blocks(found: Records, chance: float) -> tuple[Any, ...]:
    """The findings, the tally and the table of claims; `chance` is the share of scrambled numbers met as well."""
    once = record.overall(found)
    return (
        Section("What it shows, and whether this program shows it", (_findings(found),)),
        Section("Its fifteen claims, each once", (
            Text(
                f"{tally(found, once)} As many of the eight claims that eigenvalues decide are met for scrambled "
                f"numbers, by a search as wide, in {chance:.0%} of the cases."
            ),
            Tiles(_tiles(found, once)),
            _table(once),
            Section("By reading, with both measures of amplitude", (_by_reading(found),), folded=True),
        )),
    )  # fmt: skip


def every_number(found: Records) -> tuple[Section, ...]:
    """Each claim with all its numbers, folded; near the end of the page, because print unfolds them."""
    return tuple(
        Section(f"{each['id']}: {each['statement']}", _details(each["id"], found), folded=True)
        for each in record.overall(found)
    )


def tally(found: Records, once: Records) -> str:
    """The count of claims in words: by one reading, by some, excluded, open."""
    own = record.met_by_reading(found)
    most = max(own, key=lambda name: len(own[name]))
    met = [each["id"] for each in once if each["verdict"] == AGREE]
    excluded = [each["id"] for each in once if each["id"] not in met and each["id"] in EXCLUDED]
    rest = [each["id"] for each in once if each["id"] not in met + excluded]
    printed = {name: ids for name, ids in own.items() if name not in INFERRED}
    best = max(printed, key=lambda name: len(printed[name]))
    measures = "; ".join(
        f"{measure}: {len(record.met_by_reading(found, measure)[most])}" for measure in AMPLITUDES
    )  # fmt: skip
    inferred = (
        f" {shown_name(most)} is inferred from these numbers, so they are no test of it." if most in INFERRED else ""
    )
    return (
        f"{len(own[most])} of {len(once)} numbers by one reading ({shown_name(most)}; amplitudes read as {measures}), "
        f"{len(met)} by some reading ({', '.join(met)}), {len(excluded)} excluded by theorem beside claims "
        f"that are met ({', '.join(excluded) or 'none'}), the rest open ({', '.join(rest) or 'none'}).{inferred} "
        f"The best of the printed readings, {shown_name(best)}, meets {len(printed[best])}."
    )


def shown_name(reading: str) -> str:
    """A reading as the page writes it; an inferred one has a star."""
    return reading + (INFER if reading in INFERRED else "")


def _tiles(found: Records, once: Records) -> tuple[tuple[str, str, str], ...]:
    own = record.met_by_reading(found)
    most = max(own, key=lambda name: len(own[name]))
    met = sum(each["verdict"] == AGREE for each in once)
    excluded = sum(each["verdict"] != AGREE and each["id"] in EXCLUDED for each in once)
    return (
        (f"{len(own[most])} of {len(once)}", f"met by one reading, {shown_name(most)}", AGREE),
        (str(met), "met by some reading", AGREE),
        (str(excluded), "excluded by theorem", ""),
        (str(len(once) - met - excluded), "open", ""),
    )


def _part(found: Records, key: str, road: str) -> dict[str, Mapping[str, Any]]:
    """The answers to one part by reading."""
    claim, _, name = key.partition(".")
    return {
        each["reading"]: part["roads"][road]
        for each in found if each["id"] == claim
        for part in each["parts"] if part["part"] == name and road in part["roads"]
    }  # fmt: skip


def _by(readings: list[str], of: int) -> str:
    if not readings:
        return "by no reading"
    return f"by {len(readings)} of {of}: {', '.join(shown_name(name) for name in readings)}"


def _findings(found: Records) -> Table:
    """The qualitative findings; each is asked of every reading."""

    def yes(key: str, road: str = EIGENVALUES) -> set[str]:
        return {name for name, answer in _part(found, key, road).items() if answer["computed"] is True}

    beats = {n for n, a in _part(found, "mu-4.separation", RAW).items() if _finite(a) and a["computed"] < BEATING}
    low, high = (_part(found, f"mu-7.at_{mu}", EXACT) for mu in ("0.40", "0.50"))
    grows = {n for n in low if _finite(low[n]) and _finite(high[n]) and high[n]["computed"] > low[n]["computed"]}
    rows = (
        ("Friction alone makes the drum flutter: two modes meet, and one of them grows.", yes("mu-2.mechanism"), ""),
        ("The higher the friction, the faster it grows.", yes("mu-2.mechanism") & yes("q-2.grows"), ""),
        ("Just below the onset two close frequencies beat.", beats, ""),
        ("Past the onset motion grows into a limit cycle, larger with friction.",
         yes("mu-2.persists", EXACT) & grows, ""),
        ("High load sets off a second mechanism, fed by the negative slope, in one mode without coalescence.",
         yes("q-2.load") & yes("q-2.apart"), ""),
        ("A negative slope raises the critical friction of flutter.", yes("q-1.raises"), ""),
        ("A narrow part of the map of both centres of pressure is unstable.", yes("th-1.mostly_stable"),
         "at mu = 0.30; the inferred readings have theirs, at the published theta1, from 0.40 on"),
        ("Low speed sets the negative slope off.", yes("q-2.low_speed"), "see V-1 below: excluded beside N-1"),
    )  # fmt: skip
    every = {each["reading"] for each in found}
    order = list(dict.fromkeys(each["reading"] for each in found))
    table = []
    for what, by, note in rows:
        names = [name for name in order if name in by]
        answer = "yes" if names else "no"
        table.append(
            (what, Cell(answer, _by(names, len(every)) + (f"; {note}" if note else ""), AGREE if names else ""))
        )
    caption = (
        f"The findings the paper draws, in our words, asked of {len(every)} readings of its equations. {INFER}: "
        f"inferred from its numbers. {EIGENVALUES_ONLY}"
    )
    return Table(("finding of the paper", "shown here"), tuple(table), caption)


def _finite(answer: Mapping[str, Any]) -> bool:
    value = answer["computed"]
    return isinstance(value, float) and abs(value) < 1e9


def _table(once: Records) -> Table:
    """Two columns, so that a phone shows both: the claim, and what became of it."""
    rows = []
    for each in once:
        met = each["verdict"] == AGREE
        if met:
            state, why = "met", f"by {', '.join(shown_name(name) for name in each['agree'])}"
        elif each["id"] in EXCLUDED:
            state, why = "excluded", f"beside {EXCLUDED[each['id']]}"
        else:
            other = f"; {', '.join(each['otherwise'])} with the other measure of amplitude" if each["otherwise"] else ""
            state, why = "open", f"nearest: {shown_name(each['reading'])}{other}"
        what = each["computed"].replace("_", " ")
        measure = f", amplitudes {each['amplitude']}" if each["amplitude"] else ""
        told = f"computed {what}{measure}; {why}"
        claim = Cell(f"{each['id']}: {each['published']}", each["statement"])
        rows.append((claim, Cell(state, told, AGREE if met else "")))
    caption = (
        "By the best reading of each claim. A claim is met when all of its parts that count are. Every number, its "
        "tolerance and the reason of the tolerance stand claim by claim below the readings."
    )
    return Table(("claim", "what became of it"), tuple(rows), caption)


def _by_reading(found: Records) -> Table:
    own = record.met_by_reading(found)
    both = {measure: record.met_by_reading(found, measure) for measure in AMPLITUDES}
    measure_of = {each["reading"]: each["amplitude"] for each in found if each["amplitude"]}
    rows = tuple(
        (
            shown_name(name), f"{len(ids)}", ", ".join(ids) or "none", measure_of[name],
            *(f"{len(both[measure][name])}" for measure in AMPLITUDES),
        )
        for name, ids in own.items()
    )  # fmt: skip
    return Table(("reading", "met", "which", "amplitudes read as", *AMPLITUDES), rows, "Claims met, of fifteen.")


def _details(claim: str, found: Records) -> tuple[Any, ...]:
    """Each part of a claim: published, tolerance and reason, and every reading's answers."""
    mine = [each for each in found if each["id"] == claim]
    about = next(each for each in claims() if each.id == claim)
    tables: list[Any] = [Text(f"{about.statement} Decided by: {' and '.join(about.deciding)}.")]
    for i, part in enumerate(mine[0]["parts"]):
        published = "yes" if part["published"] is True else f"{part['digits']} {part['unit']}".removesuffix(" -")
        roads = list(part["roads"])
        rows: list[tuple[str | Cell, ...]] = []
        for each in mine:
            answers = [each["parts"][i]["roads"][road] for road in roads]
            rows.append((shown_name(each["reading"]), *(_answer(a) for a in answers)))
        meaning = about.parts[i].meaning
        judged = f"published {published}, tolerance {part['tolerance']} ({part['reason']})"
        caption = f"{meaning[0].upper()}{meaning[1:]}: {judged}."
        tables.append(Table(("reading", *roads), tuple(rows), caption))
    return tuple(tables)


def _answer(answer: Mapping[str, Any]) -> Cell:
    both = answer["as"]
    shown = " / ".join(f"{SIGNS[a['verdict']]} {a['shown']}" for a in both.values()) if both else ""
    note = "" if answer["trusted"] else "not to be trusted: "
    text = shown or f"{SIGNS[answer['verdict']]} {answer['shown']}"
    head = f"{' / '.join(both)}. " if both else ""
    return Cell(text, head + note + answer["note"], AGREE if answer["verdict"] == AGREE else "")

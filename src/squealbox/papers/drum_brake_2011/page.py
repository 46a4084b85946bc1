"""The one page of the study: findings, claims, why they are met or not, the figures, what is assumed, the search."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from squealbox.papers.drum_brake_2011 import page_claims, page_why, record, search_results
from squealbox.papers.drum_brake_2011.beside import Extras
from squealbox.papers.drum_brake_2011.cases import ALPHA, DEFAULT_READING, DURATION, PRINTED, RECONSTRUCTED, SPEED
from squealbox.papers.drum_brake_2011.claims import AGREE, EXACT, RAW, ROADS, paper
from squealbox.papers.drum_brake_2011.ensembles import COARSE, LEVEL, LONGER, MEANS
from squealbox.papers.drum_brake_2011.motions import METHODS
from squealbox.report import Cell, Code, Page, Picture, Points, Section, Table, Text

READING_MEANS = {
    "eq1_printed": "Eq. (1) as printed: friction along x proportional to x, along y to y",
    "eq3": "the linear form of Eq. (3): friction along x proportional to y and the other way round, slip taken as +",
    "eq3_signed": "the same with the sign of each sliding component: shoe 2 turns in x",
    "componentwise": "friction proportional to the whole spring compression, its sign by component",
    "consistent": "one contact a shoe, along its tangent, with the load in the contact: what a free-body diagram gives",
    PRINTED: "the matrices of Eq. (3) with their alpha terms, exactly as printed: linear, so eigenvalues only",
    "reconstructed": "inferred, not printed: signs +, - in both rows, N in friction; alpha and V_B fitted, amplitudes "
    "read peak to peak",
    "reconstructed_simple": "inferred, not printed: signs +, - in both rows, loads along the springs; round alpha and "
    "V_B, amplitudes read peak to peak",
}
CAPTIONS = {
    "fig1": "Fig. 1. The model, angles to scale. Eq. (1) has the loads along (sin, -cos), not along the springs.",
    "fig2": "Fig. 2. The friction law for three coefficients at rest. The slope is an assumption.",
    "fig3": "Fig. 3. Time series and spectra over the friction coefficient. Black: raw, as in the paper. Dotted: "
    "envelope of the exact motion; dashed: its spectrum. Pink: the published frequencies and amplitudes.",
    "fig4": "Fig. 4. Phase planes over the friction coefficient. Black: last cycles, raw. Dashed: last cycle, exact.",
    "fig5": "Fig. 5. Frequencies and growth rates over the friction coefficient. Stars: the published frequencies.",
    "fig6": "Fig. 6. Time series and spectra over the load. Black: raw; dotted and dashed: exact; pink: published.",
    "fig7": "Fig. 7. Phase planes over the load. Black: last cycles, raw. Dashed: last cycle, exact.",
    "fig8": "Fig. 8. Braking from 0.2 m/s to rest in 0.05 s. Grey: where the paper sees a constant amplitude. "
    "The kick at the end is the belt coming to rest.",
    "fig9": "Fig. 9. Growth rate over both centres of pressure in steps of 1 deg. Black: its boundary. "
    "Blue: the published unstable zone.",
    "maps_friction": "Friction with load and with speed. Left: growth rate by eigenvalues. Right: transients "
    "from rest; black line: the boundary by eigenvalues. Specks along it decay by less than 3.5 1/s, too slowly to be "
    "told from a cycle.",
    "maps_pressure": "Centres of pressure. Left: growth rate by eigenvalues. Right: transients from rest at the same "
    "points; black line: the boundary by eigenvalues; pink: the published zone.",
    "maxima": "The last eight maxima of x, less steady sliding, over the friction coefficient after 0.5 s; linear "
    "within 1 µm of zero. One mark a value of mu is a cycle of one maximum, several are a cycle of several or a motion "
    "that does not repeat; those that rise from zero right after the onset are still growing. Circles: from rest; "
    "dots: from 0.1 % beside steady sliding. Where they part, the start decides.",
}


def page(
    folder: Path,
    studies: Mapping[str, Any],
    found: list[record.Record],
    searched: Mapping[str, Any],
    more: Extras,
) -> Page:
    """The page of the study whose figures are in `folder`: findings first, then claims, why, figures, the rest."""
    default = studies[DEFAULT_READING]
    lead = (
        f"What the paper shows and whether this program shows it, for {len(studies)} readings of its contradictory "
        "equations; then its numbers, each beside what is computed, and why some cannot be met. Nothing was tuned to "
        "agree."
    )
    others = [name for name in studies if name not in (DEFAULT_READING, RECONSTRUCTED)]
    redrawn = _pictures(folder / RECONSTRUCTED, studies[RECONSTRUCTED]["figures"])
    return Page(
        title=paper()["title"],
        lead=f"{paper()['source']}. {lead}",
        sections=(
            Section("What the paper says", page_claims.blocks(found, more.short.chance)),
            Section("What no reading can meet", page_why.excluded(folder)),
            Section("The reconstruction", page_why.reconstruction(
                more, record.met_by_reading(found)[RECONSTRUCTED], redrawn
            )),
            Section("What the solver of 2011 did", (
                *page_why.solver(folder, more),
                Section("Raw and exact runs of this study", _raw_and_exact(studies, found), folded=True),
            )),
            Section("The readings", (_readings(list(studies), found),)),
            Section(f"Reading {DEFAULT_READING} (the default of DrumBrake)",
                    _reading(DEFAULT_READING, default, found, folder)),
            Section("The other readings", tuple(
                Section(page_claims.shown_name(name), _reading(name, studies[name], found, folder / name), folded=True)
                for name in (*others, RECONSTRUCTED)
            )),
            Section("Every number, its tolerance and why", page_claims.every_number(found)),
            Section("Assumptions and contradictions", _assumptions()),
            Section("Model and friction law", (_picture(folder, "fig1"), _picture(folder, "fig2"))),
            *_choices(folder, searched),
            Section("Run it again", _again()),
        ),
        footer=f"Made by {', '.join(f'{name} {version}' for name, version in record.versions().items())}.",
    )  # fmt: skip


def _choices(folder: Path, searched: Mapping[str, Any]) -> tuple[Section, ...]:
    """The search over alpha, speed and floor in every reading, where it was made."""
    if not searched:
        return ()
    return (Section("Which choices meet which claims", search_results.blocks(folder, searched)),)


def _readings(readings: list[str], found: list[record.Record]) -> Table:
    rows = (_reading_row(reading, [each for each in found if each["reading"] == reading]) for reading in readings)
    head = ("reading", "agree", "disagree", "not decidable", "parts that agree")
    return Table(head, tuple(rows), "*: inferred from the paper's numbers, not printed.")


def _reading_row(reading: str, found: list[record.Record]) -> tuple[str | Cell, ...]:
    numbers = record.count(found)
    verdicts = [
        part["roads"][road]["verdict"]
        for each in found for part in each["parts"] for road in part["roads"] if road in each["deciding"]
    ]  # fmt: skip
    parts = f"{verdicts.count(AGREE)} of {len(verdicts)}"
    return (
        Cell(page_claims.shown_name(reading), READING_MEANS[reading]),
        *(str(number) for number in numbers.values()),
        parts,
    )


def _raw_and_exact(studies: Mapping[str, Any], found: list[record.Record]) -> tuple[Any, ...]:
    rows = []
    for each in found:
        for part in each["parts"]:
            raw, exact = part["roads"].get(RAW), part["roads"].get(EXACT)
            if raw and exact and (raw["verdict"] != exact["verdict"] or not raw["trusted"]):
                what = Cell(f"{each['id']} {part['part']}".replace("_", " "), part["meaning"])
                rows.append((what, each["reading"], _answer(raw), _answer(exact)))
    intro = (
        "Raw runs integrate sgn() as it stands, as in 2011; exact runs locate each stick, slip and reversal. A raw "
        "run tells something else when its verdict is another one, or the amplitude of what persists is more than 5 % "
        "off; it is then marked as not to be trusted wherever it is used. The tolerance of 1e-3 damps: raw motions "
        "that decay do so faster than the equation says."
    )
    summary = Table(
        ("reading", "runs that tell something else", "decay rate, raw over exact", "steps, raw", "steps, exact"),
        tuple(_raw_summary(reading, study["runs"]) for reading, study in studies.items() if study["runs"]),
        "Raw beside exact, over all runs of a reading: least to greatest.",
    )
    if not rows:
        return (Text(intro), summary, Text("No verdict on a claim depends on it."))
    caption = "Parts of claims whose verdict changes, or whose raw value is not to be trusted."
    return (Text(intro), summary, Table(("part of a claim", "reading", "raw", "exact"), tuple(rows), caption))


def _raw_summary(reading: str, runs: list[dict[str, Any]]) -> tuple[str | Cell, ...]:
    doubtful = [run["run"] for run in runs if run["doubt"]]
    decaying = [run for run in runs if run[RAW]["verdict"] == run[EXACT]["verdict"] == "decays"]
    rates = [run[RAW]["growth_rate"] / run[EXACT]["growth_rate"] for run in decaying]
    steps = [
        f"{min(counts)} to {max(counts)}" for counts in ([run[road]["steps"] for run in runs] for road in (RAW, EXACT))
    ]
    return (
        reading,
        Cell(f"{len(doubtful)} of {len(runs)}", ", ".join(doubtful)),
        f"{min(rates):.2f} to {max(rates):.2f}" if rates else "nothing decays",
        *steps,
    )


def _answer(answer: Mapping[str, Any] | None) -> Cell:
    if answer is None:
        return Cell("")
    note = answer["note"] if answer["trusted"] else f"not to be trusted: {answer['note']}"
    mark = AGREE if answer["verdict"] == AGREE else ""
    return Cell(f"{page_claims.SIGNS[answer['verdict']]} {answer['shown']}", note, mark)


def _assumptions() -> tuple[Any, ...]:
    return (
        Section("Assumed", (Points(tuple(paper()["assumptions"])),)),
        Section("Where the paper contradicts itself", (Points(tuple(paper()["contradictions"])),)),
    )


def _reading(name: str, study: Mapping[str, Any], found: list[record.Record], folder: Path) -> tuple[Any, ...]:
    rows = []
    for each in (each for each in found if each["reading"] == name):
        for part in each["parts"]:
            published = "yes" if part["published"] is True else f"{part['digits']} {part['unit']}".removesuffix(" -")
            what = Cell(f"{each['id']} {part['part']}".replace("_", " "), part["meaning"])
            by_road = [_answer(part["roads"].get(road)) for road in ROADS]
            rows.append((what, Cell(published, _why(part)), *by_road))
    head = ("part of a claim", "published, tolerance", "eigenvalues", "raw (as in 2011)", "exact")
    pictures = _pictures(folder, study["figures"]) if name != RECONSTRUCTED else ()  # they stand above
    table = Section("All numbers", (Table(head, tuple(rows)),), folded=True)
    runs = (Section("All runs, raw beside exact", (_runs(study["runs"]),), folded=True),) if study["runs"] else ()
    shares = _shares(study.get("shares", []))
    return (Text(f"{READING_MEANS[name][0].upper()}{READING_MEANS[name][1:]}."), table, *runs, *pictures, *shares)


def _shares(maps: list[dict[str, Any]]) -> tuple[Any, ...]:
    """What the maps by transients are made of, and why they differ from those by eigenvalues."""
    if not maps:
        return ()
    rows: tuple[tuple[str | Cell, ...], ...] = tuple(
        (Cell(each["map"], f"{each['run']:,} of {each['points']:,} run"), *(f"{share:.2%}" for share in each["shares"]))
        for each in maps
    )
    caption = (
        f"Maps by transients: share of each kind. Every {COARSE}th value of both axes is run, and in between wherever "
        "neighbours differ or the eigenvalues change sign; the rest is as its neighbours are. A trajectory starts from "
        f"rest and squeals when, over the last fifth of {1e3 * DURATION:g} ms, the speed of its vibration (2 pi times "
        f"frequency times amplitude) is above {LEVEL:g} V_B. Where that differs from the eigenvalues it goes on to "
        f"{1e3 * LONGER:g} ms. What holds its level is a cycle beside stable sliding: the step load from rest reaches "
        "it, and an eigenvalue cannot see it. What has fallen was still ringing: 50 ms are too short to tell. "
        "Unstable, yet quiet: it grows so slowly that the longer run is too short as well. Not decided: the trajectory "
        "hung where contacts stick and slip without end, and was stopped."
    )
    return (Table(("map", *MEANS), rows, caption),)


def _why(part: record.Record) -> str:
    """The tolerance and its reason; a statement needs no tolerance."""
    return str(part["reason"]) if part["published"] is True else f"{part['tolerance']}: {part['reason']}"


def _runs(runs: list[dict[str, Any]]) -> Table:
    rows = tuple(
        (
            run["run"],
            *(Cell(f"{run[road]['verdict']}, {run[road]['amplitude']:.3g} mm") for road in (RAW, EXACT)),
            Cell(f"{run['distance']:.2g}", run["doubt"]),
            f"{run[RAW]['steps']}",
            f"{run[EXACT]['steps']}",
            f"{run[EXACT]['events']}",
        )
        for run in runs
    )
    head = ("run", "raw", "exact", "distance", "raw steps", "exact steps", "exact events")
    return Table(
        head, rows, "Distance: largest |x raw - x exact| over half the range of x. A cycle out of phase gives 2."
    )


def _again() -> tuple[Any, ...]:
    methods = [f"{road}: {method.tableau}, relative tolerance {method.rtol:g}" for road, method in METHODS.items()]
    return (
        Code("squealbox paper drum-brake-2011 --out DIR\nsquealbox paper drum-brake-2011 --out DIR --search"),
        Code('from squealbox.papers.drum_brake_2011 import reproduce\n\nreproduce("DIR")'),
        Text(
            "DIR then holds this page, claims.json, claims.md, and the figures in figures/; with "
            "--search also search.csv. "
            f"Assumed for the printed readings: alpha = {ALPHA:g} s/m, V_B = {SPEED:g} m/s. Transients: "
            f"{'; '.join(methods)}."
        ),
    )


def _pictures(folder: Path, names: list[str]) -> tuple[Picture, ...]:
    return tuple(_picture(folder, name) for name in names)


def _picture(folder: Path, name: str) -> Picture:
    return Picture(folder / f"{name}.png", CAPTIONS[name])

"""Tables of a report: parameters, contacts, modes, sensitivity, energy, claims of how each computation ended."""

from typing import Any

import numpy as np

from squealbox.plots import parameter_rows, shown
from squealbox.remedies import Remedies
from squealbox.report.blocks import Cell, Table
from squealbox.report.examination import Examination, results_of
from squealbox.report.words import in_reading_unit, quantity
from squealbox.stability import ComplexModes, ModeEnergy, Sensitivity, contact_groups
from squealbox.system import Equilibrium, System, equilibrium
from squealbox.words import number, plain_unit

MOST_MODES = 12
MOST_PARAMETERS = 10
MOST_CURES = 8
MOST_CONTACTS = 24  # told one by one
ALIKE = 0.05  # MAC from which a mode without friction is named


def parameters(found: Examination) -> Table:
    """Every parameter with value, range, meaning and source."""
    rows = tuple(
        (name, value, limits, meaning, source or "not given") for name, value, limits, meaning, source in
        parameter_rows(found.shown)
    )  # fmt: skip
    return Table(("parameter", "value", "may be", "meaning", "source"), rows)


def contacts(system: System, time: float) -> Table:
    """What each contact carries in steady sliding, and its law."""
    state = equilibrium(system, time)
    if len(system.contacts) > MOST_CONTACTS and state.exists:
        return _many_contacts(system, state)
    rows = []
    for i, contact in enumerate(system.contacts):
        numbers = ("not known",) * 3
        slope = "not known"
        if state.exists:
            speed = float(state.sliding_speed[i])
            force = quantity(state.normal_force[i], "N")
            numbers = (force, quantity(speed, "m/s"), number(float(state.friction[i]), 5))
            slope = f"{number(float(contact.law.slope_at(speed)), 4)} s/m"
        kind = "unilateral" if contact.unilateral else "always closed"
        rows.append((system.contact_names[i], *numbers, slope, type(contact.law).__name__, kind))
    head = ("contact", "normal force", "sliding speed", "friction coefficient", "its slope", "law", "")
    return Table(head, tuple(rows), "Contacts in steady sliding. A negative normal force pulls: the model then lies.")


def _many_contacts(system: System, state: Equilibrium) -> Table:
    """Contacts by their name without its number, each group in one row."""
    rows = []
    for name, at in contact_groups(system.contact_names).items():
        speed, mu = np.abs(state.sliding_speed[at]), state.friction[at]
        rows.append((
            name, str(len(at)), str(int(np.sum(state.normal_force[at] <= 0.0))),
            quantity(np.sum(state.normal_force[at]), "N", 4), quantity(np.max(state.normal_force[at]), "N", 3),
            f"{number(np.min(speed), 3)} to {number(np.max(speed), 3)} m/s",
            number(mu[0], 4) if np.ptp(mu) < 1e-9 else f"{number(np.min(mu), 4)} to {number(np.max(mu), 4)}",
            type(system.contacts[at[0]].law).__name__,
        ))  # fmt: skip
    head = ("contacts", "points", "lifted off", "normal force", "largest", "sliding speed", "friction", "law")
    return Table(head, tuple(rows), "Contacts in steady sliding, in groups.")


def modes_in_band(table: dict[str, Any]) -> Table:
    """Modes of a finite-element brake: error bars, other codes' numbers, who moves, of which modes without friction."""
    growth, error = table["growth rate [1/s]"], table["error [1/s]"]
    damping = table["damping ratio [-]"]
    order = np.argsort(damping, kind="stable")[: max(MOST_MODES, int(np.sum(growth > -error)))]
    rows = []
    for i in order:
        grows, known = growth[i] > 0.0, abs(growth[i]) > error[i]
        moves = [(name[9:-4], table[name][i]) for name in table if name.startswith("share of")]
        likes = [
            f"{table[f'MAC {k} [-]'][i]:.2f} to that at {quantity(table[f'of mode at mu = 0 {k} [Hz]'][i], 'Hz', 5)}"
            for k in (1, 2)
            if table[f"MAC {k} [-]"][i] > ALIKE
        ] or ["to none"]
        rows.append((
            str(int(table["mode"][i])), quantity(table["frequency [Hz]"][i], "Hz", 6),
            Cell(f"{number(growth[i], 5)} 1/s", f"± {number(error[i], 2)} 1/s"),
            Cell(
                f"{number(100.0 * damping[i], 4)} %",
                f"Abaqus {number(table['Abaqus damping ratio [-]'][i], 4)}\n"
                f"Ansys {number(table['Ansys stability [Hz]'][i], 4)} Hz",
            ),
            Cell(", ".join(f"{name} {100.0 * share:.0f} %" for name, share in moves) or "not known"),
            Cell(*[*likes, ""][:2]),
            Cell(
                ("grows" if grows else "decays") if known else "not decided", "" if known else "within its error bar",
                ("unstable" if grows else "stable") if known else "not-decidable",
            ),
        ))  # fmt: skip
    left = f" The first {len(rows)} of {len(growth)}." if len(rows) < len(growth) else ""
    said = "Modes of the whole brake in the band, least damped first. Moves: kinetic energy. MAC: likeness to the "
    head = ("mode", "frequency", "growth rate", "damping ratio", "moves", "MAC", "")
    return Table(head, tuple(rows), f"{said}modes without friction.{left}")


def modes(spectrum: ComplexModes) -> Table:
    """Frequency, growth rate and damping ratio of each mode, the least damped first."""
    half = spectrum.eigenvalues.shape[-1] // 2
    order = np.argsort(-spectrum.growth_rate[:half], kind="stable")[:MOST_MODES]
    rows = []
    for i in order:
        grows = spectrum.growth_rate[i] > 0.0 and not bool(spectrum.stable)
        remark = "two modes nearly merge" if spectrum.condition[i] > 1e6 else ""
        rows.append((
            str(int(i) + 1), quantity(spectrum.frequency[i], "Hz", 6), f"{number(spectrum.growth_rate[i], 5)} 1/s",
            f"{number(100.0 * spectrum.damping_ratio[i], 4)} %",
            Cell("grows" if grows else "decays", remark, "unstable" if grows else "stable"),
        ))  # fmt: skip
    left = f" The first {MOST_MODES} of {half}." if half > MOST_MODES else ""
    return Table(
        ("mode", "frequency", "growth rate", "damping ratio", ""), tuple(rows), f"Modes, least damped first.{left}"
    )


def ranking(found: Examination, ranked: Sensitivity) -> Table:
    """Which parameter changes the growth rate most, for one per cent more of it."""
    rows = []
    turn = np.sign(np.imag(ranked.eigenvalue)) / (2.0 * np.pi)
    for name, change in ranked.ranked()[:MOST_PARAMETERS]:
        i = ranked.parameters.index(name)
        factor, unit = in_reading_unit(found, name)
        hertz = 0.01 * ranked.values[i] * turn * np.imag(ranked.first[i])
        better = "less of it" if change > 0.0 else "more of it" if change < 0.0 else "no effect"
        value = f"{number(factor * ranked.values[i], 6)} {unit}".rstrip()
        rows.append((name, value, f"{number(0.01 * change, 4)} 1/s", f"{number(hertz, 4)} Hz", better))
    head = ("parameter", "value", "growth rate, for +1 %", "frequency, for +1 %", "quieter with")
    return Table(head, tuple(rows), "To first order, of the worst mode, the strongest first.")


def energy(fed: ModeEnergy) -> Table:
    """What each contact and damper adds to the growth rate, and the work in one cycle."""
    per = 1.0 / (2.0 * fed.total)
    rows = [
        (name, f"{number(fed.circulation[i] * per, 4)} 1/s", f"{number(fed.slope[i] * per, 4)} 1/s",
         "" if np.isnan(fed.phase[i]) else f"{number(np.rad2deg(fed.phase[i]), 4)}°",
         f"{number(fed.work_per_cycle[i] / fed.total, 3)}")
        for i, name in enumerate(fed.contacts)
    ]  # fmt: skip
    rows += [
        (f"friction of {name} across its sliding", f"{number(-fed.across[i] * per, 4)} 1/s", "", "", "")
        for i, name in enumerate(fed.contacts) if fed.across[i] != 0.0
    ]  # fmt: skip
    rows += [
        (f"damping of {name}", f"{number(-fed.dissipated[i] * per, 4)} 1/s", "", "",
         f"{number(-fed.dissipated_per_cycle[i] / fed.total, 3)}")
        for i, name in enumerate(fed.dofs)
    ]  # fmt: skip
    head = ("", "by normal force, or damping", "by slope of friction", "phase of normal force", "work a cycle / energy")
    said = f"What feeds and damps the worst mode; the sum is its growth rate, {number(fed.growth_rate, 5)} 1/s."
    return Table(head, tuple(rows), said)


def cures(found: Remedies) -> Table:
    """The best cures: dose, what is left of the squeal, cost and what to know before."""
    rows = []
    for i in range(min(len(found), MOST_CURES)):
        dose, unit = found.dose_as_read(i)
        left = "not known" if np.isnan(found.amplitude[i]) else quantity(found.amplitude[i], "m", 2)
        mark = "stable" if found.reached[i] else "not-decidable"
        rows.append((
            Cell(str(found.name[i]), str(found.caution[i])),
            f"{number(dose, 3)} {plain_unit(unit)}".strip(),
            f"{number(found.growth[i], 3)} 1/s", Cell(f"{number(100.0 * found.probability[i], 3)} %", mark=mark), left,
            str(found.cost[i]),
        ))  # fmt: skip
    head = ("cure", "dose", "growth rate", "lot that squeals", "after a push", "cost")
    before = f"Without: {number(found.growth_before, 3)} 1/s, {number(100.0 * found.before, 3)} % of the lot squeals."
    said = (
        f"The best {len(rows)} of {len(found)}, quiet up to {number(100.0 * found.margin, 3)} % more friction. {before}"
    )
    return Table(head, tuple(rows), said)


def endings(found: Examination) -> Table:
    """How each computation ended, and with which settings."""
    rows = []
    for result in results_of(found):
        settings = ", ".join(f"{name} = {_short(value)}" for name, value in result.settings.items())
        mark = "stable" if result.outcome.ok else "not-decidable"
        rows.append(
            (type(result).__name__, Cell(str(result.outcome), result.outcome.message, mark), settings or "usual")
        )
    rows += [(name, Cell("not computed", why, "not-decidable"), "") for name, why in found.missing.items()]
    return Table(("result", "ended", "settings"), tuple(rows))


def _short(value: object) -> str:
    text = shown(value, 4) if isinstance(value, float) else str(value)
    return text if len(text) <= 40 else f"{text[:37]}..."

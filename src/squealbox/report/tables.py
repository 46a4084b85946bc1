"""Tables of a report: parameters, contacts, modes, sensitivity, energy, claims of how each computation ended."""

import numpy as np

from squealbox.plots.cards import parameter_rows
from squealbox.plots.facts import shown
from squealbox.remedies import Remedies
from squealbox.report.blocks import Cell, Table
from squealbox.report.examination import Examination, results_of
from squealbox.report.words import in_reading_unit, quantity
from squealbox.stability import ComplexModes, ModeEnergy, Sensitivity
from squealbox.system import System, equilibrium
from squealbox.words import number, plain_unit

MOST_MODES = 12
MOST_PARAMETERS = 10
MOST_CURES = 8


def parameters(found: Examination) -> Table:
    """Every parameter with value, range, meaning and source."""
    rows = tuple(
        (name, value, limits, meaning, source or "not given") for name, value, limits, meaning, source in
        parameter_rows(found.design)
    )  # fmt: skip
    return Table(("parameter", "value", "may be", "meaning", "source"), rows)


def contacts(system: System, time: float) -> Table:
    """What each contact carries in steady sliding, and its law."""
    state = equilibrium(system, time)
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
         f"{number(np.rad2deg(fed.phase[i]), 4)}°", f"{number(fed.work_per_cycle[i] / fed.total, 3)}")
        for i, name in enumerate(fed.contacts)
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

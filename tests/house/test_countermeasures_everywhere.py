"""Every countermeasure goes where a design goes: files, arrays, drawings, the command line; remedies are reproduced."""

import html
import re

import numpy as np
import pytest

from squealbox import (
    PID,
    ActiveForce,
    AddedDamping,
    AddedMass,
    AddedStiffness,
    Asymmetry,
    Controlled,
    Coulomb,
    DelayedFeedback,
    Dithered,
    DrumBrake,
    LayerDamping,
    LinearSlope,
    LuGre,
    ModeCoupling,
    NormalDither,
    Scatter,
    Shim,
    StateFeedback,
    TunedMass,
    best_absorber,
    closed_loop,
    complex_modes,
    plot,
    read_design,
    silence,
    write_design,
)
from squealbox.cli import main
from squealbox.cli.inputs import changed
from squealbox.countermeasures import COUNTERMEASURES
from squealbox.countermeasures.best import _tuned
from squealbox.designs import DESIGNS
from squealbox.files import json_schema, read_text
from squealbox.files.writing import cure_text, design_text
from squealbox.loops import LOOPS
from squealbox.parameters import from_plain, to_plain
from squealbox.plots import loop_locus, nyquist_curve
from squealbox.remedies import Candidate, candidates_for
from squealbox.remedies.candidates import more_friction
from squealbox.report.blocks import Table
from squealbox.report.page import render
from squealbox.report.results import result_page
from squealbox.result import Result
from squealbox.stability import growth_about, growth_of
from squealbox.studies import Normal
from squealbox.system import as_system

DRUM = DrumBrake(friction=LinearSlope(0.36, -0.05))
CASES = [
    TunedMass(DRUM, "y", 0.05, 1906.0, 0.013),
    AddedMass(DRUM, "y", 0.1),
    AddedStiffness(DRUM, "x", 1e6, "y"),
    AddedDamping(DRUM, "x", 100.0),
    Shim(DRUM, "shoe 1", 2e9, 0.3),
    LayerDamping(DRUM, "y", 0.5, 1.0),
    Asymmetry(DRUM, "x", "y", 1e5),
    Dithered(DRUM, 0.3),
    NormalDither(DRUM, 0.2),
    Controlled(TunedMass(DRUM, "y", 0.05, 1906.0), [
        ActiveForce(0.1, 5e-5, PID(on="y", proportional=10.0)),
        PID(on="x", derivative=3.0, limit=80.0, delay=2e-5, sampling=5e4),
        StateFeedback(on="x", velocity=(1.0, 2.0)),
        DelayedFeedback(on="y", derivative=2.0, delay=1e-5),
    ]),
]  # fmt: skip
SCATTER = Scatter({"friction.static": Normal(0.36, 0.03), "k3": Normal(19e7, 5e6)})


def named(case):
    return type(case).__name__


def test_every_kind_has_a_case():
    assert {*map(type, CASES)} == {*COUNTERMEASURES.values(), Controlled}
    assert {type(loop) for loop in CASES[-1].loops} == set(LOOPS.values())


@pytest.mark.parametrize("case", CASES, ids=named)
def test_it_survives_its_file_and_plain_data(case, tmp_path):
    assert read_design(write_design(case, tmp_path / "brake.toml")) == case
    assert from_plain(to_plain(case)) == case
    assert case == case.replace()
    assert hash(case) == hash(case.replace())


@pytest.mark.parametrize("case", CASES, ids=named)
def test_it_is_drawn_as_the_brake_it_holds(case):
    assert plot(case).axes[0].get_title()


@pytest.mark.parametrize("case", CASES[:-2], ids=named)
def test_it_takes_arrays(case):
    static = np.array([0.3, 0.36])
    together = growth_of(case.replace({"friction.static": static}))
    alone = [float(complex_modes(case.replace({"friction.static": s})).largest_growth_rate) for s in static]
    assert together == pytest.approx(alone, rel=1e-8)


def test_the_schema_knows_both_sections():
    brakes = json_schema()["oneOf"]
    assert all({"countermeasures", "loops"} <= set(brake["properties"]) for brake in brakes)


@pytest.fixture(scope="module")
def table():
    return silence(DRUM, SCATTER, samples=128, push=0.0)


def test_remedies_are_many_ranked_and_reproduced_by_their_line(table):
    assert len(table) >= 15
    assert np.all(np.diff(table.probability) >= 0.0)
    for row in range(len(table)):
        assert growth_of(table.design(row)) == pytest.approx(float(table.growth[row]), rel=1e-9, abs=1e-9)
        if table.reached[row]:
            assert table.growth_at_margin[row] <= 1e-9
        if table.growth[row] <= 0.0 and table.probability[row] > 0.5:
            assert "stable as drawn" in table.caution[row]


def test_the_table_is_read_without_a_key(table):
    """Angles in degrees, no unit of a pure number, no amplitude of 1e-13 um, and what never helps named in one line."""
    text = table.summary(len(table))
    assert " rad" not in text
    assert not re.search(r"\d - |  makes", text)
    assert "at mu +10 %" in text
    (loud,) = [line for line in text.splitlines() if line.startswith("no dose that was tried makes it quiet with 10 %")]
    never = [str(table.name[i]) for i in range(len(table)) if not table.reached[i]]
    assert never
    assert sorted(loud.partition(": ")[2].split(", ")) == sorted(never)
    row = next(i for i in range(len(table)) if table.unit[i] == "rad")
    assert table.rows()[row][1] == f"{np.rad2deg(table.dose[row]):.4g} deg"


def test_dampers_need_the_dose_that_is_known(table):
    row = next(i for i in range(len(table)) if str(table.name[i]).startswith("dampers on"))
    assert float(table.dose[row]) == pytest.approx(1983.0, abs=1.0)


def test_results_survive_their_files(table, tmp_path):
    for found in (table, best_absorber(DRUM, "y", 0.05), closed_loop(CASES[-1].replace({"loops.1.sampling": None}))):
        back = Result.load(found.save(tmp_path / "result.nc"))
        assert type(back) is type(found)
        assert plot(found).axes


def test_commands(tmp_path, capsys):
    path = write_design(Controlled(DRUM, [PID(on=name, derivative=2e3) for name in "xy"]), tmp_path / "loop.toml")
    assert main(["loop", str(path), "--out", str(tmp_path / "loop")]) == 0
    assert "delay margin 7.58569e-05 s" in capsys.readouterr().out
    plain = write_design(DRUM, tmp_path / "drum.toml")
    assert main(["dither", str(plain), "--velocity", "0.21", "0.4", "--points", "3"]) == 0
    assert "Caution" in capsys.readouterr().out
    assert main(["absorber", str(plain), "--on", "y", "--mass", "50 g", "--out", str(tmp_path / "absorber")]) == 0
    assert "tune to" in capsys.readouterr().out
    assert read_design(tmp_path / "absorber" / "with_absorber.toml").mass == 0.05
    for name in (*COUNTERMEASURES, *LOOPS, "reduced"):
        assert main(["list", name]) == 0
        assert f"{name}: " in capsys.readouterr().out
    assert main(["silence", str(plain), "--samples", "0"]) == 2
    assert "--samples 0" in capsys.readouterr().err


def test_cures_that_are_other_values_say_which(table):
    for row in range(len(table)):
        if table.values[row]:
            assert DRUM.replace(table.values[row]) == table.design(row)
        else:
            assert not str(table.line[row]).startswith("brake.replace")
    assert sum(map(bool, table.values)) >= 5


def test_the_lines_of_a_cure_in_a_file_make_it(table):
    """What `silence` says for a file, pasted behind the brake or given by --set, is the brake of the table's row."""
    whole, told = design_text(DRUM), 0
    for row in range(len(table)):
        lines = cure_text(table.design(row), DRUM, table.values[row])
        if table.values[row]:
            cured = changed(DRUM, lines.replace('"', "").splitlines())
        else:
            assert lines.startswith(("[[countermeasures]]\nkind = ", "[[loops]]\nkind = "))
            cured = read_text(f"{whole}\n{lines}", "brake.toml").design
            told += 1
        assert float(growth_of(cured)) == pytest.approx(float(table.growth[row]), rel=1e-9, abs=1e-6)
    assert told > 10


def test_the_lines_of_a_cure_of_a_cured_brake_are_the_new_ones():
    brake = TunedMass(DRUM, "y", 0.05, 1906.0, 0.013)
    cured = AddedDamping(AddedMass(brake, "x", 0.1), "x", 7.0)
    lines = cure_text(cured, brake)
    assert lines.count("[[countermeasures]]") == 2
    assert "tuned_mass" not in lines
    assert read_text(f"{design_text(brake)}\n{lines}", "brake.toml").design == cured


@pytest.mark.parametrize("kind", ["block_chain", "pad_on_disc", "drum_brake_shoes"])
def test_every_kind_of_brake_has_its_table(kind):
    """Several contacts of one law, a law with a floor, a design whose own rules refuse some doses."""
    brake = DESIGNS[kind]()
    chosen = candidates_for(brake, more_friction(brake, 1.1))
    wanted = ("inertia", "friction", "tangential", "layer")
    few = [each for each in chosen if each.name.startswith(wanted)][:6]
    found = silence(brake, None, few, samples=32, push=0.0)
    assert len(chosen) >= 15
    assert len(found) >= 2
    assert np.all(np.isfinite(found.growth))


def test_scatter_of_the_brake_is_not_that_of_its_cure():
    """The brake has a tuned mass, whose mass scatters; a cure that is a mass has a field of that name as well."""
    brake = TunedMass(ModeCoupling(friction=Coulomb(1.05)), "x", 0.05, np.sqrt(2.0) / (2.0 * np.pi))
    scatter = Scatter({"mass": Normal(0.05, 0.008)})
    cure = Candidate(
        "mass", lambda dose: AddedMass(brake, "y", dose), np.array([0.01]), "kg",
        lambda dose: f"AddedMass(brake, 'y', {dose!r})", lambda dose: "weight",
    )  # fmt: skip
    found = silence(brake, scatter, [cure], margin=0.0, samples=256, push=0.0)
    lot = scatter.sample(256, seed=0)["mass"]
    share = np.mean(growth_of(AddedMass(brake.replace({"mass": lot}), "y", 0.01)) > 0.0)
    wrong = np.mean(growth_of(AddedMass(brake, "y", lot)) > 0.0)
    assert float(found.probability[0]) == share != wrong


@pytest.mark.parametrize("brake", [DRUM, ModeCoupling(friction=Coulomb(1.2))], ids=["drum", "coupling"])
def test_the_absorber_of_the_table_is_the_best_absorber(brake):
    """One mass at one place has one best tuning, whichever command is asked: `silence` and `absorber` agree."""
    chosen = [each for each in candidates_for(brake, more_friction(brake, 1.1)) if " g on " in each.name]
    found = silence(brake, None, chosen, samples=16, push=0.0)
    for row in range(len(found)):
        cured = found.design(row)
        best = best_absorber(brake, cured.on, cured.mass)
        assert (cured.frequency, cured.damping) == (float(best.frequency), float(best.damping))
        # of the value 1e-6 is left: where two modes meet `best` tells their mean, and eigenvalues are known to a root
        assert float(found.growth[row]) == pytest.approx(float(best.value), rel=1e-4, abs=1e-6)


def test_an_absorber_that_is_best_without_damping_has_none():
    """A light absorber on strong flutter: the search once ran off towards damping of 1e-15, and then out of range."""
    best = best_absorber(DrumBrake(friction=LinearSlope(0.45, -0.01)), "x", 0.02)
    assert float(best.damping) == 0.0
    more = [float(growth_of(best.design.replace(damping=z))) for z in (0.0, 1e-4, 1e-3, 1e-2)]
    assert more == sorted(more)


@pytest.mark.parametrize("change", [{}, {"loops.0.delay": 1e-5}, {"loops.0.sampling": 5e4, "loops.1.sampling": 5e4}])
def test_figures_of_a_loop(change):
    closed = closed_loop(Controlled(DRUM, [PID(on=name, derivative=2000.0) for name in "xy"]).replace(change))
    curve = nyquist_curve(closed).axes[0]
    assert curve.get_xlabel() == "real part of -L"
    nearest = min(np.min(np.hypot(line.get_xdata() + 1.0, line.get_ydata())) for line in curve.lines[:1])
    assert nearest > 0.1  # a stable loop keeps away from -1
    locus = loop_locus(closed).axes[0]
    assert ("without delay" in locus.get_title()) == bool(change)


def test_the_least_squeal_is_a_share_and_no_worse_than_a_grid():
    brake = ModeCoupling(c1=0.02, c2=0.02, friction=Coulomb(1.1))
    scatter = Scatter({"friction.static": Normal(1.1, 0.08), "k11": Normal(2.0, 0.04)})
    best = best_absorber(brake, "x", 0.05, "probability", scatter, samples=64)
    lot, centre = scatter.sample(64, seed=0), np.sqrt(2.0) / (2.0 * np.pi)

    def share(frequency, damping):
        return float(np.mean(growth_of(TunedMass(brake, "x", 0.05, frequency, damping).replace(lot)) > 0.0))

    assert float(best.value) == share(float(best.frequency), float(best.damping))
    grid = [share(centre * f, z) for f in np.linspace(0.85, 1.15, 14) for z in np.geomspace(1e-3, 0.2, 10)]
    assert float(best.value) <= min(grid) < float(best.before)


def test_cures_have_a_page_of_their_own(table):
    page = result_page(table)
    cells = [block for block in page.sections[0].blocks if isinstance(block, Table)]
    assert len(cells[0].rows) == len(table)
    assert str(table.line[0]) in html.unescape(render(page))
    dithered = [i for i in range(len(table)) if "Dithered" in str(table.line[i])]
    assert len(dithered) >= 2
    assert all("mean friction left" in str(table.caution[i]) for i in dithered)


@pytest.mark.parametrize(
    "brake",
    [
        DRUM,
        Controlled(DRUM, [PID(on="x", derivative=3.0, delay=2e-5)]),
        Controlled(DRUM, [PID(on="x", derivative=3.0, sampling=5e4)]),
        DESIGNS["drum_brake_shoes"](),
        ModeCoupling(friction=LuGre(0.45, 0.3, 0.1, 1e4, 10.0, 0.05)),
    ],
    ids=["drum", "late loop", "sampled loop", "several contacts", "memory"],
)
def test_a_tuning_is_linearised_as_the_brake_with_it(brake):
    """`best_absorber` linearises once and moves the absorber's spring and damper in what it got."""
    start = TunedMass(brake, as_system(brake).names[0], 0.05, 1906.0, 0.013)
    tuned = _tuned(start)
    frequencies, dampings = np.array([800.0, 1906.0, 4000.0]), np.array([0.0, 0.013, 0.4])
    together = growth_about(tuned(frequencies, dampings))
    for i, (frequency, damping) in enumerate(zip(frequencies, dampings, strict=True)):
        alone = float(growth_of(start.replace(frequency=frequency, damping=damping)))
        assert together[i] == pytest.approx(alone, rel=1e-9, abs=1e-7)
        assert float(growth_about(tuned(frequency, damping))) == pytest.approx(alone, rel=1e-9, abs=1e-7)


def test_bars_of_cures_have_a_key(table):
    told = [text.get_text() for text in plot(table).axes[0].get_legend().get_texts()]
    assert told == ["quiet at 10 % more friction", "no dose is quiet at 10 % more friction", "without a cure"]

"""What a bifurcation diagram's section reads, against the closed form of the undamped block on a belt.

It sticks at speed V up to x = mu_s N/k, then slips about mu_k N/k with the amplitude sqrt(D^2 + V^2), D = (mu_s - mu_k)
N/k, and stops again at mu_k N/k - D. So with k = N = 1: largest x mu_k + sqrt(D^2 + V^2), x where v falls to 0
mu_k - D, x' where x rises through mu_k, on the way with the belt, V.
"""

import csv

import numpy as np
import pytest

from small_systems import block_on_belt
from squealbox import Coulomb, DrumBrake, LinearSlope, Stribeck, branch, shooting
from squealbox.cli import BAD_INPUT, DONE, main
from squealbox.files import write_design
from squealbox.limit_cycles import Section, bifurcation_diagram, lyapunov_exponents
from squealbox.limit_cycles.attractors.sections import passages
from squealbox.parameters import ParameterError
from squealbox.plots import amplitude_and_section
from squealbox.stability import complex_modes

STATIC, KINETIC = 0.4, 0.25
DROP = STATIC - KINETIC
SPEEDS = np.linspace(0.05, 0.2, 6)
AROUND = np.linspace(0.27, 0.3, 3)


def dry(speed):
    return block_on_belt(Coulomb(STATIC, KINETIC), speed)


def read(section, **more):
    options = {"sweeps": ("rest",), "returns": 6} | more
    return bifurcation_diagram(dry, "V", SPEEDS, section=section, **options)


@pytest.mark.parametrize(
    ("section", "expected"),
    [
        (Section.maxima("q1"), KINETIC + np.hypot(DROP, SPEEDS)),
        (Section.minima("q1"), KINETIC - np.hypot(DROP, SPEEDS)),
        (Section("q1", "v1", 0.0, -1), np.full(6, KINETIC - DROP)),
        (Section.returns("q1"), SPEEDS),
    ],
    ids=str,
)
def test_what_a_section_reads_of_stick_slip(section, expected):
    diagram = read(section)
    assert diagram.outcome == "completed"
    held = diagram.crossings[0]
    assert np.all(np.sum(np.isfinite(held), axis=1) >= 4)
    # 1/128 period between samples: where the motion stops within one, order 2 of that leaves some 1e-4 of the size
    np.testing.assert_allclose(held, np.where(np.isfinite(held), expected[:, None], np.nan), rtol=3e-4, atol=3e-5)


def test_what_never_happens_is_not_read():
    """The block never overtakes the belt, so v does not rise through zero from below; nor from the drawn starts."""
    diagram = read(Section("q1", "v1", 0.0, 1), starts=2)
    assert diagram.sweeps == ("rest", "start 1", "start 2")
    assert not np.any(np.isfinite(diagram.crossings))
    np.testing.assert_allclose(diagram.amplitude[0, :, 0], np.hypot(DROP, SPEEDS), rtol=1e-5)  # 1e-6 of their range


def test_a_motion_that_stays_on_a_plane_passes_it_once():
    """v falls to 0, stays there but for round-off, and leaves upwards: one fall, no rise."""
    t = np.arange(6.0)
    q, v = np.zeros((1, 6, 1)), np.array([[[1.0], [0.5], [1e-17], [-1e-17], [1e-17], [0.4]]])
    falls = passages(t, q, v, np.array([[0.0, 1.0]]), [0.0], -1)
    rises = passages(t, q, v, np.array([[0.0, 1.0]]), [0.0], 1)
    assert (len(falls[0]), len(rises[0])) == (1, 0)
    assert 1.0 < falls[1][0] <= 2.0


@pytest.mark.parametrize(
    ("options", "named"),
    [
        ({"section": Section.maxima("z")}, "read"),
        ({"section": Section("q1", "v2")}, "where"),
        ({"section": None, "sweeps": (), "starts": 0}, "starts"),
        ({"section": None, "returns": 0}, "returns"),
    ],
)
def test_what_makes_no_sense_is_named(options, named):
    with pytest.raises(ParameterError, match=named):
        bifurcation_diagram(dry, "V", SPEEDS, **options)


def test_branches_lie_beneath_the_marks():
    """The followed stick-slip cycles pass through what the sweep down reads, amplitude above and maxima below."""
    drum = DrumBrake(friction=LinearSlope(0.3, -0.05), reading="consistent")
    large = shooting(drum, ([3e-5, 1e-5], [0.3, -0.3]))
    walk = branch(drum, "friction.static", (0.25, 0.35), large, value=0.3, direction=-1, method="shooting", points=40,
                  largest_step=0.02)  # fmt: skip
    diagram = bifurcation_diagram(drum, "friction.static", AROUND, sweeps=("down",), section=Section.maxima("y"),
                                  returns=3, start=large.start)  # fmt: skip
    figure = amplitude_and_section(diagram, branches=walk, dof=1)
    for panel in figure.axes:
        curve = next(line for line in panel.lines if line.get_label() == "stable cycles, followed")
        marks = next(line for line in panel.lines if line.get_label() == "swept down")
        x, y = (np.asarray(part, dtype=float) for part in curve.get_data())
        order = np.argsort(x)
        at, height = (np.asarray(part, dtype=float) for part in marks.get_data())
        seen = np.isfinite(height)
        assert np.sum(seen) >= 2
        np.testing.assert_allclose(height[seen], np.interp(at[seen], x[order], y[order]), rtol=2e-3)
    by_velocity = bifurcation_diagram(drum, "friction.static", AROUND, sweeps=("down",), returns=3,
                                      section=Section.returns("y"), start=large.start)  # fmt: skip
    below = amplitude_and_section(by_velocity, branches=walk, dof=1).axes[1]
    assert "stable cycles, followed" not in [line.get_label() for line in below.lines]  # a branch does not say it


@pytest.fixture
def brake(tmp_path):
    return write_design(DrumBrake(friction=LinearSlope(0.3, -0.05), reading="consistent"), tmp_path / "brake.toml")


def test_the_command_draws_and_tabulates(brake, tmp_path, capsys):
    """The stick-slip of the drum lives down to 0.1775, sliding is stable up to 0.3327: a sweep down shows both."""
    out = tmp_path / "out"
    words = ["--parameter", "friction.static", "--range", "0.15", "0.36", "--points", "8", "--returns", "5"]
    assert main(["diagram", str(brake), *words, "--sweeps", "up", "down", "--out", str(out)]) == DONE
    said = capsys.readouterr().out
    assert "y at its maxima" in said
    assert "Rest and vibration coexist at 6 values, from 0.18 to 0.33" in said
    assert {path.name for path in out.iterdir()} == {
        "diagram.png", "diagram.svg", "diagram.csv", "section.csv", "diagram.nc"
    }  # fmt: skip
    rows = list(csv.DictReader((out / "diagram.csv").read_text().splitlines()))
    assert len(rows) == 16
    kinds = {(row["sweep"], round(float(row["friction.static [-]"]), 2)): row["kind"] for row in rows}
    assert (kinds["up", 0.27], kinds["down", 0.27], kinds["down", 0.15]) == ("rests", "repeats", "rests")
    passed = list(csv.DictReader((out / "section.csv").read_text().splitlines()))
    assert sum(row["sweep"] == "down" and abs(float(row["friction.static [-]"]) - 0.27) < 1e-9 for row in passed) == 5


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--section", "sideways"], "expected maxima, minima, return, or a plane"),
        (["--section", "w falls 0"], "one of x, y, x', y'"),
        (["--section", "x rises 2kg"], "kg"),
        (["--dof", "z"], "one of x, y, x', y'"),
        (["--dof", "x'", "--section", "maxima"], "a displacement"),
        (["--duration", "soon"], "soon"),
        (["--starts", "-1"], "starts"),
        (["--sweeps", "left"], "sweeps"),
    ],
)
def test_what_the_command_refuses(brake, words, said, capsys):
    where = ["--parameter", "friction.static", "--range", "0.2", "0.3"]
    assert main(["diagram", str(brake), *where, *words]) == BAD_INPUT
    assert said in capsys.readouterr().err


def test_the_command_cycle_prints_exponents_that_its_multipliers_confirm(brake, capsys):
    assert main(["cycle", str(brake), "--set", "friction.static=0.45", "--exponents", "60"]) == DONE
    lines = capsys.readouterr().out.splitlines()
    at = next(i for i, line in enumerate(lines) if line.startswith("Lyapunov exponents over 60 periods"))
    runs, multipliers = (
        [float(x) for x in line.split(":")[1].removesuffix(" 1/s").split(", ")] for line in lines[at : at + 2]
    )
    period = float(next(line for line in lines if "period" in line).split("period ")[1].split(" s")[0])
    assert abs(runs[0]) * period < 1e-7  # the trivial exponent, a shift in time; derivatives are good to 1e-8
    np.testing.assert_allclose(runs[1:], multipliers[1:], rtol=1e-4)  # five printed digits; -inf where it sticks
    assert np.isinf(runs[-1])
    assert main(["cycle", str(brake), "--exponents", "-1"]) == BAD_INPUT


def test_in_stable_sliding_the_largest_exponent_is_the_growth_rate():
    """A spiral into steady sliding: the negative twin of the 0 of every cycle."""
    system = block_on_belt(Stribeck(0.4, 0.25, 0.3), 0.5, damping=0.2)
    found = lyapunov_exponents(system, ([0.3], [0.01]), 2.0 * np.pi, 30)
    growth = np.max(complex_modes(system).growth_rate)
    assert growth < -0.01
    assert abs(found[0] - growth) < 3.0 / (30 * 2.0 * np.pi)

"""Each formula where it holds: slow drive, laws of their own, moving rest, cautions beyond a model's range."""

import numpy as np
import pytest

from squealbox import (
    Contact,
    Coulomb,
    Cubic,
    LinearSlope,
    ParameterError,
    Sinusoid,
    Stribeck,
    System,
    branch,
    complex_modes,
    hopf_point,
    shooting,
)
from squealbox.cautions import out_of_range
from squealbox.friction import FrictionLaw, Hyperbolic, Table
from squealbox.limit_cycles import averaged_limit
from squealbox.limit_cycles.estimates.averaging import averaged_excess
from squealbox.schedules import Constant, Ramp


def block(law: FrictionLaw, speed: object, damping: float = 0.02, normal: object = 1.0) -> System:
    return System([[1.0]], [[damping]], [[1.0]], 0.0, (Contact([0.0], [1.0], [1.0], normal, speed, law),))


@pytest.mark.parametrize(("speed", "period"), [(0.003, 134.404), (0.001, 396.927)])
def test_slow_drive_sticks_and_slips(speed: float, period: float) -> None:
    """Periods by an independent event integrator; a run of 12 periods of the block lies inside one stick."""
    cycle = shooting(block(Coulomb(0.4, 0.2), speed))
    assert cycle.outcome.ok
    assert float(cycle.period) == pytest.approx(period, rel=4e-6)
    assert float(cycle.sticking_time[0]) > 0.95 * period


def test_steady_sliding_is_still_steady_sliding() -> None:
    assert shooting(block(Coulomb(0.4), 0.1, damping=0.5)).outcome == "steady_sliding"


@pytest.mark.parametrize(
    "law", [Cubic(0.4, 0.25, 0.5), Cubic(0.6, 0.2, 0.3), Stribeck(0.4, 0.25, 0.3), Hyperbolic(0.5, 2.0)]
)
def test_the_averaged_limit_balances_the_touching_cycle_of_each_law(law: FrictionLaw) -> None:
    limit = averaged_limit(law, 1.0, 0.1)
    assert float(averaged_excess(law, limit, limit, 1.0, 0.1)) == pytest.approx(0.0, abs=1e-9)


def test_the_averaged_limit_of_the_cubic_law() -> None:
    """c s = 3/2 N D (1 - 5 V^2/(4 s^2)) with c = 0.1, s = 0.5, D = 0.15: V = 0.3944053."""
    assert averaged_limit(Cubic(0.4, 0.25, 0.5), 1.0, 0.1) == pytest.approx(np.sqrt(0.2 * (1 - 2.0 / 9.0)), rel=1e-14)
    with pytest.raises(ParameterError, match="static limit"):
        averaged_limit(Coulomb(0.4, 0.25), 1.0, 0.1)


@pytest.mark.parametrize("where", ["V", "N0", "load"])
def test_what_oscillates_at_rest_has_no_modes(where: str) -> None:
    wave = Sinusoid(1.0, 0.3, 2.0)
    system = block(Stribeck(0.4, 0.25, 0.3), wave if where == "V" else 1.0, normal=wave if where == "N0" else 1.0)
    system = system.replace(load=wave * [1.0]) if where == "load" else system
    modes = complex_modes(system)
    assert modes.outcome == "moving"
    assert where in modes.outcome.message
    assert not modes.exists


@pytest.mark.parametrize("steady", [Constant(1.0), Ramp(1.0, -1.0, 0.5), Sinusoid(1.0, 0.0, 5.0)])
def test_what_is_constant_or_settles_has_modes(steady: object) -> None:
    assert complex_modes(block(Stribeck(0.4, 0.25, 0.3), steady)).outcome.ok


def test_the_kind_of_a_hopf_point_is_not_read_off_a_table() -> None:
    law = Stribeck(0.4, 0.25, 0.3)
    speeds = np.linspace(0.0, 1.5, 6)
    table = Table(speeds.tolist(), law.mu(speeds).tolist())
    born = hopf_point(lambda v: block(table, v, damping=0.2), "V", (0.05, 1.0))
    assert born.kind == "unknown"
    assert "fit" in born.caution
    assert hopf_point(lambda v: block(law, v, damping=0.2), "V", (0.05, 1.0)).kind == "subcritical"


def test_cautions_outside_the_range_of_a_law_or_contact() -> None:
    assert "friction is negative" in complex_modes(block(LinearSlope(0.45, -0.03), 20.0)).caution
    assert complex_modes(block(LinearSlope(0.45, -0.03), 10.0)).caution == ""
    assert complex_modes(block(LinearSlope(0.45, -0.03, 0.1), 20.0)).caution == ""
    assert "beyond the law's data" in complex_modes(block(Table([0.0, 1.0], [0.4, 0.3]), 1.5)).caution
    assert "have to pull" in out_of_range(block(Coulomb(0.3), 1.0), [[2.0], [-1.0]], [[1.0], [1.0]])[0]


def test_a_branch_of_stick_slip_is_followed_by_the_method_that_can() -> None:
    walk = branch(lambda v: block(Coulomb(0.4, 0.2), v), "V", (0.05, 0.3), value=0.1, points=4)
    assert walk.settings["method"] == "shooting"
    assert len(walk.value) == 4
    assert np.all(walk.sticking > 0.0)
    with pytest.raises(ParameterError, match="low < high"):
        branch(lambda v: block(Coulomb(0.4, 0.2), v), "V", (0.3, 0.05))


def test_a_family_of_laws_is_looked_at_member_by_member() -> None:
    """0.3 - 0.2 * 2 < 0 in the last of four; with all slopes at -0.1 none is negative."""
    said = complex_modes(block(LinearSlope(np.full(4, 0.3), np.array([0.0, -0.05, -0.1, -0.2])), 2.0)).caution
    assert said == "contact 1: friction is negative at 2 m/s (mu = -0.1) and drives the sliding: give the law a floor"
    assert not complex_modes(block(LinearSlope(np.full(4, 0.3), -0.1), 2.0)).caution

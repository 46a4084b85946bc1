"""The name of a mechanism against the powers of the mode, for every design: what feeds it is what the name says."""

import numpy as np
import pytest

from squealbox.designs import DESIGNS, DrumBrakeShoes, MassOnBelt
from squealbox.friction import Coulomb, Hyperbolic, LinearSlope
from squealbox.stability import critical_values, mechanism, mode_energy, stability_boundary
from squealbox.stability.family import steady_sliding
from squealbox.stability.mechanisms import MIXED, contributions, mechanism_codes
from squealbox.stability.state_matrix import spectrum
from squealbox.system import System

MUS = (0.05, 0.2, 0.3948, 0.45, 0.6, 0.8)


def with_coulomb(name: str, mu: float):
    """The design under constant friction mu; designs hold it as a law or as a coefficient."""
    design = DESIGNS[name]()
    named = {field.name for field in design.__dataclass_fields__.values()}
    if "friction" in named:
        return design.replace({"friction": Coulomb(mu)})
    return design.replace({"mu": mu})


@pytest.mark.parametrize("name", sorted(DESIGNS))
def test_constant_friction_is_never_negative_slope(name: str) -> None:
    for mu in MUS:
        design = with_coulomb(name, mu)
        steady = steady_sliding(design)
        if not np.all(steady.equilibrium.exists):
            continue
        assert np.array_equal(steady.C, steady.structural)
        found = mechanism(design)
        assert found.slope == 0.0
        assert found.name in ("stable", "flutter", "divergence")
        values = spectrum(steady)
        worst = values[np.argmax(values.real)]
        assert (found.name == "divergence") == (found.name != "stable" and abs(worst.imag) < 1e-9 * abs(values).max())
        if found.name == "flutter":
            energy = mode_energy(design)
            fed = float(np.sum(energy.circulation) + energy.structure)
            assert fed / (2.0 * energy.total) > 0.0
            assert np.all(energy.slope == 0.0)
            assert energy.residual < 1e-9


def test_shoes_flutter_where_two_modes_of_a_drum_brake_merge() -> None:
    """Without damping the squares of the frequencies are K's eigenvalues over M: past flutter a pair is complex."""
    found = critical_values(DrumBrakeShoes(), "friction.static", (0.05, 0.9))
    assert set(found.mechanism) == {"flutter"}
    assert found.value[0] == pytest.approx(0.3945983604, abs=1e-9)
    steady = steady_sliding(DrumBrakeShoes(friction=Coulomb(0.3948)))
    squares = np.linalg.eigvals(np.linalg.solve(steady.M, steady.K))
    assert np.min(squares.real) > 0.0  # no divergence
    for mu, merged in ((0.2, False), (0.5, True)):
        free = steady_sliding(DrumBrakeShoes(friction=Coulomb(mu), damping=0.0))
        squares = np.linalg.eigvals(np.linalg.solve(free.M, free.K))
        assert bool(np.max(np.abs(squares.imag)) > 1e-6 * np.max(np.abs(squares))) == merged


def test_the_symmetric_part_alone_is_no_passive_base() -> None:
    """Why friction's stiffness is switched on whole: its symmetric part alone makes this brake diverge."""
    steady = steady_sliding(DrumBrakeShoes(friction=Coulomb(0.3948)))
    assert np.min(np.linalg.eigvalsh(0.5 * (steady.K + steady.K.T))) < 0.0
    assert np.min(np.linalg.eigvalsh(steady.elastic)) > 0.0
    base, circulation, slope = contributions(steady)
    assert base < 0.0 < circulation
    assert slope == 0.0


@pytest.mark.parametrize("alpha", [0.02, 0.3])
def test_falling_friction_is_negative_slope_and_its_power_is_the_growth(alpha: float) -> None:
    """One mass: growth = N alpha / (2 m), all of it the slope; the negative twin rises with speed and is stable."""
    falling = MassOnBelt(friction=LinearSlope(0.5, -alpha))
    found = mechanism(falling)
    assert found.name == "negative_slope"
    assert found.slope == pytest.approx(0.5 * alpha, rel=1e-9)
    assert float(np.sum(mode_energy(falling).slope)) > 0.0
    assert mechanism(falling.replace({"friction.slope": alpha})).name == "stable"


def test_a_gyroscopic_term_is_not_called_slope() -> None:
    """G does no work: with a skew stiffness it is still flutter, and slope is exactly nothing."""
    turning = System(M=np.eye(2), C=[[0.01, 0.3], [-0.3, 0.01]], K=[[2.0, 1.0], [-1.0, 2.0]])
    assert mechanism(turning).name == "flutter"
    assert mechanism(turning).slope == 0.0


def test_what_oscillates_is_not_divergence_whatever_the_parts_say() -> None:
    code = mechanism_codes(np.array(2.0), np.array(50.0), np.array(-1.0), np.array(-1.0), np.array(100.0))
    assert code == MIXED


def test_a_boundary_on_a_side_is_one_curve() -> None:
    """No load, no friction: with falling friction any load destabilises, so the boundary is the side itself."""
    design = MassOnBelt(friction=Hyperbolic(1.0, 3.0))
    found = stability_boundary(design, {"load": (0.0, 100.0), "sliding_speed": (0.05, 2.0)})
    assert len(found.curves) == 1
    assert np.all(found.x == 0.0)
    assert (found.y.max(), found.y.min()) == (2.0, 0.05)
    assert found.y[0] > found.y[-1]  # downwards: the unstable side is on the left
    damped = stability_boundary(design.replace(c=0.5), {"load": (0.0, 1.0), "sliding_speed": (0.05, 2.0)})
    assert np.min(damped.x) > 0.0  # with damping it lies inside: N 3/(1 + 3 v)^2 = c
    assert damped.x == pytest.approx(0.5 * (1.0 + 3.0 * damped.y) ** 2 / 3.0, rel=1e-8)


def test_boundary_of_the_shoes_from_no_load_on_is_the_critical_friction() -> None:
    """K_eff does not depend on the load under constant friction, so the boundary is a line of one friction."""
    found = stability_boundary(DrumBrakeShoes(), {"friction.static": (0.2, 0.6), "load": (0.0, 3000.0)}, cells=8)
    inside = found.y > 1.0
    assert found.x[inside] == pytest.approx(0.3945983604, abs=1e-6)

"""Cycles of systems with other states than q and q': rows without mass, friction with memory, loops with a limit."""

import numpy as np
import pytest

from squealbox import PID, Contact, Coulomb, MassOnBelt, ParameterError, System, branch, simulate
from squealbox.friction import Dahl, LuGre
from squealbox.limit_cycles import basin, bifurcation_diagram, settled_cycles, shooting
from squealbox.limit_cycles.cycles.differences import by_differences
from squealbox.limit_cycles.cycles.field import Field
from squealbox.limit_cycles.cycles.variation import flight, fly

FALLING = Coulomb(0.4, 0.25)
SERIES = 2.0 / 3.0  # N/m, of a spring 1 and, behind a node without mass, a spring 2


def on_two_springs(V=0.1):
    """A block on a belt, its spring split by a node that has neither mass nor damper: x = 1/3 of the block's."""
    belt = Contact([0.0, 0.0], [1.0, 0.0], [1.0, 0.0], 1.0, V, FALLING)
    return System(np.diag([1.0, 0.0]), np.zeros((2, 2)), [[1.0, -1.0], [-1.0, 3.0]], 0.0, (belt,))


def with_maxwell(V=0.1):
    """A block on a belt with a spring, and a damper in series with another spring beside it: a row of first order."""
    belt = Contact([0.0, 0.0], [1.0, 0.0], [1.0, 0.0], 1.0, V, FALLING)
    damping = 0.05 * np.array([[1.0, -1.0], [-1.0, 1.0]])
    return System(np.diag([1.0, 0.0]), damping, np.diag([1.0, 0.5]), 0.0, (belt,))


def on_bristles(V=0.1):
    belt = Contact([0.0], [1.0], [1.0], 1.0, V, LuGre(0.4, 0.25, 0.1, stiffness=100.0, damping=1.0))
    return System([[1.0]], [[0.0]], [[1.0]], 0.0, (belt,))


def controlled():
    """Negative damping under a PID whose force has a limit: still within a cycle that is unstable, beyond it lost."""
    loop = PID(on="q1", integral=0.05, derivative=0.3, limit=1.0)
    return System([[1.0]], [[-0.1]], [[1.0]], 0.0, (), loops=(loop,))


def period(V):
    """R4 with another spring: T = 2 dF/(k V) + 2 (pi - atan(dF w/(k V)))/w, w^2 = k/m."""
    w, force = np.sqrt(SERIES), 0.15
    return 2.0 * force / (SERIES * V) + 2.0 / w * (np.pi - np.arctan(force * w / (SERIES * V)))


def closes(system, cycle):
    run = simulate(system, float(cycle.period), cycle.start, rtol=1e-12)
    return float(np.max(np.abs(np.hstack([run.q[-1] - run.q[0], run.qd[-1] - run.qd[0]]))))


def test_a_node_without_mass():
    cycle = shooting(on_two_springs())
    assert cycle.outcome == "completed"
    assert float(cycle.period) == pytest.approx(period(0.1), abs=1e-9)
    assert cycle.amplitude[1] == pytest.approx(cycle.amplitude[0] / 3.0, rel=1e-9)
    assert len(cycle.multipliers) == 2  # a node has no state of its own
    assert abs(cycle.multipliers[0] - 1.0) < 1e-9
    assert abs(cycle.multipliers[1]) < 1e-9
    assert cycle.caution == ""


def test_a_branch_of_it():
    followed = branch(on_two_springs, "V", (0.09, 0.11), value=0.1, method="shooting", points=5)
    assert len(followed.value) >= 4
    assert followed.period == pytest.approx([period(v) for v in followed.value], abs=1e-8)


def test_a_row_of_first_order():
    """Coming back after a period, and a small disturbance shrinking by the largest multiplier in each."""
    system = with_maxwell()
    cycle = shooting(system)
    assert closes(system, cycle) < 1e-10
    assert len(cycle.multipliers) == 3
    assert np.all(np.abs(cycle.multipliers[1:]) < 1e-9)  # a stick forgets the block, and lasts long for the damper
    assert simulate(system, 40.0, cycle.start).event_time.size > 8


def test_friction_with_memory():
    system = on_bristles()
    cycle = shooting(system, settle=200.0)
    assert cycle.outcome == "completed"
    assert closes(system, cycle) < 1e-10
    away = [np.array(x) for x in cycle.start]
    away[0] = away[0] + 1e-5
    ends = [simulate(system, k * float(cycle.period), tuple(away), rtol=1e-12).q[-1, 0] for k in (1, 2)]
    shrinks = (ends[1] - ends[0]) / (ends[0] - away[0][0])  # steps from round to round: the shift in time drops out
    assert shrinks == pytest.approx(float(cycle.multipliers[1].real), abs=2e-4)
    assert "memory" in cycle.to_dataset()
    assert type(cycle).from_dataset(cycle.to_dataset()).start[2] == pytest.approx(cycle.start[2])


def test_a_loop_with_a_limit():
    """The largest motion that such a loop still brings to rest; forward runs on either side of it."""
    system = controlled()
    cycle = shooting(system, ([12.5], [0.0], 6.29))
    assert cycle.outcome == "completed"
    assert not cycle.stable
    assert len(cycle.multipliers) == 3  # the block, and the integral; not the integral of the command
    grown = max(abs(cycle.multipliers))
    start = shooting(system, cycle).start
    swings = []
    for share in (0.98, 1.02):
        run = simulate(system, 20.0 * float(cycle.period), tuple(share * x for x in start))
        swings.append(np.ptp(run.q[-len(run.q) // 20 :]) / 2.0)
    assert swings[0] < 0.9 * cycle.amplitude[0] < 1.1 * cycle.amplitude[0] < swings[1]
    assert grown > 1.3


def test_a_basin_and_a_diagram_without_a_mass_everywhere():
    found = basin(with_maxwell(), starts=40)
    cycle = shooting(with_maxwell())
    assert found.outcome == "completed"
    assert sorted(found.kind) == ["cycle", "steady sliding"]
    swings = [half for half in (each.high - each.low for each in found.attractors) if np.max(half) > 0.1]
    assert swings[0] / 2.0 == pytest.approx(cycle.amplitude, rel=1e-6)
    diagram = bifurcation_diagram(with_maxwell, "V", np.array([0.1, 0.12]), sweeps=("rest",))
    assert diagram.outcome == "completed"


def test_settled_cycles_of_rows_without_mass():
    for system in (with_maxwell(), on_two_springs()):
        (cycle,) = settled_cycles(system, 8)
        assert cycle.period == pytest.approx(shooting(system).period, rel=1e-8)
    with pytest.raises(ParameterError, match="leading axes"):
        shooting(on_two_springs(np.array([0.1, 0.2])))


def test_one_of_a_family_is_neither_stable_nor_unstable():
    """Sliding throughout without damping, each amplitude below V/w is a cycle of period 2 pi; bent bristles rest."""
    cycle = shooting(MassOnBelt(m=1.0, k=1.0, c=0.0, load=1.0, friction=Dahl(0.3, 300.0), sliding_speed=0.1))
    assert cycle.outcome == "completed"
    assert cycle.period == pytest.approx(2.0 * np.pi, rel=1e-8)
    assert cycle.stability == "neutral"
    assert not cycle.caution
    assert not cycle.stable
    assert "neutral cycle" in str(cycle)


def test_a_start_on_one_of_a_family_stays_there():
    """A block that slides without damping about mu N/k = 0.075: from 0.5 its amplitude is 0.425."""
    belt = Contact([0.0], [1.0], [1.0], 1.0, 1.0, Coulomb(0.3))
    cycle = shooting(System([[1.0]], [[0.0]], [[4.0]], 0.0, (belt,)), ([0.5], [0.0]))
    assert cycle.outcome == "completed"
    assert cycle.stability == "neutral"
    assert np.ptp(cycle.q) / 2.0 == pytest.approx(0.425, rel=1e-5)


def test_differences_agree_with_the_equation_s_derivative():
    """Two roads to the same matrix, of a system that has both, through stick and slip."""
    belt = Contact([0.0], [1.0], [1.0], 1.0, 0.1, FALLING)
    field = Field(System([[1.0]], [[0.05]], [[1.0]], 0.0, (belt,)))
    x, duration = np.array([0.1, -0.05]), 5.0
    motion = fly(field, x, duration)
    exact = flight(field, x, duration, motion=motion)
    near = by_differences(field, x, duration, motion=motion)
    assert len(motion.event_time) > 1
    np.testing.assert_allclose(near.phi, exact.phi, atol=1e-9)
    assert near.mismatch < 1e-9

"""Stretches of a parameter are told to where stability changes, and one by one where there are several."""

import numpy as np
import pytest

from squealbox import MassOnBelt, Stribeck
from squealbox.limit_cycles import (
    BifurcationDiagram,
    Branch,
    beside_sliding,
    branch,
    hopf_point,
    shooting,
    stable_sliding,
    stretches,
)
from squealbox.matrices import runs_of_true


def followed(values, stable, sizes, special=()):
    """A branch of cycles at these values."""
    k, kinds = len(values), [kind for kind, _, _ in special]
    size = np.asarray(sizes, dtype=float)[:, None]
    return Branch(
        value=np.asarray(values, dtype=float), period=np.ones(k), lowest=-size, highest=size,
        multipliers=np.column_stack([np.ones(k), np.where(stable, 0.5, 2.0)]), start=np.zeros((k, 2)),
        least_slip=np.ones(k), sticking=np.zeros(k), unknowns=np.zeros((k, 1)), special_kind=np.array(kinds),
        special_value=np.array([value for _, value, _ in special]),
        special_point=np.array([i for _, _, i in special], dtype=int), special_uncertainty=np.zeros(len(special)),
        special_test=np.zeros(len(special)), parameter="p",
    )  # fmt: skip


def test_runs_of_true():
    assert runs_of_true([]) == runs_of_true([False]) == []
    assert runs_of_true([True, False, True, True]) == [(0, 0), (2, 3)]


def test_a_stretch_ends_at_the_fold_and_at_the_onset():
    """Amplitude sqrt(5 - p) from an onset at 5, back over a fold at 1 that no cycle followed lies on."""
    one = followed([4.9, 4.0, 2.0, 1.2, 1.1, 3.0], [0, 0, 0, 0, 1, 1], [0.3162, 1.0, 1.73, 2.0, 2.2, 3.0],
                   [("fold", 1.0, 3)])  # fmt: skip
    assert stretches(one, [5.0]) == [(1.0, 5.0, False), (1.0, 3.0, True)]
    assert stretches(one) == [(1.0, 4.9, False), (1.0, 3.0, True)]
    assert stretches(one, [0.9])[0] == (1.0, 4.9, False)  # the branch passes over no way to it


def test_stretches_apart_are_not_told_as_one():
    ends = [followed([0.0, 1.0], [1, 1], [1.0, 1.0]), followed([8.0, 9.5], [1, 1], [1.0, 1.0])]
    assert beside_sliding(ends, [(0.5, 9.0)]) == [(0.5, 1.0), (8.0, 9.0)]
    assert beside_sliding(ends, [(2.0, 7.0)]) == beside_sliding([], [(0.0, 9.0)]) == beside_sliding(ends, []) == []
    assert beside_sliding([followed([1.0, 2.0], [0, 0], [1.0, 1.0])], [(0.0, 9.0)]) == []


def test_a_block_on_a_belt_slides_quietly_above_its_hopf_speed():
    """c = -N mu'(V) at V = s ln(N (static - kinetic)/(c s)): below it stick-slip alone, above it both."""
    law = Stribeck(static=0.4, kinetic=0.2, speed=0.1)
    belt = MassOnBelt(m=1.0, c=2.0, k=100.0, load=10.0, friction=law)
    onset = 0.1 * np.log(10.0 * 0.2 / (2.0 * 0.1))
    assert stable_sliding(belt, "sliding_speed", (0.1, 0.5)) == [(pytest.approx(onset, rel=1e-10), 0.5)]
    quiet = stable_sliding(belt, "sliding_speed", (0.1, 0.5))
    born = hopf_point(belt, "sliding_speed", (0.1, 0.5))
    unstable = branch(belt, "sliding_speed", (0.1, 0.5), born, method="shooting", points=10)
    assert beside_sliding([unstable], quiet) == []
    assert stretches(unstable, [onset])[0][0] == onset < unstable.value[0]
    start = shooting(belt.replace({"sliding_speed": 0.2}))
    walk = branch(belt, "sliding_speed", (0.1, 0.5), start, value=0.2, method="shooting", points=80)
    ((low, high),) = beside_sliding([walk], quiet)
    assert low == pytest.approx(onset, rel=1e-10)
    assert high == walk.special("fold")[0] > np.max(walk.value[walk.stable])


def test_a_diagram_tells_where_it_vibrates_by_stretches():
    kind = np.array([[2, 2, 1, 0, 1]])
    at = np.arange(5.0)
    one = BifurcationDiagram(
        value=at, kind=kind, maxima=np.zeros((1, 5, 1, 8)), lowest=np.zeros((1, 5, 1)), highest=np.zeros((1, 5, 1)),
        frequency=np.ones((1, 5, 1)), state=np.zeros((1, 5, 2)), sliding=np.zeros((5, 1)),
        crossings=np.zeros((1, 5, 0)), parameter="p", sweeps=("up",), dofs=("x",),
    )  # fmt: skip
    assert one.stretches(kind[0] != 1, lambda value: f"{value:g}") == "from 0 to 1 and at 3"

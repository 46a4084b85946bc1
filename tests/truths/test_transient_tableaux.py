"""R6: each tableau satisfies the order conditions of its source, exactly, and no more of them than it claims.

Tolerances: round-off of the sums, times the size of the tableau's entries; Tsitouras' and DOP853's are printed to
about 16 digits, so the same holds for them.
"""

import numpy as np
import pytest

from rooted_trees import density, trees, worst_condition, worst_of_estimate
from squealbox.transient.methods import TABLEAUX, tableau

NAMES = tuple(TABLEAUX)
ORDER = {"bogacki-shampine": 3, "dormand-prince": 5, "tsitouras": 5, "dormand-prince-8": 8}
ESTIMATE = {"bogacki-shampine": 2, "dormand-prince": 4, "tsitouras": 4, "dormand-prince-8": 5}  # of the embedded method
DENSE = {"bogacki-shampine": 3, "dormand-prince": 4, "tsitouras": 4, "dormand-prince-8": 7}
ROUND_OFF = 2e-14
NOT_ZERO = 1e-7  # a condition that fails, fails by far more than round-off


def main_part(method):
    """A and b of the stages of a step, b over them."""
    return method.a[: method.stages, : method.stages], method.b


def with_last(method):
    """A with the stage after the step."""
    return method.a[: method.stages + 1, : method.stages + 1]


def test_trees_are_counted_right():
    # Hairer, Norsett & Wanner, table II.2.1; density of the tall tree is the factorial, of the bush its size
    assert [len(trees(n)) for n in range(1, 9)] == [1, 1, 2, 4, 9, 20, 48, 115]
    assert density((((),),)) == 6
    assert density(((), ())) == 3


@pytest.mark.parametrize("name", NAMES)
def test_sums(name):
    method = tableau(name)
    assert abs(method.b.sum() - 1.0) < ROUND_OFF
    assert np.max(np.abs(method.a.sum(1) - method.c)) < ROUND_OFF * np.max(np.abs(method.a))
    assert np.all(np.triu(method.a) == 0.0), "the method is explicit"
    assert abs(method.e.sum()) < ROUND_OFF, "an error estimate vanishes for y' = 1"
    assert method.c[method.stages] == pytest.approx(1.0, abs=ROUND_OFF)
    assert np.array_equal(method.a[method.stages, : method.stages], method.b), "the stage after a step begins the next"


@pytest.mark.parametrize("name", NAMES)
def test_nodes_are_row_sums(name):
    # c of three tableaux is computed from A; these are the nodes their sources print
    printed = {
        "bogacki-shampine": [0, 1 / 2, 3 / 4, 1],
        "dormand-prince": [0, 1 / 5, 3 / 10, 4 / 5, 8 / 9, 1, 1],
        "tsitouras": [0, 0.161, 0.327, 0.9, 0.9800255409045097, 1, 1],
        "dormand-prince-8": [0, 0.0526001519587677, 0.0789002279381516, 0.118350341907227, 0.281649658092773, 1 / 3,
                             0.25, 0.307692307692308, 0.651282051282051, 0.6, 0.857142857142857, 1, 1],
    }[name]  # fmt: skip
    assert tableau(name).c[: len(printed)] == pytest.approx(printed, abs=1e-14)


@pytest.mark.parametrize("name", NAMES)
def test_order_conditions(name):
    method = tableau(name)
    a, b = main_part(method)
    for nodes in range(1, ORDER[name] + 1):
        assert worst_condition(a, b, nodes) < ROUND_OFF
    assert method.order == ORDER[name]


@pytest.mark.parametrize("name", NAMES)
def test_the_next_order_is_not_reached(name):
    a, b = main_part(tableau(name))
    assert worst_condition(a, b, ORDER[name] + 1) > NOT_ZERO


@pytest.mark.parametrize("name", NAMES)
def test_a_wrong_entry_breaks_a_condition(name):
    a, b = main_part(tableau(name))
    for i, j in ((1, 0), (2, 1)):
        wrong = a.copy()
        wrong[i, j] += 0.01
        assert max(worst_condition(wrong, b, nodes) for nodes in range(1, ORDER[name] + 1)) > NOT_ZERO


@pytest.mark.parametrize("name", NAMES)
def test_error_estimate_has_its_order(name):
    method = tableau(name)
    a = with_last(method)
    for nodes in range(1, ESTIMATE[name] + 1):
        assert worst_of_estimate(a, method.e, nodes) < ROUND_OFF
    assert worst_of_estimate(a, method.e, ESTIMATE[name] + 1) > NOT_ZERO


def test_second_estimate_of_dormand_prince_8_has_order_3():
    method = tableau("dormand-prince-8")
    a = with_last(method)
    assert max(worst_of_estimate(a, method.e3, nodes) for nodes in range(1, 4)) < ROUND_OFF
    assert worst_of_estimate(a, method.e3, 4) > NOT_ZERO


@pytest.mark.parametrize("name", NAMES)
def test_dense_output_joins_the_step(name):
    method = tableau(name)
    tolerance = ROUND_OFF * np.max(np.abs(method.p))
    ends = np.zeros(len(method.p))
    ends[: method.stages] = method.b
    last = np.eye(len(method.p))[method.stages]
    degrees = np.arange(1, method.p.shape[1] + 1)
    assert np.max(np.abs(method.p.sum(1) - ends)) < tolerance  # theta = 1 is the step
    assert np.max(np.abs(method.p[:, 0] - np.eye(len(method.p))[0])) < tolerance  # leaves with y' at the start
    assert np.max(np.abs(method.p @ degrees - last)) < 10.0 * tolerance  # arrives with y' at the end


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("theta", [0.1, 0.5, 0.9])
def test_dense_output_has_its_order(name, theta):
    method = tableau(name)
    weights = method.p @ theta ** np.arange(1, method.p.shape[1] + 1)
    tolerance = ROUND_OFF * np.max(np.abs(method.p))
    for nodes in range(1, DENSE[name] + 1):
        assert worst_condition(method.a, weights, nodes, theta) < tolerance
    assert worst_condition(method.a, weights, DENSE[name] + 1, theta) > NOT_ZERO


@pytest.mark.parametrize(("name", "rival"), [("bogacki-shampine", "RK23"), ("dormand-prince", "RK45")])
def test_same_numbers_as_scipy(name, rival):
    import scipy.integrate

    method, other = tableau(name), getattr(scipy.integrate, rival)
    stages = method.stages
    assert np.max(np.abs(method.a[:stages, : other.A.shape[1]] - other.A)) < ROUND_OFF
    assert np.max(np.abs(method.b - other.B)) < ROUND_OFF
    assert np.max(np.abs(np.abs(method.e) - np.abs(other.E))) < ROUND_OFF  # the sign of an error estimate is free
    assert np.max(np.abs(method.p - other.P)) < ROUND_OFF * np.max(np.abs(other.P))

"""Order conditions of Runge-Kutta methods, one for each rooted tree (Butcher 1963).

A tree is the tuple of its branches. A method is of order p when b . u(tree) = 1/density(tree) for every tree of at most
p nodes, where u(tree) is the product of A u(branch) over the branches; its dense output b(theta) is of order p when
b(theta) . u(tree) = theta^nodes/density(tree).
"""

from functools import cache
from itertools import combinations_with_replacement

import numpy as np


@cache
def trees(nodes):
    """All rooted trees of so many nodes."""
    return tuple({tuple(sorted(forest)) for forest in forests(nodes - 1, nodes - 1)})


@cache
def forests(nodes, largest):
    """All multisets of trees of so many nodes together, each of at most `largest`."""
    if nodes == 0:
        return ((),)
    if largest == 0:
        return ()
    found = []
    for count in range(nodes // largest + 1):
        for some in combinations_with_replacement(trees(largest), count):
            found += [some + rest for rest in forests(nodes - count * largest, largest - 1)]
    return tuple(found)


def size(tree):
    """Number of nodes."""
    return 1 + sum(size(branch) for branch in tree)


def density(tree):
    """gamma: the product of the sizes of all subtrees."""
    return size(tree) * int(np.prod([density(branch) for branch in tree], dtype=np.int64))


def stage_products(a, tree):
    """u(tree), one value for each stage."""
    result = np.ones(len(a))
    for branch in tree:
        result = result * (a @ stage_products(a, branch))
    return result


def worst_condition(a, b, nodes, theta=1.0):
    """Largest |b . u - theta^nodes/density| over the trees of so many nodes."""
    return max(abs(b @ stage_products(a, t) - theta**nodes / density(t)) for t in trees(nodes))


def worst_of_estimate(a, e, nodes):
    """Largest |e . u| over the trees of so many nodes: zero where both methods of a pair satisfy the conditions."""
    return max(abs(e @ stage_products(a, t)) for t in trees(nodes))

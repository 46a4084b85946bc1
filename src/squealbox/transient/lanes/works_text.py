"""The works of a Taylor step of a recorded motion, by a rule of Radau on the series that the step has left.

    work = int F d . q' dt = span sum_j w_j F(x_j span) d . q'(x_j span)

over eight instants x_j of the step, the last of which is its end: one register, where the series of each product would
take as long as the equation itself. The rule is exact to degree 14. A step whose terms fall to the tolerance rtol at
order 16 leaves a term of degree 15 of the size of rtol, and of that the rule leaves 3e-9.
Source of the rule: Hairer and Wanner 1996, Solving Ordinary Differential Equations II, section IV.5 (Radau IIA).
"""

from typing import Any

import numpy as np
from numpy.polynomial import Legendre
from numpy.polynomial.legendre import legvander

from squealbox.transient.lanes.equation_text import EquationText
from squealbox.transient.lanes.shape import ORDER, UNIT_OF_WINDOW

NODES = 8


def radau() -> tuple[Any, Any]:
    """Instants in (0, 1], the last of them 1, and weights that integrate polynomials of degree 2 NODES - 2 exactly."""
    last = Legendre.basis(NODES) - Legendre.basis(NODES - 1)
    nodes = np.append(last.roots()[:-1], 1.0)
    return 0.5 * (1.0 + nodes), np.linalg.solve(legvander(nodes, NODES - 1).T, np.eye(NODES)[0])


class WorksText(EquationText):
    """Writes `works_at(A, b)`: works since the start of the step at the instant `since`, and the contacts' ranges."""

    def read(self, place: int) -> str:
        """The number of a row in every place of a register."""
        return f"spread(A, b + {place})"

    def followed(self, name: str, order: int) -> str:
        """The series that the step has left of something followed."""
        shape = self.shape
        place = self.rows.places[f"term0_{shape.followed[0]}"] + shape.followed.index(name)
        return f"stored(A, b + {place}, {shape.breadth}, {order + 1})"

    def text(self) -> str:
        """The function."""
        nodes, weights = radau()
        n, m, shape, places = self.shape.n, self.shape.m, self.shape, self.rows.places
        self.put(f"unit = {self.row('window')} * {UNIT_OF_WINDOW!r}")
        self.put(f"here = each({nodes.tolist()}) * {self.row('since')}")
        self.put(f"share = each({weights.tolist()}) * since_ * unit")
        for i in range(n):
            self.put(f"q{i}, slope{i} = value_and_slope({self.followed(f'q{i}', ORDER + 1)}, here, {ORDER + 1})")
            self.put(f"v{i} = slope{i} / unit")
        for c in range(m):
            for name, order in (("n", ORDER), ("v", ORDER), ("f", ORDER - 1)):
                self.put(f"{name}{c}s = {self.followed(f'{name}{c}', order)}")
                self.put(f"{name}{c}_at = value({name}{c}s, here, {order})")
        load = [[row] if (row := self.entry(f"F{i}")) else [] for i in range(n)]
        if shape.varying:
            load = [[f"value({self.followed(f'F{i}', ORDER)}, here, {ORDER})"] for i in range(n)]
        contact = {name: [f"{name[0]}{c}_at" for c in range(m)] for name in ("normal", "force")}
        opened = [self.openness(c, f"at(n{c}s, 0)") for c in range(m)]  # the choice was made when the step began
        state = [f"q{i}" for i in range(n)], [f"v{i}" for i in range(n)]
        for k, power in enumerate(self.powers(state, contact, load, opened)):
            if power:
                self.put(f"store_one(A, b + {places[f'gain{k}']}, over_all('fadd', share * ({power})))")
        for c in range(m):
            least = f"over_all('fmin', n{c}_at)" if c in shape.pressed else "np.inf"
            self.put(f"store_one(A, b + {places[f'trough{c}']}, {least})")
            self.put(f"store_one(A, b + {places[f'peak{c}']}, over_all('fmax', abs(v{c}_at)))")
        return "\n".join([f"\n@wide({NODES})", "def works_at(A, b):", *self.lines, '    return "0"\n'])

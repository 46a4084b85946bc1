"""The text that tells whether a step is free of events, for the writer of the step in `step_text`."""

from collections.abc import Sequence
from math import comb
from typing import Any

import numpy as np

from squealbox.transient._sharing import RISES
from squealbox.transient.lanes.equation_text import EquationText, minus


def probes(rule: Any) -> list[int]:
    """Stages inside a step whose states tell most of it: the last, or three of a method with many."""
    inside = [k for k in range(1, rule.stages) if 0.2 < rule.c[k] < 0.9]
    return [inside[-4], inside[-2], inside[-1]] if len(inside) > 6 else inside[-1:]


def slope_weights(places: Sequence[float], at: float = 1.0) -> list[float]:
    """Weights of the values at these places for the slope there of the polynomial through them."""
    powers = np.vander(np.array(places), increasing=True).T
    slopes = [k * at ** max(k - 1, 0) for k in range(len(places))]
    return [float(x) for x in np.linalg.solve(powers, slopes)]


def bernstein_weights(places: Sequence[float]) -> list[list[float]]:
    """Weights of the values at these places for each Bernstein coefficient of the polynomial through them."""
    degree, at = len(places) - 1, np.array(places)
    values = [comb(degree, k) * at**k * (1.0 - at) ** (degree - k) for k in range(degree + 1)]
    return [[float(x) for x in row] for row in np.linalg.inv(np.stack(values, axis=1))]


class EventText(EquationText):
    """Writes the event functions of a Runge-Kutta step, which sets what stands here."""

    rule: Any
    probes: list[int]
    weights: list[float]

    def events(self, contact: Any, v: list[str], a: list[str], q1: list[str], v1: list[str], a1: list[str]) -> None:
        """`accepted` and `event`: whether every event function surely stays positive over the step.

        Each function that varies smoothly is a cubic between its values and slopes at both ends; it has no root when
        the cubic's Bernstein coefficients stay positive with a margin. The margin of a sticking contact is looked at
        in every stage. A trial that aims at an event lands when it ends beside it; `share` of the step is missing.
        """
        shape, end = self.shape, contact[-1]
        m = shape.m
        target, trust = self.row("target"), self.row("trust")
        self.put(f"landing = {target} >= 0.0")
        self.put("clear = fine")
        self.put(f"angle = {self.row('highest')} * hh")
        self.put("gap = pace = held = 0.0 * t_")
        for j in range(shape.functions):
            c = j % m
            if j < m:
                value, rate0, rate1, inner = self.first_function(c, contact, v, a, v1, a1)
            else:
                value, rate0, rate1 = self.second_function(c, end, v, v1)
                inner = value
            self.put(f"value{j} = {value}")
            self.put(f"rate0{j} = {rate0}")
            self.put(f"rate1{j} = {rate1}")
            phi, fresh = self.row(f"phi{j}"), self.row(f"fresh{j}") if j < m else "0.0 * t_"
            self.put(f"left{j} = {phi} + hh * rate0{j} * {1 / 3!r}")
            self.put(f"right{j} = value{j} - hh * rate1{j} * {1 / 3!r}")
            self.doubt(j, phi, self.sticks(j) if j < m else None)
            self.put(f"inner{j} = {inner}")
            self.put(f"inside{j} = ({phi} + 3.0 * left{j} > -1.0 * hh * {fresh}) & (left{j} + right{j} > doubt{j})")
            self.put(f"inside{j} = inside{j} & (3.0 * right{j} + value{j} > 0.0) & (inner{j} > 0.0)")
            self.put(f"inside{j} = inside{j} | ({trust} > 0.5)")
            self.put(f"here{j} = {target} == {float(j)}")
            self.put(f"steep{j} = hh * rate1{j}")
            if j < m:
                fall = self.fall(phi, [part["margin"][j] for part in contact])
                self.put(f"steep{j} = steep{j} + {self.sticks(j)} * {fall}")
                self.put(f"held = held + 1.0 * here{j} * {self.sticks(j)}")
            self.put(f"gap = gap + 1.0 * here{j} * value{j}")
            self.put(f"pace = pace + 1.0 * here{j} * steep{j}")
        for j in range(shape.functions):
            sure = f"here{j} | ((value{j} > 0.0) & inside{j})"
            if shape.functions > 1:  # another root in the same place, as of two contacts on one motion
                self.put(f"near = minimum({self.row('tolerance')}, 1e-9 * (abs({self.row(f'phi{j}')}) + abs(left{j})))")
                sure += f" | (landing & (abs(value{j}) <= 4.0 * abs(gap) + near))"
            self.put(f"clear = clear & ({sure})")
        # a contact let go a little too early would stick again at once: the margin of one that sticks is reached closer
        self.put(f"reach = minimum({self.reach!r} * rtol_, 1e-3) * (1.0 - 0.999 * held)")
        self.put("mended = (abs(gap) <= -1.0 * reach * pace) & (t_ + 1.01 * hh < t_end_)")
        self.put(f"close = mended | (abs(gap) <= {self.row('tolerance')})")
        self.put("accepted = clear & (close | ~landing)")
        self.put("share = where(landing & accepted & mended, -1.0 * gap / minimum(pace, -1e-300), 0.0)")
        self.put("shift = share * hh")
        self.put("event = fine & ((landing & accepted) | ~accepted)")
        for j in range(shape.functions):
            for name, value in (("end", "value"), ("rate", "rate0"), ("rate_end", "rate1"), ("inner", "inner")):
                self.keep(f"{name}{j}", f"{value}{j}")
        self.keep("close", "1.0 * close")
        self.keep("pace", "pace")
        for c in range(m):
            for k, stage in enumerate(self.probes):
                self.keep(f"probe{k}_{c}", contact[stage - 1]["margin"][c])
            if len(self.probes) > 1:
                self.early(c, contact[self.probes[0] - 1])

    def doubt(self, j: int, first: str, sticks: str | None) -> None:
        """`doubt{j}`: a third of the number D by which the function may differ from its cubic, D (x (1 - x))^2.

        See `crossing.doubt_of`. As a quartic in Bernstein's form the sum differs from the cubic in the middle alone.
        """
        self.put(f"down, across, up = left{j} - {first}, right{j} - left{j}, value{j} - right{j}")
        self.put("bend = maximum(abs(across - down), abs(up - across))")
        self.put("bend = maximum(bend, 0.5 * angle * maximum(abs(down), abs(up)))")
        self.put(f"doubt{j} = {1 / 3!r} * angle * angle * bend" + (f" * (1.0 - {sticks})" if sticks else ""))

    def early(self, c: int, part: Any) -> None:
        """Value and slope at the first probe of the function of a contact that does not stick."""
        stage = self.probes[0]
        velocity = [f"v{i}s{stage}" for i in range(self.shape.n)]
        time = f"t_ + {float(self.rule.c[stage])!r} * hh"
        value = f"{self.row(f's{c}')} * {part['speed'][c]}"
        if self.shape.unilateral[c]:
            value += f" - {self.row(f'open{c}')} * {part['normal'][c]}"
        self.keep(f"early{c}", value)
        self.keep(f"early_rate{c}", self.first_rate(c, velocity, part["a"], time))

    def fall(self, first: str, stages: list[str]) -> str:
        """Slope at the end, times the step, of what has these values at the start and in each stage."""
        values = [first, *(stages[k - 1] for k in self.probes), stages[-1]]
        return "(" + " + ".join(f"{w!r} * {x}" for w, x in zip(self.weights, values, strict=True)) + ")"

    def mended(
        self, contact: Any, a: list[str], q1: list[str], v1: list[str], a1: list[str]
    ) -> tuple[list[str], list[str], list[str]]:
        """The state at the event beside which a trial has landed: Taylor's series over `shift`; the same elsewhere."""
        for i in range(self.shape.n):
            jerk = self.fall(a[i], [x["a"][i] for x in contact]) if self.shape.has_mass(i) else "0.0 * t_"
            self.put(f"jerk{i} = share * {jerk}")
            self.put(f"q_at{i} = {q1[i]} + shift * ({v1[i]} + 0.5 * shift * {a1[i]})")
            self.put(f"v_at{i} = {v1[i]} + shift * ({a1[i]} + 0.5 * jerk{i})")
            self.put(f"a_at{i} = {a1[i]} + jerk{i}")
        q2, v2, a2 = ([f"{x}_at{i}" for i in range(self.shape.n)] for x in "qva")
        return q2, v2, a2

    def first_function(
        self, c: int, contact: Any, v: list[str], a: list[str], v1: list[str], a1: list[str]
    ) -> tuple[str, str, str, str]:
        """(value at the end, slopes at both ends, least value inside) of the function of a contact's mode."""
        end, stick = contact[-1], self.sticks(c)
        rates = self.first_rate(c, v, a, "t_"), self.first_rate(c, self.velocity, a1, "t_ + hh")
        if not self.shape.along(c):
            value = f"1.0 - {self.row(f'open{c}')}" if self.shape.unilateral[c] else "1.0 + 0.0 * t_"
            inner = "1.0 + 0.0 * t_"
            rates = ("0.0 * t_", "0.0 * t_")
        else:
            noise = self.row(f"noise{c}")
            s = self.row(f"s{c}")
            slides = self.rubbing(c, f"{s} * {end['speed'][c]}", f"{s} * {s}")
            value = f"{slides} + {stick} * ({end['margin'][c]} + {noise})"
            inner = end["margin"][c]
            for part in self.inside_margins(c, contact):
                inner = f"minimum({inner}, {part})"
            inner = f"where({stick} > 0.5, {inner} + {noise}, 1.0)"
        if self.shape.unilateral[c]:
            value += f" - {self.row(f'open{c}')} * {end['normal'][c]}"
        return value, *rates, inner

    def inside_margins(self, c: int, contact: Any) -> list[str]:
        """The margin in each stage; under a schedule, whose dips are short, the Bernstein coefficients through some."""
        if not self.shape.varying:
            return [part["margin"][c] for part in contact[:-1]]
        values = [self.row(f"phi{c}"), *(contact[k - 1]["margin"][c] for k in self.watched), contact[-1]["margin"][c]]
        out = []
        for k, weights in enumerate(bernstein_weights([0.0, *self.rule.c[self.watched], 1.0])[1:-1]):
            terms = " + ".join(f"{w!r} * {x}" for w, x in zip(weights, values, strict=True))
            self.put(f"coefficient{c}_{k} = {terms}")
            out.append(f"coefficient{c}_{k}")
        return out

    @property
    def watched(self) -> list[int]:
        """Stages whose margins, with those at both ends, make a polynomial."""
        inside = [k for k in range(1, self.rule.stages) if 0.2 < self.rule.c[k] < 0.95]
        return self.probes if len(self.probes) > 1 else inside[:2]

    def first_rate(self, c: int, v: list[str], a: list[str], time: str) -> str:
        """Slope of the function of a contact's mode; that of a margin is not at hand."""
        time = self.within(time)
        parts = self.signal(c, f"V{c}", time, rate=True) + minus(self.product(f"t{c}", a))
        rate = f"{self.row(f's{c}')} * ({' + '.join(parts) if parts else '0.0 * t_'})".replace("+ -", "- ")
        rate = self.rubbing(c, rate, "0.0 * t_")
        if not self.shape.unilateral[c]:
            return rate
        return f"{rate} - {self.row(f'open{c}')} * {self.normal_rate(c, v, time)}"

    def second_function(self, c: int, end: Any, v: list[str], v1: list[str]) -> tuple[str, str, str]:
        """The normal force of a unilateral contact that slips; 1 otherwise."""
        if not self.shape.unilateral[c]:
            return "1.0 + 0.0 * t_", "0.0 * t_", "0.0 * t_"
        s = self.row(f"s{c}")
        # held by another contact, one whose friction rises from zero lifts off with N as one that slips does
        slips = f"({s} * {s} + {self.sticks(c)} * ({self.row(f'law{c}_0')} <= {RISES!r}))"
        rates = [f"{slips} * {self.normal_rate(c, x, at)}" for x, at in ((v, "t_"), (v1, "t_ + hh"))]
        return f"where({slips} > 0.5, {end['normal'][c]}, 1.0)", rates[0], rates[1]

    def normal_rate(self, c: int, v: list[str], time: str) -> str:
        """N0' + n . q'."""
        parts = self.signal(self.shape.m + c, f"N0{c}", self.within(time), rate=True) + self.product(f"n{c}", v)
        return f"({' + '.join(parts) if parts else '0.0 * t_'})"

    @property
    def reach(self) -> float:
        """How far beside its event a trial may end, in steps and parts of rtol; a tenth of it for a sticking contact.

        Taylor's series takes the third derivative, and for a sticking contact the slope of its margin, from the stages.
        """
        return 1000.0 if len(self.probes) > 1 else 100.0

    @property
    def velocity(self) -> list[str]:
        """The velocities at the end of the step."""
        return [f"v{i}s{self.rule.stages}" for i in range(self.shape.n)]

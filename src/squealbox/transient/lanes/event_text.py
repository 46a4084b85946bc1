"""The text that tells whether a step is free of events, for the writer of the step in `step_text`."""

from typing import Any

from squealbox.transient.lanes.shape import Shape


def minus(terms: list[str]) -> list[str]:
    """Each term with its sign turned."""
    return ["-" + term for term in terms]


class EventText:
    """Writes the event functions; the rest of a `Step` gives it lines, rows and signals."""

    shape: Shape
    rule: Any
    middle_stage: int
    put: Any
    row: Any
    keep: Any
    signal: Any
    product: Any

    def events(self, contact: Any, v: Any, a: Any, q1: Any, v1: Any, a1: Any) -> None:
        """`accepted` and `event`: whether every event function surely stays positive over the step.

        Each function that varies smoothly is a cubic between its values and slopes at both ends; it has no root when
        the cubic's Bernstein coefficients stay positive with a margin. The margin of a sticking contact is looked at
        in every stage.
        """
        shape, end = self.shape, contact[-1]
        m = shape.m
        target, trust = self.row("target"), self.row("trust")
        self.put(f"landing = {target} >= 0.0")
        self.put("clear = fine")
        self.put("landed_at = 0.0 * t_")
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
            self.put(f"room{j} = 0.2 * (abs(value{j} - {phi}) + abs(left{j} - {phi}) + abs(right{j} - value{j}))")
            self.put(f"room{j} = room{j} * (1.0 * (abs(rate0{j}) + abs(rate1{j}) > 0.0))")
            self.put(f"inner{j} = {inner}")
            self.put(f"inside{j} = (left{j} > room{j} * (1.0 - {fresh})) & (right{j} > room{j}) & (inner{j} > 0.0)")
            self.put(f"inside{j} = inside{j} | ({trust} > 0.5)")
            self.put(f"here{j} = {target} == {float(j)}")
            self.put(f"sure{j} = here{j} | ((value{j} > room{j} * (1.0 - {trust})) & inside{j})")
            self.put(f"clear = clear & sure{j}")
            self.put(f"landed_at = landed_at + 1.0 * here{j} * abs(value{j})")
        self.put(f"close = landed_at <= {self.row('tolerance')}")
        self.put("accepted = clear & (close | ~landing)")
        self.put("event = fine & ((landing & accepted) | ~accepted)")
        for j in range(shape.functions):
            for name, value in (("end", "value"), ("rate", "rate0"), ("rate_end", "rate1"), ("inner", "inner")):
                self.keep(f"{name}{j}", f"{value}{j}")
        for c in range(m):
            self.keep(f"middle{c}", contact[self.middle_stage - 1]["margin"][c])

    def first_function(self, c: int, contact: Any, v: Any, a: Any, v1: Any, a1: Any) -> tuple[str, str, str, str]:
        """(value at the end, slopes at both ends, least value inside) of the function of a contact's mode."""
        shape, end = self.shape, contact[-1]
        s, wide = self.row(f"s{c}"), self.row(f"open{c}") if shape.unilateral[c] else None
        stick = f"(1.0 - {s} * {s}" + (f" - {wide})" if wide else ")")
        rates = []
        for vector, time in ((a, "t_"), (a1, "t_ + hh")):
            parts = self.signal(c, f"V{c}", time, rate=True) + minus(self.product(f"t{c}", vector))
            rates.append(f"{s} * ({' + '.join(parts) if parts else '0.0 * t_'})".replace("+ -", "- "))
        value = f"{s} * {end['speed'][c]} + {stick} * {end['margin'][c]}"
        inner = end["margin"][c]
        for part in contact[:-1]:
            inner = f"minimum({inner}, {part['margin'][c]})"
        inner = f"where({stick} > 0.5, {inner}, 1.0)"
        if wide:
            value += f" - {wide} * {end['normal'][c]}"
            for i, vector in enumerate((v, self.velocity)):
                rates[i] += f" - {wide} * {self.normal_rate(c, vector, ('t_', 't_ + hh')[i])}"
        return value, rates[0], rates[1], inner

    def second_function(self, c: int, end: Any, v: Any, v1: Any) -> tuple[str, str, str]:
        """The normal force of a unilateral contact that slips; 1 otherwise."""
        if not self.shape.unilateral[c]:
            return "1.0 + 0.0 * t_", "0.0 * t_", "0.0 * t_"
        s = self.row(f"s{c}")
        slips = f"({s} * {s})"
        rates = [f"{slips} * {self.normal_rate(c, x, at)}" for x, at in ((v, "t_"), (v1, "t_ + hh"))]
        return f"where({slips} > 0.5, {end['normal'][c]}, 1.0)", rates[0], rates[1]

    def normal_rate(self, c: int, v: Any, time: str) -> str:
        """N0' + n . q'."""
        parts = self.signal(self.shape.m + c, f"N0{c}", time, rate=True) + self.product(f"n{c}", v)
        return f"({' + '.join(parts) if parts else '0.0 * t_'})"

    @property
    def velocity(self) -> list[str]:
        """The velocities at the end of the step."""
        return [f"v{i}s{self.rule.stages}" for i in range(self.shape.n)]

"""The equation of motion of a lane engine as text, whatever kind of step is taken along it.

It is that of `_motion.derivative`, unrolled: every entry of a matrix that is not zero in the whole ensemble becomes one
term. Rows of one double for each lane hold the parameters and the state of a group; `Places` tells where each is.

While contacts stick, t . q'' = V' gives their forces F = G_ss^-1 (V' - t . a), a the accelerations without them; the
rows H hold G_ss^-1, zero for the others, and change only at events.
"""

from squealbox.schedules import SCHEDULES
from squealbox.transient._motion import ARCTAN
from squealbox.transient.lanes.formulas import is_table
from squealbox.transient.lanes.shape import Shape, layout

CALLED = """

@inner
def step(A, b):
    return trial(A, b)
"""


def minus(terms: list[str]) -> list[str]:
    """Each term with its sign turned."""
    return ["-" + term for term in terms]


class EquationText:
    """Writes the accelerations; a kind of step adds `friction`, `margin` and its own lines."""

    def __init__(self, shape: Shape) -> None:
        self.shape, self.rows = shape, layout(shape)
        self.lines: list[str] = []
        self.loaded: set[str] = set()
        self.tag = 0

    def friction(self, c: int, k: int, speed: str, normal: str) -> str:
        """Friction force of a sliding contact; 0 while it sticks or is open."""
        raise NotImplementedError

    def margin(self, c: int, k: int, normal: str) -> str:
        """How far the force of a sticking contact is below its limit."""
        raise NotImplementedError

    def put(self, line: str) -> None:
        """One more line."""
        self.lines.append("    " + line)

    def row(self, name: str) -> str:
        """A local with the row's values, loaded at its first use."""
        local = f"{name}_"
        if name not in self.loaded:
            self.loaded.add(name)
            self.put(f"{local} = {self.read(self.rows.places[name])}")
        return local

    def read(self, place: int) -> str:
        """The numbers of a row as they are worked with: one for each lane."""
        return f"load(A, b + {place * self.shape.lanes})"

    def keep(self, name: str, value: str) -> None:
        """Write a row."""
        self.put(f"store(A, b + {self.rows.places[name] * self.shape.lanes}, {value})")

    def entry(self, name: str) -> str | None:
        """The local of an entry of the equation, None when it is zero throughout."""
        return self.row(name) if name in self.shape.present else None

    def total(self, target: str, parts: list[str]) -> str:
        """target = sum of the parts."""
        self.put(f"{target} = {' + '.join(parts) if parts else '0.0 * t_'}".replace("+ -", "- "))
        return target

    def product(self, name: str, vector: list[str]) -> list[str]:
        """Terms name{i} * vector[i] that are present."""
        found = [(self.entry(f"{name}_{i}"), x) for i, x in enumerate(vector)]
        return [f"{a} * {x}" for a, x in found if a is not None]

    def signal(self, index: int, name: str, time: str, rate: bool = False) -> list[str]:
        """Terms of V_c, N0_c or M^-1 f_i at an instant."""
        if not self.shape.varying:
            value = None if rate else self.entry(name)
            return [] if value is None else [value]
        parts = []
        for k, (kind, count) in enumerate(self.shape.signals[index]):
            p = self.given(f"given{index}_{k}_", count, is_table(SCHEDULES, kind), 0)
            parts.append(f"{self.row(f'weight{index}_{k}')} * lane_{'rate' if rate else 'value'}_{kind}({time}, {p})")
        return parts

    def given(self, name: str, count: int, table: bool, at: int) -> str:
        """The coefficients name0, name1, ... of a formula; of a long one they stay in memory, p[at] known."""
        if not table:
            return "(" + ", ".join(self.row(f"{name}{i}") for i in range(count)) + ",)"
        columns = 3 - (at == 0)  # speeds, coefficients and slopes of a law; instants and values of a schedule
        known = {} if at < 0 else {at: (count - 1) // columns}
        return f"Given(A, b + {self.rows.places[f'{name}0'] * self.shape.lanes}, {count}, {known})"

    def accelerations(self, q: list[str], v: list[str], time: str) -> dict[str, list[str]]:
        """q'' in locals, with the speed, normal force, friction force and stick margin of each contact."""
        n, m, shape = self.shape.n, self.shape.m, self.shape
        time = self.within(time)
        self.tag += 1
        k = self.tag
        speeds = [self.total(f"v{c}_{k}", self.speed(c, q, v, time)) for c in range(m)]
        normals = [self.total(f"n{c}_{k}", self.signal(m + c, f"N0{c}", time) + self.product(f"n{c}", q))
                   for c in range(m)]  # fmt: skip
        forces = [
            self.smooth_force(c, k, speeds[c], normals[c], q)
            if shape.is_smooth(c)
            else self.friction(c, k, speeds[c], normals[c])
            for c in range(m)
        ]
        out = []
        for i in range(n):
            parts = self.signal(2 * m + i, f"f{i}", time)
            parts += minus(self.product(f"mk{i}", q)) + minus(self.product(f"mc{i}", v))
            parts += [f"creep{c}_{k}" for c, row in enumerate(shape.memories) if row == i]
            for c in range(m):
                push, lift = self.entry(f"md{c}_{i}"), self.entry(f"mw{c}_{i}")
                parts += [f"{push} * {forces[c]}"] if push else []
                if shape.unilateral[c] and lift:
                    parts.append(f"{lift} * ({self.openness(c, normals[c])} * {normals[c]})")
            out.append(self.total(f"a{i}_{k}", parts))
        margins = self.hold(k, out, forces, normals, time) if shape.exact else []
        return {"a": out, "speed": speeds, "normal": normals, "force": forces, "margin": margins}

    def within(self, time: str) -> str:
        """An instant of a step; of its end what is just before, so that a kink there is seen from the left."""
        if not self.shape.varying or time == "t_":
            return time
        self.tag += 1
        self.put(f"at{self.tag} = minimum({time}, inside_)")
        return f"at{self.tag}"

    def speed(self, c: int, q: list[str], v: list[str], time: str) -> list[str]:
        """Terms of the sliding velocity V - t . q' - s . q of a contact."""
        return self.signal(c, f"V{c}", time) + minus(self.product(f"t{c}", v)) + minus(self.product(f"s{c}", q))

    def smooth_force(self, c: int, k: int, speed: str, normal: str, q: list[str]) -> str:
        """Friction force of a contact without events, and the rate of its memory."""
        kind, z = self.shape.smooth[c] - 1, "0.0"
        p = self.given(f"law{c}_", self.shape.laws[c][1], False, 1)
        rate = "0.0"
        if self.shape.memories and self.shape.memories[c] >= 0:
            z, rate = q[self.shape.memories[c]], f"creep{c}_{k}"
            self.put(f"{rate} = lane_creep_{kind}({speed}, {z}, {p})")
        shut = f" * (1.0 - {self.openness(c, normal)})" if self.shape.unilateral[c] else ""
        self.put(f"f{c}_{k} = lane_grip_{kind}({speed}, {z}, {rate}, {p}) * {normal}{shut}")
        return f"f{c}_{k}"

    def smoothed(self, c: int, speed: str, normal: str, p: str) -> str:
        """Friction force of a contact whose sgn is smoothed."""
        at = f"{speed} / {self.row('width')}"
        sign = f"({2.0 / 3.141592653589793!r} * arctan({at}))" if self.shape.scheme == ARCTAN else f"lane_tanh({at})"
        shut = f" * (1.0 - {self.openness(c, normal)})" if self.shape.unilateral[c] else ""
        return f"lane_mu_{self.shape.laws[c][0]}(abs({speed}), {p}) * {sign} * {normal}{shut}"

    def openness(self, c: int, normal: str) -> str:
        """1 where a unilateral contact is open, else 0."""
        return self.row(f"open{c}") if self.shape.exact else f"(1.0 * ({normal} <= 0.0))"

    def hold(self, k: int, a: list[str], forces: list[str], normals: list[str], time: str) -> list[str]:
        """Add the forces of sticking contacts; returns how far each is below its limit."""
        m, shape = self.shape.m, self.shape
        for c in range(m):
            parts = self.signal(c, f"V{c}", time, rate=True) + minus(self.product(f"t{c}", a))
            self.total(f"r{c}_{k}", parts)
        margins = []
        for c in range(m):
            self.put(f"hold{c}_{k} = " + " + ".join(f"{self.row(f'h{c}_{x}')} * r{x}_{k}" for x in range(m)))
        for group in shape.groups:
            self.share_out(k, group, normals)
        for c in range(m):
            self.put(f"{forces[c]} = {forces[c]} + hold{c}_{k}")
            margins.append(self.margin(c, k, normals[c]))
        for i in range(shape.n):
            parts = [f"{push} * hold{c}_{k}" for c in range(m) if (push := self.entry(f"md{c}_{i}"))]
            self.put(f"{a[i]} = {a[i]} + " + " + ".join(parts) if parts else "pass")
        return margins

    def rubbing(self, c: int, value: str, without: str) -> str:
        """The value where contact c has friction; without any it reverses as if it were not there."""
        return f"where({self.row(f'law{c}_0')} > 0.0, {value}, {without})" if c in self.shape.slick else value

    def share_out(self, k: int, group: tuple[int, ...], normals: list[str]) -> None:
        """What the sticking contacts of one motion carry of its force: F_c over its limit is the same for all."""
        total = " + ".join(f"{self.row(f'lever{c}')} * hold{c}_{k}" for c in group)
        idle = " * ".join(f"(1.0 - {self.sticks(c)})" for c in group)
        for c in group:
            self.put(f"part{c}_{k} = {self.row(f'law{c}_0')} * {normals[c]} * {self.sticks(c)}")
        limit = " + ".join(f"abs(lever{c}_) * part{c}_{k}" for c in group)
        self.put(f"ratio{group[0]}_{k} = ({total}) / ({limit} + {idle} + 1e-300)")
        for c in group:
            self.put(f"hold{c}_{k} = where(lever{c}_ > 0.0, 1.0, -1.0) * part{c}_{k} * ratio{group[0]}_{k}")

    def powers(
        self,
        state: tuple[list[str], list[str]],
        contact: dict[str, list[str]],
        load: list[list[str]],
        opened: list[str],
    ) -> list[str]:
        """Powers of each friction, of load, circulation, damping and opening, as `_motion.energy_rates` has them.

        Given are names: of q and q', of the contacts' "force" and "normal" force, the terms of the load on each row,
        and what is 1 for each contact that is open, else 0; "" comes back where there is nothing.
        """
        shape, (q, v) = self.shape, state

        def against(name: str, sign: str, of: list[str]) -> str:
            rows = [(" + ".join(self.product(f"{name}{i}", of)), x) for i, x in enumerate(v)]
            return " + ".join(f"{sign}{x} * ({row})" for row, x in rows if row)

        along = [" + ".join(self.product(f"d{c}", v)) for c in range(shape.m)]
        out = [f"{force} * ({row})" if row else "" for force, row in zip(contact["force"], along, strict=True)]
        out.append(" + ".join(f"({' + '.join(terms)}) * {x}" for terms, x in zip(load, v, strict=True) if terms))
        out += [against("ka", "-1.0 * ", q) if shape.audited else "", against("c", "", v)]
        lifted = [(" + ".join(self.product(f"w{c}", v)), c) for c in range(shape.m) if shape.unilateral[c]]
        out.append(" + ".join(f"{opened[c]} * {contact['normal'][c]} * ({row})" for row, c in lifted if row))
        return out

    def flag(self, code: str, any_of: str) -> None:
        """`flags`: the lanes that need service; what each needs is written down only when one does."""
        self.put(f"flags = bits(({any_of}) & (alive_ > 0.5))")
        self.put(f"if_flagged(flags, lambda: store(A, b + {self.rows.places['code'] * self.shape.lanes}, {code}))")

    def sticks(self, c: int) -> str:
        """1 while a contact sticks, else 0."""
        s = self.row(f"s{c}")
        return f"(1.0 - {s} * {s}" + (f" - {self.row(f'open{c}')})" if self.shape.unilateral[c] else ")")

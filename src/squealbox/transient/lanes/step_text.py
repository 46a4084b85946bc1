"""The step of a lane engine as text: one trial step of several trajectories, without a branch on any of them.

Friction in the exact scheme. s is +1 or -1 while a contact slips and 0 otherwise, so ``s mu(s v) N`` vanishes when it
does not; `equation_text` tells how contacts stick.
"""

from typing import Any

from squealbox.friction import LAWS
from squealbox.transient._motion import RAW
from squealbox.transient.lanes.equation_text import CALLED, minus
from squealbox.transient.lanes.event_text import probes, slope_weights
from squealbox.transient.lanes.formulas import in_memory
from squealbox.transient.lanes.recorded_text import RecordedText
from squealbox.transient.lanes.shape import Shape
from squealbox.transient.methods import tableau
from squealbox.transient.rows import ALGEBRAIC, FIRST_ORDER, WITH_MASS

LEAST_SQUARE = 1e-8  # of an error that the next step is told


class Step(RecordedText):
    """Writes the text of the step."""

    def __init__(self, shape: Shape) -> None:
        super().__init__(shape)
        self.scales: dict[float, str] = {}
        self.starting: dict[str, list[str]] | None = None
        self.rule = tableau(shape.tableau)
        self.probes = probes(self.rule)
        places = [0.0, *self.rule.c[self.probes], 1.0]
        self.weights, self.first_weights = slope_weights(places, 1.0), slope_weights(places, 0.0)

    def forget(self) -> None:
        """Rows are read again after this point."""
        self.put("forget()")
        self.loaded.clear()

    def friction(self, c: int, k: int, speed: str, normal: str) -> str:
        """Friction force of a sliding contact; 0 while it sticks or is open."""
        shape, force = self.shape, f"f{c}_{k}"
        kind, count = shape.laws[c]
        p = self.given(f"law{c}_", count, in_memory(kind, shape.own), 1 if kind < len(LAWS) else -1)
        if shape.exact:
            s = self.row(f"s{c}")
            self.put(f"u{c}_{k} = {s} * {speed}")
            mu = f"(lane_mu_{kind}(maximum(u{c}_{k}, 0.0), {p}) + minimum(u{c}_{k}, 0.0) * {self.row(f'slope{c}')})"
            self.put(f"{force} = {s} * {mu} * {normal}")
            return force
        if shape.scheme == RAW:
            shut = f" * (1.0 - {self.openness(c, normal)})" if shape.unilateral[c] else ""
            self.put(f"{force} = with_sign(lane_mu_{kind}(abs({speed}), {p}) * {normal}, {speed}){shut}")
            return force
        self.put(f"{force} = {self.smoothed(c, speed, normal, p)}")
        return force

    def margin(self, c: int, k: int, normal: str) -> str:
        """How far the force of a sticking contact is below its limit."""
        self.put(f"g{c}_{k} = {self.row(f'law{c}_0')} * {normal} - abs(hold{c}_{k})")
        return f"g{c}_{k}"

    @staticmethod
    def constants(shape: Shape) -> dict[str, float]:
        """Numbers that stand in the texts of the passes over one lane."""
        rule = tableau(shape.tableau)
        at = [float(rule.c[k]) for k in probes(rule)]
        return {"PROBES": len(at)} | {f"PROBE_{k}": place for k, place in enumerate((at * 3)[:3])}

    def text(self) -> str:
        """The function `step(A, b)`: advance one group by one trial; returns the lanes that need service as bits."""
        shape, n, rule = self.shape, self.shape.n, self.rule
        for name in ("t", "h", "t_end", "rtol", "alive"):
            self.row(name)
        self.put("rest = t_end_ - t_")
        self.put("inside_ = t_end_ - 1.7e-16 * abs(t_end_)")  # just below: a kink at the end is seen from the left
        self.put("last = h_ >= rest * 0.999999999999")
        self.put("hh = where(last, rest, h_)")
        q, v, a = ([self.row(f"{x}{i}") for i in range(n)] for x in "qva")
        vs, as_ = [v], [a]
        heavy, moving = shape.of(WITH_MASS), shape.of(WITH_MASS, FIRST_ORDER)
        contact: list[dict[str, list[str]]] = []
        for stage in range(1, rule.stages + 1):
            weights = rule.b if stage == rule.stages else rule.a[stage, :stage]
            self.forget()
            for i in moving:
                self.combined(f"q{i}s{stage}", q[i], weights, vs, i)
            for i in heavy:
                self.combined(f"v{i}s{stage}", v[i], weights, as_, i)
            qs, us = ([f"{x}{i}s{stage}" for i in range(n)] for x in "qv")
            time = "t_ + hh" if stage == rule.stages else f"t_ + {rule.c[stage]!r} * hh"
            contact.append(self.accelerations(qs, us, time))
            self.without_mass(contact[-1]["a"], qs, us)
            vs.append(us)
            as_.append(contact[-1]["a"])
        q1, v1 = qs, us
        a, a1 = self.slopes(v, a, us, contact)
        self.end = contact[-1]
        self.forget()
        self.error(q, v, q1, v1, vs, as_)
        self.put("fine = square <= 1.0")
        if shape.exact:
            self.events(contact, v, a, q1, v1, a1)
            q1, v1, a1 = self.mended(contact, a, q1, v1, a1)
        else:
            self.put("accepted = fine")
        self.forget()
        self.control()
        self.put("t1 = where(last, t_end_, t_ + hh" + (" + shift)" if shape.exact else ")"))
        self.observe(contact, (q, v, a), (q1, v1, a1))
        if shape.recorded:
            self.record(contact, (q, v))
        self.advance((q, v, a), (q1, v1, a1))
        head, tail = ["@traced", "def trial(A, b):"], ["    return flags", CALLED]
        return "\n".join([*head, *self.lines, *tail])

    def without_mass(self, x: list[str], q: list[str], v: list[str]) -> None:
        """In a stage: x is q' of rows of first order and q of algebraic ones, whose velocities follow."""
        for i in self.shape.of(FIRST_ORDER):
            self.put(f"{v[i]} = {x[i]}")
        for i in self.shape.of(ALGEBRAIC):
            self.put(f"{q[i]} = {x[i]}")
            self.total(v[i], minus(self.product(f"mk{i}", v)))

    def slopes(self, v: list[str], a: list[str], v1: list[str], contact: Any) -> tuple[list[str], list[str]]:
        """q'' at both ends; that of a row without mass by the polynomial through its velocities in the stages."""
        before, after = list(a), list(contact[-1]["a"])
        for i in self.shape.of(FIRST_ORDER):
            before[i], after[i] = f"begun{i}", f"ended{i}"
            values = [v[i], *(contact[k - 1]["a"][i] for k in self.probes), contact[-1]["a"][i]]
            self.put(f"per{i} = where(hh > 0.0, 1.0 / hh, 0.0)")
            for name, weights in ((before[i], self.first_weights), (after[i], self.weights)):
                terms = " + ".join(f"{w!r} * {x}" for w, x in zip(weights, values, strict=True))
                self.put(f"{name} = per{i} * ({terms})")
        for i in self.shape.of(ALGEBRAIC):
            before[i], after[i] = f"begun{i}", f"ended{i}"
            for name, rates in ((before[i], before), (after[i], after)):
                self.total(name, minus(self.product(f"mk{i}", rates)))
        return before, after

    def combined(self, name: str, base: str, weights: Any, parts: list[list[str]], i: int) -> str:
        """base + sum of hh * weight * part; the products hh * weight serve all states of a stage."""
        terms = [f"{self.scaled(float(w))} * {part[i]}" for w, part in zip(weights, parts, strict=False) if w != 0.0]
        self.put(f"{name} = {base} + {' + '.join(terms)}")
        return name

    def scaled(self, weight: float) -> str:
        """The local that holds hh * weight."""
        if weight not in self.scales:
            self.scales[weight] = f"hw{len(self.scales)}"
            self.put(f"{self.scales[weight]} = {weight!r} * hh")
        return self.scales[weight]

    def error(
        self, q: list[str], v: list[str], q1: list[str], v1: list[str], vs: list[list[str]], as_: list[list[str]]
    ) -> None:
        """`square`: the squared norm of the embedded error, as in `_runge_kutta.error_norm`."""
        n, rule = self.shape.n, self.rule
        states = [*self.shape.of(WITH_MASS, FIRST_ORDER), *(n + i for i in self.shape.of(WITH_MASS))]
        for k, (old, new) in enumerate(zip((*q, *v), (*q1, *v1), strict=True)):
            if k not in states:
                continue
            self.put(f"size{k} = {self.row(f'atol{k}')} + rtol_ * maximum(abs({old}), abs({new}))")
            self.put(f"square{k} = size{k} * size{k}")
        for tag, weights in (("e", rule.e), ("x", rule.e3)):
            if weights is None:
                continue
            for k in states:
                parts = vs if k < n else as_
                used = zip(weights, parts, strict=False)
                terms = [f"{float(w)!r} * {part[k % n]}" for w, part in used if w != 0.0]
                self.put(f"{tag}{k} = {' + '.join(terms)}".replace("+ -", "- "))
            self.put(f"sum_{tag} = " + " + ".join(self.quotients(tag, states)))
        if rule.e3 is None:
            self.put(f"square = hh * hh * sum_e * {1.0 / len(states)!r}")
        else:
            self.put("below = sum_e + 0.01 * sum_x")
            self.put("below = where(below > 0.0, below, 1.0)")
            self.put(f"square = hh * hh * sum_e * sum_e / below * {1.0 / len(states)!r}")

    def quotients(self, tag: str, states: list[int]) -> list[str]:
        """Sums of squares of error over size, up to four over one division: it costs as much as ten products."""
        out = []
        for first in range(0, len(states), 4):
            names = states[first : first + 4]
            above, below = f"{tag}{names[0]} * {tag}{names[0]}", f"square{names[0]}"
            for done, k in enumerate(names[1:], 1):
                self.put(f"{tag}a{k} = ({above}) * square{k} + {tag}{k} * {tag}{k} * ({below})")
                above = f"{tag}a{k}"
                below = " * ".join(f"square{x}" for x in names[: done + 1])
            out.append(f"{above} / ({below})")
        return out

    def control(self) -> None:
        """`h_new`: a proportional-integral controller (Gustafsson 1991) within [0.1, growth].

        After a rejected step it is an integral one, and without growth. `eased` is what the error before allows.
        """
        power, safety, easing = 0.5 / (self.rule.error_order + 1.0), self.rule.safety, self.rule.easing
        self.put("size = rough_log(square)")
        eased = f" + {self.row('eased')}" if easing else ""
        self.put(f"factor = {safety!r} * rough_exp({(0.75 * easing - 1.0) * power!r} * size{eased})")
        self.put("factor = where(square < 1e300, factor, 0.1)")
        self.put(f"factor = minimum(maximum(factor, 0.1), {float(self.rule.growth)!r})")
        self.put(f"factor = where({self.row('cautious')} > 0.5, minimum(factor, 1.0), factor)")
        again = f"minimum(maximum({safety!r} * rough_exp({-power!r} * size), 0.1), 0.9)"
        self.put(f"factor = where(fine, factor, where(square < 1e300, {again}, 0.1))")
        if easing:
            eased = f"{easing * power!r} * rough_log(maximum(square, {LEAST_SQUARE!r}))"
            self.keep("eased", f"where(fine, {eased}, 0.0)")
        self.put(f"h_new = minimum(hh * factor, {self.row('largest')})")
        self.put("h_new = where(fine & last, maximum(h_new, h_), h_new)")

    def advance(self, old: Any, new: Any) -> None:
        """Take the step where it is accepted, count, and say which lanes need service."""
        n, shape = self.shape.n, self.shape
        if shape.samples:
            self.keep("t_old", "t_")
            for x, values in zip("qva", old, strict=True):
                for i in range(n):
                    self.keep(f"{x}_old{i}", values[i])
        if shape.recorded:
            self.keep("t_old", "t_")
            for x, values in zip("qv", old, strict=False):
                for i in range(n):
                    self.keep(f"{x}_old{i}", values[i])
        for x, before, after in zip("qva", old, new, strict=True):
            for i in range(n):
                self.keep(f"{x}{i}", f"where(accepted, {after[i]}, {before[i]})")
        for c in shape.pressed:
            least = self.row(f"lowest{c}")
            self.keep(f"lowest{c}", f"where(accepted, minimum({least}, {self.end['normal'][c]}), {least})")
        for c in shape.ranging:
            most, speed = self.row(f"fastest{c}"), f"abs({self.end['speed'][c]})"
            self.keep(f"fastest{c}", f"where(accepted, maximum({most}, {speed}), {most})")
        self.put("t_now = where(accepted, t1, t_)")
        self.keep("t", "t_now")
        tries, taken = self.row("tries"), self.row("taken")
        self.keep("taken", f"{taken} + 1.0 * accepted")
        self.put(f"tried = {tries} + 1.0")
        self.keep("tries", "tried")
        self.put("done = t_now >= t_end_")
        self.put(f"lost = ~fine & (h_new <= {self.row('least')} + 4e-16 * t_)")
        self.put(f"over = tried >= {self.row('most')}")
        code = "1.0 * done + 2.0 * lost + 4.0 * over"
        any_of = "done | lost | over"
        if shape.exact:
            self.keep("h", "where(event, hh, h_new)")
            for j in range(shape.functions):
                self.keep(f"phi{j}", f"where(accepted, value{j} + share * steep{j}, {self.row(f'phi{j}')})")
            for c in range(shape.m):
                self.keep(f"fresh{c}", f"where(accepted, 0.0, {self.row(f'fresh{c}')})")
            for c, force in enumerate(self.end["force"]):
                self.keep(f"force{c}", force)
            self.keep("trust", f"where(accepted, 0.0, {self.row('trust')})")
            self.keep("target", "where(fine, target_, -1.0)")
            self.put("landed = event & accepted")
            code += " + 8.0 * event + 16.0 * landed"
            any_of += " | event"
        else:
            self.keep("h", "h_new")
        if shape.samples or shape.recorded:
            self.put(f"due = accepted & (t_now >= {self.row('next')})")
            code += " + 32.0 * due"
            any_of += " | due"
        self.keep("cautious", "where(fine, 0.0, 1.0)")
        self.flag(code, any_of)

    def observe(self, contact: Any, old: Any, new: Any) -> None:
        """Hand every accepted step to the observers."""
        shape = self.shape
        works = any(observer.of == "contact" for observer in shape.observers)
        if works:
            for c in range(shape.m):
                self.work(c, contact, old, new)
        for k, observer in enumerate(shape.observers):
            for i in range(shape.copies(observer)):
                memory = [self.row(f"o{k}_{i}_{j}") for j in range(len(observer.start))]
                given = [self.row(f"c{k}_{i}_{j}") for j in range(observer.coefficients)]
                before, after = self.views(observer.of, i, contact, old, new)
                p = "(" + "".join(f"{x}, " for x in given) + ")" if given else "(0.0 * t_,)"
                self.put(f"seen{k}_{i} = observe_{k}(({', '.join(memory)},), {p}, {before}, {after})")
                for j, value in enumerate(memory):
                    self.keep(f"o{k}_{i}_{j}", f"where(accepted, seen{k}_{i}[{j}], {value})")

    def views(self, of: str, i: int, contact: Any, old: Any, new: Any) -> tuple[str, str]:
        """What an observer of a degree of freedom, of a contact or of the whole sees before and after the step."""
        n, end = self.shape.n, contact[-1]
        if of == "dof":
            return tuple(  # type: ignore[return-value]
                f"Motion({t}, {', '.join(x[i] for x in state)})" for t, state in (("t_", old), ("t1", new))
            )
        if of == "contact":
            before, after = self.sliding(i, old, "t_"), (end["speed"][i], end["normal"][i])
            if self.shape.exact:  # the state may have been moved onto an event
                after = self.sliding(i, new, "t1")
            senses = self.shape.exact and not self.shape.is_smooth(i)
            mode = self.row(f"s{i}") if senses else f"(1.0 * ({end['speed'][i]} > 0.0) - 0.5) * 2.0"
            if self.shape.exact and self.shape.unilateral[i]:  # s is 0 in both; only a contact that sticks counts as 0
                mode = f"({mode} + 2.0 * {self.row(f'open{i}')})"
            work = self.row(f"work{i}")
            return (
                f"Sliding(t_, {', '.join(before)}, {mode}, {work})",
                f"Sliding(t1, {', '.join(after)}, {mode}, worked{i})",
            )
        n = n if self.shape.seen < 0 else self.shape.seen
        tuples = [", ".join(f"({', '.join(x[:n])},)" for x in state) for state in (old, new)]
        return f"State(t_, {tuples[0]})", f"State(t1, {tuples[1]})"

    def sliding(self, c: int, state: Any, time: str) -> tuple[str, str]:
        """Sliding velocity and normal force of a contact."""
        time = self.within(time)
        speed = self.speed(c, state[0], state[1], time)
        normal = self.signal(self.shape.m + c, f"N0{c}", time) + self.product(f"n{c}", state[0])
        return tuple(" + ".join(x).replace("+ -", "- ") or "0.0 * t_" for x in (speed, normal))  # type: ignore[return-value]

    def work(self, c: int, contact: Any, old: Any, new: Any) -> None:
        """Work of a contact's friction in the step by the weights of the method, added to its row."""
        rule, n = self.rule, self.shape.n
        parts = []
        for j, weight in enumerate(rule.b):
            if weight == 0.0:
                continue
            force = contact[j - 1]["force"][c] if j > 0 else self.starting_force(c, old)
            speed = old[1] if j == 0 else [f"v{i}s{j}" for i in range(n)]
            along = self.product(f"d{c}", speed)
            parts.append(f"{float(weight)!r} * {force} * ({' + '.join(along) if along else '0.0 * t_'})")
        worked = f"{self.row(f'work{c}')} + hh * ({' + '.join(parts)})"
        if self.shape.exact:
            along = self.product(f"d{c}", [f"v{i}s{rule.stages}" for i in range(n)])
            worked += f" + shift * {self.end['force'][c]} * ({' + '.join(along) if along else '0.0 * t_'})"
        self.put(f"worked{c} = {worked}")
        self.keep(f"work{c}", f"where(accepted, worked{c}, work{c}_)")

    def starting_force(self, c: int, old: Any) -> str:
        """The friction force at the start of the step, computed once more: no row keeps it."""
        if self.starting is None:
            self.starting = self.accelerations(old[0], old[1], "t_")
        return self.starting["force"][c]

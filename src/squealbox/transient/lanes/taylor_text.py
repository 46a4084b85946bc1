"""One Taylor step of a lane engine as text: the solution's own series, a step as long as its last terms allow.

The equation of motion is that of `equation_text`, run once on series instead of numbers. The series does not depend on
the step, so no step is tried in vain: its length follows from the last two coefficients (Jorba and Zou, Experimental
Mathematics 14(1), 99-117, 2005) and ends at the first event, which is a root of the series.
"""

from collections.abc import Iterator

from squealbox.friction import LAWS
from squealbox.transient._motion import TANH
from squealbox.transient._sharing import RISES
from squealbox.transient.lanes.equation_text import CALLED, EquationText
from squealbox.transient.lanes.formulas import is_table, law_text, smooth_text
from squealbox.transient.lanes.shape import ORDER, PARTS, UNIT_OF_WINDOW, WORK_ORDER, Shape
from squealbox.transient.lanes.works_text import WorksText
from squealbox.transient.rows import ALGEBRAIC, FIRST_ORDER, WITH_MASS

JUDGED = (0.35, 0.7, 0.999999)  # shares of a step at which laws are compared; the last before a kink that ends it
AMISS = 10.0  # tolerances by which what is amiss then may move a row: some twenty times what the series' end leaves

CALLED_BY_MODE = """

@inner
def step(A, b):
    if sticking(A, b) != 0:
        return trial(A, b)
    return glide(A, b)
"""


def states(q: list[str], v: list[str], a: list[str]) -> Iterator[tuple[str, str, int]]:
    """Name of a row, its series and the order to which that is known."""
    for name, series, order in (("q", q, ORDER + 1), ("v", v, ORDER), ("a", a, ORDER - 1)):
        yield from ((f"{name}{i}", each, order) for i, each in enumerate(series))


class TaylorStep(EquationText):
    """Writes the text of the step."""

    def __init__(self, shape: Shape) -> None:
        super().__init__(shape)
        self.gliding = False

    def text(self) -> str:
        """The function `step(A, b)`, and `series_at(A, b)` and `works_at(A, b)` of a recorded motion."""
        return self.steps() + (self.evaluation() if self.shape.recorded else "")

    def evaluation(self) -> str:
        """The text of `series_at(A, b)`: all followed series and their slopes at the instant `since`, side by side."""
        breadth, places = self.shape.breadth, self.rows.places
        first = places[f"term0_{self.shape.followed[0]}"]
        call = f"{places['since']}, {first}, {breadth}, {ORDER + 2}, {places['value0']}, {places['slope_value0']}"
        at_once = f"\n@wide({breadth})\ndef series_at(A, b):\n    return at_once(A, b, {call})\n"
        return at_once + WorksText(self.shape).text()

    def steps(self) -> str:
        """Another trial where no lane of the group sticks, without the forces that hold."""
        if not self.shape.exact:
            return self.trial("trial") + CALLED
        parts = [self.trial("trial")]
        self.gliding, self.lines, self.tag = True, [], 0
        self.loaded.clear()
        parts.append(self.trial("glide"))
        self.lines = []
        self.loaded.clear()
        truths = " | ".join(f"({self.sticks(c)} > 0.5)" for c in range(self.shape.m))
        self.put(f"return bits(({truths}) & ({self.row('alive')} > 0.5))")
        parts.append("\n".join(["@traced_as_written", "def sticking(A, b):", *self.lines]))
        return "\n".join(parts) + CALLED_BY_MODE

    def trial(self, name: str) -> str:
        """The text of one trial."""
        n = self.shape.n
        for given in ("t", "h", "t_end", "rtol", "alive", "window"):
            self.row(given)
        self.put(f"unit = window_ * {UNIT_OF_WINDOW!r}")
        self.put("inside_ = np.inf")
        self.put("rest = (t_end_ - t_) / unit")
        heavy, moving = self.shape.of(WITH_MASS), self.shape.of(WITH_MASS, FIRST_ORDER)
        for state in (*(f"q{i}" for i in moving), *(f"v{i}" for i in heavy)):
            self.put(f"{state}s = Series(None, ({self.row(state)},))")
        q, v = [f"q{i}s" for i in range(n)], [f"v{i}s" for i in range(n)]
        self.put("time = time_series(t_, unit)")
        self.put("with deciding() as kinks:")
        self.lines, before = [], self.lines
        found = self.accelerations(q, v, "time")
        found["a"] = self.without_mass(found["a"])
        names = ["".join(f"{x}{i}s, " for i in moving) for x in "qv"] + ["".join(f"{found['a'][i]}, " for i in heavy)]
        grown = "".join(f"v{i}s, " for i in heavy)
        self.put(f"grow(({names[0]}), ({names[1]}), ({grown}), ({names[2]}), unit, {ORDER})")
        self.lines = before + ["    " + line for line in self.lines]
        self.length(v)
        self.ending(found)
        self.observe_parts(found, q, v)
        if self.shape.recorded:
            self.record(found, q)
        self.finish(found, q, v)
        return "\n".join(["@traced_as_written", f"def {name}(A, b):", *self.lines, "    return flags\n"])

    def without_mass(self, x: list[str]) -> list[str]:
        """q'' of every row, where x is q' of rows of first order and q of algebraic ones."""
        out = list(x)
        for i in self.shape.of(FIRST_ORDER):
            self.put(f"v{i}s = {x[i]}")
        for i in self.shape.of(ALGEBRAIC):
            self.put(f"q{i}s = {x[i]}")
            self.put(f"v{i}s = slope_series(q{i}s) * (1.0 / unit)")
        for i in self.shape.of(FIRST_ORDER, ALGEBRAIC):
            out[i] = f"a{i}s"
            self.put(f"a{i}s = slope_series(v{i}s) * (1.0 / unit)")
        return out

    def hold(self, k: int, a: list[str], forces: list[str], normals: list[str], time: str) -> list[str]:
        """As usual; nothing where no contact sticks."""
        return [] if self.gliding else super().hold(k, a, forces, normals, time)

    def given(self, name: str, count: int, table: bool, at: int) -> str:
        """A bound that is infinite in the whole ensemble stays a plain number, which chooses nothing."""
        if table:
            return super().given(name, count, table, at)
        local = [f"{name}{i}" for i in range(count)]
        endless = dict(self.shape.endless)
        return "(" + "".join(f"{endless.get(x) or self.row(x)}, " for x in local) + ")"

    def friction(self, c: int, k: int, speed: str, normal: str) -> str:
        """Of a sliding contact; no step goes beyond a reversal, so the law needs no continuation there."""
        kind, count = self.shape.laws[c]
        force, p = f"f{c}_{k}", self.given(f"law{c}_", count, is_table(LAWS, kind), 1)
        if not self.shape.exact:
            if self.shape.scheme == TANH:
                self.put(f"ends_near_zero({speed}, {self.row('width')})")
            self.put(f"{force} = {self.smoothed(c, speed, normal, p)}")
            return force
        s = self.row(f"s{c}")
        self.put(f"mu{c}_{k} = lane_mu_{kind}(from_zero({s} * {speed}), {p})")
        self.put(f"{force} = {s} * mu{c}_{k} * {normal}")
        return force

    def margin(self, c: int, k: int, normal: str) -> str:
        """How far a sticking contact is below its limit on either side: two series without a corner."""
        self.put(f"limit{c} = {self.row(f'law{c}_0')} * {normal} + {self.row(f'noise{c}')}")
        self.put(f"below{c}, above{c} = limit{c} - hold{c}_{k}, limit{c} + hold{c}_{k}")
        return f"below{c}"

    def length(self, v: list[str]) -> None:
        """`x`: how long the step may be, in units of the series."""
        moving = self.shape.of(WITH_MASS, FIRST_ORDER)
        for i in moving:
            here = f"(abs({self.row(f'q{i}')}) + unit * abs({self.row(f'v{i}')}))"
            self.put(f"size{i} = {self.row(f'atol{i}')} + rtol_ * {here}")
        sizes, speeds = "".join(f"size{i}, " for i in moving), "".join(f"{v[i]}, " for i in moving)
        for group in () if self.gliding else self.shape.groups:  # the motion does not tell how they share its force
            k = self.tag
            limits = " + ".join(f"abs(constant(at(part{c}_{k}, 0), unit))" for c in group)
            self.put(f"shared{group[0]} = rtol_ * ({limits}) + 1e-100")
            sizes += "".join(f"unit * (shared{group[0]} + {self.row(f'noise{c}')}), " for c in group)
            speeds += "".join(f"hold{c}_{k}, " for c in group)
        self.put(f"reached, fine = reach(({speeds}), ({sizes}), unit, {ORDER})")
        self.put("x = minimum(reached, h_ / unit)")
        self.put("last = x >= rest * 0.999999999999")
        self.put("x = where(last, rest, x)")

    def ending(self, found: dict[str, list[str]]) -> None:
        """`end`: where the step ends, at the first event; `event` and the number of its function."""
        m = self.shape.m if self.shape.exact else 0
        first, second = zip(*(self.functions_of(c, found) for c in range(m)), strict=True) if m else ((), ())
        watched = "".join(f"{name}, " for name in (*first, *second))
        largest = f"{self.row('largest')} / unit"
        self.ready(found)
        safe = []
        for c in (c for c in range(m) if not self.shape.is_smooth(c)):
            slips = f"surely_slips({self.row(f's{c}')}, {found['speed'][c]}, x, {ORDER})"
            without = f" | (({self.row(f'law{c}_0')} <= 0.0) & ({self.row(f's{c}')} != 0.0))"
            safe.append(f"({slips}{without})" if c in self.shape.slick else slips)
        safe += ["(x < 0.0)"] * any(self.shape.unilateral[:m])
        self.put(f"safe = {' & '.join(safe) or 'x > 0.0'}")
        order = WORK_ORDER if self.shape.varying else ORDER  # a schedule's terms are known beyond those of the motion
        self.put(f"found = step_end(({watched}), kinks, safe, x, {largest}, {order})")
        self.put("end, event, target, longest = found.end, (found.event > 0.5) & fine, found.target, found.next_limit")
        self.judge(found)
        for c in range(0 if self.gliding else m):
            two = f"(target > {m + c - 0.5}) & (target < {m + c + 0.5})"
            holds = f"({self.sticks(c)} > 0.5)"
            holds += f" & ({self.row(f'law{c}_0')} > {RISES!r})" if self.shape.unilateral[c] else ""
            self.put(f"target = where({two} & {holds}, {float(c)}, target)")
        self.put("moved = fine & (end > 0.0)")
        self.put("t1 = where((found.whole > 0.5) & last & moved, t_end_, minimum(t_ + end * unit, t_end_))")

    def judge(self, found: dict[str, list[str]]) -> None:
        """Take no step inside or at the end of which a law is not what its series says, and half of it next time.

        A law that falls exponentially is hidden in its series where its share there is below round-off.
        """
        # what is amiss in the rate of each row
        moving: dict[int, list[str]] = {i: [] for i in self.shape.of(WITH_MASS, FIRST_ORDER)}
        for c in (c for c in range(self.shape.m) if self.hides(c)):
            row = self.shape.memories[c] if self.shape.memories else -1
            for j, share in enumerate(JUDGED):
                self.put(f"away = end * {share!r}")
                self.put(f"slide = value({found['speed'][c]}, away, {ORDER})")
                force, creep = self.compared(c, row, found)
                self.put(f"amiss{c}_{j} = abs({force})")
                if creep:
                    self.put(f"drift{c}_{j} = abs({creep})")
                for i, parts in moving.items():
                    push = self.entry(f"md{c}_{i}")
                    parts += [f"abs({push}) * amiss{c}_{j}"] if push else []
                    parts += [f"drift{c}_{j}"] if i == row else []
        faults = [
            f"((unit * end * {'unit * ' * (i in self.shape.of(WITH_MASS))}({' + '.join(parts)})) > {AMISS!r} * size{i})"
            for i, parts in moving.items()
            if parts
        ]
        if faults:
            self.put(f"misjudged = {' | '.join(faults)}")
            self.put("longest = where(misjudged, 0.5 * end, longest)")
            self.put("end, event = where(misjudged, 0.0, end), event & ~misjudged")

    def hides(self, c: int) -> bool:
        """Whether the law of a contact, or its smoothed sgn, has an exponential."""
        smooth = self.shape.is_smooth(c)
        if self.shape.scheme == TANH and not smooth:
            return True
        text = smooth_text(self.shape.smooth[c] - 1) if smooth else law_text(self.shape.laws[c][0], self.shape.own)
        return "exp(" in text or "tanh(" in text

    def compared(self, c: int, row: int, found: dict[str, list[str]]) -> tuple[str, str]:
        """Force, and rate of the memory, by the series and by the law itself at `away`, one less the other."""
        law, count = self.shape.laws[c]
        p, k = self.given(f"law{c}_", count, is_table(LAWS, law), 1), self.tag
        normal = f"value({found['normal'][c]}, away, {ORDER})"
        if not self.shape.is_smooth(c):
            if not self.shape.exact:
                return f"value(f{c}_{k}, away, {ORDER - 1}) - {self.smoothed(c, 'slide', normal, p)}", ""
            mu = f"lane_mu_{law}(maximum({self.row(f's{c}')} * slide, 0.0 * t_), {p})"
            return f"(value(mu{c}_{k}, away, {ORDER}) - {mu}) * {normal}", ""
        kind, z, rate = self.shape.smooth[c] - 1, "0.0", "0.0"
        if row >= 0:
            self.put(f"z = value(q{row}s, away, {ORDER})")
            self.put(f"rate = lane_creep_{kind}(slide, z, {p})")
            z, rate = "z", "rate"
        shut = f" * (1.0 - {self.openness(c, normal)})" if self.shape.unilateral[c] else ""
        force = f"value(f{c}_{k}, away, {ORDER - 1}) - lane_grip_{kind}(slide, {z}, {rate}, {p}) * {normal}{shut}"
        return force, f"value(creep{c}_{k}, away, {ORDER - 1}) - rate" if row >= 0 else ""

    def ready(self, found: dict[str, list[str]]) -> None:
        """All that both the branch of the events and the rest read."""
        names = [*found["speed"], *found["normal"]]
        held = self.shape.exact and not self.gliding
        names += [f"hold{c}_{self.tag}" for c in range(self.shape.m)] if held else []
        names += found["force"]  # their works are integrated outside the branch
        further = self.shape.varying or any(observer.of == "contact" for observer in self.shape.observers)
        self.put(f"ready({WORK_ORDER if further else ORDER}, {', '.join(names)})" if names else "pass")

    def functions_of(self, c: int, found: dict[str, list[str]]) -> tuple[str, str]:
        """Names of both event functions of a contact, which stay positive as long as its mode holds."""
        s, stick, normal = self.row(f"s{c}"), self.sticks(c), found["normal"][c]
        wide = f" - {self.row(f'open{c}')} * {normal}" if self.shape.unilateral[c] else ""
        held = "" if self.gliding else f" + {stick} * below{c}"
        if self.shape.along(c):
            slides = self.rubbing(c, f"{s} * {found['speed'][c]}", f"{s} * {s}")
            self.put(f"phi{c} = {slides}{held}{wide}")
        else:
            self.put(f"phi{c} = {s} * {s}{wide}")
        slips = f"where({s} * {s} > 0.5, {normal}, 1.0)" if wide else "1.0"
        above = f"above{c}"
        if wide and not self.gliding:  # held by another contact, one whose friction rises from zero lifts off with N
            above = f"where({self.row(f'law{c}_0')} > {RISES!r}, above{c}, {normal})"
        self.put(f"psi{c} = {slips if self.gliding else f'where({stick} > 0.5, {above}, {slips})'}")
        return f"phi{c}", f"psi{c}"

    def observe_parts(self, found: dict[str, list[str]], q: list[str], v: list[str]) -> None:
        """Hand the parts of the step to the observers one after the other: they follow no longer ones."""
        shape = self.shape
        kinds = {observer.of for observer in shape.observers}
        if not kinds:
            return
        if "contact" in kinds:
            for c in range(shape.m):
                along = " + ".join(self.product(f"d{c}", v)) or "0.0 * t_"
                self.put(f"power{c} = integral({found['force'][c]} * ({along}))")
        memory = {f"o{k}_{i}_{j}": self.row(f"o{k}_{i}_{j}") for k, each in enumerate(shape.observers)
                  for i in range(shape.copies(each)) for j in range(len(each.start))}  # fmt: skip
        self.point(0, kinds, found, q, v)
        for part in range(1, PARTS + 1):
            self.point(part, kinds, found, q, v)
            for k, observer in enumerate(shape.observers):
                for i in range(shape.copies(observer)):
                    names = [f"o{k}_{i}_{j}" for j in range(len(observer.start))]
                    given = "".join(f"{self.row(f'c{k}_{i}_{j}')}, " for j in range(observer.coefficients))
                    before, after = (self.view(observer.of, i, p) for p in (part - 1, part))
                    held = "".join(f"{memory[name]}, " for name in names)
                    self.put(
                        f"seen{k}_{i}p{part} = observe_{k}(({held}), ({given or '0.0 * t_, '}), {before}, {after})"
                    )
                    for j, name in enumerate(names):
                        memory[name] = f"seen{k}_{i}p{part}[{j}]"
        for name, value in memory.items():
            self.keep(name, f"where(moved, {value}, {self.row(name)})")
        if "contact" in kinds:
            for c in range(shape.m):
                self.keep(f"work{c}", f"where(moved, work{c}p{PARTS}, {self.row(f'work{c}')})")

    def point(self, part: int, kinds: set[str], found: dict[str, list[str]], q: list[str], v: list[str]) -> None:
        """What is seen at the end of a part of the step."""
        self.put(f"at{part} = end * {part / PARTS!r}")
        self.put(f"t{part}p = t1" if part == PARTS else f"t{part}p = t_ + at{part} * unit")
        for name, series, order in states(q, v, found["a"]):
            self.put(f"{name}p{part} = value({series}, at{part}, {order})")
        if "contact" in kinds:
            for c in range(self.shape.m):
                self.put(f"speed{c}p{part} = value({found['speed'][c]}, at{part}, {ORDER})")
                self.put(f"normal{c}p{part} = value({found['normal'][c]}, at{part}, {ORDER})")
                self.put(f"work{c}p{part} = {self.row(f'work{c}')} + unit * value(power{c}, at{part}, {WORK_ORDER})")

    def view(self, of: str, i: int, part: int) -> str:
        """What an observer of a degree of freedom, of a contact or of the whole sees there."""
        n, time = self.shape.n, f"t{part}p"
        if of == "dof":
            return f"Motion({time}, q{i}p{part}, v{i}p{part}, a{i}p{part})"
        if of == "contact":
            senses = self.shape.exact and not self.shape.is_smooth(i)
            mode = self.row(f"s{i}") if senses else f"(2.0 * (speed{i}p{part} > 0.0) - 1.0)"
            if self.shape.exact and self.shape.unilateral[i]:
                mode = f"({mode} + 2.0 * {self.row(f'open{i}')})"
            return f"Sliding({time}, speed{i}p{part}, normal{i}p{part}, {mode}, work{i}p{part})"
        n = n if self.shape.seen < 0 else self.shape.seen
        tuples = ", ".join("(" + "".join(f"{x}{k}p{part}, " for k in range(n)) + ")" for x in "qva")
        return f"State({time}, {tuples})"

    def record(self, found: dict[str, list[str]], q: list[str]) -> None:
        """Keep the series of all that a recorded motion is told in."""
        n, m, shape = self.shape.n, self.shape.m, self.shape
        told = [(each, ORDER + 1) for each in q]
        told += [(each, ORDER) for name in ("normal", "speed") for each in found[name]]
        told += [(each, ORDER - 1) for each in found["force"]]
        for i in range(n if shape.varying else 0):
            told.append((self.total(f"load{i}", self.signal(2 * m + n + i, f"F{i}", "time")), ORDER))
        for name, (series, order) in zip(shape.followed, told, strict=True):
            for k in range(order + 1):
                place = self.rows.places[f"term{k}_{name}"] * shape.lanes
                self.put(f"store(A, b + {place}, at({series}, {k}))")
        self.keep("t_old", "t_")
        self.keep("span", "where(moved, end * unit, 0.0)")
        if not shape.exact and m:
            back = [f"((at({x}, 0) > 0.0) ^ (value({x}, end, {ORDER}) > 0.0))" for x in found["speed"]]
            self.keep("reversals", f"{self.row('reversals')} + where(moved & ({' | '.join(back)}), 1.0, 0.0)")

    def finish(self, found: dict[str, list[str]], q: list[str], v: list[str]) -> None:
        """Take the step, count, and say which lanes need service."""
        n, shape = self.shape.n, self.shape
        if shape.samples:
            self.keep("t_old", "t_")
            for i in range(n):
                for k in range(ORDER + 2):
                    self.keep(f"term{i}_{k}", f"constant(at({q[i]}, {k}), unit)")
        for name, series, order in states(q, v, found["a"]):
            self.keep(name, f"where(fine, value({series}, end, {order}), {self.row(name)})")
        for c in () if shape.recorded else shape.pressed:
            least, normal = self.row(f"lowest{c}"), found["normal"][c]
            there = f"minimum(value({normal}, 0.5 * end, {ORDER}), value({normal}, end, {ORDER}))"
            self.keep(f"lowest{c}", f"where(fine, minimum({least}, {there}), {least})")
        for c in () if shape.recorded else shape.ranging:
            most, speed = self.row(f"fastest{c}"), found["speed"][c]
            there = f"maximum(abs(value({speed}, 0.5 * end, {ORDER})), abs(value({speed}, end, {ORDER})))"
            self.keep(f"fastest{c}", f"where(fine, maximum({most}, {there}), {most})")
        self.put("t_now = where(fine, t1, t_)")
        self.keep("t", "t_now")
        self.keep("taken", f"{self.row('taken')} + 1.0 * moved")
        self.put(f"tried = {self.row('tries')} + 1.0")
        self.keep("tries", "tried")
        self.keep("h", "longest * unit")
        self.put("done = t_now >= t_end_")
        self.put(f"lost = ~fine | (reached * unit <= {self.row('least')} + 4e-16 * t_)")
        self.put(f"over = tried >= {self.row('most')}")
        code, any_of = "1.0 * done + 2.0 * lost + 4.0 * over", "done | lost | over"
        if shape.exact:
            for c in range(shape.m):
                self.keep(f"force{c}", f"value({found['force'][c]}, end, {ORDER - 1})")
            self.keep("target", "target")
            self.keep("resume", self.row("largest"))
            code, any_of = code + " + 16.0 * event", any_of + " | event"
        if shape.samples or shape.recorded:
            self.put(f"due = moved & (t_now >= {self.row('next')})")
            code, any_of = code + " + 32.0 * due", any_of + " | due"
        self.flag(code, any_of)

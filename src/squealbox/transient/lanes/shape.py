"""What a lane kernel is compiled for, and the place of every number of a group in its rows."""

import math
from dataclasses import dataclass, field
from typing import Any

from squealbox.friction import LAWS, Coulomb, Hyperbolic, Stribeck
from squealbox.transient._motion import EXACT
from squealbox.transient.methods import TAYLOR
from squealbox.transient.rows import FIRST_ORDER, WITH_MASS

LANES = 8  # trajectories side by side in an ensemble: a register of 512 bits, or two or four smaller ones
ORDER = 16  # of the velocities in a Taylor step; 14 to 20 cost the same at relative errors from 1e-5 to 1e-12
WORK_ORDER = 18  # of works: their rates are products, whose terms fall off later; 20 costs a tenth of a run more
PARTS = 3  # in which a Taylor step is looked at; each is at most a sixth of the shortest period, as other steps are
UNIT_OF_WINDOW = 1e3 / (2.0 * math.pi)  # the series count in 1 / (highest angular frequency), 1e-3 / (2 pi) windows


@dataclass(frozen=True)
class Shape:
    """What a kernel is compiled for; everything else is a number in a row.

    `present` names the entries that are not zero in the whole ensemble, such as "mk01". `signals` gives the kind of
    schedule of each term of V_c, N0_c and M^-1 f_i, in that order; () where it is a constant row. `endless` gives the
    coefficients of laws that are infinite in the whole ensemble, as text. `kinds` are those of `rows`, () where every
    row has mass. `smooth` and `memories` are those of `smooth_laws` and `rows`, () without any; observers see the first
    `seen` rows. `groups` names contacts on one motion that share its force by limits that vary within a step,
    `slick` those without any friction in some job.
    """

    n: int
    m: int
    tableau: str
    scheme: int
    laws: tuple[tuple[int, int], ...]
    present: frozenset[str]
    unilateral: tuple[bool, ...]
    signals: tuple[tuple[tuple[int, int], ...], ...] = ()
    observers: tuple[Any, ...] = ()
    samples: bool = False
    breaks: int = 0
    own: tuple[tuple[str, str], ...] = ()
    endless: tuple[tuple[str, str], ...] = ()
    lanes: int = LANES
    recorded: bool = False
    kinds: tuple[int, ...] = ()
    smooth: tuple[int, ...] = ()
    memories: tuple[int, ...] = ()
    seen: int = -1
    groups: tuple[tuple[int, ...], ...] = ()
    slick: tuple[int, ...] = ()

    @property
    def taylor(self) -> bool:
        """Whether the step is a Taylor series."""
        return self.tableau == TAYLOR

    @property
    def staged(self) -> bool:
        """Whether a recorded motion goes by the stages of a Runge-Kutta method."""
        return self.recorded and not self.taylor

    @property
    def exact(self) -> bool:
        """Whether events are located."""
        return self.scheme == EXACT and self.m > 0

    @property
    def varying(self) -> bool:
        """Whether any signal is a schedule."""
        return bool(self.signals)

    @property
    def simple(self) -> bool:
        """Whether the usual event can be decided on the rows alone: constant signals, no contact that opens."""
        pushed = any(f"md{c}_{i}" in self.present for c in range(self.m) for i in self.of(FIRST_ORDER))
        plain = not (self.varying or any(self.unilateral) or any(self.smooth) or pushed)
        return self.exact and plain

    @property
    def audited(self) -> bool:
        """Whether the works of a recorded motion include that of a skew stiffness."""
        return any(f"ka{i}_{j}" in self.present for i in range(self.n) for j in range(self.n))

    @property
    def followed(self) -> list[str]:
        """What a recorded motion is told in, each a series of time in a step; the load too where it varies."""
        n, m = self.n, self.m
        told = [f"q{i}" for i in range(n)] + [f"{name}{c}" for name in ("n", "v", "f") for c in range(m)]
        return told + [f"F{i}" for i in range(n if self.varying else 0)]

    @property
    def breadth(self) -> int:
        """How many series are evaluated at once: those followed, and zeros up to whole registers."""
        return -(-len(self.followed) // 8) * 8

    @property
    def followed_padded(self) -> list[str]:
        """Names of `breadth` series."""
        return [*self.followed, *(f"spare{j}" for j in range(self.breadth - len(self.followed)))]

    def along(self, c: int) -> bool:
        """Whether contact c has a direction along which it can stick."""
        return not self.is_smooth(c) and all(
            any(f"{name}{c}_{i}" in self.present for i in range(self.n)) for name in ("t", "d")
        )

    @property
    def pressed(self) -> list[int]:
        """Contacts that cannot open and whose normal force varies: how far it falls is kept."""
        varies = [any(f"n{c}_{i}" in self.present for i in range(self.n)) or self.varying for c in range(self.m)]
        return [c for c in range(self.m) if varies[c] and not self.unilateral[c]]

    @property
    def ranging(self) -> list[int]:
        """Contacts whose law may turn negative or end: with exact contact, how fast they slide is kept."""
        bounded = [LAWS.index(law) for law in (Coulomb, Stribeck, Hyperbolic)]
        return [c for c in range(self.m) if self.recorded or (self.exact and self.laws[c][0] not in bounded)]

    def is_smooth(self, c: int) -> bool:
        """Whether contact c has a law without events."""
        return bool(self.smooth) and self.smooth[c] > 0

    def copies(self, observer: Any) -> int:
        """How often an observer looks: once for each freedom or contact, or once."""
        return int(observer.copies(self.n if self.seen < 0 else self.seen, self.m))

    def has_mass(self, i: int) -> bool:
        """Whether row i has mass, and so a velocity of its own."""
        return not self.kinds or self.kinds[i] == WITH_MASS

    def of(self, *kinds: int) -> list[int]:
        """The rows of these kinds."""
        return [i for i in range(self.n) if (self.kinds[i] if self.kinds else WITH_MASS) in kinds]

    @property
    def stepped(self) -> bool:
        """Whether samples are steps of the method itself: an interpolation by values and slopes is coarser than it."""
        return self.samples and self.tableau == "dormand-prince-8"

    @property
    def functions(self) -> int:
        """How many event functions there are."""
        return self.m * (2 if any(self.unilateral) else 1)


@dataclass
class Places:
    """Places of the rows of a group, by name; parameters first, as the table of jobs holds them."""

    places: dict[str, int] = field(default_factory=dict)

    def add(self, *names: str) -> None:
        """Give each name the next place."""
        for name in names:
            self.places[name] = len(self.places)

    def __len__(self) -> int:
        return len(self.places)


def parameter_rows(shape: Shape) -> list[str]:
    """Names of the rows that come with a job: what the equation holds, then start, tolerances and limits."""
    n, m = shape.n, shape.m
    named = entries(n, m) + (audit(n) if shape.recorded else [])
    names = [name for name in named if name in shape.present]
    for c, (_, count) in enumerate(shape.laws):
        names += [f"law{c}_{i}" for i in range(count)] + [f"slope{c}"]
    for index, terms in enumerate(shape.signals):
        for k, (_, count) in enumerate(terms):
            names += [f"weight{index}_{k}"] + [f"given{index}_{k}_{i}" for i in range(count)]
    names += [f"lever{c}" for group in shape.groups for c in group]
    if shape.simple:
        names += [f"zero{c}" for c in range(m)] + [f"own_g{c}" for c in range(m)]
    names += [f"start{k}" for k in range(2 * n)] + [f"atol{k}" for k in range(2 * n)]
    names += [f"break{k}" for k in range(shape.breaks)]
    return [*names, "rtol", "width", "window", "highest", "largest", "least", "first"]


def entries(n: int, m: int) -> list[str]:
    """Names of all numbers of the equation, zero or not, in the order of their rows."""
    names = [f"{name}{i}_{j}" for name in ("mk", "mc") for i in range(n) for j in range(n)]
    names += [f"{name}{c}_{i}" for name in ("md", "mw", "d", "t", "s", "n", "w") for c in range(m) for i in range(n)]
    names += [f"g{c}_{b}" for c in range(m) for b in range(m)]
    return names + [f"V{c}" for c in range(m)] + [f"N0{c}" for c in range(m)] + [f"f{i}" for i in range(n)]


def audit(n: int) -> list[str]:
    """Names of the further numbers a recorded motion's works take: damping, skew stiffness and load."""
    return [f"{name}{i}_{j}" for name in ("c", "ka") for i in range(n) for j in range(n)] + [f"F{i}" for i in range(n)]


def layout(shape: Shape) -> Places:
    """All rows of a group."""
    n, m, rows = shape.n, shape.m, Places()
    rows.add(*parameter_rows(shape))
    rows.add("job", "alive", "t", "h", "t_end", "tries", "taken", "cautious", "code", "most")
    rows.add(*(f"q{i}" for i in range(n)), *(f"v{i}" for i in range(n)), *(f"a{i}" for i in range(n)))
    rows.add(*(f"lowest{c}" for c in range(m)), *(f"fastest{c}" for c in range(m)))
    if not shape.taylor:
        rows.add("eased")
    if shape.exact:
        rows.add("target", "tolerance", "trust", "resume", "events", "window_start", "window_events", "turns")
        rows.add("low", "low_phi", "high", "high_phi", "high_rate", "close", "pace")
        rows.add(*(f"probe{k}_{c}" for k in range(3) for c in range(m)))
        rows.add(*(f"{name}{c}" for name in ("early", "early_rate") for c in range(m)))
        rows.add(*(f"s{c}" for c in range(m)), *(f"open{c}" for c in range(m)))
        rows.add(*(f"force{c}" for c in range(m)))
        rows.add(*(f"h{c}_{b}" for c in range(m) for b in range(m)))
        rows.add(*(f"noise{c}" for c in range(m)))
        for name in ("phi", "fresh", "end", "rate", "rate_end", "inner"):
            rows.add(*(f"{name}{j}" for j in range(shape.functions)))
    if shape.samples:
        rows.add("next", "sample", "t_old")
        if shape.taylor:
            rows.add(*(f"term{i}_{k}" for i in range(n) for k in range(ORDER + 2)))
        else:
            rows.add(*(f"{x}_old{i}" for x in "qva" for i in range(n)))
    if shape.recorded:
        rows.add("next", "sample", "t_old", "span", "reversals")
        rows.add(*(f"{name}{k}" for name in ("done", "was") for k in range(m + 4)))  # works, at the end and the start
    if shape.recorded and shape.taylor:
        rows.add("since", *(f"{name}{j}" for name in ("value", "slope_value") for j in range(shape.breadth)))
        rows.add(*(f"gain{k}" for k in range(m + 4)), *(f"{name}{c}" for name in ("trough", "peak") for c in range(m)))
        rows.add(*(f"term{k}_{name}" for k in range(ORDER + 2) for name in shape.followed_padded))
    if shape.staged:
        rows.add("flips", *(f"{x}_old{i}" for x in "qv" for i in range(n)))
        rows.add(*(f"{name}_end{c}" for name in ("normal", "speed", "friction") for c in range(m)))
    if any(observer.of == "contact" for observer in shape.observers):
        rows.add(*(f"work{c}" for c in range(m)))
    for k, observer in enumerate(shape.observers):
        for i in range(shape.copies(observer)):
            rows.add(*(f"o{k}_{i}_{j}" for j in range(len(observer.start))))
            rows.add(*(f"c{k}_{i}_{j}" for j in range(observer.coefficients)))
    return rows

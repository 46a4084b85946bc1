"""Several doubles as one number, of any width: plain Python run once on such numbers writes packed code.

A loop over lanes leaves it to the optimiser whether registers are packed, and it fails silently. Here a number is an
LLVM vector, so the operations on it are packed whatever surrounds them: 512 bits wide where the processor has them,
split in two or four or eight where it has not. Formulas run as they stand, once, and each operation on a `Lanes` adds
one line to LLVM's text. So nothing of them passes through the compiler, and one plain function serves NumPy, translated
code and the lanes. What the kernels of `packed` name are the same functions.
"""

import math
import operator
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from typing import Any

from squealbox.compiled.arithmetic import Arithmetic, written
from squealbox.compiled.kinds import Untranslatable

FLAGS = "contract nsz arcp"  # nnan and ninf would remove the tests for failed lanes
ALIGNED = 64  # bytes: rows and stacks begin with a line of the cache: a register put by across two costs twice
BRANCH = (
    "a friction law, schedule or observer chooses by if, and, or, min or max: lanes compute both sides, "
    "and numpy.where, &, |, numpy.minimum or numpy.maximum select"
)
KNOWN = (
    "expected arithmetic, or of NumPy where, minimum, maximum, sqrt, exp, log, sin, cos, arctan, tanh or abs, "
    "which is what lanes know"
)
ARITHMETIC = {
    "add": operator.add, "subtract": operator.sub, "multiply": operator.mul, "divide": operator.truediv,
    "less": operator.lt, "less_equal": operator.le, "greater": operator.gt, "greater_equal": operator.ge,
}  # fmt: skip
PART = 1_000  # lines of a block: the time to choose instructions grows with their square
UNCUT = (
    8_000  # lines where a block's end keeps a product and a sum from being rounded as one: bits of small kernels stay
)
SELDOM = '!0 = !{!"branch_weights", i32 1, i32 99}'
WIDTH: ContextVar[int] = ContextVar("lanes of a number")
WRITER: ContextVar[Any] = ContextVar("writer of the function being written")
ALLOWED: ContextVar[str] = ContextVar("what the optimiser may do to the rounding", default=FLAGS)


class Writer(Arithmetic):
    """Writes one function of lanes, and those it calls into `functions`."""

    def __init__(self, functions: dict[str, str] | None = None) -> None:
        super().__init__()
        self.functions = {} if functions is None else functions
        self.block, self.blocks, self.room, self.cut = "entry", 0, UNCUT, 0

    def put(self, line: str) -> str:
        """A line whose result goes into a fresh register; a long text goes on in another block now and then."""
        if len(self.lines) >= max(self.cut, self.room):
            self.cut, self.blocks = len(self.lines) + PART, self.blocks + 1
            nowhere = super().put("icmp eq ptr %rows, null")  # never: no optimiser may join the blocks again
            self.lines.append(f"br i1 {nowhere}, label %nowhere, label %part{self.blocks}")
            self.label(f"part{self.blocks}")
        return super().put(line)

    def label(self, name: str) -> None:
        """A block begins."""
        self.lines.append(f"{name}:")
        self.block = name

    def joined(self, *ways: tuple[str, str]) -> str:
        """The register that is the first of each pair where one comes from the block that is the second."""
        return super().put(f"phi {reals()} " + ", ".join(f"[ {value}, %{block} ]" for value, block in ways))

    def define(self, name: str, given: str, returned: str, value: str, linkage: str = "") -> None:
        """The function as text, which is given `ptr %rows`; its stack begins with a line of the cache."""
        cut = ["nowhere:", f"ret {returned} zeroinitializer"] if self.cut else []
        lines = "\n  ".join([*self.lines, f"ret {returned} {value}", *cut])
        head = f"define {linkage} {returned} @{name}({given}) nounwind alignstack({ALIGNED})"
        self.functions[name] = f"{head} {{\nentry:\n  {lines}\n}}\n"


@contextmanager
def writing(writer: Any, lanes: int | None = None, allowed: str | None = None) -> Iterator[Any]:
    """Let operations add their lines there, on numbers of so many lanes."""
    tokens = [(WRITER, WRITER.set(writer))]
    tokens += [] if lanes is None else [(WIDTH, WIDTH.set(lanes))]
    tokens += [] if allowed is None else [(ALLOWED, ALLOWED.set(allowed))]
    try:
        yield writer
    finally:
        for variable, token in tokens:
            variable.reset(token)


def reals() -> str:
    """LLVM's type of one number."""
    return f"<{WIDTH.get()} x double>"


def wide() -> str:
    """LLVM's type of as many whole numbers."""
    return f"<{WIDTH.get()} x i64>"


def truths() -> str:
    """LLVM's type of as many truth values."""
    return f"<{WIDTH.get()} x i1>"


def put(line: str) -> str:
    """One more line, whose result is a register."""
    register: str = WRITER.get().put(line)
    return register


def number(value: float) -> str:
    """The same number in every lane."""
    return "<" + ", ".join([f"double {written(float(value))}"] * WIDTH.get()) + ">"


def whole(value: int) -> str:
    """The same whole number in every lane."""
    return "<" + ", ".join([f"i64 {value}"] * WIDTH.get()) + ">"


def each(values: Sequence[float]) -> "Lanes":
    """Known numbers, one in each lane."""
    return Lanes("<" + ", ".join(f"double {written(value)}" for value in values) + ">")


def over_all(name: str, x: "Lanes") -> str:
    """The register of the sum ("fadd"), the least ("fmin") or the largest ("fmax") of all lanes."""
    start = "double -0.0, " if name == "fadd" else ""
    declared = f"declare double @llvm.vector.reduce.{name}.v{WIDTH.get()}f64("
    WRITER.get().needed.add(f"{declared}{'double, ' if start else ''}{reals()})")
    return put(f"call reassoc nnan double @llvm.vector.reduce.{name}.v{WIDTH.get()}f64({start}{reals()} {x.vector})")


def packed(x: Any) -> str:
    """The register of a `Lanes`, or a plain number in every lane."""
    return x.vector if isinstance(x, Lanes) else number(x)


def called(name: str, *values: str) -> str:
    """A function of LLVM's for packed numbers."""
    kind, full = reals(), f"@llvm.{name}.v{WIDTH.get()}f64"
    WRITER.get().needed.add(f"declare {kind} {full}({', '.join([kind] * len(values))})")
    return put(f"call {ALLOWED.get()} {kind} {full}({', '.join(f'{kind} {x}' for x in values)})")


def as_whole(x: str) -> str:
    """The bits of packed numbers."""
    return put(f"bitcast {reals()} {x} to {wide()}")


def as_reals(x: str) -> str:
    """Packed numbers of such bits."""
    return put(f"bitcast {wide()} {x} to {reals()}")


class Wider:
    """A kind of number that knows what to do with lanes beside it, such as a series of them."""

    __slots__ = ()


def _operation(name: str, turned: bool = False) -> Callable[[Any, Any], Any]:
    def operate(self: Any, other: Any) -> Any:
        if isinstance(other, (Truth, Wider)):
            return NotImplemented
        a, b = (packed(other), self.vector) if turned else (self.vector, packed(other))
        return Lanes(put(f"{name} {ALLOWED.get()} {reals()} {a}, {b}"))

    return operate


def _comparison(order: str) -> Callable[[Any, Any], Any]:
    def compare(self: Any, other: Any) -> Any:
        if isinstance(other, Wider):
            return NotImplemented
        return Truth(put(f"fcmp {order} {reals()} {self.vector}, {packed(other)}"))

    return compare


def _refused(self: Any) -> Any:
    raise Untranslatable(BRANCH)


class Lanes:
    """One double in each lane."""

    __slots__ = ("vector",)

    def __init__(self, vector: str) -> None:
        self.vector = vector

    __add__, __radd__ = _operation("fadd"), _operation("fadd", True)
    __sub__, __rsub__ = _operation("fsub"), _operation("fsub", True)
    __mul__, __rmul__ = _operation("fmul"), _operation("fmul", True)
    __truediv__, __rtruediv__ = _operation("fdiv"), _operation("fdiv", True)
    __lt__, __le__, __gt__, __ge__ = (_comparison(order) for order in ("olt", "ole", "ogt", "oge"))
    __eq__, __ne__ = _comparison("oeq"), _comparison("une")
    __bool__ = __int__ = __float__ = __index__ = _refused

    def __array_ufunc__(self, function: Any, method: str, *given: Any, **_: Any) -> Any:
        """Arithmetic with a NumPy number on the left; any other function of NumPy is refused by its name."""
        known = ARITHMETIC.get(function.__name__)
        if known is None:
            raise Untranslatable(f"numpy.{function.__name__} in a friction law, schedule or observer: {KNOWN}")
        return known(*(x if isinstance(x, Lanes) else float(x) for x in given))

    def __neg__(self) -> "Lanes":
        return Lanes(put(f"fneg {ALLOWED.get()} {reals()} {self.vector}"))

    def __abs__(self) -> "Lanes":
        return Lanes(called("fabs", self.vector))

    def __pow__(self, exponent: int) -> Any:
        """A whole power by squaring."""
        if int(exponent) != exponent or not 0 <= exponent <= 64:
            raise Untranslatable(f"a power of {exponent} in a law or observer: expected a whole number from 0 to 64")
        total: Any = 1.0
        square, rest = self, int(exponent)
        while rest:
            total = total * square if rest & 1 else total
            rest >>= 1
            square = square * square if rest else square
        return total


class Truth:
    """One truth value in each lane; times a number it is the number or 0, as in NumPy."""

    __slots__ = ("vector",)
    __array_ufunc__ = None

    def __init__(self, vector: str) -> None:
        self.vector = vector

    def __and__(self, other: Any) -> "Truth":
        return Truth(put(f"and {truths()} {self.vector}, {other.vector}"))

    def __or__(self, other: Any) -> "Truth":
        return Truth(put(f"or {truths()} {self.vector}, {other.vector}"))

    def __xor__(self, other: Any) -> "Truth":
        return Truth(put(f"xor {truths()} {self.vector}, {other.vector}"))

    def __invert__(self) -> "Truth":
        return Truth(put(f"xor {truths()} {self.vector}, <{', '.join(['i1 true'] * WIDTH.get())}>"))

    def __mul__(self, other: Any) -> Lanes:
        return where(self, other, 0.0)

    __rmul__ = __mul__
    __bool__ = _refused


def forget() -> None:
    """Let rows be read again after this point: a load folds into an operation, a spilled register does not."""
    WRITER.get().lines.append('call void asm sideeffect "", "~{memory}"()')


def where(truth: Any, yes: Any, no: Any) -> Lanes:
    """`yes` in the lanes where it is true, else `no`; as `numpy.where`."""
    return Lanes(put(f"select {truths()} {truth.vector}, {reals()} {packed(yes)}, {reals()} {packed(no)}"))


def with_sign(x: Lanes, other: Lanes) -> Lanes:
    """x times the sign of `other`: x, -x, or 0 where `other` is 0; by the bit of the sign."""
    sign = put(f"and {wide()} {as_whole(other.vector)}, {whole(-(1 << 63))}")
    turned = as_reals(put(f"xor {wide()} {as_whole(x.vector)}, {sign}"))
    return where(other == 0.0, 0.0, Lanes(turned))


def minimum(a: Any, b: Any) -> Any:
    """The smaller of two; b when either is not a number."""
    if not isinstance(a, Lanes) and not isinstance(b, Lanes):
        return min(b, a)
    return where(a < b, a, b) if isinstance(a, Lanes) else where(b > a, a, b)


def maximum(a: Any, b: Any) -> Any:
    """The larger of two; b when either is not a number."""
    if not isinstance(a, Lanes) and not isinstance(b, Lanes):
        return max(b, a)
    return where(a > b, a, b) if isinstance(a, Lanes) else where(b < a, a, b)


def bits(truth: Truth) -> str:
    """The truth values as the bits of one integer; 0 when none holds."""
    lanes = WIDTH.get()
    return put(f"zext i{lanes} {put(f'bitcast {truths()} {truth.vector} to i{lanes}')} to i64")


def fused(a: Lanes, b: Lanes, c: Lanes) -> Lanes:
    """a b + c, rounded once."""
    return Lanes(called("fma", packed(a), packed(b), packed(c)))


@contextmanager
def _where_any(flags: str, weights: str = "") -> Iterator[str]:
    """Lines that are skipped where no bit is set; gives the block before them."""
    writer = WRITER.get()
    writer.blocks += 1
    inside, behind = f"inside{writer.blocks}", f"behind{writer.blocks}"
    some, before = put(f"icmp ne i64 {flags}, 0"), writer.block
    writer.lines.append(f"br i1 {some}, label %{inside}, label %{behind}{weights}")
    writer.label(inside)
    yield before
    writer.lines.append(f"br label %{behind}")
    writer.label(behind)


def if_any(truth: Truth, compute: Callable[[], tuple[Lanes, ...]], otherwise: tuple[Lanes, ...]) -> tuple[Lanes, ...]:
    """What `compute` gives, skipped where the truth holds in no lane; it must give `otherwise` to a lane without it."""
    values, flags = [packed(x) for x in otherwise], bits(truth)
    with _where_any(flags) as before:
        found = [packed(x) for x in compute()]
        inside = WRITER.get().block
    return tuple(Lanes(WRITER.get().joined((yes, inside), (no, before))) for yes, no in zip(found, values, strict=True))


def if_flagged(flags: str, act: Callable[[], None]) -> None:
    """Act, when a bit of `bits` is set: seldom."""
    WRITER.get().needed.add(SELDOM)
    with _where_any(flags, ", !prof !0"):
        act()


def sqrt(x: Any) -> Any:
    """Square root."""
    if not isinstance(x, Lanes):
        return math.sqrt(x)
    return Lanes(called("sqrt", x.vector))


EXP_TERMS = tuple(1.0 / math.factorial(k) for k in range(14))


def exp(x: Any) -> Any:
    """e**x to about 1e-15: 2**k times the Taylor sum of degree 13 on |r| <= ln 2 / 2; 0 and inf at the ends."""
    if not isinstance(x, Lanes):
        return math.exp(x)
    kind, truth = reals(), truths()
    below = put(f"fcmp ult {kind} {x.vector}, {number(709.0)}")
    low = put(f"select {truth} {below}, {kind} {x.vector}, {kind} {number(709.0)}")
    high = put(f"fcmp ugt {kind} {low}, {number(-708.0)}")
    clipped = Lanes(put(f"select {truth} {high}, {kind} {low}, {kind} {number(-708.0)}"))
    with writing(WRITER.get(), allowed=""):
        k = Lanes(called("rint", (clipped * (1.0 / math.log(2.0))).vector))
        r = clipped - k * 0.6931471803691238
        r = r - k * 1.9082149292705877e-10
    total: Any = EXP_TERMS[-1]
    with writing(WRITER.get(), allowed=FLAGS):
        for term in reversed(EXP_TERMS[:-1]):
            total = total * r + term
    biased = put(f"add {wide()} {put(f'fptosi {kind} {k.vector} to {wide()}')}, {whole(1023)}")
    scale = as_reals(put(f"shl {wide()} {biased}, {whole(52)}"))
    with writing(WRITER.get(), allowed=""):
        return total * Lanes(scale)


def lane_tanh(x: Any) -> Any:
    """Hyperbolic tangent."""
    if not isinstance(x, Lanes):
        return math.tanh(x)
    a = exp(-2.0 * abs(x))
    size = (1.0 - a) / (1.0 + a)
    return where(x < 0.0, -size, size)


def _each(name: str) -> Any:
    """A function of the C library, called lane by lane: right, and slow."""

    def call(x: Any) -> Any:
        """A function of the C library, lane by lane."""
        if not isinstance(x, Lanes):
            return getattr(math, name)(x)
        WRITER.get().needed.add(f"declare double @{name}(double)")
        kind, out = reals(), "undef"
        for i in range(WIDTH.get()):
            one = put(f"call double @{name}(double {put(f'extractelement {kind} {x.vector}, i32 {i}')})")
            out = put(f"insertelement {kind} {out}, double {one}, i32 {i}")
        return Lanes(out)

    return call


sin, cos, arctan, log = (_each(name) for name in ("sin", "cos", "atan", "log"))

"""Several doubles as one number, eight or one: plain Python run once on such numbers writes packed code.

A loop over lanes leaves it to the optimiser whether registers are packed, and it fails silently. Here a number is an
LLVM vector, so the operations on it are packed whatever surrounds them: 512 bits wide where the processor has them,
split in two or four or eight where it has not. The step and the formulas of friction laws, schedules and observers run
as they stand, once, and each operation on a `Lanes` adds one instruction. So nothing of them passes through
the compiler, and one plain function serves NumPy, the scalar march and the lanes.

Importing this module loads llvmlite; only generated files do.
"""

import math
import operator
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from typing import Any

from llvmlite import ir

from squealbox.system import InvalidSystem
from squealbox.transient.lanes.shape import LANES

FLAGS = ("contract", "nsz", "arcp")  # nnan and ninf would remove the tests for failed lanes
DOUBLE, INTEGER, SHORT = ir.DoubleType(), ir.IntType(64), ir.IntType(32)
ALIGNED = 64  # bytes: rows begin with a line of the cache
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
WIDTH: ContextVar[int] = ContextVar("lanes of a number", default=LANES)
BUILDER: ContextVar[Any] = ContextVar("builder of the function being written")
ALLOWED: ContextVar[tuple[str, ...]] = ContextVar("what the optimiser may do to the rounding", default=FLAGS)


@contextmanager
def writing(builder: Any, lanes: int | None = None) -> Iterator[None]:
    """Let operations add their instructions there, on numbers of so many lanes."""
    tokens = BUILDER.set(builder), WIDTH.set(lanes or WIDTH.get())
    try:
        yield
    finally:
        BUILDER.reset(tokens[0])
        WIDTH.reset(tokens[1])


def packed_type() -> Any:
    """LLVM's type of one number."""
    return ir.VectorType(DOUBLE, WIDTH.get())


def alignment() -> int:
    """Bytes at whose multiples rows begin: those of a single run just so, those of a group on a line of the cache."""
    return 8 if WIDTH.get() == 1 else ALIGNED


def wide_type() -> Any:
    """LLVM's type of as many whole numbers."""
    return ir.VectorType(INTEGER, WIDTH.get())


def number(value: float) -> Any:
    """The same number in every lane."""
    return ir.Constant(packed_type(), [float(value)] * WIDTH.get())


def packed(x: Any) -> Any:
    """The vector of a `Lanes`, or of a plain number."""
    return x.vector if isinstance(x, Lanes) else number(x)


def declared(module: Any, kind: Any, name: str) -> Any:
    """The function of that name and type in a module, declared at first use."""
    return module.globals.get(name) or ir.Function(module, kind, name)


def _call(name: str, *values: Any) -> Any:
    builder = BUILDER.get()
    kind = ir.FunctionType(packed_type(), [packed_type()] * len(values))
    return builder.call(declared(builder.module, kind, f"{name}.v{WIDTH.get()}f64"), values)


class Wider:
    """A kind of number that knows what to do with lanes beside it, such as a series of them."""

    __slots__ = ()


def _operation(method: str, turned: bool = False) -> Callable[[Any, Any], Any]:
    def operate(self: Any, other: Any) -> Any:
        if isinstance(other, (Truth, Wider)):
            return NotImplemented
        a, b = (packed(other), self.vector) if turned else (self.vector, packed(other))
        return Lanes(getattr(BUILDER.get(), method)(a, b, flags=ALLOWED.get()))

    return operate


def _comparison(sign: str) -> Callable[[Any, Any], Any]:
    def compare(self: Any, other: Any) -> Any:
        if isinstance(other, Wider):
            return NotImplemented
        builder = BUILDER.get()
        order = builder.fcmp_unordered if sign == "!=" else builder.fcmp_ordered
        return Truth(order(sign, self.vector, packed(other)))

    return compare


def _refused(self: Any) -> Any:
    raise InvalidSystem(BRANCH)


class Lanes:
    """One double in each lane."""

    __slots__ = ("vector",)

    def __init__(self, vector: Any) -> None:
        self.vector = vector

    __add__, __radd__ = _operation("fadd"), _operation("fadd", True)
    __sub__, __rsub__ = _operation("fsub"), _operation("fsub", True)
    __mul__, __rmul__ = _operation("fmul"), _operation("fmul", True)
    __truediv__, __rtruediv__ = _operation("fdiv"), _operation("fdiv", True)
    __lt__, __le__, __gt__, __ge__ = (_comparison(sign) for sign in ("<", "<=", ">", ">="))
    __eq__, __ne__ = _comparison("=="), _comparison("!=")
    __bool__ = __int__ = __float__ = __index__ = _refused

    def __array_ufunc__(self, function: Any, method: str, *given: Any, **_: Any) -> Any:
        """Arithmetic with a NumPy number on the left; any other function of NumPy is refused by its name."""
        known = ARITHMETIC.get(function.__name__)
        if known is None:
            raise InvalidSystem(f"numpy.{function.__name__} in a friction law, schedule or observer: {KNOWN}")
        return known(*(x if isinstance(x, Lanes) else float(x) for x in given))

    def __neg__(self) -> "Lanes":
        return Lanes(BUILDER.get().fneg(self.vector, flags=ALLOWED.get()))

    def __abs__(self) -> "Lanes":
        return Lanes(_call("llvm.fabs", self.vector))

    def __pow__(self, exponent: int) -> Any:
        """A whole power by squaring."""
        if int(exponent) != exponent or not 0 <= exponent <= 64:
            raise InvalidSystem(f"a power of {exponent} in a law or observer: expected a whole number from 0 to 64")
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

    def __init__(self, vector: Any) -> None:
        self.vector = vector

    def __and__(self, other: Any) -> "Truth":
        return Truth(BUILDER.get().and_(self.vector, other.vector))

    def __or__(self, other: Any) -> "Truth":
        return Truth(BUILDER.get().or_(self.vector, other.vector))

    def __xor__(self, other: Any) -> "Truth":
        return Truth(BUILDER.get().xor(self.vector, other.vector))

    def __invert__(self) -> "Truth":
        return Truth(BUILDER.get().not_(self.vector))

    def __mul__(self, other: Any) -> Lanes:
        return where(self, other, 0.0)

    __rmul__ = __mul__
    __bool__ = _refused


class Group:
    """The rows of a group in memory; indices are places of doubles."""

    def __init__(self, data: Any) -> None:
        self.data = data

    def at(self, place: int) -> Any:
        """Pointer to the row that begins there."""
        builder = BUILDER.get()
        return builder.bitcast(builder.gep(self.data, [INTEGER(place)]), packed_type().as_pointer())


class Given:
    """Coefficients that lie in `count` rows one after another; those in `whole` are numbers known beforehand."""

    def __init__(self, group: Group, place: int, count: int, whole: dict[int, int]) -> None:
        self.group, self.place, self.count, self.whole = group, place, count, whole

    def __getitem__(self, i: int) -> Any:
        return self.whole[i] if i in self.whole else load(self.group, self.place + i * WIDTH.get())

    def of(self, index: Any, first: int) -> Lanes:
        """In each lane the coefficient `index` places after that which comes `first`."""
        builder, lanes = BUILDER.get(), WIDTH.get()
        out = ir.Constant(packed_type(), ir.Undefined)
        for i in range(lanes):
            place = builder.mul(builder.extract_element(index, SHORT(i)), INTEGER(lanes))
            place = builder.add(place, INTEGER(self.place + first * lanes + i))
            one = builder.load(builder.gep(self.group.data, [place]))
            out = builder.insert_element(out, one, SHORT(i))
        return Lanes(out)

    def last_below(self, x: Lanes, first: int, count: int) -> Any:
        """In each lane the place of the last of `count` increasing coefficients that is not above x; 0 if none is."""
        builder, lanes = BUILDER.get(), WIDTH.get()
        found, end = (ir.Constant(wide_type(), [number] * lanes) for number in (0, count - 1))
        for power in reversed(range((count - 1).bit_length())):
            tried = builder.add(found, ir.Constant(wide_type(), [1 << power] * lanes))
            tried = builder.select(builder.icmp_unsigned("<=", tried, end), tried, found)
            found = builder.select((self.of(tried, first) <= x).vector, tried, found)
        return found


def load(group: Group, place: int, aligned: int | None = None) -> Lanes:
    """The row that begins there, at a multiple of so many bytes."""
    value = BUILDER.get().load(group.at(place))
    value.align = aligned or alignment()
    return Lanes(value)


def store(group: Group, place: int, value: Any, aligned: int | None = None) -> None:
    """Write a row."""
    BUILDER.get().store(packed(value), group.at(place)).align = aligned or alignment()


def store_known(group: Group, place: int, value: Any) -> None:
    """Write a row, unless there is nothing to write: a coefficient that is zero in every lane."""
    if value is not None:
        store(group, place, value)


def at_once(group: Group, b: int, since: int, terms: int, breadth: int, count: int, values: int, slopes: int) -> Any:
    """Several series and their slopes at one instant, a lane for each: `count` coefficients, `breadth` apart."""
    builder, packed_x = BUILDER.get(), ir.Constant(packed_type(), ir.Undefined)
    x = builder.load(builder.gep(group.data, [INTEGER(b + since)]))
    for i in range(WIDTH.get()):
        packed_x = builder.insert_element(packed_x, x, SHORT(i))
    at, total, slope = Lanes(packed_x), None, None
    for k in range(count - 1, -1, -1):
        term = load(group, b + terms + k * breadth, 8)
        slope = total if slope is None or total is None else fused(slope, at, total)
        total = term if total is None else fused(total, at, term)
    store(group, b + values, total, 8)
    store(group, b + slopes, slope, 8)
    return INTEGER(0)


def forget() -> None:
    """Let rows be read again after this point: a load folds into an operation, a spilled register does not."""
    BUILDER.get().asm(ir.FunctionType(ir.VoidType(), []), "", "~{memory}", [], True)


def where(truth: Any, yes: Any, no: Any) -> Lanes:
    """`yes` in the lanes where it is true, else `no`; as `numpy.where`."""
    return Lanes(BUILDER.get().select(truth.vector, packed(yes), packed(no)))


def with_sign(x: Lanes, other: Lanes) -> Lanes:
    """x times the sign of `other`: x, -x, or 0 where `other` is 0; by the bit of the sign."""
    builder = BUILDER.get()
    sign = builder.and_(
        builder.bitcast(other.vector, wide_type()), ir.Constant(wide_type(), [-(1 << 63)] * WIDTH.get())
    )
    turned = builder.bitcast(builder.xor(builder.bitcast(x.vector, wide_type()), sign), packed_type())
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


def bits(truth: Truth) -> Any:
    """The truth values as the bits of one integer; 0 when none holds."""
    builder = BUILDER.get()
    return builder.zext(builder.bitcast(truth.vector, ir.IntType(WIDTH.get())), INTEGER)


def fused(a: Lanes, b: Lanes, c: Lanes) -> Lanes:
    """a b + c, rounded once."""
    return Lanes(_call("llvm.fma", packed(a), packed(b), packed(c)))


def if_any(truth: Truth, compute: Callable[[], tuple[Lanes, ...]], otherwise: tuple[Lanes, ...]) -> tuple[Lanes, ...]:
    """What `compute` gives, skipped where the truth holds in no lane; it must give `otherwise` to a lane without it."""
    builder = BUILDER.get()
    before, values = builder.block, [packed(x) for x in otherwise]
    with builder.if_then(builder.icmp_unsigned("!=", bits(truth), INTEGER(0))):
        found = [packed(x) for x in compute()]
        inside = builder.block
    out = []
    for yes, no in zip(found, values, strict=True):
        out.append(builder.phi(packed_type()))
        out[-1].add_incoming(yes, inside)
        out[-1].add_incoming(no, before)
    return tuple(Lanes(x) for x in out)


def if_flagged(flags: Any, act: Callable[[], None]) -> None:
    """Act, when a bit of `bits` is set: seldom."""
    builder = BUILDER.get()
    with builder.if_then(builder.icmp_unsigned("!=", flags, INTEGER(0)), likely=False):
        act()


def sqrt(x: Any) -> Any:
    """Square root."""
    if not isinstance(x, Lanes):
        return math.sqrt(x)
    return Lanes(_call("llvm.sqrt", x.vector))


EXP_TERMS = tuple(1.0 / math.factorial(k) for k in range(14))


def exp(x: Any) -> Any:
    """e**x to about 1e-15: 2**k times the Taylor sum of degree 13 on |r| <= ln 2 / 2; 0 and inf at the ends."""
    if not isinstance(x, Lanes):
        return math.exp(x)
    builder = BUILDER.get()
    low = builder.select(builder.fcmp_unordered("<", x.vector, number(709.0)), x.vector, number(709.0))
    clipped = builder.select(builder.fcmp_unordered(">", low, number(-708.0)), low, number(-708.0))
    k = _call("llvm.rint", builder.fmul(clipped, number(1.0 / math.log(2.0))))
    r = builder.fsub(clipped, builder.fmul(k, number(0.6931471803691238)))
    r = builder.fsub(r, builder.fmul(k, number(1.9082149292705877e-10)))
    total = number(EXP_TERMS[-1])
    for term in reversed(EXP_TERMS[:-1]):
        total = builder.fadd(builder.fmul(total, r, flags=FLAGS), number(term), flags=FLAGS)
    power = builder.add(builder.fptosi(k, wide_type()), ir.Constant(wide_type(), [1023] * WIDTH.get()))
    scale = builder.bitcast(builder.shl(power, ir.Constant(wide_type(), [52] * WIDTH.get())), packed_type())
    return Lanes(builder.fmul(total, scale))


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
        builder = BUILDER.get()
        function = declared(builder.module, ir.FunctionType(DOUBLE, [DOUBLE]), name)
        out = ir.Constant(packed_type(), ir.Undefined)
        for i in range(WIDTH.get()):
            one = builder.call(function, [builder.extract_element(x.vector, SHORT(i))])
            out = builder.insert_element(out, one, SHORT(i))
        return Lanes(out)

    return call


sin, cos, arctan, log = (_each(name) for name in ("sin", "cos", "atan", "log"))

"""Operations on numbers of translated code: each writes a line of LLVM's text and gives the register of its result.

Rounding is as written: no operation is fused or reordered, so a translated function gives the bits of the plain one
wherever the C library does.
"""

import math
import operator
import struct
from collections.abc import Callable
from typing import Any

from squealbox.compiled.kinds import (
    FLOAT,
    LANES,
    MASK,
    PACKED,
    TEXTS,
    TRUTH,
    WHOLE,
    Number,
    Untranslatable,
    Value,
    kind_of,
)

INSTRUCTIONS = {"+": ("fadd", "add"), "-": ("fsub", "sub"), "*": ("fmul", "mul")}
BITS = {"&": "and", "|": "or", "^": "xor", "<<": "shl", ">>": "ashr"}
ORDERS = {"<": ("olt", "slt"), "<=": ("ole", "sle"), ">": ("ogt", "sgt"), ">=": ("oge", "sge"),
          "==": ("oeq", "eq"), "!=": ("une", "ne")}  # fmt: skip
PLAIN: dict[str, Callable[[Any, Any], Any]] = {
    "+": operator.add, "-": operator.sub, "*": operator.mul, "/": operator.truediv, "//": operator.floordiv,
    "%": operator.mod, "**": operator.pow, "&": operator.and_, "|": operator.or_, "^": operator.xor,
    "<<": operator.lshift, ">>": operator.rshift, "<": operator.lt, "<=": operator.le, ">": operator.gt,
    ">=": operator.ge, "==": operator.eq, "!=": operator.ne,
}  # fmt: skip
LIBRARY = {
    "sin": "sin", "cos": "cos", "tan": "tan", "arctan": "atan", "atan": "atan", "arcsin": "asin", "arccos": "acos",
    "exp": "exp", "log": "log", "log10": "log10", "sinh": "sinh", "cosh": "cosh", "tanh": "tanh", "expm1": "expm1",
    "log1p": "log1p",
}  # fmt: skip
OF_TWO = {"nextafter": "nextafter", "hypot": "hypot", "arctan2": "atan2", "copysign": "copysign", "power": "pow"}
INTRINSIC = {"sqrt": "llvm.sqrt.f64", "fabs": "llvm.fabs.f64", "absolute": "llvm.fabs.f64", "floor": "llvm.floor.f64",
             "ceil": "llvm.ceil.f64"}  # fmt: skip
FLAGS = (
    "nsz arcp contract afn reassoc"  # of packed numbers; not nnan or ninf: they would remove the tests for lost lanes
)
WIDE = {"+": "fadd", "-": "fsub", "*": "fmul", "/": "fdiv"}
MOST_POWER = 16  # whole powers up to this one are products


def literal(value: Any) -> bool:
    """Whether it is a Python number, known while the text is written."""
    return isinstance(value, int | float)


def written(value: float) -> str:
    """A float in LLVM's text: the bits, for no decimal says infinity."""
    return f"0x{struct.unpack('<Q', struct.pack('<d', value))[0]:016X}"


class Arithmetic:
    """Writes operations into `lines`."""

    def __init__(self) -> None:
        self.lines: list[str] = []
        self.count = 0
        self.needed: set[str] = set()  # declarations of the C library and LLVM

    def put(self, line: str) -> str:
        """A line whose result goes into a fresh register."""
        self.count += 1
        self.lines.append(f"%r{self.count} = {line}")
        return f"%r{self.count}"

    def numbered(self, value: Value, kind: str | None = None) -> Number:
        """The value as a number of that kind, or of its own."""
        own = kind_of(value)
        if not isinstance(own, str):
            raise Untranslatable(f"a {own[0]} where a number is expected")
        kind = kind or own
        if literal(value) and kind == PACKED:
            return Number(PACKED, "<" + ", ".join([f"double {written(float(value))}"] * LANES) + ">")
        if literal(value):
            number = float(value) if kind == FLOAT else bool(value) if kind == TRUTH else int(value)
            return Number(kind, written(number) if kind == FLOAT else str(number).lower())
        if own == kind:
            return value
        if kind == PACKED:
            return self.in_all_lanes(self.numbered(value, FLOAT))
        if own in (PACKED, MASK) or kind == MASK:
            raise Untranslatable("packed numbers or masks beside what is not")
        if kind == TRUTH:
            return self.truth(value)
        if kind == FLOAT:
            name = "sitofp" if own == WHOLE else "uitofp"
            return Number(FLOAT, self.put(f"{name} {TEXTS[own]} {value.text} to double"))
        line = f"zext i1 {value.text} to i64" if own == TRUTH else f"fptosi double {value.text} to i64"
        return Number(WHOLE, self.put(line))

    def in_all_lanes(self, x: Number) -> Number:
        """A number as packed ones."""
        kind = TEXTS[PACKED]
        one = self.put(f"insertelement {kind} poison, double {x.text}, i64 0")
        zeros = f"<{LANES} x i32> zeroinitializer"
        return Number(PACKED, self.put(f"shufflevector {kind} {one}, {kind} poison, {zeros}"))

    def truth(self, value: Value) -> Any:
        """Whether it is not zero: a Python truth value or a number of kind TRUTH."""
        if literal(value):
            return bool(value)
        if not isinstance(value, Number):
            raise Untranslatable("a choice by what is not a number")
        return value if value.kind == TRUTH else self.compare("!=", value, 0)

    def binary(self, sign: str, a: Value, b: Value) -> Value:
        """a sign b."""
        if literal(a) and literal(b):
            return self.known(sign, a, b)
        kinds = kind_of(a), kind_of(b)
        if PACKED in kinds and sign in WIDE:
            x, y = self.numbered(a, PACKED), self.numbered(b, PACKED)
            return Number(PACKED, self.put(f"{WIDE[sign]} {FLAGS} {TEXTS[PACKED]} {x.text}, {y.text}"))
        if kinds == (MASK, MASK) and sign in ("&", "|"):
            return Number(MASK, self.put(f"{BITS[sign]} {TEXTS[MASK]} {a.text}, {b.text}"))
        if sign == "**":
            return self.power(a, b)
        if sign in BITS:
            kind = TRUTH if kinds == (TRUTH, TRUTH) else WHOLE
            if FLOAT in kinds:
                raise Untranslatable(f"{sign} of numbers that are not whole")
            x, y = self.numbered(a, kind), self.numbered(b, kind)
            return Number(kind, self.put(f"{BITS[sign]} {TEXTS[kind]} {x.text}, {y.text}"))
        if FLOAT in kinds or sign == "/":
            x, y = self.numbered(a, FLOAT), self.numbered(b, FLOAT)
            if sign == "/":
                return Number(FLOAT, self.put(f"fdiv double {x.text}, {y.text}"))
            if sign not in INSTRUCTIONS:
                raise Untranslatable(f"{sign} of numbers that are not whole")
            return Number(FLOAT, self.put(f"{INSTRUCTIONS[sign][0]} double {x.text}, {y.text}"))
        x, y = self.numbered(a, WHOLE), self.numbered(b, WHOLE)
        if sign in INSTRUCTIONS:
            return Number(WHOLE, self.put(f"{INSTRUCTIONS[sign][1]} i64 {x.text}, {y.text}"))
        return self.divided(sign, x, y)

    def known(self, sign: str, a: Any, b: Any) -> Any:
        """As Python, but a division by zero is infinite or not a number, as in NumPy."""
        if sign == "/" and b == 0:
            return math.nan if a == 0 or a != a else math.copysign(math.inf, a) * math.copysign(1.0, b)
        return PLAIN[sign](a, b)

    def divided(self, sign: str, x: Number, y: Number) -> Number:
        """Whole quotient or remainder, towards minus infinity."""
        rest = Number(WHOLE, self.put(f"srem i64 {x.text}, {y.text}"))
        signs = Number(WHOLE, self.put(f"xor i64 {rest.text}, {y.text}"))
        below = self.binary("&", self.compare("!=", rest, 0), self.compare("<", signs, 0))
        if sign == "%":
            return self.binary("+", rest, self.select(below, y, Number(WHOLE, "0")))
        return self.binary("-", Number(WHOLE, self.put(f"sdiv i64 {x.text}, {y.text}")), below)

    def power(self, a: Value, b: Value) -> Value:
        """a ** b; small whole powers are products, powers of whole numbers a loop."""
        if isinstance(b, int) and 0 <= b <= MOST_POWER:
            total: Any = 1 if kind_of(a) != FLOAT else 1.0
            for k in range(b):
                total = a if k == 0 else self.binary("*", total, a)
            return total
        if kind_of(a) != FLOAT and kind_of(b) != FLOAT:
            x, y = self.numbered(a, WHOLE), self.numbered(b, WHOLE)
            return Number(WHOLE, self.put(f"call i64 @whole_power(i64 {x.text}, i64 {y.text})"))
        if kind_of(b) != FLOAT:
            b = self.numbered(b, FLOAT)
        return self.called("pow", a, b)

    def negated(self, a: Value) -> Value:
        """-a."""
        if literal(a):
            return -a
        if a.kind in (FLOAT, PACKED):
            return Number(a.kind, self.put(f"fneg {TEXTS[a.kind]} {a.text}"))
        return self.binary("-", 0, a)

    def inverted(self, a: Value) -> Value:
        """not a."""
        truth = self.truth(a)
        return not truth if literal(truth) else Number(TRUTH, self.put(f"xor i1 {truth.text}, true"))

    def compare(self, sign: str, a: Value, b: Value) -> Value:
        """a sign b, a truth value."""
        if literal(a) and literal(b):
            return PLAIN[sign](a, b)
        if PACKED in (kind_of(a), kind_of(b)):
            x, y = self.numbered(a, PACKED), self.numbered(b, PACKED)
            return Number(MASK, self.put(f"fcmp {ORDERS[sign][0]} {TEXTS[PACKED]} {x.text}, {y.text}"))
        real = FLOAT in (kind_of(a), kind_of(b))
        kind = FLOAT if real else WHOLE
        x, y = self.numbered(a, kind), self.numbered(b, kind)
        name = "fcmp" if real else "icmp"
        return Number(TRUTH, self.put(f"{name} {ORDERS[sign][not real]} {TEXTS[kind]} {x.text}, {y.text}"))

    def select(self, truth: Value, yes: Value, no: Value) -> Value:
        """`yes` where it is true, else `no`."""
        if literal(truth):
            return yes if truth else no
        kind = self.common(yes, no)
        x, y = self.numbered(yes, kind), self.numbered(no, kind)
        return Number(kind, self.put(f"select i1 {truth.text}, {TEXTS[kind]} {x.text}, {TEXTS[kind]} {y.text}"))

    def common(self, a: Value, b: Value) -> str:
        """The wider kind of two numbers."""
        kinds = {kind_of(a), kind_of(b)}
        return FLOAT if FLOAT in kinds else WHOLE if WHOLE in kinds else TRUTH

    def called(self, name: str, *values: Value) -> Number:
        """A function of the C library or of LLVM, double to double."""
        self.needed.add(f"declare double @{name}({', '.join('double' for _ in values)})")
        given = ", ".join(f"double {self.numbered(each, FLOAT).text}" for each in values)
        return Number(FLOAT, self.put(f"call double @{name}({given})"))

    def size(self, a: Value) -> Value:
        """abs(a)."""
        if literal(a):
            return abs(a)
        if a.kind == PACKED:
            kind, name = TEXTS[PACKED], f"@llvm.fabs.v{LANES}f64"
            self.needed.add(f"declare {kind} {name}({kind})")
            return Number(PACKED, self.put(f"call {kind} {name}({kind} {a.text})"))
        if a.kind == FLOAT:
            return self.called("llvm.fabs.f64", a)
        return self.select(self.compare("<", a, 0), self.negated(a), a)

    def lesser(self, sign: str, *values: Value) -> Value:
        """min ("<") or max (">") as Python has them: the first of equals, and of what cannot be compared."""
        best = values[0]
        for each in values[1:]:
            if literal(best) and literal(each):
                best = min(best, each) if sign == "<" else max(best, each)
            else:
                best = self.select(self.compare(sign, each, best), each, best)
        return best

    def bounded(self, sign: str, a: Value, b: Value) -> Value:
        """NumPy's minimum ("<") or maximum (">"): what is not a number stays so."""
        if literal(a) and literal(b):
            return a if PLAIN[sign](a, b) or a != a else b
        first = self.compare(sign, a, b)
        if kind_of(a) == FLOAT:
            first = self.binary("|", first, self.compare("!=", a, a))
        return self.select(first, a, b)

    def numpy(self, name: str, values: list[Value]) -> Value:
        """A function of NumPy or of `math`."""
        if name in ("minimum", "maximum"):
            return self.bounded("<" if name == "minimum" else ">", *values)
        if name == "where":
            return self.select(self.truth(values[0]), *values[1:])
        if name == "sign":
            x = self.numbered(values[0], FLOAT)
            whole = self.binary("-", self.compare(">", x, 0.0), self.compare("<", x, 0.0))
            return self.select(self.compare("!=", x, x), x, self.numbered(whole, FLOAT))
        if name in ("isfinite", "isnan"):
            x = self.numbered(values[0], FLOAT)
            return self.compare("!=", x, x) if name == "isnan" else self.compare("<", self.size(x), math.inf)
        if name in ("abs", "absolute", "fabs"):
            return self.size(values[0])
        if name in ("float64", "int64"):
            return self.numbered(values[0], FLOAT if name == "float64" else WHOLE)
        for table in (INTRINSIC, LIBRARY, OF_TWO):
            if name in table:
                return self.called(table[name], *values)
        raise Untranslatable(f"numpy.{name}")


HELPERS = """
define internal i64 @whole_power(i64 %x, i64 %n) {
entry:
  br label %next
next:
  %left = phi i64 [ %n, %entry ], [ %less, %again ]
  %total = phi i64 [ 1, %entry ], [ %more, %again ]
  %go = icmp sgt i64 %left, 0
  br i1 %go, label %again, label %done
again:
  %less = sub i64 %left, 1
  %more = mul i64 %total, %x
  br label %next
done:
  ret i64 %total
}
"""

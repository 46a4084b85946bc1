"""Sixteen doubles as one number of the compiler: arithmetic, comparisons and a few functions on packed registers.

A loop over lanes leaves it to the optimiser whether registers are packed, and it fails silently. Here one value is an
LLVM vector, so the operations on it are packed whatever surrounds them: 512 bits wide where the processor has them,
split in two or four or eight where it has not. The formulas of friction laws and schedules run on such values as they
stand, which is how one plain function serves NumPy, the scalar march and the lanes.

Importing this module loads numba; only generated files do.
"""

import math
import operator
from typing import Any

from llvmlite import ir
from numba import extending, types
from numba.core import cgutils
from numba.core.typing.templates import AbstractTemplate, ConcreteTemplate, infer_global, signature
from numba.extending import lower_builtin, models, register_model

LANES = 16
FLAGS = ("contract", "nsz", "arcp")  # nnan and ninf would remove the tests for failed lanes
DOUBLE, INTEGER = ir.DoubleType(), ir.IntType(64)
PACKED, LOGICAL = ir.VectorType(DOUBLE, LANES), ir.VectorType(ir.IntType(1), LANES)
WIDE = ir.VectorType(INTEGER, LANES)
intrinsic: Any = extending.intrinsic  # untyped, and its calls leave out the typing context


class Lanes(types.Type):
    """One double in each lane."""

    def __init__(self) -> None:
        super().__init__("lanes")


class Mask(types.Type):
    """One truth value in each lane."""

    def __init__(self) -> None:
        super().__init__("lane mask")


lanes, mask = Lanes(), Mask()


@register_model(Lanes)
class _LanesModel(models.PrimitiveModel):
    def __init__(self, manager: Any, kind: Any) -> None:
        super().__init__(manager, kind, PACKED)


@register_model(Mask)
class _MaskModel(models.PrimitiveModel):
    def __init__(self, manager: Any, kind: Any) -> None:
        super().__init__(manager, kind, LOGICAL)


def spread(builder: Any, value: Any) -> Any:
    """A scalar in every lane; a vector as it is."""
    if isinstance(value.type, ir.VectorType):
        return value
    if isinstance(value, ir.Constant):
        return ir.Constant(PACKED, [value.constant] * LANES)
    one = builder.insert_element(ir.Constant(PACKED, ir.Undefined), value, ir.Constant(ir.IntType(32), 0))
    zeros = ir.Constant(ir.VectorType(ir.IntType(32), LANES), [0] * LANES)
    return builder.shuffle_vector(one, ir.Constant(PACKED, ir.Undefined), zeros)


def _number(value: float) -> Any:
    return ir.Constant(PACKED, [value] * LANES)


def _call(builder: Any, name: str, *values: Any) -> Any:
    kind = ir.FunctionType(PACKED, [PACKED] * len(values))
    return builder.call(cgutils.get_or_insert_function(builder.module, kind, f"{name}.v{LANES}f64"), values)


def _binary(operation: Any, method: str) -> None:
    cases = [signature(lanes, a, b) for a, b in ((lanes, lanes), (lanes, types.float64), (types.float64, lanes))]
    infer_global(operation)(type("Rule", (ConcreteTemplate,), {"cases": cases}))
    for case in cases:

        def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
            a, b = (spread(builder, arg) for arg in args)
            return getattr(builder, method)(a, b, flags=FLAGS)

        lower_builtin(operation, *case.args)(lower)


def _comparison(operation: Any, sign: str) -> None:
    cases = [signature(mask, a, b) for a, b in ((lanes, lanes), (lanes, types.float64), (types.float64, lanes))]
    infer_global(operation)(type("Rule", (ConcreteTemplate,), {"cases": cases}))
    for case in cases:

        def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
            a, b = (spread(builder, arg) for arg in args)
            order = builder.fcmp_unordered if sign == "!=" else builder.fcmp_ordered
            return order(sign, a, b)

        lower_builtin(operation, *case.args)(lower)


def _logical(operation: Any, method: str) -> None:
    infer_global(operation)(type("Rule", (ConcreteTemplate,), {"cases": [signature(mask, mask, mask)]}))

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return getattr(builder, method)(*args)

    lower_builtin(operation, mask, mask)(lower)


for _operation, _method in (
    (operator.add, "fadd"), (operator.sub, "fsub"), (operator.mul, "fmul"), (operator.truediv, "fdiv"),
    (operator.iadd, "fadd"), (operator.isub, "fsub"), (operator.imul, "fmul"), (operator.itruediv, "fdiv"),
):  # fmt: skip
    _binary(_operation, _method)
for _operation, _sign in (
    (operator.lt, "<"), (operator.le, "<="), (operator.gt, ">"), (operator.ge, ">="), (operator.eq, "=="),
    (operator.ne, "!="),
):  # fmt: skip
    _comparison(_operation, _sign)
for _operation, _method in ((operator.and_, "and_"), (operator.or_, "or_"), (operator.xor, "xor")):
    _logical(_operation, _method)


def _truth_times(a: Any, b: Any) -> None:
    """A truth value times a number is the number or 0, as in NumPy."""

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        truth, value = args if a is mask else (args[1], args[0])
        return builder.select(truth, spread(builder, value), _number(0.0))

    lower_builtin(operator.mul, a, b)(lower)


class _TruthTimes(ConcreteTemplate):
    pairs = ((mask, lanes), (lanes, mask), (mask, types.float64), (types.float64, mask))
    cases = [signature(lanes, a, b) for a, b in pairs]  # noqa: RUF012


infer_global(operator.mul)(_TruthTimes)
for _a, _b in _TruthTimes.pairs:
    _truth_times(_a, _b)


class _Unary(ConcreteTemplate):
    cases = [signature(lanes, lanes)]  # noqa: RUF012


class _Not(ConcreteTemplate):
    cases = [signature(mask, mask)]  # noqa: RUF012


class _Whole(AbstractTemplate):
    def generic(self, args: Any, keywords: Any) -> Any:
        return signature(types.intp, lanes) if args == (lanes,) else None


infer_global(operator.neg)(_Unary)
infer_global(abs)(_Unary)
infer_global(operator.invert)(_Not)
infer_global(int)(_Whole)


@lower_builtin(operator.neg, lanes)
def _negative(context: Any, builder: Any, sig: Any, args: Any) -> Any:
    return builder.fneg(args[0], flags=FLAGS)


@lower_builtin(abs, lanes)
def _absolute(context: Any, builder: Any, sig: Any, args: Any) -> Any:
    return _call(builder, "llvm.fabs", args[0])


@lower_builtin(operator.invert, mask)
def _inverse(context: Any, builder: Any, sig: Any, args: Any) -> Any:
    return builder.not_(args[0])


@lower_builtin(int, lanes)
def _whole(context: Any, builder: Any, sig: Any, args: Any) -> Any:
    """A count is the same in all lanes of a kernel."""
    return builder.fptosi(builder.extract_element(args[0], ir.Constant(ir.IntType(32), 0)), INTEGER)


def _place(context: Any, builder: Any, sig: Any, args: Any) -> Any:
    data = context.make_array(sig.args[0])(context, builder, args[0]).data
    return builder.bitcast(builder.gep(data, [args[1]]), PACKED.as_pointer())


@intrinsic
def load(typing: Any, array: Any, offset: Any) -> Any:
    """The lanes that begin at array[offset]."""

    def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        value = builder.load(_place(context, builder, sig, args))
        value.align = 8
        return value

    return lanes(array, types.intp), generate


@intrinsic
def store(typing: Any, array: Any, offset: Any, value: Any) -> Any:
    """Write the lanes that begin at array[offset]."""

    def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        builder.store(spread(builder, args[2]), _place(context, builder, sig, args)).align = 8
        return context.get_dummy_value()

    return types.void(array, types.intp, value), generate


@intrinsic
def forget(typing: Any) -> Any:
    """Let rows be read again after this point: a load folds into an operation, a spilled register does not."""

    def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        builder.asm(ir.FunctionType(ir.VoidType(), []), "", "~{memory}", [], True)
        return context.get_dummy_value()

    return types.void(), generate


@intrinsic
def where(typing: Any, truth: Any, yes: Any, no: Any) -> Any:
    """`yes` in the lanes where it is true, else `no`; as `numpy.where`."""

    def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return builder.select(args[0], spread(builder, args[1]), spread(builder, args[2]))

    kinds = [lanes if kind is lanes else types.float64 for kind in (yes, no)]
    return lanes(mask, *kinds), generate


def _pairwise(sign: str) -> Any:
    def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        a, b = (spread(builder, arg) for arg in args)
        return builder.select(builder.fcmp_ordered(sign, a, b), a, b)

    return generate


@intrinsic
def minimum(typing: Any, a: Any, b: Any) -> Any:
    """The smaller of two; b when either is not a number."""
    return lanes(*[lanes if kind is lanes else types.float64 for kind in (a, b)]), _pairwise("<")


@intrinsic
def maximum(typing: Any, a: Any, b: Any) -> Any:
    """The larger of two; b when either is not a number."""
    return lanes(*[lanes if kind is lanes else types.float64 for kind in (a, b)]), _pairwise(">")


@intrinsic
def bits(typing: Any, truth: Any) -> Any:
    """The truth values as the bits of one integer; 0 when none holds."""

    def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return builder.zext(builder.bitcast(args[0], ir.IntType(LANES)), INTEGER)

    return types.int64(mask), generate


@intrinsic
def sqrt(typing: Any, x: Any) -> Any:
    """Square root."""

    def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return _call(builder, "llvm.sqrt", args[0])

    return lanes(lanes), generate


@intrinsic
def rough_power(typing: Any, x: Any, exponent: Any) -> Any:
    """x**exponent to a few per cent for x > 0, by the exponent and mantissa as a logarithm: for step factors."""

    def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        one = float(1023 << 52)
        whole = builder.sitofp(builder.bitcast(args[0], WIDE), PACKED)
        scaled = builder.fmul(builder.fsub(whole, _number(one)), spread(builder, args[1]))
        return builder.bitcast(builder.fptosi(builder.fadd(scaled, _number(one)), WIDE), PACKED)

    return lanes(lanes, types.float64), generate


EXP_TERMS = tuple(1.0 / math.factorial(k) for k in range(14))


@intrinsic
def exp(typing: Any, x: Any) -> Any:
    """e**x to about 1e-15: 2**k times the Taylor sum of degree 13 on |r| <= ln 2 / 2; 0 and inf at the ends."""

    def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        low = builder.select(builder.fcmp_unordered("<", args[0], _number(709.0)), args[0], _number(709.0))
        clipped = builder.select(builder.fcmp_unordered(">", low, _number(-708.0)), low, _number(-708.0))
        k = _call(builder, "llvm.rint", builder.fmul(clipped, _number(1.0 / math.log(2.0))))
        r = builder.fsub(clipped, builder.fmul(k, _number(0.6931471803691238)))
        r = builder.fsub(r, builder.fmul(k, _number(1.9082149292705877e-10)))
        total = _number(EXP_TERMS[-1])
        for term in reversed(EXP_TERMS[:-1]):
            total = builder.fadd(builder.fmul(total, r, flags=FLAGS), _number(term), flags=FLAGS)
        power = builder.add(builder.fptosi(k, WIDE), ir.Constant(WIDE, [1023] * LANES))
        scale = builder.bitcast(builder.shl(power, ir.Constant(WIDE, [52] * LANES)), PACKED)
        return builder.fmul(total, scale)

    return lanes(lanes), generate


def _each(name: str) -> Any:
    """A function of the C library, called lane by lane: right, and slow."""

    def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        function = cgutils.get_or_insert_function(builder.module, ir.FunctionType(DOUBLE, [DOUBLE]), name)
        out = ir.Constant(PACKED, ir.Undefined)
        for i in range(LANES):
            at = ir.Constant(ir.IntType(32), i)
            out = builder.insert_element(out, builder.call(function, [builder.extract_element(args[0], at)]), at)
        return out

    return generate


@intrinsic
def sin(typing: Any, x: Any) -> Any:
    """Sine."""
    return lanes(lanes), _each("sin")


@intrinsic
def cos(typing: Any, x: Any) -> Any:
    """Cosine."""
    return lanes(lanes), _each("cos")


@intrinsic
def arctan(typing: Any, x: Any) -> Any:
    """Inverse tangent."""
    return lanes(lanes), _each("atan")


@intrinsic
def log(typing: Any, x: Any) -> Any:
    """Natural logarithm."""
    return lanes(lanes), _each("log")


@intrinsic
def take(typing: Any, counter: Any) -> Any:
    """The counter's value, which is raised by one at once, whatever other threads do."""

    def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        data = context.make_array(sig.args[0])(context, builder, args[0]).data
        return builder.atomic_rmw("add", data, ir.Constant(INTEGER, 1), "monotonic")

    return types.int64(counter), generate


FUNCTIONS = ("where", "minimum", "maximum", "sqrt", "exp", "sin", "cos", "arctan", "log")

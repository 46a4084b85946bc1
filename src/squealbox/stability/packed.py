"""Sixteen real numbers as one value of compiled code: `Packed`, with arithmetic, comparisons and a choice by mask.

A loop over lanes is packed by LLVM only when it can prove that nothing overlaps, and fails silently when it cannot.
Here a variable of a kernel simply is a vector: `x * y + z` are packed instructions, on AVX2, AVX-512 or NEON, and the
kernel reads like the formula for one matrix. A `Mask` is what a comparison of two of them gives.

Entry i of an array of packed numbers is `load(array, i)`; the array holds 16 doubles for each. Importing this module
loads numba.
"""

import operator
from collections.abc import Callable
from typing import Any

import numpy as np
from llvmlite import ir
from numba import extending, njit, types
from numba.core import cgutils
from numba.core.extending import models, register_model
from numba.core.typing.templates import ConcreteTemplate, infer_global, signature

intrinsic: Any = extending.intrinsic  # untyped, and its calls leave out the typing context
LANES = 16  # two registers of AVX-512: one hides the latency of the other
FLAGS = ("contract", "nsz", "arcp", "reassoc", "afn")  # not nnan or ninf: they would remove the tests for lost lanes
REALS, WORDS, BITS = (ir.VectorType(kind, LANES) for kind in (ir.DoubleType(), ir.IntType(64), ir.IntType(1)))


class Packed(types.Type):
    """Sixteen doubles."""

    def __init__(self) -> None:
        super().__init__(name="packed")


class Mask(types.Type):
    """Sixteen truths."""

    def __init__(self) -> None:
        super().__init__(name="packed mask")


packed, mask = Packed(), Mask()


@register_model(Packed)
class _PackedModel(models.PrimitiveModel):
    def __init__(self, manager: Any, kind: Any) -> None:
        super().__init__(manager, kind, REALS)


@register_model(Mask)
class _MaskModel(models.PrimitiveModel):
    def __init__(self, manager: Any, kind: Any) -> None:
        super().__init__(manager, kind, BITS)


def _operator(function: Any, result: Any, arguments: tuple[Any, ...], emit: Callable[..., Any]) -> None:
    """Teach numba a Python operator on packed arguments: `emit` writes its instruction."""
    infer_global(function)(type("Rule", (ConcreteTemplate,), {"cases": [signature(result, *arguments)]}))
    extending.lower_builtin(function, *arguments)(lambda context, builder, _, args: emit(builder, *args))


def _function(result: Any, *arguments: Any) -> Callable[..., Any]:
    """A function of kernels from the one that writes its instructions."""

    def wrap(emit: Callable[..., Any]) -> Any:
        def generate(context: Any, builder: Any, _: Any, args: Any) -> Any:
            return emit(builder, *args)

        def typed(*_: Any) -> Any:
            return signature(result, *arguments), generate

        by_count: list[Any] = [  # numba reads the number of arguments off the function itself
            lambda typing, a: typed(a),
            lambda typing, a, b: typed(a, b),
            lambda typing, a, b, c: typed(a, b, c),
        ]
        return intrinsic(by_count[len(arguments) - 1])

    return wrap


def _call(builder: Any, name: str, *args: Any) -> Any:
    kind = ir.FunctionType(REALS, [REALS] * len(args))
    target = cgutils.get_or_insert_function(builder.module, kind, f"llvm.{name}.v{LANES}f64")
    return builder.call(target, args, fastmath=FLAGS)


def _words(value: int) -> Any:
    return ir.Constant(WORDS, [value] * LANES)


_BOTH = (packed, packed)
_operator(operator.add, packed, _BOTH, lambda b, x, y: b.fadd(x, y, flags=FLAGS))
_operator(operator.sub, packed, _BOTH, lambda b, x, y: b.fsub(x, y, flags=FLAGS))
_operator(operator.mul, packed, _BOTH, lambda b, x, y: b.fmul(x, y, flags=FLAGS))
_operator(operator.truediv, packed, _BOTH, lambda b, x, y: b.fdiv(x, y, flags=FLAGS))
_operator(operator.neg, packed, (packed,), lambda b, x: b.fneg(x))
_operator(abs, packed, (packed,), lambda b, x: _call(b, "fabs", x))
_operator(operator.lt, mask, _BOTH, lambda b, x, y: b.fcmp_ordered("<", x, y))
_operator(operator.le, mask, _BOTH, lambda b, x, y: b.fcmp_ordered("<=", x, y))
_operator(operator.gt, mask, _BOTH, lambda b, x, y: b.fcmp_ordered(">", x, y))
_operator(operator.ge, mask, _BOTH, lambda b, x, y: b.fcmp_ordered(">=", x, y))
_operator(operator.eq, mask, _BOTH, lambda b, x, y: b.fcmp_ordered("==", x, y))
_operator(operator.and_, mask, (mask, mask), lambda b, x, y: b.and_(x, y))
_operator(operator.or_, mask, (mask, mask), lambda b, x, y: b.or_(x, y))


@_function(packed, types.float64)
def splat(b: Any, x: Any) -> Any:
    """The same number in all lanes."""
    first = ir.Constant(ir.IntType(32), 0)
    one = b.insert_element(ir.Constant(REALS, ir.Undefined), x, first)
    return b.shuffle_vector(one, one, ir.Constant(ir.VectorType(ir.IntType(32), LANES), [0] * LANES))


@_function(packed, mask, packed, packed)
def select(b: Any, where: Any, x: Any, y: Any) -> Any:
    """x where the mask holds, else y."""
    return b.select(where, x, y)


@_function(types.boolean, mask)
def some(b: Any, where: Any) -> Any:
    """Whether the mask holds in any lane."""
    return b.icmp_unsigned("!=", b.bitcast(where, ir.IntType(LANES)), ir.Constant(ir.IntType(LANES), 0))


@_function(packed, packed)
def root(b: Any, x: Any) -> Any:
    """The square root."""
    return _call(b, "sqrt", x)


@_function(packed, packed, packed)
def signed(b: Any, x: Any, y: Any) -> Any:
    """|x| with the sign of y."""
    return _call(b, "copysign", x, y)


@_function(packed, packed, packed)
def larger(b: Any, x: Any, y: Any) -> Any:
    """The larger of two numbers; y when either is NaN."""
    return b.select(b.fcmp_ordered(">", x, y), x, y)


@_function(types.float64, packed)
def largest(b: Any, x: Any) -> Any:
    """The largest of the sixteen; of finite numbers only."""
    kind = ir.FunctionType(ir.DoubleType(), [REALS])
    target = cgutils.get_or_insert_function(b.module, kind, f"llvm.vector.reduce.fmax.v{LANES}f64")
    return b.call(target, [x], fastmath=("nnan",))


@_function(packed, packed)
def inverse_power(b: Any, x: Any) -> Any:
    """2^-e where 2^e <= |x| < 2^(e+1); 2^1023 where x = 0. Exact, and no division."""
    exponent = b.and_(b.bitcast(x, WORDS), _words(0x7FF << 52))
    return b.bitcast(b.sub(_words(0x7FE << 52), exponent), REALS)


@_function(packed, packed)
def power_near_root(b: Any, x: Any) -> Any:
    """The power of two f with x / 2 <= f^2 < 2 x, of x > 0."""
    exponent = b.sub(b.lshr(b.bitcast(x, WORDS), _words(52)), _words(1023))
    half = b.ashr(b.add(exponent, _words(1)), _words(1))
    return b.bitcast(b.shl(b.add(half, _words(1023)), _words(52)), REALS)


def _place(context: Any, builder: Any, kind: Any, array: Any, index: Any) -> Any:
    data = context.make_array(kind)(context, builder, array).data
    first = builder.mul(index, ir.Constant(index.type, LANES))
    return builder.bitcast(builder.gep(data, [first]), REALS.as_pointer())


@intrinsic
def load(typing: Any, array: Any, index: Any) -> Any:
    """Packed number `index` of a flat array."""

    def generate(context: Any, builder: Any, kinds: Any, args: Any) -> Any:
        value = builder.load(_place(context, builder, kinds.args[0], *args))
        value.align = 8
        return value

    return signature(packed, array, types.intp), generate


@intrinsic
def store(typing: Any, array: Any, index: Any, value: Any) -> Any:
    """Write packed number `index` of a flat array."""

    def generate(context: Any, builder: Any, kinds: Any, args: Any) -> Any:
        builder.store(args[2], _place(context, builder, kinds.args[0], *args[:2])).align = 8
        return context.get_dummy_value()

    return signature(types.void, array, types.intp, packed), generate


@njit(error_model="numpy", forceinline=True)
def room(count: int) -> Any:
    """Zeros for `count` packed numbers, from a cache line's start: a load across two lines costs twice."""
    wide = np.zeros(count * LANES + 8)
    first = -(wide.ctypes.data // 8) % 8
    return wide[first : first + count * LANES]

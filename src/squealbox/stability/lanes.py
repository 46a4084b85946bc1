"""Operations on sixteen doubles at once, written as LLVM vectors.

The loop vectoriser guards every loop over slices of one array with checks for overlap that cost as much as the work, so
the innermost operations of `kernels_lanes` say themselves which registers are packed.
"""

from typing import Any

from llvmlite import ir
from numba import extending, types
from numba.core import cgutils

intrinsic: Any = extending.intrinsic  # untyped, and its calls leave out the typing context
LANES = 16
EPS = 2.220446049250313e-16
FLAGS = ("contract", "nsz", "arcp", "reassoc", "afn")


class _Vectors:
    """Loads and stores of sixteen doubles in the flat arrays of one call."""

    def __init__(self, context: Any, builder: Any, signature: Any, args: Any) -> None:
        self.builder = builder
        self.kind = ir.VectorType(ir.DoubleType(), LANES)
        self.bases = [
            context.make_array(kind)(context, builder, arg).data if isinstance(kind, types.Array) else arg
            for kind, arg in zip(signature.args, args, strict=True)
        ]

    def at(self, base: Any, offset: Any) -> Any:
        place = self.builder.gep(base, [offset])
        return self.builder.bitcast(place, self.kind.as_pointer())

    def load(self, base: Any, offset: Any) -> Any:
        value = self.builder.load(self.at(base, offset))
        value.align = 8
        return value

    def store(self, value: Any, base: Any, offset: Any) -> None:
        self.builder.store(value, self.at(base, offset)).align = 8

    def times(self, a: Any, b: Any) -> Any:
        return self.builder.fmul(a, b, flags=FLAGS)

    def plus(self, a: Any, b: Any) -> Any:
        return self.builder.fadd(a, b, flags=FLAGS)

    def minus(self, a: Any, b: Any) -> Any:
        return self.builder.fsub(a, b, flags=FLAGS)


@intrinsic
def reflect(typing: Any, h: Any, first: Any, apart: Any, stride: Any, count: Any, width: Any, v: Any) -> Any:
    """For `count` triples (a, b, c) at first, + apart, + 2 apart, `stride` on: p = f0 a + f1 b + f2 c; a -= p g0, ...

    v holds f0, f1, f2, g0, g1, g2, sixteen of each; with `width` 2 only a and b exist.
    """
    signature = types.void(h, types.intp, types.intp, types.intp, types.intp, types.intp, v)

    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        vectors = _Vectors(context, builder, signature, args)
        target, _, _, _, _, _, weights = vectors.bases
        f = [vectors.load(weights, ir.Constant(ir.IntType(64), i * LANES)) for i in range(6)]

        def body(size: int) -> None:
            with cgutils.for_range(builder, args[4]) as loop:
                place = builder.add(args[1], builder.mul(loop.index, args[3]))
                places = [builder.add(place, builder.mul(args[2], ir.Constant(ir.IntType(64), i))) for i in range(size)]
                parts = [vectors.load(target, where) for where in places]
                p = vectors.times(f[0], parts[0])
                for i in range(1, size):
                    p = vectors.plus(p, vectors.times(f[i], parts[i]))
                for i in range(size):
                    vectors.store(vectors.minus(parts[i], vectors.times(p, f[3 + i])), target, places[i])

        three = builder.icmp_signed("==", args[5], ir.Constant(ir.IntType(64), 3))
        with builder.if_else(three) as (then, otherwise):
            with then:
                body(3)
            with otherwise:
                body(2)
        return context.get_dummy_value()

    return signature, generate


@intrinsic
def add_product(
    typing: Any, out: Any, o: Any, a: Any, i: Any, b: Any, j: Any, stride_a: Any, stride_b: Any, count: Any
) -> Any:
    """out[o] = sum over `count` of a[i + k stride_a] b[j + k stride_b], sixteen wide."""
    signature = types.void(out, types.intp, a, types.intp, b, types.intp, types.intp, types.intp, types.intp)

    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        vectors = _Vectors(context, builder, signature, args)
        total = cgutils.alloca_once_value(builder, ir.Constant(vectors.kind, [0.0] * LANES))
        with cgutils.for_range(builder, args[8]) as loop:
            left = vectors.load(vectors.bases[2], builder.add(args[3], builder.mul(loop.index, args[6])))
            right = vectors.load(vectors.bases[4], builder.add(args[5], builder.mul(loop.index, args[7])))
            builder.store(vectors.plus(builder.load(total), vectors.times(left, right)), total)
        vectors.store(builder.load(total), vectors.bases[0], args[1])
        return context.get_dummy_value()

    return signature, generate


@intrinsic
def subtract_scaled(typing: Any, h: Any, i: Any, stride: Any, v: Any, j: Any, s: Any, k: Any, count: Any) -> Any:
    """h[i + m stride] -= v[j + m 16] s[k] for m < count, sixteen wide."""
    signature = types.void(h, types.intp, types.intp, v, types.intp, s, types.intp, types.intp)

    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        vectors = _Vectors(context, builder, signature, args)
        scale = vectors.load(vectors.bases[5], args[6])
        with cgutils.for_range(builder, args[7]) as loop:
            place = builder.add(args[1], builder.mul(loop.index, args[2]))
            weight = builder.add(args[4], builder.mul(loop.index, ir.Constant(ir.IntType(64), LANES)))
            old = vectors.load(vectors.bases[0], place)
            vectors.store(
                vectors.minus(old, vectors.times(vectors.load(vectors.bases[3], weight), scale)),
                vectors.bases[0],
                place,
            )
        return context.get_dummy_value()

    return signature, generate


@intrinsic
def window_starts(typing: Any, h: Any, entry: Any, row: Any, size: Any, ends: Any) -> Any:
    """First row of the coupled window of every lane, into the second sixteen of `ends`, from its last row in the first.

    That is the largest i not above the last row with |h(i, i-1)| <= eps (|h(i-1, i-1)| + |h(i, i)|), or 0.
    """
    signature = types.void(h, types.intp, types.intp, types.intp, ends)

    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        vectors = _Vectors(context, builder, signature, args)
        kind, matrix, out = vectors.kind, vectors.bases[0], vectors.bases[4]

        def size_of(offset: Any) -> Any:
            name = f"llvm.fabs.v{LANES}f64"
            absolute = cgutils.get_or_insert_function(builder.module, ir.FunctionType(kind, [kind]), name)
            return builder.call(absolute, [vectors.load(matrix, offset)])

        last = vectors.load(out, ir.Constant(ir.IntType(64), 0))
        found = cgutils.alloca_once_value(builder, ir.Constant(kind, [0.0] * LANES))
        here = cgutils.alloca_once_value(builder, ir.Constant(kind, [1.0] * LANES))
        diagonal = builder.add(args[2], args[1])
        with cgutils.for_range(builder, builder.sub(args[3], ir.Constant(ir.IntType(64), 1))) as loop:
            before = builder.mul(loop.index, diagonal)
            beside = vectors.plus(size_of(before), size_of(builder.add(before, diagonal)))
            below = size_of(builder.add(before, args[2]))
            limit = vectors.times(beside, ir.Constant(kind, [EPS] * LANES))
            number = builder.load(here)
            split = builder.and_(builder.fcmp_ordered("<=", below, limit), builder.fcmp_ordered("<=", number, last))
            builder.store(builder.select(split, number, builder.load(found)), found)
            builder.store(vectors.plus(number, ir.Constant(kind, [1.0] * LANES)), here)
        vectors.store(builder.load(found), out, ir.Constant(ir.IntType(64), LANES))
        return context.get_dummy_value()

    return signature, generate


@intrinsic
def reflectors(
    typing: Any, h: Any, column: Any, row: Any, third: Any, step: Any, ends: Any, shifts: Any, f: Any
) -> Any:
    """The reflection of every lane at one step, as the six vectors `reflect` takes; doing nothing outside the window.

    column, + row and `third` are the places of the entries it clears; the windows' ends and `step` are real numbers.
    """
    signature = types.void(h, types.intp, types.intp, types.intp, types.float64, ends, shifts, f)

    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        vectors = _Vectors(context, builder, signature, args)
        kind, matrix, out = vectors.kind, vectors.bases[0], vectors.bases[7]
        load, times, plus = vectors.load, vectors.times, vectors.plus

        def number(value: float) -> Any:
            return ir.Constant(kind, [value] * LANES)

        def place(i: int) -> Any:
            return ir.Constant(ir.IntType(64), i * LANES)

        def call(name: str, x: Any) -> Any:
            shape = ir.FunctionType(kind, [kind])
            return builder.call(cgutils.get_or_insert_function(builder.module, shape, f"{name}.v{LANES}f64"), [x])

        def over(x: Any, live: Any) -> Any:
            return builder.fdiv(number(1.0), builder.select(live, x, number(1.0)), flags=FLAGS)

        at = builder.insert_element(ir.Constant(kind, ir.Undefined), args[4], ir.Constant(ir.IntType(32), 0))
        zeros = ir.Constant(ir.VectorType(ir.IntType(32), LANES), [0] * LANES)
        at = builder.shuffle_vector(at, ir.Constant(kind, ir.Undefined), zeros)
        last, low = load(vectors.bases[5], place(0)), load(vectors.bases[5], place(1))
        first = builder.fcmp_ordered("==", low, at)
        active = builder.and_(builder.fcmp_ordered(">=", at, low), builder.fcmp_ordered("<", at, last))
        three = builder.fcmp_ordered("<", plus(at, number(1.0)), last)
        places = [args[1], builder.add(args[1], args[2]), args[3]]
        old = [load(matrix, where) for where in places]
        p, q, r = (builder.select(first, load(vectors.bases[6], place(i)), old[i]) for i in range(3))
        r = builder.select(three, r, number(0.0))
        size = plus(plus(call("llvm.fabs", p), call("llvm.fabs", q)), call("llvm.fabs", r))
        live = builder.and_(active, builder.fcmp_ordered(">", size, number(0.0)))
        scale = over(size, live)
        p, q, r = times(p, scale), times(q, scale), times(r, scale)
        length = call("llvm.sqrt", plus(plus(times(p, p), times(q, q)), times(r, r)))
        s = builder.select(builder.fcmp_ordered("<", p, number(0.0)), vectors.minus(number(0.0), length), length)
        u = plus(p, s)
        by_s, by_u = over(s, live), over(u, live)
        parts = [times(q, by_u), times(r, by_u), times(u, by_s), times(q, by_s), times(r, by_s)]
        vectors.store(number(1.0), out, place(0))
        for i, part in enumerate(parts):
            vectors.store(builder.select(live, part, number(0.0)), out, place(i + 1))
        inner = builder.and_(active, builder.fcmp_ordered(">", at, low))
        wide = builder.and_(inner, three)
        vectors.store(builder.select(wide, number(0.0), old[2]), matrix, places[2])
        vectors.store(builder.select(inner, number(0.0), old[1]), matrix, places[1])
        kept = builder.select(inner, vectors.minus(number(0.0), times(s, size)), old[0])
        vectors.store(kept, matrix, places[0])
        return context.get_dummy_value()

    return signature, generate

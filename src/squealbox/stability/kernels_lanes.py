"""Compiled spectra of many small real matrices, sixteen at a time on packed registers.

The steps are LAPACK's: balance, Householder reduction to Hessenberg form, Francis double-shift QR. Sixteen matrices lie
side by side, entry (i, j) of all of them at (i n + j) 16, and a reflection is applied to all at once. What differs
between them, the window that is still coupled and its shifts, is settled by a scalar pass between two sweeps; a matrix
outside its window, or finished, takes part with a reflection that does nothing.

The three innermost operations are written as LLVM vectors, because the loop vectoriser guards every loop over slices of
one array with checks for overlap that cost as much as the work. Importing this module loads numba; only `spectra` does.
"""

import math
from typing import Any

import numpy as np
from llvmlite import ir
from numba import extending, njit, types
from numba.core import cgutils

intrinsic: Any = extending.intrinsic  # untyped, and its calls leave out the typing context
LANES = 16
EPS = 2.220446049250313e-16
SWEEPS = 60  # QR sweeps on one eigenvalue before the matrix is given up
FAST = {"contract", "nsz", "arcp", "reassoc", "afn"}  # not nnan or ninf: they would remove the tests for lost lanes
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


@njit(error_model="numpy", fastmath=FAST)
def hessenberg(h: Any, n: int, v: Any, s: Any) -> None:
    """Householder reduction of all lanes; v holds the vector, s sums and scales."""
    row, entry = n * LANES, LANES
    for m in range(n - 2):
        size = n - m - 1
        corner = (m + 1) * row + m * entry
        add_product(s, 0, h, corner + row, h, corner + row, row, row, size - 1)
        for lane in range(LANES):
            x, rest = h[corner + lane], s[lane]
            length = math.sqrt(x * x + rest)
            alpha = -length if x > 0.0 else length
            live = rest > 0.0
            u = x - alpha
            v[lane] = u
            s[LANES + lane] = 2.0 / (u * u + rest) if live else 0.0
            s[2 * LANES + lane] = alpha if live else x
        for i in range(1, size):
            for lane in range(LANES):
                v[i * LANES + lane] = h[corner + i * row + lane]
        for lane in range(LANES):
            h[corner + lane] = s[2 * LANES + lane]
        for i in range(1, size):
            for lane in range(LANES):
                h[corner + i * row + lane] = 0.0
        for j in range(m + 1, n):
            start = (m + 1) * row + j * entry
            add_product(s, 0, v, 0, h, start, entry, row, size)
            for lane in range(LANES):
                s[lane] *= s[LANES + lane]
            subtract_scaled(h, start, row, v, 0, s, 0, size)
        for i in range(n):
            start = i * row + (m + 1) * entry
            add_product(s, 0, v, 0, h, start, entry, entry, size)
            for lane in range(LANES):
                s[lane] *= s[LANES + lane]
            subtract_scaled(h, start, entry, v, 0, s, 0, size)


@njit(error_model="numpy", fastmath=FAST)
def settle(h: Any, n: int, lane: int, state: Any, start: int, shifts: Any, values: Any, row_of: int) -> bool:
    """Write the eigenvalues of one lane that have split off, and prepare its next window; True while it has one.

    state (3, lanes): last row of the window, first row, sweeps; `start` is the first row found for that last row;
    values[row_of] takes the eigenvalues.
    """
    row = n * LANES
    last = state[0, lane]
    low = start
    while last >= 0:
        if low < 0:
            low = last
            while low >= 1:
                size = abs(h[(low - 1) * row + (low - 1) * LANES + lane]) + abs(h[low * row + low * LANES + lane])
                if abs(h[low * row + (low - 1) * LANES + lane]) <= EPS * size:
                    break
                low -= 1
        x = h[last * row + last * LANES + lane]
        if low == last:
            values[row_of, last] = complex(x, 0.0)
            last -= 1
            low = -1
            state[2, lane] = 0
            continue
        y = h[(last - 1) * row + (last - 1) * LANES + lane]
        w = h[last * row + (last - 1) * LANES + lane] * h[(last - 1) * row + last * LANES + lane]
        if low == last - 1:
            p = 0.5 * (y - x)
            q = p * p + w
            z = math.sqrt(abs(q))
            if q >= 0.0:
                z = p + (z if p >= 0.0 else -z)
                values[row_of, last - 1] = complex(x + z, 0.0)
                values[row_of, last] = complex(x - w / z if z != 0.0 else x + z, 0.0)
            else:
                values[row_of, last - 1] = complex(x + p, z)
                values[row_of, last] = complex(x + p, -z)
            last -= 2
            low = -1
            state[2, lane] = 0
            continue
        state[2, lane] += 1
        if state[2, lane] > SWEEPS or not abs(x) < 1e300:
            for i in range(last + 1):
                values[row_of, i] = complex(math.nan, math.nan)
            last = -1
            break
        if state[2, lane] % 10 == 0:
            size = abs(h[last * row + (last - 1) * LANES + lane]) + abs(h[(last - 1) * row + (last - 2) * LANES + lane])
            x += 0.75 * size
            y = x
            w = -0.4375 * size * size
        corner = low * row + low * LANES + lane
        z = h[corner]
        r, s = x - z, y - z
        shifts[lane] = (r * s - w) / h[corner + row] + h[corner + LANES]
        shifts[LANES + lane] = h[corner + row + LANES] - z - r - s
        shifts[2 * LANES + lane] = h[corner + 2 * row + LANES]
        state[0, lane], state[1, lane] = last, low
        return True
    state[0, lane], state[1, lane] = -1, n
    return False


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


@njit(error_model="numpy", fastmath=FAST)
def mirror(f: Any) -> None:
    """Exchange the two triples of f: the columns take the transposed reflection."""
    for i in range(3 * LANES):
        swap = f[i]
        f[i] = f[3 * LANES + i]
        f[3 * LANES + i] = swap


@njit(error_model="numpy", fastmath=FAST)
def francis(h: Any, n: int, count: int, state: Any, ends: Any, shifts: Any, f: Any, values: Any, start: int) -> None:
    """QR sweeps until every lane has all its eigenvalues."""
    row = n * LANES
    for lane in range(LANES):
        state[0, lane] = n - 1 if lane < count else -1
        state[1, lane] = n
        state[2, lane] = 0
    while True:
        for lane in range(LANES):
            ends[lane] = float(state[0, lane])
        window_starts(h, LANES, row, n, ends)
        top, bottom = -1, n
        for lane in range(count):
            if state[0, lane] >= 0 and settle(h, n, lane, state, int(ends[LANES + lane]), shifts, values, start + lane):
                top, bottom = max(top, state[0, lane]), min(bottom, state[1, lane])
        if top < 0:
            return
        for lane in range(LANES):
            ends[lane], ends[LANES + lane] = float(state[0, lane]), float(state[1, lane])
        for k in range(bottom, top):
            column = k * row + max(k - 1, 0) * LANES
            third = min(k + 2, n - 1) * row + max(k - 1, 0) * LANES
            reflectors(h, column, row, third, float(k), ends, shifts, f)
            width = 3 if k < top - 1 else 2
            reflect(h, k * row + k * LANES, row, LANES, top + 1 - k, width, f)
            mirror(f)
            reflect(h, bottom * row + k * LANES, LANES, row, min(top, k + 3) + 1 - bottom, width, f)


@njit(error_model="numpy")
def balance(a: Any, n: int) -> None:
    """Scale rows and columns by powers of two until their norms agree."""
    done = False
    while not done:
        done = True
        for i in range(n):
            c = 0.0
            r = 0.0
            for j in range(n):
                c += abs(a[j, i])
                r += abs(a[i, j])
            c -= abs(a[i, i])
            r -= abs(a[i, i])
            if not (c > 0.0 and r > 0.0 and c < 1e300 and r < 1e300):
                continue
            f = 1.0
            s = c + r
            while c < r / 2.0:
                f *= 2.0
                c *= 4.0
            while c > r * 2.0:
                f /= 2.0
                c /= 4.0
            if (c + r) / f < 0.95 * s:
                done = False
                for j in range(n):
                    a[i, j] /= f
                for j in range(n):
                    a[j, i] *= f


@njit(cache=True, error_model="numpy")
def spectra(matrices: Any, values: Any) -> None:
    """Eigenvalues of matrices (count, n, n) into values (count, n); NaN where QR does not converge."""
    number, n = matrices.shape[0], matrices.shape[1]
    a = np.empty((n, n))
    h = np.zeros(n * n * LANES)
    v = np.zeros(max(n, 8) * LANES)
    s = np.zeros(3 * LANES)
    shifts = np.zeros(3 * LANES)
    ends = np.zeros(2 * LANES)
    f = np.zeros(6 * LANES)
    state = np.zeros((3, LANES), dtype=np.int64)
    for start in range(0, number, LANES):
        count = min(LANES, number - start)
        for lane in range(count):
            a[:, :] = matrices[start + lane]
            balance(a, n)
            for i in range(n):
                for j in range(n):
                    h[(i * n + j) * LANES + lane] = a[i, j]
        hessenberg(h, n, v, s)
        francis(h, n, count, state, ends, shifts, f, values, start)

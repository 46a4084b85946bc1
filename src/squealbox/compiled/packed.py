"""Sixteen real numbers as one value of translated code, with arithmetic, comparisons and a choice by mask.

A loop over lanes is packed by LLVM only when it can prove that nothing overlaps, and fails silently when it cannot.
Here a variable of a kernel simply is a vector: `x * y + z` are packed instructions, on AVX2, AVX-512 or NEON, and the
kernel reads like the formula for one matrix. What a comparison of two of them gives is a mask. Operations may be fused
and reordered, unlike those of single numbers.

Entry i of an array of packed numbers is `load(array, i)`; the array holds 16 doubles for each.
"""

from collections.abc import Callable
from typing import Any

import numpy as np

from squealbox.compiled.arithmetic import FLAGS
from squealbox.compiled.kinds import FLOAT, LANES, MASK, PACKED, TEXTS, TRUTH, WHOLE, Array, Number, Untranslatable

REALS, BITS, WORDS = TEXTS[PACKED], TEXTS[MASK], f"<{LANES} x i64>"


class Written:
    """A function of kernels that writes its own instructions, from values of the kinds it is for."""

    def __init__(self, kinds: str, write: Callable[..., Any]) -> None:
        self.kinds, self.lines, self.__doc__ = kinds, write, write.__doc__

    def __call__(self, *_: Any) -> Any:
        raise TypeError("a function of compiled code alone")

    def write(self, _: Any, caller: Any, values: list[Any]) -> Any:
        """Its instructions there; numbers known beforehand become those of the wanted kind."""
        if len(values) != len(self.kinds):
            raise Untranslatable(f"{len(values)} arguments, of {len(self.kinds)} expected")
        given = [caller.numbered(x, kind) if kind != "a" else x for x, kind in zip(values, self.kinds, strict=True)]
        return self.lines(caller, *given)


def written(kinds: str) -> Callable[[Callable[..., Any]], Written]:
    """A function of kernels from the one that writes its instructions; an array is "a" among the kinds."""
    return lambda write: Written(kinds, write)


def _intrinsic(f: Any, name: str, *values: Number) -> Number:
    f.needed.add(f"declare {REALS} @llvm.{name}.v{LANES}f64({', '.join([REALS] * len(values))})")
    given = ", ".join(f"{REALS} {x.text}" for x in values)
    return Number(PACKED, f.put(f"call {FLAGS} {REALS} @llvm.{name}.v{LANES}f64({given})"))


def _chosen(f: Any, where: Number, x: Number, y: Number) -> Number:
    return Number(PACKED, f.put(f"select {BITS} {where.text}, {REALS} {x.text}, {REALS} {y.text}"))


def _words(value: int) -> str:
    return "<" + ", ".join([f"i64 {value}"] * LANES) + ">"


@written(FLOAT)
def splat(f: Any, x: Number) -> Number:
    """The same number in all lanes."""
    return f.numbered(x, PACKED)


@written(MASK + PACKED + PACKED)
def select(f: Any, where: Number, x: Number, y: Number) -> Number:
    """x where the mask holds, else y."""
    return _chosen(f, where, x, y)


@written(MASK)
def some(f: Any, where: Number) -> Number:
    """Whether the mask holds in any lane."""
    bits = f.put(f"bitcast {BITS} {where.text} to i{LANES}")
    return Number(TRUTH, f.put(f"icmp ne i{LANES} {bits}, 0"))


@written(MASK)
def word(f: Any, where: Number) -> Number:
    """The mask as a whole number, whose bit k is lane k."""
    bits = f.put(f"bitcast {BITS} {where.text} to i{LANES}")
    return Number(WHOLE, f.put(f"zext i{LANES} {bits} to i64"))


@written(PACKED)
def root(f: Any, x: Number) -> Number:
    """The square root."""
    return _intrinsic(f, "sqrt", x)


@written(PACKED + PACKED)
def signed(f: Any, x: Number, y: Number) -> Number:
    """|x| with the sign of y."""
    return _intrinsic(f, "copysign", x, y)


@written(PACKED + PACKED)
def larger(f: Any, x: Number, y: Number) -> Number:
    """The larger of two numbers; y when either is NaN."""
    return _chosen(f, f.compare(">", x, y), x, y)


@written(PACKED + PACKED)
def smaller(f: Any, x: Number, y: Number) -> Number:
    """The smaller of two numbers; y when either is NaN."""
    return _chosen(f, f.compare("<", x, y), x, y)


@written(PACKED)
def largest(f: Any, x: Number) -> Number:
    """The largest of the sixteen; of finite numbers only."""
    f.needed.add(f"declare double @llvm.vector.reduce.fmax.v{LANES}f64({REALS})")
    return Number(FLOAT, f.put(f"call nnan double @llvm.vector.reduce.fmax.v{LANES}f64({REALS} {x.text})"))


@written(PACKED)
def inverse_power(f: Any, x: Number) -> Number:
    """2^-e where 2^e <= |x| < 2^(e+1); 2^1023 where x = 0. Exact, and no division."""
    word = f.put(f"bitcast {REALS} {x.text} to {WORDS}")
    exponent = f.put(f"and {WORDS} {word}, {_words(0x7FF << 52)}")
    turned = f.put(f"sub {WORDS} {_words(0x7FE << 52)}, {exponent}")
    return Number(PACKED, f.put(f"bitcast {WORDS} {turned} to {REALS}"))


@written(PACKED)
def power_near_root(f: Any, x: Number) -> Number:
    """The power of two f with x / 2 <= f^2 < 2 x, of x > 0."""
    word = f.put(f"bitcast {REALS} {x.text} to {WORDS}")
    high = f.put(f"lshr {WORDS} {word}, {_words(52)}")
    exponent = f.put(f"sub {WORDS} {high}, {_words(1022)}")
    half = f.put(f"ashr {WORDS} {exponent}, {_words(1)}")
    biased = f.put(f"add {WORDS} {half}, {_words(1023)}")
    shifted = f.put(f"shl {WORDS} {biased}, {_words(52)}")
    return Number(PACKED, f.put(f"bitcast {WORDS} {shifted} to {REALS}"))


def _place(f: Any, array: Array, index: Number, apart: int) -> str:
    first = f.put(f"mul i64 {index.text}, {apart}")
    place: str = f.put(f"getelementptr double, ptr {array.pointer}, i64 {first}")
    return place


@written("a" + WHOLE)
def load(f: Any, array: Array, index: Number) -> Number:
    """Packed number `index` of a flat array."""
    return Number(PACKED, f.put(f"load {REALS}, ptr {_place(f, array, index, LANES)}, align 8"))


@written("a" + WHOLE + PACKED)
def store(f: Any, array: Array, index: Number, value: Number) -> None:
    """Write packed number `index` of a flat array."""
    f.lines.append(f"store {REALS} {value.text}, ptr {_place(f, array, index, LANES)}, align 8")


@written("a" + WHOLE)
def columns(f: Any, array: Array, index: Number) -> tuple[Number, ...]:
    """The four entries, each of sixteen matrices of 2 x 2 that lie flat from the one numbered 16 `index` on."""
    whole = f"<{4 * LANES} x double>"
    found = f.put(f"load {whole}, ptr {_place(f, array, index, 4 * LANES)}, align 8")
    out = []
    for k in range(4):
        places = ", ".join(f"i32 {4 * lane + k}" for lane in range(LANES))
        out.append(Number(PACKED, f.put(f"shufflevector {whole} {found}, {whole} poison, <{LANES} x i32> <{places}>")))
    return tuple(out)


def room(count: int) -> Any:
    """Zeros for `count` packed numbers, from a cache line's start: a load across two lines costs twice."""
    wide = np.zeros(count * LANES + 8)
    first = -(wide.ctypes.data // 8) % 8
    return wide[first : first + count * LANES]

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

from squealbox.compiled import vectors
from squealbox.compiled.arithmetic import FLAGS
from squealbox.compiled.kinds import FLOAT, LANES, MASK, PACKED, TEXTS, TRUTH, WHOLE, Array, Number, Untranslatable
from squealbox.compiled.vectors import Lanes, Truth, as_reals, as_whole, bits, called, put, whole, wide, writing

REALS = TEXTS[PACKED]
OBJECTS: dict[str, Callable[[str], Any]] = {PACKED: Lanes, MASK: Truth}


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
        objects = [OBJECTS[x.kind](x.text) if getattr(x, "kind", "") in OBJECTS else x for x in given]
        with writing(caller, LANES, FLAGS):
            found = self.lines(*objects)
        return tuple(map(_number, found)) if isinstance(found, tuple) else _number(found)


def _number(found: Any) -> Any:
    """What translated code knows: a number in a register."""
    if isinstance(found, Lanes):
        return Number(PACKED, found.vector)
    return Number(MASK, found.vector) if isinstance(found, Truth) else found


def written(kinds: str) -> Callable[[Callable[..., Any]], Written]:
    """A function of kernels from one that works on lanes and writes; an array is "a" among the kinds."""
    return lambda write: Written(kinds, write)


select = written(MASK + PACKED + PACKED)(vectors.where)
root = written(PACKED)(vectors.sqrt)
larger = written(PACKED + PACKED)(vectors.maximum)
smaller = written(PACKED + PACKED)(vectors.minimum)


@written(PACKED)
def splat(x: Lanes) -> Lanes:
    """The same number in all lanes."""
    return x


@written(MASK)
def some(where: Truth) -> Number:
    """Whether the mask holds in any lane."""
    return Number(TRUTH, put(f"icmp ne i64 {bits(where)}, 0"))


@written(MASK)
def word(where: Truth) -> Number:
    """The mask as a whole number, whose bit k is lane k."""
    return Number(WHOLE, bits(where))


@written(PACKED + PACKED)
def signed(x: Lanes, y: Lanes) -> Lanes:
    """|x| with the sign of y."""
    return Lanes(called("copysign", x.vector, y.vector))


@written(PACKED)
def largest(x: Lanes) -> Number:
    """The largest of the sixteen; of finite numbers only."""
    vectors.WRITER.get().needed.add(f"declare double @llvm.vector.reduce.fmax.v{LANES}f64({REALS})")
    return Number(FLOAT, put(f"call nnan double @llvm.vector.reduce.fmax.v{LANES}f64({REALS} {x.vector})"))


@written(PACKED)
def inverse_power(x: Lanes) -> Lanes:
    """2^-e where 2^e <= |x| < 2^(e+1); 2^1023 where x = 0. Exact, and no division."""
    exponent = put(f"and {wide()} {as_whole(x.vector)}, {whole(0x7FF << 52)}")
    return Lanes(as_reals(put(f"sub {wide()} {whole(0x7FE << 52)}, {exponent}")))


@written(PACKED)
def power_near_root(x: Lanes) -> Lanes:
    """The power of two f with x / 2 <= f^2 < 2 x, of x > 0."""
    high = put(f"lshr {wide()} {as_whole(x.vector)}, {whole(52)}")
    exponent = put(f"sub {wide()} {high}, {whole(1022)}")
    half = put(f"ashr {wide()} {exponent}, {whole(1)}")
    biased = put(f"add {wide()} {half}, {whole(1023)}")
    return Lanes(as_reals(put(f"shl {wide()} {biased}, {whole(52)}")))


def _place(array: Array, index: Number, apart: int) -> str:
    first = put(f"mul i64 {index.text}, {apart}")
    return put(f"getelementptr double, ptr {array.pointer}, i64 {first}")


@written("a" + WHOLE)
def load(array: Array, index: Number) -> Lanes:
    """Packed number `index` of a flat array."""
    return Lanes(put(f"load {REALS}, ptr {_place(array, index, LANES)}, align 8"))


@written("a" + WHOLE + PACKED)
def store(array: Array, index: Number, value: Lanes) -> None:
    """Write packed number `index` of a flat array."""
    at = _place(array, index, LANES)
    vectors.WRITER.get().lines.append(f"store {REALS} {value.vector}, ptr {at}, align 8")


@written("a" + WHOLE)
def columns(array: Array, index: Number) -> tuple[Lanes, ...]:
    """The four entries, each of sixteen matrices of 2 x 2 that lie flat from the one numbered 16 `index` on."""
    full = f"<{4 * LANES} x double>"
    found = put(f"load {full}, ptr {_place(array, index, 4 * LANES)}, align 8")
    out = []
    for k in range(4):
        places = ", ".join(f"i32 {4 * lane + k}" for lane in range(LANES))
        out.append(Lanes(put(f"shufflevector {full} {found}, {full} poison, <{LANES} x i32> <{places}>")))
    return tuple(out)


def room(count: int) -> Any:
    """Zeros for `count` packed numbers, from a cache line's start: a load across two lines costs twice."""
    wide = np.zeros(count * LANES + 8)
    first = -(wide.ctypes.data // 8) % 8
    return wide[first : first + count * LANES]

"""Packed numbers in memory: rows of doubles, one for each lane, and tables of coefficients that lie in them."""

from typing import Any

from squealbox.compiled.arithmetic import written
from squealbox.compiled.vectors import ALIGNED, WIDTH, WRITER, Lanes, fused, packed, put, reals, truths, whole, wide


def alignment() -> int:
    """Bytes at whose multiples rows begin: those of a single run just so, those of a group on a line of the cache."""
    return 8 if WIDTH.get() == 1 else ALIGNED


class Group:
    """The rows of a group in memory; indices are places of doubles, known or registers."""

    def __init__(self, data: str) -> None:
        self.data = data

    def at(self, place: Any) -> str:
        """Pointer to the double there."""
        return put(f"getelementptr double, ptr {self.data}, i64 {place}")


class Given:
    """Coefficients that lie in `count` rows one after another; those in `whole` are numbers known beforehand."""

    def __init__(self, group: Group, place: int, count: int, whole: dict[int, int]) -> None:
        self.group, self.place, self.count, self.whole = group, place, count, whole

    def __getitem__(self, i: int) -> Any:
        return self.whole[i] if i in self.whole else load(self.group, self.place + i * WIDTH.get())

    def of(self, index: str, first: int) -> Lanes:
        """In each lane the coefficient `index` places after that which comes `first`."""
        lanes, out = WIDTH.get(), "undef"
        for i in range(lanes):
            place = put(f"mul i64 {put(f'extractelement {wide()} {index}, i32 {i}')}, {lanes}")
            place = put(f"add i64 {place}, {self.place + first * lanes + i}")
            one = put(f"load double, ptr {self.group.at(place)}")
            out = put(f"insertelement {reals()} {out}, double {one}, i32 {i}")
        return Lanes(out)

    def last_below(self, x: Lanes, first: int, count: int) -> str:
        """In each lane the place of the last of `count` increasing coefficients that is not above x; 0 if none is."""
        found, kind, truth = whole(0), wide(), truths()
        for power in reversed(range((count - 1).bit_length())):
            tried = put(f"add {kind} {found}, {whole(1 << power)}")
            there = put(f"icmp ule {kind} {tried}, {whole(count - 1)}")
            tried = put(f"select {truth} {there}, {kind} {tried}, {kind} {found}")
            below = (self.of(tried, first) <= x).vector
            found = put(f"select {truth} {below}, {kind} {tried}, {kind} {found}")
        return found


def load(group: Group, place: int, aligned: int | None = None) -> Lanes:
    """The row that begins there, at a multiple of so many bytes."""
    return Lanes(put(f"load {reals()}, ptr {group.at(place)}, align {aligned or alignment()}"))


def store(group: Group, place: int, value: Any, aligned: int | None = None) -> None:
    """Write a row; None is a coefficient that is zero in every lane."""
    at = group.at(place)
    WRITER.get().lines.append(
        f"store {reals()} {packed(0.0 if value is None else value)}, ptr {at}, align {aligned or alignment()}"
    )


def spread(group: Group, place: int) -> Lanes:
    """The double there, in every lane."""
    one = put(f"insertelement {reals()} poison, double {put(f'load double, ptr {group.at(place)}')}, i32 0")
    return Lanes(put(f"shufflevector {reals()} {one}, {reals()} poison, <{WIDTH.get()} x i32> zeroinitializer"))


def store_one(group: Group, place: int, value: Any) -> None:
    """Write the double there, a number or a register."""
    text = value if isinstance(value, str) else written(value)
    WRITER.get().lines.append(f"store double {text}, ptr {group.at(place)}")


def at_once(group: Group, b: int, since: int, terms: int, breadth: int, count: int, values: int, slopes: int) -> str:
    """Several series and their slopes at one instant, a lane for each: `count` coefficients, `breadth` apart."""
    at, total, slope = spread(group, b + since), None, None
    for k in range(count - 1, -1, -1):
        term = load(group, b + terms + k * breadth, 8)
        slope = total if slope is None or total is None else fused(slope, at, total)
        total = term if total is None else fused(total, at, term)
    store(group, b + values, total, 8)
    store(group, b + slopes, slope, 8)
    return "0"

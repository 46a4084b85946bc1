"""Expressions of translated code: names, elements and fields, choices and calls."""

import ast
import itertools
import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from squealbox.compiled.arithmetic import Arithmetic, literal
from squealbox.compiled.kinds import (
    FLOAT,
    TEXTS,
    TRUTH,
    WHOLE,
    Array,
    Named,
    Number,
    OfAnotherText,
    Record,
    Untranslatable,
    Value,
    handed,
    kind_of,
    registers,
)

if TYPE_CHECKING:
    from squealbox.compiled.translation import Unit

SIGNS: dict[type[ast.AST], str] = {
    ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/", ast.FloorDiv: "//", ast.Mod: "%", ast.Pow: "**",
    ast.BitAnd: "&", ast.BitOr: "|", ast.BitXor: "^", ast.LShift: "<<", ast.RShift: ">>", ast.Lt: "<", ast.LtE: "<=",
    ast.Gt: ">", ast.GtE: ">=", ast.Eq: "==", ast.NotEq: "!=", ast.Is: "==", ast.IsNot: "!=",
}  # fmt: skip
ELEMENTS = {np.dtype("f8"): FLOAT, np.dtype("i8"): WHOLE}
NUMPY = (np, math)


@dataclass(frozen=True, slots=True)
class Room:
    """A variable that holds a number of a kind."""

    kind: str


@dataclass(frozen=True, slots=True)
class Several:
    """A variable that holds a tuple, each part under a name of its own."""

    count: int


class Expressions(Arithmetic):
    """Writes expressions of one function."""

    def __init__(self, unit: "Unit") -> None:
        super().__init__()
        self.unit = unit
        self.rooms: list[str] = []
        self.local: dict[str, Value] = {}
        self.labels = itertools.count()
        self.open = True

    def unknown(self, node: ast.AST) -> Any:
        """What the plain subset does not have."""
        raise Untranslatable(f"{type(node).__name__} is not known")

    def label(self, name: str) -> None:
        """A block begins."""
        self.lines.append(f"{name}:")
        self.open = True

    def jump(self, name: str) -> None:
        """The end of a block that has not been left."""
        if self.open:
            self.lines.append(f"br label %{name}")
        self.open = False

    def value(self, node: ast.expr) -> Value:
        """What an expression is."""
        return getattr(self, f"of_{type(node).__name__}", self.unknown)(node)

    def of_Constant(self, node: ast.Constant) -> Value:
        """A number as it stands."""
        if not isinstance(node.value, int | float):
            raise Untranslatable(f"{node.value!r}")
        return node.value

    def of_Name(self, node: ast.Name) -> Value:
        """What a name stands for: a variable, or a name of the text."""
        if node.id in self.local:
            return self.named(node.id)
        if node.id in self.unit.names:
            found = self.unit.names[node.id]
            return self.number_elsewhere(found) if isinstance(found, OfAnotherText) else found
        raise Untranslatable(f"the name {node.id}")

    def number_elsewhere(self, found: OfAnotherText) -> Number:
        """A number that another text holds."""
        assert found.kind is not None
        symbol = self.unit.symbol(found, None)
        self.needed.add(f'@"{symbol}" = external constant {TEXTS[found.kind]}')
        return Number(found.kind, self.put(f'load {TEXTS[found.kind]}, ptr @"{symbol}"'))

    def named(self, name: str) -> Value:
        """What a variable holds."""
        found = self.local[name]
        if isinstance(found, Room):
            return Number(found.kind, self.put(f"load {TEXTS[found.kind]}, ptr %v.{name}"))
        return tuple(self.named(f"{name}.{k}") for k in range(found.count)) if isinstance(found, Several) else found

    def of_Tuple(self, node: ast.Tuple) -> Value:
        """Several values."""
        return tuple(self.value(each) for each in node.elts)

    def of_UnaryOp(self, node: ast.UnaryOp) -> Value:
        """not, -, + or ~ of a value."""
        value = self.value(node.operand)
        if isinstance(node.op, ast.Not):
            return self.inverted(value)
        if isinstance(node.op, ast.Invert):
            return ~value if literal(value) else self.binary("^", value, True if value.kind == TRUTH else -1)
        return value if isinstance(node.op, ast.UAdd) else self.negated(value)

    def of_BinOp(self, node: ast.BinOp) -> Value:
        """An operation on two values."""
        return self.binary(SIGNS[type(node.op)], self.value(node.left), self.value(node.right))

    def of_Compare(self, node: ast.Compare) -> Value:
        """A chain of comparisons."""
        left, found = self.value(node.left), None
        for sign, right in zip(node.ops, node.comparators, strict=True):
            other = self.value(right)
            one = self.compare(SIGNS[type(sign)], left, other)
            found = one if found is None else self.binary("&", found, one)
            left = other
        return found

    def of_BoolOp(self, node: ast.BoolOp) -> Value:
        """A truth value; what stands behind is looked at only where it decides."""
        ends = isinstance(node.op, ast.Or)
        k, room = next(self.labels), None
        for number, each in enumerate(node.values):
            truth = self.truth(self.value(each))
            if literal(truth):
                if truth == ends:
                    if room is None:
                        return truth
                    self.lines.append(f"store i1 {str(truth).lower()}, ptr {room}")
                    break
                if number == len(node.values) - 1 and room is None:
                    return truth
                continue
            if room is None:
                room = f"%b{k}"
                self.rooms.append(f"{room} = alloca i1")
            self.lines.append(f"store i1 {truth.text}, ptr {room}")
            if number < len(node.values) - 1:
                on, off = (f"done{k}", f"also{k}x{number}") if ends else (f"also{k}x{number}", f"done{k}")
                self.lines.append(f"br i1 {truth.text}, label %{on}, label %{off}")
                self.label(f"also{k}x{number}")
        if room is None:
            return not ends
        self.jump(f"done{k}")
        self.label(f"done{k}")
        return Number(TRUTH, self.put(f"load i1, ptr {room}"))

    def of_IfExp(self, node: ast.IfExp) -> Value:
        """One of two values; the other is not computed."""
        truth = self.truth(self.value(node.test))
        if literal(truth):
            return self.value(node.body if truth else node.orelse)
        k = next(self.labels)
        self.lines.append(f"br i1 {truth.text}, label %then{k}, label %else{k}")
        self.label(f"then{k}")
        yes, ends = self.value(node.body), len(self.lines)
        self.label(f"else{k}")
        no = self.value(node.orelse)
        pairs = list(zip(yes, no, strict=True)) if isinstance(yes, tuple) else [(yes, no)]
        kinds = [self.common(*pair) for pair in pairs]
        rooms = [f"%x{k}x{i}" for i in range(len(pairs))]
        self.rooms += [f"{room} = alloca {TEXTS[kind]}" for room, kind in zip(rooms, kinds, strict=True)]
        self.stored(rooms, kinds, [no for _, no in pairs])
        self.jump(f"on{k}")
        behind, self.lines = self.lines[ends:], self.lines[:ends]
        self.stored(rooms, kinds, [yes for yes, _ in pairs])
        self.lines += [f"br label %on{k}", *behind, f"on{k}:"]
        self.open = True
        found = tuple(
            Number(kind, self.put(f"load {TEXTS[kind]}, ptr {room}")) for room, kind in zip(rooms, kinds, strict=True)
        )
        return found if isinstance(yes, tuple) else found[0]

    def stored(self, rooms: list[str], kinds: list[str], values: list[Value]) -> None:
        """Numbers into their rooms."""
        for room, kind, value in zip(rooms, kinds, values, strict=True):
            self.lines.append(f"store {TEXTS[kind]} {self.numbered(value, kind).text}, ptr {room}")

    def of_Attribute(self, node: ast.Attribute) -> Value:
        """A field of a record, the shape of an array, a constant of NumPy."""
        owner = self.value(node.value)
        if isinstance(owner, Record):
            return self.load(self.place(node))
        if isinstance(owner, Named):
            return owner.values[owner.fields.index(node.attr)]
        if isinstance(owner, Array) and node.attr == "shape":
            return tuple(n if isinstance(n, int) else Number(WHOLE, n) for n in owner.shape)
        if any(owner is module for module in NUMPY) and isinstance(getattr(owner, node.attr, None), float):
            return float(getattr(owner, node.attr))
        raise Untranslatable(f"{ast.unparse(node)}")

    def of_Subscript(self, node: ast.Subscript) -> Value:
        """An element or a row."""
        owner = self.value(node.value)
        if isinstance(owner, tuple):
            return self.of_tuple(owner, self.value(node.slice))
        return self.load(self.place(node))

    def of_tuple(self, values: tuple[Any, ...], index: Value) -> Value:
        """One of several, by a number that need not be known beforehand."""
        if literal(index):
            return values[int(index)]
        found = values[-1]
        for k in range(len(values) - 2, -1, -1):
            found = self.select(self.compare("==", index, k), values[k], found)
        return found

    def place(self, node: ast.expr) -> Value:
        """Where an element or a field lies: an array of no axes where it is a number."""
        if isinstance(node, ast.Attribute):
            record = self.value(node.value)
            if not isinstance(record, Record) or node.attr not in (record.dtype.fields or {}):
                raise Untranslatable(f"{ast.unparse(node)}")
            assert record.dtype.fields is not None
            kind, offset = record.dtype.fields[node.attr][:2]
            base, shape = kind.subdtype or (kind, ())
            pointer = self.put(f"getelementptr i8, ptr {record.pointer}, i64 {offset}")
            return Array(ELEMENTS[base], pointer, tuple(int(n) for n in shape))
        if not isinstance(node, ast.Subscript):
            raise Untranslatable(f"{ast.unparse(node)}")
        array = self.value(node.value)
        if not isinstance(array, Array):
            raise Untranslatable(f"an element of {ast.unparse(node.value)}")
        index = self.value(node.slice)
        given = index if isinstance(index, tuple) else (index,)
        if len(given) > len(array.shape):
            raise Untranslatable(f"{ast.unparse(node)}: too many indices")
        total: Value = 0
        for k, each in enumerate(given):
            at = self.binary("+", self.length(array, k), each) if literal(each) and each < 0 else each
            total = self.binary("+", self.binary("*", total, self.length(array, k)), at)
        for k in range(len(given), len(array.shape)):
            total = self.binary("*", total, self.length(array, k))
        where = self.numbered(total, WHOLE).text
        pointer = self.put(f"getelementptr {TEXTS[array.element]}, ptr {array.pointer}, i64 {where}")
        return Array(array.element, pointer, array.shape[len(given) :])

    @staticmethod
    def length(array: Array, axis: int) -> Value:
        """The length of an axis."""
        n = array.shape[axis]
        return n if isinstance(n, int) else Number(WHOLE, n)

    def load(self, place: Array) -> Value:
        """The number that lies there; an array stays one."""
        if place.shape:
            return place
        return Number(place.element, self.put(f"load {TEXTS[place.element]}, ptr {place.pointer}"))

    def store(self, place: Array, value: Value) -> None:
        """Write a number there."""
        if place.shape:
            raise Untranslatable("a whole array at once")
        number = self.numbered(value, place.element)
        self.lines.append(f"store {TEXTS[place.element]} {number.text}, ptr {place.pointer}")

    def of_Call(self, node: ast.Call) -> Value:
        """A call of a plain function, of Python's own or of NumPy's."""
        if node.keywords:
            raise Untranslatable("an argument by name")
        values = [self.value(each) for each in node.args]
        if isinstance(node.func, ast.Attribute):
            owner = self.value(node.func.value)
            if not any(owner is module for module in NUMPY):
                raise Untranslatable(f"{ast.unparse(node.func)}")
            return self.numpy(node.func.attr, values)
        name = node.func.id if isinstance(node.func, ast.Name) else ""
        if name in self.unit.trees:
            return self.call(name, values)
        found: Any = self.unit.names.get(name)
        if isinstance(found, OfAnotherText):
            return self.call_elsewhere(found, [self.numbers(each) for each in values])
        if hasattr(found, "write"):
            return found.write(self.unit, self, values)
        if name in BUILT_IN:
            return BUILT_IN[name](self, values)
        raise Untranslatable(f"the function {ast.unparse(node.func)}")

    def call(self, name: str, values: list[Value]) -> Value:
        """A call of another plain function."""
        given = [self.numbers(each) for each in values]
        kinds = tuple(kind_of(each) for each in given)
        return self.call_made(*self.unit.function(name, kinds), kinds, given)

    def call_elsewhere(self, found: OfAnotherText, given: list[Value]) -> Value:
        """A call of a function of another text."""
        kinds = tuple(kind_of(each) for each in given)
        symbol = self.unit.symbol(found, kinds)
        types = ", ".join(text for kind in kinds for text in registers(kind))
        self.needed.add(f'declare {result(found.kind)} @"{symbol}"({types})')
        return self.call_made(symbol, found.kind, kinds, given)

    def call_made(self, made: str, returned: Any, kinds: tuple[Any, ...], given: list[Value]) -> Value:
        """A call of the function of that name in LLVM's text."""
        types = [text for kind in kinds for text in registers(kind)]
        texts = [text for each in given for text in handed(each)]
        arguments = ", ".join(f"{kind} {text}" for kind, text in zip(types, texts, strict=True))
        if returned is None:
            self.lines.append(f'call void @"{made}"({arguments})')
            return None
        found = self.put(f'call {result(returned)} @"{made}"({arguments})')
        if isinstance(returned, str):
            return Number(returned, found)
        whole = result(returned)
        return tuple(Number(kind, self.put(f"extractvalue {whole} {found}, {k}")) for k, kind in enumerate(returned[1]))

    def numbers(self, value: Value) -> Value:
        """Literals as numbers, also inside tuples."""
        if literal(value):
            return self.numbered(value)
        return tuple(self.numbers(each) for each in value) if isinstance(value, tuple) else value


BUILT_IN: dict[str, Callable[[Expressions, list[Value]], Value]] = {
    "abs": lambda f, given: f.size(*given),
    "min": lambda f, given: f.lesser("<", *given),
    "max": lambda f, given: f.lesser(">", *given),
    "float": lambda f, given: float(given[0]) if literal(given[0]) else f.numbered(given[0], FLOAT),
    "int": lambda f, given: int(given[0]) if literal(given[0]) else f.numbered(given[0], WHOLE),
    "bool": lambda f, given: f.truth(given[0]),
    "len": lambda f, given: len(given[0]) if isinstance(given[0], tuple) else f.length(given[0], 0),
}


def result(kind: Any) -> str:
    """LLVM's type of what is returned."""
    if kind is None:
        return "void"
    if isinstance(kind, str):
        return TEXTS[kind]
    return "{" + ", ".join(TEXTS[each] for each in kind[1]) + "}"

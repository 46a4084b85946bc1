"""Plain functions as LLVM's text: one pass over the syntax tree, for the kinds of arguments a caller hands over.

Known are numbers, truth values, arrays and records, tuples of them, `if`, `for` over a range, `while`, calls of other
plain functions, of the Python functions abs, min, max, int, float, bool, len, and of NumPy's for single numbers. A
choice by what is known beforehand leaves only its branch. Everything else raises `Untranslatable` with its line.
"""

import ast
import itertools
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from squealbox.compiled.arithmetic import HELPERS, Arithmetic, literal
from squealbox.compiled.kinds import (
    FLOAT,
    TEXTS,
    TRUTH,
    WHOLE,
    Array,
    Named,
    Number,
    Record,
    Untranslatable,
    Value,
    handed,
    kind_of,
    registers,
    taken,
    wider,
)

SIGNS: dict[type[ast.AST], str] = {
    ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/", ast.FloorDiv: "//", ast.Mod: "%", ast.Pow: "**",
    ast.BitAnd: "&", ast.BitOr: "|", ast.BitXor: "^", ast.LShift: "<<", ast.RShift: ">>", ast.Lt: "<", ast.LtE: "<=",
    ast.Gt: ">", ast.GtE: ">=", ast.Eq: "==", ast.NotEq: "!=", ast.Is: "==", ast.IsNot: "!=",
}  # fmt: skip
ELEMENTS = {np.dtype("f8"): FLOAT, np.dtype("i8"): WHOLE}
NUMPY = (np, math)
SMALL = 60  # lines of a function that becomes part of its callers


@dataclass(frozen=True, slots=True)
class Room:
    """A variable that holds a number of a kind."""

    kind: str


@dataclass(frozen=True, slots=True)
class Several:
    """A variable that holds a tuple, each part under a name of its own."""

    count: int


class Wider(Exception):
    """A variable, or what is returned, turned out to be of a wider kind: write the function anew."""


class Unit:
    """The functions of one text, each written once for each combination of kinds of its arguments.

    `trees` holds the plain functions by name, `names` what else they may name: numbers, modules, and objects with a
    method ``write(unit, function, values)`` that write their own instructions.
    """

    def __init__(self, trees: Mapping[str, ast.FunctionDef], names: Mapping[str, Any], inline: bool = False) -> None:
        self.trees, self.names, self.inline = trees, names, inline
        self.made: dict[Any, tuple[str, Any]] = {}
        self.texts: list[str] = []
        self.needed: set[str] = set()
        self.modules: dict[str, Any] = {}  # of functions written with llvmlite, by name

    def function(self, name: str, kinds: tuple[Any, ...]) -> tuple[str, Any]:
        """(its name in LLVM's text, the kind it returns)."""
        key = name, kinds
        if key not in self.made:
            wanted = f"{name}.{len(self.made)}"
            function = Function(self, self.trees[name], kinds)
            returned = function.translated()
            self.made[key] = wanted, returned
            self.texts.append(function.text(wanted, returned, "internal", self.inline))
            self.needed |= function.needed
        return self.made[key]

    def text(self) -> str:
        """The whole module."""
        return "\n".join([*sorted(self.needed), HELPERS, *self.texts])


class Function(Arithmetic):
    """Writes one function."""

    def __init__(self, unit: Unit, tree: ast.FunctionDef, kinds: tuple[Any, ...]) -> None:
        super().__init__()
        self.unit, self.tree, self.kinds = unit, tree, kinds
        self.wide: dict[str, Any] = {}  # kinds of variables, as wide as was needed so far
        self.returned: Any = None
        self.returns = False

    def translated(self) -> Any:
        """Write the body; returns the kind of what is returned."""
        while True:
            self.lines, self.rooms, self.count = [], [], 0
            self.local: dict[str, Value] = {}
            self.open, self.loops, self.labels, self.depth = True, [], itertools.count(), 0
            try:
                self.arguments()
                self.body(self.tree.body)
                if self.open:
                    if self.returns and self.returned is not None:
                        self.lines.append("unreachable")
                    else:
                        self.lines.append("ret void")
                return self.returned
            except Wider:
                continue

    def text(self, name: str, returned: Any, linkage: str, inline: bool) -> str:
        """As LLVM's text."""
        types = [each for kind in self.kinds for each in registers(kind)]
        given = ", ".join(f"{each} %a{k}" for k, each in enumerate(types))
        attributes = "alwaysinline nounwind" if inline or len(self.lines) < SMALL else "nounwind"
        lines = "\n  ".join([*self.rooms, *self.lines])
        return f'define {linkage} {result(returned)} @"{name}"({given}) {attributes} {{\nentry:\n  {lines}\n}}\n'

    def arguments(self) -> None:
        """Arguments under their names; numbers as variables, for they may be assigned."""
        names = (f"%a{k}" for k in itertools.count())
        wanted = self.tree.args.args
        if len(wanted) != len(self.kinds) or self.tree.args.defaults or self.tree.args.kwonlyargs:
            raise Untranslatable(f"{self.tree.name} takes {len(wanted)} arguments, of {len(self.kinds)} given")
        for argument, kind in zip(wanted, self.kinds, strict=True):
            self.assign(argument.arg, taken(kind, names))

    # statements

    def inside(self, statements: list[ast.stmt]) -> None:
        """The body of a branch or a loop."""
        self.depth += 1
        self.body(statements)
        self.depth -= 1

    def body(self, statements: list[ast.stmt]) -> None:
        """Statements up to the first that leaves."""
        for statement in statements:
            if not self.open:
                return
            try:
                getattr(self, f"do_{type(statement).__name__}", self.unknown)(statement)
            except Untranslatable as error:
                if error.args[0].startswith("in "):
                    raise
                raise Untranslatable(
                    f"in {self.tree.name}, `{ast.unparse(statement).splitlines()[0]}`: {error}"
                ) from error

    def unknown(self, node: ast.AST) -> Any:
        """What the plain subset does not have."""
        raise Untranslatable(f"{type(node).__name__} is not known")

    def do_Pass(self, node: ast.Pass) -> None:
        pass

    def do_Expr(self, node: ast.Expr) -> None:
        if not isinstance(node.value, ast.Constant):
            self.value(node.value)

    def do_Return(self, node: ast.Return) -> None:
        value = None if node.value is None else self.value(node.value)
        kind = None if value is None else self.plain(kind_of(value))
        if not self.returns:
            self.returns, self.returned = True, kind
        elif kind != self.returned:
            found = wider(self.returned, kind)
            if found != self.returned:
                self.returned = found
                raise Wider
        self.lines.append("ret void" if value is None else f"ret {self.packed(value, self.returned)}")
        self.open = False

    @staticmethod
    def plain(kind: Any) -> Any:
        """The kind, if it may be returned."""
        if isinstance(kind, str) or (kind[0] == "tuple" and all(isinstance(each, str) for each in kind[1])):
            return kind
        raise Untranslatable("a function that returns an array or a record")

    def packed(self, value: Value, kind: Any) -> str:
        """Type and register of what is returned."""
        if isinstance(kind, str):
            number = self.numbered(value, kind)
            return f"{TEXTS[kind]} {number.text}"
        whole, text = result(kind), "undef"
        for k, (each, wanted) in enumerate(zip(value, kind[1], strict=True)):
            text = self.put(f"insertvalue {whole} {text}, {TEXTS[wanted]} {self.numbered(each, wanted).text}, {k}")
        return f"{whole} {text}"

    def do_Assign(self, node: ast.Assign) -> None:
        value = self.value(node.value)
        for target in node.targets:
            self.put_into(target, value)

    def do_AnnAssign(self, node: ast.AnnAssign) -> None:
        if node.value is not None:
            self.put_into(node.target, self.value(node.value))

    def do_AugAssign(self, node: ast.AugAssign) -> None:
        if isinstance(node.target, ast.Name):
            old = self.value(ast.Name(node.target.id, ast.Load()))
            self.assign(node.target.id, self.binary(SIGNS[type(node.op)], old, self.value(node.value)))
            return
        place = self.place(node.target)
        self.store(place, self.binary(SIGNS[type(node.op)], self.load(place), self.value(node.value)))

    def put_into(self, target: ast.expr, value: Value) -> None:
        """Assign to a name, an element, a field or a tuple of such."""
        if isinstance(target, ast.Name):
            self.assign(target.id, value)
        elif isinstance(target, ast.Tuple | ast.List):
            parts = value.values if isinstance(value, Named) else value
            if not isinstance(parts, tuple) or len(parts) != len(target.elts):
                raise Untranslatable("a tuple of another length")
            for each, part in zip(target.elts, parts, strict=True):
                self.put_into(each, part)
        else:
            self.store(self.place(target), value)

    def assign(self, name: str, value: Value) -> None:
        """A number goes into the variable's room, a tuple into several; an array or a record has one name for good."""
        if isinstance(value, tuple):
            for k, each in enumerate(value):
                self.assign(f"{name}.{k}", each)
            value = Several(len(value))
        if not isinstance(value, Number) and not literal(value):
            if name in self.local and self.local[name] != value and (self.depth or isinstance(self.local[name], Room)):
                raise Untranslatable(f"{name} is one thing here and another there")
            self.local[name] = value
            return
        kind = kind_of(value)
        held = self.wide.get(name)
        if held is None:
            held = self.wide[name] = kind
        elif wider(held, kind) != held:
            self.wide[name] = wider(held, kind)
            raise Wider
        if name not in self.local:
            self.rooms.append(f"%v.{name} = alloca {TEXTS[held]}")
            self.local[name] = Room(held)
        self.lines.append(f"store {TEXTS[held]} {self.numbered(value, held).text}, ptr %v.{name}")

    def do_If(self, node: ast.If) -> None:
        truth = self.truth(self.value(node.test))
        if literal(truth):
            self.body(node.body if truth else node.orelse)
            return
        k = next(self.labels)
        self.lines.append(f"br i1 {truth.text}, label %then{k}, label %else{k}")
        leaves = []
        for name, statements in ((f"then{k}", node.body), (f"else{k}", node.orelse)):
            self.label(name)
            self.inside(statements)
            leaves.append(not self.open)
            self.jump(f"on{k}")
        if all(leaves):
            self.open = False
        else:
            self.label(f"on{k}")

    def label(self, name: str) -> None:
        """A block begins."""
        self.lines.append(f"{name}:")
        self.open = True

    def jump(self, name: str) -> None:
        """The end of a block that has not been left."""
        if self.open:
            self.lines.append(f"br label %{name}")
        self.open = False

    def do_While(self, node: ast.While) -> None:
        k = next(self.labels)
        self.jump(f"test{k}")
        self.label(f"test{k}")
        truth = self.truth(self.value(node.test))
        if literal(truth):
            self.jump(f"loop{k}" if truth else f"on{k}")
        else:
            self.lines.append(f"br i1 {truth.text}, label %loop{k}, label %on{k}")
        self.label(f"loop{k}")
        self.loops.append((f"test{k}", f"on{k}"))
        self.inside(node.body)
        self.loops.pop()
        self.jump(f"test{k}")
        self.label(f"on{k}")

    def do_For(self, node: ast.For) -> None:
        if node.orelse or not isinstance(node.target, ast.Name):
            raise Untranslatable("a loop with else, or over tuples")
        if not (
            isinstance(node.iter, ast.Call) and isinstance(node.iter.func, ast.Name) and node.iter.func.id == "range"
        ):
            raise Untranslatable("a loop that is not over a range")
        given = [self.value(each) for each in node.iter.args]
        first, last, step = (0, given[0], 1) if len(given) == 1 else (*given, 1)[:3]
        if not isinstance(step, int):
            raise Untranslatable("a range whose step is not a plain number")
        k, name = next(self.labels), f"%c{next(self.labels)}"
        self.rooms.append(f"{name} = alloca i64")
        self.lines.append(f"store i64 {self.numbered(first, WHOLE).text}, ptr {name}")
        last = self.numbered(last, WHOLE)
        self.jump(f"test{k}")
        self.label(f"test{k}")
        at = Number(WHOLE, self.put(f"load i64, ptr {name}"))
        more = self.compare("<" if step > 0 else ">", at, last)
        self.lines.append(f"br i1 {more.text}, label %loop{k}, label %on{k}")
        self.label(f"loop{k}")
        self.assign(node.target.id, at)
        self.loops.append((f"more{k}", f"on{k}"))
        self.inside(node.body)
        self.loops.pop()
        self.jump(f"more{k}")
        self.label(f"more{k}")
        at = Number(WHOLE, self.put(f"load i64, ptr {name}"))
        self.lines.append(f"store i64 {self.binary('+', at, step).text}, ptr {name}")
        self.jump(f"test{k}")
        self.label(f"on{k}")

    def do_Break(self, node: ast.Break) -> None:
        self.jump(self.loops[-1][1])

    def do_Continue(self, node: ast.Continue) -> None:
        self.jump(self.loops[-1][0])

    # expressions

    def value(self, node: ast.expr) -> Value:
        """What an expression is."""
        return getattr(self, f"of_{type(node).__name__}", self.unknown)(node)

    def of_Constant(self, node: ast.Constant) -> Value:
        if not isinstance(node.value, int | float):
            raise Untranslatable(f"{node.value!r}")
        return node.value

    def of_Name(self, node: ast.Name) -> Value:
        if node.id in self.local:
            return self.named(node.id)
        if node.id in self.unit.names:
            return self.unit.names[node.id]
        raise Untranslatable(f"the name {node.id}")

    def named(self, name: str) -> Value:
        """What a variable holds."""
        found = self.local[name]
        if isinstance(found, Room):
            return Number(found.kind, self.put(f"load {TEXTS[found.kind]}, ptr %v.{name}"))
        return tuple(self.named(f"{name}.{k}") for k in range(found.count)) if isinstance(found, Several) else found

    def of_Tuple(self, node: ast.Tuple) -> Value:
        return tuple(self.value(each) for each in node.elts)

    def of_UnaryOp(self, node: ast.UnaryOp) -> Value:
        value = self.value(node.operand)
        if isinstance(node.op, ast.Not):
            return self.inverted(value)
        if isinstance(node.op, ast.Invert):
            return ~value if literal(value) else self.binary("^", value, True if value.kind == TRUTH else -1)
        return value if isinstance(node.op, ast.UAdd) else self.negated(value)

    def of_BinOp(self, node: ast.BinOp) -> Value:
        return self.binary(SIGNS[type(node.op)], self.value(node.left), self.value(node.right))

    def of_Compare(self, node: ast.Compare) -> Value:
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
        if hasattr(self.unit.names.get(name), "write"):
            return self.unit.names[name].write(self.unit, self, values)
        if name in BUILT_IN:
            return BUILT_IN[name](self, values)
        raise Untranslatable(f"the function {ast.unparse(node.func)}")

    def call(self, name: str, values: list[Value]) -> Value:
        """A call of another plain function."""
        given = [self.numbers(each) for each in values]
        kinds = tuple(kind_of(each) for each in given)
        made, returned = self.unit.function(name, kinds)
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


BUILT_IN: dict[str, Callable[[Function, list[Value]], Value]] = {
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

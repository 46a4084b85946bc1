"""Plain functions as LLVM's text: one pass over the syntax tree, for the kinds of arguments a caller hands over.

Known are numbers, truth values, arrays and records, tuples of them, `if`, `for` over a range, `while`, calls of other
plain functions, of the Python functions abs, min, max, int, float, bool, len, and of NumPy's for single numbers. A
choice by what is known beforehand leaves only its branch. Everything else raises `Untranslatable` with its line.
"""

import ast
import itertools
from collections.abc import Mapping
from typing import Any

from squealbox.compiled.arithmetic import HELPERS, literal
from squealbox.compiled.expressions import SIGNS, Expressions, Room, Several, result
from squealbox.compiled.kinds import (
    TEXTS,
    WHOLE,
    Named,
    Number,
    OfAnotherText,
    Untranslatable,
    Value,
    kind_of,
    registers,
    said,
    taken,
    wider,
)

SMALL = 60  # lines of a function that becomes part of its callers


class WiderKind(Exception):
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
        self.modules: dict[str, str] = {}  # of functions written in lanes, by name
        self.asked: dict[tuple[str, Any, Any], str] = {}  # of another text: symbols, by name, kind and arguments' kinds

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

    def symbol(self, found: OfAnotherText, kinds: tuple[Any, ...] | None) -> str:
        """The name, in LLVM's text, of what another text has."""
        return self.asked.setdefault((found.name, found.kind, kinds), f"{found.name}.elsewhere.{len(self.asked)}")

    def give(self, symbol: str, name: str, kind: str | None, kinds: tuple[Any, ...] | None) -> None:
        """Write what another text asks for, under the name it has there: a function of that kind, or a number."""
        if kinds is None and isinstance(self.names.get(name), int):
            self.texts.append(f'@"{symbol}" = constant i64 {self.names[name]}')
            return
        if kinds is None or name not in self.trees:
            raise Untranslatable(f"{name} is asked for by another text, and not here")
        function = Function(self, self.trees[name], kinds)
        returned = function.translated()
        if returned != kind:
            raise Untranslatable(f"{name} returns {said(returned)}, and {said(kind)} is asked for")
        self.texts.append(function.text(symbol, returned, "", False))
        self.needed |= function.needed

    def text(self) -> str:
        """The whole module."""
        return "\n".join([*sorted(self.needed), HELPERS, *self.texts])


class Function(Expressions):
    """Writes one function."""

    def __init__(self, unit: Unit, tree: ast.FunctionDef, kinds: tuple[Any, ...]) -> None:
        super().__init__(unit)
        self.tree, self.kinds = tree, kinds
        self.wide: dict[str, Any] = {}  # kinds of variables, as wide as was needed so far
        self.returned: Any = None
        self.returns = False

    def translated(self) -> Any:
        """Write the body; returns the kind of what is returned."""
        while True:
            self.lines, self.rooms, self.count = [], [], 0
            self.local: dict[str, Value] = {}
            self.open, self.labels, self.depth = True, itertools.count(), 0
            self.loops: list[tuple[str, str]] = []
            try:
                self.arguments()
                self.body(self.tree.body)
                if self.open:
                    if self.returns and self.returned is not None:
                        self.lines.append("unreachable")
                    else:
                        self.lines.append("ret void")
                return self.returned
            except WiderKind:
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

    def do_Pass(self, node: ast.Pass) -> None:
        """Nothing."""

    def do_Expr(self, node: ast.Expr) -> None:
        """A call for what it does; a docstring."""
        if not isinstance(node.value, ast.Constant):
            self.value(node.value)

    def do_Return(self, node: ast.Return) -> None:
        """The end of the function."""
        value = None if node.value is None else self.value(node.value)
        kind = None if value is None else self.plain(kind_of(value))
        if not self.returns:
            self.returns, self.returned = True, kind
        elif kind != self.returned:
            found = wider(self.returned, kind)
            if found != self.returned:
                self.returned = found
                raise WiderKind
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
        """An assignment."""
        value = self.value(node.value)
        for target in node.targets:
            self.put_into(target, value)

    def do_AnnAssign(self, node: ast.AnnAssign) -> None:
        """An assignment with an annotation, which says nothing here."""
        if node.value is not None:
            self.put_into(node.target, self.value(node.value))

    def do_AugAssign(self, node: ast.AugAssign) -> None:
        """An assignment such as +=."""
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
            raise WiderKind
        if name not in self.local:
            self.rooms.append(f"%v.{name} = alloca {TEXTS[held]}")
            self.local[name] = Room(held)
        self.lines.append(f"store {TEXTS[held]} {self.numbered(value, held).text}, ptr %v.{name}")

    def do_If(self, node: ast.If) -> None:
        """A choice; by what is known beforehand only its branch is written."""
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

    def do_While(self, node: ast.While) -> None:
        """A loop."""
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
        """A loop over a range."""
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
        """On behind the loop."""
        self.jump(self.loops[-1][1])

    def do_Continue(self, node: ast.Continue) -> None:
        """On with the next turn."""
        self.jump(self.loops[-1][0])

"""Plain Python functions on `Lanes` as compiled ones, which generated files call with an array and an offset."""

from collections.abc import Callable
from functools import wraps
from typing import Any

from llvmlite import ir

from squealbox.compiled.kinds import WHOLE, Array, Number
from squealbox.compiled.translation import Function, Unit
from squealbox.transient.lanes.vectors import (
    ALIGNED,
    ALLOWED,
    BUILDER,
    DOUBLE,
    INTEGER,
    Given,
    Group,
    Lanes,
    declared,
    packed,
    packed_type,
    writing,
)


def on_lines(function: Any) -> None:
    """Let the stack of a function begin with a line of the cache: a register put by across two lines costs twice."""
    function.attributes.add("nounwind")  # llvmlite writes alignstack only beside another attribute
    function.attributes.alignstack = ALIGNED


def apart(function: Callable[..., Any]) -> Callable[..., Any]:
    """A formula of one `Lanes` and many coefficients as a function of its own, called: for long tables."""

    def call(x: Lanes, given: Given) -> Lanes:
        builder = BUILDER.get()
        data = builder.gep(given.group.data, [INTEGER(given.place)])
        kind = ir.FunctionType(packed_type(), [packed_type(), data.type])
        made = declared(builder.module, kind, f"{function.__name__}_{given.count}")
        if made.is_declaration:
            made.linkage = "internal"
            on_lines(made)
            inside = ir.IRBuilder(made.append_basic_block())
            with writing(inside):
                value = function(Lanes(made.args[0]), Given(Group(made.args[1]), 0, given.count, given.whole))
                inside.ret(packed(value))
        return Lanes(builder.call(made, [x.vector, data]))

    return call


def traced_as_written(function: Callable[..., Any]) -> Any:
    """As `traced`, with every operation rounded as it stands: two such functions agree to the last bit."""

    @wraps(function)
    def strictly(*given: Any) -> Any:
        token = ALLOWED.set(())
        try:
            return function(*given)
        finally:
            ALLOWED.reset(token)

    return traced(strictly)


def traced(function: Callable[..., Any]) -> "Traced":
    """The plain function f(group, 0) -> integer for compiled callers, who give it an array and an offset."""
    return Traced(function)


def wide(lanes: int) -> Callable[[Callable[..., Any]], "Traced"]:
    """As `traced_as_written`, on so many lanes whatever the kernel has."""
    return lambda function: Traced(function, lanes)


class Traced:
    """A function of rows in memory that writes itself, once, when compiled code first calls it."""

    def __init__(self, function: Callable[..., Any], lanes: int | None = None) -> None:
        self.function, self.lanes = function, lanes

    def write(self, unit: Unit, caller: Function, values: list[Any]) -> Number:
        """Its call there."""
        rows, offset = values
        name = f"traced_{self.function.__name__}"
        if name not in unit.modules:
            unit.modules[name] = self.module(name, self.lanes or unit.names["LANES"])
        caller.needed.add(f"declare i64 @{name}(ptr)")
        place = caller.put(f"getelementptr double, ptr {rows.pointer}, i64 {caller.numbered(offset, WHOLE).text}")
        return Number(WHOLE, caller.put(f"call i64 @{name}(ptr {place})"))

    def module(self, name: str, lanes: int) -> ir.Module:
        """The function alone in LLVM's module, for so many lanes."""
        module = ir.Module(name)
        made = ir.Function(module, ir.FunctionType(INTEGER, [DOUBLE.as_pointer()]), name)
        on_lines(made)
        builder = ir.IRBuilder(made.append_basic_block())
        with writing(builder, lanes):
            builder.ret(self.function(Group(made.args[0]), 0))
        return module


class Take:
    """`take(counter)`: the counter's value, which is raised by one at once, whatever other threads do."""

    def write(self, unit: Unit, caller: Function, values: list[Any]) -> Number:
        """Its call there."""
        (counter,) = values
        assert isinstance(counter, Array)
        return Number(WHOLE, caller.put(f"atomicrmw add ptr {counter.pointer}, i64 1 monotonic"))


take = Take()

"""Plain Python functions on `Lanes` as compiled ones, which generated files call with an array and an offset."""

from collections.abc import Callable
from functools import wraps
from typing import Any

from squealbox.compiled import (
    PART,
    WHOLE,
    WRITER,
    Array,
    Function,
    Given,
    Group,
    Lanes,
    Number,
    Unit,
    Untranslatable,
    Writer,
    packed,
    put,
    reals,
    writing,
)
from squealbox.system import InvalidSystem


def apart(function: Callable[..., Any]) -> Callable[..., Any]:
    """A formula of one `Lanes` and many coefficients as a function of its own, called: for long tables."""

    def call(x: Lanes, given: Given) -> Lanes:
        writer, kind, name = WRITER.get(), reals(), f"{function.__name__}_{given.count}"
        data = given.group.at(given.place)
        if name not in writer.functions:
            with writing(Writer(writer.functions)) as inside:
                value = function(Lanes("%x"), Given(Group("%rows"), 0, given.count, given.whole))
                inside.define(name, f"{kind} %x, ptr %rows", kind, packed(value), "internal")
            writer.needed |= inside.needed
        return Lanes(put(f"call {kind} @{name}({kind} {x.vector}, ptr {data})"))

    return call


def traced_as_written(function: Callable[..., Any]) -> Any:
    """As `traced`, with every operation rounded as it stands: two such functions agree to the last bit."""

    @wraps(function)
    def strictly(*given: Any) -> Any:
        with writing(WRITER.get(), allowed="") as writer:
            writer.room = PART
            return function(*given)

    return traced(strictly)


def traced(function: Callable[..., Any]) -> "Traced":
    """The plain function f(group, 0) -> integer for compiled callers, who give it an array and an offset."""
    return Traced(function)


def wide(lanes: int) -> Callable[[Callable[..., Any]], "Traced"]:
    """As `traced`, on so many lanes whatever the kernel has."""
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

    def module(self, name: str, lanes: int) -> str:
        """The function alone as LLVM's module, for so many lanes."""
        with writing(Writer(), lanes) as writer:
            try:
                value = self.function(Group("%rows"), 0)
            except Untranslatable as error:
                raise InvalidSystem(str(error)) from error
            writer.define(name, "ptr %rows", "i64", value)
        return "\n".join([*sorted(writer.needed), *writer.functions.values()])


class Take:
    """`take(counter)`: the counter's value, which is raised by one at once, whatever other threads do."""

    def __call__(self, *_: Any) -> Any:
        raise TypeError("a function of compiled code alone")

    def write(self, unit: Unit, caller: Function, values: list[Any]) -> Number:
        """Its call there."""
        (counter,) = values
        assert isinstance(counter, Array)
        return Number(WHOLE, caller.put(f"atomicrmw add ptr {counter.pointer}, i64 1 monotonic"))


take = Take()

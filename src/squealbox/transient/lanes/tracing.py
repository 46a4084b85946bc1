"""Plain Python functions on `Lanes` as compiled ones, which generated files call with an array and an offset."""

from collections.abc import Callable
from functools import wraps
from typing import Any

from llvmlite import ir
from numba import extending, types
from numba.core import cgutils

from squealbox.transient.lanes.vectors import (
    ALIGNED,
    ALLOWED,
    BUILDER,
    INTEGER,
    PACKED,
    Given,
    Group,
    Lanes,
    packed,
    writing,
)

intrinsic: Any = extending.intrinsic  # untyped, and its calls leave out the typing context


def on_lines(function: Any) -> None:
    """Let the stack of a function begin with a line of the cache: a register put by across two lines costs twice."""
    function.attributes.add("nounwind")  # llvmlite writes alignstack only beside another attribute
    function.attributes.alignstack = ALIGNED


def apart(function: Callable[..., Any]) -> Callable[..., Any]:
    """A formula of one `Lanes` and many coefficients as a function of its own, called: for long tables."""

    def call(x: Lanes, given: Given) -> Lanes:
        builder = BUILDER.get()
        data = builder.gep(given.group.data, [INTEGER(given.place)])
        kind = ir.FunctionType(PACKED, [PACKED, data.type])
        made = cgutils.get_or_insert_function(builder.module, kind, f"{function.__name__}_{given.count}")
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


def traced(function: Callable[..., Any]) -> Any:
    """The plain function f(group, 0) -> integer for compiled callers, who give it an array and an offset."""

    @intrinsic
    def compiled(typing: Any, array: Any, offset: Any) -> Any:
        def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
            data = context.make_array(sig.args[0])(context, builder, args[0]).data
            on_lines(builder.function)
            with writing(builder):
                return function(Group(builder.gep(data, [args[1]])), 0)

        return types.int64(array, offset), generate

    return compiled


@intrinsic
def take(typing: Any, counter: Any) -> Any:
    """The counter's value, which is raised by one at once, whatever other threads do."""

    def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        data = context.make_array(sig.args[0])(context, builder, args[0]).data
        return builder.atomic_rmw("add", data, ir.Constant(INTEGER, 1), "monotonic")

    return types.int64(counter), generate

"""Compilation of a generated file as one whole: its functions are typed one by one, but optimised and assembled once.

numba optimises and assembles every function by itself and again inside each of its callers, and asks all templates of
an operator at each of its uses. A generated file has some seventy functions of which one is called from Python, so most
of that work is thrown away. Here a function marked
`inner` only contributes its LLVM module; the function marked `entry` links all of them and is optimised and assembled
with them, and kept on disk by numba's own cache.

Importing this module loads numba; only generated files do.
"""

import operator
from typing import Any, ClassVar

import numba
from numba import _dynfunc  # type: ignore[attr-defined]
from numba.core import funcdesc, lowering, typed_passes, types
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import CompilerBase, _LowerResult
from numba.core.compiler_machinery import PassManager, register_pass
from numba.core.typed_passes import (
    AnnotateTypes,
    IRLegalization,
    NativeLowering,
    NopythonTypeInference,
    PreLowerStripPhis,
)
from numba.core.untyped_passes import FixupArgs, IRProcessing, ReconstructSSA, TranslateByteCode

OPTIONS: dict[str, Any] = {"error_model": "numpy", "fastmath": {"contract", "nsz"}, "nogil": True}
njit: Any = numba.njit
NO_CODE = "What compiled callers name; there is no code behind it to be called from Python."


class Part(JITCodeLibrary):
    """The module of one function, neither optimised nor assembled: raw material of a `Whole`."""

    def __init__(self, codegen: Any, name: str) -> None:
        super().__init__(codegen, name)
        self.needs: dict[Any, None] = {}

    def add_linking_library(self, library: Any) -> None:
        """A called function: kept by reference, linked by the whole."""
        self.needs[library] = None

    def add_llvm_module(self, ll_module: Any) -> None:
        """No passes over one function: the whole runs them all."""
        self._final_module.link_in(ll_module)

    def finalize(self) -> None:
        """Nothing may be added any more."""
        self._finalized = True


class Whole(JITCodeLibrary):
    """The module of an entry with all that it calls."""

    def add_linking_library(self, library: Any) -> None:
        """Also what a part needs in turn."""
        if library in self._linking_libraries:
            return
        super().add_linking_library(library)
        for other in getattr(library, "needs", ()):
            self.add_linking_library(other)


class Remembering:
    """A typing context that keeps what an operation on numbers and arrays comes to.

    numba asks all templates of an operator anew at each of its uses, half a millisecond each; the answer depends on the
    types alone, and a literal number is a number here.
    """

    known: ClassVar[dict[Any, Any]] = {}
    KINDS = (types.Number, types.Boolean, types.Array)

    def __init__(self, context: Any) -> None:
        self._context = context

    def __getattr__(self, name: str) -> Any:
        return getattr(self._context, name)

    def resolve_function_type(self, function: Any, args: Any, keywords: Any) -> Any:
        """As numba's, once for each combination of types."""
        plain = tuple(types.unliteral(each) for each in args)
        if keywords or isinstance(function, types.Dispatcher) or not all(isinstance(x, self.KINDS) for x in plain):
            return self._context.resolve_function_type(function, args, keywords)
        key = function, plain
        if key not in self.known:
            self.known[key] = self._context.resolve_function_type(function, plain, keywords)
        return self.known[key]


@register_pass(mutates_CFG=True, analysis_only=False)
class QuickTyping(NopythonTypeInference):
    """Type inference with a memory."""

    _name = "quick_typing"

    def run_pass(self, state: Any) -> bool:
        """As numba's."""
        context = state.typingctx
        state.typingctx = Remembering(context)
        try:
            done: bool = super().run_pass(state)
        finally:
            state.typingctx = context
        return done


class QuickLower(lowering.Lower):
    """Lowering that takes the signature of an operation from type inference, not up to four times anew."""

    def lower_binop(self, resty: Any, expr: Any, op: Any) -> Any:
        """As numba's, without looking for a variant for a literal operand: only powers have one."""
        signature = self.fndesc.calltypes[expr]
        if op in (operator.pow, operator.ipow) or not all(isinstance(x, Remembering.KINDS) for x in signature.args):
            return super().lower_binop(resty, expr, op)
        return self._applied(op, (expr.lhs, expr.rhs), signature, resty)

    def lower_getitem(self, resty: Any, expr: Any, value: Any, index: Any, signature: Any) -> Any:
        """As numba's."""
        if not all(isinstance(x, Remembering.KINDS) for x in signature.args):
            return super().lower_getitem(resty, expr, value, index, signature)
        return self._applied(operator.getitem, (value, index), signature, resty)

    def _applied(self, op: Any, operands: tuple[Any, ...], signature: Any, resty: Any) -> Any:
        function = self.context.typing_context.resolve_value_type(op)
        if signature.args not in function._impl_keys:
            signature = function.get_call_type(self.context.typing_context, signature.args, {})
        values = [self._cast_var(x, kind) for x, kind in zip(operands, signature.args, strict=True)]
        found = self.context.get_function(function, signature)(self.builder, values)
        return self.context.cast(self.builder, found, signature.return_type, resty)


@register_pass(mutates_CFG=True, analysis_only=False)
class PartLowering(NativeLowering):
    """Lower a function into a `Part`; it cannot be called from Python."""

    _name = "part_lowering"

    def run_pass(self, state: Any) -> bool:
        """As `NativeLowering.run_pass` without wrappers, optimisation and assembly."""
        target, flags = state.targetctx, state.flags
        library = state.library = Part(target.codegen(), state.func_id.func_qualname)
        description = funcdesc.PythonFunctionDescriptor.from_specialized_function(
            state.func_ir, state.typemap, state.return_type, state.calltypes, mangler=target.mangler,
            inline=flags.forceinline, noalias=flags.noalias, abi_tags=[flags.get_mangle_string()],
        )  # fmt: skip
        with target.push_code_library(library):
            lower = QuickLower(target, library, description, state.func_ir, metadata=state.metadata)
            lower.lower()
        name = description.qualname.split(".")[-1]
        named = _dynfunc.make_function(description.lookup_module(), name, NO_CODE, 0, lower.env, (library,))
        target.insert_user_function(named, description, [library])
        state["cr"] = _LowerResult(description, lower.call_helper, cfunc=named, env=lower.env)
        return True


@register_pass(mutates_CFG=True, analysis_only=False)
class WholeLowering(NativeLowering):
    """Lower a function into a `Whole`."""

    _name = "whole_lowering"

    def run_pass(self, state: Any) -> bool:
        """As `NativeLowering.run_pass`, with another library."""
        state.library = Whole(state.targetctx.codegen(), state.func_id.func_qualname)
        state.library.enable_object_caching()
        done: bool = super().run_pass(state)
        return done


def _compiler(lower: Any) -> type[CompilerBase]:
    """Plain typed functions need few of numba's passes: no rewrites, no closures, no parallel loops."""

    class Pipeline(CompilerBase):
        """The passes in their order."""

        def define_pipelines(self) -> list[Any]:
            """One pipeline, without a second one to fall back to."""
            pm = PassManager("squealbox")
            for step in (
                TranslateByteCode, FixupArgs, IRProcessing, ReconstructSSA, QuickTyping, PreLowerStripPhis,
                IRLegalization, AnnotateTypes, lower, typed_passes.NoPythonBackend,
            ):  # fmt: skip
                pm.add_pass(step, step.__name__)
            pm.finalize()
            return [pm]

    return Pipeline


PARTS, WHOLE = _compiler(PartLowering), _compiler(WholeLowering)


def inner(function: Any) -> Any:
    """A function that only compiled ones call."""
    return njit(pipeline_class=PARTS, **OPTIONS)(function)


def packed(function: Any) -> Any:
    """Such a function that becomes part of the text of its callers."""
    return njit(pipeline_class=PARTS, forceinline=True, **OPTIONS)(function)


def entry(function: Any) -> Any:
    """The function that Python calls."""
    return njit(pipeline_class=WHOLE, cache=True, no_cfunc_wrapper=True, **OPTIONS)(function)

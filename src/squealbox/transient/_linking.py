"""Compilation of a generated file as one whole: its functions are typed one by one, but optimised and assembled once.

numba optimises and assembles every function by itself and again inside each of its callers. A generated file has some
hundred functions of which one is called from Python, so most of that work is thrown away. Here a function marked
`inner` only contributes its LLVM module; the function marked `entry` links all of them and is optimised and assembled
with them, and kept on disk by numba's own cache.

Importing this module loads numba; only generated files do.
"""

from typing import Any

import numba
from numba import _dynfunc  # type: ignore[attr-defined]
from numba.core import funcdesc, lowering, typed_passes
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
            lower = lowering.Lower(target, library, description, state.func_ir, metadata=state.metadata)
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
                TranslateByteCode, FixupArgs, IRProcessing, ReconstructSSA, NopythonTypeInference, PreLowerStripPhis,
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

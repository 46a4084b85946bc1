"""From LLVM's text to machine code on disk, and calls of it.

What is kept is named by the hash of the text, of the kinds of the arguments, of the processor and of the modules that
translate: a change of any makes another file, and several processes may write the same one at once.
"""

import ast
import ctypes
import hashlib
import inspect
import io
import os
import pickle
import tempfile
import threading
import warnings
from collections.abc import Callable
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

from squealbox.compiled.expressions import ELEMENTS, result
from squealbox.compiled.kinds import FLOAT, TEXTS, TRUTH, WHOLE, Array, Record, kind_of, registers
from squealbox.compiled.translation import Unit
from squealbox.waiting import aside

DECORATORS = ("inner", "packed", "entry")  # of plain functions that are translated; packed ones into their callers
LINE = 64  # bytes of the cache's lines, with one of which the stack begins: a register put by across two costs twice
PATIENCE = 0.5  # s of compiling after which people are told
PASSES = (  # those that plain loops gain by; LLVM's own list takes ten times as long for code no quicker
    "sroa", "simplify_cfg", "always_inliner", "instruction_combine", "loop_simplify", "loop_rotate", "new_gvn",
    "instruction_combine", "simplify_cfg", "global_dead_code_eliminate",
)  # fmt: skip
CTYPES = {"ptr": ctypes.c_void_p, "i64": ctypes.c_int64, "double": ctypes.c_double, "i1": ctypes.c_bool}
LOCK = threading.Lock()
KEPT: list[Any] = []  # execution engines, for as long as their code may be called


def cache_folder() -> Path:
    """Where compiled code is kept: $SQUEALBOX_CACHE, else the user's cache folder."""
    chosen = os.environ.get("SQUEALBOX_CACHE")
    if chosen:
        return Path(chosen)
    base = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return Path(base) / "squealbox" / "kernels"


class Compiled:
    """A plain function of a text, compiled at its first call for the kinds of its arguments, then read from disk.

    What the text has as `OfAnotherText` is in the text `elsewhere`, compiled apart: so texts that differ in little
    share the machine code of what they have in common.
    """

    def __init__(self, text: str, name: str, elsewhere: str = "") -> None:
        self.text, self.name, self.elsewhere = text, name, elsewhere
        self.made: dict[Any, Callable[..., Any]] = {}
        self.modules: list[Any] = []

    def __call__(self, *given: Any) -> Any:
        return self.bound(*given)()

    def bound(self, *given: Any) -> Callable[[], Any]:
        """The call with these arguments, to be made several times: what lies in memory is read anew each time."""
        key = tuple(_key(each) for each in given)
        made = self.made.get(key)
        if made is None:
            with LOCK:
                made = self.made[key] = self.made.get(key) or self._compiled(given)
        return made(*given)

    def _compiled(self, given: tuple[Any, ...]) -> Callable[..., Any]:
        kinds = tuple(_kind(each) for each in given)
        self.modules = []
        (returned, asked), code = kept(self._path(kinds), lambda: self._emitted(*built(self.text, self.name, kinds)))
        codes = [code]
        if asked:
            codes.append(
                kept(self._path_elsewhere(asked), lambda: self._emitted((), given_to(self.elsewhere, asked)))[1]
            )
        return _callable(loaded(codes, self.name), kinds, returned)

    def _emitted(self, told: Any, module: Any) -> tuple[Any, bytes]:
        self.modules.append(module)
        return told, processor().emit_object(module)

    def _path(self, kinds: tuple[Any, ...]) -> Path:
        return _path(f"{self.text}\n{self.name} {kinds}")

    def _path_elsewhere(self, asked: Any) -> Path:
        return _path(f"{self.elsewhere}\n{asked}")

    def assembly(self) -> str:
        """The assembler's text of what was compiled last, not of what came from disk."""
        return "\n".join(processor().emit_assembly(each) for each in self.modules)

    def ready(self, *given: Any) -> bool:
        """Whether a call with such arguments finds its machine code, here or on disk."""
        if tuple(_key(each) for each in given) in self.made:
            return True
        found = on_disk(self._path(tuple(_kind(each) for each in given)))
        return found is not None and (not found[0][1] or self._path_elsewhere(found[0][1]).exists())


class Translated:
    """A text whose functions are compiled one by one, each at its first call."""

    def __init__(self, text: str) -> None:
        self.text = text

    def __getattr__(self, name: str) -> Compiled:
        if f"def {name}(" not in self.text:
            raise AttributeError(name)
        made = Compiled(self.text, name)
        setattr(self, name, made)
        return made


@cache
def translated(*modules: ModuleType) -> Translated:
    """The functions of some modules as compiled ones, all parts of their callers."""
    text = []
    for module in modules:
        tree = ast.parse(inspect.getsource(module))
        for node in tree.body:
            if isinstance(node, ast.FunctionDef):
                node.decorator_list = [ast.Name("packed")]
        text.append(ast.unparse(tree))
    return Translated("\n\n".join(text))


def _key(value: Any) -> Any:
    """What tells the kinds of arguments apart, quickly."""
    if isinstance(value, np.ndarray):
        return (value.dtype.char, value.ndim) if value.dtype.names is None else (id(value.dtype), value.dtype)
    if isinstance(value, np.void):
        return id(value.dtype), value.dtype
    return tuple(_key(each) for each in value) if isinstance(value, tuple) else type(value)


def _kind(value: Any) -> Any:
    """The kind of an argument handed over from Python."""
    if isinstance(value, np.ndarray) and value.dtype.names is not None and value.shape == (1,):
        return kind_of(Record(value.dtype, ""))
    if isinstance(value, np.ndarray):
        if value.dtype not in ELEMENTS or not value.flags.c_contiguous:
            raise TypeError(f"an array of {value.dtype}: compiled code takes float64 and int64, row by row")
        return kind_of(Array(ELEMENTS[value.dtype], "", ("",) * value.ndim))
    if isinstance(value, np.void):
        return kind_of(Record(value.dtype, ""))
    if isinstance(value, tuple):
        return "named", getattr(value, "_fields", ()), tuple(_kind(each) for each in value)
    return kind_of(value)


def built(text: str, name: str, kinds: tuple[Any, ...]) -> tuple[Any, Any]:
    """((the kind of what the function returns, what it asks of another text), LLVM's module with it)."""
    unit = _unit(text)
    made, returned = unit.function(name, kinds)
    asked = [(symbol, *each) for each, symbol in unit.asked.items()]
    whole = "\n".join([unit.text(), _door(name, made, kinds, returned)])
    return (returned, asked), optimised(whole, unit.modules)


def given_to(text: str, asked: list[tuple[Any, ...]]) -> Any:
    """LLVM's module with what another text asks of this one."""
    unit = _unit(text)
    for each in asked:
        unit.give(*each)
    return optimised(unit.text(), unit.modules)


def _path(named: str) -> Path:
    digest = hashlib.sha256(named.encode() + _of_this_machine()).hexdigest()
    return cache_folder() / f"{digest[:32]}.code"


def _unit(text: str) -> Unit:
    """The functions to translate, and the rest of the text run as Python for the names they use."""
    tree = ast.parse(text)
    marked = {
        node.name: (node, node.decorator_list[0].id)
        for node in tree.body
        if isinstance(node, ast.FunctionDef)
        and len(node.decorator_list) == 1
        and isinstance(node.decorator_list[0], ast.Name)
        and node.decorator_list[0].id in DECORATORS
    }
    rest = [node for node in tree.body if not (isinstance(node, ast.FunctionDef) and node.name in marked)]
    module = ModuleType("squealbox_kernel")
    exec(compile(ast.Module(rest, []), "<kernel>", "exec"), module.__dict__)  # text of our own making
    inline = any(mark == "packed" for _, mark in marked.values())
    return Unit({name: node for name, (node, _) in marked.items()}, module.__dict__, inline)


def _door(name: str, made: str, kinds: tuple[Any, ...], returned: Any) -> str:
    """The function that Python calls: what is returned goes into an array of doubles."""
    types = [text for kind in kinds for text in registers(kind)]
    given = [f"{text} %a{k}" for k, text in enumerate(types)]
    lines = [f'define void @"{name}"({", ".join([*given, "ptr %out"])}) nounwind alignstack({LINE}) {{', "entry:"]
    call = f'call {result(returned)} @"{made}"({", ".join(given)})'
    lines.append(f"  {call}" if returned is None else f"  %found = {call}")
    parts = [] if returned is None else [returned] if isinstance(returned, str) else returned[1]
    for k, kind in enumerate(parts):
        one = "%found"
        if not isinstance(returned, str):
            one = f"%part{k}"
            lines.append(f"  {one} = extractvalue {result(returned)} %found, {k}")
        if kind != FLOAT:
            lines.append(f"  %real{k} = {'sitofp' if kind == WHOLE else 'uitofp'} {TEXTS[kind]} {one} to double")
            one = f"%real{k}"
        lines += [f"  %at{k} = getelementptr double, ptr %out, i64 {k}", f"  store double {one}, ptr %at{k}"]
    return "\n".join([*lines, "  ret void", "}"])


@cache
def processor() -> Any:
    """LLVM's description of this machine."""
    import llvmlite.binding as llvm

    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    features = llvm.get_host_cpu_features().flatten()
    target = llvm.Target.from_default_triple()
    return target.create_target_machine(cpu=llvm.get_host_cpu_name(), features=features, opt=1, jit=True)


@cache
def _of_this_machine() -> bytes:
    """Digest of what the machine code depends on besides its text."""
    import llvmlite.binding as llvm

    parts = [llvm.get_host_cpu_name(), llvm.get_host_cpu_features().flatten(), str(llvm.llvm_version_info)]
    texts = [path.read_bytes() for path in sorted(Path(__file__).parent.glob("*.py"))]
    return b"".join([*(each.encode() for each in parts), *texts])


def optimised(text: str, modules: dict[str, str]) -> Any:
    """A text and the modules it calls, as one; those are straight-line code, by which the passes gain nothing."""
    import llvmlite.binding as llvm

    machine = processor()
    module = llvm.parse_assembly(text)
    module.triple, module.data_layout = machine.triple, str(machine.target_data)
    builder = llvm.create_pass_builder(machine, llvm.create_pipeline_tuning_options(speed_level=1))
    _passed(module, builder, PASSES)
    for other, part in modules.items():
        module.link_in(llvm.parse_assembly(part))
        module.get_function(other).linkage = "internal"
    module.verify()
    _passed(module, builder, ("global_dead_code_eliminate",))
    return module


def _passed(module: Any, builder: Any, passes: tuple[str, ...]) -> None:
    import llvmlite.binding as llvm

    manager = llvm.create_new_module_pass_manager()
    for each in passes:
        getattr(manager, f"add_{each}_pass")()
    manager.run(module, builder)


def loaded(codes: list[bytes], name: str) -> int:
    """The address of a function of machine code, which may be in several parts that call each other."""
    import llvmlite.binding as llvm

    processor()
    engine = llvm.create_mcjit_compiler(llvm.parse_assembly(""), _machine_of_its_own())
    for code in codes:
        engine.add_object_file(llvm.object_file.ObjectFileRef.from_data(code))
    engine.finalize_object()
    KEPT.append(engine)
    address: int = engine.get_function_address(name)
    return address


def _machine_of_its_own() -> Any:
    """An engine owns its description of the machine."""
    import llvmlite.binding as llvm

    return llvm.Target.from_default_triple().create_target_machine(jit=True)


def _callable(address: int, kinds: tuple[Any, ...], returned: Any) -> Callable[..., Callable[[], Any]]:
    """Binds arguments to the compiled function, which releases the interpreter's lock while it runs."""
    types = [CTYPES[text] for kind in kinds for text in registers(kind)]
    function = ctypes.CFUNCTYPE(None, *types, ctypes.c_void_p)(address)
    parts = () if returned is None else (returned,) if isinstance(returned, str) else returned[1]
    turns = tuple({FLOAT: float, WHOLE: int, TRUTH: bool}[kind] for kind in parts)

    def bound(*given: Any) -> Callable[[], Any]:
        """Hand over addresses and numbers; the arguments stay alive as long as the call."""
        out = (ctypes.c_double * max(len(parts), 1))()
        flat: list[Any] = []
        for each in given:
            _flatten(each, flat)
        flat.append(ctypes.addressof(out))

        def call(_: Any = (given, out)) -> Any:
            function(*flat)
            found = tuple(turn(x) for turn, x in zip(turns, out, strict=False))
            return None if returned is None else found[0] if isinstance(returned, str) else found

        return call

    return bound


def _flatten(value: Any, flat: list[Any]) -> None:
    if isinstance(value, np.ndarray):
        if not value.flags.c_contiguous:
            raise TypeError("an array that does not lie row by row")
        flat.append(_address(value))
        if value.dtype.names is None:
            flat.extend(value.shape)
    elif isinstance(value, np.void):
        whole: Any = value.base  # its own interface would list all fields, which takes longer than a short run
        alone = isinstance(whole, np.ndarray) and whole.nbytes == value.nbytes
        flat.append(_address(whole) if alone else value.__array_interface__["data"][0])
    elif isinstance(value, tuple):
        for each in value:
            _flatten(each, flat)
    else:
        flat.append(value)


def _address(array: Any) -> int:
    """Where an array lies; by its buffer, which is several times quicker to ask than NumPy's interface."""
    plain = array if array.dtype.names is None else array.reshape(1).view(np.uint8)
    if plain.size and plain.flags.writeable:
        return ctypes.addressof(ctypes.c_char.from_buffer(plain))
    address: int = plain.ctypes.data
    return address


def kept(path: Path, build: Callable[[], tuple[Any, bytes]]) -> tuple[Any, bytes]:
    """What `build` gives, a note and bytes, from disk where it was built before; a damaged file is written anew."""
    found = on_disk(path)
    if found is not None:
        return found
    told = threading.Timer(PATIENCE, aside, ["compiling for this kind of system, once on this machine"])
    told.daemon = True
    told.start()
    try:
        note, code = build()
    finally:
        told.cancel()
        aside("")
    content = pickle.dumps(note) + code
    _write(path, hashlib.sha256(content).hexdigest().encode() + b"\n" + content)
    return note, code


def on_disk(path: Path) -> tuple[Any, bytes] | None:
    """What was kept there; None where nothing is, or it is damaged."""
    try:
        check, _, content = path.read_bytes().partition(b"\n")
    except OSError:
        return None
    if not content or hashlib.sha256(content).hexdigest().encode() != check:
        return None
    stream = io.BytesIO(content)
    return pickle.load(stream), stream.read()


def _write(path: Path, content: bytes) -> None:
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        handle, temporary = tempfile.mkstemp(dir=path.parent, suffix=".part")
        with os.fdopen(handle, "wb") as file:
            file.write(content)
        os.replace(temporary, path)
    except OSError as error:
        said = f"{path.parent} is not writable ({error}): compiled code is not kept"
        warnings.warn(said, RuntimeWarning, stacklevel=2)

"""The one door to the compiler: plain functions in, compiled functions out, kept on disk between runs.

The sources of the march make one text, those of laws and schedules another, and `compiled` turns both into machine code
named by the hash of the text. So a change of any source makes new code; nothing stale runs.
`plain=True` runs the very same texts without the compiler, which the tests use to compare the two.
"""

import ast
import hashlib
import inspect
import operator
import re
from collections.abc import Callable, Collection, Mapping, Sequence
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import Any

from squealbox.compiled import Compiled, OfAnotherText, cache_folder, kept
from squealbox.friction import LAWS
from squealbox.schedules import SCHEDULES
from squealbox.transient import (
    _events,
    _impacts,
    _march,
    _modes,
    _motion,
    _rigid,
    _runge_kutta,
    _sharing,
    _time_stepping,
    by_kind,
)
from squealbox.transient.smooth_laws import SMOOTH

COMPARISONS: dict[type[ast.cmpop], Callable[[Any, Any], bool]] = {
    ast.Eq: operator.eq, ast.NotEq: operator.ne, ast.Gt: operator.gt, ast.Lt: operator.lt,
}  # fmt: skip
ENTRIES = ("march", "time_stepping")
FORMULAS = {name: each.kind for name, each in vars(by_kind).items() if isinstance(each, OfAnotherText)}
HEADER = '"""Made by squealbox; safe to delete."""\n\nimport numpy as np\n\n{decorators}'
PLAIN = """

def inner(function):
    return function


entry = inner
"""


@cache
def time_stepping_kernel(plain: bool = False, own: tuple[tuple[str, str], ...] = ()) -> Callable[..., Any]:
    """`_time_stepping.time_stepping`, compiled at first use; `own` as in `kernel`."""
    return _kernel("time_stepping", (_time_stepping,), {}, True, own, plain)


@cache
def kernel(events: bool, plain: bool = False, own: tuple[tuple[str, str], ...] = ()) -> Callable[..., int]:
    """`_march.march`, compiled for each new room of its records at first use, then read from disk.

    `own` are the sources of mu(v, p) and slope(v, p) of friction laws that follow `LAWS`.
    """
    decisions = (_rigid, _sharing, _impacts, _modes, _events) if events else ()
    modules = (_motion, _runge_kutta, *decisions, _march)
    march: Callable[..., int] = _kernel("march", modules, {"WITH_EVENTS": events}, not events, own, plain)
    return march


def _kernel(
    name: str,
    modules: Sequence[ModuleType],
    fixed: Mapping[str, float],
    inline: bool,
    own: tuple[tuple[str, str], ...],
    plain: bool,
) -> Any:
    """A function of some modules, which share their machine code whatever laws and schedules there are."""

    def written() -> str:
        return "\n\n".join(part for module in modules for part in definitions(module, fixed))

    rest = kept_text(f"formulas {own} {plain}", lambda: laws_and_schedules(own, plain))
    text = kept_text(f"{name} {fixed}", written)
    if plain:
        module = ModuleType("squealbox_kernel")
        exec(compile(f"{rest}\n{text}", "<kernel>", "exec"), module.__dict__)  # text of our own making
        return getattr(module, name)
    decorators = "packed = None  # every function becomes part of its callers\n" if inline else ""
    return Compiled(HEADER.format(decorators=decorators) + elsewhere(FORMULAS) + text, name, rest)


def elsewhere(names: Mapping[str, str | None]) -> str:
    """The text that has these names, of numbers and functions of their kinds, as `OfAnotherText`."""
    lines = [f"{name} = OfAnotherText({name!r}, {kind!r})" for name, kind in names.items()]
    return "\n".join(["from squealbox.compiled.kinds import OfAnotherText\n", *lines, "", ""])


def kept_text(made_for: str, write: Callable[[], str]) -> str:
    """A generated text, from disk where these modules wrote it before: that takes longer than a short run.

    `made_for` says all that it depends on besides the modules.
    """
    named = hashlib.sha256(made_for.encode() + _digest()).hexdigest()[:32]
    return kept(cache_folder() / f"{named}.text", lambda: ((), write().encode()))[1].decode()


@cache
def _digest() -> bytes:
    """Of every module that texts are written by or made of."""
    folder = Path(__file__).parent
    above = [*folder.parent.glob("*.py"), *folder.parent.glob("friction/*.py")]
    texts = [path.read_bytes() for path in sorted([*folder.rglob("*.py"), *above])]
    return hashlib.sha256(b"".join(texts)).digest()


def laws_and_schedules(
    own: tuple[tuple[str, str], ...] = (),
    plain: bool = False,
    laws: Collection[int] | None = None,
    schedules: Collection[int] | None = None,
    smooth: Collection[int] | None = None,
) -> str:
    """The text of laws and schedules behind one function each, `FORMULAS`; of all kinds, or only of those named."""
    parts = [HEADER.format(decorators=PLAIN if plain else "")]
    parts += _dispatcher("law_mu", [law.formula for law in LAWS], "v", laws, [mu for mu, _ in own])
    parts += _dispatcher("law_slope", [law.slope_formula for law in LAWS], "v", laws, _calls_of_mu(own))
    parts += _dispatcher("law_creep", [law.creep_formula or _no_creep for law in SMOOTH], "v, z", smooth)
    parts += _dispatcher("law_grip", [law.grip_formula for law in SMOOTH if law.grip_formula], "v, z, rate", smooth)
    parts += _dispatcher("schedule_value", [each.formula for each in SCHEDULES], "t", schedules)
    parts += _dispatcher("schedule_rate", [each.rate_formula for each in SCHEDULES], "t", schedules)
    return "\n\n".join(parts) + "\n"


_source = cache(inspect.getsource)


def _no_creep(v: Any, z: Any, p: Any) -> Any:
    return 0.0 * v


def _calls_of_mu(own: tuple[tuple[str, str], ...]) -> list[str]:
    """The slopes of own laws, which may call their mu, with the name it has in the generated file."""
    return [re.sub(r"\bmu(?=\()", f"law_mu_{len(LAWS) + i}", slope) for i, (_, slope) in enumerate(own)]


def _dispatcher(
    name: str,
    formulas: list[Callable[..., Any]],
    argument: str,
    kinds: Collection[int] | None,
    own: list[str] | None = None,
) -> list[str]:
    """Each formula under a name of its own, and one function that chooses by kind."""
    parts = []
    lines = ["@inner", f"def {name}(kind, {argument}, p):"]
    for i, formula in enumerate([*map(_source, formulas), *(own or ())]):
        if kinds is not None and i not in kinds:
            continue
        text = re.sub(r"^def \w+", f"def {name}_{i}", formula, count=1)
        parts.append("@inner\n" + text.rstrip().replace(": Any", "").replace(" -> Any", ""))
        lines.append(f"    if kind == {i}:\n        return float({name}_{i}({argument}, p))")
    lines.append("    return np.nan")
    return [*parts, "\n".join(lines)]


def definitions(module: ModuleType, fixed: Mapping[str, float], entries: tuple[str, ...] = ENTRIES) -> list[str]:
    """Constants and functions of a plain module, in order, with their decorators."""
    parts = []
    for i, (name, text, mentioned) in enumerate(_plain(module)):
        if name:
            given = tuple((each, type(fixed[each]), fixed[each]) for each in mentioned if each in fixed)
            text = ("@entry\n" if name in entries else "@inner\n") + _chosen(module, i, given)
        parts.append(text)
    return parts


@cache
def _plain(module: ModuleType) -> list[tuple[str, str, tuple[str, ...]]]:
    """Of each constant and function of a module: its name ("" of a constant), its text, what can be fixed in it."""
    parts: list[tuple[str, str, tuple[str, ...]]] = []
    for node in ast.parse(inspect.getsource(module)).body:
        if isinstance(node, ast.Assign):
            parts.append(("", ast.unparse(node), ()))
        elif isinstance(node, ast.FunctionDef):
            spelled = _Spelled().visit(node)
            inside = list(ast.walk(spelled))
            names = {_dotted(each) for each in inside if isinstance(each, (ast.Name, ast.Attribute))}
            names |= {f"{_dotted(each.value)}[]" for each in inside if isinstance(each, ast.Subscript)}
            parts.append((node.name, ast.unparse(spelled), tuple(sorted(names))))
    return parts


@cache
def _chosen(module: ModuleType, index: int, given: tuple[tuple[str, type, float], ...]) -> str:
    """A function with numbers for names. Kernels share most of theirs, and to write them takes longer than to load.

    given : names, kinds (1 and True are one key, but two texts) and numbers
    """
    function = ast.parse(_plain(module)[index][1]).body[0]
    return ast.unparse(_Fixed({name: value for name, _, value in given}).visit(function))


class _Spelled(ast.NodeTransformer):
    """A `lane` as what compiled code hands over, array, group and number, and its rows as places in the array."""

    def visit_arguments(self, node: ast.arguments) -> ast.arguments:
        """A parameter `lane` becomes three."""
        node.args = [ast.arg(name) for each in node.args for name in (PARTS if each.arg == "lane" else (each.arg,))]
        return node

    def visit_Call(self, node: ast.Call) -> ast.Call:
        """What is handed over as `lane` or `Lane(A, b, k)` becomes three."""
        self.generic_visit(node)
        node.args = [part for each in node.args for part in _parts(each)]
        return node

    def visit_Subscript(self, node: ast.Subscript) -> ast.expr:
        """`lane.q[i]`, the i-th row from q on."""
        row = _row(node.value)
        self.generic_visit(node)
        return _place(*row, node.ctx, node.slice) if row else node

    def visit_Attribute(self, node: ast.Attribute) -> ast.expr:
        """`lane.t`, a row."""
        row = _row(node)
        self.generic_visit(node)
        return _place(*row, node.ctx) if row else node


PARTS = ("A", "b", "lane")


def _parts(given: ast.expr) -> Sequence[ast.expr]:
    """Array, group and number of a lane; anything else as it is."""
    if isinstance(given, ast.Name) and given.id == "lane":
        return [ast.Name(name) for name in PARTS]
    return given.args if isinstance(given, ast.Call) and _dotted(given.func) == "Lane" else [given]


def _row(node: ast.expr) -> tuple[Sequence[ast.expr], str] | None:
    """The lane and the name of one of its rows; None where it is none."""
    parts = _parts(node.value) if isinstance(node, ast.Attribute) else ()
    return (parts, node.attr) if isinstance(node, ast.Attribute) and len(parts) == len(PARTS) else None


def _place(parts: Sequence[ast.expr], name: str, context: ast.expr_context, index: ast.expr | None = None) -> ast.expr:
    array, group, number = map(ast.unparse, parts)
    row = f"ROW_{name.upper()}" if index is None else f"(ROW_{name.upper()} + {ast.unparse(index)})"
    place = ast.parse(f"{array}[{group} + {row} * WIDTH + {number}]", mode="eval").body
    assert isinstance(place, ast.Subscript)
    place.ctx = context
    return place


class _Fixed(ast.NodeTransformer):
    """Put numbers for names, and keep only the branches they leave, so the others are never compiled."""

    def __init__(self, fixed: Mapping[str, float]) -> None:
        self.fixed = fixed

    def visit_Name(self, node: ast.Name) -> ast.expr:
        """A fixed name becomes its value."""
        return ast.Constant(self.fixed[node.id]) if node.id in self.fixed else node

    def visit_Attribute(self, node: ast.Attribute) -> ast.expr:
        """A fixed attribute such as p.contacts becomes its value."""
        name = _dotted(node)
        return ast.Constant(self.fixed[name]) if name in self.fixed else node

    def visit_Subscript(self, node: ast.Subscript) -> ast.expr:
        """Every element of a fixed array, named such as ``p.rigid[]``, becomes its value."""
        self.generic_visit(node)
        name = f"{_dotted(node.value)}[]"
        return ast.Constant(self.fixed[name]) if name in self.fixed and isinstance(node.ctx, ast.Load) else node

    def visit_Compare(self, node: ast.Compare) -> ast.expr:
        """A comparison of two numbers becomes its truth value."""
        self.generic_visit(node)
        sides = (node.left, node.comparators[0])
        known = COMPARISONS.get(type(node.ops[0])) if len(node.ops) == 1 else None
        if known is None or not all(isinstance(side, ast.Constant) for side in sides):
            return node
        return ast.Constant(known(*(side.value for side in sides)))  # type: ignore[attr-defined]

    def visit_BinOp(self, node: ast.BinOp) -> ast.expr:
        """The product of two numbers becomes a number."""
        self.generic_visit(node)
        if (
            isinstance(node.op, ast.Mult)
            and isinstance(node.left, ast.Constant)
            and isinstance(node.right, ast.Constant)
        ):
            return ast.Constant(node.left.value * node.right.value)  # type: ignore[operator]
        return node

    def visit_BoolOp(self, node: ast.BoolOp) -> ast.expr:
        """``True and x`` is x, ``False and x`` is False."""
        self.generic_visit(node)
        first = node.values[0]
        if isinstance(node.op, ast.And) and isinstance(first, ast.Constant):
            rest = node.values[1:]
            return (rest[0] if len(rest) == 1 else ast.BoolOp(node.op, rest)) if first.value else first
        return node

    def visit_For(self, node: ast.For) -> ast.stmt:
        """A loop that has lost its body does nothing."""
        self.generic_visit(node)
        node.body = node.body or [ast.Pass()]
        return node

    def visit_If(self, node: ast.If) -> Any:
        """A statement whose test is now constant becomes its branch."""
        self.generic_visit(node)
        node.body = node.body or [ast.Pass()]
        if isinstance(node.test, ast.Constant):
            return node.body if node.test.value else node.orelse
        return node

    def visit_IfExp(self, node: ast.IfExp) -> ast.expr:
        """An expression whose test is now constant becomes its branch."""
        self.generic_visit(node)
        if isinstance(node.test, ast.Constant):
            return node.body if node.test.value else node.orelse
        return node


def _dotted(node: ast.expr) -> str:
    """``p.contacts`` of the expression that says so, "" of others; asked often, where `ast.unparse` is slow."""
    if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
        return f"{node.value.id}.{node.attr}"
    return node.id if isinstance(node, ast.Name) else ""

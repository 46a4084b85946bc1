"""Plain formulas of laws, schedules and observers as functions of lanes."""

import ast
import inspect
import textwrap
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from squealbox import friction, schedules
from squealbox.friction import LAWS
from squealbox.schedules import SCHEDULES
from squealbox.system import InvalidSystem
from squealbox.transient.lanes.shape import Shape
from squealbox.transient.observers import extreme
from squealbox.transient.own_laws import is_long
from squealbox.transient.smooth_laws import SMOOTH

VECTOR_FUNCTIONS = ("where", "minimum", "maximum", "sqrt", "exp", "sin", "cos", "arctan", "log")


def formulas(shape: Shape) -> list[str]:
    """The laws, schedules and observers of a kernel as functions of lanes."""
    parts: list[str] = []
    for kind in sorted({kind for kind, _ in shape.laws}):
        if shape.taylor and is_table(LAWS, kind):
            parts.append(f"lane_mu_{kind} = law_of_points")
            continue
        parts.append(lane_function(law_text(kind, shape.own), f"lane_mu_{kind}", in_memory(kind, shape.own)))
    for kind in sorted({kind - 1 for kind in shape.smooth if kind > 0}):
        law = SMOOTH[kind]
        for name, formula in (("creep", law.creep_formula), ("grip", law.grip_formula)):
            parts += [] if formula is None else [lane_function(inspect.getsource(formula), f"lane_{name}_{kind}")]
    for kind in sorted({kind for terms in shape.signals for kind, _ in terms}):
        if shape.taylor and is_table(SCHEDULES, kind):
            parts.append(f"lane_value_{kind}, lane_rate_{kind} = line_of_points, slope_of_points")
            continue
        for name, formula in (("value", SCHEDULES[kind].formula), ("rate", SCHEDULES[kind].rate_formula)):
            text = inspect.getsource(formula)
            parts.append(lane_function(text, f"lane_{name}_{kind}", is_table(SCHEDULES, kind)))
    if shape.observers:
        parts.append(lane_function(inspect.getsource(extreme), "extreme"))
    for k, observer in enumerate(shape.observers):
        parts.append(lane_function(source_of(observer.update), f"observe_{k}"))
    return parts


def is_table(kinds: Sequence[type], kind: int) -> bool:
    """Whether it is a table, whose coefficients are as many as its points; kinds after the known ones are own laws."""
    return kind < len(kinds) and kinds[kind] in (friction.Table, schedules.Table)


def law_text(kind: int, own: Sequence[tuple[str, str]]) -> str:
    """The source of a law's formula."""
    return own[kind - len(LAWS)][0] if kind >= len(LAWS) else inspect.getsource(LAWS[kind].formula)


def smooth_text(kind: int) -> str:
    """The sources of the formulas of a law without events."""
    return "".join(inspect.getsource(each) for each in (SMOOTH[kind].creep_formula, SMOOTH[kind].grip_formula) if each)


def in_memory(kind: int, own: Sequence[tuple[str, str]]) -> bool:
    """Whether a law is long, and so called with its coefficients in memory: a table, or an own law that is a sum."""
    return is_long(own[kind - len(LAWS)][0]) if kind >= len(LAWS) else is_table(LAWS, kind)


def source_of(function: Callable[..., Any]) -> str:
    """The text of a user's plain function; `InvalidSystem` when there is none to compile."""
    try:
        return inspect.getsource(function)
    except (OSError, TypeError) as error:
        raise InvalidSystem(f"{function!r}: expected a plain function whose source can be read, from a file") from error


def lane_function(text: str, name: str, table: bool = False) -> str:
    """A plain formula under another name, its NumPy functions replaced by those of lanes; that of a table is called."""
    tree = ast.parse(textwrap.dedent(text))
    function = tree.body[0]
    if not isinstance(function, ast.FunctionDef):
        raise InvalidSystem(f"{text.splitlines()[0]}: expected a plain function written with def")
    function.name, function.returns, function.decorator_list = name, None, []
    for argument in function.args.args:
        argument.annotation = None
    return "@apart\n" * table + ast.unparse(ast.fix_missing_locations(_OfLanes().visit(tree)))


class _OfLanes(ast.NodeTransformer):
    """Names of the functions of lanes for those of NumPy; np.inf and np.nan stay."""

    def visit_Attribute(self, node: ast.Attribute) -> ast.expr:
        """np.exp becomes exp."""
        self.generic_visit(node)
        if not (isinstance(node.value, ast.Name) and node.value.id in ("np", "numpy", "math")):
            return node
        if node.attr in VECTOR_FUNCTIONS:
            return ast.Name(node.attr, ast.Load())
        others = {"tanh": "lane_tanh", "abs": "abs", "absolute": "abs", "fabs": "abs"}
        return ast.Name(others[node.attr], ast.Load()) if node.attr in others else node


def tried(text: str) -> str:
    """Why a law's text mu(v, p) cannot be run on a series; empty where it can."""
    from squealbox import compiled as vectors
    from squealbox.transient.lanes import series

    names: dict[str, Any] = {"np": np, **{name: getattr(series, name) for name in (*VECTOR_FUNCTIONS, "lane_tanh")}}
    try:
        exec(compile(lane_function(text, "mu"), "<own law>", "exec"), names)
        with vectors.writing(vectors.Writer(), 1), series.deciding():
            one = vectors.Lanes(vectors.number(1.0))
            numbers = [one] * 64
            found = names["mu"](series.Series(lambda k: None, (one, one)), numbers)
            found[2] if isinstance(found, series.Series) else found
    except Exception as error:  # whatever a user's text does there
        return f"{error}"
    return ""

"""Plain formulas of laws, schedules and observers as functions of lanes."""

import ast
import inspect
import textwrap
from collections.abc import Callable
from typing import Any

from squealbox.friction import LAWS
from squealbox.schedules import SCHEDULES
from squealbox.system import InvalidSystem
from squealbox.transient.lanes.shape import Shape
from squealbox.transient.observers import extreme

VECTOR_FUNCTIONS = ("where", "minimum", "maximum", "sqrt", "exp", "sin", "cos", "arctan", "log")


def formulas(shape: Shape, laws: tuple[Any, ...] = LAWS) -> list[str]:
    """The laws, schedules and observers of a kernel as functions of lanes."""
    parts = []
    for kind in sorted({kind for kind, _ in shape.laws}):
        parts.append(lane_function(laws[kind].formula, f"lane_mu_{kind}"))
    for kind in sorted({kind for terms in shape.signals for kind, _ in terms}):
        parts.append(lane_function(SCHEDULES[kind].formula, f"lane_value_{kind}"))
        parts.append(lane_function(SCHEDULES[kind].rate_formula, f"lane_rate_{kind}"))
    if shape.observers:
        parts.append(lane_function(extreme, "extreme"))
    parts += [lane_function(observer.update, f"observe_{k}") for k, observer in enumerate(shape.observers)]
    return parts


def lane_function(formula: Callable[..., Any], name: str) -> str:
    """A plain formula under another name, its NumPy functions replaced by those of lanes."""
    tree = ast.parse(textwrap.dedent(inspect.getsource(formula)))
    function = tree.body[0]
    if not isinstance(function, ast.FunctionDef):
        raise InvalidSystem(f"{formula!r}: expected a plain function written with def")
    function.name, function.returns, function.decorator_list = name, None, []
    for argument in function.args.args:
        argument.annotation = None
    return "@packed\n" + ast.unparse(ast.fix_missing_locations(_OfLanes().visit(tree)))


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

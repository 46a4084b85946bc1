"""Means over a fast harmonic: E[h] = (1/2 pi) int h(v + w sin(phase)) dphase, with kinks of h at known places.

Gauss-Legendre in the phase, in panels between the kinks, graded by halves towards u = 0, where what is averaged turns;
for the compiled engines as a text of such sums around the text of what is averaged. Depends on: nothing.
"""

import ast
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

PANELS, NODES = 12, 16  # panels on each side of a reversal, each half as wide as the last, and Gauss points in each
IN_TEXT, WIDTHS = 16, (0.0, 2.0**-7, 2.0**-5, 2.0**-3, 0.5, 1.5)  # Gauss points and edges over w of panels in a text
BEYOND = 1e100  # m/s, the last edge


def mean_over_phase(h: Callable[[Any], Any], v: np.ndarray, w: np.ndarray, kinks: Sequence[Any] = ()) -> Any:
    """E[h(v + w sin)] for arrays v, w of one shape (...); `h` is called with u of shape (..., panels, nodes).

    `kinks` are values |u| > 0 at which h is not smooth; u = 0 always counts as one.

    >>> round(float(mean_over_phase(np.abs, np.asarray(0.0), np.asarray(1.0))), 12) == round(2.0 / np.pi, 12)
    True
    """
    nodes, weights = np.polynomial.legendre.leggauss(NODES)
    grades = np.r_[0.0, 0.5 ** np.arange(PANELS - 1, -1, -1.0)]
    turn = np.arcsin(np.clip(-v / w, -1.0, 1.0))
    cuts = [np.arcsin(np.clip((sign * kink - v) / w, -1.0, 1.0)) for kink in kinks for sign in (1.0, -1.0)]
    below, above = ((end - turn)[..., None] * grades + turn[..., None] for end in (-0.5 * np.pi, 0.5 * np.pi))
    more = np.stack([turn, *(np.broadcast_to(cut, turn.shape) for cut in cuts)], axis=-1)
    edges = np.sort(np.concatenate([below, above, more], axis=-1), axis=-1)
    half, middle = 0.5 * np.diff(edges), 0.5 * (edges[..., 1:] + edges[..., :-1])
    u = v[..., None, None] + w[..., None, None] * np.sin(middle[..., None] + half[..., None] * nodes)
    return np.sum(h(u) * weights * half[..., None], axis=(-1, -2)) / np.pi


def summed(text: str, panels: int, known: Mapping[int, int]) -> tuple[str, str]:
    """Source of E[mu(|u|) sgn(u)] and of its slope (by differences) for a source of mu(v, p) that ends with its return.

    p = (any, w, edges of the panels in |u| (panels + 1), Gauss points and weights (IN_TEXT each), coefficients of mu),
    of which those in `known` are whole numbers. A panel above and its mirror below cancel to the last bit at v = 0.

    >>> "for j in range(2)" in summed("def mu(v, p): return p[0] + 0.0 * v", 2, {})[0]
    True
    """
    first = 2 + panels + 1 + 2 * IN_TEXT
    function = _Inner(first, known).visit(ast.parse(text)).body[0]
    *before, last = function.body
    if (
        not isinstance(last, ast.Return)
        or last.value is None
        or any(isinstance(x, ast.Return) for y in before for x in ast.walk(y))
    ):
        raise ValueError("expected one return, at the end")
    before = [each for each in before if not (isinstance(each, ast.Expr) and isinstance(each.value, ast.Constant))]
    lines = [line for each in before for line in ast.unparse(each).splitlines()]
    inner = "\n".join(f"            {line}" for line in [*lines, f"inner_mu = {ast.unparse(last.value)}"])
    return _SUM.format(panels=panels, points=IN_TEXT, at=3 + panels, inner=inner), _DIFFERENCE


def in_text(edges: Sequence[Any]) -> tuple[Any, ...]:
    """The coefficients of `summed` between w and those of mu."""
    nodes, weights = np.polynomial.legendre.leggauss(IN_TEXT)
    return (*edges, BEYOND, *map(float, nodes), *map(float, weights))


class _Inner(ast.NodeTransformer):
    """The names of a formula beside those of the sum around it, its coefficients behind those of the sum."""

    def __init__(self, first: int, known: Mapping[int, int]) -> None:
        self.first, self.known, self.local = first, known, {"v"}

    def visit_FunctionDef(self, node: ast.FunctionDef) -> ast.FunctionDef:
        """All that it sets is its own."""
        self.local |= {x.id for x in ast.walk(node) if isinstance(x, ast.Name) and isinstance(x.ctx, ast.Store)}
        self.generic_visit(node)
        return node

    def visit_Name(self, node: ast.Name) -> ast.Name:
        """v becomes inner_v."""
        return ast.Name(f"inner_{node.id}", node.ctx) if node.id in self.local else node

    def visit_Subscript(self, node: ast.Subscript) -> ast.expr:
        """p[2] becomes p[2 + first], or its number."""
        if not (isinstance(node.value, ast.Name) and node.value.id == "p"):
            self.generic_visit(node)
            return node
        at = node.slice.value if isinstance(node.slice, ast.Constant) else None
        if isinstance(at, int) and at in self.known:
            return ast.Constant(float(self.known[at]))
        place = ast.BinOp(self.visit(node.slice), ast.Add(), ast.Constant(self.first))
        return ast.Subscript(node.value, place, node.ctx)


_SUM = """def mu(v, p):
    total = 0.0 * v
    for j in range({panels}):
        a = np.minimum(np.maximum((p[2 + j] - v) / p[1], -1.0), 1.0)
        b = np.minimum(np.maximum((p[3 + j] - v) / p[1], -1.0), 1.0)
        c = np.minimum(np.maximum((p[2 + j] + v) / p[1], -1.0), 1.0)
        d = np.minimum(np.maximum((p[3 + j] + v) / p[1], -1.0), 1.0)
        a = 2.0 * np.arctan(a / (1.0 + np.sqrt(1.0 - a * a)))
        b = 2.0 * np.arctan(b / (1.0 + np.sqrt(1.0 - b * b)))
        c = 2.0 * np.arctan(c / (1.0 + np.sqrt(1.0 - c * c)))
        d = 2.0 * np.arctan(d / (1.0 + np.sqrt(1.0 - d * d)))
        for i in range({points}):
            inner_v = np.maximum(p[1] * np.sin(0.5 * (a + b + (b - a) * p[{at} + i])) + v, 0.0)
{inner}
            total = total + p[{at} + {points} + i] * (b - a) * inner_mu
            inner_v = np.maximum(p[1] * np.sin(0.5 * (c + d + (d - c) * p[{at} + i])) - v, 0.0)
{inner}
            total = total - p[{at} + {points} + i] * (d - c) * inner_mu
    return total * 0.15915494309189535
"""
_DIFFERENCE = """def slope(v, p):
    h = 1e-5 * (v + 1e-3)
    low = np.maximum(v - h, 0.0)
    return (mu(v + h, p) - mu(low, p)) / (v + h - low)
"""

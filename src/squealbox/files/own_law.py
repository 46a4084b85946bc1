"""A friction law of one's own: plain functions in a Python file that a design file names.

    def mu(v, p):        coefficient [-] at the sliding speed v >= 0 [m/s]; p holds the law's numbers
    def slope(v, p):     its derivative [s/m]; may be left out

They follow the rules of the laws in `friction`: arithmetic and NumPy (as ``np``) only, one expression path for numbers
and arrays, because the transient engine compiles their text. Left out, the slope is the central difference
(mu(v + h) - mu(v - h))/(2 h) with h = 1e-5 (v + 1e-3), at v < h the forward one: relative error about 1e-10 for a smooth
law, h^2 mu'''/6 plus round-off/h.

Such a file is code. It is read as text here and run only where the caller allows it.
"""

import ast
import hashlib
from collections.abc import Callable, Sequence
from functools import cache
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from squealbox.friction import FrictionLaw
from squealbox.parameters import ParameterError

LARGEST = 20_000  # characters of a law's source


class OwnLaw(FrictionLaw):
    """A friction law from the text of plain functions ``mu(v, p)`` and, if given, ``slope(v, p)``.

    `source` is that text and `numbers` what the functions find in p; p[0] is `static`, the largest coefficient a sticking
    contact carries, and is mu(0) when left out. Made in Python, the law runs at once; a file may make one only when its
    reader is told so.

    >>> law = OwnLaw("def mu(v, p):\\n    return p[1] / (1.0 + v)", numbers=(0.4,))
    >>> round(float(law.mu(1.0)), 12), round(float(law.slope_at(1.0)), 9)
    (0.2, -0.1)
    """

    source: str
    numbers: tuple[float, ...] = ()
    static: float | None = None

    title: ClassVar[str] = "friction law from a Python file"

    def __post_init__(self) -> None:
        super().__post_init__()
        object.__setattr__(self, "numbers", _numbers(self.numbers))
        functions = compiled(self.source)
        if self.static is None:
            with np.errstate(all="ignore"):
                object.__setattr__(self, "static", _start(functions[0], self.numbers))
        elif not (np.ndim(self.static) == 0 and 0.0 <= float(self.static) <= 10.0):
            raise ParameterError("OwnLaw", "static", self.static, "a finite number in [0, 10]")

    def coefficients(self) -> tuple[Any, ...]:
        """The static limit, then the law's numbers."""
        return (self.static, *self.numbers)

    def mu(self, velocity: Any) -> Any:
        return compiled(self.source)[0](np.abs(velocity), self.coefficients())

    def slope_at(self, velocity: Any) -> Any:
        return compiled(self.source)[1](np.abs(velocity), self.coefficients())

    @property
    def content_hash(self) -> str:
        """SHA-256 of the source: two laws with the same text share compiled code."""
        return hashlib.sha256(self.source.encode()).hexdigest()

    @property
    def texts(self) -> tuple[str, str]:
        """The source of `mu` and of `slope`, the second derived when left out."""
        return _texts(self.source)


def law_from_file(path: Path, numbers: Sequence[float] = (), static: float | None = None) -> OwnLaw:
    """The law in the Python file at `path`. Calling this allows its code."""
    return OwnLaw(path.read_text(encoding="utf-8"), tuple(numbers), static)


DERIVED = """def slope(v, p):
    h = 1e-5 * (v + 1e-3)
    low = np.maximum(v - h, 0.0)
    return (mu(v + h, p) - mu(low, p)) / (v + h - low)
"""


@cache
def compiled(source: str) -> tuple[Callable[..., Any], Callable[..., Any]]:
    """The functions mu and slope of a law's source, run as plain Python; `ParameterError` says what is wrong with it."""
    space: dict[str, Any] = {"np": np, "numpy": np}
    try:
        exec(compile("\n\n".join(_texts(source)), "<friction law>", "exec"), space)
    except Exception as error:
        raise _refused(f"{type(error).__name__}: {error}", "functions that run") from error
    return space["mu"], space["slope"]


@cache
def _texts(source: str) -> tuple[str, str]:
    if not isinstance(source, str) or len(source) > LARGEST:
        raise _refused("its source", f"text of at most {LARGEST} characters")
    try:
        tree = ast.parse(source)
    except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
        raise _refused(str(error).splitlines()[0], "Python") from error
    found = {}
    for node in tree.body:
        if isinstance(node, ast.FunctionDef) and node.name in ("mu", "slope") and not node.decorator_list:
            if [argument.arg for argument in node.args.args] != ["v", "p"]:
                raise _refused(f"{node.name}({ast.unparse(node.args)})", f"def {node.name}(v, p)")
            node.returns = None
            for argument in node.args.args:
                argument.annotation = None
            found[node.name] = ast.unparse(node)
        elif not _is_preface(node):
            raise _refused(ast.unparse(node).splitlines()[0], "the functions mu(v, p) and slope(v, p), and no other")
    if "mu" not in found:
        raise _refused("no mu", "a function mu(v, p)")
    return found["mu"], found.get("slope", DERIVED)


def _is_preface(node: ast.stmt) -> bool:
    """True for a docstring and for ``import numpy as np``."""
    if isinstance(node, ast.Expr):
        return isinstance(node.value, ast.Constant)
    return isinstance(node, ast.Import) and [(a.name, a.asname) for a in node.names] == [("numpy", "np")]


def _numbers(values: Any) -> tuple[float, ...]:
    try:
        numbers = tuple(float(value) for value in values)
    except (TypeError, ValueError) as error:
        raise ParameterError("OwnLaw", "numbers", values, "finite numbers") from error
    if not np.all(np.isfinite(numbers)):
        raise ParameterError("OwnLaw", "numbers", values, "finite numbers")
    return numbers


def _start(mu: Callable[..., Any], numbers: tuple[float, ...]) -> float:
    try:
        start = float(mu(0.0, (0.0, *numbers)))
    except Exception as error:
        raise _refused(f"mu(0, p) raises {type(error).__name__}: {error}", "a finite number in [0, 10]") from error
    if not 0.0 <= start <= 10.0:
        raise _refused(f"mu(0, p) = {start:g}", "a finite number in [0, 10]")
    return start


def _refused(what: str, expected: str) -> ParameterError:
    return ParameterError("OwnLaw", "source", what, expected)

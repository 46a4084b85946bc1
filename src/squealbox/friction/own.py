"""A friction law of one's own: plain functions in a Python file that a design file names.

    def mu(v, p):        coefficient [-] at the sliding speed v >= 0 [m/s]; p holds the law's numbers
    def slope(v, p):     its derivative [s/m]; may be left out

They follow the rules of the laws in `friction`: arithmetic and NumPy (as ``np``) only, one expression path for numbers
and arrays, because the transient engine compiles their text. Left out, the slope is the central difference
(mu(v + h) - mu(v - h))/(2 h) with h = 1e-5 (v + 1e-3), at v < h the one-sided one: relative error about 1e-10 for a
smooth law, h^2 mu'''/6 plus round-off/h.

Such a file is code. It is read as text here and run only where the caller allows it.
"""

import ast
import hashlib
import inspect
import re
import textwrap
from collections.abc import Callable, Iterable, Sequence
from functools import cache
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from squealbox.law import NEVER_STICKS, FrictionLaw
from squealbox.parameters import ParameterError, parameter


class OwnLaw(FrictionLaw):
    """A friction law from the text of plain functions ``mu(v, p)`` and, if given, ``slope(v, p)``.

    `source` is that text, `static` the largest coefficient a sticking contact carries, which the functions find in
    p[0], and `numbers` what follows it in p. Make one with `own_law` from functions or text, or with `law_from_file`:
    they allow the code to run. A law that comes out of a saved result is data, and asking it for a value raises
    `ParameterError` until `allow` is called with it.

    >>> law = own_law("def mu(v, p): return p[1] / (1.0 + v)", numbers=(0.4,))
    >>> round(float(law.mu(1.0)), 12), round(float(law.slope_at(1.0)), 9)
    (0.2, -0.1)
    """

    LARGEST: ClassVar[int] = 20_000  # characters of a source

    source: str
    static: float = parameter("-", 0.0, 10.0, meaning="static limit")
    numbers: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "numbers", _numbers(self.numbers))
        _texts(self.source)
        super().__post_init__()

    def _check_start(self) -> None:
        if self.source not in _ALLOWED:  # `allow` looks
            return
        try:
            super()._check_start()
        except ParameterError:
            raise
        except Exception as error:
            raise _refused(f"its code raises {type(error).__name__}: {error}", "mu(v, p) and slope(v, p)") from error

    def coefficients(self) -> tuple[Any, ...]:
        """The static limit, then the law's numbers."""
        rising = np.where(np.asarray(self.static) == 0.0, NEVER_STICKS, self.static)
        return (rising if np.ndim(rising) else float(rising), *self.numbers)

    def mu(self, velocity: float | np.ndarray) -> Any:
        return _functions(self.source)[0](np.abs(velocity), self.coefficients())

    def slope_at(self, velocity: float | np.ndarray) -> Any:
        return _functions(self.source)[1](np.abs(velocity), self.coefficients())

    @property
    def content_hash(self) -> str:
        """SHA-256 of the source: two laws with the same text share compiled code."""
        return hashlib.sha256(self.source.encode()).hexdigest()

    @property
    def texts(self) -> tuple[str, str]:
        """The source of `mu` and of `slope`, the second derived when left out."""
        return _texts(self.source)


def own_law(
    mu: Callable[..., Any] | str,
    slope: Callable[..., Any] | None = None,
    *,
    numbers: Sequence[float] = (),
    static: float | None = None,
) -> OwnLaw:
    """A law from two plain functions of (v, p), or from their text; `slope` may be left out (see the module).

    `numbers` [SI]: the law's own numbers, in the units the functions give them. `static` [-] left out is mu(0).
    Raises `ParameterError` for text that is not such functions, or a mu(0) outside [0, 10].

    >>> law = own_law("def mu(v, p): return 0.3 + 0.1 * np.exp(-v)")
    >>> round(law.static, 12)
    0.4
    """
    source = mu if isinstance(mu, str) else "\n\n".join(_text_of(f, n) for f, n in ((mu, "mu"), (slope, "slope")) if f)
    _texts(source)
    _ALLOWED.add(source)
    values = _numbers(numbers)
    return OwnLaw(source, _start(_functions(source)[0], values) if static is None else static, values)


def law_from_file(path: Path, numbers: Sequence[float] = (), static: float | None = None) -> OwnLaw:
    """The law in the Python file at `path`. Calling this allows its code.

    `numbers` [SI]: the law's own numbers, in the units its file gives them; `static` [-]: static limit.
    """
    return own_law(path.read_text(encoding="utf-8"), numbers=numbers, static=static)


def allow(law: OwnLaw) -> OwnLaw:
    """Let the code of a law that was read from a file run in this process; returns the law."""
    _ALLOWED.add(law.source)
    law._check_start()
    return law


DERIVED = """def slope(v, p):
    h = 1e-5 * (v + 1e-3)
    low = np.maximum(v - h, 0.0)
    return (mu(v + h, p) - mu(low, p)) / (v + h - low)
"""


_ALLOWED: set[str] = set()  # sources that the user has let run in this process


def _functions(source: str) -> tuple[Callable[..., Any], Callable[..., Any]]:
    if source not in _ALLOWED:
        raise _refused("code that came with a file", "a call of squealbox.friction.allow(law) before it is run")
    return _run(source)


@cache
def _run(source: str) -> tuple[Callable[..., Any], Callable[..., Any]]:
    space: dict[str, Any] = {"np": np}
    try:
        exec(compile("\n\n".join(_texts(source)), "<friction law>", "exec"), space)
    except Exception as error:
        raise _refused(f"{type(error).__name__}: {error}", "functions that run") from error
    return space["mu"], space["slope"]


@cache
def _texts(source: str) -> tuple[str, str]:
    if not isinstance(source, str) or len(source) > OwnLaw.LARGEST:
        raise _refused("its source", f"text of at most {OwnLaw.LARGEST} characters")
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


def _text_of(function: Callable[..., Any], name: str) -> str:
    try:
        text = textwrap.dedent(inspect.getsource(function))
    except (OSError, TypeError) as error:
        raise _refused(f"{function!r}", "a function written in a file or cell, or its text") from error
    return re.sub(r"^def \w+", f"def {name}", text, count=1)


def _is_preface(node: ast.stmt) -> bool:
    """True for a docstring and for ``import numpy as np``."""
    if isinstance(node, ast.Expr):
        return isinstance(node.value, ast.Constant)
    return isinstance(node, ast.Import) and [(a.name, a.asname) for a in node.names] == [("numpy", "np")]


def _numbers(values: Iterable[Any]) -> tuple[float, ...]:
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

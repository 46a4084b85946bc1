"""What a function takes is said by its type: the share of parameters typed Any in each room only falls."""

import ast

from house.rooms import PACKAGE

# Percent of a room's annotated parameters that may be Any. Formulas of friction and schedules and what is compiled take
# numbers, arrays and packed numbers alike; files and the page read what somebody wrote.
MOST = {
    "squealbox": 14, "calibration": 9, "cli": 7, "compiled": 22, "control": 2, "countermeasures": 7, "designs": 5,
    "fe": 2, "files": 9, "friction": 35, "limit_cycles": 2, "loops": 17, "papers": 7, "plots": 6, "remedies": 4,
    "report": 6, "signals": 5, "stability": 2, "studies": 3, "transient": 17, "workbench": 9,
}  # fmt: skip
MOST_PARAMETERS = 8
LONGER = 22  # functions with more; the calls of users among them stay as they are


def functions(text: str) -> list[ast.FunctionDef | ast.AsyncFunctionDef]:
    """All functions of a source, methods and inner ones too."""
    return [node for node in ast.walk(ast.parse(text)) if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef))]


def untyped(text: str) -> tuple[int, int, list[str]]:
    """How many annotated parameters are Any, how many there are, and the names of those that are Any."""
    given = [
        (function.name, each.arg, ast.unparse(each.annotation))
        for function in functions(text)
        for each in ast.walk(function.args)
        if isinstance(each, ast.arg) and each.annotation is not None
    ]
    names = [f"{function}({name})" for function, name, told in given if told in ("Any", "Any | None")]
    return len(names), len(given), names


def rooms() -> dict[str, str]:
    """Each room's sources as one text; single files are the room `squealbox`."""
    found: dict[str, list[str]] = {}
    for path in sorted(PACKAGE.rglob("*.py")):
        parts = path.relative_to(PACKAGE).parts
        found.setdefault(parts[0] if len(parts) > 1 else "squealbox", []).append(path.read_text())
    return {room: "\n".join(texts) for room, texts in found.items()}


def test_parameters_say_what_they_are():
    sources = rooms()
    assert set(sources) == set(MOST)
    for room, text in sources.items():
        count, every, names = untyped(text)
        assert 100.0 * count <= MOST[room] * every, (
            f"{100.0 * count / every:.1f} % of the parameters in {room} are Any, {MOST[room]} % may be: write what "
            f"arrives, such as np.ndarray, ArrayLike or DesignOrSystem, in place of Any at {', '.join(names[-8:])}"
        )


def test_any_is_seen():
    text = "def f(a: Any, b: int, *c: Any, d: Any | None = None) -> Any:\n    def g(e: Any): ...\n"
    assert untyped(text) == (4, 5, ["f(a)", "f(c)", "f(d)", "g(e)"])


def test_functions_do_not_take_more_and_more():
    found = []
    for room, text in rooms().items():
        for each in functions(text):
            given = [*each.args.posonlyargs, *each.args.args, *each.args.kwonlyargs]
            if len([one for one in given if one.arg not in ("self", "cls")]) > MOST_PARAMETERS:
                found.append(f"{room}: {each.name}")
    assert len(found) <= LONGER, (
        f"{len(found)} functions take more than {MOST_PARAMETERS} parameters, {LONGER} do: those that travel together "
        f"are a noun with a name; {', '.join(found)}"
    )

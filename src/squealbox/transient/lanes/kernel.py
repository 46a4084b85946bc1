"""The kernel of lanes as two generated texts: the service, with the scalar march's decisions, and what a shape has.

The service is compiled once for all shapes with the same features; a new shape compiles its step alone.
"""

import hashlib
from dataclasses import fields
from functools import cache
from pathlib import Path

from squealbox.compiled import WHOLE, Compiled, OfAnotherText
from squealbox.schedules import SCHEDULES, Constant
from squealbox.transient import _engine, _events, _impacts, _march, _modes, _motion, _rigid, _runge_kutta, _sharing
from squealbox.transient.lanes import alone, crossing, of_a_shape, recording, roots, samples, service, stages_again
from squealbox.transient.lanes.formulas import formulas
from squealbox.transient.lanes.shape import ORDER, PARTS, UNIT_OF_WINDOW, Shape, layout, parameter_rows
from squealbox.transient.lanes.step_text import Step
from squealbox.transient.lanes.taylor_text import TaylorStep
from squealbox.transient.methods import tableau

SERVICE = """
from squealbox.transient.lanes.tracing import take
# written by modules whose texts have the digest {digest}: a change of theirs makes another file
"""
HEAD = """
from collections import namedtuple

from squealbox.compiled.in_memory import Given, at_once, load, spread, store, store_one
from squealbox.compiled.vectors import (
    arctan, bits, cos, each, exp, forget, if_flagged, lane_tanh, log, maximum, minimum, over_all, sin, sqrt, where,
    with_sign,
)
from squealbox.transient.lanes.rough import rough_exp, rough_log
from squealbox.transient.lanes.tracing import apart, traced, traced_as_written, wide
# written by modules whose texts have the digest {digest}: a change of theirs makes another file
{more}

LANES = {lanes}
Motion = namedtuple("Motion", "t, q, qd, qdd")
Sliding = namedtuple("Sliding", "t, velocity, normal, mode, work")
State = namedtuple("State", "t, q, qd, qdd")
"""
SERIES = """
from squealbox.transient.lanes.series import (
    Series, arctan, at, constant, cos, deciding, exp, from_zero, integral, lane_tanh, log, maximum, minimum,
    sin, sqrt, stored, time_series, value, value_and_slope, where,
)
from squealbox.transient.lanes.series import derivative as slope_series
from squealbox.transient.lanes.tables import law_of_points, line_of_points, slope_of_points
from squealbox.transient.lanes.taylor import ends_near_zero, grow, reach, ready, surely_slips
from squealbox.transient.lanes.taylor_events import step_end

@inner
def evaluate(A, b, lane):
    return series_at(A, b)

@inner
def add_works(A, b, lane):
    return works_at(A, b)
"""
FEW = 12  # coefficients that are copied one by one
FROM_THE_MARCH = ("pulled", "chatters", "write_row")
OF_EVERY_KERNEL = ("tracing.py", "rough.py")
WRITERS = (*OF_EVERY_KERNEL, "series.py", "tables.py", "taylor.py", "taylor_events.py")
ROWS = (  # of a lane, by the names that kernels have for them
    "job alive t h t_end tries taken cautious code most first rtol window target tolerance trust resume events "
    "window_start window_events turns low low_phi high high_phi high_rate sample highest close pace t_old span "
    "since reversals flips eased gain trough peak q v start phi fresh end rate rate_end inner force zero own_g early "
    "early_rate q_old fastest value noise lowest v_old was done normal_end speed_end friction_end"
)
OTHERWISE = {
    "all": "", "acceleration": "a0", "breaks": "break0", "probe": "probe0_0", "slips": "s0", "opened": "open0",
    "hold": "h0_0", "next_sample": "next", "term": "term0_0", "slope": "slope_value0",
}  # fmt: skip
PLACES = {f"ROW_{name.upper()}": OTHERWISE.get(name, name) for name in (*ROWS.split(), *OTHERWISE)}


COUNTS = (
    "DOFS", "CONTACTS", "FUNCTIONS", "GIVEN", "ALL_ROWS", "BREAKS", "ROW_OBSERVED", "MEMORY",
)  # fmt: skip
OF_A_SHAPE = {
    **_engine.FORMULAS, **dict.fromkeys((*PLACES, *COUNTS), WHOLE),
    **{name: each.kind for name, each in vars(of_a_shape).items() if isinstance(each, OfAnotherText)},
}  # fmt: skip


@cache
def lane_kernel(shape: Shape) -> Compiled:
    """`service.run`, compiled for one shape at first use, then read from disk."""
    return Compiled(service_text(features(shape)), "run", _text(shape))


def features(shape: Shape) -> tuple[tuple[str, float], ...]:
    """What of a shape its service is compiled for."""
    found: dict[str, float] = {
        "WITH_EVENTS": shape.exact, "SAMPLES": shape.samples, "WIDTH": shape.lanes,
        "RECORDED": shape.recorded, "SHARES": PARTS if shape.taylor else 1, "STAGED": shape.staged,
        "SERIES": shape.taylor, "TRIES": shape.exact and not shape.taylor, "SIMPLE": shape.simple,
        "STEPPED": shape.stepped, "p.rigid[]": 0, "p.rigid_count": 0,
    }  # fmt: skip
    found |= {} if shape.varying else {"p.varying": 0}
    found |= {} if shape.kinds else {"p.light": 0}
    found |= {} if shape.smooth else {"p.smooth[]": 0}
    found |= {"TERMS": ORDER + 2, "UNIT_OF_WINDOW": UNIT_OF_WINDOW} if shape.taylor else Step.constants(shape)
    return tuple(found.items())


@cache
def service_text(features: tuple[tuple[str, float], ...]) -> str:
    """The text of the passes over one lane, for all shapes with such features, from disk where it was made before."""
    return _engine.kept_text(f"service {features}", lambda: service_source(features))


def service_source(features: tuple[tuple[str, float], ...]) -> str:
    """That text; what belongs to a shape is elsewhere."""
    fixed = dict(features)
    exact, staged = fixed["WITH_EVENTS"], fixed["STAGED"]
    head = _engine.HEADER.format(decorators="")
    parts = [head, SERVICE.format(digest=digest(("tracing.py",))), _engine.elsewhere(OF_A_SHAPE)]
    for module in (_motion, *((_rigid, _sharing, _impacts, _modes, _events) if exact else ())):
        parts += _engine.definitions(module, fixed)
    kept = ("COMPLETED", "TENSION", "SAMPLED", *(f"@inner\ndef {name}(" for name in FROM_THE_MARCH))
    parts += [text for text in _engine.definitions(_march, fixed) if text.lstrip("(").startswith(kept)]
    needed = {roots: fixed["TRIES"], crossing: fixed["TRIES"], alone: fixed["SIMPLE"]}
    needed |= {_runge_kutta: fixed["STEPPED"] or staged, samples: True, recording: fixed["RECORDED"]}
    needed |= {stages_again: staged}
    for module in (*(each for each, used in needed.items() if used), service):
        parts += _engine.definitions(module, fixed, entries=("run",))
    return "\n\n".join(parts) + "\n"


def _text(shape: Shape) -> str:
    """What belongs to a shape, from disk where it was made before; not with observers that are the user's functions."""
    asked = [(each.update.__module__, getattr(each.update, "__qualname__", "<>")) for each in shape.observers]
    if any(not module.startswith("squealbox.transient.") or "<" in name for module, name in asked):
        return source(shape)
    watched = [each._replace(update=name) for each, name in zip(shape.observers, asked, strict=True)]
    told = {each.name: getattr(shape, each.name) for each in fields(shape)}
    told |= {"present": sorted(shape.present), "observers": watched}
    if not shape.taylor:
        rule = tableau(shape.tableau)
        told["rule"] = [each if each is None else each.tobytes() for each in (rule.a, rule.b, rule.c, rule.e, rule.e3)]
    return _engine.kept_text(repr(told), lambda: source(shape))


def source(shape: Shape) -> str:
    """The text of what belongs to a shape: its step, laws and schedules, and the places of its rows."""
    rows = layout(shape)
    smooth = {kind - 1 for kind in shape.smooth if kind > 0}
    laws = {kind for kind, _ in shape.laws}
    schedules = {kind for terms in shape.signals for kind, _ in terms} | {SCHEDULES.index(Constant)}
    first = rows.places["o0_0_0"] if shape.observers else 0
    counts = (
        shape.n, shape.m, shape.functions, len(parameter_rows(shape)), len(rows), shape.breaks, first,
        len(rows) - first if first else 0,
    )  # fmt: skip
    places = {name: rows.places.get(row, rows.places.get(f"{row}0", 0)) for name, row in PLACES.items()} | dict(
        zip(COUNTS, counts, strict=True)
    )
    if shape.recorded and shape.taylor:
        places["ROW_TERM"] = rows.places[f"term0_{shape.followed[0]}"]
    head = HEAD.format(
        lanes=shape.lanes,
        digest=digest(WRITERS if shape.taylor else OF_EVERY_KERNEL),
        more=SERIES if shape.taylor else "",
    )
    parts = [
        _engine.laws_and_schedules(shape.own, laws=laws, schedules=schedules, smooth=smooth),
        head,
        "\n".join(f"{name} = {value}" for name, value in places.items()),
        *formulas(shape),
        (TaylorStep if shape.taylor else Step)(shape).text(),
        _gather(shape, rows.places),
        _observers(shape, rows.places),
    ]
    parts += _one_contact(shape, rows.places) if shape.simple else []
    return "\n\n".join(parts) + "\n"


def digest(names: tuple[str, ...]) -> str:
    """Of the modules that write a kernel's instructions and whose texts are not in the generated file."""
    texts = [(Path(__file__).parent / name).read_bytes() for name in names]
    return hashlib.sha256(b"".join(texts)).hexdigest()[:20]


def _gather(shape: Shape, places: dict[str, int]) -> str:
    """Text of `gather(A, b, lane, p, s)`: a lane's parameters into the records of the scalar march."""
    lines = ["@inner", "def gather(A, b, lane, p, s):"]

    def put(target: str, name: str) -> None:
        if name in places:
            lines.append(f"    {target} = A[b + {places[name] * shape.lanes} + lane]")

    n, m = shape.n, shape.m
    for name in ("mk", "mc"):
        for i in range(n):
            for j in range(n):
                put(f"p.{name}[{i}, {j}]", f"{name}{i}_{j}")
    for name in ("md", "mw", "d", "t", "s", "n", "w"):
        for c in range(m):
            for i in range(n):
                put(f"p.{name}[{c}, {i}]", f"{name}{c}_{i}")
    for c in range(m):
        for e in range(m):
            put(f"p.g[{c}, {e}]", f"g{c}_{e}")
        lines += _numbers(f"p.law_coefficients[{c}, {{}}]", f"law{c}_", shape.laws[c][1], shape, places)
        if shape.along(c):
            put(f"p.static[{c}]", f"law{c}_0")
        else:
            lines.append(f"    p.static[{c}] = 0.0")
    put("p.smoothing", "width")
    put("p.window", "window")
    lines += _signals(shape, places)
    return "\n".join([*lines, "    return"]) + "\n"


def _one_contact(shape: Shape, places: dict[str, int]) -> list[str]:
    """Text of what `alone` asks of one contact of a lane: normal force, speed, rate, limit, and impulses."""

    def at(name: str) -> str:
        return f"A[b + {places[name] * shape.lanes} + lane]"

    def along(c: int, rows: str, states: str, sign: str = "+") -> str:
        pairs = [(f"{rows}{c}_{i}", f"{states}{i}") for i in range(shape.n) if f"{rows}{c}_{i}" in places]
        return "".join(f" {sign} {at(row)} * {at(state)}" for row, state in pairs)

    def value(c: int, name: str) -> str:
        return at(f"{name}{c}") if f"{name}{c}" in places else "0.0"

    def scale(c: int, states: str = "v") -> str:
        pairs = [(f"t{c}_{i}", f"{states}{i}") for i in range(shape.n) if f"t{c}_{i}" in places]
        return "".join(f" + abs({at(row)} * {at(state)})" for row, state in pairs)

    answers = {
        "contact_normal": lambda c: value(c, "N0") + along(c, "n", "q"),
        "contact_speed": lambda c: value(c, "V") + along(c, "t", "v", "-"),
        "speed_scale": lambda c: f"abs({value(c, 'V')})" + scale(c),
        "slip_rate": lambda c: "0.0" + along(c, "t", "a", "-"),
        "rate_scale": lambda c: "1e-300" + scale(c, "a"),
        "contact_static": lambda c: at(f"law{c}_0"),
    }
    texts = []
    for name, answer in answers.items():
        lines = [f"    if c == {c}:\n        return {answer(c)}" for c in range(shape.m)]
        texts.append("\n".join(["@inner", f"def {name}(A, b, lane, c):", *lines, "    return np.nan"]))
    for name, states in (("push", "a"), ("stop", "v")):
        lines = [f"@inner\ndef {name}(A, b, lane, c, x):"]
        for c in range(shape.m):
            lines.append(f"    if c == {c}:\n        x = 1.0 * x")
            lines += [f"        {at(f'{states}{i}')} += {at(f'md{c}_{i}')} * x"
                      for i in range(shape.n) if f"md{c}_{i}" in places]  # fmt: skip
        texts.append("\n".join(lines))
    return texts


def _signals(shape: Shape, places: dict[str, int]) -> list[str]:
    n, m, lines = shape.n, shape.m, []
    if not shape.varying:
        names = [f"V{c}" for c in range(m)] + [f"N0{c}" for c in range(m)] + [f"f{i}" for i in range(n)]
        for index, name in enumerate(names):
            if name in places:
                lines.append(f"    s.signal[{index}] = A[b + {places[name] * shape.lanes} + lane]")
        return lines
    for index, terms in enumerate(shape.signals[: 2 * m + n]):
        for k, (_, count) in enumerate(terms):
            at = f"p.signal_start[{index}] + {k}"
            lines.append(f"    p.term_weight[{at}] = A[b + {places[f'weight{index}_{k}'] * shape.lanes} + lane]")
            lines += _numbers(f"p.term_coefficients[{at}, {{}}]", f"given{index}_{k}_", count, shape, places)
    return lines


def _numbers(target: str, name: str, count: int, shape: Shape, places: dict[str, int]) -> list[str]:
    """Text that copies the rows name0, name1, ...; in a loop where they are many, as those of a table."""
    if count > FEW:
        copied = f"{target.format('i')} = A[b + ({places[f'{name}0']} + i) * {shape.lanes} + lane]"
        return [f"    for i in range({count}):", f"        {copied}"]
    rows = [places[f"{name}{i}"] * shape.lanes for i in range(count)]
    return [f"    {target.format(i)} = A[b + {row} + lane]" for i, row in enumerate(rows)]


def _observers(shape: Shape, places: dict[str, int]) -> str:
    """Text of `set_observers(A, b, lane, fixed)`: memory and coefficients at the start of a job."""
    lines = ["@inner", "def set_observers(A, b, lane, fixed):"]
    at = 3 + len(parameter_rows(shape))
    for k, observer in enumerate(shape.observers):
        for i in range(shape.copies(observer)):
            for j, value in enumerate(observer.start):
                number = repr(float(value)).replace("inf", "np.inf").replace("nan", "np.nan")
                lines.append(f"    A[b + {places[f'o{k}_{i}_{j}'] * shape.lanes} + lane] = {number}")
            for j in range(observer.coefficients):
                lines.append(f"    A[b + {places[f'c{k}_{i}_{j}'] * shape.lanes} + lane] = fixed[{at + j}]")
        at += observer.coefficients
    return "\n".join([*lines, "    return"]) + "\n"

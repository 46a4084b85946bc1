"""Plain functions run by Python and as machine code of the house: the same bits; and one engine of any width."""

import ast
import math

import numpy as np
import pytest

from squealbox import Coulomb, DrumBrake, LinearSlope, MassOnBelt, Stribeck, simulate, simulate_ensemble
from squealbox.compiled.kinds import Untranslatable
from squealbox.compiled.machine import Compiled
from squealbox.files.own_law import own_law
from squealbox.transient import _engine
from squealbox.transient.lanes import single
from squealbox.transient.lanes.kernel import lane_kernel

MAKERS = "import numpy as np\n\nSHARES = (0.0, 4.0, -6.0)\n\n"
TEXTS = {
    "choices": """
@entry
def choices(x, k):
    y = 0
    if 0.0 < x < 1.0 or (k > 2 and not x > 5.0):
        y = 1.5 * x
    elif k % 3 == 1:
        y = k // 2 - x ** 2
    return y + (2.0 if x < 0.0 else k), min(x, 1.0, k), max(k, 2), abs(-x)
""",
    "loops": """
@inner
def term(x, k):
    return x ** k / (1.0 + k), k % 2 == 0

@entry
def loops(x, k):
    total = 0.0
    for i in range(k, -1, -1):
        value, even = term(x, i)
        if even and i == 4:
            continue
        if value > 1e6:
            break
        total += value
    n = 0
    while True:
        n += 1
        total = 0.5 * total + SHARES[n % 3]
        if n > k:
            return total, n, total > 0.0
""",
    "functions": """
@entry
def functions(x, k):
    a = np.sqrt(abs(x)) + np.exp(-x * x) + np.sin(x) * np.cos(k) + np.arctan(x) + np.tanh(x)
    b = np.minimum(np.maximum(x, 0.0), 1.0) + np.where(x > k, x, 2.0 * k) + np.sign(x)
    return a, b, np.isfinite(x / 0.0), np.nextafter(x, np.inf), int(x) + float(k), k // -3, k % -3
""",
}


@pytest.mark.parametrize("name", TEXTS)
def test_machine_code_gives_the_bits_of_python(name):
    text = MAKERS + TEXTS[name]
    plain: dict = {"entry": lambda f: f, "inner": lambda f: f}
    exec(text, plain)
    compiled = Compiled(text, name)
    for x in (-2.7, -0.3, 0.0, 0.4, 1.0, 3.3, 40.0):
        for k in (-5, 0, 1, 2, 3, 7):
            with np.errstate(all="ignore"):
                wanted = plain[name](np.float64(x), k)
            assert compiled(x, k) == pytest.approx(wanted, rel=1e-15, nan_ok=True)


def test_records_and_arrays_are_written_in_place():
    kind = np.dtype([("count", "i8"), ("size", "f8"), ("grid", "f8", (2, 3))])
    record, rows = np.zeros(1, dtype=kind), np.arange(6.0).reshape(3, 2)
    text = """
@inner
def put(row, r, k):
    for j in range(row.shape[0]):
        r.grid[j, k] += row[j]

@entry
def fill(r, rows):
    for k in range(rows.shape[0]):
        put(rows[k], r, k)
        r.count += 1
    r.size = rows[-1, 0] * r.grid.shape[1]
"""
    assert Compiled(text, "fill")(record, rows) is None
    assert record["grid"][0].tolist() == rows.T.tolist()
    assert (record["count"][0], record["size"][0]) == (3, 12.0)


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("return [x]", "List"),
        ("return print(x)", "print"),
        ("return np.sort(x)", "numpy.sort"),
        ("return nothing + x", "nothing"),
        ("return f(x, scale=2.0)", "by name"),
        ("y = x[0]\n    return y", "element"),
    ],
)
def test_what_is_not_plain_is_named_with_its_line(line, said):
    with pytest.raises(Untranslatable, match=said) as caught:
        Compiled(f"import numpy as np\n\n@entry\ndef f(x):\n    {line}\n", "f")(1.0)
    assert "in f, `" in str(caught.value)


ASKS = """
from squealbox.compiled.kinds import OfAnotherText

ROOM = OfAnotherText("ROOM", "i")
other = OfAnotherText("other", "f")

@entry
def asks(x):
    return other(x, 2) + other(x, 3) + ROOM, ROOM // 2
"""


def test_texts_that_are_joined_share_what_they_have_in_common(monkeypatch, tmp_path):
    monkeypatch.setenv("SQUEALBOX_CACHE", str(tmp_path))
    for room, sign, count in ((3, "+", 2), (5, "-", 3), (5, "-", 3)):
        rest = f"ROOM = {room}\n\n@inner\ndef other(x, k):\n    return x {sign} k\n"
        asks = Compiled(ASKS, "asks", rest)
        assert asks.ready(1.0) == (count == len(list(tmp_path.iterdir())))
        assert asks(10.0) == ((25.0 + room, room // 2) if sign == "+" else (15.0 + room, room // 2))
        assert asks.ready(1.0)
        assert len(list(tmp_path.glob("*.code"))) == count


def test_what_another_text_lacks_is_said():
    with pytest.raises(Untranslatable, match="other is asked for by another text, and not here"):
        Compiled(ASKS, "asks", "ROOM = 2\n")(1.0)
    with pytest.raises(Untranslatable, match="other returns a whole number, and a number is asked for"):
        Compiled(ASKS, "asks", "ROOM = 2\n\n@inner\ndef other(x, k):\n    return k\n")(1.0)


def test_a_new_law_compiles_its_step_alone(monkeypatch, tmp_path):
    monkeypatch.setenv("SQUEALBOX_CACHE", str(tmp_path))
    made = {}
    for law in (Coulomb(0.4), Stribeck(0.4, 0.3, 0.5)):
        single.KEPT.clear()
        lane_kernel.cache_clear()
        assert simulate(MassOnBelt(friction=law), 1.0).outcome == "completed"
        made[law] = {path.name for path in tmp_path.glob("*.code")}
    first, both = made.values()
    assert (len(first), len(both)) == (2, 3)
    assert first < both


def test_a_single_run_is_the_lane_of_an_ensemble_to_the_bit():
    frictions = [0.2, 0.37, 0.44]
    brake = DrumBrake(friction=LinearSlope(0.44, -0.05), reading="consistent")
    many = simulate_ensemble(brake, {"friction.static": frictions}, 0.02)
    for k, mu in enumerate(frictions):
        one = simulate(brake.replace({"friction.static": mu}), 0.02)
        assert one.settings["tableau"] == many.settings["tableau"] == "taylor"
        assert (one.steps, len(one.event_time)) == (many.steps[k], many.events[k])
        assert np.array_equal(one.q[-1], many.q[k])
        assert np.array_equal(one.qd[-1], many.qd[k])
    assert many.events[2] > 100


def test_rows_of_a_taylor_run_are_dense_and_its_audit_closes():
    motion = simulate(DrumBrake(friction=LinearSlope(0.3, -0.05)), 0.01)
    fine = simulate(
        DrumBrake(friction=LinearSlope(0.3, -0.05)), 0.01, times=motion.t, method="dormand-prince-8", rtol=1e-12
    )
    assert len(motion.t) > 1.2 * motion.steps  # long steps are told in parts
    assert np.max(np.abs(motion.q - fine.q)) < 1e-8 * np.max(np.abs(fine.q))
    assert np.max(np.abs(motion.work_friction - fine.work_friction)) < 1e-8 * np.max(np.abs(fine.work_friction))
    assert motion.energy.relative_residual < 1e-8


def test_what_has_no_series_is_run_by_another_method():
    assert simulate(MassOnBelt(friction=Coulomb(0.3)), 0.01, contact="raw").settings["tableau"] == "dormand-prince-8"
    rooted = own_law("def mu(v, p): return 0.4 - 0.02 * np.sqrt(v)")
    assert simulate(MassOnBelt(friction=rooted), 0.05).outcome == "completed"
    assert simulate(MassOnBelt(friction=Coulomb(0.3)), 0.01).settings["tableau"] == "taylor"
    assert math.isclose(simulate(MassOnBelt(friction=Coulomb(0.3)), 0.01).settings["rtol"], 1e-10)


def test_a_row_of_a_lane_is_spelled_as_its_place():
    """A kernel says `lane.q[i]`; what is compiled finds it in the array of the group."""
    said = """
def moved(lane, o):
    lane.q[2 * o + 1] += lane.t
    return moved(Lane(B, 8 * o, 3), o) + Lane(B, 0, 0).v[o]
"""
    spelled = ast.unparse(_engine._Spelled().visit(ast.parse(said)))
    assert spelled.splitlines() == [
        "def moved(A, b, lane, o):",
        "    A[b + (ROW_Q + 2 * o + 1) * WIDTH + lane] += A[b + ROW_T * WIDTH + lane]",
        "    return moved(B, 8 * o, 3, o) + B[0 + (ROW_V + o) * WIDTH + 0]",
    ]

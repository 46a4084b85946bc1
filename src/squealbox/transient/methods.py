"""Integration methods as data: a Butcher tableau, its error weights and its dense output, over one Runge-Kutta loop."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from squealbox.parameters import ParameterError, known_names
from squealbox.registers import later, names_in
from squealbox.transient import _dop853, tableaux

TAYLOR = "taylor"  # the solution's own series
ELSEWHERE = {  # what other programs call them
    "rk23": "bogacki-shampine", "bs3": "bogacki-shampine", "rk45": "dormand-prince", "dopri5": "dormand-prince",
    "tsit5": "tsitouras", "dop853": "dormand-prince-8",
}  # fmt: skip
USUAL_RTOL = 1e-10  # of a series; that of a tableau stands in it


@dataclass(frozen=True, eq=False)
class Tableau:
    """An explicit embedded Runge-Kutta pair. Source: Hairer, Norsett and Wanner 1993, Solving ODEs I, II.4 to II.6.

    With S stages a step is y1 = y + h sum_i b_i k_i. The stage after them, k_S = f(t + h, y1), serves the error, the
    dense output and the next step. a (R, R), c (R,) cover R >= S + 1 stages; those after S serve the dense output only.
    e and e3 (S + 1,) weigh the stages for the error of order `error_order`; p (R, degree) gives the dense output
    y(t + theta h) = y + h sum_i k_i sum_j p_ij theta^(j + 1). growth limits how much longer the next step may be.
    safety is the share of the step that would just be accepted which a lane takes: the error of a high order swings by
    decades within a vibration, so at 0.9 a third of the steps would be tried in vain. easing is the power to which the
    error of the step before counts (Gustafsson 1991), where that saves trials.
    """

    name: str
    title: str
    source: str
    order: int
    error_order: int
    a: Any
    b: Any
    c: Any
    e: Any
    p: Any
    e3: Any = None
    growth: float = 10.0
    safety: float = 0.87
    easing: float = 0.4
    rtol: float = 1e-8  # the usual one

    @property
    def stages(self) -> int:
        """Number S of stages of a step."""
        return len(self.b)


@dataclass(frozen=True)
class Method:
    """An algorithm with its tolerances.

    tableau : name, one of `TABLEAUX`
    rtol : relative tolerance of each displacement and velocity in a step [-]; None takes the usual one of the method
    atol : absolute tolerance of a velocity [m/s]; that of a displacement is atol / (highest angular frequency). None
        takes 1e-3 rtol times the fastest sliding speed; where nothing slides (below 1e-12 m/s) times the speed that
        start and load lead to, or 1 m/s without any. An array of 2n values [m, m/s] is taken as it is.
    first_step, largest_step [s] : None leaves them to the program
    most_steps : tried steps after which a run ends as "step_limit"
    """

    tableau: str = "dormand-prince-8"
    rtol: Any = None
    atol: Any = None
    first_step: float | None = None
    largest_step: float | None = None
    most_steps: int = 2_000_000

    def __post_init__(self) -> None:
        if self.tableau not in (*TABLEAUX, TAYLOR):
            word = str(self.tableau)
            asked = ELSEWHERE.get(word.lower(), word)
            raise ParameterError("Method", "tableau", self.tableau, known_names(asked, [*TABLEAUX, TAYLOR]))
        if self.rtol is None:
            usual = USUAL_RTOL if self.tableau == TAYLOR else TABLEAUX[self.tableau]().rtol
            object.__setattr__(self, "rtol", usual)
        if not 1e-15 <= self.rtol < 1.0:
            raise ParameterError("Method", "rtol", self.rtol, "a number in [1e-15, 1)")
        for name in ("first_step", "largest_step"):
            value = getattr(self, name)
            if value is not None and not 0.0 < value < np.inf:
                raise ParameterError("Method", name, value, "a finite number in (0, inf) s, or None")
        good = self.atol is None or (
            np.ndim(self.atol) < 2 and np.all(np.isfinite(self.atol)) and np.all(np.asarray(self.atol) > 0.0)
        )
        if not good:
            raise ParameterError("Method", "atol", self.atol, "finite numbers in (0, inf), one or a list, or None")
        if not self.most_steps >= 1:
            raise ParameterError("Method", "most_steps", self.most_steps, "a whole number of at least 1")


@cache
def bogacki_shampine() -> Tableau:
    """Bogacki and Shampine's 3(2) pair, Applied Mathematics Letters 2(4), 321-325 (1989), used in 2011."""
    a = _lower([[], [1 / 2], [0, 3 / 4], [2 / 9, 1 / 3, 4 / 9]])
    p = np.array([[1, -4 / 3, 5 / 9], [0, 1, -2 / 3], [0, 4 / 3, -8 / 9], [0, -1, 1]])
    e = np.array([5 / 72, -1 / 12, -1 / 9, 1 / 8])
    source = "Bogacki & Shampine 1989"
    return Tableau("bogacki-shampine", "Bogacki-Shampine 3(2)", source, 3, 2, a, a[3, :3], a.sum(1), e, p, rtol=1e-6)


@cache
def dormand_prince() -> Tableau:
    """Dormand and Prince's 5(4) pair, Journal of Computational and Applied Mathematics 6, 19-26 (1980).

    The dense output of order 4 is Shampine's, Mathematics of Computation 46, 135-150 (1986).
    """
    a = _lower([
        [],
        [1 / 5],
        [3 / 40, 9 / 40],
        [44 / 45, -56 / 15, 32 / 9],
        [19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729],
        [9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656],
        [35 / 384, 0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84],
    ])  # fmt: skip
    e = np.array([-71 / 57600, 0, 71 / 16695, -71 / 1920, 17253 / 339200, -22 / 525, 1 / 40])
    p = np.array([
        [1, -8048581381 / 2820520608, 8663915743 / 2820520608, -12715105075 / 11282082432],
        [0, 0, 0, 0],
        [0, 131558114200 / 32700410799, -68118460800 / 10900136933, 87487479700 / 32700410799],
        [0, -1754552775 / 470086768, 14199869525 / 1410260304, -10690763975 / 1880347072],
        [0, 127303824393 / 49829197408, -318862633887 / 49829197408, 701980252875 / 199316789632],
        [0, -282668133 / 205662961, 2019193451 / 616988883, -1453857185 / 822651844],
        [0, 40617522 / 29380423, -110615467 / 29380423, 69997945 / 29380423],
    ])  # fmt: skip
    source = "Dormand & Prince 1980; Shampine 1986"
    return Tableau("dormand-prince", "Dormand-Prince 5(4)", source, 5, 4, a, a[6, :6], a.sum(1), e, p)


@cache
def tsitouras() -> Tableau:
    """Tsitouras' 5(4) pair, Computers & Mathematics with Applications 62, 770-775 (2011)."""
    a = _lower([
        [],
        [0.161],
        [-0.008480655492356989, 0.335480655492357],
        [2.8971530571054935, -6.359448489975075, 4.3622954328695815],
        [5.325864828439257, -11.748883564062828, 7.4955393428898365, -0.09249506636175525],
        [5.86145544294642, -12.92096931784711, 8.159367898576159, -0.071584973281401, -0.028269050394068383],
        [0.09646076681806523, 0.01, 0.4798896504144996, 1.379008574103742, -3.290069515436081, 2.324710524099774],
    ])  # fmt: skip
    e = np.array([
        -0.00178001105222577714, -0.0008164344596567469, 0.007880878010261995, -0.1447110071732629,
        0.5823571654525552, -0.45808210592918697, 1 / 66,
    ])  # fmt: skip
    p = np.array([
        [1, -2.763706197274826, 2.9132554618219126, -1.0530884977290216],
        [0, 0.1317, -0.2234, 0.1017],
        [0, 3.9302962368947516, -5.941033872131505, 2.490627285651253],
        [0, -12.411077166933676, 30.33818863028232, -16.548102889244902],
        [0, 37.50931341651104, -88.1789048947664, 47.37952196281928],
        [0, -27.896526289197286, 65.09189467479366, -34.87065786149661],
        [0, 1.5, -4, 2.5],
    ])  # fmt: skip
    return Tableau("tsitouras", "Tsitouras 5(4)", "Tsitouras 2011", 5, 4, a, a[6, :6], a.sum(1), e, p)


@cache
def dormand_prince_8() -> Tableau:
    """Dormand and Prince's 8(5,3), with the dense output of order 7 of the program DOP853."""
    size = len(_dop853.C)
    a = np.array([_row(row, size) for row in _dop853.A])
    e3, e5 = (_row(row, 13) for row in _dop853.E3_E5)
    b = a[12, :12]
    c = np.array(_dop853.C)
    p = _nested_dense(a[12], np.array([_row(row, size) for row in _dop853.D]))
    source, more = "Hairer, Norsett & Wanner 1993", {"e3": e3, "safety": 0.8, "easing": 0.0, "rtol": 3e-10}
    return Tableau("dormand-prince-8", "Dormand-Prince 8(5,3)", source, 8, 7, a, b, c, e5, p, **more)


TABLEAUX: dict[str, Callable[[], Tableau]] = {
    "bogacki-shampine": bogacki_shampine,
    "dormand-prince": dormand_prince,
    "tsitouras": tsitouras,
    "dormand-prince-8": dormand_prince_8,
    **{name.replace("_", "-"): later("squealbox.transient.tableaux", name) for name in names_in(tableaux)},
}


def tableau(name: str) -> Tableau:
    """The tableau of that name; an unknown name is a `ParameterError` that lists the known ones."""
    if name not in TABLEAUX:
        raise ParameterError("Method", "tableau", name, known_names(str(name), list(TABLEAUX)))
    return TABLEAUX[name]()


def _lower(rows: list[list[float]]) -> Any:
    a = np.zeros((len(rows), len(rows)))
    for i, row in enumerate(rows):
        a[i, : len(row)] = row
    return a


def _row(entries: dict[int, float], size: int) -> Any:
    row = np.zeros(size)
    row[list(entries)] = list(entries.values())
    return row


def _nested_dense(b: Any, d: Any) -> Any:
    """DOP853's x (F0 + (1-x) (F1 + x (F2 + (1-x) (F3 + ... )))) as powers of x, for each stage."""
    first = np.eye(len(b))[0]
    last = np.eye(len(b))[12]
    levels = [b, first - b, 2.0 * b - last - first, *d]
    total = np.zeros((len(b), 1))
    for i, level in enumerate(reversed(levels)):
        total[:, 0] += level
        factor = np.array([0.0, 1.0]) if i % 2 == 0 else np.array([1.0, -1.0])
        total = np.array([np.convolve(row, factor) for row in total])
    return total[:, 1:]

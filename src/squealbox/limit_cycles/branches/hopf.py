"""Where a cycle is born: the Hopf point of steady sliding and the first Lyapunov coefficient.

At x0 with A q = i w q, A' p = -i w p, <q, q> = <p, q> = 1 and f(x0 + u) = A u + B(u, u)/2 + C(u, u, u)/6 + ...

    l1 = 1/(2 w) Re[<p, C(q, q, qc)> - 2 <p, B(q, A^-1 B(q, qc))> + <p, B(qc, (2 i w - A)^-1 B(q, q))>]

(Kuznetsov 2004, Elements of Applied Bifurcation Theory, Eq. 5.62). z' = lambda(p) z + w l1 z |z|^2 on the centre
manifold, so cycles exist where Re lambda'(p) (p - p0) / l1 < 0, with u = 2 Re(z q) and
|z|^2 = -Re lambda'(p) (p - p0) / (w l1). l1 < 0: supercritical, stable cycles grow softly; l1 > 0: subcritical, an
unstable cycle guards steady sliding and the motion jumps.

For sliding contacts F = s mu(s v) N with dN = n.u, dv = -t.u', so

    B(x, y)    = sum M^-1 d [mu' (dN_x dv_y + dN_y dv_x) + s mu'' N dv_x dv_y]
    C(x, y, z) = sum M^-1 d [s mu'' (dN_x dv_y dv_z + ...) + mu''' N dv_x dv_y dv_z]
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from squealbox.arguments import public
from squealbox.family import Bounds, DesignOrRecipe, Family, Varied, kept_unit
from squealbox.friction import Table
from squealbox.limit_cycles.cycles.field import Field
from squealbox.limit_cycles.cycles.starting import steady_state
from squealbox.result import COMPLETED, Array, Outcome, Result, quantity
from squealbox.schedules import value_at
from squealbox.stability import OneEigenvalue, critical_value
from squealbox.system import as_system


@dataclass(frozen=True, kw_only=True, eq=False)
class HopfPoint(OneEigenvalue, Result):
    """A Hopf point, as :func:`hopf_point` returns it; NaN where the outcome is not "completed"."""

    value: Any = quantity("", "", "value of the parameter, in its own unit")
    eigenvalue: Any = quantity("", "1/s", "eigenvalue on the boundary")
    shape: Array = quantity("state", "1", "q of the state (q, q') with |q| = 1")
    steady: Array = quantity("state", "m", "steady sliding (q, 0)")
    lyapunov: Any = quantity("", "1", "first Lyapunov coefficient l1; its sign is what matters")
    growth_slope: Any = quantity("", "1/s", "dRe lambda/dp, per unit of the parameter")
    frequency_slope: Any = quantity("", "rad/s", "dIm lambda/dp, per unit of the parameter")
    parameter: str = ""
    caution: str = ""

    @property
    def kind(self) -> str:
        """Supercritical, subcritical, degenerate (|l1| lost in round-off), or unknown (a law known by points only)."""
        if not np.isfinite(self.lyapunov) or self.caution:
            return "unknown"
        size = float(np.max(np.abs(self.shape)))
        if abs(self.lyapunov) < 1e-10 * size:
            return "degenerate"
        return "supercritical" if self.lyapunov < 0.0 else "subcritical"

    def amplitude(self, value: ArrayLike) -> Any:
        """Predicted amplitude [m] of each degree of freedom at parameter values; NaN on the side without cycles."""
        square = -self.growth_slope * (np.asarray(value) - self.value) / (self.angular_frequency * self.lyapunov)
        half = len(self.shape) // 2
        with np.errstate(invalid="ignore"):
            return 2.0 * np.sqrt(square)[..., None] * np.abs(self.shape[:half])

    def beside(self, size: float) -> float:
        """Parameter value at which the largest predicted amplitude is `size` [m]."""
        half = len(self.shape) // 2
        square = (0.5 * size / float(np.max(np.abs(self.shape[:half])))) ** 2
        return float(self.value - square * self.angular_frequency * self.lyapunov / self.growth_slope)

    @property
    def first_rest(self) -> float:
        """The parameter value up to which all contacts keep sliding on the predicted cycle; NaN where none stops it.

        A contact comes to rest where the swing of its sliding velocity, w |t.u| times the amplitude, is its speed. Up
        to there the kind of the Hopf point tells what is met; beyond, sticking decides.
        """
        system, half = as_system(self.inputs["system"]), len(self.shape) // 2
        u = self.shape[:half] / float(np.max(np.abs(self.shape[:half])))
        swings = [(abs(float(value_at(c.V, 0.0))), abs(self.angular_frequency * (c.t @ u))) for c in system.contacts]
        sizes = [speed / swing for speed, swing in swings if swing > 0.0 and speed > 0.0]
        return self.beside(min(sizes)) if sizes and self.kind in ("supercritical", "subcritical") else float("nan")

    def summary(self) -> str:
        """One line: where, at which frequency, of which kind, and how far its contacts keep sliding."""
        return self.told()

    def told(self, digits: int = 10) -> str:
        """The `summary`, with so many digits [-] of values of the parameter."""
        if not self.outcome.ok:
            return f"{self.parameter}: {self.outcome.told}"
        kind = "Hopf point of unknown kind" if self.kind == "unknown" else f"{self.kind} Hopf point"
        place, rest = (self.read_value(self.parameter, value, digits) for value in (self.value, self.first_rest))
        said = f"{kind} at {self.parameter} = {place}, {self.frequency:.6g} Hz"
        if np.isfinite(self.first_rest):
            said += f"; on its cycle contacts keep sliding as far as {rest}"
        return f"{said}; {self.caution}" if self.caution else said


@public()
def hopf_point(design: DesignOrRecipe, parameter: Varied, bounds: Bounds | None = None) -> HopfPoint:
    """The first Hopf point between `bounds` and the kind of cycle born there.

    Parameters
    ----------
    design : a design, or a function of one value that returns a design or system
    parameter, bounds : {name: (low, high)} in the parameter's own unit, such as {"friction.static": (0.1, 0.6)}; or the
        name and the bounds one after the other

    Outcome "no_hopf" where stability does not change by a complex pair, else that of `critical_value`. Accuracy: value
    as `critical_value`; l1 to about 1e-7, limited by the law's second and third derivative, taken from a polynomial
    through its slope. Source: Kuznetsov 2004, Ch. 5.

    >>> from squealbox import DrumBrake, LinearSlope
    >>> hopf_point(DrumBrake(friction=LinearSlope(0.3, -0.05)), "friction.static", (0.1, 0.6)).kind
    'supercritical'
    """
    family = Family.within("hopf_point", design, parameter, bounds)
    make, parameter, bounds = family.system, family.name, family.spans[0]
    Field(make(bounds[0]))  # says at once where the system is none that this room can treat
    found = critical_value(design, parameter, bounds)
    outcome = found.outcome
    if outcome.ok and abs(np.imag(found.eigenvalue)) == 0.0:
        outcome = Outcome("no_hopf", "stability changes by a real eigenvalue: no cycle is born there")
    inputs = {"system": make(bounds[0])}
    settings = {"bounds": list(bounds), **kept_unit(design, parameter)}
    about: dict[str, Any] = {"parameter": parameter, "settings": settings}
    if not outcome.ok:
        nan = np.full(2 * make(bounds[0]).size, np.nan)
        none = np.asarray(np.nan)
        return HopfPoint(inputs=inputs, outcome=outcome, value=none, eigenvalue=none, shape=nan, steady=nan,
                         lyapunov=none, growth_slope=none, frequency_slope=none, **about)  # fmt: skip
    value = float(found.value)
    field = Field(make(value))
    eigenvalue, q, p, steady = critical_pair(field, abs(np.imag(found.eigenvalue)))
    step = 1e-4 * (bounds[1] - bounds[0])
    ahead, behind = (critical_pair(Field(make(value + s * step)), abs(eigenvalue.imag))[0] for s in (1.0, -1.0))
    slope = (ahead - behind) / (2.0 * step)
    return HopfPoint(
        inputs={"system": field.system}, outcome=Outcome(COMPLETED), value=np.asarray(value),
        eigenvalue=np.asarray(1j * eigenvalue.imag), shape=q, steady=steady,
        lyapunov=np.asarray(lyapunov_coefficient(field, steady, eigenvalue.imag, q, p)),
        growth_slope=np.asarray(slope.real), frequency_slope=np.asarray(slope.imag),
        caution=_tabulated(field), **about,
    )  # fmt: skip


def _tabulated(field: Field) -> str:
    """What points of a law do not say: its second and third derivative, on which the kind of the Hopf point rests."""
    if any(isinstance(law, Table) for law in field.laws):
        return (
            "the kind rests on the second and third derivative of mu, which points of a table do not give: they "
            "promise mu and about its slope; fit a law with a formula (fit_friction)"
        )
    return ""


def critical_pair(field: Field, frequency: float) -> tuple[complex, Any, Any, Any]:
    """Eigenvalue nearest to i frequency, right and left vector, steady state."""
    steady = steady_state(field)
    a = field.jacobian(steady, steady_modes(field, steady))
    values, right = np.linalg.eig(a)
    i = int(np.argmin(np.abs(values - 1j * frequency)))
    dual, left = np.linalg.eig(a.T)
    p = left[:, int(np.argmin(np.abs(dual - np.conj(values[i]))))]
    q = right[:, i] / np.linalg.norm(right[:, i])
    return complex(values[i]), q, p / np.conj(np.vdot(p, q)), steady


def steady_modes(field: Field, steady: np.ndarray) -> Any:
    """Modes of the contacts in steady sliding."""
    normal, speed = field.contact_state(steady)
    return np.where(field.unilateral & (normal <= 0.0), 2, np.where(speed >= 0.0, 1, -1))


def lyapunov_coefficient(field: Field, steady: np.ndarray, frequency: float, q: np.ndarray, p: np.ndarray) -> float:
    """l1 of the equation at the head of this module; `frequency` in rad/s, q and p its critical vectors."""
    normal, speed = field.contact_state(steady)
    closed = np.where(steady_modes(field, steady) == 2, 0.0, 1.0)
    sense = np.sign(speed)
    first, second, third = (closed * x for x in law_derivatives(field, speed))
    n = field.size

    def parts(u: np.ndarray) -> tuple[Any, Any]:
        return field.n @ u[:n], -field.t @ u[n:]

    def along(force: np.ndarray) -> Any:
        return np.concatenate([np.zeros(n, dtype=complex), force @ field.md])

    def bilinear(x: np.ndarray, y: np.ndarray) -> Any:
        (nx, vx), (ny, vy) = parts(x), parts(y)
        return along(first * (nx * vy + ny * vx) + sense * second * normal * vx * vy)

    def trilinear(x: np.ndarray, y: np.ndarray, z: np.ndarray) -> Any:
        (nx, vx), (ny, vy), (nz, vz) = parts(x), parts(y), parts(z)
        mixed = nx * vy * vz + ny * vx * vz + nz * vx * vy
        return along(sense * second * mixed + third * normal * vx * vy * vz)

    a = field.jacobian(steady, steady_modes(field, steady)).astype(complex)
    conj = np.conj(q)
    slow = np.linalg.solve(a, bilinear(q, conj))
    fast = np.linalg.solve(2j * frequency * np.eye(2 * n) - a, bilinear(q, q))
    total = np.vdot(p, trilinear(q, q, conj)) - 2.0 * np.vdot(p, bilinear(q, slow)) + np.vdot(p, bilinear(conj, fast))
    return float(total.real / (2.0 * frequency))


def law_derivatives(field: Field, speed: np.ndarray) -> tuple[Any, Any, Any]:
    """mu', mu'' and mu''' of each contact at its speed, from a polynomial through the slope at Chebyshev points."""
    from numpy.polynomial import chebyshev

    degree = 12
    points = np.cos(np.pi * (np.arange(degree + 1) + 0.5) / (degree + 1))
    radius = 0.2 * np.abs(speed)
    slopes = field.coefficients(np.abs(speed) + points[:, None] * radius)[1]
    series = chebyshev.chebfit(points, slopes, degree)
    return tuple(np.asarray(chebyshev.chebval(0.0, chebyshev.chebder(series, k) if k else series)) / radius**k
                 for k in range(3))  # fmt: skip

"""LuGre, Dahl and elasto-plastic friction: curves, hysteresis, pencil and motions against closed forms and SciPy."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from squealbox import (
    PID,
    Contact,
    Controlled,
    Coulomb,
    DrumBrake,
    Method,
    System,
    closed_loop,
    complex_modes,
    fit_friction,
    simulate,
    simulate_ensemble,
)  # fmt: skip
from squealbox.friction import Averaged, Dahl, ElastoPlastic, FrictionLaw, LuGre
from squealbox.limit_cycles import basin, bifurcation_diagram, harmonic_balance
from squealbox.parameters import ParameterError
from squealbox.schedules import Sinusoid
from squealbox.stability import mode_energy
from squealbox.system import InvalidSystem, linearise

LAWS = [
    LuGre(0.45, 0.3, 0.1, 1e4, 10.0, 0.05), Dahl(0.3, 1e4), Dahl(0.3, 1e4, 2),
    ElastoPlastic(0.45, 0.3, 0.1, 1e4, 10.0, 0.05, 0.6),
]  # fmt: skip


def named(law: FrictionLaw) -> str:
    return f"{type(law).__name__}{getattr(law, 'exponent', '')}"


def block(law: FrictionLaw, V: Any = 0.05, N: Any = 10.0, k: float = 100.0, load: float = 0.0) -> System:
    return System([[1.0]], [[0.2]], [[k]], [load], (Contact(n=[0.0], d=[1.0], t=[1.0], N0=N, V=V, law=law),))


def creep(law: FrictionLaw, v: float, z: float) -> float:
    """z' from the formulas of the papers, written out anew."""
    if isinstance(law, Dahl):
        return float(v * (1.0 - law.stiffness * z * np.sign(v) / law.kinetic) ** int(law.exponent))
    steady = (law.kinetic + (law.static - law.kinetic) * np.exp(-((v / law.speed) ** 2))) / law.stiffness
    share = 1.0
    if isinstance(law, ElastoPlastic):
        least = law.breakaway * law.kinetic / law.stiffness
        share = 0.0
        if np.sign(z) == np.sign(v) and abs(z) > least:
            middle = (abs(z) - 0.5 * (steady + least)) / (steady - least)
            share = 1.0 if abs(z) >= steady else 0.5 * np.sin(np.pi * middle) + 0.5
    return float(v - share * abs(v) * z / steady)


@pytest.mark.parametrize("law", LAWS, ids=named)
def test_block_on_a_belt_is_that_of_scipy(law: Any) -> None:
    """Taylor, a Runge-Kutta method, and an ensemble of either contact scheme, against Radau."""
    s0, s1, s2 = law.grip

    def field(t: float, y: Any) -> list[float]:
        v = 0.05 - y[1]
        rate = creep(law, v, y[2])
        return [y[1], -0.2 * y[1] - 100.0 * y[0] + 10.0 * (s0 * y[2] + s1 * rate + s2 * v), rate]

    times = np.linspace(0.0, 1.0, 11)
    exact = solve_ivp(field, (0.0, 1.0), [0.0] * 3, method="Radau", rtol=1e-10, atol=1e-13, t_eval=times).y[0]
    system = block(law)
    found = simulate(system, 1.0, times=times, rtol=1e-11)
    assert found.outcome.ok
    assert np.max(np.abs(found.q[:, 0] - exact)) < 1e-9
    assert found.energy.relative_residual < 1e-9
    assert len(found.event_time) == 0
    other = simulate(system, 1.0, times=times, rtol=1e-9, method="dormand-prince-8")
    assert np.max(np.abs(other.q[:, 0] - exact)) < 1e-8
    many = simulate_ensemble(system, None, 1.0, "tsitouras", times=times, rtol=1e-9, contact="smooth")
    assert np.max(np.abs(many.sample_q[:, 0] - exact)) < 1e-8
    assert many.q.shape == (1,)
    assert many["amplitude"].shape == (1,)


def test_a_lane_of_an_ensemble_is_its_single_run() -> None:
    """Parameters of the law over an axis, and a sequence of designs; the bits of a single run."""
    brake = DrumBrake(friction=LuGre(0.4, 0.3, 0.4, 3e4, 1e-3, 0.02), sliding_speed=0.5)
    values = {"friction.static": [0.35, 0.45], "friction.stiffness": [2e4, 4e4]}
    many = simulate_ensemble(brake, values, 2e-3, "taylor", start="sliding", rtol=1e-9)
    kept = [
        brake.replace({"friction.static": a, "friction.stiffness": b}) for a, b in zip(*values.values(), strict=True)
    ]
    row = simulate_ensemble(kept, None, 2e-3, "taylor", start="sliding", rtol=1e-9)
    for i, one in enumerate(kept):
        alone = simulate(one, 2e-3, start="sliding", method="taylor", rtol=1e-9)
        assert np.array_equal(many.q[i], alone.q[-1])
        assert np.allclose(row.q[i], alone.q[-1], rtol=1e-12, atol=0.0)


def test_another_law_is_told_apart() -> None:
    """Negative twin: without the Stribeck fall the motion is another one."""
    times = np.linspace(0.0, 1.0, 11)
    found, other = (
        simulate(block(law), 1.0, times=times).q for law in (LAWS[0], LuGre(0.3, 0.3, 0.1, 1e4, 10.0, 0.05))
    )
    assert np.max(np.abs(found - other)) > 1e-3


@pytest.mark.parametrize("law", [LAWS[0], LAWS[1], LAWS[3]], ids=named)
@pytest.mark.parametrize("V", [0.03, -0.2])
def test_steady_sliding_has_the_force_of_the_curve(law: Any, V: float) -> None:
    """A held block settles to mu(V) N, and start="sliding" is there from the first instant."""
    system = block(law, V=V, k=1e4)
    for start, duration in (("rest", 3.0), ("sliding", 0.1)):
        found = simulate(system.replace(C=[[50.0]]), duration, start=start, times=3)
        assert found.friction_force[-1, 0] == pytest.approx(np.sign(V) * 10.0 * float(law.mu(V)), rel=1e-9)
    assert found.friction_force[0, 0] == pytest.approx(np.sign(V) * 10.0 * float(law.mu(V)), rel=1e-12)


def test_a_contact_at_rest_has_the_stiffness_of_its_bristles() -> None:
    """A push of a hundred-thousandth of the limit: N s0 beside the spring; the period of the small swing too."""
    law = LuGre(0.45, 0.3, 0.1, 1e4)
    system = System([[1.0]], [[0.0]], [[100.0]], [1e-4], (Contact([0.0], [1.0], [1.0], 10.0, 0.0, law),))
    omega = np.sqrt(100.0 + 10.0 * 1e4)
    times = np.linspace(0.0, 3.0 * 2.0 * np.pi / omega, 13)
    found = simulate(system, times[-1], times=times)
    exact = 1e-4 / omega**2 * (1.0 - np.cos(omega * times))
    assert np.max(np.abs(found.q[:, 0] - exact)) < 1e-3 * np.max(exact)  # the bend of the bristles, of order F/(mu N)


def test_hysteresis_of_dahl_is_its_closed_form() -> None:
    """A belt that swings drives a held block: F follows mu N - (mu N + F0) exp(-s0 x/mu) up, and its mirror down."""
    law, N, swing, rate = Dahl(0.3, 2e3), 10.0, 1e-3, 5.0
    belt = Sinusoid(0.0, swing * 2.0 * np.pi * rate, rate, np.pi / 2.0)
    held = System([[1e3]], [[0.0]], [[1e12]], [0.0], (Contact([0.0], [1.0], [1.0], N, belt, law),))
    found = simulate(held, 1.0, times=401)
    rise = 2.0 * swing * law.stiffness / law.kinetic
    peak = law.kinetic * N * np.tanh(0.5 * rise)  # of the closed loop
    x = swing * (np.sin(2.0 * np.pi * rate * found.t))
    late = found.t > 0.6
    up = found.sliding_velocity[:, 0] > 1e-6
    top = law.kinetic * N - (law.kinetic * N + peak) * np.exp(-law.stiffness * (x + swing) / law.kinetic)
    low = -law.kinetic * N + (law.kinetic * N + peak) * np.exp(-law.stiffness * (swing - x) / law.kinetic)
    assert np.max(np.abs(found.friction_force[late & up, 0] - top[late & up])) < 1e-6 * peak
    down = late & (found.sliding_velocity[:, 0] < -1e-6)
    assert np.max(np.abs(found.friction_force[down, 0] - low[down])) < 1e-6 * peak


def test_stiff_bristles_tend_to_coulomb_stick_slip() -> None:
    """The error against exact stick-slip falls with s0^(-2/3): bristles give way as a state passes a fold."""
    times = np.linspace(0.0, 6.0, 13)
    exact = simulate(block(Coulomb(0.3), V=0.2, k=25.0), 6.0, times=times).q[:, 0]
    errors = []
    for stiffness in (1e4, 8e4):
        found = simulate(block(LuGre(0.3, 0.3, 0.1, stiffness), V=0.2, k=25.0), 6.0, times=times, rtol=1e-8)
        errors.append(np.max(np.abs(found.q[:, 0] - exact)))
    assert np.log(errors[0] / errors[1]) / np.log(8.0) == pytest.approx(2.0 / 3.0, abs=0.1)
    assert errors[1] < 2e-4


def test_what_rests_stays_at_rest() -> None:
    """No belt and no load: every kink of the law lies at the present state, and is never left."""
    found = simulate(block(LuGre(0.3, 0.3, 0.1, 1e5), V=0.0), 5.0, times=3)
    assert found.outcome.ok
    assert found.steps < 2000
    assert np.all(found.q == 0.0)


def vector_field(system: System) -> Callable[[Any], Any]:
    """x' for x = (q, q', z), by the formulas of the papers."""
    n = system.size

    def field(x: Any) -> Any:
        q, v, z = x[:n], x[n : 2 * n], x[2 * n :]
        push, rates = np.array(system.load, dtype=float), np.zeros(len(z))
        for c, contact in enumerate(system.contacts):
            speed, normal = float(contact.V) - contact.t @ v, float(contact.N0) + contact.n @ q
            rates[c] = creep(contact.law, speed, z[c])
            s0, s1, s2 = contact.law.grip  # type: ignore[attr-defined]
            push = push + contact.d * normal * (s0 * z[c] + s1 * rates[c] + s2 * speed)
        return np.concatenate([v, np.linalg.solve(system.M, push - system.C @ v - system.K @ q), rates])

    return field


@pytest.mark.parametrize(
    "law", [LuGre(0.45, 0.3, 0.4, 3e4, 1e-3, 0.02), Dahl(0.35, 3e4), LuGre(0.2, 0.3, 0.4, 1e5)], ids=named
)
def test_modes_of_the_drum_are_those_of_its_vector_field(law: Any) -> None:
    """Two bristle poles more; central differences of the whole field, to 1e-6 of each eigenvalue."""
    brake = DrumBrake(friction=law, sliding_speed=0.5)
    system, about = brake.system(), linearise(brake.system())
    steady = np.concatenate([about.equilibrium.q[:2], [0.0, 0.0], about.equilibrium.q[2:]])
    field, size = vector_field(system), np.concatenate([np.abs(steady[:2]), [1e-2, 1e-2], np.abs(steady[4:])])
    assert np.max(np.abs(field(steady))) < 1e-9
    steps = 1e-4 * np.diag(size)
    jacobian = np.stack([(field(steady + h) - field(steady - h)) / (2.0 * h[i]) for i, h in enumerate(steps)], axis=1)
    exact = np.sort_complex(np.linalg.eigvals(jacobian))
    found = complex_modes(brake).eigenvalues
    found = np.sort_complex(found[np.isfinite(found)])
    assert len(found) == 6
    assert np.max(np.abs(found - exact) / np.abs(exact)) < 1e-6


def test_poles_of_a_controlled_brake_are_its_modes() -> None:
    """closed_loop and the pencil in which the loop is folded, with bristles and an integral."""
    brake = DrumBrake(friction=LuGre(0.45, 0.3, 0.4, 3e4, 1e-3, 0.02), sliding_speed=0.5)
    controlled = Controlled(brake, [PID(on="y", proportional=1e6, integral=3e8, derivative=100.0)])
    poles, found = closed_loop(controlled).poles, complex_modes(controlled).eigenvalues
    found = found[np.isfinite(found)]
    assert len(poles) == len(found) == 7
    assert all(np.min(np.abs(found - pole)) < 1e-8 * np.max(np.abs(found)) for pole in poles)


def test_motion_along_a_mode_is_its_pole() -> None:
    """A start on the unstable mode, bristles included, follows exp(lambda t); steady sliding stays where it is."""
    brake = DrumBrake(friction=LuGre(0.45, 0.3, 0.4, 3e4, 1e-3, 0.02), sliding_speed=0.5)
    modes, steady = complex_modes(brake), linearise(brake.system()).equilibrium.q
    fastest = int(np.nanargmax(modes.growth_rate))
    value, shape = modes.eigenvalues[fastest], modes.right[:, fastest]
    shape = shape * 1e-12 / np.max(np.abs(shape[:2]))  # 1e-7 of the steady deflection: what is not linear is 1e-6 of it
    times = np.linspace(0.0, 2e-3, 21)
    still = simulate(brake, 2e-3, start="sliding", times=times)
    assert np.max(np.abs(still.q - steady[:2])) < 1e-13
    start = (steady[:2] + shape[:2].real, (value * shape[:2]).real, steady[2:] + shape[2:].real)
    moved = simulate(brake, 2e-3, start=start, times=times, rtol=1e-12, atol=1e-20)
    exact = (np.exp(value * times)[:, None] * shape).real
    assert np.max(np.abs(moved.q - steady[:2] - exact[:, :2])) < 1e-5 * np.max(np.abs(exact[:, :2]))
    with pytest.raises(ParameterError, match="deflections"):
        simulate(brake, 1e-3, start=(*start[:2], [0.0]))


def test_bristles_that_feed_energy_in_are_named() -> None:
    """s1 |v| > 4 g somewhere in the run; the twin stays below."""
    fast = simulate(block(LuGre(0.3, 0.3, 0.1, 1e4, 60.0)), 0.2, times=3)
    slow = simulate(block(LuGre(0.3, 0.3, 0.1, 1e4, 3.0)), 0.2, times=3)
    assert "bristles" in fast.caution
    assert "bristles" not in slow.caution


def test_a_fit_of_steady_sliding_gives_its_three_numbers() -> None:
    speeds = np.linspace(0.01, 0.5, 30)
    true = LuGre(0.45, 0.3, 0.12)
    found = fit_friction(speeds, true.mu(speeds), law=("lugre", "elasto_plastic", "stribeck"))
    assert isinstance(found.law_named("lugre"), LuGre)
    assert np.allclose(found.coefficients[0], [0.45, 0.3, 0.12], rtol=1e-8)
    assert np.allclose(found.coefficients[1], [0.45, 0.3, 0.12], rtol=1e-8)
    assert found.names[found.best] != "stribeck"
    assert "lugre" not in fit_friction(speeds, true.mu(speeds)).names


def test_open_contact_has_no_force() -> None:
    """A unilateral contact pulled off: no friction from then on."""
    law = LuGre(0.45, 0.3, 0.1, 1e3, 1.0)
    lifts = Contact([0.0, 50.0], [1.0, 0.0], [1.0, 0.0], 1.0, 0.2, law, unilateral=True, normal=[0.0, 1.0])
    system = System(np.eye(2), 0.1 * np.eye(2), np.diag([20.0, 60.0]), [0.0, -1.0], (lifts,))
    found = simulate(system, 2.0, start=([0.0, -0.1], [0.0, 0.3]), times=201)
    opened = found.mode[:, 0] == 2
    assert np.any(opened)
    assert not np.all(opened)
    assert np.all(found.friction_force[opened, 0] == 0.0)
    assert np.all(np.abs(found.friction_force[~opened, 0]) > 0.0)


@pytest.mark.parametrize(("ask", "error"), [
    (lambda s: harmonic_balance(s), InvalidSystem),
    (lambda s: basin(s), InvalidSystem),
    (lambda s: bifurcation_diagram(lambda v: s, "V", [0.1, 0.2]), InvalidSystem),
    (lambda s: mode_energy(s), InvalidSystem),
    (lambda s: simulate(s, 0.1, contact="time-stepping"), InvalidSystem),
    (lambda s: Averaged(s.contacts[0].law, 1.0), ParameterError),
    (lambda s: Dahl(0.3, 1e4, 1.5), ParameterError),
    (lambda s: ElastoPlastic(0.3, 0.4, 0.1), ParameterError),
])  # fmt: skip
def test_what_does_not_know_memory_says_so(ask: Any, error: type[Exception]) -> None:
    with pytest.raises(error, match=r"memory|1, 2 or 3|at most static"):
        ask(block(LAWS[0]))


BENT = (0.45, 0.3, 0.4, 1e5, 0.1)


@pytest.mark.parametrize("law", [LuGre(*BENT), ElastoPlastic(*BENT, breakaway=0.5)])
def test_two_contacts_with_memory_from_rest(law: Any) -> None:
    """Each is compared with its own series: the drum's two stopped as `step_limit` after a millionth of a second."""
    brake, tight = DrumBrake(friction=law, sliding_speed=0.5), Method("dormand-prince-8", rtol=1e-12)
    one, close = (simulate(brake, 0.004, times=41, method=method) for method in ("taylor", tight))
    assert one.outcome == "completed"
    assert one.steps < 2000
    assert np.max(np.abs(one.q - close.q)) < 1e-8 * np.max(np.abs(close.q))
